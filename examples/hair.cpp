// Learned wet hair under a head that turns, as hair.c in C++: hair_in_cpp SCENE.toml MODEL.h5 [DEVICE]. Its
// dry strands are stiff: they turn with the head. Prints how far wet tips hang from their roots on average
// [m].
#include <cmath>
#include <cstdio>
#include <wetcurl/wetcurl.hpp>

static wetcurl::PoseArray head_at(int frame) {
    const double angle = 0.02 * frame;
    return {0, 0, 0, std::cos(angle / 2), 0, std::sin(angle / 2), 0};
}

// About y, as head_at does.
static void turn(int frame, const std::vector<float>& from, std::vector<float>& to) {
    const float c = std::cos(0.02f * float(frame)), s = std::sin(0.02f * float(frame));
    for (size_t k = 0; k < from.size(); k += 3) {
        to[k] = c * from[k] + s * from[k + 2];
        to[k + 1] = from[k + 1];
        to[k + 2] = -s * from[k] + c * from[k + 2];
    }
}

int main(int argc, char** argv) try {
    if (argc < 3) return std::fprintf(stderr, "use: hair_in_cpp SCENE.toml MODEL.h5 [DEVICE]\n"), 2;
    wetcurl::Hair hair(argv[1], argv[2], argc > 3 ? argv[3] : "cpu");
    const size_t n = size_t(hair.particles()), strands = size_t(hair.high_strands());
    const std::vector<float> rest = hair.low_at_rest();
    std::vector<float> low(rest.size()), high(strands * n * 3);
    hair.bind(low.data(), high.data());
    for (int frame = 0; frame < 4; ++frame) {
        turn(frame, rest, low);
        if (frame == 0)
            hair.run(head_at(0));
        else
            hair.run(head_at(frame - 1), head_at(frame), head_at(frame + 1));
    }
    double sum = 0;
    for (size_t s = 0; s < strands; ++s) {
        const float *root = &high[3 * n * s], *tip = root + 3 * (n - 1);
        sum += std::sqrt(std::pow(tip[0] - root[0], 2) + std::pow(tip[1] - root[1], 2) +
                         std::pow(tip[2] - root[2], 2));
    }
    std::printf("%zu strands, %.6f\n", strands, sum / double(strands));
} catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
}

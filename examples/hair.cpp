// The same as hair.c in C++: hair_in_cpp SCENE.toml MODEL.h5 [DEVICE].
#include <cmath>
#include <cstdio>
#include <wetcurl.hpp>

static wetcurl::PoseArray head_at(int frame) {
    const double angle = 0.02 * frame;
    return {0, 0, 0, std::cos(angle / 2), 0, std::sin(angle / 2), 0};
}

int main(int argc, char** argv) try {
    if (argc < 3) return std::fprintf(stderr, "use: hair_in_cpp SCENE.toml MODEL.h5 [DEVICE]\n"), 2;
    wetcurl::Hair hair(argv[1], argv[2], argc > 3 ? argv[3] : "cpu");
    const size_t n = size_t(hair.particles()), strands = size_t(hair.high_strands());
    const std::vector<float> rest = hair.low_at_rest();
    std::vector<float> low(rest), high(strands * n * 3);
    hair.bind(low.data(), high.data());
    for (int frame = 0; frame < 4; ++frame) {
        const float c = std::cos(0.02f * float(frame)), s = std::sin(0.02f * float(frame));
        for (size_t k = 0; k < rest.size(); k += 3) {
            low[k] = c * rest[k] + s * rest[k + 2];
            low[k + 2] = -s * rest[k] + c * rest[k + 2];
        }
        if (frame == 0)
            hair.run(head_at(0));
        else
            hair.run(head_at(frame - 1), head_at(frame), head_at(frame + 1));
    }
    // Another shot begins as the first did, and what is no position or no pose is refused, not computed with.
    const std::vector<float> fourth = high;
    hair.restart();
    low = rest;
    hair.run(head_at(0));
    const std::vector<float> first = high;
    hair.restart();
    hair.run(head_at(0));
    if (high != first || high == fourth)
        throw std::runtime_error("a shot does not begin as the one before did");
    auto refused = [&](auto act) {
        try {
            act();
        } catch (const std::runtime_error& e) {
            std::fprintf(stderr, "refused: %s\n", e.what());
            return;
        }
        throw std::runtime_error("something that is not finite was computed with");
    };
    // The whole grid is wet, so that a crop leaves out nothing.
    hair.crop();
    hair.restart();
    hair.run(head_at(0));
    if (high != first) throw std::runtime_error("a crop of all of it is not all of it");
    refused([&] { hair.run({0, NAN, 0, 1, 0, 0, 0}); });
    refused([&] { hair.run({0, 0, 0, 2, 0, 0, 0}); });
    low[7] = NAN;
    refused([&] { hair.run(head_at(0)); });
    high = fourth;

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

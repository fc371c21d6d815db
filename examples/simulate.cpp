// Wet hair on a skin that deforms, simulated in memory: simulate_in_cpp [DEVICE]. The underside of a slab,
// which breathes and sways, carries the roots, as the skin of a character does; half of the hair is wetted on
// the way, and a cut puts all of it elsewhere. Prints how far roots are from the skin at most, and the mean
// saturation.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <wetcurl/wetcurl.hpp>

namespace {

const char* scene = R"(
[groom]
particles = 24
scalp = "skin"
[stretch]
[bend]
[core]
[wetness]
level = 0.1
[wetness.flow]
[curl]
[[solid]]
name = "skin"
shape = "mesh"
spacing = 0.01
)";

constexpr int across = 12;  // vertices of the slab's upper and lower side, each way

// A slab 0.2 m across and 0.05 m thick, whose lower side swells by `breath` [m].
std::vector<float> skin_at(double breath, double sway) {
    std::vector<float> x;
    for (int side = 0; side < 2; ++side)
        for (int row = 0; row < across; ++row)
            for (int column = 0; column < across; ++column) {
                const double u = 0.2 * (column / (across - 1.0) - 0.5),
                             w = 0.2 * (row / (across - 1.0) - 0.5);
                const double swell = std::cos(15 * u) * std::cos(15 * w);
                x.insert(x.end(), {float(u + sway), float(side ? -0.05 - breath * swell : 0), float(w)});
            }
    return x;
}

std::vector<int> triangles() {
    std::vector<int> corners;
    auto quad = [&](int a, int b, int c, int d) { corners.insert(corners.end(), {a, b, c, a, c, d}); };
    const int below = across * across, last = across - 1;
    for (int row = 0; row < last; ++row)
        for (int column = 0; column < last; ++column) {
            const int k = row * across + column;
            quad(k, k + across, k + across + 1, k + 1);
            quad(below + k, below + k + 1, below + k + across + 1, below + k + across);
        }
    for (int k = 0; k < last; ++k) {
        const int left = k * across, right = left + last, far = last * across + k;
        quad(k, k + 1, below + k + 1, below + k);                            // row 0
        quad(far + 1, far, below + far, below + far + 1);                    // the last row
        quad(left + across, left, below + left, below + left + across);      // column 0
        quad(right, right + across, below + right + across, below + right);  // the last column
    }
    return corners;
}

// A strand at each inner vertex of the lower side.
std::vector<float> strands_on(const std::vector<float>& skin, int points, std::vector<int>& vertices) {
    std::vector<float> x;
    for (int row = 2; row + 2 < across; ++row)
        for (int column = 2; column + 2 < across; ++column) {
            const int v = across * across + row * across + column;
            vertices.push_back(v);
            for (int i = 0; i < points; ++i)
                x.insert(x.end(), {skin[size_t(3 * v)] + 0.002f * std::sin(0.8f * float(i)),
                                   skin[size_t(3 * v + 1)] - 0.006f * float(i), skin[size_t(3 * v + 2)]});
        }
    return x;
}

}  // namespace

int main(int argc, char** argv) try {
    const std::vector<float> skin = skin_at(0, 0);
    std::vector<int> vertex;
    const std::vector<float> drawn = strands_on(skin, 20, vertex);
    const std::vector<int> points(vertex.size(), 20);
    wetcurl::Setup setup = wetcurl::Setup::text(scene);
    setup.strands(points, drawn).mesh("skin", skin, triangles());
    wetcurl::Simulation hair(setup, argc > 1 ? argv[1] : "cpu");

    double off = 0;
    for (int frame = 1; frame <= 48; ++frame) {
        if (frame == 12) {
            std::vector<float> wet = hair.saturation();
            std::fill(wet.begin(), wet.begin() + long(wet.size() / 2), 1.0f);
            hair.wet(wet);
        }
        const double sway = frame < 24 ? 0.002 * frame : 1;
        const std::vector<float> now = skin_at(0.01 * std::sin(0.4 * frame), sway);
        hair.move_mesh("skin", now);
        frame == 24 ? hair.cut() : hair.advance(1 / 30.0);
        const std::vector<float> x = hair.displayed();
        for (size_t s = 0; s < vertex.size(); ++s)
            for (size_t axis = 0; axis < 3; ++axis) {
                const float root = x[3 * s * size_t(hair.particles()) + axis];
                off = std::max(off, double(std::abs(root - now[3 * size_t(vertex[s]) + axis])));
            }
    }
    const std::vector<float> wet = hair.saturation();
    double sum = 0;
    for (float sigma : wet) sum += double(sigma);
    std::printf("%d strands, roots off by %.6f, saturation %.6f\n", hair.strands(), off,
                sum / double(wet.size()));
} catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
}

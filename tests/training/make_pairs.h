// Small pairs files whose targets follow from their inputs, for the tests of training.
#pragma once

#include <cmath>
#include <random>
#include <string>

#include "learn/codec/dct.h"
#include "learn/codec/pairs.h"

namespace wetcurl::testing {

inline constexpr int made_particles = 12;
inline constexpr int made_static = 6, made_dynamic = strand_coefficients + 2;

inline std::vector<float> uniform(std::mt19937& random, size_t n, float low = -1, float high = 1) {
    std::vector<float> out(n);
    for (auto& v : out) v = low + (high - low) * float(random() >> 8) / float(1 << 24);
    return out;
}

// Codec strand: a side x side grid without its first pixel; strands of 0.2 m. The target's amplitudes mix
// five inputs of the same strand smoothly, some 2 cm in size, alike for every seed. Channel 0 of `static`
// is 9.81 everywhere; `times`: which frames of a run these are, empty: nobody knows. After cohesion the
// amplitudes are half as large, where `displayed`.
inline std::string make_strand_pairs(const std::string& path, int side = 6, int frames = 6,
                                     float scale = 0.02f, unsigned seed = 11, bool displayed = false,
                                     const std::vector<int>& times = {}, float length = 0.2f) {
    std::mt19937 random(seed), law(3);
    PairsWriter file(path, Codec::strand, made_particles, true);
    StrandPairs run;
    run.static_channels = made_static;
    run.dynamic_channels = made_dynamic;
    run.height = run.width = side;
    run.frames = frames;
    const size_t area = run.pixels();
    run.fixed = uniform(random, made_static * area);
    std::fill_n(run.fixed.begin(), area, 9.81f);
    run.mask.assign(area, 1);
    run.mask[0] = 0;
    run.length.assign(area, length);
    run.displayed = displayed;
    run.frame = times;
    file.begin(run);
    const auto mix = uniform(law, size_t(strand_coefficients) * 5);
    for (int f = 0; f < frames; ++f) {
        const auto dynamic = uniform(random, made_dynamic * area);
        std::vector<float> target(strand_coefficients * area);
        for (size_t p = 0; p < area; ++p) {
            const float in[5] = {run.fixed[area + p], run.fixed[2 * area + p], dynamic[p],
                                 dynamic[17 * area + p], dynamic[strand_coefficients * area + p]};
            for (size_t k = 0; k < size_t(strand_coefficients); ++k) {
                float sum = 0.3f;
                for (size_t j = 0; j < 5; ++j) sum += mix[5 * k + j] * in[j];
                target[k * area + p] = scale * std::tanh(sum) / (1 + float(k % dct_kept));
            }
        }
        std::vector<float> after = target;
        for (float& v : after) v *= 0.5f;
        file.append(dynamic.data(), target.data(), displayed ? after.data() : nullptr);
    }
    file.commit();
    return path;
}

// Codec root: 32 x 32 images of a smooth map that moves; the wet one is darker and bent. The left half of the
// target's mask is empty, and there the target is absurd. Its time starts at frame `first`.
inline std::string make_root_pairs(const std::string& path, int frames = 5, int first = 0) {
    constexpr int side = 32;
    PairsWriter file(path, Codec::root, made_particles, true);
    const double lower[3] = {0, 0, 0}, upper[3] = {0.3, 0.4, 1.2};  // its diagonal is 1.3 m
    file.box(lower, upper);
    RootPairs run;
    run.frames = frames;
    run.height = run.width = side;
    run.mask_low.assign(run.pixels(), 1);
    run.mask.assign(4 * run.pixels(), 1);
    for (int y = 0; y < 2 * side; ++y)
        for (int x = 0; x < side; ++x) run.mask[size_t(y * 2 * side + x)] = 0;
    file.begin(run);
    auto colour = [](int c, double y, double x, int f) {
        return 0.5 + 0.3 * std::sin(3 * x + 2 * y + c + 0.3 * f);
    };
    for (int f = first; f < first + frames; ++f) {
        std::vector<float> input(3 * run.pixels()), target(12 * run.pixels());
        for (int c = 0; c < 3; ++c) {
            for (int y = 0; y < side; ++y)
                for (int x = 0; x < side; ++x)
                    input[size_t((c * side + y) * side + x)] =
                        float(colour(c, double(y) / side, double(x) / side, f));
            for (int y = 0; y < 2 * side; ++y)
                for (int x = 0; x < 2 * side; ++x) {
                    const double dry = colour(c, y / 64.0, x / 64.0, f);
                    target[size_t((c * 2 * side + y) * 2 * side + x)] =
                        float(x < side ? 50 : dry - 0.1 * dry * dry);
                }
        }
        file.append(input.data(), target.data());
    }
    file.commit();
    return path;
}

// Codec adhesion: one sample in ten in contact; the target is what a small function makes of the particle's
// state.
inline std::string make_adhesion_pairs(const std::string& path, int count = 3000) {
    std::mt19937 random(5);
    PairsWriter file(path, Codec::adhesion, made_particles, true);
    std::vector<AdhesionSample> samples(static_cast<size_t>(count));
    for (size_t s = 0; s < samples.size(); ++s) {
        const auto values = uniform(random, adhesion_inputs);
        std::copy(values.begin(), values.end(), samples[s].input.begin());
        samples[s].contact = s % 10 == 0;
        float* const own = samples[s].input.data() + AdhesionChannels::first(0);
        own[AdhesionChannels::contact] = samples[s].contact;
        samples[s].target = samples[s].contact ? -0.5f - 0.4f * own[AdhesionChannels::distance] +
                                                     0.3f * own[AdhesionChannels::force]
                                               : 0;
    }
    file.add(samples);
    file.commit();
    return path;
}

}  // namespace wetcurl::testing

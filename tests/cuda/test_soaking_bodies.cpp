// What follows the water, as the device has it, run on the host against the host's own strands.
#include <gtest/gtest.h>

#include <algorithm>

#include "cuda/water/soaking_setup.h"
#include "solver/chain/chain_state.h"
#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;

// Wet from some way down the strand on, and as it comes; one strand is dry.
Scene scene_with_water(const std::vector<std::string>& set, const std::string& text = wet_scene) {
    Scene scene = scene_of(text, set);
    Random random(3);
    const size_t n = size_t(scene.groom.rest.particles);
    for (size_t k = 0; k < scene.saturation.size(); ++k) {
        const size_t s = k / n, i = k % n;
        scene.saturation[k] = s == 1 || i < s ? 0.f : float(random.number(0.1, 1));
    }
    return scene;
}
Scene dried(Scene scene) {
    std::fill(scene.saturation.begin(), scene.saturation.end(), 0.f);
    return scene;
}

struct Soaked {
    std::vector<double> mass, saturation, rest_core, stretch_spring, bend_spring, twist_spring;
    std::vector<Vec3d> target, push;
    std::vector<float> volume, wet_volume;
};
// SoakingDevice on the host: its buffers, and its kernels in their order.
Soaked by_bodies(const Scene& scene, const ChainState<double>& dry) {
    const size_t count = scene.saturation.size(), n = size_t(scene.groom.rest.particles);
    Soaked out{dry.mass,
               dry.saturation,
               dry.rest_core,
               dry.stretch_spring,
               dry.bend_spring,
               dry.twist_spring,
               dry.target,
               dry.push,
               {},
               {}};
    out.volume.resize(count), out.wet_volume.resize(count);
    const SoakedStrands<double> to{.mass = out.mass.data(),
                                   .saturation = out.saturation.data(),
                                   .rest_core = out.rest_core.data(),
                                   .stretch_spring = out.stretch_spring.data(),
                                   .bend_spring = out.bend_spring.data(),
                                   .twist_spring = out.twist_spring.data(),
                                   .target = out.target.data(),
                                   .push = out.push.data(),
                                   .volume = out.volume.data(),
                                   .wet_volume = out.wet_volume.data()};
    const std::vector<double> springs = dry_springs(scene);
    const DryCurlArrays arrays = dry_curl_arrays(scene);
    const DryCurls curls = dry_curls(scene, arrays.curl.data(), arrays.vectors.data(),
                                     arrays.rotations.data(), arrays.lengths.data());
    const auto printed = printed_edges(scene, dry.rest_length);
    const Weighing weigh = weighing(scene, printed.empty() ? nullptr : printed.data(), springs.data());
    for (size_t k = 0; k < count; ++k) weigh(k, scene.saturation[k], dry.mass[k], to);
    std::vector<Vec3d> target(arrays.vectors.size() / 5), points(count);
    for (int s = 0; curls.curl && s < curls.strands; ++s)
        curls.soak(s, &scene.saturation[size_t(s) * n], target.data(), points.data(), to);
    return out;
}

double farthest(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
    double most = a.size() == b.size() ? 0 : INFINITY;
    for (size_t k = 0; k < a.size() && k < b.size(); ++k) most = std::max(most, norm(a[k] - b[k]));
    return most;
}
double farthest(const std::vector<double>& a, const std::vector<double>& b) {
    double most = a.size() == b.size() ? 0 : INFINITY;
    for (size_t k = 0; k < a.size() && k < b.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
    return most;
}

// The same formulas: a multiply-add may be contracted otherwise, and angles amplify it.
constexpr double rounding = 1e-12;

TEST(SoakingBodies, wet_strands_are_the_hosts) {
    for (const std::vector<std::string>& more :
         std::vector<std::vector<std::string>>{{}, {"curl.radius=0.006", "curl.pitch=0.02"}}) {
        auto set = more;
        set.push_back("groom.grid=[5, 5]");
        const Scene scene = scene_with_water(set);
        const ChainState<double> dry(dried(scene)), wanted(scene);
        const Soaked got = by_bodies(scene, dry);
        ASSERT_GT(farthest(dry.target, wanted.target), 1e-4);        // [m]
        ASSERT_GT(farthest(dry.rest_core, wanted.rest_core), 1e-5);  // [m]
        ASSERT_GT(farthest(dry.mass, wanted.mass), 0.1 * wanted.mass[1]);
        EXPECT_LT(farthest(got.target, wanted.target), rounding);
        EXPECT_LT(farthest(got.rest_core, wanted.rest_core), rounding);
        EXPECT_LT(farthest(got.mass, wanted.mass), 1e-15 * wanted.mass[1]);
        EXPECT_EQ(got.saturation, wanted.saturation);
        const auto volume = volumes_of(scene);
        for (size_t k = 0; k < volume.size(); ++k) {
            ASSERT_GT(volume[k], 0);
            EXPECT_FLOAT_EQ(got.volume[k], volume[k]);
            EXPECT_FLOAT_EQ(got.wet_volume[k], volume[k] * scene.saturation[k]);
        }
        // Dry strands keep their bits.
        for (size_t i = 0; i + 1 < size_t(dry.n); ++i)
            EXPECT_EQ(norm(got.target[dry.at(1, int(i))] - dry.target[dry.at(1, int(i))]), 0) << i;
    }
}

TEST(SoakingBodies, springs_of_wet_fibres_are_the_hosts) {
    const Scene scene = scene_with_water({"groom.grid=[5, 5]"}, as_fibre(wet_scene));
    const ChainState<double> dry(dried(scene)), wanted(scene);
    const Soaked got = by_bodies(scene, dry);
    const auto nearly_equal = [&](const std::vector<double>& a, const std::vector<double>& b) {
        ASSERT_EQ(a.size(), b.size());
        for (size_t k = 0; k < a.size(); ++k) {
            if ((k + 1) % size_t(dry.n) == 0) continue;  // no edge
            EXPECT_NEAR(a[k] / b[k], 1, 1e-12) << k;
        }
    };
    ASSERT_GT(farthest(dry.bend_spring, wanted.bend_spring), 0.01 * dry.bend_spring[1]);
    nearly_equal(got.stretch_spring, wanted.stretch_spring);
    nearly_equal(got.bend_spring, wanted.bend_spring);
    nearly_equal(got.twist_spring, wanted.twist_spring);
}

TEST(SoakingBodies, the_printed_curl_pushes_as_the_hosts) {
    const Scene scene = scene_with_water({"curl.form='printed'", "curl.radius=0.008", "curl.pitch=0.02"});
    const ChainState<double> dry(dried(scene)), wanted(scene);
    const Soaked got = by_bodies(scene, dry);
    ASSERT_GT(farthest(dry.push, wanted.push), 1e-3);  // [m]
    EXPECT_LT(farthest(got.push, wanted.push), rounding);
    EXPECT_EQ(farthest(got.target, dry.target), 0);
}

}  // namespace
}  // namespace wetcurl

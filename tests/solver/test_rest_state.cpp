// The rest state of strands: forces that vanish on the drawn shape, or balance its weight.
#include "solver/scene/rest_state.h"
#include "solver/solids/rest_depths.h"
#include "tests/solver/one_strand.h"
#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;

// Strand s of a scene with the rest state that the scene gives it.
OneStrand strand_of(const Scene& scene, int s) {
    Points p;
    for (int i = 0; i < scene.groom.rest.particles; ++i) p.push_back(cast<double>(scene.groom.rest.at(s, i)));
    OneStrand strand(p);
    const StrandRest rest = rest_state_of(scene, s);
    strand.mass = rest.mass;
    strand.rest_length = rest.rest_length;
    strand.target = rest.target;
    strand.rest_core = rest.rest_core;
    strand.frame = rest.frame;
    return strand;
}

Points internal_forces(const Scene& scene, OneStrand& strand) {
    Eigen::VectorXd f = Eigen::VectorXd::Zero(3 * strand.n);
    for_each_present(scene.chain, [&](const auto& term) { f += force_of(term, strand.view()); });
    return unstacked(f);
}

TEST(RestState, smoothing_of_the_core_follows_the_mean_segment_of_the_groom) {
    const Scene scene = scene_of(dry_scene);
    const Core& core = *scene.term<Core>();
    EXPECT_LT(filter_beta(mean_segment(scene.groom), core.alpha_c), 0.9);
    EXPECT_NEAR(core.beta, filter_beta(mean_segment(scene.groom), core.alpha_c), 1e-12);
}

TEST(RestState, a_thinned_groom_has_the_smoothing_of_the_whole) {
    EXPECT_EQ(scene_of(dry_scene).term<Core>()->beta, scene_of(dry_scene, {}, 2).term<Core>()->beta);
}

TEST(RestState, the_drawn_shape_bears_no_force) {
    const Scene scene = scene_of(dry_scene);
    for (int s = 0; s < scene.groom.rest.count; ++s) {
        OneStrand strand = strand_of(scene, s);
        for (const auto& f : internal_forces(scene, strand)) EXPECT_LT(norm(f), 1e-14);
        strand.x[10].x += 1e-4;
        EXPECT_GT(norm(internal_forces(scene, strand)[10]), 1e-5);
    }
}

TEST(RestState, free_of_sag_the_drawn_shape_carries_its_weight) {
    const Scene scene = scene_of(dry_scene, {"groom.rest='sag_free'"});
    for (int s = 0; s < scene.groom.rest.count; ++s) {
        OneStrand strand = strand_of(scene, s);
        const Points f = internal_forces(scene, strand);
        for (size_t i = 2; i < f.size(); ++i) {
            const Vec3d weight = strand.mass[i] * scene.integrator.gravity;
            EXPECT_LT(norm(f[i] + weight), 1e-9 * norm(weight)) << i;
        }
    }
}

TEST(RestState, masses_are_those_of_the_length_and_of_the_water) {
    const Scene dry = scene_of(dry_scene, {"groom.linear_density=1e-5"});
    const Scene wet =
        scene_of(dry_scene + "[wetness]\nlevel = 0.5\nabsorbed = 0.4\n", {"groom.linear_density=1e-5"});
    auto total = [](const Scene& scene) {
        double sum = 0;
        for (double m : rest_state_of(scene, 3).mass) sum += m;
        return sum;
    };
    EXPECT_NEAR(total(dry), 1e-5 * arc_length(dry.groom.rest.strand(3), dry.groom.rest.particles), 1e-12);
    EXPECT_GT(total(dry), 1e-7);
    EXPECT_NEAR(total(wet) / total(dry), 1.2, 1e-6);
    const auto volume = volumes_of(wet);
    double sum = 0;
    const size_t n = size_t(wet.groom.rest.particles);
    for (size_t i = 0; i < n; ++i) sum += volume[3 * n + i];
    EXPECT_NEAR(sum, total(wet) / 1300, 1e-6 * sum);
}

TEST(RestState, hair_that_is_drawn_into_an_attached_solid_may_lie_as_deep) {
    const Scene scene = scene_of(dry_scene + "[[solid]]\nradius = 0.097\nattached = \"head\"\n");
    const auto depth = rest_depths_of(scene);
    double deepest = 0;
    for (size_t k = 0; k < depth.size(); ++k) {
        const double phi = norm(cast<double>(scene.groom.rest.points[k])) - 0.097;
        EXPECT_NEAR(depth[k], std::min(0.0, phi), 1e-7);
        deepest = std::min(deepest, double(depth[k]));
    }
    EXPECT_NEAR(deepest, -0.002, 1e-5);  // the roots of the built-in groom
    EXPECT_TRUE(rest_depths_of(scene_of(dry_scene)).empty());
}

TEST(RestState, curl_shortens_the_rest_shape_where_it_is_wet_alone) {
    const Scene dry = scene_of(dry_scene);
    const Scene wet = scene_of(dry_scene + "[wetness]\npattern = \"tip\"\n[curl]\n");
    const StrandRest a = rest_state_of(dry, 5), b = rest_state_of(wet, 5);
    int same = 0, other = 0;
    for (size_t i = 1; i < a.target.size(); ++i) (norm(a.target[i] - b.target[i]) == 0 ? same : other) += 1;
    EXPECT_GT(same, 5);
    EXPECT_GT(other, 5);
    EXPECT_EQ(a.rest_core[1], b.rest_core[1]);
    EXPECT_LT(b.rest_core.back(), a.rest_core.back());
}

}  // namespace
}  // namespace wetcurl

// The device's forces on all strands run on the host, particle by particle, against each method's own.
#include <gtest/gtest.h>

#include <deque>

#include "cuda/pair_forces/pair_forces_kernel_body.h"
#include "solver/pair_forces/pair_forces_coupling.h"
#include "tests/cuda/host_search.h"
#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;

struct Result {
    std::vector<Vec3d> force;
    std::vector<double> stiffness;
    double energy = 0;
    size_t pairs = 0;
    void operator+=(const Result& other) {
        force.resize(other.force.size(), {0, 0, 0}), stiffness.resize(other.stiffness.size(), 0);
        for (size_t i = 0; i < force.size(); ++i)
            force[i] += other.force[i], stiffness[i] += other.stiffness[i];
        energy += other.energy, pairs += other.pairs;
    }
};

// Backwards: no particle's answer is another's but by the passes before.
template <class Pulls>
Result run(const Pulls& pulls) {
    const uint32_t count = pulls.count();
    Result out{std::vector<Vec3d>(count), std::vector<double>(count)};
    for (int pass = 0; pass < pulls.preparations; ++pass)
        for (uint32_t k = count; k-- > 0;) pulls.prepare(pass, k);
    for (uint32_t k = count; k-- > 0;) {
        const Pull sum = pulls.pull(k);
        out.force[pulls.id(k)] = sum.force, out.stiffness[pulls.id(k)] = sum.stiffness;
        out.pairs += sum.pairs, out.energy += pulls.energy(k);
    }
    return out;
}

struct HostPairs {
    std::vector<Vec3f> near;
    std::vector<PairPoint> point;
    std::vector<double> density;
    std::vector<Vec3d> normal;
    std::optional<HostSearch> search;
    PairMemory memory;

    HostPairs(const Scene& scene, const std::vector<Vec3d>& x, double radius)
        : point(x.size()), density(x.size(), NAN), normal(x.size(), {NAN, NAN, NAN}) {
        const std::vector<double> mass = particle_masses(scene);
        for (const Vec3d& p : x) near.push_back(cast<float>(p - x[0]));
        search.emplace(near, scene.groom.rest.particles, radius, Vec3f{0, 0, 0});
        memory = {search->view, point.data(), density.data(), normal.data()};
        for (uint32_t k = 0; k < memory.search.count; ++k)
            memory.take(k, x.data(), mass.data(), scene.saturation.data());
    }
};
struct HostSurfaces {
    std::deque<HostSearch> search;
    std::deque<std::vector<double>> volume;
    std::vector<SampledSurface> views;
    std::vector<Pose> poses;
    HostSurfaces(const Scene& scene, const BoundaryParticles2013& method, double time) {
        for (const auto& solid : scene.solids) {
            const auto points = sampled_surface(solid.shape, method.spacing);
            search.emplace_back(points, 1, search_radius(method), Vec3f{0, 0, 0});
            volume.push_back(boundary_volumes(points, method.h));
            views.push_back({search.back().view, volume.back().data()});
            poses.push_back(solid.at(time, scene.motion.at(time)));
        }
    }
};

akinci2013::KernelTable view_of(const akinci2013::KernelSum& sum) { return {sum.cell(), sum.sum().data()}; }

Result by_bodies(const Scene& scene, const std::vector<Vec3d>& x, double time) {
    Result out;
    for_each_pair_force(scene, [&]<class Method>(const Method& method) {
        if constexpr (std::is_same_v<Method, BoundaryParticles2013>) {
            const HostSurfaces surfaces(scene, method, time);
            const akinci2013::KernelSum sum(akinci2013::adhesion_kernel, method.h);
            const std::vector<double> mass = particle_masses(scene);
            out += run(BoundaryPulls{method, view_of(sum), uint32_t(x.size()), surfaces.views.data(),
                                     surfaces.poses.data(), int(surfaces.views.size()), x.data(), mass.data(),
                                     scene.saturation.data()});
        } else if constexpr (std::is_same_v<Method, Cohesion>) {
            out += run(StrandPulls<CohesionPairs>{{method}, HostPairs(scene, x, method.h_c).memory});
        } else {
            constexpr bool is_lin = std::is_same_v<Method, Lin2015>;
            const akinci2013::KernelSum sum(
                is_lin ? akinci2013::adhesion_kernel : akinci2013::cohesion_kernel, method.h);
            const HostPairs pairs(scene, x, method.h);
            using Pairs = std::conditional_t<is_lin, LinPairs, KimPairs>;
            out += run(StrandPulls<Pairs>{{method, view_of(sum)}, pairs.memory});
        }
    });
    return out;
}
Result by_reference(const Scene& scene, const std::vector<Vec3d>& x, double time) {
    const auto forces = make_pair_forces(scene);
    Result out;
    forces->evaluate(x, time, out.force);
    out.stiffness = forces->stiffness() ? *forces->stiffness() : std::vector<double>(x.size(), 0);
    out.energy = forces->potential(x, time);
    out.pairs = size_t(std::lround(forces->neighbours_mean() * double(x.size())));
    return out;
}

// Unequal masses and saturations, some strands dry; a turning head, with a solid on it and one that moves.
Scene tuft(const std::string& method) {
    Scene scene = scene_of(
        "fps = 24\n[groom]\ngrid = [5, 4]\nparticles = 12\n[stretch]\n[motion]\naxis = [0, 1, 0]\nangle = "
        "50\n"
        "period = 0.5\n[wetness]\njitter = 0.8\n" +
        method +
        "[[solid]]\nshape = \"box\"\nhalf = [0.01, 0.004, 0.006]\nattached = \"head\"\n[[solid]]\n"
        "radius = 0.006\n[[solid.motion.keyframe]]\ntime = 0\n[[solid.motion.keyframe]]\ntime = 0.2\n"
        "translation = [0.01, 0, 0]\n");
    scatter(scene, 7, 0.015);
    for (int s = 3; s < 6; ++s) std::fill_n(scene.saturation.begin() + 12 * s, 12, 0.f);
    return scene;
}
const std::string methods[] = {"[cohesion]\nstrength = 500\n", "[baseline]\nmethod = \"lin\"\n",
                               "[baseline]\nmethod = \"kim\"\n",
                               "[baseline]\nmethod = \"boundary_particles\"\nspacing = 0.002\n",
                               "[baseline]\nchain = \"iben\"\ncohesion = \"kim\"\nboundary = "
                               "\"particles\"\nboundary_spacing = 0.002\n"};

double largest(const std::vector<Vec3d>& force) {
    double most = 0;
    for (const auto& f : force) most = std::max(most, norm(f));
    return most;
}

TEST(PairForces, are_those_of_each_method) {
    for (const auto& method : methods) {
        SCOPED_TRACE(method);
        const Scene scene = tuft(method);
        auto x = positions_of(scene);
        for (auto& p : x) p += {0.003, -0.001, 0.002};
        const double time = 0.13;
        const Result wanted = by_reference(scene, x, time), got = by_bodies(scene, x, time);
        ASSERT_GT(largest(wanted.force), 1e-9);
        ASSERT_GT(std::abs(wanted.energy), 1e-14);
        EXPECT_GT(got.pairs, x.size());
        EXPECT_LE(got.pairs, wanted.pairs + 1);  // that counts some dry ones
        size_t pulled = 0;
        for (size_t i = 0; i < x.size(); ++i) {
            // Sums in double, in another order.
            EXPECT_LT(norm(got.force[i] - wanted.force[i]), 1e-12 * largest(wanted.force)) << i;
            EXPECT_NEAR(got.stiffness[i], wanted.stiffness[i], 1e-12 * wanted.stiffness[i]) << i;
            pulled += norm(got.force[i]) > 0;
        }
        EXPECT_GT(pulled, x.size() / 2);
        EXPECT_NEAR(got.energy, wanted.energy, 1e-12 * std::abs(wanted.energy));
        if (method == methods[0]) {
            EXPECT_GT(*std::max_element(got.stiffness.begin(), got.stiffness.end()), 1e-9);
        }
    }
}

TEST(PairForces, of_what_is_not_finite_are_none) {
    for (const auto& method : methods) {
        SCOPED_TRACE(method);
        const Scene scene = tuft(method);
        auto x = positions_of(scene);
        // The reference has them where they meet nobody.
        for (size_t k = 0; k < 3; ++k) x[12 * (10 + k) + 7] = {double(k + 1), 0, 0};
        const Result wanted = by_reference(scene, x, 0);
        ASSERT_GT(largest(wanted.force), 1e-9);
        x[127] = {NAN, 0, 0}, x[139] = {0, INFINITY, 0}, x[151] = {1e30, 0, 0};
        const Result got = by_bodies(scene, x, 0);
        for (size_t i = 0; i < x.size(); ++i)
            EXPECT_LT(norm(got.force[i] - wanted.force[i]), 1e-12 * largest(wanted.force)) << i;
    }
}

}  // namespace
}  // namespace wetcurl

// Cohesion inside the solve: its forces against its potential, and strands that it draws. Sec. VI.A.2.
#include "base/geometry/kernels.h"
#include "solver/pair_forces/cohesion_forces.h"
#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;

TEST(CohesionForces, the_moment_of_the_kernel_is_its_integral) {
    const double h = 0.012;
    for (double r : {0.0, 0.002, 0.0059, 0.006, 0.007, 0.0115, 0.013}) {
        double sum = 0;
        const int steps = 20000;
        for (int k = 0; k < steps && r < h; ++k) {
            const double ds = (h - r) / steps, s = r + (k + 0.5) * ds;
            sum += s * kernel_shape(s, h) * ds;
        }
        EXPECT_NEAR(kernel_shape_moment(r, h), sum, 1e-9 * h * h) << r;
    }
}

// Unequal masses and saturations.
Scene tuft(const std::string& wetness) {
    Scene scene =
        scene_of("[groom]\ngrid = [4, 3]\nparticles = 12\n[integrator]\ngravity = [0, 0, 0]\n[stretch]\n" +
                 wetness + "[cohesion]\nstrength = 500\n");
    scatter(scene, 5, 0.012);
    return scene;
}

TEST(CohesionForces, are_the_gradient_of_their_potential_and_sum_to_zero) {
    const Scene scene = tuft("[wetness]\njitter = 0.8\n");
    const auto forces = make_cohesion_forces(scene);
    auto x = positions_of(scene);
    std::vector<Vec3d> force;
    forces->evaluate(x, 0, force);
    double most = 0;
    Vec3d sum{0, 0, 0};
    for (const auto& f : force) most = std::max(most, norm(f)), sum += f;
    ASSERT_GT(most, 0);
    EXPECT_LT(norm(sum), 1e-12 * most);
    // The search sees positions in single precision, so that pairs at the support's edge come and go.
    const double step = 1e-5;
    for (size_t i = 0; i < x.size(); i += 17)
        for (double Vec3d::*axis : {&Vec3d::x, &Vec3d::y, &Vec3d::z}) {
            auto at = [&](double by) {
                auto moved = x;
                moved[i].*axis += by;
                return forces->potential(moved, 0);
            };
            EXPECT_NEAR(-(at(step) - at(-step)) / (2 * step), force[i].*axis, 1e-3 * most) << i;
        }
}

// V(x + d) <= V(x) - f.d + ½ d.S.d for every d: S outweighs the slopes however far a step goes.
TEST(CohesionForces, their_stiffness_bounds_the_potential_from_above) {
    const Scene scene = tuft("[wetness]\njitter = 0.8\n");
    const auto forces = make_cohesion_forces(scene);
    const auto x = positions_of(scene);
    std::vector<Vec3d> force;
    forces->evaluate(x, 0, force);
    const std::vector<double> stiffness = *forces->stiffness();
    const double start = forces->potential(x, 0);
    Random random(3);
    for (double size : {1e-5, 1e-3, 1e-2, 1e-1}) {
        auto moved = x;
        double bound = start;
        for (size_t i = 0; i < x.size(); ++i) {
            const Vec3d d = random.vector(size);
            moved[i] += d;
            bound += -dot(force[i], d) + 0.5 * stiffness[i] * dot(d, d);
        }
        EXPECT_LE(forces->potential(moved, 0), bound + 1e-9 * std::abs(start)) << size;
    }
}

TEST(CohesionForces, dry_hair_feels_none) {
    const Scene scene = tuft("[wetness]\nlevel = 0\n");
    std::vector<Vec3d> force;
    make_cohesion_forces(scene)->evaluate(positions_of(scene), 0, force);
    for (const auto& f : force) EXPECT_TRUE(f.x == 0 && f.y == 0 && f.z == 0);
}

const std::string lock_of_hair = R"(fps = 24
[groom]
grid = [6, 6]
particles = 46
[stretch]
[bend]
[core]
[stiffness]
global = 5
[wetness]
[cohesion]
)";

// The largest rise of the energy and the kinetic energy at the end, of how far it falls in all.
std::pair<double, double> rise_and_rest(const char* strength) {
    const auto course =
        energy_course(scene_of(lock_of_hair, {std::string("cohesion.strength=") + strength}), 48);
    std::printf("strength %s: energy rises by %.1e of its fall, kinetic at the end %.1e of it\n", strength,
                course.rise / course.fall, course.kinetic / course.fall);
    return {course.rise / course.fall, course.kinetic / course.fall};
}
TEST(CohesionForces, a_released_lock_gains_no_energy_and_comes_to_rest) {
    for (const char* strength : {"1000", "3000", "1e4"}) {
        const auto [rise, kinetic] = rise_and_rest(strength);
        EXPECT_LT(rise, 1e-9) << strength;
        EXPECT_LT(kinetic, 1e-3) << strength;
    }
    // So strong that all hair ends up in one knot, it stays finite and comes to rest.
    const auto [rise, kinetic] = rise_and_rest("1e6");
    EXPECT_LT(rise, 0.1);
    EXPECT_LT(kinetic, 1e-3);
}

// Of tips from the nearest one [m], mean.
double apart(const Strands& s) {
    double sum = 0;
    for (int a = 0; a < s.count; ++a) {
        double nearest = 1;
        for (int b = 0; b < s.count; ++b)
            if (a != b)
                nearest =
                    std::min(nearest, double(norm(s.at(a, s.particles - 1) - s.at(b, s.particles - 1))));
        sum += nearest / s.count;
    }
    return sum;
}
TEST(CohesionForces, draw_the_simulated_strands_together) {
    auto tips_apart = [](const char* strength) {
        return apart(after(scene_of(lock_of_hair,
                                    {"cohesion.radius=0.04", std::string("cohesion.strength=") + strength}),
                           24)
                         .positions);
    };
    EXPECT_LT(tips_apart("3000"), 0.7 * tips_apart("0"));
}

TEST(CohesionForces, bad_neighbours_are_refused) {
    for (const char* other :
         {"[baseline]\nmethod = \"lin\"\n", "[integrator]\nkind = \"explicit\"\n", "[wetness.flow]\n"}) {
        try {
            scene_of(lock_of_hair + other, {"cohesion.strength=1"});
            ADD_FAILURE() << other;
        } catch (const Misuse& e) {
            EXPECT_NE(std::string(e.what()).find("cohesion.strength"), std::string::npos) << e.what();
        }
    }
}

}  // namespace
}  // namespace wetcurl

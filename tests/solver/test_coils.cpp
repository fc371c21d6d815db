// Tightly coiled strands, which the paper leaves out: as many particles a turn as are asked for at load keep
// their shape.
#include <numbers>

#include "solver/chain/one_strand.h"
#include "solver/grooms/turns.h"
#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;

constexpr double radius = 0.003, pitch = 0.005;
constexpr int turns = 16;

struct Coil {
    double radius, pitch;
};
// Means over a coil of `each` particles a turn: distances to the middle of the turn around, and what these
// middles advance by over a turn.
Coil coil_of(const Strands& strand, int each) {
    std::vector<Vec3d> middle;
    Coil mean{0, 0};
    for (int i = each / 2; i + each - each / 2 < strand.particles; ++i) {
        Vec3d sum{0, 0, 0};
        for (int k = i - each / 2; k < i - each / 2 + each; ++k)
            sum += 0.5 * (cast<double>(strand.at(0, k)) + cast<double>(strand.at(0, k + 1)));
        middle.push_back((1.0 / each) * sum);
        mean.radius += norm(cast<double>(strand.at(0, i)) - middle.back());
    }
    mean.radius /= double(middle.size());
    const size_t pairs = middle.size() - size_t(each);
    for (size_t i = 0; i < pairs; ++i)
        mean.pitch += norm(middle[i + size_t(each)] - middle[i]) / double(pairs);
    return mean;
}

// A coil of one fibre, bend EI / l³, and what is left of its radius and pitch, the mean over the last second
// of three.
Coil kept(int each, double gravity, const std::string& motion) {
    const int n = turns * each + 1;
    const double length = turns * std::hypot(2 * std::numbers::pi * radius, pitch), l = length / (n - 1);
    const double bend = 8e-9 / (l * l * l);
    Scene scene =
        scene_of(dry_scene + motion,
                 {"groom.grid=[1, 1]", "groom.particles=" + std::to_string(n), "integrator.substeps=10",
                  "integrator.gravity=[0, " + std::to_string(-gravity) + ", 0]",
                  "bend.stiffness=" + std::to_string(bend), "bend.damping=" + std::to_string(2e-4 * bend),
                  "stretch.stiffness=" + std::to_string(100 * bend),
                  "stretch.damping=" + std::to_string(1e-3 * bend)});
    const auto shape = helix_points(n, length, radius, pitch);
    for (int i = 0; i < n; ++i) scene.groom.rest.at(0, i) = cast<float>(shape[size_t(i)] + Vec3d{0.1, 0, 0});
    const Coil rest = coil_of(scene.groom.rest, each);
    const auto simulation = make_simulation(scene, "double");
    Coil sum{0, 0};
    for (int f = 0; f < 72; ++f) {
        simulation->advance();
        if (f < 48) continue;
        RunFrame frame;
        simulation->snapshot(frame);
        const Coil now = coil_of(frame.positions, each);
        sum.radius += now.radius / rest.radius / 24, sum.pitch += now.pitch / rest.pitch / 24;
    }
    return sum;
}

const std::string swing = "[motion]\naxis = [0, 1, 0]\nangle = 40\nperiod = 0.8\n";

TEST(Coils, swung_without_gravity_keep_radius_and_pitch) {
    const Coil c = kept(int(enough_particles_of_a_turn), 0, swing);
    EXPECT_NEAR(c.radius, 1, 0.02);
    EXPECT_NEAR(c.pitch, 1, 0.03);
}

TEST(Coils, that_hang_lengthen_as_those_of_many_particles_do) {
    const Coil enough = kept(int(enough_particles_of_a_turn), 9.81, ""), fine = kept(24, 9.81, "");
    std::printf("hanging coil: pitch %.4f of its own with %g particles a turn, %.4f with 24\n", enough.pitch,
                enough_particles_of_a_turn, fine.pitch);
    EXPECT_GT(fine.pitch, 1.03);
    EXPECT_NEAR((enough.pitch - 1) / (fine.pitch - 1), 1, 0.2);
    EXPECT_NEAR(enough.radius, fine.radius, 0.02);
}

}  // namespace
}  // namespace wetcurl

// Hair as a fibre against closed forms of rods: what it is does not depend on how many particles it has.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "solver/chain/one_strand.h"
#include "tests/grooms/strand_files.h"
#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;

constexpr double pi = std::numbers::pi, g = 9.81;

TEST(Fibre, has_the_area_and_the_rigidities_of_an_ellipse) {
    Fibre round;
    round.ellipticity = 1;
    const double d = round.diameter;
    EXPECT_NEAR(round.area(), pi * d * d / 4, 1e-20);
    EXPECT_NEAR(round.flexural_rigidity() / (round.youngs_modulus * pi * std::pow(d, 4) / 64), 1, 1e-12);
    EXPECT_NEAR(round.torsional_rigidity() / (round.shear_modulus * pi * std::pow(d, 4) / 32), 1, 1e-12);
    Fibre flat;
    flat.ellipticity = 2;
    const double a = d * std::sqrt(2) / 2, b = a / 2;  // half axes
    EXPECT_NEAR(flat.area(), pi * a * b, 1e-20);
    const double strong = pi / 4 * a * a * a * b, weak = pi / 4 * a * b * b * b;
    EXPECT_NEAR(flat.flexural_rigidity() / (flat.youngs_modulus * 2 / (1 / strong + 1 / weak)), 1, 1e-12);
    EXPECT_NEAR(flat.torsional_rigidity() / (flat.shear_modulus * pi * std::pow(a * b, 3) / (a * a + b * b)),
                1, 1e-12);
}

TEST(Fibre, water_softens_and_swells_it) {
    const Fibre fibre;
    const auto dry = fibre.wet_shares(0), wet = fibre.wet_shares(1);
    EXPECT_EQ(dry.stretch, 1);
    EXPECT_EQ(dry.bend, 1);
    EXPECT_EQ(dry.twist, 1);
    EXPECT_NEAR(wet.stretch, 1.6 / 3.89 * 1.14 * 1.14, 1e-12);
    EXPECT_NEAR(wet.bend, 1.6 / 3.89 * std::pow(1.14, 4), 1e-12);
    EXPECT_NEAR(wet.twist, 0.2 / 0.89 * std::pow(1.14, 4), 1e-12);
}

// Of hair in one file, as the program reads it.
class FibreScene : public ::testing::Test {
  protected:
    Scene of(const StrandPoints& strands, int particles, const std::string& rest,
             const std::string& more = "") {
        scratch_.file("hair.data", data_file(strands));
        return load_scene(scratch_.file(
            "scene.toml",
            "fps = 24\nallow = [\"up\", \"size\", \"order\", \"stray_points\"]\n[groom]\nfile = "
            "\"hair.data\"\nunits = \"m\"\nup = \"y\"\nparticles = " +
                std::to_string(particles) + "\n" + rest + "\n" + more));
    }
    // The mean height of tips below roots [m] after so many seconds.
    static double drop(const Scene& scene, double seconds, const std::string& precision = "double") {
        const Strands p = after(scene, int(std::lround(seconds * scene.fps)), precision).positions;
        double sum = 0;
        for (int s = 0; s < p.count; ++s) sum += double(p.at(s, 0).y - p.at(s, p.particles - 1).y);
        return sum / p.count;
    }
    Scratch scratch_;
};

// Horizontal, q L^4 / 8 EI.
TEST_F(FibreScene, a_cantilever_bends_as_a_beam_at_any_number_of_particles) {
    const double length = 0.02;
    StrandPoints strands;
    for (int s = 0; s < 4; ++s) {
        std::vector<Vec3d> points;
        for (int i = 0; i < 40; ++i) points.push_back({length * i / 39, 0, 0.01 * s});
        strands.push_back(points);
    }
    const Fibre fibre;
    const double expected =
        fibre.linear_density() * g * std::pow(length, 4) / (8 * fibre.flexural_rigidity());
    for (const int particles : {16, 32, 64}) {
        const double found = drop(of(strands, particles,
                                     "[integrator]\nkind = \"backward_euler\"\nsubsteps = "
                                     "20\n[fibre]\ndamping = 0.01\nstrain = 0\n"),
                                  1);
        EXPECT_NEAR(found / expected, 1, particles == 16 ? 0.05 : 0.03) << particles;
    }
}

// A coil that hangs by its root: F R² S (cos² / GJ + sin² / EI) under its own weight, of which half counts.
TEST_F(FibreScene, coils_sag_as_springs_of_wire) {
    const Fibre fibre;
    for (const auto& [radius, pitch] : {std::pair{0.0025, 0.004}, {0.004, 0.012}, {0.003, 0.025}}) {
        const double length = 0.2, turn = std::hypot(2 * pi * radius, pitch);
        const int particles = int(48 * length / turn) + 1;
        const StrandPoints coil{helix_points(8 * particles, length, radius, pitch)};
        const double weight = fibre.linear_density() * length * g / 10, sine = pitch / turn,
                     cosine = 2 * pi * radius / turn;
        const double expected =
            weight / 2 * radius * radius * length *
            (cosine * cosine / fibre.torsional_rigidity() + sine * sine / fibre.flexural_rigidity());
        const Scene scene = of(coil, particles,
                               "[integrator]\nkind = \"backward_euler\"\nsubsteps = 20\ngravity = [0, "
                               "-0.981, 0]\n[fibre]\ndamping = 0.003\n");
        const auto simulation = make_simulation(scene, "double");
        const auto height = [&] {
            RunFrame frame;
            simulation->snapshot(frame);
            return double(frame.positions.at(0, 0).y - frame.positions.at(0, particles - 1).y);
        };
        const double drawn = height();
        for (int f = 0; f < 150; ++f) simulation->advance();
        EXPECT_NEAR((height() - drawn) / expected, 1, 0.05) << radius << " " << pitch;
    }
}

// Waves and curls that hang: as high with few particles as with many, dry and wet.
TEST_F(FibreScene, hair_is_as_high_at_any_number_of_particles) {
    const auto height = [&](double radius, double pitch, int particles, const std::string& more) {
        StrandPoints hair;
        for (int s = 0; s < 2; ++s) hair.push_back(helix_points(1200, 0.15, radius, pitch));
        for (auto& x : hair[1]) x.x += 0.05;
        return drop(of(hair, particles, "[integrator]\nsubsteps = 10\n[fibre]\ndamping = 0.002\n", more), 3);
    };
    for (const std::string more : {"", "[wetness]\n"}) {
        const double fine = height(0.006, 0.06, 200, more);
        for (const int particles : {32, 64, 100})
            EXPECT_NEAR(height(0.006, 0.06, particles, more) / fine, 1, 0.02) << particles << more;
    }
}

TEST_F(FibreScene, energy_of_a_fall_never_rises) {
    const StrandPoints hair{helix_points(400, 0.15, 0.006, 0.03)};
    for (const int particles : {50, 100}) {
        const Scene scene =
            of(hair, particles, "[integrator]\nsubsteps = 10\ngravity = [9.81, 0, 0]\n[fibre]\n");
        const EnergyCourse course = energy_course(scene, 96);
        EXPECT_GT(course.fall, 0);
        EXPECT_LT(course.rise, 1e-3 * course.fall) << particles;
    }
}

TEST_F(FibreScene, single_precision_keeps_it) {
    const StrandPoints hair{helix_points(1200, 0.2, 0.004, 0.012)};
    const std::string text =
        "[integrator]\nsubsteps = 10\n[fibre]\n[motion]\naxis = [0, 1, 0]\nangle = 30\nperiod = 1\n";
    const Scene scene = of(hair, 200, text);
    const Strands one = after(scene, 24, "float").positions, two = after(scene, 24, "double").positions;
    EXPECT_LT(farthest(one, two, 0), 2e-3);
    double stretched = 0;
    for (int i = 0; i + 1 < 200; ++i)
        stretched =
            std::max(stretched, double(norm(one.at(0, i + 1) - one.at(0, i)) /
                                       norm(scene.groom.rest.at(0, i + 1) - scene.groom.rest.at(0, i))));
    EXPECT_LT(stretched, 1.02);
}

TEST_F(FibreScene, what_says_the_same_twice_is_refused) {
    const StrandPoints hair{helix_points(100, 0.1, 0.004, 0.02)};
    expect_error<Misuse>([&] { of(hair, 20, "[fibre]\n[bend]\n"); }, {"[bend]", "[fibre]"});
    expect_error<Misuse>([&] { of(hair, 20, "[fibre]\n[stretch]\n"); }, {"[stretch]", "[fibre]"});
    expect_error<Misuse>([&] { of(hair, 20, "density = 1300\n[fibre]\n"); }, {"density", "diameter"});
    expect_error<Misuse>([&] { of(hair, 20, "linear_density = 1e-5\n[fibre]\n"); },
                         {"linear_density", "diameter"});
}

}  // namespace
}  // namespace wetcurl

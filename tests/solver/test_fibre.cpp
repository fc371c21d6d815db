// Hair as a fibre against closed forms of rods: what it is does not depend on how many particles it has.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
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
    const auto dry = fibre.wet_springs().at(0), wet = fibre.wet_springs().at(1);
    EXPECT_EQ(dry.stretch, 1);
    EXPECT_EQ(dry.bend, 1);
    EXPECT_EQ(dry.twist, 1);
    EXPECT_NEAR(wet.stretch, 1.5 / 3.89 * 1.065 * 1.065, 1e-12);
    EXPECT_NEAR(wet.bend, 1.5 / 3.89 * std::pow(1.065, 4), 1e-12);
    EXPECT_NEAR(wet.twist, 0.2 / 0.89 * std::pow(1.065, 4), 1e-12);
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
    static StrandPoints four_of(const std::vector<Vec3d>& points, const Vec3d& apart) {
        StrandPoints out(4, points);
        for (int s = 0; s < 4; ++s)
            for (Vec3d& x : out[size_t(s)]) x += double(s) * apart;
        return out;
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

// A coil that hangs by its root: F R² S (cos² / GJ + sin² / EI) under its own weight, of which half counts,
// with the angle at which the wire climbs. That is for whole turns, whose weight hangs in their axis, and for
// a small sag: here a small share of the coil's height, and of what it could still give.
TEST_F(FibreScene, coils_sag_as_springs_of_wire) {
    const Fibre fibre;
    constexpr int turns = 16, of_turn = 48, particles = turns * of_turn + 1;
    for (const auto& [radius, pitch] : {std::pair{0.002, 0.004},
                                        {0.002, 0.025},
                                        {0.0025, 0.004},
                                        {0.004, 0.012},
                                        {0.01, 0.004},
                                        {0.01, 0.025}}) {
        const double turn = std::hypot(2 * pi * radius, pitch), length = turns * turn, sine = pitch / turn,
                     cosine = 2 * pi * radius / turn;
        const double of_gravity =
            fibre.linear_density() * length / 2 * radius * radius * length *
            (cosine * cosine / fibre.torsional_rigidity() + sine * sine / fibre.flexural_rigidity());
        const double expected = 0.003 * length * std::min(sine, 1 - sine);
        const Scene scene = of(StrandPoints{helix_points(8 * particles, length, radius, pitch)}, particles,
                               "[integrator]\nkind = \"backward_euler\"\nsubsteps = 1\ngravity = [0, " +
                                   fmt::format("{:.9g}", -expected / of_gravity) +
                                   ", 0]\n[fibre]\ndamping = 0.01\nstrain = 0\n");
        const auto simulation = make_simulation(scene, "double");
        const auto height = [&] {
            RunFrame frame;
            simulation->snapshot(frame);
            return double(frame.positions.at(0, 0).y - frame.positions.at(0, particles - 1).y);
        };
        const double drawn = height();
        for (int f = 0; f < 2400; ++f) simulation->advance();
        EXPECT_NEAR((height() - drawn) / expected, 1, 0.02) << radius << " " << pitch;
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

// Above what it was before, by a share of what the fall takes: of long steps less than a hundredth.
TEST_F(FibreScene, energy_of_a_fall_rises_by_the_error_of_the_step_alone) {
    const StrandPoints hair{helix_points(400, 0.15, 0.006, 0.03)};
    for (const int particles : {50, 100})
        for (const auto& [substeps, bound] : {std::pair{10, 0.01}, {40, 1e-3}}) {
            const Scene scene = of(hair, particles,
                                   "[integrator]\nsubsteps = " + std::to_string(substeps) +
                                       "\ngravity = [9.81, 0, 0]\n[fibre]\n");
            const EnergyCourse course = energy_course(scene, 96);
            EXPECT_GT(course.fall, 0);
            EXPECT_LT(course.rise, bound * course.fall) << particles << " " << substeps;
        }
}

// On a head that stands still: nothing drives it, so that its energy can only fall.
TEST_F(FibreScene, stiff_hair_that_falls_on_a_head_gains_nothing) {
    for (const std::string hair : {"type1", "horse"}) {
        const Scene scene = parse_scene(
            "fps = 24\n[groom]\ngrid = [4, 4]\nparticles = 100\nlength = 0.15\n[integrator]\nsubsteps = "
            "10\n[fibre]\nhair = \"" +
                hair + "\"\n[[solid]]\nname = \"head\"\nradius = 0.095\n",
            "test", ".");
        const EnergyCourse course = energy_course(scene, 96);
        EXPECT_GT(course.fall, 1e-7) << hair;
        EXPECT_LT(course.rise, 1e-3 * course.fall) << hair;
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

// The same on a rod whose diameter falls from root to tip: d⁴ along the moment of the weight beyond.
TEST_F(FibreScene, a_profile_tapers_weight_and_stiffness) {
    const double length = 0.02;
    std::vector<Vec3d> points;
    for (int i = 0; i < 400; ++i) points.push_back({length * i / 399, 0, 0});
    const Scene scene = of(four_of(points, {0, 0, 0.01}), 64,
                           "[integrator]\nkind = \"backward_euler\"\nsubsteps = 20\n[fibre]\ndamping = "
                           "0.01\nstrain = 0\nprofile = [1.2, 1.0, 0.6]\n");
    const Fibre& fibre = *scene.fibre;
    EXPECT_EQ(fibre.profile_at(0), 1.2);
    EXPECT_NEAR(fibre.profile_at(0.25), 1.1, 1e-12);
    EXPECT_NEAR(fibre.profile_at(1), 0.6, 1e-12);
    // By sums over fine slices: moment, slope, drop.
    const int slices = 4000;
    const double ds = length / slices;
    double weight = 0, moment = 0, mass = 0;
    std::vector<double> curvature(slices);
    for (int k = slices - 1; k >= 0; --k) {
        const double d = fibre.profile_at((k + 0.5) / slices);
        mass += fibre.linear_density() * d * d * ds;
        weight += g * fibre.linear_density() * d * d * ds;
        moment += weight * ds;
        curvature[size_t(k)] = moment / (fibre.flexural_rigidity() * std::pow(d, 4));
    }
    double slope = 0, expected = 0;
    for (double c : curvature) slope += c * ds, expected += slope * ds;
    EXPECT_NEAR(drop(scene, 1) / expected, 1, 0.03);
    double found = 0;
    for (double m : dry_masses(scene, 0)) found += m;
    EXPECT_NEAR(found / mass, 1, 1e-3);
}

TEST_F(FibreScene, diameters_spread_from_strand_to_strand) {
    const auto scene = [](int grid, const std::string& more) {
        return parse_scene("[groom]\ngrid = [" + std::to_string(grid) + ", " + std::to_string(grid) +
                               "]\nparticles = 5\nlength_noise = 0\n[fibre]\n" + more,
                           "scene", ".");
    };
    EXPECT_TRUE(scene(4, "").thickness.empty());
    const Scene spread = scene(64, "spread = 0.1\n");
    const auto& d = spread.thickness;
    ASSERT_EQ(d.size(), 4096u);
    double mean = 0, square = 0;
    for (double x : d) mean += x / double(d.size());
    for (double x : d) square += (x - mean) * (x - mean) / double(d.size());
    EXPECT_NEAR(mean, 1, 0.005);
    EXPECT_NEAR(std::sqrt(square), 0.1, 0.005);
    // Nested grids agree, and so does a run of fewer strands.
    const Scene coarse = scene(32, "spread = 0.1\n");
    EXPECT_EQ(coarse.thickness[33], d[64 * 2 + 2]);
    SceneOptions few;
    few.stride = 2;
    const Scene thinned = parse_scene(spread.text, "scene", ".", few);
    EXPECT_EQ(thinned.thickness, coarse.thickness);
    // Mass goes by the area, bends by its square.
    const StrandRest rest = rest_state_of(spread, 7), plain = rest_state_of(scene(64, ""), 7);
    EXPECT_NEAR(rest.mass[2] / plain.mass[2], d[7] * d[7], 1e-9);
    EXPECT_NEAR(rest.springs.bend[2] / plain.springs.bend[2], std::pow(d[7], 4), 1e-9);
    EXPECT_NEAR(spread.hair_width(7, 0.5), 70e-6 * d[7], 1e-9);
}

// A horizontal rod that carries an arm at its end, at a right angle to it: the arm's weight twists the rod.
// Twist and positions are found in turn, and across a corner so sharp they take long to agree.
TEST_F(FibreScene, a_rod_twists_under_the_weight_of_an_arm) {
    const double rod = 0.02, arm = 0.01;
    std::vector<Vec3d> points;
    for (int i = 0; i <= 200; ++i) points.push_back({rod * i / 200, 0, 0});
    for (int i = 1; i <= 100; ++i) points.push_back({rod, 0, arm * i / 100});
    const Scene scene =
        of(four_of(points, {0, 0.02, 0}), 31,
           "[integrator]\nkind = \"backward_euler\"\nsubsteps = 20\n[fibre]\ndamping = 0.01\nstrain = 0\n");
    const Fibre& fibre = *scene.fibre;
    const double q = fibre.linear_density() * g, ei = fibre.flexural_rigidity(),
                 bends = q * std::pow(rod, 4) / (8 * ei) + q * arm * std::pow(rod, 3) / (3 * ei) +
                         q * std::pow(arm, 4) / (8 * ei),
                 twists = q * arm * arm / 2 * rod / fibre.torsional_rigidity() * arm;
    EXPECT_GT(twists, 0.1 * bends);
    const double found = drop(scene, 5);
    EXPECT_NEAR((found - bends) / twists, 1, 0.05);
    EXPECT_NEAR(found / (bends + twists), 1, 0.03);
}

// Upright hair buckles under its own weight at q L³ = 7.837 EI (Greenhill 1881). Near that a slant is
// magnified as 1 / (1 - g / g_b): Southwell's line through two gravities finds g_b.
TEST_F(FibreScene, upright_hair_buckles_at_greenhill_s_length) {
    const double length = 0.06;
    std::vector<Vec3d> points;
    for (int i = 0; i < 200; ++i) points.push_back({0, length * i / 199, 0});
    const auto leaning = [&](double gravity) {
        const Scene scene = of(four_of(points, {0, 0, 0.01}), 64,
                               "[integrator]\nkind = \"backward_euler\"\nsubsteps = 20\ngravity = [" +
                                   std::to_string(0.002 * gravity) + ", " + std::to_string(-gravity) +
                                   ", 0]\n[fibre]\ndamping = 0.02\nstrain = 0\n");
        const Strands p = after(scene, 72, "double").positions;
        return double(p.at(0, 63).x) / gravity;
    };
    const Fibre fibre;
    const double buckles =
                     7.8373 * fibre.flexural_rigidity() / (fibre.linear_density() * std::pow(length, 3)),
                 low = 0.3 * buckles, high = 0.6 * buckles, at_low = 1 / leaning(low),
                 at_high = 1 / leaning(high);
    const double found = low + (high - low) * at_low / (at_low - at_high);
    EXPECT_NEAR(found / buckles, 1, 0.03);
}

// Hair that hardly bends swings as a chain: 4 pi sqrt(L / g) / 2.4048 (Bernoulli).
TEST_F(FibreScene, limp_hair_swings_as_a_chain) {
    const double length = 0.2;
    std::vector<Vec3d> points;
    for (int i = 0; i < 200; ++i) points.push_back({0, -length * i / 199, 0});
    const Scene scene =
        of(four_of(points, {0, 0, 0.01}), 100,
           "[integrator]\nsubsteps = 40\ngravity = [0.2, -9.81, 0]\n[fibre]\nyoungs_modulus = "
           "5e6\nshear_modulus = 1e6\ndamping = 0\n");
    const auto simulation = make_simulation(scene, "double");
    std::vector<double> x;
    for (int f = 0; f < 96; ++f) {
        simulation->advance();
        RunFrame frame;
        simulation->snapshot(frame);
        x.push_back(double(frame.positions.at(0, 99).x));
    }
    // The lowest mode of the tip about where it hangs now: least squares of a cosine over its frequency.
    const double expected = 4 * pi * std::sqrt(length / g) / 2.4048;
    double best = 0, least = 1e9;
    for (double period = 0.9 * expected; period < 1.1 * expected; period += 0.001 * expected) {
        Eigen::MatrixXd a(long(x.size()), 3);
        Eigen::VectorXd b(long(x.size()));
        for (long f = 0; f < long(x.size()); ++f) {
            const double w = 2 * pi * double(f + 1) / (24 * period);
            a.row(f) << std::cos(w), std::sin(w), 1;
            b[f] = x[size_t(f)];
        }
        const double left = (a * a.colPivHouseholderQr().solve(b) - b).norm();
        if (left < least) least = left, best = period;
    }
    EXPECT_NEAR(best / expected, 1, 0.03);
}

class HairKinds : public ::testing::TestWithParam<const char*> {};

TEST_P(HairKinds, are_fibres_and_curls_that_a_scene_may_overrule) {
    const HairKind& kind = *hair_named(GetParam());
    const std::string named = std::string("[fibre]\nhair = \"") + kind.name + "\"\n";
    const Scene scene = parse_scene("[groom]\ngrid = [2, 2]\nparticles = 8\n" + named, "scene", ".");
    EXPECT_NEAR(scene.fibre->diameter, kind.diameter, 1e-12);
    EXPECT_NEAR(scene.fibre->ellipticity, kind.ellipticity, 1e-9);
    EXPECT_NEAR(scene.fibre->youngs_modulus / kind.youngs_modulus, 1, 1e-9);
    const Scene own = parse_scene(
        "[groom]\ngrid = [2, 2]\nparticles = 8\ncurl_radius = 0.001\n" + named + "diameter = 1e-4\n", "scene",
        ".");
    EXPECT_EQ(own.fibre->diameter, 1e-4);
    EXPECT_NEAR(own.fibre->ellipticity, kind.ellipticity, 1e-9);
    // A run says what it was made by: the same hair.
    const Scene again = parse_scene(scene.text, "scene", ".");
    EXPECT_TRUE(same_bits(again.groom.rest, scene.groom.rest));
}

// Drawn hair that is to hang as drawn does, dry; and water leaves it whole.
TEST_P(HairKinds, free_of_sag_hang_as_drawn) {
    const HairKind& kind = *hair_named(GetParam());
    const double turn = kind.curl_radius > 0 ? std::hypot(2 * pi * kind.curl_radius, kind.pitch) : 0.1;
    const int particles = std::max(24, int(14 * 0.1 / turn));
    const auto text = [&](const std::string& wet) {
        return "fps = 24\n[groom]\ngrid = [2, 2]\nlength = 0.1\nrest = \"sag_free\"\nparticles = " +
               std::to_string(particles) + "\n[fibre]\nhair = \"" + kind.name +
               "\"\n[integrator]\nsubsteps = 20\n[stiffness]\nglobal = 4\n" + wet;
    };
    const Scene dry = parse_scene(text(""), "scene", ".");
    const Strands hung = after(dry, 48, "double").positions;
    EXPECT_LT(farthest(hung, dry.groom.rest, 0), 0.002);
    const Scene wet = parse_scene(text("[wetness]\n[curl]\n"), "scene", ".");
    const Strands soaked = after(wet, 48, "float").positions;
    for (int s = 0; s < soaked.count; ++s)
        for (int i = 0; i + 1 < soaked.particles; ++i) {
            const double l = double(norm(wet.groom.rest.at(s, i + 1) - wet.groom.rest.at(s, i)));
            EXPECT_NEAR(double(norm(soaked.at(s, i + 1) - soaked.at(s, i))) / l, 1, 0.05);
        }
}

INSTANTIATE_TEST_SUITE_P(all, HairKinds, ::testing::ValuesIn(hair_names),
                         [](const auto& kind) { return std::string(kind.param); });

TEST_F(FibreScene, hair_of_no_such_kind_is_refused) {
    expect_error<Misuse>([] { parse_scene("[fibre]\nhair = \"type3d\"\n", "scene", "."); },
                         {"hair", "type3d", "type3b"});
}

// A file's strands have their own shape.
TEST_F(FibreScene, kinds_of_hair_leave_a_file_s_curls_alone) {
    const StrandPoints hair{helix_points(100, 0.1, 0.004, 0.02)};
    const Scene scene = of(hair, 100, "[fibre]\nhair = \"type4c\"\n");
    EXPECT_NEAR(scene.fibre->diameter, 73e-6, 1e-12);
    EXPECT_LT(
        norm(scene.groom.rest.at(0, 50) - scene.groom.rest.at(0, 0) - cast<float>(hair[0][50] - hair[0][0])),
        1e-4f);
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

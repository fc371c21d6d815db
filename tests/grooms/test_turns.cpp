// Turns of curls: counted on helices and grooms, and the particles that are asked for.
#include <numbers>

#include "solver/chain/one_strand.h"
#include "solver/grooms/groom.h"
#include "solver/grooms/procedural.h"
#include "strand_files.h"

namespace wetcurl {
namespace {

using namespace testing;

constexpr double mm = 1e-3;

// A helix of whole turns about y.
std::vector<Vec3d> coil(double radius, double pitch, int turns, int of_a_turn) {
    return helix_points(turns * of_a_turn + 1, turns * std::hypot(2 * std::numbers::pi * radius, pitch),
                        radius, pitch);
}

// What is found of its particles, where they are too few; else "".
std::string found_in(const std::string& toml, const std::string& folder) {
    Config config = Config::parse("[groom]\n" + toml, "scene.toml", folder);
    std::vector<Finding> findings;
    load_groom(config.root().table("groom"), 1, {}, &findings);
    for (const Finding& finding : findings)
        if (finding.name == std::string("few_particles"))
            return finding.level == Finding::Level::warning ? described(finding) : "";
    ADD_FAILURE() << "nothing is said of the particles of a turn";
    return "";
}

TEST(Turns, of_a_helix_are_counted_whatever_its_radius_and_sampling) {
    for (double radius : {2 * mm, 4 * mm, 10 * mm})
        for (int of_a_turn : {6, 12, 40}) {
            const CurlTurns found = turns_of(coil(radius, 5 * mm, 16, of_a_turn));
            // The spline between six points of a turn cuts its corners.
            EXPECT_NEAR(found.turns, 16, of_a_turn > 6 ? 0.2 : 0.7) << radius << " " << of_a_turn;
            EXPECT_NEAR(found.radius / radius, 1, of_a_turn > 6 ? 0.03 : 0.1) << radius << " " << of_a_turn;
        }
}

// As files have them: between sparse control points lie many more, on lines; and what a scan or a rounding
// adds.
TEST(Turns, are_counted_between_sparse_control_points_and_through_noise) {
    Random random(5);
    for (int turns : {2, 4, 9})
        for (int of_a_turn : {8, 12, 40}) {
            const auto control = coil(10 * mm, 40 * mm, turns, of_a_turn);
            std::vector<Vec3d> lines;
            for (size_t i = 0; i + 1 < control.size(); ++i)
                for (int k = 0; k < 5; ++k)
                    lines.push_back(control[i] + 0.2 * k * (control[i + 1] - control[i]));
            lines.push_back(control.back());
            std::vector<Vec3d> noisy = control;
            for (auto& x : noisy) x += random.vector(0.2 * mm);
            for (const auto& strand : {lines, noisy}) {
                const CurlTurns found = turns_of(strand);
                EXPECT_NEAR(found.turns / turns, 1, 0.1) << turns << " " << of_a_turn;
                EXPECT_NEAR(found.radius / (10 * mm), 1, 0.25) << turns << " " << of_a_turn;
            }
        }
}

TEST(Turns, of_hair_that_curls_in_part_are_those_of_its_curly_part) {
    StrandPoints strands;
    for (int s = 0; s < 30; ++s)
        strands.push_back(s % 3 ? straight_points(80, 0.2, {0, -1, 0}) : coil(4 * mm, 10 * mm, 8, 12));
    EXPECT_NEAR(turns_of(strands).turns, 8, 0.2);
}

TEST(Turns, of_straight_bent_and_noisy_strands_are_none) {
    Random random(3);
    auto noisy = straight_points(100, 0.3, {0, -1, 0});
    for (auto& x : noisy) x += random.vector(0.2 * mm);
    std::vector<Vec3d> bent;
    for (int i = 0; i < 60; ++i) bent.push_back({0.1 * std::cos(0.05 * i), 0.1 * std::sin(0.05 * i), 0});
    for (const auto& strand : {straight_points(50, 0.3, {0, -1, 0}), noisy, bent})
        EXPECT_EQ(turns_of(strand).turns, 0);
}

TEST(Turns, that_the_built_in_groom_claims_are_those_of_its_strands) {
    Config config = Config::parse(
        "curl_radius = 0.003\npitch = 0.006\nradius_noise = 0\nlength_noise = 0\nparticles = 400\n"
        "grid = [4, 4]\n",
        "scene.toml");
    const ProceduralGroom groom = read_procedural(config.root(), 1);
    const Groom made = make_procedural(groom);
    StrandPoints strands;
    for (int s = 0; s < made.rest.count; ++s) {
        strands.emplace_back();
        for (int i = 0; i < made.rest.particles; ++i)
            strands.back().push_back(cast<double>(made.rest.at(s, i)));
    }
    const CurlTurns claimed = turns_of(groom), found = turns_of(strands);
    EXPECT_GT(claimed.turns, 10);
    // The curl opens over the first 15 % of the strand.
    EXPECT_NEAR(found.turns / claimed.turns, 1, 0.15);
}

TEST(Turns, ask_for_the_number_of_particles_that_ends_the_warning) {
    const std::string coils =
        "grid = [2, 2]\nlength = 0.25\ncurl_radius = 0.003\npitch = 0.006\nparticles = ";
    const double turns = 0.25 / std::hypot(2 * std::numbers::pi * 0.003, 0.006);  // 12.64
    const int enough = int(std::ceil(8 * turns)) + 1;
    const std::string number = "particles = " + std::to_string(enough);
    for (int particles : {20, 50, enough - 1}) {
        const std::string found = found_in(coils + std::to_string(particles) + "\n", ".");
        for (const std::string& part : {std::string("12.6 turns"), number})
            EXPECT_NE(found.find(part), std::string::npos) << found;
        EXPECT_EQ(found.find("shows its curl") != std::string::npos, particles == 20) << found;
    }
    EXPECT_EQ(found_in(coils + std::to_string(enough) + "\n", "."), "");
    EXPECT_EQ(found_in("grid = [2, 2]\n", "."), "");  // the defaults
}

TEST(Turns, of_a_file_are_those_before_it_is_resampled) {
    Scratch scratch;
    StrandPoints strands;
    for (int s = 0; s < 100; ++s) {
        strands.push_back(coil(3 * mm, 5 * mm, 16, 12));
        for (auto& x : strands.back()) x += Vec3d{0.01 * (s % 10), 0, 0.01 * (s / 10)};
    }
    scratch.file("coils.data", data_file(strands));
    const std::string file = "file = 'coils.data'\nunits = 'm'\n";
    const std::string found = found_in(file + "particles = 40\n", scratch.path());
    const int enough = enough_particles(turns_of(strands));
    EXPECT_NEAR(enough, 8 * 16 + 1, 3);
    for (const std::string& part : {"particles = " + std::to_string(enough), std::string("no such")})
        EXPECT_NE(found.find(part), std::string::npos) << found;
    EXPECT_EQ(found_in(file + "particles = 200\n", scratch.path()), "");
}

}  // namespace
}  // namespace wetcurl

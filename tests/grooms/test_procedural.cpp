// The built-in groom: nesting, curls of the size asked for, a free face, nothing inside the head.
#include <cstring>
#include <numbers>

#include "base/geometry/bust.h"
#include "base/geometry/shapes.h"
#include "solver/grooms/procedural.h"
#include "tests/base/scratch.h"
#include "tests/base/threads.h"

namespace wetcurl {
namespace {

using namespace testing;

constexpr double pi = std::numbers::pi;

ProceduralGroom parameters(const std::string& toml = "", unsigned long long seed = 1) {
    Config config = Config::parse(toml, "scene.toml");
    const ProceduralGroom g = read_procedural(config.root(), seed);
    config.require_all_used();
    return g;
}
Groom groom(const std::string& toml = "", unsigned long long seed = 1) {
    return make_procedural(parameters(toml, seed));
}

bool same_bits(const Groom& a, const Groom& b) {
    return a.rest.count == b.rest.count && a.rest.particles == b.rest.particles && a.hash() == b.hash() &&
           !std::memcmp(a.normal.data(), b.normal.data(), a.normal.size() * sizeof(Vec3f));
}

void expect_nests(const std::string& fine, const std::string& coarse, const std::string& more = "") {
    const Groom full = groom(fine + more), half = groom(coarse + more);
    EXPECT_EQ(full.rest.count, 4 * half.rest.count);
    EXPECT_TRUE(same_bits(coarsened(full, 2), half));
    EXPECT_NE(coarsened(full, 4).hash(), half.hash());
}

std::string ball_mesh(const Scratch& scratch, int skip = 0) {
    const Mesh mesh = triangulated(Sphere{0.095}, 64);
    std::ostringstream out;
    for (const auto& x : mesh.vertices) out << "v " << x.x << ' ' << x.y << ' ' << x.z << '\n';
    for (size_t t = size_t(skip); t < mesh.triangles.size(); ++t)
        out << "f " << mesh.triangles[t][0] + 1 << ' ' << mesh.triangles[t][1] + 1 << ' '
            << mesh.triangles[t][2] + 1 << '\n';
    return "scalp = '" + scratch.file("ball.obj", out.str()) + "'\nunits = 'm'\n";
}

TEST(Procedural, coarse_grids_are_every_second_root_to_the_bit) {
    expect_nests("grid = [32, 32]\n", "grid = [16, 16]\n");
    expect_nests("grid = [20, 12]\n", "grid = [10, 6]\n");
    expect_nests("grid = [22, 14]\n", "grid = [11, 7]\n");  // sides that are no powers of two
    Scratch scratch;
    expect_nests("grid = [12, 12]\n", "grid = [6, 6]\n", ball_mesh(scratch) + "scalp_centre = [0, 0, 0]\n");
    expect_nests("grid = [32, 32]\n", "grid = [16, 16]\n", "curl_lock = 0.03\n");
}

TEST(Procedural, same_seed_same_bits_for_any_number_of_threads_and_another_seed_other_strands) {
    const auto [one, three] = with_one_and_three_threads([] { return groom("grid = [16, 16]"); });
    EXPECT_TRUE(same_bits(one, three));
    EXPECT_FALSE(same_bits(one, groom("grid = [16, 16]", 2)));
}

TEST(Procedural, strands_have_their_length_and_even_segments) {
    constexpr double noise = 0.1, length = 0.25;
    const Groom g = groom("grid = [16, 16]\nparticles = 200");
    double low = 1, high = 0;
    for (int s = 0; s < g.rest.count; ++s) {
        const double along = arc_length(g.rest.strand(s), g.rest.particles),
                     even = along / (g.rest.particles - 1);
        low = std::min(low, along);
        high = std::max(high, along);
        for (int i = 0; i + 1 < g.rest.particles; ++i)
            // Chords of a helix of 9 particles to the millimetre and more: shorter than their arcs by under 1
            // %.
            ASSERT_NEAR(norm(cast<double>(g.rest.at(s, i + 1) - g.rest.at(s, i))), even, 0.02 * even);
    }
    EXPECT_GT(low, 0.99 * length * (1 - noise));
    EXPECT_LE(high, length * (1 + noise));
    EXPECT_GT(high - low, length * noise);
}

// Radius and advance a turn of a strand's last third, which hangs straight down.
struct Helix {
    double radius, pitch, hand;
};
Helix measured(const Groom& g, int s, double pitch_guess) {
    const int n = g.rest.particles;
    auto at = [&](int i) { return cast<double>(g.rest.at(s, i)); };
    // The axis: the mean over a whole number of turns, as many as go into the last third.
    int first = n - 1;
    const double turns = std::floor((at(2 * n / 3).y - at(n - 1).y) / pitch_guess);
    while (at(first).y - at(n - 1).y < turns * pitch_guess) --first;
    Vec3d axis{0, 0, 0};
    for (int i = first; i < n; ++i) axis += (1.0 / (n - first)) * at(i);
    double radius = 0, angle = 0;
    for (int i = first; i < n; ++i) {
        const Vec3d d = at(i) - axis;
        radius += std::hypot(d.x, d.z) / (n - first);
        if (i == first) continue;
        const Vec3d e = at(i - 1) - axis;
        angle += std::atan2(e.z * d.x - e.x * d.z, e.x * d.x + e.z * d.z);
    }
    return {radius, (at(first).y - at(n - 1).y) * 2 * pi / std::abs(angle), angle < 0 ? -1.0 : 1.0};
}

TEST(Procedural, curls_have_the_radius_and_pitch_asked_for_and_either_hand) {
    for (const auto& [radius, pitch] : {std::pair{0.006, 0.025}, {0.003, 0.02}, {0.01, 0.05}}) {
        const Groom g =
            groom("grid = [8, 8]\nparticles = 2000\nlength = 1.2\nradius_noise = 0\ncurl_radius = " +
                  std::to_string(radius) + "\npitch = " + std::to_string(pitch));
        int left = 0;
        for (int s = 0; s < g.rest.count; ++s) {
            const Helix helix = measured(g, s, pitch);
            // The hanging part still turns towards the plumb line by a hair: a few per cent at most.
            ASSERT_NEAR(helix.radius, radius, 0.03 * radius);
            ASSERT_NEAR(helix.pitch, pitch, 0.03 * pitch);
            left += helix.hand < 0;
        }
        // 64 fair coins: 32 +- 4.
        EXPECT_GT(left, 16);
        EXPECT_LT(left, 48);
    }
}

// How alike strands curl whose roots lie `apart` [m] or nearer: the mean cosine of the edges of one to those
// of the other that are nearest.
double alike(const Groom& hair, double apart) {
    double sum = 0, count = 0;
    const int n = hair.rest.particles;
    for (int s = 0; s < hair.rest.count; ++s)
        for (int t = 0; t < s; ++t) {
            if (norm(hair.rest.at(s, 0) - hair.rest.at(t, 0)) > apart) continue;
            const auto edge = [&](int strand, int i) {
                return cast<double>(hair.rest.at(strand, i + 1) - hair.rest.at(strand, i));
            };
            for (int i = n / 2; i + 1 < n; i += 5) {
                int nearest = 0;
                const auto far = [&](int j) { return norm(hair.rest.at(t, j) - hair.rest.at(s, i)); };
                for (int j = 1; j + 1 < n; ++j)
                    if (far(j) < far(nearest)) nearest = j;
                const Vec3d a = edge(s, i), b = edge(t, nearest);
                sum += dot(a, b) / (norm(a) * norm(b)), count += 1;
            }
        }
    return sum / count;
}

TEST(Procedural, strands_of_a_lock_curl_alike_and_locks_differ) {
    const std::string curls = "grid = [40, 40]\nparticles = 100\ncurl_radius = 0.008\nphase_noise = 3.1\n";
    const Groom alone = groom(curls), locks = groom(curls + "curl_lock = 0.04\n");
    EXPECT_LT(alike(alone, 0.012), 0.7);
    EXPECT_GT(alike(locks, 0.012), alike(alone, 0.012) + 0.15);
    // Those of other locks are no more alike than without any.
    EXPECT_LT(alike(groom(curls + "curl_lock = 0.004\n"), 0.012), alike(alone, 0.012) + 0.05);
}

TEST(Procedural, without_curl_a_long_strand_ends_plumb) {
    const Groom g = groom("grid = [8, 8]\ncurl_radius = 0\nlength = 0.8");
    for (int s = 0; s < g.rest.count; ++s) {
        const Vec3d end = cast<double>(g.rest.at(s, 49) - g.rest.at(s, 45));
        EXPECT_LT(std::hypot(end.x, end.z), 0.05 * norm(end));
        EXPECT_LT(end.y, 0);
    }
}

TEST(Procedural, roots_stand_on_the_scalp_and_strands_leave_along_its_normal) {
    const Groom g = groom("particles = 500");
    for (int s = 0; s < g.rest.count; ++s) {
        const Vec3d root = cast<double>(g.rest.at(s, 0)), n = cast<double>(g.normal[size_t(s)]);
        ASSERT_NEAR(norm(root), 0.095, 1e-6);
        ASSERT_NEAR(dot(n, root), 0.095, 1e-6);
        ASSERT_GT(dot(cast<double>(g.rest.at(s, 2) - g.rest.at(s, 0)), n),
                  0.9 * norm(cast<double>(g.rest.at(s, 2) - g.rest.at(s, 0))));
    }
}

TEST(Procedural, no_particle_lies_inside_the_ball) {
    double deepest = 0;
    for (const char* more : {"", "curl_radius = 0.03\n", "lift = 0.002\n", "comb = 8\n", "coverage = 2.8\n",
                             "tilt = 0\ncomb = 0\n", "length = 0.03\n", "curl_radius = 0\nlift = 0.001\n",
                             "radius_noise = 0.9\npitch = 0.005\n"}) {
        const Groom g = groom("grid = [16, 16]\nparticles = 120\n" + std::string(more));
        for (const auto& x : g.rest.points) deepest = std::max(deepest, 0.095 - norm(cast<double>(x)));
        EXPECT_LT(deepest, 2e-4) << more;
    }
}

TEST(Procedural, the_face_stays_free) {
    const Groom g = groom();
    int crown = 0;
    for (int s = 0; s < g.rest.count; ++s)
        for (int i = 0; i < g.rest.particles; ++i) {
            const Vec3f x = g.rest.at(s, i);
            EXPECT_FALSE(x.z > 0.06f && x.y < 0.03f && std::abs(x.x) < 0.05f) << s << " " << i;
            crown += x.y > 0.095f;
        }
    EXPECT_GT(crown, 100);
}

TEST(Procedural, equal_areas_of_the_square_are_equal_areas_of_the_scalp) {
    const Cap cap{{0, 1, 0}, {1, 0, 0}, 1.6};
    constexpr int n = 400;
    for (double share : {0.1, 0.3, 0.7}) {
        // Round the pole, and a slice of longitudes: each must hold its share of places.
        int inner = 0, slice = 0;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                const Vec3d d = cap.direction((i + 0.5) / n, (j + 0.5) / n);
                ASSERT_NEAR(norm(d), 1, 1e-12);
                inner += 1 - d.y < share * (1 - std::cos(1.6));
                slice += std::atan2(d.z, d.x) + pi < 2 * pi * share;
            }
        EXPECT_NEAR(double(inner) / (n * n), share, 0.005);
        EXPECT_NEAR(double(slice) / (n * n), share, 0.005);
    }
}

TEST(Procedural, a_head_mesh_that_is_not_there_is_named) {
    expect_error([&] { parameters("scalp = '/no/such/head.obj'"); }, {"/no/such/head.obj"});
}

TEST(Procedural, a_head_mesh_takes_the_place_of_the_ball) {
    Scratch scratch;
    const std::string grid = "grid = [12, 12]\nscalp_centre = [0, 0, 0]\n";
    const Groom ball = groom(grid);
    // A closed mesh, and one with a hole below, where no hair grows.
    for (int skipped : {0, 40}) {
        const Groom head = groom(grid + ball_mesh(scratch, skipped));
        double farthest = 0, deepest = 0;
        for (int s = 0; s < head.rest.count; ++s) {
            farthest = std::max(farthest, norm(cast<double>(head.rest.at(s, 0) - ball.rest.at(s, 0))));
            // Facets lie inside of the ball: by r (1 - cos(pi / 64)) = 0.11 mm, twice that across both ways.
            for (int i = 0; i < head.rest.particles; ++i)
                deepest = std::max(deepest, 0.095 - norm(cast<double>(head.rest.at(s, i))));
        }
        EXPECT_LT(farthest, 3e-4) << skipped;
        EXPECT_GT(farthest, 1e-6);
        EXPECT_LT(deepest, 5e-4);
    }
}

TEST(Procedural, the_centre_of_a_head_lies_under_its_top) {
    Mesh head = triangulated(Sphere{0.1}, 64);
    for (auto& x : head.vertices) x = x + Vec3f{0.5f, 1.0f, -0.25f};
    const Vec3d centre = head_centre(head, 0.1);
    EXPECT_LT(norm(centre - Vec3d{0.5, 1.0, -0.25}), 0.005);
}

TEST(Procedural, a_natural_hairline_leaves_face_and_ears_free_and_reaches_the_nape) {
    const std::string natural = "grid = [32, 32]\nparticles = 4\nhairline = \"natural\"\ntilt = 0.35\n";
    const Groom hair = groom(natural);
    double lowest = 1, foremost = -1;
    for (int s = 0; s < hair.rest.count; ++s) {
        const Vec3d root = cast<double>(hair.rest.at(s, 0)), out = normalized(root, root);
        ASSERT_LT(std::acos(out.y), hairline(out) + 1e-6);
        lowest = std::min(lowest, out.y);
        if (std::abs(out.x) < 0.2) foremost = std::max(foremost, out.z);
    }
    EXPECT_LT(lowest, std::cos(2.0));                            // under the ears, at the nape
    EXPECT_NEAR(foremost, std::sin(hairline({0, 0, 1})), 0.03);  // up to the brow
    // Grids nest, whatever the rim.
    EXPECT_TRUE(same_bits(coarsened(hair, 2),
                          groom("grid = [16, 16]\nparticles = 4\nhairline = \"natural\"\ntilt = 0.35\n")));
}

TEST(Procedural, the_part_turns_to_either_side) {
    const std::string base = "grid = [16, 16]\nparticles = 30\ncurl_radius = 0\ncomb = 3\n";
    // Hair at the crown falls away from the part: with it on one side, more of the hair falls to the other.
    auto sideways = [&](const std::string& turn) {
        const Groom hair = groom(base + "part_turn = " + turn + "\n");
        double sum = 0;
        for (int s = 0; s < hair.rest.count; ++s) sum += double(hair.rest.at(s, 29).x - hair.rest.at(s, 0).x);
        return sum / hair.rest.count;
    };
    EXPECT_LT(sideways("0.6"), sideways("0") - 1e-3);
    EXPECT_GT(sideways("-0.6"), sideways("0") + 1e-3);
    EXPECT_TRUE(same_bits(groom(base), groom(base + "part_turn = 0\n")));
}

}  // namespace
}  // namespace wetcurl

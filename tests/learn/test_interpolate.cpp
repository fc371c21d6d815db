// Interpolation of a low-resolution run, without a network.
#include "learn/codec/core_detail.h"
#include "learn/codec/interpolate.h"
#include "tests/learn/hair.h"

namespace wetcurl::testing {
namespace {

constexpr Interpolation kinds[] = {Interpolation::nearest, Interpolation::quad, Interpolation::core,
                                   Interpolation::rest, Interpolation::skin};

Strands interpolated(Interpolation kind, const Stencil& stencil, const Groom& high, const Strands& low,
                     const Pose& head = {}, const Strands* shape = nullptr) {
    Strands out;
    Interpolator(kind, stencil, high, coarsened(high, 2), shape).apply(low, head, out);
    return out;
}

double mean_curl(const Strands& strands) {
    double sum = 0;
    for (float r : curl_radii(strands)) sum += r;
    return sum / strands.count;
}

// Strands whose tips stand `by(strand)` [m] from where they are at rest; other particles less, in proportion.
template <class By>
Strands swayed(const Strands& rest, By by) {
    Strands out = rest;
    for (int s = 0; s < rest.count; ++s)
        for (int i = 0; i < rest.particles; ++i)
            out.at(s, i) += (float(i) / float(rest.particles - 1)) * by(s);
    return out;
}

// Strands of the pixels with an odd row and an odd column: those with four neighbours.
Strands inner(const Groom& groom, const Strands& strands) {
    std::vector<int> kept;
    for (int row = 1; row + 1 < groom.grid.height; row += 2)
        for (int column = 1; column + 1 < groom.grid.width; column += 2)
            kept.push_back(groom.grid.at(column, row));
    Strands out(int(kept.size()), strands.particles);
    for (size_t k = 0; k < kept.size(); ++k)
        std::copy_n(strands.strand(kept[k]), strands.particles, out.strand(int(k)));
    return out;
}

TEST(Stencil, weights_sum_to_one_on_whole_grids_and_grids_with_holes) {
    Groom whole = curly_groom({});
    Groom holed = whole;
    holed.grid.strand.assign(holed.grid.strand.size(), -1);
    holed.rest = Strands(0, whole.rest.particles);
    holed.normal.clear();
    std::vector<int> kept;
    for (int s = 0; s < whole.rest.count; ++s)
        if (s % 3 != 0) kept.push_back(s);
    holed.rest = Strands(int(kept.size()), whole.rest.particles);
    for (size_t k = 0; k < kept.size(); ++k) {
        std::copy_n(whole.rest.strand(kept[k]), whole.rest.particles, holed.rest.strand(int(k)));
        holed.normal.push_back(whole.normal[size_t(kept[k])]);
        holed.grid.strand[size_t(kept[k])] = int(k);
    }
    for (const Groom& groom : {whole, holed})
        for (const Stencil& stencil :
             {quad_stencil(groom, coarsened(groom, 2)), triangle_stencil(groom, coarsened(groom, 2))}) {
            ASSERT_EQ(stencil.count(), groom.rest.count);
            for (int s = 0; s < stencil.count(); ++s) {
                double sum = 0;
                for (int k = 0; k < stencil.width; ++k) {
                    const float w = stencil.weight[size_t(s * stencil.width + k)];
                    EXPECT_GE(w, 0);
                    sum += w;
                }
                EXPECT_NEAR(sum, 1, 1e-6);
            }
        }
}

TEST(Stencil, an_inner_root_has_four_equal_neighbours) {
    const Groom groom = curly_groom({});
    const Stencil stencil = quad_stencil(groom, coarsened(groom, 2));
    const int s = groom.grid.at(3, 5);
    for (int k = 0; k < 4; ++k) EXPECT_FLOAT_EQ(stencil.weight[size_t(s) * 4 + k], 0.25f);
    std::vector<int> found(stencil.from.begin() + s * 4, stencil.from.begin() + s * 4 + 4);
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, (std::vector<int>{2 * 4 + 1, 2 * 4 + 2, 3 * 4 + 1, 3 * 4 + 2}));
}

TEST(Stencil, grooms_that_do_not_nest_are_an_error) {
    const Groom groom = curly_groom({});
    Groom low = coarsened(groom, 2);
    low.rest.at(3, 7).x += 0.001f;
    expect_error([&] { require_nested(groom, low); }, {"strand 3", "particle 7", "allowed 0.01 mm"});
    expect_error([&] { require_part(groom, low); }, {"strand 3 is none", "particle 7", "allowed 0.01 mm"});
    expect_error([&] { quad_stencil(groom, low); }, {"4 x 4 roots", "every second, third", "8 x 8 roots"});
    expect_error([&] { require_nested(groom, coarsened(groom, 4)); },
                 {"2 x 2 roots", "every second root", "4 x 4 roots"});
    require_part(groom, coarsened(groom, 4));
    EXPECT_FALSE(nests(groom, low));
    EXPECT_TRUE(nests(groom, coarsened(groom, 3)));
}

TEST(Stencil, of_every_fourth_root_is_bilinear) {
    const Groom groom = curly_groom({}), low = coarsened(groom, 4);  // 8 x 8 to 2 x 2
    const Stencil stencil = quad_stencil(groom, low);
    for (int row = 0; row <= 4; ++row)
        for (int column = 0; column <= 4; ++column) {
            std::vector<double> share(4, 0);
            for (size_t k = 0; k < 4; ++k) {
                const size_t at = size_t(row * 8 + column) * 4 + k;
                share[size_t(stencil.from[at])] += double(stencil.weight[at]);
            }
            const double u = column / 4.0, v = row / 4.0;
            const double expected[] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
            for (size_t k = 0; k < 4; ++k) EXPECT_NEAR(share[k], expected[k], 1e-6) << column << " " << row;
        }
}

// Roots that lie nowhere on a grid: in a plane what is linear in the roots comes back exactly, wherever they
// surround it.
TEST(Stencil, of_any_roots_is_linear_between_them) {
    Groom groom = curly_groom({});
    Random random(3);
    for (int s = 0; s < groom.rest.count; ++s) {
        const Vec3f to{0.01f * float(s % 8) + 0.002f * float(random.number()), 0,
                       0.01f * float(s / 8) + 0.002f * float(random.number())};
        const Vec3f move = to - groom.rest.at(s, 0);
        for (int i = 0; i < groom.rest.particles; ++i) groom.rest.at(s, i) += move;
        groom.normal[size_t(s)] = {0, 1, 0};
    }
    std::vector<int> kept;
    for (int s = 0; s < groom.rest.count; s += 3) kept.push_back(s);
    const Groom low = part_of(groom, kept);
    const Stencil stencil = surrounding_stencil(groom, low);
    EXPECT_EQ(stencil.width, 3);
    for (size_t k = 0; k < kept.size(); ++k) EXPECT_EQ(stencil.twin[k], kept[k]);
    int inside = 0;
    for (int s = 0; s < groom.rest.count; ++s) {
        Vec3f sum{0, 0, 0};
        float weights = 0;
        for (size_t k = 0; k < 3; ++k) {
            const size_t at = size_t(s) * 3 + k;
            EXPECT_GE(stencil.weight[at], 0);
            weights += stencil.weight[at];
            sum += stencil.weight[at] * low.rest.at(stencil.from[at], 0);
        }
        EXPECT_NEAR(weights, 1, 1e-6);
        const int column = s % 8, row = s / 8;
        if (column < 2 || row < 2 || column > 5 || row > 5) continue;
        ++inside;
        EXPECT_LT(norm(sum - groom.rest.at(s, 0)), 1e-7f) << s;
    }
    EXPECT_EQ(inside, 16);
}

TEST(Interpolation, shared_strands_come_back_as_they_are) {
    const Groom groom = curly_groom({});
    std::vector<int> kept;
    const Groom low = coarsened(groom, 2, &kept);
    for (const Stencil& stencil : {quad_stencil(groom, low), triangle_stencil(groom, low)})
        for (Interpolation kind : kinds) {
            const Strands out = interpolated(kind, stencil, groom, low.rest);
            for (int s = 0; s < low.rest.count; ++s)
                for (int i = 0; i < low.rest.particles; ++i)
                    // A few roundings of lengths up to 0.3 m, 3e-8 each.
                    EXPECT_LT(norm(out.at(kept[size_t(s)], i) - low.rest.at(s, i)), 3e-7);
        }
}

TEST(Interpolation, equal_strands_around_give_a_copy) {
    Curls curls;
    curls.phase_spread = 0;
    const Groom groom = curly_groom(curls);
    const Groom low = coarsened(groom, 2);
    ASSERT_NEAR(mean_curl(groom.rest) / curls.radius, 1, 0.05);
    for (const Stencil& stencil : {quad_stencil(groom, low), triangle_stencil(groom, low)})
        for (Interpolation kind : kinds)
            EXPECT_LT(largest_distance(interpolated(kind, stencil, groom, low.rest), groom.rest), 5e-7);
}

TEST(Interpolation, roots_are_exact_and_all_follows_the_head) {
    const Groom groom = curly_groom({});
    const Groom low = coarsened(groom, 2);
    const Pose pose = some_pose(7);
    const Strands turned_rest = moved(groom.rest, pose);
    Random random(6);
    std::vector<Vec3f> sway;
    for (int s = 0; s < low.rest.count; ++s) sway.push_back(cast<float>(random.vector(0.05)));
    const Strands bent = swayed(low.rest, [&](int s) { return sway[size_t(s)]; });
    for (const Stencil& stencil : {quad_stencil(groom, low), triangle_stencil(groom, low)})
        for (Interpolation kind : kinds) {
            const Strands still = interpolated(kind, stencil, groom, bent);
            const Strands turned = interpolated(kind, stencil, groom, moved(bent, pose), pose);
            ASSERT_GT(largest_distance(still, groom.rest), 1e-3);  // it is no copy
            EXPECT_LT(largest_distance(moved(still, pose), turned), 2e-6);
            for (int s = 0; s < groom.rest.count; ++s)
                EXPECT_LT(norm(turned.at(s, 0) - turned_rest.at(s, 0)), 1e-7);
        }
}

TEST(Interpolation, skin_keeps_the_drawn_shape_and_turns_it_as_guides_turn) {
    const Groom groom = curly_groom({});
    const Groom low = coarsened(groom, 2);
    for (const Stencil& stencil : {quad_stencil(groom, low), triangle_stencil(groom, low)})
        EXPECT_LT(largest_distance(interpolated(Interpolation::skin, stencil, groom, low.rest), groom.rest),
                  1e-6);
    // Straight guides that all turn about an axis across them turn a strand about the mean of their roots.
    Groom straight = low;
    for (int s = 0; s < straight.rest.count; ++s)
        for (int i = 0; i < straight.rest.particles; ++i)
            straight.rest.at(s, i) = straight.rest.at(s, 0) - Vec3f{0, 4e-3f * float(i), 0};
    Strands turned = straight.rest;
    const Quatf turn = cast<float>(rotation_about(Vec3d{0.6, 0, -0.8}, 0.5));
    const auto turned_about = [&](const Vec3f& middle, const Vec3f& x) {
        return middle + rotate(turn, x - middle);
    };
    for (int s = 0; s < turned.count; ++s)
        for (int i = 0; i < turned.particles; ++i)
            turned.at(s, i) = turned_about(straight.rest.at(s, 0), straight.rest.at(s, i));
    Stencil stencil = quad_stencil(groom, low);
    Strands out;
    Interpolator(Interpolation::skin, stencil, groom, straight).apply(turned, {}, out);
    for (int s = 0; s < groom.rest.count; ++s) {
        Vec3f middle{0, 0, 0};
        for (int k = 0; k < stencil.width; ++k)
            middle += stencil.weight[size_t(s * stencil.width + k)] *
                      straight.rest.at(stencil.from[size_t(s * stencil.width + k)], 0);
        EXPECT_LT(norm(out.at(s, 0) - groom.rest.at(s, 0)), 1e-7);
        for (int i = 1; i < groom.rest.particles; ++i)
            EXPECT_LT(norm(out.at(s, i) - turned_about(middle, groom.rest.at(s, i))), 2e-6) << s << " " << i;
    }
}

// The same roots in another order of strands.
TEST(Interpolation, the_order_of_strands_does_not_matter) {
    const Groom groom = curly_groom({});
    Groom other = groom;
    const int n = groom.rest.count;
    for (int s = 0; s < n; ++s) {
        const int to = (s * 37 + 11) % n;  // 37 is prime to 64
        std::copy_n(groom.rest.strand(s), groom.rest.particles, other.rest.strand(to));
        other.normal[size_t(to)] = groom.normal[size_t(s)];
        other.grid.strand[size_t(s)] = to;
    }
    const Groom low = coarsened(groom, 2), other_low = coarsened(other, 2);
    for (Interpolation kind : kinds) {
        const Strands a = interpolated(kind, quad_stencil(groom, low), groom, low.rest);
        const Strands b = interpolated(kind, quad_stencil(other, other_low), other, other_low.rest);
        for (int s = 0; s < n; ++s)
            for (int i = 0; i < a.particles; ++i)
                EXPECT_LT(norm(a.at(s, i) - b.at((s * 37 + 11) % n, i)), 1e-7);
    }
}

TEST(Interpolation, a_linear_field_of_offsets_is_reproduced_inside) {
    // Offsets that grow linearly over a flat scalp.
    Groom groom = curly_groom({});
    for (int s = 0; s < groom.rest.count; ++s) {
        const float x = float(s % 8), z = float(s / 8);
        for (int i = 0; i < groom.rest.particles; ++i)
            groom.rest.at(s, i) = {0.01f * x + 1e-4f * float(i) * (x + 2 * z), -0.004f * float(i),
                                   0.01f * z - 1e-4f * float(i) * z};
        groom.normal[size_t(s)] = {0, 1, 0};
    }
    const Groom low = coarsened(groom, 2);
    for (const Stencil& stencil : {quad_stencil(groom, low), triangle_stencil(groom, low)})
        for (Interpolation kind : {Interpolation::quad, Interpolation::core})
            EXPECT_LT(largest_distance(inner(groom, interpolated(kind, stencil, groom, low.rest)),
                                       inner(groom, groom.rest)),
                      kind == Interpolation::quad ? 1e-6 : 1e-5);
}

// Neighbours that differ in their phase alone.
Curls dense_upright_curls() {
    Curls curls;
    curls.width = curls.height = 32;
    curls.spacing = 0.002;
    curls.lean = 0;
    return curls;
}

TEST(Interpolation, core_and_detail_keeps_the_curl_of_random_phases_and_the_mean_loses_it) {
    const Curls curls = dense_upright_curls();
    const Groom groom = curly_groom(curls);
    const Groom low = coarsened(groom, 2);
    const double truth = mean_curl(inner(groom, groom.rest));
    ASSERT_NEAR(truth / curls.radius, 1, 0.05);
    const Stencil stencil = quad_stencil(groom, low);
    auto kept = [&](Interpolation kind) {
        return mean_curl(inner(groom, interpolated(kind, stencil, groom, low.rest))) / truth;
    };
    EXPECT_GT(kept(Interpolation::core), 0.9);
    EXPECT_LT(kept(Interpolation::core), 1.1);
    // The mean length of the mean of four random unit vectors in the plane: 1.799 / 4.
    EXPECT_NEAR(kept(Interpolation::quad), 0.45, 0.03);
}

TEST(Interpolation, rest_of_strands_at_rest_is_the_rest_groom_at_any_pose) {
    const Groom groom = curly_groom({});
    const Groom low = coarsened(groom, 2);
    ASSERT_GT(largest_distance(interpolated(Interpolation::core, quad_stencil(groom, low), groom, low.rest),
                               groom.rest),
              1e-3);  // of strands around it alone a strand is not known
    for (const Stencil& stencil : {quad_stencil(groom, low), triangle_stencil(groom, low)})
        for (unsigned seed = 0; seed < 5; ++seed) {
            const Pose pose = seed ? some_pose(seed) : Pose{};
            // Positions to 0.5 m are rounded to 3e-8 m, and a core adds 49 edges of them.
            EXPECT_LT(largest_distance(
                          interpolated(Interpolation::rest, stencil, groom, moved(low.rest, pose), pose),
                          moved(groom.rest, pose)),
                      1e-6)
                << seed;
        }
}

TEST(Interpolation, rest_keeps_every_curl_where_the_mean_of_random_phases_loses_it) {
    const Curls curls = dense_upright_curls();
    const Groom groom = curly_groom(curls);
    const Groom low = coarsened(groom, 2);
    const Vec3f sway{0.05f, 0, 0.02f};
    const Strands bent = swayed(low.rest, [&](int) { return sway; });
    const Stencil stencil = quad_stencil(groom, low);
    const Strands out = interpolated(Interpolation::rest, stencil, groom, bent);
    const auto before = curl_radii(groom.rest), after = curl_radii(out);
    const int tip = out.particles - 1;
    for (int s = 0; s < out.count; ++s) {
        // Turned, each detail is as long as it was; the core of all is not quite the core that it was put on.
        EXPECT_NEAR(after[size_t(s)] / before[size_t(s)], 1, 0.01) << s;
        // The core moves by the sway; the detail at the tip (8 mm) turns with it, by 15 degrees.
        EXPECT_LT(norm(out.at(s, tip) - groom.rest.at(s, tip) - sway), 0.003) << s;
    }
    // As of strands at rest: 1.799 / 4.
    const Strands mean = interpolated(Interpolation::quad, stencil, groom, bent);
    EXPECT_NEAR(mean_curl(inner(groom, mean)) / mean_curl(inner(groom, groom.rest)), 0.45, 0.03);
}

// Straight strands that hang side by side.
Groom straight_groom() { return curly_groom({.radius = 0, .lean = 0}); }

// At a parting: of the columns to its left and right, the one between them is drawn as those to the right.
TEST(Interpolation, rest_goes_with_the_strands_that_are_drawn_alike) {
    Groom groom = straight_groom();
    auto right = [](int strand) { return strand % 8 > 2; };
    groom.rest = swayed(groom.rest, [&](int s) { return Vec3f{right(s) ? 0.1f : -0.1f, 0, 0}; });
    const Groom low = coarsened(groom, 2);
    const Vec3f sway{0, 0, 0.1f};
    auto moving = [&](int s) { return low.rest.at(s, low.rest.particles - 1).x > low.rest.at(s, 0).x; };
    const Strands parted = swayed(low.rest, [&](int s) { return moving(s) ? sway : Vec3f{0, 0, 0}; });
    const Stencil stencil = quad_stencil(groom, low);
    const Strands wanted = swayed(groom.rest, [&](int s) { return right(s) ? sway : Vec3f{0, 0, 0}; });
    // Parallel strands within a fiftieth of their length count as one.
    EXPECT_LT(largest_distance(interpolated(Interpolation::rest, stencil, groom, parted), wanted), 1e-3);
    EXPECT_GT(largest_distance(interpolated(Interpolation::quad, stencil, groom, parted), wanted), 0.05);
}

// Strands that lean to random sides, of which water takes a share from the low-resolution ones: it does from
// all.
TEST(Interpolation, rest_keeps_of_its_own_what_low_resolution_strands_keep) {
    const Groom hanging = straight_groom();
    Random random(5);
    std::vector<Vec3f> lean;
    for (int s = 0; s < hanging.rest.count; ++s) {
        Vec3d side = random.vector(1);
        side.y = 0;
        lean.push_back(0.1f * cast<float>(normalized(side, Vec3d{1, 0, 0})));
    }
    Groom groom = hanging;
    groom.rest = swayed(hanging.rest, [&](int s) { return lean[size_t(s)]; });
    const Groom low = coarsened(groom, 2);
    const Stencil stencil = quad_stencil(groom, low);
    for (const float kept : {1.f, 0.6f, 0.f}) {
        const Strands wanted = swayed(hanging.rest, [&](int s) { return kept * lean[size_t(s)]; });
        Strands now = low.rest;
        for (int s = 0; s < now.count; ++s)
            std::copy_n(wanted.strand(stencil.twin[size_t(s)]), now.particles, now.strand(s));
        const Strands out = interpolated(Interpolation::rest, stencil, groom, now);
        // Of 0.1 m that they lean, a tenth of what is lost may be chance.
        EXPECT_LT(largest_distance(out, wanted), 1e-6 + 0.01 * (1 - kept)) << kept;
    }
}

// A fringe between strands that hang to the waist: it turns as they do, and does not go where their tips go.
TEST(Interpolation, rest_of_a_short_strand_turns_as_long_ones_around_it) {
    Groom groom = straight_groom();
    const auto length = [](int s) { return s / 8 % 2 == 1 ? 0.02f : 1.f; };  // of a row
    for (int s = 0; s < groom.rest.count; ++s)
        for (int i = groom.rest.particles - 1; i > 0; --i)
            groom.rest.at(s, i) =
                groom.rest.at(s, 0) + length(s) * (groom.rest.at(s, i) - groom.rest.at(s, 0));
    const Groom low = coarsened(groom, 2);  // long ones alone
    const Quatf turn = cast<float>(rotation_about(Vec3d{0.6, 0, -0.8}, 0.5));
    const auto turned = [&](const Strands& strands) {
        Strands out = strands;
        for (int s = 0; s < out.count; ++s)
            for (int i = 1; i < out.particles; ++i)
                out.at(s, i) = out.at(s, 0) + rotate(turn, out.at(s, i) - out.at(s, 0));
        return out;
    };
    for (const Stencil& stencil : {quad_stencil(groom, low), triangle_stencil(groom, low)})
        EXPECT_LT(largest_distance(interpolated(Interpolation::rest, stencil, groom, turned(low.rest)),
                                   turned(groom.rest)),
                  1e-6);
}

TEST(Interpolation, rest_of_the_drawn_shape_is_that_of_no_shape) {
    const Groom groom = curly_groom({});
    const Groom low = coarsened(groom, 2);
    Random random(9);
    const Strands bent = swayed(low.rest, [&](int) { return cast<float>(random.vector(0.05)); });
    const Pose pose = some_pose(4);
    const Stencil stencil = quad_stencil(groom, low);
    const auto plain = interpolated(Interpolation::rest, stencil, groom, moved(bent, pose), pose),
               shaped =
                   interpolated(Interpolation::rest, stencil, groom, moved(bent, pose), pose, &groom.rest);
    EXPECT_EQ(largest_distance(plain, shaped), 0);
}

TEST(Interpolation, rest_of_a_tighter_curl_has_its_radius_at_the_places_of_the_drawn_core) {
    Curls wide{.particles = 100, .radius = 0.004, .turns = 10, .lean = 0}, tight = wide;
    tight.radius /= 2;
    const Groom groom = curly_groom(wide);
    const Groom low = coarsened(groom, 2);
    const Strands shape = curly_groom(tight).rest;
    const auto drawn = curl_radii(groom.rest), wanted = curl_radii(shape);
    // Smoothing leaves this share of ten turns in the core, and of the drawn one's no half is taken.
    const double left = 1 / (1 + std::pow(2 * std::numbers::pi * wide.turns / 10, 2));
    for (unsigned seed = 0; seed < 3; ++seed) {
        const Pose pose = seed ? some_pose(seed) : Pose{};
        const Strands out = interpolated(Interpolation::rest, quad_stencil(groom, low), groom,
                                         moved(low.rest, pose), pose, &shape);
        const auto found = curl_radii(out);
        for (int s = 0; s < out.count; ++s) {
            EXPECT_NEAR(wanted[size_t(s)] / drawn[size_t(s)], 0.5, 0.005) << s;
            EXPECT_NEAR(found[size_t(s)] / wanted[size_t(s)], 1, left) << s;
        }
        // Half of that share, from one side of the curl to the other, and the slack of edges that it tilts.
        EXPECT_LT(largest_distance(cores_of(out), moved(cores_of(groom.rest), pose)), 0.1 * wide.radius);
    }
}

// Where the wet strand is shorter (a tighter curl), so is its way: each edge of the moved core is as much
// shorter as the strand's own.
TEST(Interpolation, rest_of_a_shorter_shape_scales_the_edges_of_the_moved_core) {
    const Groom groom = curly_groom({.lean = 0});  // strands of one length
    const Groom low = coarsened(groom, 2);
    const float part = 0.8f;
    auto shorter = [&](const Strands& strands) {
        Strands out = strands;
        for (int s = 0; s < out.count; ++s)
            for (int i = 0; i < out.particles; ++i)
                out.at(s, i) = strands.at(s, 0) + part * (strands.at(s, i) - strands.at(s, 0));
        return out;
    };
    const Strands shape = shorter(groom.rest), core = cores_of(groom.rest);
    const Stencil stencil = quad_stencil(groom, low);
    const Pose pose = some_pose(3);
    // Cores are linear in the strand, so all of it is shorter; 49 edges of 0.5 m are rounded to 3e-8 m.
    EXPECT_LT(largest_distance(
                  interpolated(Interpolation::rest, stencil, groom, moved(low.rest, pose), pose, &shape),
                  moved(shape, pose)),
              1e-6);
    // A sway in proportion to the particle is one of the core alike, and the detail turns but keeps its
    // length.
    const Vec3f sway{0.05f, 0, 0.02f};
    const Strands out = interpolated(Interpolation::rest, stencil, groom,
                                     swayed(low.rest, [&](int) { return sway; }), {}, &shape);
    const Strands moved_core = shorter(swayed(core, [&](int) { return sway; }));
    for (int s = 0; s < out.count; ++s)
        for (int i = 0; i < out.particles; ++i)
            EXPECT_NEAR(norm(out.at(s, i) - moved_core.at(s, i)),
                        part * norm(groom.rest.at(s, i) - core.at(s, i)), 2e-6)
                << s << " " << i;
}

// Wet strands are shorter already: those with a root of their own come back as they are.
TEST(Interpolation, rest_from_wet_strands_shortens_none_twice) {
    const Groom groom = curly_groom({});
    const Groom low = coarsened(groom, 2);
    const Stencil stencil = quad_stencil(groom, low);
    Strands shape = groom.rest, wet = low.rest;
    for (int s = 0; s < shape.count; ++s)
        for (int i = 1; i < shape.particles; ++i)
            shape.at(s, i) = shape.at(s, 0) + 0.8f * (shape.at(s, i) - shape.at(s, 0));
    for (int s = 0; s < wet.count; ++s)
        std::copy_n(shape.strand(stencil.twin[size_t(s)]), shape.particles, wet.strand(s));
    const Pose pose = some_pose(4);
    Strands in = moved(wet, pose);
    auto farthest = [&](bool low_is_wet) {
        Strands out;
        Interpolator(Interpolation::rest, stencil, groom, low, &shape, low_is_wet).apply(in, pose, out);
        double most = 0;
        for (int s = 0; s < in.count; ++s)
            for (int i = 0; i < in.particles; ++i)
                most = std::max(most, double(norm(out.at(stencil.twin[size_t(s)], i) - in.at(s, i))));
        return most;
    };
    EXPECT_LT(farthest(true), 2e-6);
    EXPECT_GT(farthest(false), 1e-2);
    // However they hang, detail and all.
    for (int s = 0; s < wet.count; ++s)
        for (int i = 1; i < wet.particles; ++i)
            wet.at(s, i) += Vec3f{0.01f * float(std::sin(0.9 * i + s)), 0, 1e-3f * float(i)};
    in = moved(wet, pose);
    EXPECT_LT(farthest(true), 2e-6);
}

// Dry strands, put where they would be, were they wet, are taken for wet ones there.
TEST(Interpolation, rest_from_settled_strands_is_rest_from_wet_ones_where_they_are) {
    const Groom groom = curly_groom({});
    const Groom low = coarsened(groom, 2);
    const Stencil stencil = quad_stencil(groom, low);
    const Pose pose = some_pose(5);
    Settled settled{std::vector<float>(size_t(low.rest.count)), Strands(low.rest.count, low.rest.particles)};
    Strands wet = low.rest;
    for (int s = 0; s < wet.count; ++s) {
        settled.share[size_t(s)] = 0.8f + 0.01f * float(s);
        for (int i = 1; i < wet.particles; ++i) {
            settled.more.at(s, i) = {2e-3f * float(std::sin(0.4 * i + s)), -1e-3f * float(i),
                                     1e-3f * float(s % 3)};
            wet.at(s, i) = wet.at(s, 0) + settled.share[size_t(s)] * (wet.at(s, i) - wet.at(s, 0)) +
                           settled.more.at(s, i);
        }
    }
    Strands from_dry, from_wet;
    Interpolator(Interpolation::rest, stencil, groom, low, nullptr, false, &settled)
        .apply(moved(low.rest, pose), pose, from_dry);
    Interpolator(Interpolation::rest, stencil, groom, low, nullptr, true)
        .apply(moved(wet, pose), pose, from_wet);
    EXPECT_LT(largest_distance(from_dry, from_wet), 2e-6);
    EXPECT_GT(largest_distance(from_dry, moved(groom.rest, pose)), 1e-2);
    settled.more.count = 3;
    expect_error([&] { Interpolator(Interpolation::rest, stencil, groom, low, nullptr, false, &settled); },
                 {"3 strands", "settled", "all low-resolution 16"});
}

// At rest they are where wet ones are; those near go with the dry strand, those far by no means.
TEST(Settled, strands_that_fall_to_another_side_move_less_with_the_dry_ones) {
    Strands dry(3, 5), wet(3, 5);
    for (int s = 0; s < 3; ++s)
        for (int i = 0; i < 5; ++i) dry.at(s, i) = wet.at(s, i) = {0, -0.05f * float(i), 0};
    for (int i = 1; i < 5; ++i) {
        wet.at(0, i).x += 1e-3f;                  // 0.005 of the length
        wet.at(1, i).x += 0.025f;                 // 0.11
        wet.at(2, i) = {0.05f * float(i), 0, 0};  // to the side
    }
    const Settled settled = settled_between(dry, wet);
    EXPECT_EQ(settled.share[0], 1);
    EXPECT_NEAR(settled.share[1], (0.2 - 0.025 * std::sqrt(0.8) / arc_length(wet.strand(1), 5)) / 0.15, 1e-5);
    EXPECT_EQ(settled.share[2], 0);
    for (int s = 0; s < 3; ++s)
        for (int i = 0; i < 5; ++i)
            EXPECT_LT(norm(settled.share[size_t(s)] * dry.at(s, i) + settled.more.at(s, i) - wet.at(s, i)),
                      1e-7);
}

TEST(Interpolation, a_shape_of_other_strands_is_an_error) {
    const Groom groom = curly_groom({});
    const Groom low = coarsened(groom, 2);
    expect_error([&] { Interpolator(Interpolation::rest, quad_stencil(groom, low), groom, low, &low.rest); },
                 {"shape at rest", "16 strands", "all 64"});
}

// Between a hanging curl and the same turned by 80 degrees.
TEST(Interpolation, detail_turns_with_the_core) {
    Groom high = curly_groom({.width = 3, .height = 1, .phase_spread = 0, .lean = 0});
    const int n = high.rest.particles;
    const Quatf turn = cast<float>(rotation_about({0, 0, 1}, 80 * std::numbers::pi / 180));
    for (int i = 0; i < n; ++i) {
        const Vec3f root = high.rest.at(2, 0);
        high.rest.at(2, i) = root + rotate(turn, high.rest.at(2, i) - root);
    }
    const Groom low = coarsened(high, 2);
    const Strands out = interpolated(Interpolation::core, quad_stencil(high, low), high, low.rest);
    Strands core(2, n);
    for (int s = 0; s < 2; ++s) core_of(low.rest.strand(s), n, core_beta(n), core.strand(s));
    double along = 0;
    for (int i = 1; i + 1 < n; ++i) {
        auto mean = [&](int k) {
            return high.rest.at(1, 0) +
                   0.5f * (core.at(0, k) - core.at(0, 0) + core.at(1, k) - core.at(1, 0));
        };
        const Vec3f from = core.at(0, i + 1) - core.at(0, i), to = mean(i + 1) - mean(i);
        const Vec3f detail = low.rest.at(0, i) - core.at(0, i), turned = out.at(1, i) - mean(i);
        EXPECT_NEAR(norm(turned), norm(detail), 1e-6);
        EXPECT_NEAR(dot(turned, to) / norm(to), dot(detail, from) / norm(from), 1e-6);
        along = std::max(along, double(std::abs(dot(detail, to) / norm(to))));
    }
    EXPECT_GT(along, 0.003);  // unturned, it would lean into the core
}

TEST(Interpolation, unknown_names_are_a_misuse) {
    expect_error<Misuse>([] { interpolation_named("quat"); },
                         {"'quat'", "nearest, quad, core, rest, skin", "did you mean 'quad'"});
}

}  // namespace
}  // namespace wetcurl::testing

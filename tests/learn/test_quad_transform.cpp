// Eq 18 and 19 in paper mode, and by core and detail.
#include "learn/codec/core_detail.h"
#include "learn/codec/quad_transform.h"
#include "tests/learn/hair.h"

namespace wetcurl::testing {
namespace {

constexpr float reach = 0.02f;
constexpr Reconstruction forms[] = {Reconstruction::paper, Reconstruction::core};

struct Case {
    Groom high, low;
    std::vector<Vec3f> colours;  // one a high-resolution strand

    explicit Case(const Curls& curls = {}) : high(curly_groom(curls)), low(coarsened(high, 2)) {
        Random random(9);
        for (int s = 0; s < high.rest.count; ++s) colours.push_back(cast<float>(random.vector()));
    }
    Strands transformed(Reconstruction form, float saturation, const Strands& strands, const Pose& head = {},
                        bool triangles = false, float gain = 1, ShiftUnits units = ShiftUnits::length) const {
        QuadTransform transform(form, triangles ? triangle_stencil(high, low) : quad_stencil(high, low), high,
                                low, std::vector<float>(low.rest.points.size(), saturation), reach, gain,
                                units);
        Strands out;
        transform.apply(strands, head, colours, out);
        return out;
    }
    Strands plain(Reconstruction form, bool triangles = false) const {
        Strands out;
        Interpolator(form == Reconstruction::paper ? Interpolation::quad : Interpolation::core,
                     triangles ? triangle_stencil(high, low) : quad_stencil(high, low), high, low)
            .apply(low.rest, Pose{}, out);
        return out;
    }
};

TEST(QuadTransform, equal_strands_and_equal_colours_give_a_copy) {
    Curls curls;
    curls.phase_spread = 0;
    Case c(curls);
    c.colours.assign(c.colours.size(), {0.3f, 0.4f, 0.5f});
    for (Reconstruction form : forms)
        for (bool triangles : {false, true})
            EXPECT_LT(largest_distance(c.transformed(form, 1, c.low.rest, {}, triangles), c.high.rest), 5e-7);
}

TEST(QuadTransform, dry_hair_is_the_interpolation_and_wet_hair_is_not) {
    const Case c;
    for (Reconstruction form : forms)
        for (bool triangles : {false, true}) {
            EXPECT_EQ(
                largest_distance(c.transformed(form, 0, c.low.rest, {}, triangles), c.plain(form, triangles)),
                0);
            EXPECT_GT(
                largest_distance(c.transformed(form, 1, c.low.rest, {}, triangles), c.plain(form, triangles)),
                1e-4);
        }
}

TEST(QuadTransform, shift_is_proportional_to_the_gain_and_roots_are_exact) {
    const Case c;
    const Strands plain = c.plain(Reconstruction::core);
    const Strands once = c.transformed(Reconstruction::core, 1, c.low.rest);
    const Strands twice = c.transformed(Reconstruction::core, 1, c.low.rest, {}, false, 2);
    for (size_t k = 0; k < plain.points.size(); ++k)
        EXPECT_LT(norm((twice.points[k] - plain.points[k]) - 2.0f * (once.points[k] - plain.points[k])),
                  2e-7);
    for (int s = 0; s < plain.count; ++s) EXPECT_EQ(norm(once.at(s, 0) - c.high.rest.at(s, 0)), 0);
}

TEST(QuadTransform, gain_of_0_is_the_interpolation_bit_for_bit) {
    const Case c;
    for (Reconstruction form : forms)
        for (bool triangles : {false, true})
            for (ShiftUnits units : {ShiftUnits::length, ShiftUnits::printed}) {
                const Strands none = c.transformed(form, 1, c.low.rest, {}, triangles, 0, units);
                EXPECT_EQ(largest_distance(none, c.plain(form, triangles)), 0);
                EXPECT_GT(largest_distance(c.transformed(form, 1, c.low.rest, {}, triangles, 1, units), none),
                          1e-4);
            }
}

// The whole of a hair twice as large, its support radius too.
TEST(QuadTransform, shift_doubles_with_all_lengths_unless_it_is_as_printed) {
    const Case c;
    Case large = c;
    for (Groom* groom : {&large.high, &large.low})
        for (Vec3f& p : groom->rest.points) p = 2.0f * p;
    auto shifts = [](const Case& hair, float h, ShiftUnits units) {
        QuadTransform transform(Reconstruction::paper, quad_stencil(hair.high, hair.low), hair.high, hair.low,
                                std::vector<float>(hair.low.rest.points.size(), 1), h, 1, units);
        Strands before, after;
        transform.interpolate(hair.low.rest, Pose{}, before);
        transform.apply(hair.low.rest, Pose{}, hair.colours, after);
        for (size_t k = 0; k < after.points.size(); ++k) after.points[k] -= before.points[k];
        return after.points;
    };
    // A gradient of the kernel [1/m^4] falls to a sixteenth, and so does the shift as printed.
    for (const auto& [units, factor] :
         {std::pair{ShiftUnits::length, 2.0f}, std::pair{ShiftUnits::printed, 1.0f / 16}}) {
        const auto once = shifts(c, reach, units), twice = shifts(large, 2 * reach, units);
        float most = 0, wrong = 0;
        for (size_t k = 0; k < once.size(); ++k) {
            most = std::max(most, norm(once[k]));
            wrong = std::max(wrong, norm(twice[k] - factor * once[k]));
        }
        ASSERT_GT(most, 1e-4);
        EXPECT_LT(wrong, 1e-3f * factor * most);  // positions of 0.3 m are rounded to 3e-8
    }
}

TEST(QuadTransform, as_printed_is_a_gain_of_one_over_the_radius_to_the_fifth) {
    const Case c;
    const Strands printed =
        c.transformed(Reconstruction::paper, 1, c.low.rest, {}, false, 1, ShiftUnits::printed);
    const Strands gained = c.transformed(Reconstruction::paper, 1, c.low.rest, {}, false,
                                         1 / (reach * reach * reach * reach * reach));
    const double far = largest_distance(printed, c.plain(Reconstruction::paper));
    EXPECT_GT(far, 1e4);  // [m]: in SI units nothing stays in sight
    EXPECT_LT(largest_distance(printed, gained), 1e-5 * far);
}

TEST(QuadTransform, follows_the_head) {
    const Case c;
    const Pose pose = some_pose(11);
    for (Reconstruction form : forms)
        for (bool triangles : {false, true})
            EXPECT_LT(largest_distance(moved(c.transformed(form, 1, c.low.rest, {}, triangles), pose),
                                       c.transformed(form, 1, moved(c.low.rest, pose), pose, triangles)),
                      3e-6);
}

// One new strand halfway between two straight ones, of which one has another colour: Eq 18 by hand.
TEST(QuadTransform, shift_is_that_of_eq_18) {
    Groom high;
    high.grid = {3, 1, {0, 1, 2}};
    high.rest = Strands(3, 3);
    for (int s = 0; s < 3; ++s) {
        for (int i = 0; i < 3; ++i) high.rest.at(s, i) = {0.01f * float(s), -0.01f * float(i), 0};
        high.normal.push_back({0, 1, 0});
    }
    const Groom low = coarsened(high, 2);
    QuadTransform transform(Reconstruction::paper, quad_stencil(high, low), high, low,
                            std::vector<float>(6, 0.5f), reach);
    Strands out;
    transform.apply(low.rest, Pose{}, {{0, 0, 0}, {0.6f, 0, 0}, {0.6f, 0, 0}}, out);
    // N = 2, gamma = 0.6 / 2 for the left one, 0 for the right; r = h/2, where W' = -3/2 W(0)/h; toward the
    // left.
    const double w0 = 8 / (std::numbers::pi * std::pow(reach, 3));
    const double shift = reach * std::pow(reach, 4) * 0.5 * (1.5 * w0 / reach) * 0.3 / 2;
    ASSERT_GT(shift, 1e-3);
    EXPECT_NEAR(out.at(1, 2).x, 0.01 - shift, 1e-6);
    EXPECT_NEAR(out.at(1, 2).y, -0.02, 1e-7);
    EXPECT_NEAR(out.at(0, 2).x, 0, 1e-7);
}

TEST(QuadTransform, form_v_keeps_the_curl_of_random_phases_and_paper_mode_does_not) {
    Curls curls;
    curls.width = curls.height = 32;
    curls.spacing = 0.002;
    curls.lean = 0;
    Case c(curls);
    c.colours.assign(c.colours.size(), {0, 0, 0});
    for (bool triangles : {false, true}) {
        double radius[2] = {0, 0};
        int inner = 0;
        for (Reconstruction form : forms) {
            const auto radii = curl_radii(c.transformed(form, 1, c.low.rest, {}, triangles));
            for (int row = 1; row + 1 < 32; row += 2)
                for (int column = 1; column + 1 < 32; column += 2, ++inner)
                    radius[int(form)] += radii[size_t(c.high.grid.at(column, row))];
        }
        inner /= 2;
        EXPECT_GT(radius[1] / inner / curls.radius, 0.9);
        // Four random phases keep 0.45; of three roots two carry an odd pixel of a square grid, which keep
        // 2/pi = 0.64.
        EXPECT_NEAR(radius[0] / inner / curls.radius, triangles ? 0.64 : 0.45, triangles ? 0.06 : 0.03);
    }
}

TEST(QuadTransform, wrong_sizes_are_errors) {
    const Case c;
    expect_error(
        [&] {
            QuadTransform(Reconstruction::core, quad_stencil(c.high, c.low), c.high, c.low, {1, 1}, reach);
        },
        {"found 2 saturations"});
    expect_error([&] { c.transformed(Reconstruction::core, 1, c.low.rest, {}, false, -1); },
                 {"gain must be 0 or more"});
    expect_error<Misuse>([] { reconstruction_named("cores"); }, {"'cores'", "allowed paper, core"});
    expect_error<Misuse>([] { shift_units_named("lengths"); }, {"'lengths'", "allowed length, printed"});
}

}  // namespace
}  // namespace wetcurl::testing

// The kernel, the amplitudes of a strand, root frames, the root codec and its images.
#include <array>
#include <numeric>

#include "base/geometry/kernels.h"
#include "learn/codec/core_detail.h"
#include "learn/codec/dct.h"
#include "learn/codec/edge_lengths.h"
#include "learn/codec/root_codec.h"
#include "learn/codec/root_frame.h"
#include "tests/learn/hair.h"

namespace wetcurl::testing {
namespace {

TEST(Kernel, integrates_to_one_and_vanishes_at_its_support) {
    for (double h : {0.004, 0.5}) {
        const int n = 2000;
        double sum = 0;
        for (int k = 0; k < n; ++k) {
            const double r = (k + 0.5) * h / n;
            sum += kernel(r, h) * 4 * std::numbers::pi * r * r * h / n;
        }
        EXPECT_NEAR(sum, 1, 1e-5);       // midpoint rule, 2,000 intervals
        EXPECT_LE(kernel(h, h), 1e-40);  // the cube of a rounding error
        EXPECT_EQ(kernel(2 * h, h), 0);
        EXPECT_DOUBLE_EQ(kernel(0.0, h), kernel_at_zero(h));
    }
}

TEST(Kernel, gradient_is_the_difference_of_its_values) {
    const double h = 0.01, step = 1e-8;
    Random random(3);
    for (int trial = 0; trial < 50; ++trial) {
        const Vec3d x = random.number(0.05, 0.95) * h * random.direction();
        const Vec3d g = kernel_gradient(x, h);
        ASSERT_GT(norm(g), 1e-4 * kernel_at_zero(h) / h);
        const std::array<std::pair<Vec3d, double>, 3> axes{
            {{{step, 0, 0}, g.x}, {{0, step, 0}, g.y}, {{0, 0, step}, g.z}}};
        for (const auto& [d, expected] : axes)
            EXPECT_NEAR((kernel(norm(x + d), h) - kernel(norm(x - d), h)) / (2 * step), expected,
                        1e-5 * kernel_at_zero(h) / h);
    }
    EXPECT_EQ(norm(kernel_gradient(Vec3d{0, 0, 0}, h)), 0);
}

// A helix whose radius was averaged away by a fifth: its edges come back, itself stays where it was.
TEST(EdgeLengths, are_led_back_and_leave_the_core) {
    const int n = 64;
    auto helix = [&](float radius) {
        std::vector<Vec3f> x(n);
        for (int i = 0; i < n; ++i)
            x[size_t(i)] = {radius * (std::cos(0.6f * float(i)) - 1), -1e-3f * float(i),
                            radius * std::sin(0.6f * float(i))};
        return x;
    };
    const std::vector<Vec3f> rest = helix(5e-3f);
    std::vector<float> length(n, 0);
    for (size_t i = 1; i < n; ++i) length[i] = norm(rest[i] - rest[i - 1]);
    auto lacking = [&](const std::vector<Vec3f>& x) {
        double sum = 0;
        for (size_t i = 1; i < n; ++i) sum += std::abs(norm(x[i] - x[i - 1]) / length[i] - 1);
        return sum / (n - 1);
    };
    std::vector<Vec3f> x = helix(4e-3f);
    const std::vector<Vec3f> flat = x;
    const double before = lacking(x);
    EXPECT_GT(before, 0.15);
    lead_to_lengths(n, length.data(), 0, x.data());
    EXPECT_EQ(lacking(x), before);
    std::vector<Vec3f> once = x;
    lead_to_lengths(n, length.data(), 1, once.data());
    EXPECT_LT(lacking(once), 0.99 * before);
    lead_to_lengths(n, length.data(), most_length_rounds, x.data());
    EXPECT_LT(lacking(x), 0.8 * before);
    for (int k = 1; k < most_length_rounds; ++k) lead_to_lengths(n, length.data(), 1, once.data());
    for (size_t i = 0; i < n; ++i) EXPECT_EQ(norm(x[i] - once[i]), 0);
    EXPECT_EQ(norm(x[0] - flat[0]), 0);
    Vec3f drift{0, 0, 0};
    for (size_t i = 1; i < n; ++i) drift += x[i] - flat[i];
    EXPECT_LT(norm((1.f / n) * drift), 2e-5);  // of 1e-3 in which the helix rises an edge
    EXPECT_GT(norm(x[20] - flat[20]), 5e-5);   // outwards
    EXPECT_GT(norm(Vec3f{x[20].x + 4e-3f, 0, x[20].z}), 4.05e-3);

    // What has its lengths stays, and no length is no direction.
    x = rest;
    lead_to_lengths(n, length.data(), most_length_rounds, x.data());
    for (size_t i = 0; i < n; ++i) EXPECT_LT(norm(x[i] - rest[i]), 1e-8);
    std::vector<Vec3f> knot(n, Vec3f{1, 2, 3});
    lead_to_lengths(n, length.data(), most_length_rounds, knot.data());
    for (const Vec3f& p : knot) EXPECT_EQ(norm(p - Vec3f{1, 2, 3}), 0);
    Vec3f alone{1, 2, 3};
    lead_to_lengths(1, length.data(), most_length_rounds, &alone);
    EXPECT_EQ(norm(alone - Vec3f{1, 2, 3}), 0);
}

// Of particle i of n, as the trapezoid rule has it over a length of 1.
double trapezoid_weight(int i, int n) { return (i == 0 || i == n - 1 ? 0.5 : 1.0) / (n - 1); }

TEST(StrandDct, basis_is_orthonormal_under_trapezoid_weights) {
    for (int n : {2, 7, dct_kept, dct_kept + 1, 50, 100}) {
        const StrandDct dct(n);
        ASSERT_EQ(dct.basis().size(), size_t(dct_kept) * n);
        for (int a = 0; a < dct_kept; ++a)
            for (int b = 0; b < dct_kept; ++b) {
                double product = 0;
                for (int i = 0; i < n; ++i)
                    product += trapezoid_weight(i, n) * dct.basis()[size_t(a) * n + i] *
                               dct.basis()[size_t(b) * n + i];
                // Functions beyond the particles do not exist; the others are stored in single precision.
                EXPECT_NEAR(product, a == b && a < n, 1e-6) << n << " particles, " << a << ", " << b;
            }
    }
}

std::vector<Vec3f> offsets_of(const Strands& strands, int s) {
    std::vector<Vec3f> out;
    for (int i = 0; i < strands.particles; ++i) out.push_back(strands.at(s, i) - strands.at(s, 0));
    return out;
}

TEST(StrandDct, root_is_exact_and_coding_twice_changes_nothing) {
    const Groom groom = curly_groom({});
    const StrandDct dct(groom.rest.particles);
    const auto x = offsets_of(groom.rest, 3);
    float once[strand_coefficients], twice[strand_coefficients];
    std::vector<Vec3f> y(x.size());
    dct.encode(x.data(), once);
    dct.decode(once, y.data());
    EXPECT_EQ(norm(y[0]), 0);
    ASSERT_GT(norm(y.back()), 0.1);
    dct.encode(y.data(), twice);
    for (int k = 0; k < strand_coefficients; ++k) EXPECT_NEAR(twice[k], once[k], 1e-6);
}

TEST(StrandDct, amplitudes_do_not_depend_on_the_particle_count) {
    // Helices of one shape, sampled twice.
    Curls coarse, fine;
    coarse.particles = 50, fine.particles = 100;
    const Groom a = curly_groom(coarse), b = curly_groom(fine);
    // To amplitude k the trapezoid rule adds those at 2 (n - 1) m +- k: for k < 24 and n = 50 from 75 on,
    // where amplitude j of a helix of five turns is sqrt(2) (x'(0) -+ x'(1)) / (pi j)^2. Slopes are at most
    // 0.25 and 0.37 m here, and all of those together less than 0.05 mm. The exact root at most doubles that.
    const double tolerance = 2 * 5e-5;
    double largest = 0;
    for (int s = 0; s < a.rest.count; ++s) {
        float few[strand_coefficients], many[strand_coefficients];
        StrandDct(coarse.particles).encode(offsets_of(a.rest, s).data(), few);
        StrandDct(fine.particles).encode(offsets_of(b.rest, s).data(), many);
        for (int k = 0; k < strand_coefficients; ++k) {
            EXPECT_NEAR(few[k], many[k], tolerance) << "strand " << s << ", channel " << k;
            largest = std::max(largest, double(std::abs(few[k])));
        }
    }
    EXPECT_GT(largest, 0.05);  // a line of 0.2 m: 2 sqrt(2) / pi^2 of it
}

TEST(StrandDct, what_it_leaves_is_orthogonal_to_every_kept_curve_from_the_root) {
    // So that no other such curve is nearer.
    for (int n : {30, 50}) {
        const StrandDct dct(n);
        Random random(8);
        std::vector<Vec3f> x{{0, 0, 0}}, y(static_cast<size_t>(n));
        while (int(x.size()) < n) x.push_back(cast<float>(random.vector()));
        float c[strand_coefficients];
        dct.encode(x.data(), c);
        dct.decode(c, y.data());
        double left = 0;
        for (int k = 1; k < dct_kept; ++k) {
            const float* b = dct.basis().data() + size_t(k) * n;
            Vec3d product{0, 0, 0};
            for (int i = 0; i < n; ++i) {
                const Vec3d rest = cast<double>(x[size_t(i)] - y[size_t(i)]);
                product += trapezoid_weight(i, n) * double(b[i] - b[0]) * rest;
                left = std::max(left, norm(rest));
            }
            EXPECT_LT(norm(product), 2e-6) << n << " particles, " << k;  // sums of single precision
        }
        EXPECT_GT(left, 0.1);
    }
}

TEST(StrandDct, strands_of_no_more_particles_than_amplitudes_are_exact) {
    for (int n : {2, 5, 16, dct_kept}) {
        const StrandDct dct(n);
        Random random(4);
        std::vector<Vec3f> x{{0, 0, 0}}, y(static_cast<size_t>(n));
        while (int(x.size()) < n) x.push_back(cast<float>(random.vector()));
        float c[strand_coefficients];
        dct.encode(x.data(), c);
        dct.decode(c, y.data());
        for (int i = 0; i < n; ++i) EXPECT_LT(norm(y[size_t(i)] - x[size_t(i)]), 2e-6);
    }
}

// What 24 amplitudes an axis cost on helices of 8 mm radius and 200 mm length. A turn is two of them: twelve
// turns are past the last one.
TEST(StrandDct, floor_on_helices_stays_under_a_millimetre_up_to_nine_turns) {
    for (double turns : {2.0, 6.0, 9.0, 12.0}) {
        Curls curls;
        curls.turns = turns;
        const Groom groom = curly_groom(curls);
        const StrandDct dct(groom.rest.particles);
        double sum = 0;
        for (int s = 0; s < groom.rest.count; ++s) {
            const auto x = offsets_of(groom.rest, s);
            std::vector<Vec3f> y(x.size());
            float c[strand_coefficients];
            dct.encode(x.data(), c);
            dct.decode(c, y.data());
            for (size_t i = 0; i < x.size(); ++i) sum += norm(y[i] - x[i]);
        }
        const double floor_mm = 1e3 * sum / double(groom.rest.points.size());
        RecordProperty("floor_mm_at_" + std::to_string(int(turns)) + "_turns", std::to_string(floor_mm));
        EXPECT_GT(floor_mm, 0.01) << turns << " turns";  // it does cost something
        if (turns <= 6)
            EXPECT_LT(floor_mm, 0.5) << turns << " turns";
        else if (turns <= 9)
            EXPECT_LT(floor_mm, 1.0) << turns << " turns";
        else
            EXPECT_GT(floor_mm, 0.5 * 1e3 * curls.radius) << turns << " turns";  // the curl is lost
    }
}

TEST(StrandDct, one_particle_is_an_error) {
    expect_error([] { StrandDct dct(1); }, {"found 1 particles", "allowed 2 or more"});
}

TEST(RootFrame, is_the_normal_and_the_strands_direction) {
    const Groom groom = curly_groom({});
    const RootFrames frames = root_frames(groom);
    for (int s = 0; s < groom.rest.count; ++s) {
        const Quatf q = frames.rotation[size_t(s)];
        const Vec3f along = groom.rest.at(s, groom.rest.particles - 1) - groom.rest.at(s, 0);
        EXPECT_LT(norm(rotate(q, Vec3f{0, 1, 0}) - groom.normal[size_t(s)]), 1e-5);
        EXPECT_NEAR(dot(rotate(q, Vec3f{0, 0, 1}), along), 0, 1e-6);
        EXPECT_GT(dot(rotate(q, Vec3f{1, 0, 0}), along), 0);
    }
}

TEST(RootFrame, offsets_in_it_do_not_know_the_heads_pose) {
    const Groom groom = curly_groom({});
    const RootFrames frames = root_frames(groom);
    const Pose pose = some_pose(5);
    const Strands turned = moved(groom.rest, pose);
    ASSERT_GT(largest_distance(turned, groom.rest), 0.1);
    for (int s = 0; s < groom.rest.count; ++s) {
        EXPECT_LT(norm(frames.root_at(s, pose) - turned.at(s, 0)), 1e-6);
        const Vec3f still =
            rotate(conjugate(frames.rotation_at(s, Pose{})), groom.rest.at(s, 20) - groom.rest.at(s, 0));
        const Vec3f in_motion =
            rotate(conjugate(frames.rotation_at(s, pose)), turned.at(s, 20) - turned.at(s, 0));
        EXPECT_LT(norm(still - in_motion), 1e-6);
    }
}

TEST(RootFrame, a_strand_along_its_normal_still_has_one) {
    Groom groom;
    groom.rest = Strands(1, 4);
    for (int i = 0; i < 4; ++i) groom.rest.at(0, i) = {0, 0, 0.01f * float(i)};
    groom.normal = {{0, 0, 1}};
    const Quatf q = root_frames(groom).rotation[0];
    EXPECT_LT(norm(rotate(q, Vec3f{0, 1, 0}) - Vec3f{0, 0, 1}), 1e-6);
}

TEST(CoreAndDetail, core_of_a_straight_strand_is_the_strand) {
    std::vector<Vec3f> p, core(30);
    for (int i = 0; i < 30; ++i) p.push_back({0.003f * float(i), 0.1f, -0.005f * float(i)});
    core_of(p.data(), 30, core_beta(30), core.data());
    for (int i = 0; i < 30; ++i) EXPECT_LT(norm(core[size_t(i)] - p[size_t(i)]), 1e-7);
}

TEST(CoreAndDetail, mean_curl_radius_is_the_helixs) {
    for (double turns : {4.0, 6.0, 8.0})
        for (double radius : {0.003, 0.01}) {
            Curls curls;
            curls.turns = turns;
            curls.radius = radius;
            curls.lean = 0;
            const auto radii = curl_radii(curly_groom(curls).rest);
            // 4 %: what the filter leaves of four turns in the core; its ends add up to 15 % to single
            // strands, by their phase.
            EXPECT_NEAR(std::accumulate(radii.begin(), radii.end(), 0.0) / double(radii.size()) / radius, 1,
                        0.04)
                << turns;
        }
}

TEST(RootCodec, colours_go_there_and_back) {
    const Strands strands = curly_groom({}).rest;
    ColourBox box;
    grow(box, strands.points);
    ASSERT_GT(box.diagonal(), 0.1);
    for (const Vec3f& p : strands.points) {
        const Vec3f c = colour_of(p, box);
        EXPECT_LE(std::max({c.x, c.y, c.z}), 1);
        EXPECT_GE(std::min({c.x, c.y, c.z}), 0);
        EXPECT_LT(norm(position_of(c, box) - p), 1e-7);  // an ulp of 0.3 m is 3e-8
    }
}

TEST(RootCodec, one_scale_serves_all_axes) {
    const ColourBox box{{0, 0, 0}, {1, 2, 4}};
    const Vec3f a = colour_of({0.5f, 0, 0}, box), b = colour_of({0, 0.5f, 0}, box);
    EXPECT_FLOAT_EQ(a.x, b.y);
    EXPECT_FLOAT_EQ(a.x, float(0.5 / std::sqrt(21.0)));
}

constexpr float reach = 0.012f;

double largest_shift(const Strands& strands, const std::vector<Vec3f>& shifted) {
    double most = 0;
    for (int s = 0; s < strands.count; ++s)
        most = std::max(most, double(norm(shifted[size_t(s)] - strands.at(s, 0))));
    return most;
}

TEST(RootCodec, dry_roots_stay_and_wet_ones_move_toward_their_neighbours) {
    const Strands strands = curly_groom({}).rest;
    const std::vector<float> dry(strands.points.size(), 0), wet(strands.points.size(), 1);
    EXPECT_EQ(largest_shift(strands, shifted_roots(strands, {}, reach)), 0);
    EXPECT_EQ(largest_shift(strands, shifted_roots(strands, dry, reach)), 0);
    EXPECT_GT(largest_shift(strands, shifted_roots(strands, wet, reach)), 1e-3);

    Strands two(2, 2);
    two.points = {{0, 0, 0}, {0, -1, 0}, {0.006f, 0, 0}, {0.006f, -1, 0}};
    const auto shifted = shifted_roots(two, {1, 1, 1, 1}, reach);
    EXPECT_GT(shifted[0].x, 1e-4f);
    EXPECT_FLOAT_EQ(shifted[0].x, 0.006f - shifted[1].x);
    // h^2 grad W / (W(0) + W) at half the support: W = W(0)/4, W' = -3/2 W(0)/h.
    EXPECT_NEAR(shifted[0].x, reach * 1.5 / 1.25, 1e-6);
}

TEST(RootCodec, an_empty_neighbourhood_and_one_at_the_rim_leave_the_root) {
    Strands two(2, 2);
    for (float apart : {2 * reach, 0.9999f * reach}) {
        two.points = {{0, 0, 0}, {0, -1, 0}, {apart, 0, 0}, {apart, -1, 0}};
        const auto shifted = shifted_roots(two, {1, 1, 1, 1}, reach);
        EXPECT_LT(largest_shift(two, shifted), 1e-9);
    }
}

TEST(RootCodec, doubling_the_units_doubles_the_shift) {
    const Strands strands = curly_groom({}).rest;
    Strands large = strands;
    for (Vec3f& p : large.points) p = 2.0f * p;
    const std::vector<float> wet(strands.points.size(), 0.7f);
    const auto a = shifted_roots(strands, wet, reach), b = shifted_roots(large, wet, 2 * reach);
    ASSERT_GT(largest_shift(strands, a), 1e-3);
    for (int s = 0; s < strands.count; ++s) {
        const Vec3f da = a[size_t(s)] - strands.at(s, 0), db = b[size_t(s)] - large.at(s, 0);
        EXPECT_LT(norm(db - 2.0f * da), 1e-6);
    }
}

// Eq 16 without h^2: the sums alone, whose shift is no length.
TEST(RootCodec, as_printed_the_shift_lacks_the_square_of_the_radius) {
    const Strands strands = curly_groom({}).rest;
    const std::vector<float> wet(strands.points.size(), 0.7f);
    const auto read = shifted_roots(strands, wet, reach),
               printed = shifted_roots(strands, wet, reach, ShiftUnits::printed);
    ASSERT_GT(largest_shift(strands, printed), 1);  // [m]
    for (int s = 0; s < strands.count; ++s) {
        const Vec3f root = strands.at(s, 0);
        EXPECT_LT(norm(reach * reach * (printed[size_t(s)] - root) - (read[size_t(s)] - root)), 1e-7);
    }
}

TEST(RootCodec, a_strands_saturation_is_its_length_weighted_mean) {
    Strands one(1, 3);
    one.points = {{0, 0, 0}, {1, 0, 0}, {4, 0, 0}};
    EXPECT_FLOAT_EQ(strand_saturation(one, {0, 0, 1})[0], 0.5f * 3 / 4);
}

TEST(RootImage, is_padded_to_32_and_gives_back_every_colour) {
    RootGrid grid{40, 3, std::vector<int>(120, -1)};
    int strands = 0;
    for (size_t pixel = 0; pixel < 120; ++pixel)
        if (pixel % 5 != 2) grid.strand[pixel] = strands++;
    std::vector<Vec3f> colours;
    for (int s = 0; s < strands; ++s) colours.push_back({float(s), 1, 0.5f * float(s)});
    const RootImage image(grid);
    EXPECT_EQ(image.width(), 64);
    EXPECT_EQ(image.height(), 32);
    std::vector<float> pixels(3 * image.pixels(), -1);
    image.draw(colours, pixels.data());
    const auto back = image.read(pixels.data());
    ASSERT_EQ(back.size(), colours.size());
    for (size_t s = 0; s < back.size(); ++s) EXPECT_EQ(norm(back[s] - colours[s]), 0);
    const auto mask = image.mask();
    EXPECT_EQ(std::count(mask.begin(), mask.end(), 1), strands);
    EXPECT_EQ(*std::min_element(pixels.begin(), pixels.end()), 0);  // nothing was left undrawn
    EXPECT_EQ(pixels[size_t(31) * 64 + 63],
              colours[size_t(grid.at(39, 2))].x);  // the padding repeats the edge
}

TEST(RootImage, of_twice_the_low_resolution_holds_odd_grids) {
    const RootGrid grid{63, 65, std::vector<int>(63 * 65, 0)};
    const RootImage image(grid, 2);
    EXPECT_EQ(image.width(), 64);
    EXPECT_EQ(image.height(), 128);
    expect_error([] { RootImage(RootGrid{4, 4, std::vector<int>(16, -1)}); }, {"holds no strand"});
}

}  // namespace
}  // namespace wetcurl::testing

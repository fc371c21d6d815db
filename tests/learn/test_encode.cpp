// Runs to pairs files and back; the features that training and inference see.
#include "learn/codec/encode_runs.h"
#include "learn/codec/interpolate.h"
#include "learn/codec/root_codec.h"
#include "learn/codec/strand_codec.h"
#include "tests/learn/hair.h"

namespace wetcurl::testing {
namespace {

constexpr int frames = 5;

std::vector<float> tip_wetness(const Groom& groom) {
    std::vector<float> out;
    for (int s = 0; s < groom.rest.count; ++s)
        for (int i = 0; i < groom.rest.particles; ++i)
            out.push_back(float(i) / float(groom.rest.particles - 1));
    return out;
}

// A dry low-resolution run that sways, and a wet one that is shorter as well.
struct Runs {
    Scratch scratch;
    Groom high = curly_groom({}), low = coarsened(high, 2);
    std::vector<float> saturation = tip_wetness(high);
    std::string dry = scratch.path("dry.h5"), wet = scratch.path("wet.h5"), pairs = scratch.path("pairs.h5");

    Runs() {
        write_run(dry, low, 2, frames, {}, [](int, int i, int f) { return Vec3d{2e-4 * i * f, 0, 0}; });
        write_run(wet, high, 1, frames, saturation, [](int, int i, int f) {
            return Vec3d{2e-4 * i * f, 1e-3 * i, 0};
        });
    }
    double encode() {
        PairsWriter out(pairs, Codec::strand, high.rest.particles, true);
        const double floor_mm = encode_strands(RunPair(dry, wet), out);
        out.commit();
        return floor_mm;
    }
};

double mean_distance(const Strands& a, const Strands& b) {
    double sum = 0;
    for (size_t k = 0; k < a.points.size(); ++k) sum += norm(a.points[k] - b.points[k]);
    return sum / double(a.points.size());
}

// One frame of strands that sway, and of the same hair shrunk by the water, at a head pose.
struct WetFrame {
    Groom high = curly_groom({}), low = coarsened(high, 2);
    HeadWindow heads;
    Strands dry, wet;

    explicit WetFrame(unsigned seed) {
        heads.now = some_pose(seed);
        dry = low.rest, wet = high.rest;
        for (Strands* strands : {&dry, &wet})
            for (int s = 0; s < strands->count; ++s)
                for (int i = 0; i < strands->particles; ++i)
                    strands->at(s, i) += Vec3f{1e-3f * float(i), strands == &wet ? 1e-3f * float(i) : 0, 0};
        dry = moved(dry, heads.now), wet = moved(wet, heads.now);
    }
};

// What is to be learned for `wet`, the frame being taken up.
std::vector<float> target_of(const StrandCodec& codec, const std::vector<float>& dynamic, const Strands& wet,
                             const Pose& head) {
    std::vector<float> target(strand_coefficients * codec.pixels());
    codec.encode(wet, head, target.data());
    for (size_t k = 0; k < target.size(); ++k) target[k] -= dynamic[k];
    return target;
}

TEST(StrandCodec, base_and_decoded_target_are_the_wet_strands) {
    const WetFrame frame(2);
    StrandCodec codec(frame.high, frame.low, {});
    std::vector<float> dynamic(dynamic_channels * codec.pixels());
    codec.dynamic(frame.dry, frame.heads, dynamic.data());
    const Pose& head = frame.heads.now;
    const Strands base = codec.base(head);
    const auto target = target_of(codec, dynamic, frame.wet, head);
    Strands once;
    codec.decode(target.data(), head, once);
    ASSERT_GT(mean_distance(base, frame.wet), 0.01);
    // The water shrinks a strand by a line of 49 mm. Amplitude k of a line is 2 sqrt(2) / (pi k)^2 of it for
    // odd k: those past 23 are 0.05 mm together, and 0.4 mm at the tip, where they add up. The base turns the
    // curls by 14 degrees, the wet ones stay: 2 mm of five turns, as steep at the ends as 63 mm of line, 0.5
    // mm there. The exact root at most doubles all that.
    EXPECT_LT(mean_distance(once, frame.wet), 1e-4);
    EXPECT_LT(largest_distance(once, frame.wet), 1.8e-3);
    for (int s = 0; s < once.count; ++s) {
        EXPECT_LT(norm(once.at(s, 0) - base.at(s, 0)), 1e-7);
        EXPECT_LT(norm(once.at(s, 0) - frame.wet.at(s, 0)), 1e-7);  // rounding of the pose
    }
    const auto again = target_of(codec, dynamic, once, head);
    for (size_t k = 0; k < again.size(); ++k) EXPECT_NEAR(again[k], target[k], 2e-6);
    EXPECT_EQ(largest_distance(codec.base(frame.heads.now), base),
              0);  // encoding and decoding take up no frame
}

TEST(StrandCodec, base_is_the_rest_shape_moved_and_an_answer_of_zero_is_the_base) {
    const WetFrame frame(4);
    StrandCodec codec(frame.high, frame.low, {});
    std::vector<float> dynamic(dynamic_channels * codec.pixels()),
        amplitudes(strand_coefficients * codec.pixels());
    codec.dynamic(frame.dry, frame.heads, dynamic.data());
    Strands expected, decoded;
    const Pose& head = frame.heads.now;
    Interpolator(Interpolation::rest, quad_stencil(frame.high, frame.low), frame.high, frame.low)
        .apply(frame.dry, head, expected);
    ASSERT_GT(largest_distance(codec.base(head), moved(frame.high.rest, head)), 0.01);
    EXPECT_EQ(largest_distance(codec.base(head), expected), 0);
    // At full resolution: also what no amplitude says.
    codec.decode(std::vector<float>(amplitudes.size(), 0).data(), head, decoded);
    EXPECT_EQ(largest_distance(decoded, expected), 0);
    codec.encode(expected, head, amplitudes.data());
    for (size_t k = 0; k < amplitudes.size(); ++k)
        ASSERT_NEAR(dynamic[k], amplitudes[k], 2e-7);  // rounding of the pose
    // The next frame has its own.
    codec.dynamic(moved(frame.low.rest, head), frame.heads, dynamic.data());
    EXPECT_LT(largest_distance(codec.base(frame.heads.now), moved(frame.high.rest, head)),
              1e-6);  // rounding of the cores
}

TEST(StrandCodec, amplitudes_do_not_know_the_heads_pose) {
    const Groom high = curly_groom({});
    const StrandCodec codec(high, coarsened(high, 2), {});
    std::vector<float> still(strand_coefficients * codec.pixels()), turned(still.size());
    const Pose head = some_pose(3);
    codec.encode(high.rest, Pose{}, still.data());
    codec.encode(moved(high.rest, head), head, turned.data());
    ASSERT_GT(*std::max_element(still.begin(), still.end()),
              0.05f);  // a line of 0.2 m: 2 sqrt(2) / pi^2 of it
    for (size_t k = 0; k < still.size(); ++k) EXPECT_NEAR(still[k], turned[k], 2e-6);
}

TEST(StrandCodec, static_features_are_rest_shape_wetness_and_lengths_by_the_strands_own) {
    const Curls curls;
    const Groom high = curly_groom(curls), low = coarsened(high, 2);
    const StrandCodec codec(high, low, tip_wetness(high), nullptr, false, {.reach = 0.016});
    std::vector<float> rest(strand_coefficients * codec.pixels());
    codec.encode(high.rest, Pose{}, rest.data());
    for (size_t k = 0; k < rest.size(); ++k) ASSERT_EQ(codec.fixed()[k], rest[k]);
    const Strands cores = cores_of(high.rest), low_cores = cores_of(low.rest);
    const Stencil& around = codec.carrier().around();
    for (size_t pixel = 0; pixel < codec.pixels(); ++pixel) {
        auto channel = [&](int c) { return codec.fixed()[size_t(c) * codec.pixels() + pixel]; };
        const double length = arc_length(high.rest.strand(int(pixel)), 50);
        EXPECT_NEAR(codec.length()[pixel], length, 1e-6);
        // Fifty particles, the first six in the first piece, the last seven in the last one.
        EXPECT_NEAR(channel(static_layout.saturation.first), 2.5 / 49, 1e-6);
        EXPECT_NEAR(channel(static_layout.saturation.end() - 1), 46.0 / 49, 1e-6);
        EXPECT_NEAR(channel(static_layout.radius.first) * length, curls.radius, 0.06 * curls.radius);
        // The one to the right, or to the left at the end, and the like.
        const int column = int(pixel) % 8, row = int(pixel) / 8;
        double sum = 0;
        int count = 0;
        for (int other = 0; other < 64; ++other)
            if (std::abs(other % 8 - column) + std::abs(other / 8 - row) == 1)
                sum += norm(high.rest.at(other, 0) - high.rest.at(int(pixel), 0)), ++count;
        EXPECT_NEAR(channel(static_layout.spacing.first) * length, sum / count, 1e-7);
        EXPECT_NEAR(channel(static_layout.reach.first) * length, 0.016, 1e-7);
        // A strand that is simulated itself has one around it, which is no way off.
        const bool shared = column % 2 == 0 && row % 2 == 0;
        double off = 0, apart = 0, heaviest = 0;
        for (int k = 0; k < 4; ++k) {
            const int from = around.from[pixel * 4 + size_t(k)];
            const double weight = double(around.weight[pixel * 4 + size_t(k)]);
            off += weight * double(norm(low.rest.at(from, 0) - high.rest.at(int(pixel), 0)));
            double square = 0;
            for (int i = 0; i < 50; ++i) {
                const Vec3f d = (cores.at(int(pixel), i) - cores.at(int(pixel), 0)) -
                                (low_cores.at(from, i) - low_cores.at(from, 0));
                square += double(dot(d, d)) / 50;
            }
            apart += weight * square;
            heaviest = std::max(heaviest, weight);
        }
        EXPECT_NEAR(channel(static_layout.guides.first) * length, off, 1e-7);
        EXPECT_EQ(channel(static_layout.guides.first) == 0, shared);
        EXPECT_NEAR(channel(static_layout.guides.first + 1) * length, std::sqrt(apart), 1e-6);
        EXPECT_NEAR(channel(static_layout.guides.first + 2), heaviest, 1e-7);
        EXPECT_GT(channel(static_layout.guides.first + 3), 0);
    }
    // All roots lie as far from their middle.
    Vec3d middle{0, 0, 0};
    for (int s = 0; s < 64; ++s) middle += (1.0 / 64) * cast<double>(high.rest.at(s, 0));
    double square = 0;
    for (int s = 0; s < 64; ++s) {
        const Vec3d d = cast<double>(high.rest.at(s, 0)) - middle;
        square += dot(d, d) / 64;
    }
    EXPECT_NEAR(codec.fixed()[size_t(static_layout.scalp.first) * codec.pixels()] * codec.length()[0],
                std::sqrt(square), 1e-6);
}

// Twice as long, on a head twice as large, of a fibre as stiff against its weight, moved slower by the root
// of 2: it is the same hair to a network.
TEST(StrandCodec, features_have_no_units) {
    auto hair = [](float size) {
        Groom out = curly_groom({});
        for (Vec3f& x : out.rest.points) x = size * x;
        return out;
    };
    auto features = [&](float size) {
        const Groom high = hair(size), low = coarsened(high, 2);
        const double time = std::sqrt(double(size));
        const HairTraits traits{.rigidity = 4e-9 * std::pow(size, 3),
                                .wet_rigidity = 2e-9 * std::pow(size, 3),
                                .density = 6e-6,
                                .wet_density = 8e-6,
                                .drag = 0.5 / time,
                                .wet_drag = 4 / time,
                                .reach = 0.01 * size,
                                .low_step = 0.02 * time,
                                .fps = 24 / time};
        StrandCodec codec(high, low, tip_wetness(high), nullptr, false, traits);
        std::vector<float> out = codec.fixed(), dynamic(dynamic_channels * codec.pixels());
        for (int f = 0; f < 10; ++f) {
            auto head = [&](int k) {
                return Pose{rotation_about({0, 1, 0}, 0.004 * k * k), {0.001 * size * k * k, 0, 0}};
            };
            Strands p = low.rest;
            for (int s = 0; s < p.count; ++s)
                for (int i = 0; i < p.particles; ++i)
                    p.at(s, i).x += size * 1e-3f * float(i) * float(std::sin(0.7 * f + 0.1 * s));
            const HeadWindow heads{head(f - 1), head(f), head(f + 1), f > 0, 24 / time, {0, -9.81, 0}};
            codec.dynamic(moved(p, heads.now), heads, dynamic.data());
        }
        out.insert(out.end(), dynamic.begin(), dynamic.end());
        return out;
    };
    const std::vector<float> one = features(1), two = features(2);
    // Lags are whole frames, here of another rate: what lies in the past is not compared.
    const size_t pixels = 64, compared = size_t(static_channels + dynamic_layout.history.first) * pixels;
    ASSERT_EQ(one.size(), two.size());
    for (size_t k = 0; k < compared; ++k)
        ASSERT_NEAR(two[k], one[k], 2e-4 * std::max(1.f, std::abs(one[k]))) << "channel " << k / pixels;
}

TEST(StrandCodec, sees_the_same_past_at_any_rate) {
    EXPECT_EQ(lags_in_frames(24), (std::array<int, 4>{1, 2, 4, 8}));
    EXPECT_EQ(lags_in_frames(120), (std::array<int, 4>{5, 10, 20, 40}));
    EXPECT_EQ(lags_in_frames(30), (std::array<int, 4>{1, 3, 5, 10}));
    EXPECT_EQ(lags_in_frames(6), (std::array<int, 4>{1, 1, 1, 2}));
}

TEST(StrandCodec, averages_answers_over_a_twenty_fourth_of_a_second_in_whole_frames) {
    const Groom high = curly_groom({}), low = coarsened(high, 2);
    for (const auto& [fps, frames, last] :
         {std::tuple{8.0, 1, 3}, {24.0, 2, 8}, {30.0, 2, 10}, {48.0, 3, 16}, {60.0, 4, 20}, {120.0, 6, 40}}) {
        EXPECT_EQ(averaged_frames(fps), frames) << fps;
        HairTraits traits;
        traits.fps = fps;
        const StrandCodec codec(high, low, {}, nullptr, false, traits);
        EXPECT_EQ(codec.averaged(), frames) << fps;
        EXPECT_EQ(codec.memory(), last + frames - 1) << fps;
        EXPECT_GT(codec.slots(), last) << fps;
        EXPECT_LE(codec.slots(), last + frames) << fps;
        EXPECT_EQ(codec.slots() % frames, 0) << fps;
    }
}

TEST(StrandCodec, motion_features_are_gravity_turning_and_the_roots_acceleration) {
    const Groom high = curly_groom({}), low = coarsened(high, 2);
    StrandCodec codec(high, low, {});
    // A head that turns about y at 2 rad/s: the root's acceleration is -omega^2 times its distance from the
    // axis.
    const double fps = 240, omega = 2;
    auto pose = [&](double t) { return Pose{rotation_about({0, 1, 0}, omega * t), {0, 0.3, 0}}; };
    HeadWindow heads{pose(0.5 - 1 / fps), pose(0.5), pose(0.5 + 1 / fps), true, fps, {0, -9.81, 0}};
    std::vector<float> out(dynamic_channels * codec.pixels());
    codec.dynamic(moved(low.rest, heads.now), heads, out.data());
    const RootFrames frames_of_roots = root_frames(high);
    for (int s = 0; s < high.rest.count; ++s) {
        const Vec3d root = cast<double>(high.rest.at(s, 0));
        const Vec3d expected[3] = {{0, -9.81, 0}, {0, omega, 0}, -omega * omega * Vec3d{root.x, 0, root.z}};
        const Channels vectors[3] = {dynamic_layout.gravity, dynamic_layout.turning,
                                     dynamic_layout.acceleration};
        for (int v = 0; v < 3; ++v) {
            auto channel = [&](int axis) {
                return out[size_t(vectors[v].first + axis) * codec.pixels() + size_t(s)];
            };
            // The pose itself is a turn about gravity, so head's and world's axes agree on these vectors.
            const Vec3f found =
                rotate(frames_of_roots.rotation[size_t(s)], Vec3f{channel(0), channel(1), channel(2)});
            const double L = double(codec.length()[size_t(s)]), g = double(standard_gravity),
                         unit[3] = {g, std::sqrt(g / L), g};
            EXPECT_LT(norm(unit[v] * cast<double>(found) - expected[v]), 1e-4) << v;
        }
    }
    heads.inner = false;
    StrandCodec standing(high, low, {});
    standing.dynamic(moved(low.rest, heads.now), heads, out.data());
    for (size_t k = size_t(dynamic_layout.turning.first) * codec.pixels(); k < out.size(); ++k) {
        if (!dynamic_layout.doubt.holds(int(k / codec.pixels()))) {
            EXPECT_EQ(out[k], 0);
        }
    }
}

TEST(StrandCodec, history_features_are_those_of_frames_1_2_4_and_8_before) {
    const Groom high = curly_groom({}), low = coarsened(high, 2);
    StrandCodec codec(high, low, {});
    // Strands sway in the head's frame and the head turns ever faster.
    auto head = [](int f) { return Pose{rotation_about({0, 1, 0}, 0.01 * f * f), {0, 0, 0}}; };
    std::vector<std::vector<float>> frames;
    for (int f = 0; f < 12; ++f) {
        Strands p = low.rest;
        for (int s = 0; s < p.count; ++s)
            for (int i = 0; i < p.particles; ++i)
                p.at(s, i) += Vec3f{1e-3f * float(i) * float(std::sin(0.7 * f)), 0, 0};
        const HeadWindow heads{head(f - 1), head(f), head(f + 1), f > 0, 24, {0, -9.81, 0}};
        frames.emplace_back(size_t(dynamic_channels) * codec.pixels());
        codec.dynamic(moved(p, heads.now), heads, frames.back().data());
    }
    double most = 0;
    for (int f = 0; f < 12; ++f)
        for (size_t l = 0; l < history_lags.size(); ++l) {
            const auto& then = frames[size_t(std::max(0, f - history_lags[l]))];
            for (size_t pixel = 0; pixel < codec.pixels(); ++pixel) {
                auto now_at = [&](int c) { return frames[size_t(f)][size_t(c) * codec.pixels() + pixel]; };
                auto then_at = [&](int c) { return then[size_t(c) * codec.pixels() + pixel]; };
                const int at = dynamic_layout.past(int(l)).first, change = at + past_layout.change.first;
                for (int axis = 0; axis < 3; ++axis)
                    for (int k = 0; k < history_modes; ++k) {
                        const int c = dynamic_layout.base.first + axis * dct_kept + k,
                                  m = axis * history_modes + k;
                        ASSERT_EQ(now_at(change + m), now_at(c) - then_at(c)) << f << " " << l << " " << m;
                        most = std::max(most, double(std::abs(now_at(change + m))));
                    }
                for (int axis = 0; axis < 3; ++axis) {
                    ASSERT_EQ(now_at(at + past_layout.turning.first + axis),
                              then_at(dynamic_layout.turning.first + axis))
                        << f << " " << l;
                    ASSERT_EQ(now_at(at + past_layout.acceleration.first + axis),
                              then_at(dynamic_layout.acceleration.first + axis))
                        << f << " " << l;
                }
            }
        }
    EXPECT_GT(most, 0.005);
}

// Pairs files and models were made with these: another number needs another version of both.
TEST(NetworkChannels, are_where_files_have_them) {
    auto expect = [](const char* what, const Channels& found, int first, int count) {
        EXPECT_EQ(found.first, first) << what;
        EXPECT_EQ(found.count, count) << what;
    };
    expect("rest", static_layout.rest, 0, 72);
    expect("saturation", static_layout.saturation, 72, 8);
    expect("radius", static_layout.radius, 80, 1);
    expect("scalp", static_layout.scalp, 81, 1);
    expect("spacing", static_layout.spacing, 82, 1);
    expect("reach", static_layout.reach, 83, 1);
    expect("guides", static_layout.guides, 84, 4);
    expect("fibre", static_layout.fibre, 88, 6);
    EXPECT_EQ(static_channels, 94);
    expect("base", dynamic_layout.base, 0, 72);
    expect("gravity", dynamic_layout.gravity, 72, 3);
    expect("turning", dynamic_layout.turning, 75, 3);
    expect("acceleration", dynamic_layout.acceleration, 78, 3);
    expect("doubt", dynamic_layout.doubt, 81, 4);
    expect("history", dynamic_layout.history, 85, 72);
    expect("eight frames before", dynamic_layout.past(3), 139, 18);
    expect("change", past_layout.change, 0, 12);
    expect("turning then", past_layout.turning, 12, 3);
    expect("acceleration then", past_layout.acceleration, 15, 3);
    EXPECT_EQ(dynamic_channels, 157);
    EXPECT_EQ(strand_channels, 251);
    expect("amplitudes", answered_amplitudes, 0, 72);
    expect("errors", answered_errors, 72, 8);
    // Amplitudes 0 to 3 of x, of y, of z.
    EXPECT_EQ(history_amplitude(0), 0);
    EXPECT_EQ(history_amplitude(5), 25);
    EXPECT_EQ(history_amplitude(11), 51);
    EXPECT_EQ(adhesion_inputs, 12);
    EXPECT_EQ(AdhesionChannels::first(0) + AdhesionChannels::force, 7);
}

TEST(NetworkChannels, of_a_strand_are_named_once) {
    std::vector<int> named(size_t(strand_channels), 0);
    for (const InputGroup& g : strand_inputs)
        for (int c = g.channels.first; c < g.channels.end(); ++c) ++named.at(size_t(c));
    for (int times : named) EXPECT_EQ(times, 1);
}

TEST(StrandCodec, holes_of_the_grid_hold_zeros) {
    Groom high = curly_groom({});
    high.grid.width = 9;  // a column without strands
    std::vector<int> wider;
    for (int row = 0; row < 8; ++row) {
        for (int column = 0; column < 8; ++column) wider.push_back(row * 8 + column);
        wider.push_back(-1);
    }
    high.grid.strand = wider;
    StrandCodec codec(high, coarsened(high, 2), tip_wetness(high));
    std::vector<float> out(dynamic_channels * codec.pixels(), 7);
    codec.dynamic(coarsened(high, 2).rest, HeadWindow{}, out.data());
    for (size_t pixel = 8; pixel < codec.pixels(); pixel += 9) {
        EXPECT_EQ(codec.mask()[pixel], 0);
        for (int c = 0; c < dynamic_channels; ++c) EXPECT_EQ(out[size_t(c) * codec.pixels() + pixel], 0);
        for (int c = 0; c < static_channels; ++c)
            EXPECT_EQ(codec.fixed()[size_t(c) * codec.pixels() + pixel], 0);
    }
    high.grid.strand[0] = -1;
    expect_error([&] { StrandCodec(high, coarsened(high, 2), {}); }, {"strand 0 is at no pixel"});
}

TEST(FrameWindow, knows_the_head_before_and_after_stands_still_at_first_and_goes_on_at_last) {
    Runs runs;
    const RunReader dry(runs.dry);
    FrameWindow window(dry);
    for (int f = 0; f < frames; ++f) {
        ASSERT_TRUE(window.advance());
        EXPECT_EQ(window.index(), f);
        EXPECT_EQ(largest_distance(window.now().positions, dry.frame(f).positions), 0);
        const HeadWindow& heads = window.heads();
        EXPECT_EQ(heads.inner, f > 0);
        // 0.05 rad a frame about y; x = 0.002 f^2 m.
        EXPECT_NEAR(heads.angular_velocity().y, f > 0 ? 0.05 * 24 : 0, 1e-9);
        const bool between = f > 0 && f + 1 < frames;
        EXPECT_NEAR(heads.acceleration({0, 0, 0}).x, between ? 0.004 * 24 * 24 : 0, 1e-9);
    }
    EXPECT_FALSE(window.advance());
}

TEST(Encode, training_and_inference_see_the_same_features) {
    Runs runs;
    runs.encode();
    const PairsReader pairs(runs.pairs);
    ASSERT_EQ(pairs.runs(), 1);
    const StrandPairs stored = pairs.strand(0);
    EXPECT_EQ(stored.frames, frames);
    EXPECT_EQ(stored.static_channels, static_channels);
    EXPECT_EQ(stored.dynamic_channels, dynamic_channels);

    const RunReader dry(runs.dry);  // what inference has: this, the rest groom and the wetness
    StrandCodec codec(runs.high, dry.header().groom, runs.saturation);
    EXPECT_EQ(stored.fixed, codec.fixed());
    EXPECT_EQ(stored.mask, codec.mask());
    EXPECT_EQ(stored.length, codec.length());
    std::vector<float> mine(dynamic_channels * codec.pixels()), theirs(mine.size()),
        target(strand_coefficients * codec.pixels());
    double motion = 0;
    for (FrameWindow window(dry); window.advance();) {
        codec.dynamic(window.now().positions, window.heads(), mine.data());
        pairs.frame(0, window.index(), theirs.data(), target.data());
        EXPECT_EQ(mine, theirs) << window.index();
        for (size_t k = size_t(dynamic_layout.turning.first) * codec.pixels(); k < mine.size(); ++k)
            motion = std::max(motion, double(std::abs(mine[k])));
    }
    EXPECT_GT(motion, 0.1);
}

TEST(Encode, base_and_target_decode_to_the_wet_strands) {
    Runs runs;
    const double floor_mm = runs.encode();
    // Root mean square of the amplitudes past 23 of the line of 49 mm by which the wet strands are shorter:
    // of 2 sqrt(2) / (pi k)^2 for odd k. A quarter more or less: their mean, the exact root, the turned
    // curls.
    const double line_mm =
        49 * 2 * std::numbers::sqrt2 / std::pow(std::numbers::pi, 2) / std::sqrt(6 * std::pow(dct_kept, 3));
    EXPECT_NEAR(floor_mm, line_mm, 0.25 * line_mm);
    const PairsReader pairs(runs.pairs);
    const RunReader wet(runs.wet);
    const RunReader dry(runs.dry);
    StrandCodec codec(runs.high, runs.low, runs.saturation);
    std::vector<float> dynamic(dynamic_channels * codec.pixels()),
        target(strand_coefficients * codec.pixels());
    double sum = 0;
    for (FrameWindow window(dry); window.advance();) {
        pairs.frame(0, window.index(), dynamic.data(), target.data());
        ASSERT_GT(*std::max_element(target.begin(), target.end()), 0.01f);
        Strands decoded;
        const RunFrame frame = wet.frame(window.index());
        codec.dynamic(window.now().positions, window.heads(), dynamic.data());
        codec.decode(target.data(), frame.head, decoded);
        sum += 1e3 * mean_distance(decoded, frame.positions);
    }
    EXPECT_NEAR(sum / frames, floor_mm, 1e-3 * floor_mm);
}

TEST(Encode, root_pairs_share_a_box_and_hold_colours_of_the_roots) {
    Runs runs;
    std::vector<RunPair> both;
    both.emplace_back(runs.dry, runs.wet);
    both.emplace_back(runs.dry, runs.wet);
    const float reach = 0.012f;
    {
        PairsWriter out(runs.pairs, Codec::root, runs.high.rest.particles, true);
        encode_roots(both, reach, out);
        out.commit();
    }
    const PairsReader pairs(runs.pairs);
    ASSERT_EQ(pairs.runs(), 2);
    ColourBox box;
    pairs.box(&box.lower.x, &box.upper.x);
    ASSERT_GT(box.diagonal(), 0.03);
    const RootPairs stored = pairs.root(1);
    EXPECT_EQ(stored.height, 32);
    EXPECT_EQ(std::count(stored.mask_low.begin(), stored.mask_low.end(), 1), 16);
    EXPECT_EQ(std::count(stored.mask.begin(), stored.mask.end(), 1), 64);
    std::vector<float> input(3 * stored.pixels()), target(4 * input.size());
    pairs.frame(1, 3, input.data(), target.data());
    const auto low = RootImage(runs.low.grid).read(input.data()),
               high = RootImage(runs.high.grid, 2).read(target.data());
    const RunFrame dry = RunReader(runs.dry).frame(3), wet = RunReader(runs.wet).frame(3);
    for (int s = 0; s < runs.low.rest.count; ++s)
        EXPECT_LT(norm(position_of(low[size_t(s)], box) - dry.positions.at(s, 0)), 1e-6);
    const auto expected = shifted_roots(wet.positions, runs.saturation, reach);
    double shift = 0;
    for (int s = 0; s < runs.high.rest.count; ++s) {
        EXPECT_LT(norm(position_of(high[size_t(s)], box) - expected[size_t(s)]), 1e-6);
        shift = std::max(shift, double(norm(expected[size_t(s)] - wet.positions.at(s, 0))));
    }
    EXPECT_GT(shift, 1e-4);
}

TEST(Encode, runs_that_are_no_pair_are_errors) {
    Runs runs;
    expect_error([&] { RunPair(runs.wet, runs.dry); }, {runs.dry, "simulated dry", "simulated wet"});
    expect_error([&] { RunPair(runs.wet, runs.wet); },
                 {runs.wet, "found 64 low-resolution strands", "fewer than 64"});
    const std::string other = runs.scratch.path("other.h5");
    write_run(other, runs.low, 2, frames - 1, {});
    expect_error([&] { RunPair(other, runs.wet); }, {other, "frames", "found 4", "allowed 5"});
    write_run(other, coarsened(curly_groom({}, 2), 2), 2, frames, {});
    expect_error([&] { RunPair(other, runs.wet); }, {other, "strand 0 is none", "allowed 0.01 mm"});
    write_run(other, runs.high, 1, frames, {});
    expect_error([&] { RunPair(runs.dry, other); }, {other, "simulated dry", "simulated wet"});
    write_run(
        other, runs.low, 2, frames, {},
        [](int, int, int) {
            return Vec3d{0, 0, 0};
        },
        [](int f) {
            return Pose{Quatd::identity(), {0.1 * f, 0, 0}};
        });
    PairsWriter out(runs.pairs, Codec::strand, 50, true);
    expect_error([&] { encode_strands(RunPair(other, runs.wet), out); },
                 {other, "frame 0", "head is elsewhere"});
}

TEST(Pairs, adhesion_samples_come_back) {
    const Scratch scratch;
    Random random(5);
    std::vector<AdhesionSample> samples(7);
    for (auto& s : samples) {
        for (float& x : s.input) x = float(random.number());
        s.target = float(random.number());
        s.contact = random.number() > 0;
    }
    {
        PairsWriter out(scratch.path("a.h5"), Codec::adhesion, 50, false);
        out.add(samples);
        out.add({samples[2]});
        out.commit();
    }
    const PairsReader in(scratch.path("a.h5"));
    EXPECT_EQ(in.codec(), Codec::adhesion);
    ASSERT_EQ(in.runs(), 2);
    const auto back = in.adhesion(0);
    ASSERT_EQ(back.size(), samples.size());
    for (size_t k = 0; k < back.size(); ++k) {
        EXPECT_EQ(back[k].input, samples[k].input);
        EXPECT_EQ(back[k].target, samples[k].target);
        EXPECT_EQ(back[k].contact, samples[k].contact);
    }
    EXPECT_EQ(in.adhesion(1)[0].target, samples[2].target);
    expect_error([&] { in.strand(0); }, {"codec adhesion", "needed is codec strand"});
}

// A file of codec strand with one run of random values; `inputs` and `targets` are its frames, one after
// another.
StrandPairs write_shard(const std::string& path, unsigned seed, int run_frames, std::vector<float>& inputs,
                        std::vector<float>& targets) {
    Random random(seed);
    auto fill = [&](std::vector<float>& values, size_t n) {
        values.resize(n);
        for (float& v : values) v = float(random.number());
    };
    StrandPairs run{run_frames, 3, strand_coefficients + 2, 2, 5, {}, {}, {}, false, {}};
    fill(run.fixed, size_t(run.static_channels) * run.pixels());
    fill(run.length, run.pixels());
    run.mask.assign(run.pixels(), 1);
    run.mask[seed % run.pixels()] = 0;
    const size_t in = size_t(run.dynamic_channels) * run.pixels(), out = strand_coefficients * run.pixels();
    fill(inputs, in * size_t(run_frames));
    fill(targets, out * size_t(run_frames));
    PairsWriter file(path, Codec::strand, 50, false);
    file.begin(run);
    for (size_t f = 0; f < size_t(run_frames); ++f) file.append(&inputs[f * in], &targets[f * out]);
    file.commit();
    return run;
}

struct Shards {
    Scratch scratch;
    std::string folder = scratch.path("data"), all = folder + "/all.h5";
    std::vector<StrandPairs> runs;
    std::vector<float> inputs[3], targets[3];

    // Two shards in a folder below, and one beside the file of links.
    Shards() {
        std::filesystem::create_directories(folder + "/shards");
        PairsWriter links(all, Codec::strand, 50, false);
        const std::string names[] = {"shards/a.h5", "shards/b.h5", "c.h5"};
        for (size_t k = 0; k < 3; ++k) {
            runs.push_back(
                write_shard(folder + "/" + names[k], unsigned(k + 1), int(k) + 2, inputs[k], targets[k]));
            links.link(names[k]);
            EXPECT_EQ(links.group(), "runs/00" + std::to_string(k));
        }
        links.commit();
    }
    void expect_all(const std::string& path) const {
        const PairsReader in(path);
        EXPECT_EQ(in.codec(), Codec::strand);
        EXPECT_EQ(in.particles(), 50);
        ASSERT_EQ(in.runs(), 3);
        for (int r = 0; r < 3; ++r) {
            const StrandPairs found = in.strand(r), &wanted = runs[size_t(r)];
            EXPECT_EQ(found.frames, wanted.frames);
            EXPECT_EQ(found.static_channels, wanted.static_channels);
            EXPECT_EQ(found.dynamic_channels, wanted.dynamic_channels);
            EXPECT_EQ(found.height, wanted.height);
            EXPECT_EQ(found.width, wanted.width);
            EXPECT_EQ(found.fixed, wanted.fixed);
            EXPECT_EQ(found.mask, wanted.mask);
            EXPECT_EQ(found.length, wanted.length);
            std::vector<float> dynamic(size_t(wanted.dynamic_channels) * wanted.pixels()),
                target(strand_coefficients * wanted.pixels());
            for (int f = 0; f < wanted.frames; ++f) {
                in.frame(r, f, dynamic.data(), target.data());
                EXPECT_TRUE(
                    std::equal(dynamic.begin(), dynamic.end(), inputs[r].begin() + long(f * dynamic.size())));
                EXPECT_TRUE(
                    std::equal(target.begin(), target.end(), targets[r].begin() + long(f * target.size())));
            }
        }
    }
};

TEST(Pairs, a_file_of_links_reads_like_the_shards_it_names_also_when_moved_with_them) {
    const Shards shards;
    shards.expect_all(shards.all);
    std::filesystem::create_directories(shards.scratch.path("far/away"));
    const std::string there = shards.scratch.path("far/away/data");
    std::filesystem::rename(shards.folder, there);
    shards.expect_all(there + "/all.h5");
    // Named from the working folder, as a command line does.
    const auto relative = std::filesystem::relative(there + "/all.h5");
    ASSERT_TRUE(relative.is_relative());
    shards.expect_all(relative.string());
}

TEST(Pairs, links_and_runs_of_its_own_follow_one_another_in_a_file) {
    const Shards shards;
    const std::string path = shards.folder + "/mixed.h5";
    const StrandPairs& own = shards.runs[1];
    {
        PairsWriter out(path, Codec::strand, 50, false);
        out.link("c.h5");
        out.begin(own);
        out.append(shards.inputs[1].data(), shards.targets[1].data());
        out.link("shards/a.h5");
        out.commit();
    }
    const PairsReader in(path);
    ASSERT_EQ(in.runs(), 3);
    EXPECT_EQ(in.strand(0).fixed, shards.runs[2].fixed);
    EXPECT_EQ(in.strand(1).fixed, own.fixed);
    EXPECT_EQ(in.strand(1).frames, 1);
    EXPECT_EQ(in.strand(2).fixed, shards.runs[0].fixed);
}

TEST(Pairs, a_shard_that_is_missing_or_cut_short_is_an_error_that_names_file_and_run) {
    const Shards shards;
    const std::string shard = shards.folder + "/shards/b.h5", bytes = bytes_of(shard);
    std::filesystem::remove(shard);
    const PairsReader in(shards.all);
    EXPECT_EQ(in.strand(0).fixed, shards.runs[0].fixed);
    expect_error([&] { in.strand(1); }, {shards.all, "runs/001", "b.h5"});
    std::ofstream(shard, std::ios::binary) << bytes.substr(0, bytes.size() / 2);
    expect_error([&] { in.strand(1); }, {shards.all, "runs/001", "b.h5"});
}

TEST(Pairs, files_without_runs_and_unknown_codecs_are_errors) {
    const Scratch scratch;
    { PairsWriter(scratch.path("e.h5"), Codec::strand, 50, false).commit(); }
    expect_error([&] { PairsReader in(scratch.path("e.h5")); }, {"e.h5", "no encoded run"});
    expect_error<Misuse>([] { codec_named("strands"); },
                         {"'strands'", "strand, root, adhesion", "did you mean 'strand'"});
}

}  // namespace
}  // namespace wetcurl::testing

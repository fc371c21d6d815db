// The strand codec and interpolation on the device against those on the host.
#include <gtest/gtest.h>

#include <cmath>

#include "learn/codec/device_interpolator.h"
#include "learn/codec/interpolate.h"
#include "learn/codec/strand_kernels.h"
#include "tests/learn/hair.h"

namespace wetcurl {
namespace {

using testing::curly_groom;

bool has_device() {
    int devices = 0;
    return cudaGetDeviceCount(&devices) == cudaSuccess && devices > 0;
}

std::vector<float> downloaded(const float* data, size_t count) {
    std::vector<float> out(count);
    check_cuda(cudaMemcpy(out.data(), data, count * sizeof(float), cudaMemcpyDeviceToHost), "download");
    return out;
}

// A groom with a hole, whose low-resolution strands, dry, wet or settled, on a grid or guides of other
// lengths, sway under a head that turns and drifts.
class CodecOnDevice : public ::testing::TestWithParam<const char*> {};

TEST_P(CodecOnDevice, gives_the_features_and_strands_of_the_host) {
    if (!has_device()) GTEST_SKIP() << "SKIP: no CUDA device";
    Groom high = curly_groom({});
    high.grid.width = 9;
    std::vector<int> wider;
    for (int row = 0; row < 8; ++row) {
        for (int column = 0; column < 8; ++column) wider.push_back(row * 8 + column);
        wider.push_back(-1);
    }
    high.grid.strand = wider;
    const std::string kind = GetParam();
    const bool guides = kind == "guides";
    for (int s = 0; guides && s < high.rest.count; ++s)  // every third a third as long
        for (int i = high.rest.particles - 1; i > 0 && s % 3 == 1; --i)
            high.rest.at(s, i) = high.rest.at(s, 0) + 0.33f * (high.rest.at(s, i) - high.rest.at(s, 0));
    const Groom low = guides ? part_of(high, {0, 3, 10, 22, 31, 45, 56, 63}) : coarsened(high, 2);
    std::vector<float> saturation(high.rest.points.size(), 0.7f);
    HairTraits traits;
    if (guides)
        traits = {.rigidity = 2e-9,
                  .wet_rigidity = 1e-9,
                  .density = 6e-6,
                  .wet_density = 8e-6,
                  .drag = 4,
                  .wet_drag = 2,
                  .reach = 0.01,
                  .low_step = 1. / 48,
                  .fps = 48};
    Settled settled{std::vector<float>(size_t(low.rest.count), 0.9f), low.rest};
    for (int s = 0; s < low.rest.count; ++s)
        for (int i = 0; i < low.rest.particles; ++i)
            settled.more.at(s, i) = {1e-3f * float(i), -2e-3f * float(i), 1e-4f * float(i * s)};
    StrandCodec codec(high, low, saturation, nullptr, /*low_is_wet=*/kind == "wet", traits,
                      kind == "settled" ? &settled : nullptr);
    StrandKernels kernels(codec, low);
    const size_t n = size_t(codec.particles()), S = codec.pixels();
    ASSERT_EQ(size_t(kernels.pixels()), S);
    DeviceBuffer<Vec3f> low_there(low.rest.points.size()), out_there(high.rest.points.size());
    const size_t channels = size_t(strand_channels);
    std::vector<float> dynamic(size_t(dynamic_channels) * S), answer(size_t(strand_outputs) * S);
    for (size_t k = 0; k < answer.size(); ++k)
        answer[k] = codec.mask()[k % S] ? 1e-3f * float(std::sin(0.1 * double(k))) : 0;
    std::vector<float> by_pixel(answer.size());
    for (size_t k = 0; k < answer.size(); ++k) by_pixel[k % S * strand_outputs + k / S] = answer[k];
    const DeviceBuffer<float> answer_there(by_pixel);
    const int frames = guides ? 24 : 12;  // more than are remembered, at 48 and 24 a second
    for (int f = 0; f < frames; ++f) {
        Strands dry = low.rest;
        for (int s = 0; s < dry.count; ++s)
            for (int i = 0; i < dry.particles; ++i)
                dry.at(s, i) += Vec3f{2e-3f * float(i) * float(std::sin(0.5 * f + s)), 1e-3f * float(i), 0};
        HeadWindow heads;
        heads.before = testing::head_at(f - 1), heads.now = testing::head_at(f),
        heads.after = testing::head_at(f + 1), heads.inner = f > 0;
        dry = testing::moved(dry, heads.now);
        codec.dynamic(dry, heads, dynamic.data());
        Strands decoded;
        const int rounds = f % (most_length_rounds + 1);
        codec.decode(answer.data(), heads.now, decoded, rounds);

        low_there.upload(dry.points.data(), dry.points.size());
        kernels.begin_frame(heads, f == 0);
        kernels.take_head(nullptr);
        kernels.depart(low_there.data(), nullptr);
        kernels.move_cores(nullptr);
        kernels.carry(nullptr);
        kernels.describe(nullptr);
        const auto image = downloaded(kernels.image(), channels * S);
        double largest = 0;
        for (size_t c = 0; c < channels; ++c)
            for (size_t p = 0; p < S; ++p) {
                const float expected = c < size_t(static_channels)
                                           ? codec.fixed()[c * S + p]
                                           : dynamic[(c - size_t(static_channels)) * S + p];
                largest = std::max(largest, std::abs(double(expected)));
                // Rounding of offsets of 0.2 m by lengths as large, of accelerations by differences of poses.
                ASSERT_NEAR(image[c * S + p], expected, 1e-5 + 1e-5 * std::abs(expected))
                    << "frame " << f << ", channel " << c << ", pixel " << p;
            }
        EXPECT_GT(largest, 0.5);
        kernels.place(answer_there.data(), rounds, out_there.data(), nullptr);
        Strands placed(high.rest.count, high.rest.particles);
        out_there.download(placed.points.data());
        EXPECT_LT(testing::largest_distance(placed, decoded), 5e-6) << f;
        EXPECT_GT(testing::largest_distance(placed, codec.base(heads.now)), 1e-3);
    }

    // A ball at the head's origin, 2 cm wider than the cap that the roots lie on: what hangs within it comes
    // to its surface, but for roots, and where that tears edges strands are led, as the host leads them.
    // Every fourth strand may lie in it as it likes.
    HeadShapes head{{Sphere{0.12}}, std::vector<float>(high.rest.points.size(), 0)};
    for (size_t k = 0; k < head.depth.size(); ++k) head.depth[k] = k / n % 4 ? 0 : -1;
    Strands inside(high.rest.count, high.rest.particles);
    kernels.place(answer_there.data(), most_length_rounds, out_there.data(), nullptr);
    out_there.download(inside.points.data());
    kernels.keep_outside(head);
    const Pose pose = testing::head_at(frames - 1);
    const ShapeView ball = view_of(head.shapes[0]);
    auto depth_of = [&](int s, int i) { return head.depth[s * n + i]; };
    int moved = 0, led = 0;
    for (int round = 0; round < 2; ++round) {  // the second finds nothing of the first
        kernels.place(answer_there.data(), most_length_rounds, out_there.data(), nullptr);
        Strands around(high.rest.count, high.rest.particles), wanted = inside;
        out_there.download(around.points.data());
        auto out_of_ball = [&](const Vec3f& x, float depth) {
            const Vec3f in_head = cast<float>(pose.inverse(cast<double>(x)));
            return cast<float>(rotate(pose.rotation, cast<double>(pushed_out(ball, in_head, depth))) +
                               pose.translation);
        };
        for (int s = 0; s < wanted.count; ++s) {
            for (int i = 1; i < wanted.particles; ++i) {
                wanted.at(s, i) = out_of_ball(wanted.at(s, i), depth_of(s, i));
                moved += norm(wanted.at(s, i) - inside.at(s, i)) > 1e-4;
            }
            for (int i = 1; i < wanted.particles; ++i) {
                const Vec3f x = wanted.at(s, i);
                wanted.at(s, i) = led_around(wanted.at(s, i - 1), x, torn_lengths * codec.edges()[s * n + i],
                                             [&](const Vec3f& p) { return out_of_ball(p, depth_of(s, i)); });
                led += norm(wanted.at(s, i) - x) > 1e-3;
            }
            for (int i = 0; i < wanted.particles; ++i)
                if (depth_of(s, i) < 0) {
                    EXPECT_LT(norm(around.at(s, i) - wanted.at(s, i)), 1e-6);
                } else if (i > 0) {
                    EXPECT_GT(norm(pose.inverse(cast<double>(around.at(s, i)))), 0.12 - 1e-5);
                }
        }
        EXPECT_LT(testing::largest_distance(around, wanted), 1e-4) << round;
    }
    EXPECT_GT(moved, 100);
    EXPECT_GT(led, 100);
    head.depth.pop_back();
    testing::expect_error([&] { kernels.keep_outside(head); }, {"3199", "3200"});
}
TEST(InterpolationOnDevice, is_that_of_the_host) {
    if (!has_device()) GTEST_SKIP() << "SKIP: no CUDA device";
    const Groom high = curly_groom({}), low = coarsened(high, 2);
    const Pose pose = testing::some_pose(3);
    Strands swayed = low.rest;
    for (int s = 0; s < swayed.count; ++s)
        for (int i = 0; i < swayed.particles; ++i)
            swayed.at(s, i) += Vec3f{2e-3f * float(i) * float(std::sin(s)), 1e-3f * float(i), 0};
    swayed = testing::moved(swayed, pose);
    const DeviceBuffer<Vec3f> there(swayed.points);
    for (const Interpolation kind :
         {Interpolation::nearest, Interpolation::quad, Interpolation::core, Interpolation::rest})
        for (const int roots : {4, 3}) {
            const Stencil stencil = roots == 4 ? quad_stencil(high, low) : triangle_stencil(high, low);
            if (kind == Interpolation::rest && roots == 3) {
                testing::expect_error([&] { DeviceInterpolator(kind, stencil, high, low); },
                                      {"3 roots", "are 4"});
                continue;
            }
            Strands expected, found(high.rest.count, high.rest.particles);
            Interpolator(kind, stencil, high, low).apply(swayed, pose, expected);
            DeviceInterpolator on_device(kind, stencil, high, low);
            DeviceBuffer<Vec3f> out(found.points.size());
            for (int frame = 0; frame < 2; ++frame) {
                on_device.apply(there.data(), pose, out.data(), nullptr);
                out.download(found.points.data());
                EXPECT_LT(testing::largest_distance(found, expected), 5e-6) << int(kind) << ' ' << roots;
            }
            EXPECT_GT(testing::largest_distance(found, testing::moved(high.rest, pose)), 1e-2);
        }
}

INSTANTIATE_TEST_SUITE_P(Low, CodecOnDevice, ::testing::Values("dry", "wet", "settled", "guides"));

}  // namespace
}  // namespace wetcurl

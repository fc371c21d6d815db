// What is seen of strands that lie on a device, against the host's display.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "base/device_buffer.h"
#include "cuda/run/display.h"
#include "cuda/run/simulation.h"
#include "solver/cohesion/display.h"
#include "tests/cuda/needs_device.h"
#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;

class DisplayOnDevice : public testing::NeedsDevice {};

const std::string solids =
    "[[solid]]\nradius = 0.097\nattached = \"head\"\n"
    "[[solid]]\nshape = \"box\"\nhalf = [0.02, 0.05, 0.02]\n[[solid.motion.keyframe]]\ntranslation = [0.05, "
    "0, -0.12]\n";

// The strands as drawn, drawn together about the roots' middle so that each frame meets more of the others.
Strands gathered(const Scene& scene, const Pose& head, float share) {
    Strands p = scene.groom.rest;
    for (int s = 0; s < p.count; ++s)
        for (int i = 0; i < p.particles; ++i) {
            Vec3f& x = p.at(s, i);
            if (i > 0) x += share * float(i) / float(p.particles) * (scene.groom.rest.at(0, i) - x);
            x = rotate(cast<float>(head.rotation), x) + cast<float>(head.translation);
        }
    return p;
}

TEST_F(DisplayOnDevice, is_the_hosts_wherever_the_head_is) {
    for (const std::string spacing : {"0", "0.01"}) {
        const Scene scene =
            scene_of(wet_scene + solids, {"groom.grid=[12, 12]", "cohesion.spacing=" + spacing});
        Display wanted(scene);
        const auto got = make_cuda_display(scene, 0);
        const DeviceBuffer<Vec3f> out(scene.groom.rest.points.size());
        for (int f = 0; f < 5; ++f) {
            const double angle = 0.2 * f;
            const Pose head{{std::cos(angle / 2), 0, std::sin(angle / 2), 0}, {0.02 * f, 0.01, 0}};
            const Strands p = gathered(scene, head, 0.2f * float(f));  // lists grow
            Strands host = p, device = p;
            wanted.apply(host, head, 0);
            got->apply(device, head, 0);
            EXPECT_GT(farthest(host, p), 1e-4) << f;
            EXPECT_LT(farthest(device, host), 5e-5) << f;
            EXPECT_NEAR(got->neighbours_mean(), wanted.neighbours_mean(), 0.01 * wanted.neighbours_mean());
            // Where they lie on the device.
            check_cuda(cudaMemcpy(got->strands(), p.points.data(), out.bytes(), cudaMemcpyHostToDevice),
                       "strands");
            check_cuda(cudaDeviceSynchronize(), "strands");
            got->apply(out.data(), head, 0);
            const std::vector<Vec3f> there = out.host();
            EXPECT_EQ(std::memcmp(there.data(), device.points.data(), out.bytes()), 0) << f;
        }
    }
}

TEST_F(DisplayOnDevice, leads_strands_around_what_they_cross_as_the_host_does) {
    const Scene scene = scene_of(crossed_scene, {"groom.grid=[9, 5]"});
    Strands host = crossing(scene), device = host;
    Display(scene).apply(host, Pose(), 0);
    make_cuda_display(scene, 0)->apply(device, Pose(), 0);
    int led = 0;
    for (int s = 0; s < host.count; ++s)
        for (int i = 1; i < host.particles; ++i) {
            const float edge = norm(host.at(s, i) - host.at(s, i - 1));
            EXPECT_LT(edge, 1.02f * torn_lengths * crossing_edge);
            led += edge > 0.99f * torn_lengths * crossing_edge;
        }
    EXPECT_GT(led, 100);
    EXPECT_LT(farthest(device, host), 1e-4);
}

TEST_F(DisplayOnDevice, refuses_solids_that_deform) {
    const Scratch scratch;
    const Scene scene =
        scene_of(wet_scene + breathing_sphere(scratch, {0.05, 0.06}, 0.05, "[0, -0.06, -0.05]", 0.01),
                 {"groom.grid=[4, 4]"});
    EXPECT_THROW(make_cuda_display(scene, 0), Error);
}

}  // namespace
}  // namespace wetcurl

// What a frame asks of the driver, counted at the linker's door: tests/cuda/CMakeLists.txt names the calls
// that come here first.
#include <cuda_runtime.h>
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "cuda/run/simulation.h"
#include "tests/cuda/needs_device.h"
#include "tests/solver/scenes.h"

static std::map<std::string, int> calls;

#define COUNTED(name, parameters, ...)                \
    extern "C" cudaError_t __real_##name parameters;  \
    extern "C" cudaError_t __wrap_##name parameters { \
        ++calls[#name];                               \
        return __real_##name(__VA_ARGS__);            \
    }
COUNTED(cudaGraphLaunch, (cudaGraphExec_t graph, cudaStream_t stream), graph, stream)
COUNTED(cudaStreamBeginCapture, (cudaStream_t stream, cudaStreamCaptureMode mode), stream, mode)
COUNTED(cudaStreamSynchronize, (cudaStream_t stream), stream)
COUNTED(cudaDeviceSynchronize, ())
COUNTED(cudaEventSynchronize, (cudaEvent_t event), event)
COUNTED(cudaMemcpy, (void* to, const void* from, size_t bytes, cudaMemcpyKind kind), to, from, bytes, kind)
COUNTED(cudaMemcpyAsync, (void* to, const void* from, size_t bytes, cudaMemcpyKind kind, cudaStream_t stream),
        to, from, bytes, kind, stream)
COUNTED(cudaMalloc, (void** to, size_t bytes), to, bytes)
COUNTED(__cudaLaunchKernel,
        (cudaKernel_t kernel, dim3 grid, dim3 block, void** arguments, size_t shared, cudaStream_t stream),
        kernel, grid, block, arguments, shared, stream)
#undef COUNTED

namespace wetcurl {
namespace {

using namespace testing;

class FrameCalls : public testing::NeedsDevice {
  protected:
    // Of eight frames, once their graph is there.
    static std::map<std::string, int> of_eight_frames(const Scene& scene) {
        const auto simulation = make_cuda_simulation(scene, "float", 0);
        for (int f = 0; f < 12; ++f) simulation->advance();
        calls.clear();
        for (int f = 0; f < 8; ++f) simulation->advance();
        return calls;
    }
};

// No kernel by itself, no copy from or to the host by itself, no memory; one wait, for the report at its end.
TEST_F(FrameCalls, a_frame_is_one_graph_and_one_wait) {
    const std::map<std::string, int> wanted{{"cudaGraphLaunch", 8}, {"cudaStreamSynchronize", 8}};
    const std::string head = "[[solid]]\nradius = 0.097\nattached = \"head\"\n",
                      air = dry_scene + "[air]\ngrid = [8, 8, 8]\n";
    [[maybe_unused]] const auto compared = [&](const std::string& method) {
        return dry_scene + head + "[wetness]\n[baseline]\nmethod = \"" + method + "\"\n";
    };
    std::string coherent = wet_scene;
    coherent.replace(coherent.find("radius = 0.03"), 13, "radius = 0.03\nstrength = 20");
    const Scratch scratch;
    std::map<std::string, std::string> scenes{
        {"dry", dry_scene},
        {"wet", wet_scene + head},
        {"wind", air + "wind = [1, 0, 0]\n"},
        {"two-way air", air + "two_way = true\nwind = [0, 0, 1]\n[[air.source]]\n"},
        {"flow", flowing_scene(1, 0.5)},
        {"a ball that breathes",
         wet_scene + breathing_sphere(scratch, {0.02, 0.04}, 2, "[0, -0.1, 0.12]", 0.01, 16)}};
#ifndef WETCURL_PARITY  // there what strands do to each other is the host's
    scenes.insert(
        {{"strand contact", wet_scene + "[strand_contact]\n"},
         {"cohesion in the solve", coherent},
         {"lin", compared("lin")},
         {"kim", compared("kim")},
         {"boundary particles", compared("boundary_particles")},
         {"lin and boundary particles",
          dry_scene + head + "[wetness]\n[baseline]\ncohesion = \"lin\"\nboundary = \"particles\"\n"}});
#endif
    for (const auto& [name, text] : scenes) {
        const Scene scene = scene_of(text, {"groom.grid=[12, 12]"});
        EXPECT_EQ(of_eight_frames(scene), wanted) << name;
    }
}

}  // namespace
}  // namespace wetcurl

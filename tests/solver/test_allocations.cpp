// No memory is asked for within a frame, once the frames before have found what they need.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "tests/solver/scenes.h"

namespace {
std::atomic<long> asked{0};
void* counted(size_t bytes, size_t alignment) {
    ++asked;
    const size_t whole = (bytes + alignment - 1) / alignment * alignment;
    if (void* p = std::aligned_alloc(alignment, whole ? whole : alignment)) return p;
    throw std::bad_alloc();
}
}  // namespace

void* operator new(size_t bytes) { return counted(bytes, alignof(std::max_align_t)); }
void* operator new[](size_t bytes) { return counted(bytes, alignof(std::max_align_t)); }
void* operator new(size_t bytes, std::align_val_t a) { return counted(bytes, size_t(a)); }
void* operator new[](size_t bytes, std::align_val_t a) { return counted(bytes, size_t(a)); }
void operator delete(void* p) noexcept { std::free(p); }
void operator delete[](void* p) noexcept { std::free(p); }
void operator delete(void* p, size_t) noexcept { std::free(p); }
void operator delete[](void* p, size_t) noexcept { std::free(p); }
void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete[](void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete(void* p, size_t, std::align_val_t) noexcept { std::free(p); }
void operator delete[](void* p, size_t, std::align_val_t) noexcept { std::free(p); }

namespace wetcurl {
namespace {

using namespace testing;

long asked_in_frames(const std::string& text, int before, int frames, AdhesionPredictor* model = nullptr,
                     const std::vector<std::string>& set = {}, const std::string& precision = "float") {
    const Scene scene = scene_of(text, set);
    const auto simulation = make_simulation(scene, precision);
    if (model) simulation->use_adhesion_predictor(model);
    for (int f = 0; f < before; ++f) simulation->advance();
    const long at_first = asked;
    for (int f = 0; f < frames; ++f) simulation->advance();
    return asked - at_first;
}

TEST(Allocations, are_counted) {
    const long before = asked;
    const std::vector<int> some(100);
    EXPECT_EQ(asked - before, 1) << some.size();
}

struct NoPull final : AdhesionPredictor {
    long asked = 0;
    void evaluate(const float*, size_t rows, float* out) override {
        std::fill_n(out, rows, 0.f);
        asked += long(rows);
    }
};

// The head's motion repeats every 12 frames, so that what a frame needs was needed before.
TEST(Allocations, a_frame_asks_for_none) {
    std::string among_solids = wet_scene;
    for (size_t k = 0; k <= most_solids_in_a_loop; ++k)
        among_solids += "[[solid]]\nradius = 0.02\n[[solid.motion.keyframe]]\ntranslation = [0, " +
                        std::to_string(-0.1 * double(k)) + ", 0.1]\n";
    std::string coherent = wet_scene;
    coherent.replace(coherent.find("radius = 0.03"), 13, "radius = 0.03\nstrength = 1e-6");
    const auto compared = [](const std::string& method) {
        return dry_scene + "[[solid]]\nradius = 0.1\n[wetness]\n[baseline]\nmethod = \"" + method + "\"\n";
    };
    const std::string air = dry_scene + "[air]\ngrid = [8, 8, 8]\n";
    for (const auto& [name, text] :
         {std::pair{"dry", dry_scene},
          {"wet", wet_scene},
          {"air", air + "[[air.source]]\n"},
          {"two-way air", air + "two_way = true\nwind = [0, 0, 1]\n"},
          {"many solids", among_solids},
          {"strand contact", wet_scene + "[strand_contact]\n"},
          {"cohesion in the solve", coherent},
          {"lin", compared("lin")},
          {"kim", compared("kim")},
          {"boundary particles", compared("boundary_particles")},
          {"lin and boundary particles", dry_scene +
                                             "[[solid]]\nradius = 0.1\n[wetness]\n[baseline]\ncohesion = "
                                             "\"lin\"\nboundary = \"particles\"\n"}})
        EXPECT_EQ(asked_in_frames(text, 48, 12), 0) << name;
    EXPECT_EQ(asked_in_frames(wet_scene, 48, 12, nullptr, {}, "double"), 0);
    for (const std::string set : {"cohesion.spacing=0.02", "cohesion.relaxation=2.5",
                                  "integrator.kind=backward_euler", "integrator.limiter=0.05"})
        EXPECT_EQ(asked_in_frames(wet_scene, 48, 12, nullptr, {set}), 0) << set;
    EXPECT_EQ(
        asked_in_frames(dry_scene, 24, 12, nullptr, {"integrator.kind=explicit", "integrator.substeps=40"}),
        0);
    EXPECT_EQ(asked_in_frames(flowing_scene(1, 0.5), 96, 12), 0);
    // Beside the head: it breathes as often as the head turns.
    const Scratch scratch;
    const std::string breathes = breathing_sphere(scratch, {0.02, 0.04, 0.02, 0.04, 0.02, 0.04, 0.02}, 0.5,
                                                  "[0, -0.1, 0.12]", 0.01, 16);
    EXPECT_EQ(asked_in_frames(wet_scene + breathes, 24, 12), 0);
    NoPull model;
    EXPECT_EQ(asked_in_frames(wet_scene, 48, 12, &model), 0);
    EXPECT_GT(model.asked, 0);
}

}  // namespace
}  // namespace wetcurl

// A run of three strands of four particles, made of random numbers.
#pragma once

#include "base/run_cache.h"
#include "scratch.h"

namespace wetcurl::testing {

inline RunHeader small_header() {
    RunHeader h;
    h.scene = "title = \"two by two\"\nfps = 30\n";
    h.scene_folder = "/scenes";
    h.method = "simulated wet";
    h.fps = 30;
    h.seed = 18446744073709551615ull;
    h.stride = 2;
    h.groom.rest = Strands(3, 4);
    Random random(1);
    for (auto& p : h.groom.rest.points) p = cast<float>(random.vector());
    h.groom.normal.assign(3, {0, 1, 0});
    h.groom.grid = {2, 2, {0, 1, -1, 2}};
    h.saturation.assign(12, 0.25f);
    h.energy_kinds = {"kinetic", "stretch"};
    h.stages = {"solve", "contact", "cohesion"};
    h.inputs = {"head.obj 0123"};
    h.terms_present = "stretch, bend";
    h.terms_absent = "air";
    return h;
}

// Frame f: other numbers in each.
inline RunFrame small_frame(int f) {
    Random random(unsigned(10 + f));
    RunFrame frame;
    frame.head = {random.rotation(), random.vector()};
    frame.positions = Strands(3, 4);
    frame.displayed = Strands(3, 4);
    for (auto* s : {&frame.positions, &frame.displayed})
        for (auto& p : s->points) p = cast<float>(random.vector());
    frame.energy = {float(f), 2};
    frame.stage_seconds = {0.1f, 0.2f, float(f)};
    frame.contact.assign(12, uint8_t(f % 2));
    frame.saturation.assign(12, 0.125f * float(f % 9));
    frame.water = {1e-6, 2e-6, 3e-6 * f, 4e-7};
    frame.seconds = 0.5 * f;
    return frame;
}

inline bool same_points(const Strands& a, const Strands& b) {
    if (a.count != b.count || a.particles != b.particles) return false;
    for (size_t i = 0; i < a.points.size(); ++i)
        if (norm(a.points[i] - b.points[i]) != 0) return false;
    return true;
}

}  // namespace wetcurl::testing

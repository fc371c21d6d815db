// What soaking on a device needs of a scene. Host only.
#pragma once

#include <algorithm>
#include <vector>

#include "cuda/water/soaking_kernel_body.h"
#include "solver/scene/rest_state.h"

namespace wetcurl {

// The arrays of DryCurls one after the other, in its order; empty where no curl is blended.
struct DryCurlArrays {
    std::vector<CurlOfStrand> curl;
    std::vector<Vec3d> vectors;    // (5, edge, strand)
    std::vector<Quatd> rotations;  // (2, edge, strand)
    std::vector<double> lengths;   // (2, edge, strand); empty: no core
};
inline DryCurlArrays dry_curl_arrays(const Scene& scene) {
    if (!scene.curl || scene.curl->printed) return {};
    const size_t strands = size_t(scene.groom.rest.count), edges = size_t(scene.groom.rest.particles - 1),
                 cells = strands * edges;
    const bool core = scene.term<Core>().has_value();
    DryCurlArrays out{std::vector<CurlOfStrand>(strands), std::vector<Vec3d>(5 * cells),
                      std::vector<Quatd>(2 * cells), std::vector<double>(core ? 2 * cells : 0)};
#pragma omp parallel for schedule(dynamic)
    for (size_t s = 0; s < strands; ++s) {
        Soaking soaking;
        rest_state_of(scene, int(s), &soaking);
        const auto v = soaking.curl->view();
        out.curl[s] = v.curl;
        auto put = [&](size_t part, const auto* from, auto& to) {
            for (size_t i = 0; i < edges; ++i) to[part * cells + i * strands + s] = from[i];
        };
        put(0, v.dry, out.vectors), put(1, v.straight_edges, out.vectors);
        put(2, v.straight, out.vectors), put(3, v.helix, out.vectors), put(4, v.drawn, out.vectors);
        put(0, v.frames, out.rotations), put(1, v.bend_left, out.rotations);
        if (core) put(0, soaking.core.data(), out.lengths), put(1, soaking.rest_core.data(), out.lengths);
    }
    return out;
}
// A view of those arrays, wherever they lie now.
inline DryCurls dry_curls(const Scene& scene, const CurlOfStrand* curl, const Vec3d* vectors,
                          const Quatd* rotations, const double* lengths) {
    const int strands = scene.groom.rest.count, edges = scene.groom.rest.particles - 1;
    const size_t cells = size_t(strands) * size_t(edges);
    if (!scene.curl || scene.curl->printed) return {};
    const auto& core = scene.term<Core>();
    return {strands,
            edges,
            curl,
            vectors,
            vectors + cells,
            vectors + 2 * cells,
            vectors + 3 * cells,
            vectors + 4 * cells,
            rotations,
            rotations + cells,
            core ? core->beta : 0,
            core ? lengths : nullptr,
            core ? lengths + cells : nullptr};
}

// Of the printed curl's helix, (strand, particle); rest_length alike [m]. Empty where no curl is printed.
template <class T>
std::vector<Vec3d> printed_edges(const Scene& scene, const std::vector<T>& rest_length) {
    if (!scene.curl || !scene.curl->printed) return {};
    const int n = scene.groom.rest.particles;
    std::vector<Vec3d> out(rest_length.size(), {0, 0, 0});
#pragma omp parallel for schedule(static)
    for (int s = 0; s < scene.groom.rest.count; ++s)
        for (int i = 0; i + 1 < n; ++i) {
            const size_t k = size_t(s) * size_t(n) + size_t(i);
            out[k] = printed_edge(*scene.curl, double(rest_length[k]), i);
        }
    return out;
}
// Dry springs of a fibre, (3, strand, particle); empty without one.
inline std::vector<double> dry_springs(const Scene& scene) {
    if (!scene.fibre) return {};
    const size_t n = size_t(scene.groom.rest.particles), count = size_t(scene.groom.rest.count) * n;
    std::vector<double> out(3 * count, 0);
#pragma omp parallel for schedule(static)
    for (int s = 0; s < scene.groom.rest.count; ++s) {
        Soaking soaking;
        rest_state_of(scene, s, &soaking);
        const Fibre::Springs& own = soaking.springs;
        const std::vector<double>* kinds[] = {&own.stretch, &own.bend, &own.twist};
        for (size_t kind = 0; kind < 3; ++kind)
            std::copy(kinds[kind]->begin(), kinds[kind]->end(),
                      out.begin() + long(kind * count + size_t(s) * n));
    }
    return out;
}
inline Weighing weighing(const Scene& scene, const Vec3d* printed_edge, const double* springs) {
    return {.particles = scene.groom.rest.particles,
            .absorbed = scene.wetness->absorbed,
            .volume_density = scene.volume_density,
            .push_weight = scene.curl ? scene.curl->w_h : 0,
            .printed_edge = printed_edge,
            .wet = scene.fibre ? scene.fibre->wet_springs() : WetSprings{},
            .springs = scene.fibre ? springs : nullptr,
            .count = size_t(scene.groom.rest.count) * size_t(scene.groom.rest.particles)};
}

}  // namespace wetcurl

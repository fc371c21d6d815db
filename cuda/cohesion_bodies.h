// Eq 10 on a device, particle by particle: neighbour lists, displacements, and the smoothing along a strand
// by the 32 lanes of a warp. The formulas are those of solver/terms/cohesion.h; the reference is
// solver/passes/cohesion.h. Ours.
#pragma once

#include <cstdint>

#include "base/geometry/filter.h"
#include "cuda/cell_search.h"
#include "solver/passes/contact.h"
#include "solver/terms/cohesion.h"

namespace wetcurl {

// What a particle's neighbours ask of it, in one sector of memory: V = m / rho and sigma V.
struct alignas(32) HairPoint {
    float x, y, z, volume, wet_volume;
    WETCURL_HD Vec3f position() const { return {x, y, z}; }
};

// Arrays of (strand, particle) unless said; `count` particles, and one more without volume where noted.
struct CohesionMemory {
    CellSearch search;  // within Eq 10's h
    uint32_t count;
    int particles;             // a strand
    HairPoint *now, *next;     // one more
    float *beta, *own_weight;  // (strand) of the smoothing; Eq 10's own_weight
    // Neighbour lists of 32 particles in step: entry k of lane l at list[offset + 32 k + l], filled up with
    // `count`, who is nobody. Groups never cross a block of strands.
    uint32_t *list, *offset, *capacity, *length;
};

struct CohesionBodies {
    Cohesion term;
    CohesionMemory m;

    WETCURL_HD void place(uint32_t id, const Vec3f& p, float volume, float wet_volume) const {
        m.now[id] = m.next[id] = {p.x, p.y, p.z, volume, wet_volume};
    }
    WETCURL_HD void measure(int strand) const {
        const HairPoint* p = m.now + size_t(strand) * size_t(m.particles);
        double length = 0;
        for (int i = 0; i + 1 < m.particles; ++i)
            length += norm(cast<double>(p[i + 1].position() - p[i].position()));
        const float segment = float(length / (m.particles - 1));
        m.own_weight[strand] = float(term.own_weight(segment));
        m.beta[strand] = float(filter_beta(segment, term.coherence));
    }
    // Calls visit(j) for each particle that Eq 10 sees from particle `id`.
    template <class Visit>
    WETCURL_HD void neighbours(uint32_t id, Visit visit) const {
        m.search.neighbours(id, m.now[id].position(),
                            [&](uint32_t, const SortedPoint& other) { visit(other.id); });
    }

    // p_i^w - p_i over a list of `length` entries, 32 apart.
    WETCURL_HD Vec3f displacement(const HairPoint* now, uint32_t id, const uint32_t* list,
                                  uint32_t length) const {
        const HairPoint own = now[id];
        Cohesion::Sums<float> sums{{0, 0, 0}, 0};
        for (uint32_t k = 0; k < length; ++k) {
            const HairPoint other = now[list[32 * k]];
            sums.add(other.position() - own.position(), m.search.radius, other.volume, other.wet_volume);
        }
        return term.displacement(sums, own.volume * m.own_weight[id / uint32_t(m.particles)]);
    }

    // A strand after the last pass, no edge longer than the term allows: place(id, x), root to tip.
    template <class Place>
    WETCURL_HD void within_lengths(int strand, const HairPoint* now, const Vec3f* simulated,
                                   Place place) const {
        uint32_t id = uint32_t(strand) * uint32_t(m.particles);
        Vec3f x = now[id].position(), before = simulated[id];
        place(id, x);
        for (int i = 1; i < m.particles; ++i) {
            const Vec3f p = simulated[++id];
            x = term.within_length(x, now[id].position(), norm(p - before));
            before = p;
            place(id, x);
        }
    }
};

// u_i <- u_{i-1} + beta (u_i - u_{i-1}) over 1 .. n-1, back over n-2 .. 1, twice, as the reference does; u_0
// stays. Each lane of a warp takes a chunk, as if nothing came before it; what did, decays by 1 - beta a step
// and is added. `each_lane(f)` calls f(lane) for all 32 and ends in a barrier; `ends`: (32).
template <class EachLane>
WETCURL_HD void smooth_along(float* u, int n, float beta, float* ends, EachLane each_lane) {
    const float a = 1 - beta;
    const int chunk = ((n + 31) / 32) | 1;  // odd: no two lanes on one bank
    float decay = 1;
    for (int k = 0; k < chunk; ++k) decay *= a;
    for (int sweep = 0; sweep < 4; ++sweep) {
        const bool back = sweep % 2 == 1;
        // Step s of the sweep stands at s + 1 from the root, or from the tip.
        const int steps = back ? n - 2 : n - 1, start = back ? n - 1 : 0, sign = back ? -1 : 1;
        each_lane([&](int lane) {
            float last = 0;
            for (int s = lane * chunk; s < (lane + 1) * chunk && s < steps; ++s) {
                float& value = u[start + sign * (s + 1)];
                value = last = a * last + beta * value;
            }
            ends[lane] = last;
        });
        each_lane([&](int lane) {
            float carry = u[start];
            for (int l = 0; l < lane; ++l) carry = ends[l] + decay * carry;
            for (int s = lane * chunk; s < (lane + 1) * chunk && s < steps; ++s)
                u[start + sign * (s + 1)] += (carry *= a);
        });
    }
}

// Pushed out of solids, as far as `allowed` for what is attached to the head.
template <class Solids>
WETCURL_HD Vec3f pushed_out(const Solids& solids, Vec3f x, float allowed) {
    for (const auto& solid : solids) {
        const auto d = distance_in_world(solid, cast<typename std::decay_t<decltype(solid)>::Number>(x));
        const float depth = (solid.attached ? allowed : 0.f) - float(d.phi);
        if (depth > 0) x += depth * cast<float>(d.normal);
    }
    return x;
}

}  // namespace wetcurl

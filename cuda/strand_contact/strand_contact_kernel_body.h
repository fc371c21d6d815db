// Contact between strands on a device, particle by particle. The formulas are those of
// solver/terms/strand_contact.h; the reference is solver/strand_contact/strand_contact_pass.h. Differs:
// neighbours are found anew in every substep, since only the host could say that lists still hold.
#pragma once

#include "cuda/chain/strand_memory.h"
#include "cuda/device/cell_search.h"
#include "solver/terms/strand_contact.h"

namespace wetcurl {

// How fast a particle is [m/s], and 1/m [1/kg] as strands feel it of each other.
struct alignas(16) StrandContactPoint {
    float x, y, z, weight;
    WETCURL_HD Vec3f velocity() const { return {x, y, z}; }
};

// First all particles `count`, then all are pushed.
template <class T>
struct StrandContactKernelBody {
    StrandContact term;
    StrandContact::Step step;
    CellSearch search;   // within strand_contact_radius
    const Vec3f* drawn;  // (strand, particle) in the groom as drawn
    // In the order of cells.
    StrandContactPoint* point;
    float* contacts;  // pairs in touch

    // Calls visit(j, x_k - x_j, d_kj²) for each particle j near to k.
    template <class Visit>
    WETCURL_HD void neighbours(uint32_t k, Visit visit) const {
        const SortedPoint own = search.sorted[k];
        const Vec3f own_drawn = drawn[own.id];
        search.neighbours(own.id, own.position(), [&](uint32_t j, const SortedPoint& other) {
            visit(j, own.position() - other.position(), term.square_distance(own_drawn - drawn[other.id]));
        });
    }
    // Takes up how fast and how heavy k is, and counts its contacts. Returns how many are near.
    WETCURL_HD uint32_t count(uint32_t k, const StrandMemory<T>& m) const {
        const uint32_t id = search.sorted[k].id;
        const Vec3f v = cast<float>(m.v[id]);
        // Particles 0 and 1 go where the head takes them.
        point[k] = {v.x, v.y, v.z, id % uint32_t(m.n) < 2 ? 0.f : 1 / float(m.mass[id])};
        uint32_t near = 0, found = 0;
        neighbours(k, [&](uint32_t, const Vec3f& d, float square) { ++near, found += dot(d, d) < square; });
        contacts[k] = float(found);
        return near;
    }
    // Its impulses change the velocities of the history alike.
    WETCURL_HD void push(uint32_t k, const StrandMemory<T>& m) const {
        const StrandContactPoint own = point[k];
        const float own_contacts = contacts[k];
        if (!(own_contacts > 0 && own.weight > 0)) return;
        Vec3f all{0, 0, 0};
        neighbours(k, [&](uint32_t j, const Vec3f& d, float square) {
            const StrandContactPoint other = point[j];
            all += StrandContact::impulse(step, d, own.velocity() - other.velocity(), square,
                                          1 / (own.weight + other.weight),
                                          1 / maximum(own_contacts, contacts[j]));
        });
        const Vec3<T> dv = cast<T>(own.weight * all);
        const uint32_t id = search.sorted[k].id;
        m.v[id] += dv, m.v_before[id] += dv;
    }
};
// Of the search: rounding must not hide a pair in touch.
inline double strand_contact_radius(const StrandContact& term) { return 1.0001 * term.radius; }

}  // namespace wetcurl

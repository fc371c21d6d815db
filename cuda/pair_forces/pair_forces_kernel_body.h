// Forces on wet particles by others of other strands, and by sampled solids, particle by particle as a device
// takes them. The formulas are the methods' own; the reference is each one's PairForces.
#pragma once

#include "cuda/device/cell_search.h"
#include "solver/compared/boundary_particles2013.h"
#include "solver/compared/kim2016.h"
#include "solver/compared/lin2015.h"
#include "solver/terms/cohesion.h"

namespace wetcurl {

// On one particle, by so many others.
struct Pull {
    Vec3d force{0, 0, 0};  // [N]
    double stiffness = 0;  // [N/m]
    uint32_t pairs = 0;
};

// Where a particle is [m], what it weighs [kg], and sigma.
struct PairPoint {
    Vec3d x;
    double mass, wet;
};
// In the order of cells, but for the search's own arrays.
struct PairMemory {
    CellSearch search;  // of positions from the first particle: floats have no digits to spare far away
    PairPoint* point;
    double* density;  // [kg/m^3] and normal: kim's alone
    Vec3d* normal;

    // Particle k of the order: x, m and sigma (strand, particle).
    WETCURL_HD void take(uint32_t k, const Vec3d* x, const double* mass, const float* saturation) const {
        const uint32_t id = search.sorted[k].id;
        point[k] = {x[id], mass[id], double(saturation[id])};
    }
    // Calls visit(i, j) with the points of k and of each wet neighbour j, where k is wet itself.
    template <class Visit>
    WETCURL_HD void neighbours(uint32_t k, Visit visit) const {
        const PairPoint own = point[k];
        if (!(own.wet > 0)) return;
        const SortedPoint at = search.sorted[k];
        search.neighbours(at.id, at.position(), [&](uint32_t j, const SortedPoint&) {
            if (point[j].wet > 0) visit(own, point[j], j);
        });
    }
};

// A method says what j does to i, both with their ranks where it needs them; and what it prepares, one pass
// over all particles after the other.
struct LinPairs {
    Lin2015 method;
    akinci2013::KernelTable K;
    static constexpr int preparations = 0;
    WETCURL_HD void pull(const PairMemory&, uint32_t, uint32_t, const PairPoint& i, const PairPoint& j,
                         Pull& sum) const {
        sum.force += method.pair_force(i.x - j.x, i.mass, j.mass, i.wet * j.wet);
    }
    WETCURL_HD double energy(const PairPoint& i, const PairPoint& j) const {
        return akinci2013::pair_energy(method.beta, i.wet, j.wet, i.mass, j.mass, K(norm(i.x - j.x)));
    }
};
struct KimPairs {
    Kim2016 method;
    akinci2013::KernelTable K;
    static constexpr int preparations = 2;
    WETCURL_HD void prepare(int pass, const PairMemory& m, uint32_t k) const {
        double density = method.own_density(m.point[k].mass);
        Vec3d normal{0, 0, 0};
        m.neighbours(k, [&](const PairPoint& i, const PairPoint& j, uint32_t rank) {
            if (pass == 0)
                density += method.density_part(i.x - j.x, j.mass);
            else
                normal += j.wet * method.normal_part(i.x - j.x, j.mass / m.density[rank]);
        });
        if (pass == 0)
            m.density[k] = density;
        else
            m.normal[k] = normal;
    }
    WETCURL_HD void pull(const PairMemory& m, uint32_t k, uint32_t rank, const PairPoint& i,
                         const PairPoint& j, Pull& sum) const {
        sum.force +=
            method.pair_force(i.x - j.x, m.normal[k] - m.normal[rank], i.mass, j.mass, i.wet * j.wet);
    }
    WETCURL_HD double energy(const PairPoint& i, const PairPoint& j) const {
        return akinci2013::pair_energy(method.gamma, i.wet, j.wet, i.mass, j.mass, K(norm(i.x - j.x)));
    }
};
struct CohesionPairs {
    Cohesion method;
    static constexpr int preparations = 0;
    WETCURL_HD void pull(const PairMemory&, uint32_t, uint32_t, const PairPoint& i, const PairPoint& j,
                         Pull& sum) const {
        const Vec3d d = j.x - i.x;
        const double k = method.pair_spring(norm(d), i.mass, j.mass, i.wet * j.wet);
        sum.force += k * d;
        sum.stiffness += Cohesion::outweighed * k;
    }
    WETCURL_HD double energy(const PairPoint& i, const PairPoint& j) const {
        return method.pair_energy(norm(i.x - j.x), i.mass, j.mass, i.wet * j.wet);
    }
};

// A method's forces, a particle of the order of cells after the other.
template <class Method>
struct StrandPulls {
    static constexpr int preparations = Method::preparations;
    Method method;
    PairMemory m;

    WETCURL_HD uint32_t count() const { return m.search.count; }
    WETCURL_HD uint32_t id(uint32_t k) const { return m.search.sorted[k].id; }
    WETCURL_HD void prepare(int pass, uint32_t k) const {
        if constexpr (preparations > 0) method.prepare(pass, m, k);
    }
    WETCURL_HD Pull pull(uint32_t k) const {
        Pull sum;
        m.neighbours(k, [&](const PairPoint& i, const PairPoint& j, uint32_t rank) {
            method.pull(m, k, rank, i, j, sum);
            ++sum.pairs;
        });
        return sum;
    }
    // [J] of particle k: half of each of its pairs'.
    WETCURL_HD double energy(uint32_t k) const {
        double sum = 0;
        m.neighbours(
            k, [&](const PairPoint& i, const PairPoint& j, uint32_t) { sum += 0.5 * method.energy(i, j); });
        return sum;
    }
};

// A solid's boundary particles in its own coordinates: the search, built once, is of them.
struct SampledSurface {
    CellSearch search;
    const double* volume;  // [m^3], as they were sampled
};
// Adhesion to them, a particle (strand, particle) after the other.
struct BoundaryPulls {
    static constexpr int preparations = 0;
    BoundaryParticles2013 method;
    akinci2013::KernelTable K;
    uint32_t particles;
    const SampledSurface* surface;
    const Pose* pose;  // of each surface, when the substep begins
    int surfaces;
    const Vec3d* x;
    const double* mass;
    const float* saturation;

    WETCURL_HD uint32_t count() const { return particles; }
    WETCURL_HD uint32_t id(uint32_t k) const { return k; }
    WETCURL_HD void prepare(int, uint32_t) const {}
    // Calls visit(sigma m [kg], x - y [m] in the solid's coordinates, rotation, volume [m^3]) for each
    // boundary particle y in reach.
    template <class Visit>
    WETCURL_HD void around(uint32_t k, Visit visit) const {
        const double wet_mass = double(saturation[k]) * mass[k];
        if (!(wet_mass > 0)) return;
        for (int s = 0; s < surfaces; ++s) {
            const CellSearch& search = surface[s].search;
            const Vec3d at = pose[s].inverse(x[k]);
            search.neighbours(search.count, cast<float>(at), [&](uint32_t, const SortedPoint& y) {
                const Vec3d d = at - cast<double>(y.position());
                if (method.reaches(d)) visit(wet_mass, d, pose[s].rotation, surface[s].volume[y.id]);
            });
        }
    }
    WETCURL_HD Pull pull(uint32_t k) const {
        Pull sum;
        around(k, [&](double wet_mass, const Vec3d& d, const Quatd& rotation, double volume) {
            sum.force += rotate(rotation, method.pair_force(d, wet_mass, volume));
            ++sum.pairs;
        });
        return sum;
    }
    WETCURL_HD double energy(uint32_t k) const {
        double sum = 0;
        around(k, [&](double wet_mass, const Vec3d& d, const Quatd&, double volume) {
            sum -= method.strength(wet_mass, volume) * K(norm(d));
        });
        return sum;
    }
};
// Of the search around them: rounding to floats must not hide one in reach.
inline double search_radius(const BoundaryParticles2013& method) { return 1.01 * method.h; }

}  // namespace wetcurl

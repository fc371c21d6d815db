// What of the strands follows the water in them, particle by particle and strand by strand, by the formulas
// of `soak` and `put_water`.
#pragma once

#include "base/strided.h"
#include "solver/terms/fibre.h"
#include "solver/terms/wet_curl.h"
#include "solver/terms/wetness.h"

namespace wetcurl {

// (strand, particle). Null where no present term needs it.
template <class T>
struct SoakedStrands {
    T *mass, *saturation, *rest_core;
    T *stretch_spring, *bend_spring, *twist_spring;
    Vec3<T>*target, *push;
    float *volume, *wet_volume;  // of Eq 10: V and sigma V [m³]
};

// What a particle's share of it comes from.
struct Weighing {
    int particles;                    // of a strand
    double absorbed, volume_density;  // m_absorbed, rho [kg/m³]
    double push_weight;               // w_h
    const Vec3d* printed_edge;        // (strand, particle); null: no curl is printed
    WetSprings wet;                   // of fibres
    const double* springs;            // dry, of edges, (3, strand, particle); null: no fibres
    size_t count;                     // of particles

    // Particle k of (strand, particle), of `dry_mass` [kg].
    template <class T>
    WETCURL_HD void operator()(size_t k, float sigma, double dry_mass, const SoakedStrands<T>& to) const {
        const double mass = wet_mass(dry_mass, absorbed, sigma);
        to.mass[k] = T(mass);
        if (to.saturation) to.saturation[k] = T(sigma);
        if (to.volume) {
            const float volume = float(mass / volume_density);
            to.volume[k] = volume, to.wet_volume[k] = volume * sigma;
        }
        if (springs) {
            const WetSprings::Factors by = wet.at(double(sigma));
            to.stretch_spring[k] = T(springs[k] * by.stretch);
            to.bend_spring[k] = T(springs[count + k] * by.bend);
            if (to.twist_spring) to.twist_spring[k] = T(springs[2 * count + k] * by.twist);
        }
        if (printed_edge && (k + 1) % size_t(particles) != 0)
            to.push[k] = cast<T>(push_weight * sigma * printed_edge[k]);
    }
};

// Dry strands beside each other, (edge, strand).
struct DryCurls {
    int strands, edges;
    const CurlOfStrand* curl;  // (strand); null: no curl is blended
    const Vec3d *dry, *straight_edges, *straight, *helix, *drawn;
    const Quatd *frames, *bend_left;
    double beta;                      // of the core's filter
    const double *core, *drawn_core;  // null: no core

    // Strand s at `saturation` (particle). Room: target (edge, strand), points (particle, strand).
    template <class T>
    WETCURL_HD void soak(int s, const float* saturation, Vec3d* target, Vec3d* points,
                         const SoakedStrands<T>& to) const {
        const WetCurlView<Strided<const Vec3d>, Strided<const Quatd>> view{
            edges,        curl[s],       of(s, dry),       of(s, straight_edges), of(s, straight),
            of(s, helix), of(s, frames), of(s, bend_left), of(s, drawn)};
        const Strided<Vec3d> t = of(s, target), p = of(s, points);
        const size_t first = size_t(s) * size_t(edges + 1);
        view.at(saturation, t, p);
        for (size_t i = 0; i < size_t(edges); ++i) to.target[first + i] = cast<T>(t[i]);
        if (core)
            core_of_curl(edges, beta, t, of(s, core), of(s, drawn_core), p,
                         [&](size_t i, double length) { to.rest_core[first + i] = T(length); });
    }

  private:
    template <class V>
    WETCURL_HD Strided<V> of(int s, V* all) const {
        return {all + s, size_t(strands)};
    }
};

}  // namespace wetcurl

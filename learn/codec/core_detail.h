// A strand as its core (the smoothed strand) and the detail around it (the curl).
// The filter is Eq 2's. Differs: run from root to tip and back, since one run alone lags behind a bent
// strand, and the lag would count as curl.
#pragma once

#include <cstdlib>
#include <vector>

#include "base/geometry/filter.h"
#include "base/strands.h"

namespace wetcurl {

// Smoothing of a core, alpha a tenth of the strand's length: a curl of two turns or more is detail, a bend is
// core. l / alpha = 10 / (n - 1) for n particles, whatever the length.
inline float core_beta(int particles) { return float(filter_beta(10.0 / (particles - 1), 1.0)); }

// d = G e over n edges as Eq 2, but started half a strand early on the mirrored edges: the first edge alone
// is mostly curl and would tilt the core. `edge(i)` gives e_i, `store(i, d_i)` takes the result.
template <class Edge, class Store>
void smooth_mirrored(int n, float beta, Edge edge, Store store) {
    const int early = n / 2;
    smooth_edges<float>(
        early + n, beta, [&](int i) { return edge(std::abs(i - early)); },
        [&](int i, const Vec3f& d) {
            if (i >= early) store(i - early, d);
        });
}

// core (n) [m] of the n particles p [m]; both start at the root. `core` must not overlap p.
inline void core_of(const Vec3f* p, int n, float beta, Vec3f* core) {
    Vec3f* d = core + 1;  // edges of the core, then summed in place
    const int edges = n - 1;
    smooth_mirrored(
        edges, beta, [&](int i) { return p[i + 1] - p[i]; }, [&](int i, const Vec3f& e) { d[i] = e; });
    smooth_mirrored(
        edges, beta, [&](int i) { return d[edges - 1 - i]; },
        [&](int i, const Vec3f& e) { d[edges - 1 - i] = e; });
    core[0] = p[0];
    for (int i = 1; i < n; ++i) core[i] += core[i - 1];
}

// Of all strands, into as many of as many particles.
void take_cores(const Strands& strands, Strands& cores);

// The turn that takes the edges of one core to those of another. It is carried on from edge to edge, so that
// it does not flip where the two point opposite ways.
template <class S>
struct CarriedTurn {
    Quat<S> turn = Quat<S>::identity();
    // An edge of each core, in order from the root [m]; one without a direction leaves the turn as it is.
    WETCURL_HD void follow(const Vec3<S>& from, const Vec3<S>& to) {
        const Vec3<S> turned = rotate(turn, from);
        const auto both = minimum(norm(turned), norm(to)) > S(tiny_length<S>);
        const Quat<S> next =
            normalized(minimal_rotation(normalized(turned, to), normalized(to, turned)) * turn);
        turn = select(both, next, turn);
    }
};

// Root mean square distance of the detail from its mean [m]: the radius of a helix. `core` is scratch (n).
float curl_radius(const Vec3f* p, int n, float beta, Vec3f* core);
// One a strand.
std::vector<float> curl_radii(const Strands& strands);

}  // namespace wetcurl

// A strand as its core (the smoothed strand) and the detail around it (the curl).
// The filter is Eq 2's. Differs: run from root to tip and back, since one run alone lags behind a bent
// strand, and the lag would count as curl.
#pragma once

#include <limits>
#include <vector>

#include "base/geometry/filter.h"
#include "base/strands.h"

namespace wetcurl {

// Smoothing of a core, alpha a tenth of the strand's length: a curl of two turns or more is detail, a bend is
// core. l / alpha = 10 / (n - 1) for n particles, whatever the length.
inline float core_beta(int particles) { return float(filter_beta(10.0 / (particles - 1), 1.0)); }

// d = G e over n edges as Eq 2, but started half a strand early on the mirrored edges: the first edge alone
// is mostly curl and would tilt the core. `edge(i)` gives e_i, `store(i, d_i)` takes the result.
template <class S, class Edge, class Store>
WETCURL_HD void smooth_mirrored(int n, Plain<S> beta, Edge edge, Store store) {
    const int early = n / 2;
    smooth_edges<S>(
        early + n, beta, [&](int i) { return edge(i < early ? early - i : i - early); },
        [&](int i, const Vec3<S>& d) {
            if (i >= early) store(i - early, d);
        });
}

// core (n) [m] of the n particles p [m], of one strand or of a strand a lane; both start at the root. `core`
// must not overlap p.
template <class S>
WETCURL_HD void core_of(const Vec3<S>* p, int n, Plain<S> beta, Vec3<S>* core) {
    Vec3<S>* d = core + 1;  // edges of the core, then summed in place
    const int edges = n - 1;
    smooth_mirrored<S>(
        edges, beta, [&](int i) { return p[i + 1] - p[i]; }, [&](int i, const Vec3<S>& e) { d[i] = e; });
    smooth_mirrored<S>(
        edges, beta, [&](int i) { return d[edges - 1 - i]; },
        [&](int i, const Vec3<S>& e) { d[edges - 1 - i] = e; });
    core[0] = p[0];
    for (int i = 1; i < n; ++i) core[i] += core[i - 1];
}

// Of all strands.
Strands cores_of(const Strands& strands);

// The turn that takes the edges of one core to those of another. It is carried on from edge to edge, so that
// it does not flip where the two point opposite ways.
template <class S>
struct CarriedTurn {
    Quat<S> turn = Quat<S>::identity();
    // An edge of each core, in order from the root [m]. One of 10 nm or less, which positions are not rounded
    // to, has no direction and leaves the turn as it is.
    WETCURL_HD void follow(const Vec3<S>& from, const Vec3<S>& to) {
        const Vec3<S> a = rotate(turn, from);
        const S square_a = dot(a, a), square_b = dot(to, to);
        const auto both = minimum(square_a, square_b) > S(1e-16f);
        // As minimal_rotation, by a factor |a| |b|: of roots and quotients there is but one each.
        const S lengths = sqrt(square_a * square_b), along = dot(a, to);
        const Vec3<S> axis =
            select(a.x * a.x > S(0.5f) * square_a, Vec3<S>{-a.y, a.x, S(0)}, Vec3<S>{S(0), -a.z, a.y});
        const auto opposed = along < S(4 * std::numeric_limits<Plain<S>>::epsilon() - 1) * lengths;
        const Vec3<S> across = select(opposed, axis, cross(a, to));
        const Quat<S> q{select(opposed, S(0), lengths + along), across.x, across.y, across.z};
        turn = select(both, renormalized(normalized(q) * turn), turn);
    }
};

// Mean square of how far two strands of n particles lie apart, seen from their roots [m^2].
float square_apart(const Vec3f* a, const Vec3f* b, int n);

// Root mean square distance of the detail from its mean [m]: the radius of a helix. `core` is scratch (n).
float curl_radius(const Vec3f* p, int n, float beta, Vec3f* core);
// One a strand.
std::vector<float> curl_radii(const Strands& strands);

}  // namespace wetcurl

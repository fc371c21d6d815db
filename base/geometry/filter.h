// The smoothing filter of Eq 2 on the edges of a strand, and its adjoint.
// Differs: the start is d_{-2} = d_{-1} = e_0 (print drops the minus signs), l is the mean rest length of a
// segment.
#pragma once

#include <cmath>

#include "base/vec3.h"

namespace wetcurl {

// beta = min(1, 1 - exp(-l / alpha)); l, alpha [m]. alpha = 0 is the identity.
inline double filter_beta(double l, double alpha) {
    return alpha > 0 ? std::min(1.0, 1.0 - std::exp(-l / alpha)) : 1.0;
}

// d = G e over n edges (Eq 2). `edge(i)` gives e_i, `store(i, d_i)` takes the result.
template <class S, class Edge, class Store>
WETCURL_HD void smooth_edges(int n, Plain<S> beta, Edge edge, Store store) {
    const S a(2 * (1 - beta)), b((1 - beta) * (1 - beta)), c(beta * beta);
    Vec3<S> d1 = edge(0), d2 = d1;
    for (int i = 0; i < n; ++i) {
        Vec3<S> d = a * d1 - b * d2 + c * edge(i);
        store(i, d);
        d2 = d1;
        d1 = d;
    }
}

// y = G^T g over n edges: the recursion reversed from zero, row 0 from the conservation of sums
// (G reproduces constants, so sum(G^T g) = sum(g)).
template <class S, class In, class Store>
WETCURL_HD void smooth_edges_adjoint(int n, Plain<S> beta, In in, Store store) {
    const S a(2 * (1 - beta)), b((1 - beta) * (1 - beta)), c(beta * beta);
    const Vec3<S> zero{S(0), S(0), S(0)};
    Vec3<S> d1 = zero, d2 = zero, rest = zero;
    for (int i = n - 1; i >= 1; --i) {
        Vec3<S> g = in(i);
        Vec3<S> d = a * d1 - b * d2 + g;
        Vec3<S> y = c * d;
        rest += g - y;
        store(i, y);
        d2 = d1;
        d1 = d;
    }
    store(0, rest + in(0));
}

}  // namespace wetcurl

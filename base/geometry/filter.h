// Smoothing along a strand: the filter of Eq 2 on its edges and its adjoint, and an exponential one.
// Differs: the start is d_{-2} = d_{-1} = e_0 (print drops the minus signs), l is the mean rest length of a
// segment.
#pragma once

#include <cmath>
#include <type_traits>

#include "base/vec3.h"

namespace wetcurl {

// beta = min(1, 1 - exp(-l / alpha)); l, alpha [m]. alpha = 0 is the identity.
WETCURL_HD inline double filter_beta(double l, double alpha) {
    return alpha > 0 ? minimum(1.0, 1.0 - exp(-l / alpha)) : 1.0;
}

// Eq 2 edge by edge: d_i from e_i and the two before it. One product and sum lie between d_i and d_{i-1}.
template <class S>
struct EdgeFilter {
    S a, b, c;
    Vec3<S> d1, d2;
    WETCURL_HD EdgeFilter(Plain<S> beta, const Vec3<S>& first)
        : a(2 * (1 - beta)), b((1 - beta) * (1 - beta)), c(beta * beta), d1(first), d2(first) {}
    WETCURL_HD Vec3<S> operator()(const Vec3<S>& e) {
        const Vec3<S> d = a * d1 + (c * e - b * d2);
        d2 = d1;
        d1 = d;
        return d;
    }
};

// d = G e over n edges (Eq 2). `edge(i)` gives e_i, `store(i, d_i)` takes the result.
template <class S, class Edge, class Store>
WETCURL_HD void smooth_edges(int n, Plain<S> beta, Edge edge, Store store) {
    EdgeFilter<S> filter(beta, edge(0));
    for (int i = 0; i < n; ++i) store(i, filter(edge(i)));
}

// Lengths of what becomes of the n edges of a polyline p (n + 1): store(i, |d_i|).
template <class Points, class Store>
WETCURL_HD void smoothed_lengths(int n, double beta, const Points& p, Store store) {
    smooth_edges<double>(
        n, beta, [&](int i) { return p[size_t(i) + 1] - p[size_t(i)]; },
        [&](int i, const Vec3d& d) { store(i, norm(d)); });
}

// The adjoint edge by edge from the tip: y_i from g_i and what came before, down to edge 1.
template <class S>
struct EdgeFilterAdjoint {
    S a, b, c;
    Vec3<S> d1{S(0), S(0), S(0)}, d2{S(0), S(0), S(0)};
    WETCURL_HD explicit EdgeFilterAdjoint(Plain<S> beta)
        : a(2 * (1 - beta)), b((1 - beta) * (1 - beta)), c(beta * beta) {}
    WETCURL_HD Vec3<S> operator()(const Vec3<S>& g) {
        const Vec3<S> d = a * d1 + (g - b * d2);
        d2 = d1;
        d1 = d;
        return c * d;
    }
};

// y = G^T g over n edges: the recursion reversed from zero, row 0 from the conservation of sums
// (G reproduces constants, so sum(G^T g) = sum(g)).
template <class S, class In, class Store>
WETCURL_HD void smooth_edges_adjoint(int n, Plain<S> beta, In in, Store store) {
    EdgeFilterAdjoint<S> adjoint(beta);
    Vec3<S> rest{S(0), S(0), S(0)};
    for (int i = n - 1; i >= 1; --i) {
        const Vec3<S> g = in(i), y = adjoint(g);
        rest += g - y;
        store(i, y);
    }
    store(0, rest + in(0));
}

// u_i, `at(i)`, of a strand's particles smoothed exponentially from the root to the tip and back, twice. The
// root's stays. `ahead` of them are read before the first is written.
template <int ahead = 1, class S, class At>
WETCURL_HD void smooth_along(int n, const S& beta, At at) {
    std::remove_reference_t<decltype(at(0))> last;
    // u_i, u_{i + step}, ..., `count` of them.
    auto sweep = [&](int i, int step, int count) {
        auto take = [&](auto& u) { u = last = last + beta * (u - last); };
        for (; count >= ahead; count -= ahead, i += ahead * step) {
            decltype(last) u[ahead];
            for (int k = 0; k < ahead; ++k) u[k] = at(i + k * step);
            for (int k = 0; k < ahead; ++k) take(u[k]);
            for (int k = 0; k < ahead; ++k) at(i + k * step) = u[k];
        }
        for (; count > 0; --count, i += step) take(at(i));
    };
    for (int round = 0; round < 2; ++round) {
        last = at(0);
        sweep(1, 1, n - 1);
        sweep(n - 2, -1, n - 2);
    }
}

}  // namespace wetcurl

// What a term along a strand sees of one block of strands, and the linear system that it adds to. Ours.
// S is a Pack on the CPU (a lane is a strand) and a plain number on the GPU and in tests.
#pragma once

#include "base/geometry/frames.h"
#include "base/vec3.h"

namespace wetcurl {

// One block of strands of n particles (SI units). Pointers are null where no present term needs them.
// A term adds what its elements do, `assemble(view, system, begin, end)`: those whose last particle lies in
// begin .. end - 1. An element reaches two particles back at most, so that a strand can be assembled and
// solved in one sweep.
template <class S>
struct ChainView {
    int n;                            // particles a strand; edge i joins particles i and i+1
    const Vec3<S>* x;                 // (n) positions at which forces are taken
    const Vec3<S>* v;                 // (n) velocities at which forces are taken
    const S* mass;                    // (n) [kg]
    const S* rest_length;             // (n-1) [m]
    const Vec3<S>* target;            // (n-1) tbar_i in the frame of edge i-1; entry 0 unused
    const Quat<S>* frame;             // (n-1) F_i
    const S* rest_core;               // (n-1) |bbar_i|
    const S* saturation;              // (n) sigma_i
    const Vec3<S>* push;              // (n-1) edges of the helix of Eq 9 as printed, its root-to-tip along x
    const S* phi;                     // (n) distance to the nearest solid [m]
    const Vec3<S>* normal;            // (n) its outward normal
    const Vec3<S>* surface_velocity;  // (n) of the solid there
    const S* touching;                // (n) 1 where the particle has been in contact and not let go, else 0
    const S* given_adhesion;          // (n) F.n / (sigma m a_max) from a network in Eq 11's place, or null
    const Vec3<S>* air;               // (n) velocity of the air there
    const Vec3<S>* limit_edge;        // (n-1) edges at which the strain limit is taken
    Vec3<S> turn, turn_center,
        drift;           // the root's rigid motion: angular velocity, centre, velocity of the centre
    Vec3<S> chord;       // x_{n-1} - x_0
    Vec3<S>* core_pull;  // (2n) the core's force along each edge in the first half, made by its `prepare`
};

// Forces f and, for the implicit step, the block-pentadiagonal K = h C + h² H, upper half.
template <class S>
struct ChainSystem {
    S h;
    Vec3<S>* force;     // (n) [N]
    Sym3<S>* diagonal;  // (n) K(i, i); null: forces alone
    Mat3<S>* upper1;    // (n) K(i, i+1)
    Mat3<S>* upper2;    // (n) K(i, i+2); null where no term couples so far

    WETCURL_HD bool with_matrix() const { return diagonal != nullptr; }

    // A force along edge i: +g on particle i, -g on i+1.
    WETCURL_HD void add_edge_force(int i, const Vec3<S>& g) const {
        force[i] += g;
        force[i + 1] -= g;
    }
    // An edge stiffness: k (x_{i+1} - x_i) between particles i and i+1.
    WETCURL_HD void add_edge_matrix(int i, const Sym3<S>& k) const {
        diagonal[i] += k;
        diagonal[i + 1] += k;
        upper1[i] -= to_mat3(k);
    }
};

// All elements of a strand.
template <class Term, class S>
WETCURL_HD void assemble(const Term& term, const ChainView<S>& c, const ChainSystem<S>& a) {
    if constexpr (requires { term.prepare(c); }) term.prepare(c);
    term.assemble(c, a, 0, c.n);
}

template <class S>
WETCURL_HD Vec3<S> edge(const ChainView<S>& c, int i) {
    return c.x[i + 1] - c.x[i];
}

}  // namespace wetcurl

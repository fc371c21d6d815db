// What a term along a strand sees of one block of strands, and the linear system that it adds to.
// S is a Pack on the CPU (a lane is a strand) and a plain number on the GPU and in tests.
#pragma once

#include "base/geometry/frames.h"
#include "base/vec3.h"
#include "solver/motion/root_motion.h"
#include "solver/terms/strand_arrays.h"

namespace wetcurl {

// One block of strands of n particles (SI units): their arrays, at positions and velocities at which forces
// are taken, and what is told of solids, air and head. Pointers are null where no present term needs them. A
// term adds what its elements do, `assemble(view, system, begin, end)`: those whose last particle lies in
// begin .. end - 1. An element reaches two particles back at most, so that a strand can be assembled and
// solved in one sweep.
template <class S>
struct ChainView : StrandArrays<S, ConstPointer> {
    int n;                            // particles a strand; edge i joins particles i and i+1
    const S* phi;                     // (n) distance to the nearest solid [m]
    const Vec3<S>* normal;            // (n) its outward normal
    const Vec3<S>* surface_velocity;  // (n) of the solid there
    const S* given_adhesion;          // (n) F.n / (sigma m a_max) from a network in Eq 11's place, or null
    const Vec3<S>* limit_edge;        // (n-1) edges at which the strain limit is taken
    Vec3<S> root_spin, root_center, root_velocity;  // [rad/s], [m], [m/s]: rigid motion of the root's frame
    Vec3<S> chord;                                  // x_{n-1} - x_0
    Vec3<S>* core_pull;  // (n-1) the core's force along each edge, made by its `prepare`

    WETCURL_HD void set_arrays(const StrandArrays<S, ConstPointer>& arrays) {
        static_cast<StrandArrays<S, ConstPointer>&>(*this) = arrays;
    }
    WETCURL_HD void set_root(const RootMotion<S>& root) {
        root_spin = root.spin, root_center = root.translation, root_velocity = root.velocity;
    }
};

// Forces f and, for the implicit step, K = h C + h² H. What acts between particles is added by edges, as
// derivatives by e_i = x_{i+1} - x_i are; a row by particles is made of it once all is there.
template <class S>
struct ChainSystem {
    S h;
    unsigned ring;       // particle i, and edge i, has entry i & ring of an array
    Vec3<S>* forces;     // (n) on particles [N]
    Vec3<S>* pulls;      // (n-1) along edges [N]
    Sym3<S>* diagonals;  // (n) K of particles; null: forces alone
    Sym3<S>* edges;      // (n-1) K of edges
    Mat3<S>* joints;     // (n-1) null where no term couples two edges

    static constexpr unsigned whole = ~0u;  // a ring that never closes

    WETCURL_HD bool with_matrix() const { return diagonals != nullptr; }

    WETCURL_HD Vec3<S>& force(int i) const { return forces[at(i)]; }
    // Acts on particle i, and the other way on i+1.
    WETCURL_HD Vec3<S>& pull(int i) const { return pulls[at(i)]; }
    WETCURL_HD Sym3<S>& diagonal(int i) const { return diagonals[at(i)]; }
    WETCURL_HD Sym3<S>& edge(int i) const { return edges[at(i)]; }
    // -K(e_{i-1}, e_i), which is what couples particles i-1 and i+1.
    WETCURL_HD Mat3<S>& joint(int i) const { return joints[at(i)]; }

    // On particle i of n, with what edges add.
    WETCURL_HD Vec3<S> whole_force(int i, int n) const {
        Vec3<S> f = force(i);
        if (i + 1 < n) f += pull(i);
        if (i > 0) f -= pull(i - 1);
        return f;
    }
    // Row i of n by particles: K(i, i), K(i, i+1) and K(i, i+2), the last two where these particles are.
    WETCURL_HD void whole_row(int i, int n, Sym3<S>& k0, Mat3<S>* k1, Mat3<S>* k2) const {
        k0 = diagonal(i);
        if (i > 0) k0 += edge(i - 1);
        if (i + 1 == n) return;
        k0 += edge(i);
        Mat3<S> sum = to_mat3(edge(i));
        if (joints && i > 0) k0 += with_transposed(joint(i)), sum += joint(i);
        if (joints && i + 2 < n) sum += joint(i + 1), assign(*k2, joint(i + 1));
        assign(*k1, -sum);
    }
    // Forgets what row i is the last to ask for, once rows before it are made.
    WETCURL_HD void forget_row(int i) const {
        set_zero(force(i)), set_zero(diagonal(i));
        if (i > 0) set_zero(pull(i - 1)), set_zero(edge(i - 1));
        if (joints) set_zero(joint(i));
    }

  private:
    WETCURL_HD unsigned at(int i) const { return unsigned(i) & ring; }
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

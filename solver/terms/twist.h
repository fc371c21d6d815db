// Torsion springs between edges: what the twist of a strand between its root and its free tip costs.
// Bergou 2008, Sec. 4.2.2 and 5.1: discrete twist and its gradient through the frames' transport. The paper
// has none. Differs: the energy is periodic, GJ / l (1 - cos m) in place of GJ / (2 l) m², so that it needs
// no count of turns.
#pragma once

#include "base/parameters.h"
#include "solver/terms/bend.h"
#include "solver/terms/chain.h"

namespace wetcurl {

struct Twist {
    static constexpr const char *name = "twist", *table = "bend";
    static constexpr bool couples_two_edges = true;
    double torsion, k_b;
    static constexpr Parameter<Twist> parameters[] = {
        {"torsion", &Twist::torsion, "1", 0.75, 0, 1e3,
         "GJ / EI, torsional against flexural rigidity (ours); 0: a twist costs nothing and stays"},
    };

    // GJ / l [N m], where EI = k_b l³.
    template <class S>
    WETCURL_HD S stiffness(const S& rest_length) const {
        return S(torsion * k_b) * rest_length * rest_length;
    }

    // How far the frames hang back, 0 to 1: not at all where the step resolves the bend's springs. Where it
    // does not, positions carried ahead by their velocity tell nothing, and frames that follow them at once
    // swing.
    template <class S>
    WETCURL_HD S lag(const S& h, const S& mass) const {
        const S stiff = h * h * S(k_b);
        return stiff / (stiff + S(1000) * mass);
    }

    // Half the angle m of an edge's frame against the one before, carried along the strand: the turn from one
    // to the other is a turn about the first axis, then one about an axis across it, which scales both of
    // these alike.
    template <class S>
    struct HalfAngle {
        S cosine, sine;  // times `scale`
        WETCURL_HD HalfAngle(const Quat<S>& f, const Quat<S>& g)
            : cosine(f.w * g.w + f.x * g.x + f.y * g.y + f.z * g.z),
              sine(f.w * g.x - f.x * g.w - f.y * g.z + f.z * g.y) {}
        WETCURL_HD S squared_scale() const {
            return maximum(cosine * cosine + sine * sine, S(Plain<S>(1e-30)));
        }
        WETCURL_HD S sine_of_whole() const { return S(2) * sine * cosine / squared_scale(); }
        WETCURL_HD S squared_sine() const { return sine * sine / squared_scale(); }
        WETCURL_HD S signed_sine() const {
            return select(cosine < S(0), -sine, sine) / sqrt(squared_scale());
        }
    };

    // An edge's direction and the inverse of its length.
    template <class S>
    struct Direction {
        Vec3<S> e;
        S inverse;
        WETCURL_HD explicit Direction(const Vec3<S>& edge)
            : inverse(S(1) / maximum(norm(edge), S(tiny_length<S>))) {
            e = inverse * edge;
        }
    };
    // dm by the edges that meet: half the curvature binormal over each one's length.
    template <class S>
    struct Gradient {
        Vec3<S> before, after;
    };
    template <class S>
    WETCURL_HD static Gradient<S> gradient(const Direction<S>& before, const Direction<S>& after) {
        const S across = maximum(S(1) + dot(before.e, after.e), S(Plain<S>(1e-3)));
        const Vec3<S> half_b = (S(1) / across) * cross(before.e, after.e);
        return {before.inverse * half_b, after.inverse * half_b};
    }

    template <class S>
    WETCURL_HD S energy(const ChainView<S>& c) const {
        S sum(0);
        for (int i = 1; i + 1 < c.n; ++i) {
            const HalfAngle<S> m(c.frame[i - 1], c.frame[i]);
            sum += S(2) * stiffness(c.rest_length[i]) * m.squared_sine();
        }
        return sum;
    }

    template <class S>
    WETCURL_HD void assemble(const ChainView<S>& c, const ChainSystem<S>& a, int begin, int end) const {
        const int first = maximum(begin - 1, 1);
        if (first + 1 >= end) return;
        Direction<S> before(edge(c, first - 1));
        for (int i = first; i + 1 < end; ++i) {
            const S k = stiffness(c.rest_length[i]);
            const S torque = k * HalfAngle<S>(c.frame[i - 1], c.frame[i]).sine_of_whole();
            const Direction<S> after(edge(c, i));
            const auto [g1, g] = gradient(before, after);
            before = after;
            a.pull(i - 1) += torque * g1;
            a.pull(i) += torque * g;
            if (!a.with_matrix()) continue;
            // The system takes weight times the outer product of both gradients.
            const S weight = a.h * a.h * k;
            const Vec3<S> w1 = weight * g1, w = weight * g;
            a.edge(i - 1) += symmetric_outer(w1, g1);
            a.edge(i) += symmetric_outer(w, g);
            a.joint(i) -= outer(w1, g);
        }
    }
};

// The twists of a strand relaxed toward their equilibrium with its bending: Newton's step on the energy of
// both over the turns of edges 1 .. n-2 about themselves, with an upper bound of the curvature, so that the
// energy never rises. A tridiagonal system, eliminated from the root to the tip.
// In the place of Bergou's quasi-static solve: one step a substep follows it.
template <class S>
struct TwistElimination {
    S pivot, right;

    // Edge 0 is held by the root.
    WETCURL_HD TwistElimination() : pivot(1), right(0) {}
    // From the edge before to edge i. `k`, `torque`: of its joint with the edge before; `k_next`,
    // `torque_next`: of that with the edge after, 0 at the tip.
    WETCURL_HD void next(bool first, const S& k, const S& torque, const S& k_next, const S& torque_next,
                         const S& bend_slope, const S& bend_bound, const S& lag) {
        next(first ? S(0) : k, torque_next - torque - bend_slope, (S(1) + lag) * (bend_bound + k + k_next));
    }
    // The same where row i is known: its coupling to the row before, 0 for the first, its right side and
    // diagonal.
    WETCURL_HD void next(const S& k, const S& right_side, const S& diagonal) {
        const S coupling = k / pivot;
        right = right_side + coupling * right;
        pivot = maximum(diagonal - coupling * k, S(Plain<S>(1e-30)));
    }
};

// How the energy of the bend at an edge e changes as the frame f before it turns about itself: its slope, and
// a bound of its curvature for any turn.
template <class S>
WETCURL_HD void bend_by_turn(const Bend& bend, const Quat<S>& f, const Vec3<S>& target, const Vec3<S>& e,
                             S& slope, S& bound) {
    const Vec3<S> axis = frame_direction(f), e_turn = cross(axis, e), t_turn = cross(axis, rotate(f, target));
    slope = S(-bend.k_b) * dot(e, t_turn);
    bound = S(bend.k_b) * sqrt(dot(e_turn, e_turn) * dot(t_turn, t_turn));
}

// All frames of a strand at the positions x, in a step h [s] (0: no lag). `scratch` (2n).
template <class S>
WETCURL_HD void relax_twist(const Bend& bend, const Twist& twist, const ChainView<S>& c, const Vec3<S>* x,
                            const S& h, S* scratch, Quat<S>* frame) {
    const int n = c.n;
    TwistElimination<S> row;
    auto joint = [&](int i, S& k, S& torque) {
        k = twist.stiffness(c.rest_length[i]);
        torque = k * Twist::HalfAngle<S>(frame[i - 1], frame[i]).sine_of_whole();
    };
    S k(0), torque(0), k_next(0), torque_next(0);
    if (n > 2) joint(1, k, torque);
    for (int i = 1; i + 1 < n; ++i) {
        const bool tip = i + 2 == n;
        S slope(0), bound(0);
        k_next = torque_next = S(0);
        if (!tip) {
            joint(i + 1, k_next, torque_next);
            bend_by_turn(bend, frame[i], c.target[i + 1], x[i + 2] - x[i + 1], slope, bound);
        }
        row.next(i == 1, k, torque, k_next, torque_next, slope, bound, twist.lag(h, c.mass[i]));
        scratch[2 * i] = row.pivot, scratch[2 * i + 1] = row.right;
        k = k_next, torque = torque_next;
    }
    S turn(0);
    for (int i = n - 2; i > 0; --i) {
        const S after = i + 2 == n ? S(0) : twist.stiffness(c.rest_length[i + 1]);
        turn = (scratch[2 * i + 1] + after * turn) / scratch[2 * i];
        frame[i] = turned_about_itself(frame[i], turn);
    }
}

}  // namespace wetcurl

// Torsion springs between edges: what the twist of a strand between its root and its free tip costs.
// Bergou 2008, Sec. 4.2.2 and 5.1: discrete twist and its gradient through the frames' transport. The paper
// has none. Differs: the energy is periodic, GJ / l (1 - cos m) in place of GJ / (2 l) m², so that it needs
// no count of turns.
#pragma once

#include "base/parameters.h"
#include "solver/terms/bend.h"
#include "solver/terms/chain.h"

namespace wetcurl {

// What a joint of two edges gives.
template <class S>
struct TwistJoint {
    S stiffness, torque;  // [N m]
};

struct Twist {
    static constexpr const char *name = "twist", *table = "bend";
    static constexpr bool couples_two_edges = true;
    double torsion, k_b;
    static constexpr Parameter<Twist> parameters[] = {
        {KeyRow::number("torsion", "1", 0.75, 0, 1e3,
                        "Torsional rigidity GJ by flexural rigidity EI; 0: a twist costs nothing and stays.",
                        "ours, after Bergou 2008"),
         &Twist::torsion},
    };

    // GJ / l [N m] of an edge's joint with the one before, where EI = k_b l³. `own`: of a fibre's joint, or
    // null.
    template <class S>
    WETCURL_HD S stiffness(const S* own, const S& rest_length) const {
        return own ? *own : S(torsion * k_b) * rest_length * rest_length;
    }

    // How far the frames of springs hang back, 0 to 1: not at all where the step resolves the bend's. Where
    // it does not, positions carried ahead by their velocity tell nothing, and frames that follow them at
    // once swing.
    template <class S>
    WETCURL_HD S lag(const S& h, const S& mass) const {
        const S stiff = h * h * S(k_b);
        return stiff / (stiff + S(1000) * mass);
    }
    // The same of a fibre, by whose `bend` the joint after the edge turns to `target`. Short segments are
    // stiff by themselves; what the step must resolve is the swing of a curl, EI kappa⁴ by the mass of a
    // length. Seen: frames that hang back by a quarter take the swing out of coils within half a second,
    // those that run ahead by a twentieth feed it; and where the square of that swing's angle in a step is in
    // the hundreds, coils tremble unless frames hang back a little.
    template <class S>
    WETCURL_HD static S lag_of_fibre(const S& h, const S& mass, const S& bend, const Vec3<S>& target) {
        const S across = target.y * target.y + target.z * target.z, length = across + target.x * target.x,
                turn = across / maximum(length, S(tiny_length<S> * tiny_length<S>)),
                stiff = h * h * bend * turn * turn;
        return stiff / (stiff + S(3000) * mass);
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

    // Of an edge of that rest length and the one before it; `own` as above.
    template <class S>
    WETCURL_HD TwistJoint<S> joint(const S* own, const S& rest_length, const Quat<S>& frame_before,
                                   const Quat<S>& frame) const {
        const S k = stiffness(own, rest_length);
        return {k, k * HalfAngle<S>(frame_before, frame).sine_of_whole()};
    }

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
            sum += S(2) * stiffness(own_of(c.twist_spring, i), c.rest_length[i]) * m.squared_sine();
        }
        return sum;
    }

    template <class S>
    WETCURL_HD void assemble(const ChainView<S>& c, const ChainSystem<S>& a, int begin, int end) const {
        const int first = maximum(begin - 1, 1);
        if (first + 1 >= end) return;
        Direction<S> before(edge(c, first - 1));
        for (int i = first; i + 1 < end; ++i) {
            const auto [k, torque] =
                joint(own_of(c.twist_spring, i), c.rest_length[i], c.frame[i - 1], c.frame[i]);
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

// Of the turns of edges about themselves: an edge's row of the tridiagonal system. What couples it to an edge
// before and to one after, what its diagonal has beyond these (nothing cancels in sums of such), its right
// side. Of plain numbers it is read and written whole.
template <class S>
struct alignas(std::is_same_v<S, Plain<S>> ? 4 * sizeof(S) : alignof(S)) TwistRow {
    S before, after, excess, right;
    WETCURL_HD S inverse() const { return S(1) / maximum(before + after + excess, S(Plain<S>(1e-30))); }
    // Is coupled no longer to row `b` before it, but to what that is coupled to before; likewise after.
    WETCURL_HD void take_before(const TwistRow& b) {
        const S share = before * b.inverse();
        before = share * b.before, excess += share * b.excess, right += share * b.right;
    }
    WETCURL_HD void take_after(const TwistRow& a) {
        const S share = after * a.inverse();
        after = share * a.after, excess += share * a.excess, right += share * a.right;
    }
};

// How the energy of the bend at an edge e changes as the frame f before it turns about itself: its slope, and
// a bound of its curvature for any turn. `k_b`: of the joint of both.
template <class S>
WETCURL_HD void bend_by_turn(const S& k_b, const Quat<S>& f, const Vec3<S>& target, const Vec3<S>& e,
                             S& slope, S& bound) {
    const Vec3<S> axis = frame_direction(f), e_turn = cross(axis, e), t_turn = cross(axis, rotate(f, target));
    slope = -k_b * dot(e, t_turn);
    bound = k_b * sqrt(dot(e_turn, e_turn) * dot(t_turn, t_turn));
}

// Edge i's row, with what its joints with the edges before and after it and, by `slope` and `bound` of
// bend_by_turn, the bend after it make. Edge 0 is held by the root; at the tip nothing comes after.
template <class S>
WETCURL_HD TwistRow<S> twist_row(int i, const TwistJoint<S>& before, const TwistJoint<S>& after,
                                 const S& slope, const S& bound, const S& lag) {
    const S excess = bound + lag * (bound + before.stiffness + after.stiffness);
    return {i == 1 ? S(0) : before.stiffness, after.stiffness, i == 1 ? excess + before.stiffness : excess,
            after.torque - before.torque - slope};
}

// The twists of a strand relaxed toward their equilibrium with its bending: Newton's step on the energy of
// both over the turns of edges 1 .. n-2 about themselves, with an upper bound of the curvature, so that the
// energy never rises. Eliminated from the root to the tip.
// In the place of Bergou's quasi-static solve: one step a substep follows it.
// All frames of a strand at the positions x, in a step h [s] (0: no lag). `scratch` (2n).
template <class S>
WETCURL_HD void relax_twist(const Bend& bend, const Twist& twist, const ChainView<S>& c, const Vec3<S>* x,
                            const S& h, S* scratch, Quat<S>* frame) {
    const int n = c.n;
    if (n < 3) return;
    auto joint = [&](int i) {
        return twist.joint(own_of(c.twist_spring, i), c.rest_length[i], frame[i - 1], frame[i]);
    };
    TwistJoint<S> before = joint(1);
    TwistRow<S> row_before{};
    for (int i = 1; i + 1 < n; ++i) {
        S slope(0), bound(0);
        TwistJoint<S> after{S(0), S(0)};
        if (i + 2 < n) {
            after = joint(i + 1);
            bend_by_turn(spring_of(c.bend_spring, i + 1, bend.k_b), frame[i], c.target[i + 1],
                         x[i + 2] - x[i + 1], slope, bound);
        }
        TwistRow<S> row =
            twist_row(i, before, after, slope, bound, c.bend_spring ? S(0) : twist.lag(h, c.mass[i]));
        if (i > 1) row.take_before(row_before);
        const S inverse = row.inverse();
        scratch[2 * i] = inverse * row.right, scratch[2 * i + 1] = inverse * row.after;
        before = after, row_before = row;
    }
    S turn(0);
    for (int i = n - 2; i > 0; --i) {
        turn = scratch[2 * i] + scratch[2 * i + 1] * turn;
        const bool lags = c.bend_spring && i + 2 < n;
        frame[i] = turned_about_itself(
            frame[i],
            lags ? turn / (S(1) + twist.lag_of_fibre(h, c.mass[i], c.bend_spring[i + 1], c.target[i + 1]))
                 : turn);
    }
}

}  // namespace wetcurl

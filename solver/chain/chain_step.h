// What the substep of one block of strands is made of: the implicit scheme (BDF2), buffers, loops along a
// strand. The scheme:
//     A (v - v^) = M (v~ - v^) + h f(x~ + h v^, v^), A = M + h C + h² H, x = x~ + h v
// with the history x~, v~ and step h of BDF2 (backward Euler in the first step) and the predictor v^ = v_n.
// Seen: the higher-order predictor 2 v_n - v_{n-1} feeds energy in wherever H is a majoriser; none at all
// (v^ = 0) kills a swing. Where what the majoriser adds across the strand outweighs the strand 1e5 times
// (core) or 4e4 times (bends), the swing of that weight fills the bends with energy; there v^ is a share of
// v_n. Not so of fibres, whose bends are that stiff where segments are short, and only from one to the next.
#pragma once

#include <vector>

#include "solver/chain/block_solve.h"
#include "solver/solids/contact.h"
#include "solver/terms/list.h"

namespace wetcurl {

// The scheme's numbers of one step.
template <class S>
struct Bdf2 {
    S h, now, before;  // x~ = x + before (x_before - x), v~ = now v + before v_before
    S share;           // v^ = share v
    WETCURL_HD Bdf2(Plain<S> dt, bool first, Plain<S> share = 1)
        : h(first ? dt : dt * Plain<S>(2) / 3),
          now(first ? Plain<S>(1) : Plain<S>(4) / 3),
          before(first ? Plain<S>(0) : Plain<S>(-1) / 3),
          share(share) {}
    WETCURL_HD Vec3<S> expected_velocity(const Vec3<S>& v) const { return share * v; }
    // x~ + h v^. Differences to x: positions far from the origin keep their digits.
    WETCURL_HD Vec3<S> predicted(const Vec3<S>& x, const Vec3<S>& x_before, const Vec3<S>& v) const {
        return x + before * (x_before - x) + h * expected_velocity(v);
    }
    // r = M (v~ - v^) + h f, and M on the diagonal. `expected`: v^.
    WETCURL_HD Vec3<S> right_side(const S& mass, const Vec3<S>& v, const Vec3<S>& v_before,
                                  const Vec3<S>& expected, const Vec3<S>& force) const {
        return mass * (now * v + before * v_before - expected) + h * force;
    }
};

// What the step of one block needs beside the terms. S: a lane is a strand.
template <class S>
struct BlockStep {
    int n;
    Plain<S> dt;
    bool first;  // no history yet: backward Euler
    Vec3<S>*x, *x_before, *v,
        *v_before;        // (n) now and one step ago; on return the new state lies in *_before
    const Vec3<S>* root;  // (2) prescribed positions of particles 0 and 1 at the end of the step
    Vec3<Plain<S>> gravity;
    Quat<S> root_turn;  // rotation of the root over the step
    Quat<S>* frame;     // (n-1) or null; the caller carries them on to where the step ends
    S* pushed;          // (n) [kg m/s] by surfaces in the step before, then in this one; null: no solids
    const Vec3<S>* external = nullptr;  // (n) [N] beside the terms', at the positions now; null: none
    // (n) [N/m]: `external` is at the predicted positions, and no steeper than this there; null: explicit.
    const S* external_stiffness = nullptr;
    Plain<S> share = 1;  // of v_n in the predictor
    // Implicit: the step is linearised again where an edge turns by more than this angle [rad], at most so
    // often.
    int max_linearisations = 4;
    Plain<S> relinearise_angle = Plain<S>(0.002);
    Vec3<S>* reaction = nullptr;  // (2) [N] that moved particles 0 and 1 as prescribed; null: not asked for
};

// A spring [kg] beside which those that meet at a particle are soft: a hold gives way by a hundredth.
template <class S>
WETCURL_HD S hold_stiffness(Plain<S> spring_sum, const S& h, const S& mass) {
    return S(100) * (mass + S(4 * spring_sum) * h * h);
}

// Buffers for one block, in room that others own; null where no present term needs them.
template <class S>
struct ChainScratch {
    Vec3<S>*predicted_x, *expected_v, *solution, *core_pull, *limit_edge;
    Mat3<S>*upper1, *upper2;  // rows of the substitution
    ChainSystem<S> system;    // implicit: a ring of rows
    S* twist;
    // Of strands for which forces are not taken anew.
    Vec3<S>* kept;
    Quat<S>* kept_frame;
    Hold<S>* hold;  // of particles that are pushed, as of `gap`
    S* gap;         // [m] (n) beyond what is allowed, where the particle is expected; filled before forces
                    // are taken. On return what the implicit step left of it at least

    // Rows that are assembled at once; with those that wait for elements of the next ones they fit in a ring.
    static constexpr int at_once = 5, ring = 8;

    // Takes `room`, and returns how many numbers of it; null: only counts them.
    WETCURL_HD size_t lay(int n, const ChainTerms& terms, bool implicit, bool solids, S* room) {
        size_t taken = 0;
        auto take = [&]<class V>(V*& buffer, int count, bool needed) {
            buffer = needed && room ? reinterpret_cast<V*>(room + taken) : nullptr;
            taken += needed ? size_t(count) * sizeof(V) / sizeof(S) : 0;
        };
        const bool limits = bool(std::get<Slot<StrainLimit>>(terms));
        const bool joints = implicit && couples_two_edges(terms);
        const int rows = implicit ? ring : n;
        take(predicted_x, n, true), take(expected_v, n, implicit), take(solution, n, implicit);
        take(upper1, n, implicit), take(upper2, n, joints);
        take(system.forces, rows, true), take(system.pulls, rows, true);
        take(system.diagonals, rows, implicit), take(system.edges, rows, implicit);
        take(system.joints, rows, joints);
        take(core_pull, n, bool(std::get<Slot<Core>>(terms)));
        take(limit_edge, n, implicit && limits);
        take(twist, 2 * n, bool(std::get<Slot<Twist>>(terms)));
        take(kept, n, implicit), take(kept_frame, n, implicit && bool(std::get<Slot<Bend>>(terms)));
        take(hold, n, implicit && solids), take(gap, n, implicit && solids);
        return taken;
    }
};

// With room of its own.
template <class S>
class OwnScratch : public ChainScratch<S> {
  public:
    OwnScratch(int n, const ChainTerms& terms, bool implicit, bool solids) {
        // No number: what a step reads and nobody wrote shows.
        room_.resize(this->lay(n, terms, implicit, solids, nullptr),
                     S(std::numeric_limits<Plain<S>>::quiet_NaN()));
        this->lay(n, terms, implicit, solids, room_.data());
    }
    OwnScratch(const OwnScratch&) = delete;
    OwnScratch(OwnScratch&&) = default;  // the room stays where it is
    size_t bytes() const { return room_.size() * sizeof(S); }

  private:
    std::vector<S> room_;
};

// The frames of all edges carried to the positions x: first the root's own rotation, then each edge's.
template <class S>
WETCURL_HD void transport_frames(int n, const Quat<S>* from, const Quat<S>& turn, const Vec3<S>* x,
                                 Quat<S>* to) {
    // w alone rounds to 1 for a slow turn.
    const bool turns =
        any_positive(maximum(turn.x, -turn.x) + maximum(turn.y, -turn.y) + maximum(turn.z, -turn.z));
    for (int i = 0; i + 1 < n; ++i) to[i] = transported(turns ? turn * from[i] : from[i], x[i + 1] - x[i]);
}

// The twists of frames at the view's positions relax where they cost anything.
template <class S>
WETCURL_HD void relax_frames(const ChainTerms& terms, const ChainView<S>& view, const S& h, S* scratch,
                             Quat<S>* frame) {
    if (const auto& twist = std::get<Slot<Twist>>(terms))
        relax_twist(*std::get<Slot<Bend>>(terms), *twist, view, view.x, h, scratch, frame);
}

// The edges after a step h that changes velocities by dv (n), of `active` strands whose strain limit must be
// solved for again; the others' stay, and so does their solution. Returns whether there are any.
template <class S>
WETCURL_HD bool update_limit_edges(const StrainLimit& limit, const ChainView<S>& c, const S& h,
                                   const Vec3<S>* dv, const S& active, Vec3<S>* at) {
    S farthest(0);
    auto edge_after = [&](int i) { return edge(c, i) + h * (dv[i + 1] - dv[i]); };
    for (int i = 1; i + 1 < c.n; ++i)
        farthest = maximum(farthest, limit.unsettled(edge_after(i), at[i], c.rest_length[i]));
    farthest = active * farthest;
    if (!any_positive(farthest)) return false;
    for (int i = 1; i + 1 < c.n; ++i) at[i] = select(farthest > S(0), edge_after(i), at[i]);
    return true;
}

// Above 0 for an edge that moves by `way` and so turns by more than `turn`: forces there are not what they
// were linearised to be.
template <class S>
WETCURL_HD S turned_far(const Vec3<S>& way, const S& rest_length, const S& turn) {
    const S most = turn * rest_length;
    return dot(way, way) - most * most;
}
// What is far for a strand that surfaces push or not. Seen: a stiff strand that a ball sweeps gains energy
// where its swing is damped by one step, which takes forces once, and not by the next.
template <class S>
WETCURL_HD S far_turn(Plain<S> turn, const S& pushed) {
    return select(pushed > S(0), maximum(S(turn), S(Plain<S>(0.1))), S(turn));
}
// 1 for strands with such an edge after a step h that changes velocities by dv (n), 0 for others. `pushed`
// (n) by surfaces; null: there are none.
template <class S>
WETCURL_HD S turned_far(const ChainView<S>& c, const S& h, const Vec3<S>* dv, const S* pushed,
                        Plain<S> most) {
    S far(0), push(0);
    for (int i = 2; pushed && i < c.n; ++i) push = maximum(push, pushed[i]);
    const S turn = far_turn(most, push);
    for (int i = 1; i + 1 < c.n; ++i)
        far = maximum(far, turned_far<S>(h * (dv[i + 1] - dv[i]), c.rest_length[i], turn));
    return select(far > S(0), S(1), S(0));
}

// Which particles the surfaces hold, after a step h that changes velocities by dv (n), in lanes that are
// `active`. Returns whether others than before.
template <class S>
WETCURL_HD bool update_holds(int n, const S& h, const Vec3<S>* dv, const S* pushed, const S& active,
                             Hold<S>* hold) {
    S changed(0);
    for (int i = 2; i < n; ++i) {
        if (!any_positive(pushed[i])) continue;
        const S weight = hold[i].weight;
        changed += active * weigh_again(h, dv[i], hold[i]);
        hold[i].weight = select(active > S(0), hold[i].weight, weight);
    }
    return any_positive(changed);
}

// How many of `over`'s lanes hold.
template <class S, class Mask>
WETCURL_HD int count_lanes(const Mask& over) {
    if constexpr (std::is_same_v<S, Plain<S>>) return over;
    int count = 0;
    if constexpr (!std::is_same_v<S, Plain<S>>)
        for (int lane = 0; lane < S::lanes; ++lane) count += over[lane] != 0;
    return count;
}
// Moves the end of each edge that is longer than (1 + most) of its rest length, root to tip (Selle 2008).
// Returns how many were.
template <class S>
WETCURL_HD int limit_strain(int n, const S* rest_length, Plain<S> most, Vec3<S>* x) {
    int limited = 0;
    for (int i = 1; i + 1 < n; ++i) {
        const Vec3<S> e = x[i + 1] - x[i];
        const S length = norm(e), allowed = S(1 + most) * rest_length[i];
        const auto over = length > allowed;
        x[i + 1] = select(over, x[i] + (allowed / maximum(length, S(tiny_length<S>))) * e, x[i + 1]);
        limited += count_lanes<S>(over);
    }
    return limited;
}

}  // namespace wetcurl

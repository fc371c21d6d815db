// The implicit substep of one strand in two sweeps, for a thread a strand: from the tip, the twists' turns,
// the core's adjoint, forces, matrix and elimination row by row in registers; from the root, substitution,
// contact, frames, and for the substep that follows the core's filter and the elimination of its twists.
// Terms and formulas are those of solver/passes/chain_step.h, which is the reference. Differs: there rows are
// eliminated from the root. From the tip the adjoint and the turns need no sweeps of their own, and the two
// prescribed rows come last, where they are known.
#pragma once

#include <utility>

#include "cuda/lanes.h"
#include "solver/passes/block_solve.h"
#include "solver/passes/chain_step.h"
#include "solver/passes/contact.h"

namespace wetcurl {

// What is there of a scene, by its place in ChainTerms; contact after them. A kernel for one set
// knows it at compile time; the general one asks at each use.
namespace present {
template <class Term, size_t k = 0>
constexpr int place_of() {
    if constexpr (std::is_same_v<std::tuple_element_t<k, ChainTerms>, Slot<Term>>)
        return int(k);
    else
        return place_of<Term, k + 1>();
}
inline constexpr int contact = int(std::tuple_size_v<ChainTerms>);
template <class... Term>
inline constexpr unsigned these = (0u | ... | (1u << place_of<Term>()));
}  // namespace present

template <unsigned bits>
struct ExactSet {
    WETCURL_HD static constexpr bool has(int place) { return (bits >> place) & 1; }
};
struct AnySet {
    unsigned bits;
    WETCURL_HD bool has(int place) const { return (bits >> place) & 1; }
};
inline unsigned set_of(const ChainTerms& terms, bool contact) {
    unsigned bits = unsigned(contact) << present::contact;
    int place = 0;
    std::apply([&](const auto&... term) { ((bits |= unsigned(term.has_value()) << place++), ...); }, terms);
    return bits;
}
template <class Term, class Set>
WETCURL_HD bool has(const Set& set) {
    return set.has(present::place_of<Term>());
}
template <class Term>
WETCURL_HD const Term& get(const ChainTerms& terms) {
    return *std::get<present::place_of<Term>()>(terms);
}

// The strands in the device's memory: rows of 32 lanes (block, particle, number). Null where no present term
// needs it.
template <class T>
struct StrandMemory {
    int n;
    T *x, *x_before, *v, *v_before, *touching, *pushed;
    T *frame, *ahead;  // at the positions now, and at those at which the next forces are taken
    T* twist;          // (block, particle, 2) rows of the twists' elimination
    T* core;           // (block, particle, 3) the core's force on the smoothed edge, before the adjoint
    T* limit_edge;     // (block, particle, 3) edges at which the strain limit is taken
    T* change;         // (block, particle, 3) of velocities since forces were first taken in a step
    T* factors;        // (block, particle, 3 or 12 or 21) the substitution's y, u1, u2
    const T *root, *mass, *rest_length, *rest_core, *target, *saturation, *rest_depth, *push;
};

// What is the same for all strands and substeps.
template <class T>
struct ChainConstants {
    ChainTerms terms;
    T dt, spring_sum, share, turn;
    int looks;  // as of a BlockStep
    Vec3<T> gravity;
};

template <class T>
using DeviceSolid = PosedSolid<T, ShapeView>;

// One substep's motion of the head and of `count` solids.
template <class T>
struct SubstepMotion {
    Quat<T> head_rotation, root_turn;
    Vec3<T> head_translation, turn, turn_center, drift;
    const DeviceSolid<T>* solids;
    int count;
    WETCURL_HD const DeviceSolid<T>* begin() const { return solids; }
    WETCURL_HD const DeviceSolid<T>* end() const { return solids + count; }
};

// One strand: block of 32 and lane.
template <class T>
class StrandSweep {
    using V = Vec3<T>;
    using Q = Quat<T>;
    using M = Mat3<T>;

  public:
    WETCURL_HD StrandSweep(const StrandMemory<T>& m, const ChainConstants<T>& constants, int block, int lane)
        : m_(m), k_(constants), block_(size_t(block)), lane_(lane) {
        x_ = of<V>(m.x), x_before_ = of<V>(m.x_before), v_ = of<V>(m.v), v_before_ = of<V>(m.v_before);
    }

    // From rest: what the first substep needs, over which the root turns by `root_turn`.
    template <class Set>
    WETCURL_HD void prepare(const Set& set, const Q& root_turn) const {
        const Bdf2<T> scheme(k_.dt, true, k_.share);
        Ahead ahead(scheme, root_turn);
        for (int i = 0; i < m_.n; ++i)
            look_ahead(set, ahead, i, at_first(scheme, i), scheme.expected_velocity(v_[i]),
                       outputs_at(set, i), has<Bend>(set) && i > 0 ? of<Q>(m_.frame)[i - 1] : Q::identity());
        finish(set, ahead);
    }

    // One substep, `first` of a run (no history) or not; over the one after it the root turns by
    // `turn_after`. `last`: someone looks at the frames then. Returns how many edges were held at their
    // strain limit.
    template <class Set>
    WETCURL_HD int step(const Set& set, const SubstepMotion<T>& motion, const Q& turn_after, bool first,
                        bool last) {
        const Bdf2<T> scheme(k_.dt, first, k_.share);
        solve(set, motion, scheme);
        const int limited = substitute_from_root(set, motion, scheme, turn_after, last);
        looks_ = 1;
        // What was written over the older state is the newer one.
        const auto x = x_, v = v_;
        x_ = x_before_, v_ = v_before_;
        x_before_ = x, v_before_ = v;
        return limited;
    }

  private:
    // This lane's elements of a buffer.
    template <class E, class P>
    WETCURL_HD auto of(P* buffer, size_t rows = sizeof(E) / sizeof(T)) const {
        return LaneArray<std::remove_const_t<E>, P>{buffer + block_ * size_t(m_.n) * rows * Lanes<T>::lanes +
                                                    lane_};
    }
    WETCURL_HD V at_first(const Bdf2<T>& scheme, int i) const {
        return scheme.predicted(x_[i], x_before_[i], v_[i]);
    }
    // Of velocities until forces were taken anew.
    WETCURL_HD V change_at(int i) const { return looks_ > 1 ? V(of<V>(m_.change)[i]) : V{T(0), T(0), T(0)}; }
    // Where and at which velocity forces are taken.
    WETCURL_HD V look_at(const Bdf2<T>& scheme, int i) const {
        return at_first(scheme, i) + scheme.h * change_at(i);
    }
    WETCURL_HD V look_velocity(const Bdf2<T>& scheme, int i) const {
        return scheme.expected_velocity(v_[i]) + change_at(i);
    }

    // A row of the substitution: y, then u1, then (where a term couples two edges) u2.
    struct Factors {
        V y;
        M u1, u2;
    };
    template <class Set>
    WETCURL_HD static bool penta(const Set& set) {
        return has<Bend>(set) || has<Twist>(set);
    }
    template <class Set>
    WETCURL_HD T* factors_of(const Set& set, int i) const {
        const int rows = penta(set) ? 21 : 12;
        return m_.factors + ((block_ * size_t(m_.n) + size_t(i)) * size_t(rows)) * Lanes<T>::lanes + lane_;
    }

    template <class Set>
    WETCURL_HD Factors factors_at(const Set& set, int i) const {
        T* row = factors_of(set, i);
        Factors f{};
        f.y = LaneArray<V, T>{row}[0];
        f.u1 = LaneArray<M, T>{row + 3 * Lanes<T>::lanes}[0];
        if (penta(set)) f.u2 = LaneArray<M, T>{row + 12 * Lanes<T>::lanes}[0];
        return f;
    }
    // The solution of a row from those of the particle before and of the one before that.
    template <class Set>
    WETCURL_HD static V substituted(const Set& set, const Factors& row, const V& d1, const V& d2) {
        V d = row.y - row.u1 * d1;
        if (penta(set)) d -= row.u2 * d2;
        return d;
    }
    WETCURL_HD V placed_root(const SubstepMotion<T>& motion, int i) const {
        const LaneArray<V, const T> root{m_.root + block_ * 2 * 3 * Lanes<T>::lanes + lane_};
        return rotate(motion.head_rotation, root[i]) + motion.head_translation;
    }

    // What an element whose last particle is i reads from memory.
    struct Inputs {
        V x, x_before, v, change;  // of particle i-2
        Q frame;                   // of edge i-2, and the row of its twist's elimination
        T pivot, right;
        V v_before;  // of particle i, and so on
        T mass, saturation, touching, pushed;
        V limit_edge;          // of edge i-1
        V core, target, push;  // of edge i-1
        T rest_length;
    };
    template <class Set>
    WETCURL_HD Inputs inputs_at(const Set& set, int i) const {
        Inputs in{};
        in.x = x_[i - 2], in.x_before = x_before_[i - 2], in.v = v_[i - 2], in.change = change_at(i - 2);
        in.v_before = v_before_[i];
        in.mass = of<const T>(m_.mass)[i];
        in.rest_length = of<const T>(m_.rest_length)[i - 1];
        if (has<Bend>(set)) in.frame = of<Q>(m_.ahead)[i - 2], in.target = of<const V>(m_.target)[i - 1];
        if (has<Twist>(set) && i > 2)
            in.pivot = of<T>(m_.twist, 2)[2 * i - 4], in.right = of<T>(m_.twist, 2)[2 * i - 3];
        if (has<Core>(set)) in.core = of<V>(m_.core)[i - 1];
        if (has<CurlPush>(set)) in.push = of<const V>(m_.push)[i - 1];
        if (has<Adhesion>(set)) in.touching = of<T>(m_.touching)[i];
        if (set.has(present::contact)) in.pushed = of<T>(m_.pushed)[i];
        if (has<StrainLimit>(set)) in.limit_edge = of<V>(m_.limit_edge)[i - 1];
        if ((has<Adhesion>(set) || has<Stiffness>(set)) && m_.saturation)
            in.saturation = of<const T>(m_.saturation)[i];
        return in;
    }

    // Of particle i, which a solid has pushed or is to push, expected at x, with velocity v before. Held
    // while `pushed` is above 0; below it the surface may hold it again.
    WETCURL_HD Hold<T> hold_of(int i, const SubstepMotion<T>& motion, T pushed, T h, T mass, const V& x,
                               const V& v) const {
        T momentum = pushed < 0 ? -pushed : pushed;
        Hold<T> hold = first_hold_of(i, motion, momentum, h, mass, x, v);
        hold.gap += h * dot(change_at(i), hold.normal);
        hold.weight = pushed > 0 ? hold.stiff : T(0);
        return hold;
    }
    // The first guess; `pushed` is raised where it is expected inside.
    WETCURL_HD Hold<T> first_hold_of(int i, const SubstepMotion<T>& motion, T& pushed, T h, T mass,
                                     const V& x, const V& v) const {
        return expected_contact(motion, m_.rest_depth ? of<const T>(m_.rest_depth)[i] : T(0),
                                hold_stiffness(k_.spring_sum, h, mass), x, v, pushed);
    }

    template <class Set, size_t... place>
    WETCURL_HD void assemble_present(const Set& set, const ChainView<T>& view, const ChainSystem<T>& system,
                                     std::index_sequence<place...>) const {
        ((set.has(int(place)) ? std::get<place>(k_.terms)->assemble(view, system, 2, 3) : void()), ...);
    }

    template <class Set>
    WETCURL_HD void eliminate_from_tip(const Set& set, const SubstepMotion<T>& motion,
                                       const Bdf2<T>& scheme) const {
        const int n = m_.n;
        if (n < 3) return;
        // Particles i-2, i-1 and i stand at 0, 1 and 2: the element and the rows that it reaches.
        const V zero{T(0), T(0), T(0)};
        const Sym3<T> no_sym = identity_times(T(0));
        const M no_mat = to_mat3(no_sym);
        V x[3], v[3], force[3] = {zero, zero, zero}, r[3] = {zero, zero, zero};
        Sym3<T> diagonal[3] = {no_sym, no_sym, no_sym};
        M upper1[2] = {no_mat, no_mat}, upper2[1];
        V target[2], core[2], push[2], limit_edge[2], normal[3], surface_velocity[3];
        Q frame[2];
        T mass[3], rest_length[2], saturation[3], touching[3], phi[3];
        normal[2] = {T(0), T(1), T(0)}, surface_velocity[2] = zero;

        ChainView<T> view{};
        view.n = 3;
        view.x = x, view.v = v, view.mass = mass, view.rest_length = rest_length;
        view.limit_edge = limit_edge;
        view.target = target, view.frame = frame, view.core_pull = core, view.push = push;
        view.saturation = saturation, view.touching = touching, view.phi = phi, view.normal = normal;
        view.surface_velocity = surface_velocity;
        view.turn = motion.turn, view.turn_center = motion.turn_center, view.drift = motion.drift;
        if (has<CurlPush>(set)) view.chord = look_at(scheme, n - 1) - look_at(scheme, 0);
        const ChainSystem<T> system{scheme.h, force, diagonal, upper1, upper2};

        EdgeFilterAdjoint<T> adjoint(has<Core>(set) ? T(get<Core>(k_.terms).beta) : T(1));
        T turn(0);  // of the twist of the edge at hand
        if (has<Bend>(set)) frame[0] = of<Q>(m_.ahead)[n - 2];
        if (has<Twist>(set)) {
            turn = of<T>(m_.twist, 2)[2 * n - 3] / of<T>(m_.twist, 2)[2 * n - 4];
            frame[0] = turned_about_itself(frame[0], turn);
            of<Q>(m_.ahead).set(n - 2, frame[0]);
        }
        // Beside x and v, where and at which velocity particles were first expected.
        V first_x[3], old_v[3];
        first_x[1] = at_first(scheme, n - 1), x[1] = look_at(scheme, n - 1);
        first_x[0] = at_first(scheme, n - 2), x[0] = look_at(scheme, n - 2);
        old_v[1] = v_[n - 1], v[1] = look_velocity(scheme, n - 1);
        old_v[0] = v_[n - 2], v[0] = look_velocity(scheme, n - 2);
        Inputs next = inputs_at(set, n - 1);
        for (int i = n - 1; i >= 2; --i) {
            const Inputs in = next;
            if (i > 2) next = inputs_at(set, i - 1);  // on its way while this row is worked on
            first_x[2] = first_x[1], first_x[1] = first_x[0];
            first_x[0] = scheme.predicted(in.x, in.x_before, in.v);
            x[2] = x[1], x[1] = x[0], x[0] = first_x[0] + scheme.h * in.change;
            old_v[2] = old_v[1], old_v[1] = old_v[0], old_v[0] = in.v;
            v[2] = v[1], v[1] = v[0], v[0] = scheme.expected_velocity(in.v) + in.change;
            upper2[0] = no_mat;
            mass[2] = in.mass, saturation[2] = in.saturation, touching[2] = in.touching;
            rest_length[1] = in.rest_length, limit_edge[1] = in.limit_edge, target[1] = in.target,
            push[1] = in.push;
            if (has<Bend>(set)) frame[1] = frame[0], frame[0] = in.frame;
            if (has<Twist>(set) && i > 2) {
                const T stiffness = get<Twist>(k_.terms).stiffness(in.rest_length);
                turn = (in.right + stiffness * turn) / in.pivot;
                frame[0] = turned_about_itself(frame[0], turn);
                of<Q>(m_.ahead).set(i - 2, frame[0]);
            }
            if (has<Core>(set)) core[1] = get<Core>(k_.terms).printed ? in.core : adjoint(in.core);
            if (has<Adhesion>(set)) sample_nearest(motion, x[2], phi[2], normal[2], surface_velocity[2]);
            assemble_present(set, view, system, std::make_index_sequence<std::tuple_size_v<ChainTerms>>());

            // Row i is whole.
            r[2] += scheme.right_side(mass[2], old_v[2], in.v_before, v[2], force[2] + mass[2] * k_.gravity);
            diagonal[2] += identity_times(mass[2]);
            if (set.has(present::contact) && in.pushed > 0)
                add_hold(hold_of(i, motion, in.pushed, scheme.h, mass[2], first_x[2], old_v[2]), scheme.h,
                         v[2], diagonal[2], r[2]);
            M u1 = transposed(upper1[1]), u2 = transposed(upper2[0]), u11 = transposed(upper1[0]);
            eliminate(Row<T>{diagonal[2], &u1, penta(set) ? &u2 : nullptr, r[2]}, &diagonal[1], &r[1], &u11,
                      &diagonal[0], &r[0]);
            T* out = factors_of(set, i);
            LaneArray<V, T>{out}.set(0, r[2]);
            LaneArray<M, T>{out + 3 * Lanes<T>::lanes}.set(0, u1);
            if (penta(set)) LaneArray<M, T>{out + 12 * Lanes<T>::lanes}.set(0, u2);

            diagonal[2] = diagonal[1], diagonal[1] = diagonal[0], diagonal[0] = no_sym;
            upper1[1] = transposed(u11), upper1[0] = no_mat;
            force[2] = force[1], force[1] = force[0], force[0] = zero;
            r[2] = r[1], r[1] = r[0], r[0] = zero;
        }
    }
    // What adhesion needs to know.
    WETCURL_HD void touch(const SubstepMotion<T>& motion, const Bdf2<T>& scheme) const {
        const auto touching = of<T>(m_.touching);
        for (int i = 0; i < m_.n; ++i) {
            T phi;
            V normal, surface_velocity;
            sample_nearest(motion, look_at(scheme, i), phi, normal, surface_velocity);
            touching.set(i, updated_touching(touching[i], phi, T(get<Adhesion>(k_.terms).h_a)));
        }
    }

    // Eliminates until the edges at their strain limit and the particles that surfaces hold are found, and
    // takes forces anew where edges turn far, as the reference does.
    template <class Set>
    WETCURL_HD void solve(const Set& set, const SubstepMotion<T>& motion, const Bdf2<T>& scheme) {
        const auto pushed = of<T>(m_.pushed);
        const auto mass = of<const T>(m_.mass);
        bool contacts = false;
        for (int i = 2; set.has(present::contact) && i < m_.n; ++i) {
            T momentum = pushed[i];
            const Hold<T> hold =
                first_hold_of(i, motion, momentum, scheme.h, mass[i], at_first(scheme, i), v_[i]);
            if (!(momentum > 0)) continue;
            contacts = true;
            pushed.set(i, hold.weight > 0 ? momentum : -momentum);
        }
        while (true) {
            const bool far = solve_as_seen(set, motion, scheme, contacts);
            if (!far || looks_ == k_.looks) break;
            const auto change = of<V>(m_.change);
            // A particle's place is read before its change is written.
            for_each_solution(set, motion, scheme, true, [&](int i, const V&, const V& d, const V&) {
                change.set(i, change_at(i) + d);
            });
            ++looks_;
            Ahead ahead(scheme, Q::identity());
            for (int i = 0; i < m_.n; ++i) {
                const Outputs in = outputs_at(set, i);
                look_ahead(set, ahead, i, look_at(scheme, i), look_velocity(scheme, i), in, in.frame);
            }
            finish(set, ahead);
        }
        // Only now: every solve is to see the same contacts.
        if (has<Adhesion>(set)) touch(motion, scheme);
    }
    // Calls f(i, its place, its solution, the solution of i-1); before one is there, with 0.
    template <class Set, class F>
    WETCURL_HD void for_each_solution(const Set& set, const SubstepMotion<T>& motion, const Bdf2<T>& scheme,
                                      bool solved, F f) const {
        const V zero{T(0), T(0), T(0)};
        V d1 = zero, d2 = zero;
        for (int i = 0; i < m_.n; ++i) {
            const V x = look_at(scheme, i);
            V d = zero;
            if (solved)
                d = i < 2 ? (T(1) / scheme.h) * (placed_root(motion, i) - x)
                          : substituted(set, factors_at(set, i), d1, d2);
            f(i, x, d, d1);
            d2 = d1, d1 = d;
        }
    }
    // Returns whether an edge turned far.
    template <class Set>
    WETCURL_HD bool solve_as_seen(const Set& set, const SubstepMotion<T>& motion, const Bdf2<T>& scheme,
                                  bool contacts) const {
        const auto at = of<V>(m_.limit_edge);
        const auto pushed = of<T>(m_.pushed);
        const auto rest_length = of<const T>(m_.rest_length), mass = of<const T>(m_.mass);
        auto take_edges = [&](bool solved) {
            V x1{T(0), T(0), T(0)};
            for_each_solution(set, motion, scheme, solved, [&](int i, const V& x, const V& d, const V& d1) {
                if (i >= 2) at.set(i - 1, (x - x1) + scheme.h * (d - d1));
                x1 = x;
            });
        };
        if (has<StrainLimit>(set)) take_edges(false);
        const T turn = far_turn(k_.turn, T(contacts));
        for (int solves = 1;; ++solves) {
            eliminate_from_tip(set, motion, scheme);
            // The twists' turns are done.
            if (has<StrainLimit>(set) || contacts)
                for (int i = 1; has<Twist>(set) && i + 1 < m_.n; ++i) of<T>(m_.twist, 2).set(2 * i + 1, T(0));
            T farthest(0), changed(0), turned(0);
            const bool limit = has<StrainLimit>(set) && solves < StrainLimit::most_solves,
                       holds = contacts && solves < most_contact_solves;
            V x1{T(0), T(0), T(0)};
            for_each_solution(set, motion, scheme, true, [&](int i, const V& x, const V& d, const V& d1) {
                if (i >= 2) {
                    const V way = scheme.h * (d - d1);
                    turned = maximum(turned, turned_far<T>(way, rest_length[i - 1], turn));
                    if (limit)
                        farthest = maximum(farthest, get<StrainLimit>(k_.terms).unsettled(
                                                         (x - x1) + way, at[i - 1], rest_length[i - 1]));
                }
                x1 = x;
                if (holds && i >= 2 && pushed[i] != 0) {
                    Hold<T> hold =
                        hold_of(i, motion, pushed[i], scheme.h, mass[i], at_first(scheme, i), v_[i]);
                    const T change = weigh_again(scheme.h, d, hold);
                    changed += change;
                    if (change > 0) pushed.set(i, -pushed[i]);
                }
            });
            if (farthest > 0) take_edges(true);
            if (!(farthest > 0) && !(changed > 0)) return turned > 0;
        }
    }

    // What particle i needs on the way from the root.
    struct Outputs {
        V x, x_before, v;
        Factors row;
        Q frame;                   // of edge i-1
        V target;                  // of edge i-1
        T rest_core, rest_length;  // of edge i-1
        T rest_depth, mass;        // of particle i; of particle i-2
    };
    template <class Set>
    WETCURL_HD Outputs outputs_at(const Set& set, int i) const {
        Outputs in{};
        in.x = x_[i], in.x_before = x_before_[i], in.v = v_[i];
        if (i >= 2) {
            in.row = factors_at(set, i);
        }
        if (i >= 1) {
            if (has<Bend>(set)) in.frame = of<Q>(m_.ahead)[i - 1], in.target = of<const V>(m_.target)[i - 1];
            if (has<Twist>(set) && i >= 2) in.mass = of<const T>(m_.mass)[i - 2];
            if (has<Core>(set)) in.rest_core = of<const T>(m_.rest_core)[i - 1];
            if (has<Twist>(set) || has<StrainLimit>(set)) in.rest_length = of<const T>(m_.rest_length)[i - 1];
        }
        if (set.has(present::contact) && m_.rest_depth) in.rest_depth = of<const T>(m_.rest_depth)[i];
        return in;
    }

    // The way from the root along the positions at which the next forces are taken.
    struct Ahead {
        T h;
        Q root_turn;
        V x{T(0), T(0), T(0)}, v{T(0), T(0), T(0)};  // of particle i-1
        Q frame{};                                   // of edge i-2
        T k{}, torque{};                             // of the joint of edges i-3 and i-2
        TwistElimination<T> row;
        EdgeFilter<T> edges{T(1), V{T(0), T(0), T(0)}}, rates{T(1), V{T(0), T(0), T(0)}};
        WETCURL_HD Ahead(const Bdf2<T>& scheme, const Q& turn) : h(scheme.h), root_turn(turn) {}
    };
    WETCURL_HD void store(const TwistElimination<T>& row, int edge) const {
        of<T>(m_.twist, 2).set(2 * edge, row.pivot), of<T>(m_.twist, 2).set(2 * edge + 1, row.right);
    }
    // Particle i at x and v; `frame`: of edge i-1 where it is now.
    template <class Set>
    WETCURL_HD void look_ahead(const Set& set, Ahead& a, int i, const V& x, const V& v, const Outputs& in,
                               const Q& frame) const {
        const V e = x - a.x, rate = v - a.v;
        a.x = x, a.v = v;
        if (i < 1) return;
        if (has<Core>(set)) {
            const Core& core = get<Core>(k_.terms);
            if (i == 1) a.edges = EdgeFilter<T>(T(core.beta), e), a.rates = EdgeFilter<T>(T(core.beta), rate);
            of<V>(m_.core).set(i - 1, core.pull(a.edges(e), a.rates(rate), in.rest_core));
        }
        if (!has<Bend>(set)) return;
        const Q here = transported(a.root_turn * frame, e);
        of<Q>(m_.ahead).set(i - 1, here);
        if (has<Twist>(set) && i > 1) {
            const Twist& twist = get<Twist>(k_.terms);
            const T k = twist.stiffness(in.rest_length);
            const T torque = k * Twist::HalfAngle<T>(a.frame, here).sine_of_whole();
            if (i > 2) {
                T slope, bound;
                bend_by_turn(get<Bend>(k_.terms), a.frame, in.target, e, slope, bound);
                a.row.next(i == 3, a.k, a.torque, k, torque, slope, bound, twist.lag(a.h, in.mass));
                store(a.row, i - 2);
            }
            a.k = k, a.torque = torque;
        }
        a.frame = here;
    }
    // The tip's edge, which has no joint after it.
    template <class Set>
    WETCURL_HD void finish(const Set& set, Ahead& a) const {
        if (!has<Twist>(set) || m_.n < 3) return;
        const T lag = get<Twist>(k_.terms).lag(a.h, of<const T>(m_.mass)[m_.n - 2]);
        a.row.next(m_.n == 3, a.k, a.torque, T(0), T(0), T(0), T(0), lag);
        store(a.row, m_.n - 2);
    }

    template <class Set>
    WETCURL_HD int substitute_from_root(const Set& set, const SubstepMotion<T>& motion, const Bdf2<T>& scheme,
                                        const Q& turn_after, bool last) const {
        const int n = m_.n;
        const V zero{T(0), T(0), T(0)};
        const Bdf2<T> following(k_.dt, false, k_.share);
        Ahead ahead(following, turn_after);
        V d1 = zero, d2 = zero;  // solution of particles i-1 and i-2
        V x1 = zero;             // of particle i-1
        int limited = 0;
        Outputs next = outputs_at(set, 0);
        for (int i = 0; i < n; ++i) {
            const Outputs in = next;
            if (i + 1 < n) next = outputs_at(set, i + 1);
            const V expected = scheme.predicted(in.x, in.x_before, in.v), change = change_at(i);
            V x = expected + scheme.h * change, v = scheme.expected_velocity(in.v) + change, x_old = in.x,
              v_old = in.v, d;
            if (i < 2) {
                const V placed = placed_root(motion, i);
                d = (T(1) / scheme.h) * (placed - x);
                x = placed;
            } else {
                d = substituted(set, in.row, d1, d2);
                x += scheme.h * d;
            }
            v += d;
            if (has<StrainLimit>(set) && i >= 2)
                limited += get<StrainLimit>(k_.terms).holds(of<V>(m_.limit_edge)[i - 1], in.rest_length);
            d2 = d1, d1 = d;
            bool moved = false;
            T pushed(0), mass(0);
            if (set.has(present::contact) && i >= 2) {
                pushed = of<T>(m_.pushed)[i], mass = of<const T>(m_.mass)[i];
                if (pushed < 0) pushed = 0;
                if (pushed > 0) {
                    pushed =
                        pushed_by(hold_of(i, motion, pushed, scheme.h, mass, expected, in.v), scheme.h, d);
                }
            }
            if (set.has(present::contact) && i >= 2) {
                for (const auto& solid : motion)
                    moved |= resolve_contact(solid, T(0), solid.attached ? in.rest_depth : T(0), k_.dt, mass,
                                             pushed, x, x_old, v, v_old);
                of<T>(m_.pushed).set(i, pushed);
            }
            x_before_.set(i, x), v_before_.set(i, v);
            if (moved) x_.set(i, x_old), v_.set(i, v_old);
            Q frame{};
            if (has<Bend>(set) && i > 0) {
                frame = transported(in.frame, x - x1);
                if (last) of<Q>(m_.frame).set(i - 1, frame);
            }
            look_ahead(set, ahead, i, following.predicted(x, x_old, v), following.expected_velocity(v), in,
                       frame);
            x1 = x;
        }
        finish(set, ahead);
        return limited;
    }

    const StrandMemory<T>& m_;
    const ChainConstants<T>& k_;
    size_t block_;
    int lane_;
    int looks_ = 1;  // how often forces were taken in this step
    LaneArray<V, T> x_, x_before_, v_, v_before_;
};

}  // namespace wetcurl

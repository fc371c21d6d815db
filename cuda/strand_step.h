// The implicit substep of a few strands by a team of threads, which keep them near while a frame's substeps
// are taken. What is independent along a strand is shared out by particle: frames, forces, rows of the
// matrix, contact; what runs along it, twists, the core's filter and the system, takes rounds that reach ever
// farther. Each strand is solved as often as it needs. Terms, formulas and order are those of
// solver/passes/chain_step.h, which is the reference.
#pragma once

#include "cuda/strand_parts.h"
#include "cuda/strand_system.h"
#include "cuda/team.h"

namespace wetcurl {

template <class T>
class StrandStep {
    using V = Vec3<T>;
    using Q = Quat<T>;
    using M = Mat3<T>;
    struct alignas(4 * sizeof(T)) Frame : Q {};  // read and written whole
    // An edge's row of the system of the turns of edges about themselves: what couples it to an edge before
    // and to one after, what its diagonal has beyond these (nothing cancels in sums of such), its right side.
    struct alignas(4 * sizeof(T)) TwistRow {
        T before, after, excess, right;
        WETCURL_HD T inverse() const { return T(1) / maximum(before + after + excess, T(1e-30)); }
    };

  public:
    // What the team shares of a strand beside its room.
    struct Flags {
        unsigned now, seen;
    };
    // Numbers of room for each strand.
    WETCURL_HD static size_t room(int n, bool limits) {
        return size_t(n) * (4 + 7 * 3 + 4 + (limits ? 3 : 0)) +
               size_t(StrandSystem<T>::pairs_of(n)) * StrandSystem<T>::pair_size;
    }

    // Strands first .. first + count - 1. `room`: of each, aligned to four numbers; `flags` (count).
    WETCURL_HD StrandStep(const StrandMemory<T>& m, const ChainConstants<T>& constants, const Team& team,
                          int first, int count, bool limits, T* room, Flags* flags)
        : m_(m),
          k_(constants),
          parts_(m, constants),
          team_(team),
          count_(count),
          first_(size_t(first)),
          flags_(flags) {
        const size_t cells = size_t(count) * size_t(m.n);
        auto take = [&](size_t numbers) {
            T* at = room;
            room += numbers * cells;
            return at;
        };
        system_ = {m.n, room};
        room += size_t(count) * size_t(StrandSystem<T>::pairs_of(m.n)) * StrandSystem<T>::pair_size;
        frame_ = reinterpret_cast<Frame*>(take(4));
        for (V** vectors : {&x_, &x_before_, &v_, &v_before_, &at_, &rate_, &core_})
            *vectors = reinterpret_cast<V*>(take(3));
        pushed_ = take(1), gap_ = take(1), mass_ = take(1), rest_length_ = take(1);
        if (limits) limit_edge_ = reinterpret_cast<V*>(take(3));
    }

    // From the memory, and back.
    template <class Set>
    WETCURL_HD void load(const Set& set) {
        for_each_particle(0, m_.n, [&](int g, int i) {
            const int k = cell(g, i);
            const size_t from = first_ * size_t(m_.n) + size_t(k);
            x_[k] = m_.x[from], x_before_[k] = m_.x_before[from];
            v_[k] = m_.v[from], v_before_[k] = m_.v_before[from];
            mass_[k] = m_.mass[from], rest_length_[k] = m_.rest_length[from];
            if (has<Bend>(set)) frame_[k] = Frame{m_.frame[from]};
            if (set.has(present::contact)) pushed_[k] = m_.pushed[from];
        });
    }
    template <class Set>
    WETCURL_HD void store(const Set& set) const {
        for_each_particle(0, m_.n, [&](int g, int i) {
            const int k = cell(g, i);
            const size_t to = first_ * size_t(m_.n) + size_t(k);
            m_.x[to] = x_[k], m_.x_before[to] = x_before_[k];
            m_.v[to] = v_[k], m_.v_before[to] = v_before_[k];
            if (has<Bend>(set)) m_.frame[to] = frame_[k];
            if (set.has(present::contact)) m_.pushed[to] = pushed_[k];
        });
    }

    // One substep, `first` of a run (no history) or not. Returns how many edges this thread saw held at their
    // strain limit.
    template <class Set>
    WETCURL_HD int step(const Set& set, const SubstepMotion<T>& motion, bool first) {
        const Bdf2<T> scheme(k_.dt, first, k_.share);
        team_.share(count_, 1, [&](int g, int) { flags_[g] = {active, 0}; });
        expect(set, motion, scheme);
        for (int looks = 1;; ++looks) {
            look(set, motion, scheme, looks == 1);
            solve(set, motion, scheme);
            bool anew = false;
            team_.each(count_, [&](int g) {
                unsigned& now = flags_[g].now;
                const bool goes_on = now & active && now & far_off && looks < k_.looks;
                now = goes_on ? now | looked_anew : now & ~active;
                anew |= goes_on;
            });
            if (!team_.any(anew)) break;
            // Forces are taken anew where the solution has led those strands.
            for_each_particle(0, m_.n, [&](int g, int i) {
                if (!is(active, g)) return;
                const V d = system_.right(g, i);
                at_[cell(g, i)] += scheme.h * d, rate_[cell(g, i)] += d;
            });
        }
        const int limited = finish(set, motion, scheme);
        // What was written over the older state is the newer one.
        const auto x = x_, v = v_;
        x_ = x_before_, v_ = v_before_;
        x_before_ = x, v_before_ = v;
        return limited;
    }

  private:
    // Of a strand: its forces are taken; its system is solved; surfaces push it; an edge turns far; forces
    // have been taken more than once.
    enum : unsigned { active = 1, solved = 2, touches = 4, far_off = 8, looked_anew = 16 };
    // Seen in its solution.
    enum : unsigned { limit_moved = 1, hold_changed = 2, turned = 4 };

    WETCURL_HD int cell(int g, int i) const { return g * m_.n + i; }
    WETCURL_HD bool is(unsigned what, int g) const { return flags_[g].now & what; }
    // Of what is in the memory alone.
    WETCURL_HD size_t place(int k) const { return first_ * size_t(m_.n) + size_t(k); }
    template <class E>
    WETCURL_HD E of(const E* numbers, int k) const {
        return numbers[place(k)];
    }
    WETCURL_HD Particle<T> particle(int k) const {
        return {x_[k],  x_before_[k], v_[k],    v_before_[k],
                at_[k], rate_[k],     mass_[k], m_.rest_depth ? of(m_.rest_depth, k) : T(0)};
    }
    // f(strand, particle) for first <= particle < end. Waits.
    template <class F>
    WETCURL_HD void for_each_particle(int first, int end, F f) const {
        if (first < end) team_.share(count_, end - first, [&](int g, int k) { f(g, first + k); });
    }
    // In the place of a strand's system, until there is one.
    WETCURL_HD TwistRow* twist(int g, bool other) const {
        return reinterpret_cast<TwistRow*>(system_.numbers(g)) + (other ? m_.n : 0);
    }
    WETCURL_HD V* spare(int g, int which) const {
        return reinterpret_cast<V*>(system_.numbers(g) + 8 * m_.n) + which * m_.n;
    }
    WETCURL_HD V edge_at(int k) const { return at_[k + 1] - at_[k]; }
    WETCURL_HD V placed_root(const SubstepMotion<T>& motion, int g, int i) const {
        return parts_.placed_root(motion, first_ + size_t(g), i);
    }
    WETCURL_HD V known(const SubstepMotion<T>& motion, const Bdf2<T>& scheme, int g, int i) const {
        return (T(1) / scheme.h) * (placed_root(motion, g, i) - at_[cell(g, i)]);
    }

    // --- where particles are expected, and which surfaces hold them

    template <class Set>
    WETCURL_HD void expect(const Set& set, const SubstepMotion<T>& motion, const Bdf2<T>& scheme) {
        for_each_particle(0, m_.n, [&](int g, int i) {
            const int k = cell(g, i);
            const V x = scheme.predicted(x_[k], x_before_[k], v_[k]);
            at_[k] = x, rate_[k] = scheme.expected_velocity(v_[k]);
            if (!set.has(present::contact) || i < 2) return;
            T momentum = pushed_[k];
            const Hold<T> hold = parts_.expected_hold(motion, scheme, particle(k), x, momentum);
            gap_[k] = hold.gap;
            if (!(momentum > 0)) return;
            pushed_[k] = hold.weight > 0 ? momentum : -momentum;
            Team::raise(flags_[g].now, touches);
        });
    }

    // --- what forces need of the whole strand

    template <class Set>
    WETCURL_HD void look(const Set& set, const SubstepMotion<T>& motion, const Bdf2<T>& scheme, bool first) {
        if (has<Bend>(set) || has<StrainLimit>(set))
            for_each_active(0, [&](int g, int i) {
                const int k = cell(g, i);
                const V e = edge_at(k);
                if (has<StrainLimit>(set)) limit_edge_[k] = e;
                if (!has<Bend>(set)) return;
                const Q frame = frame_[k];
                frame_[k] = Frame{transported(first ? motion.root_turn * frame : frame, e)};
            });
        if (has<Core>(set) || has<Twist>(set)) take_along(set, scheme);
    }
    // f(strand, edge) for edges from `first` on of strands whose forces are taken. Waits.
    template <class F>
    WETCURL_HD void for_each_active(int first, F f) const {
        for_each_particle(first, m_.n - 1, [&](int g, int i) {
            if (is(active, g)) f(g, i);
        });
    }
    // f(other, reach, weight) in rounds, each of which reaches twice as far along a strand as the one before
    // and reads what that has left, in turns here or (`other`) there. Returns where the last one leaves it.
    template <class F>
    WETCURL_HD bool in_rounds(bool other, T weight, F f) const {
        for (int reach = 1; reach < m_.n - 1; reach *= 2, other = !other, weight *= weight)
            f(other, reach, weight);
        return other;
    }
    // The turns of edges about themselves and the core's forces.
    template <class Set>
    WETCURL_HD void take_along(const Set& set, const Bdf2<T>& scheme) {
        const bool filters = has<Core>(set);
        const T beta = filters ? T(get<Core>(k_.rules.terms).beta) : T(0);
        for_each_active(0, [&](int g, int i) {
            const int k = cell(g, i), root = cell(g, 0);
            if (has<Twist>(set) && i > 0) twist(g, false)[i] = joint(scheme, i, k);
            if (!filters) return;
            // Before the root the strand goes on straight.
            smoothed(g, false)[i] = edge_at(k) - edge_at(root);
            rates(g, false)[i] = rate_[k + 1] - rate_[k] - (rate_[root + 1] - rate_[root]);
        });
        const bool last = in_rounds(false, 1 - beta, [&](bool other, int reach, T weight) {
            for_each_active(0, [&](int g, int i) {
                if (has<Twist>(set) && i > 0) twist(g, !other)[i] = reduced(twist(g, other), i, reach);
                if (!filters) return;
                smoothed(g, !other)[i] = doubled(smoothed(g, other), i, -reach, weight);
                rates(g, !other)[i] = doubled(rates(g, other), i, -reach, weight);
            });
        });
        const bool adjoint = filters && !get<Core>(k_.rules.terms).printed;
        for_each_active(0, [&](int g, int i) {
            const int k = cell(g, i), root = cell(g, 0);
            if (has<Twist>(set) && i > 0) {
                const TwistRow row = twist(g, last)[i];
                frame_[k] = Frame{turned_about_itself(Q(frame_[k]), row.right * row.inverse())};
            }
            if (!filters) return;
            const T c = beta * beta;
            const V b = edge_at(root) + c * smoothed(g, last)[i],
                    nu = rate_[root + 1] - rate_[root] + c * rates(g, last)[i];
            // As many rounds go back: they end in the core's own room.
            core(g, adjoint && last)[i] =
                (adjoint ? c : T(1)) * get<Core>(k_.rules.terms).pull(b, nu, of(m_.rest_core, k));
        });
        if (adjoint)
            in_rounds(last, 1 - beta, [&](bool other, int reach, T weight) {
                for_each_active(
                    1, [&](int g, int i) { core(g, !other)[i] = doubled(core(g, other), i, reach, weight); });
            });
    }
    // The core's force along each edge, in the end in a room of its own; and what it comes of.
    WETCURL_HD V* core(int g, bool other) const { return other ? spare(g, 0) : core_ + cell(g, 0); }
    WETCURL_HD V* smoothed(int g, bool other) const { return spare(g, other ? 1 : 2); }
    WETCURL_HD V* rates(int g, bool other) const { return spare(g, other ? 3 : 4); }
    // The filter of Eq 2 but for its factor beta², 1 / (1 - q z)² with q = 1 - beta, is the product of
    // (1 + q^r z^r)² over r = 1, 2, 4, ...; its adjoint likewise, towards the root. `weight`: q^r.
    WETCURL_HD V doubled(const V* values, int i, int reach, T weight) const {
        V sum = values[i];
        const int near = i + reach, far = i + 2 * reach, edges = m_.n - 1;
        if (near >= 0 && near < edges) sum += 2 * weight * values[near];
        if (far >= 0 && far < edges) sum += weight * weight * values[far];
        return sum;
    }
    // Hockney and Jesshope 1981, parallel cyclic reduction: rows `reach` before and after are taken off row
    // i.
    WETCURL_HD TwistRow reduced(const TwistRow* rows, int i, int reach) const {
        TwistRow row = rows[i];
        if (i - reach > 0) {
            const TwistRow before = rows[i - reach];
            const T share = row.before * before.inverse();
            row.before = share * before.before;
            row.excess += share * before.excess, row.right += share * before.right;
        }
        if (i + reach < m_.n - 1) {
            const TwistRow after = rows[i + reach];
            const T share = row.after * after.inverse();
            row.after = share * after.after;
            row.excess += share * after.excess, row.right += share * after.right;
        }
        return row;
    }
    // As of TwistElimination.
    WETCURL_HD TwistRow joint(const Bdf2<T>& scheme, int i, int k) const {
        const Twist& springs = get<Twist>(k_.rules.terms);
        const Q frame = frame_[k];
        const T stiffness = springs.stiffness(rest_length_[k]);
        const T torque = stiffness * Twist::HalfAngle<T>(Q(frame_[k - 1]), frame).sine_of_whole();
        T after(0), torque_after(0), slope(0), bound(0);
        if (i + 2 < m_.n) {
            after = springs.stiffness(rest_length_[k + 1]);
            torque_after = after * Twist::HalfAngle<T>(frame, Q(frame_[k + 1])).sine_of_whole();
            bend_by_turn(get<Bend>(k_.rules.terms), frame, of(m_.target, k + 1), edge_at(k + 1), slope,
                         bound);
        }
        const T lag = springs.lag(scheme.h, mass_[k]);
        const T excess = bound + lag * (bound + stiffness + after);
        // Edge 0 is held by the root.
        return {i == 1 ? T(0) : stiffness, after, i == 1 ? excess + stiffness : excess,
                torque_after - torque - slope};
    }

    // --- the system

    // Those that end at particle j of strand g.
    template <class Set>
    WETCURL_HD Element<T> element(const Set& set, const SubstepMotion<T>& motion, const Bdf2<T>& scheme,
                                  int g, int j) const {
        const int k = cell(g, j);
        Window<T> w;
        for (int l = 0; l < 3; ++l)
            w.x[l] = at_[k - 2 + l], w.v[l] = rate_[k - 2 + l], w.mass[l] = mass_[k - 2 + l];
        w.rest_length[1] = rest_length_[k - 1];
        if (has<Bend>(set))
            w.frame[0] = frame_[k - 2], w.frame[1] = frame_[k - 1], w.target[1] = of(m_.target, k - 1);
        if (has<Core>(set)) w.core[1] = core_[k - 1];
        if (has<StrainLimit>(set)) w.limit_edge[1] = limit_edge_[k - 1];
        if (has<CurlPush>(set)) w.chord = at_[cell(g, m_.n - 1)] - at_[cell(g, 0)];
        w.saturation[2] = parts_.sees_water(set) ? of(m_.saturation, k) : T(0);
        parts_.fill(set, motion, place(k), w);
        return parts_.element(set, motion, scheme, w);
    }
    // The rows of strands that are to be solved. From the tips, so that a row is set by the first element
    // that reaches it; elements that share one take turns.
    template <class Set>
    WETCURL_HD void assemble(const Set& set, const SubstepMotion<T>& motion, const Bdf2<T>& scheme) const {
        const int n = m_.n, span = n - 2;
        for (int begin = 0; begin < count_ * span; begin += team_.threads) {
            const int job = begin + team_.thread, g = int((float(job) + 0.5f) / float(span)),
                      j = n - 1 - (job - g * span);
            const bool mine = job < count_ * span && is(solved, g);
            Element<T> e;
            if (mine) {
                e = element(set, motion, scheme, g, j);
                system_.set_row(g, j - 2, e.diagonal[0], e.force[0], e.upper1[0], e.upper2[0]);
                if (j == n - 1)
                    for (int i = n - 2; i < n + n % 2; ++i) system_.clear_row(g, i);
            }
            team_.wait();
            if (mine) {
                system_.add_diagonal(g, j - 1, e.diagonal[1]), system_.right(g, j - 1) += e.force[1];
                system_.add_coupling(g, j - 1, e.upper1[1]);
            }
            team_.wait();
            if (mine) system_.add_diagonal(g, j, e.diagonal[2]), system_.right(g, j) += e.force[2];
            team_.wait();
        }
        for_each_particle(0, n, [&](int g, int i) {
            if (!is(solved, g)) return;
            V& r = system_.right(g, i);
            if (i < 2) {
                r = known(motion, scheme, g, i);
                return;
            }
            const int k = cell(g, i);
            const Particle<T> p = particle(k);
            Sym3<T> diagonal = identity_times(T(0));
            r = parts_.own_row(set, scheme, place(k), p, r, diagonal);
            if (i < 4)
                r -= system_.known_part(g, i, known(motion, scheme, g, 0), known(motion, scheme, g, 1));
            const T pushed = set.has(present::contact) ? pushed_[k] : T(0);
            if (pushed > 0)
                add_hold(parts_.hold_of(motion, scheme, p, pushed), scheme.h, p.rate, diagonal, r);
            system_.add_diagonal(g, i, diagonal);
        });
    }

    // Solves until the edges at their strain limit and the particles that surfaces hold are found.
    template <class Set>
    WETCURL_HD void solve(const Set& set, const SubstepMotion<T>& motion, const Bdf2<T>& scheme) {
        const int n = m_.n;
        auto way_of = [&](int g, int edge) {
            return scheme.h * (system_.right(g, edge + 1) - system_.right(g, edge));
        };
        team_.share(count_, 1, [&](int g, int) {
            const unsigned now = flags_[g].now & ~(solved | far_off);
            flags_[g].now = now & active ? now | solved : now;
        });
        for (int solves = 1;; ++solves) {
            assemble(set, motion, scheme);
            system_.solve(team_, count_, [&](int g) { return is(solved, g); });
            const bool limits = has<StrainLimit>(set) && solves < StrainLimit::most_solves,
                       holds = set.has(present::contact) && solves < most_contact_solves;
            for_each_particle(2, n, [&](int g, int i) {
                if (!is(solved, g)) return;
                const int k = cell(g, i);
                const V way = way_of(g, i - 1);
                const T rest = rest_length_[k - 1];
                const bool contacts = is(touches, g);
                unsigned seen = 0;
                if (turned_far<T>(way, rest, far_turn(k_.turn, T(contacts))) > 0) seen |= turned;
                if (limits && get<StrainLimit>(k_.rules.terms)
                                      .unsettled(edge_at(k - 1) + way, limit_edge_[k - 1], rest) > 0)
                    seen |= limit_moved;
                if (holds && contacts && pushed_[k] != 0) {
                    Hold<T> hold = parts_.hold_of(motion, scheme, particle(k), pushed_[k]);
                    if (weigh_again(scheme.h, system_.right(g, i), hold) > 0)
                        pushed_[k] = -pushed_[k], seen |= hold_changed;
                }
                if (seen) Team::raise(flags_[g].seen, seen);
            });
            if (has<StrainLimit>(set) && limits)
                for_each_particle(1, n - 1, [&](int g, int i) {
                    if (flags_[g].seen & limit_moved)
                        limit_edge_[cell(g, i)] = edge_at(cell(g, i)) + way_of(g, i);
                });
            bool again = false;
            team_.each(count_, [&](int g) {
                const unsigned seen = flags_[g].seen;
                unsigned now = flags_[g].now;
                flags_[g].seen = 0;
                if (!(now & solved)) return;
                now = seen & turned ? now | far_off : now & ~far_off;
                if (!(seen & (limit_moved | hold_changed))) now &= ~solved;
                flags_[g].now = now;
                again |= now & solved;
            });
            if (!team_.any(again)) return;
        }
    }

    // --- where the step ends

    template <class Set>
    WETCURL_HD int finish(const Set& set, const SubstepMotion<T>& motion, const Bdf2<T>& scheme) {
        int limited = 0;
        for_each_particle(0, m_.n, [&](int g, int i) {
            const int k = cell(g, i);
            const V d = system_.right(g, i), expected = at_[k];
            V x = i < 2 ? placed_root(motion, g, i) : expected + scheme.h * d, v = rate_[k] + d;
            if (has<StrainLimit>(set) && i >= 2)
                limited += get<StrainLimit>(k_.rules.terms).holds(limit_edge_[k - 1], rest_length_[k - 1]);
            if (has<Adhesion>(set)) parts_.touch(set, motion, place(k), expected);
            if (set.has(present::contact) && i >= 2 &&
                parts_.may_meet(scheme, is(looked_anew, g), pushed_[k], gap_[k], d)) {
                Particle<T> p = particle(k);
                parts_.meet(motion, scheme, d, p, pushed_[k], x, v);
                x_[k] = p.x, v_[k] = p.v;
            }
            x_before_[k] = x, v_before_[k] = v;
        });
        if (has<Bend>(set))
            for_each_particle(0, m_.n - 1, [&](int g, int i) {
                const int k = cell(g, i);
                frame_[k] = Frame{transported(Q(frame_[k]), x_before_[k + 1] - x_before_[k])};
            });
        return limited;
    }

    const StrandMemory<T>& m_;
    const ChainConstants<T>& k_;
    const StrandParts<T> parts_;
    Team team_;
    int count_;
    size_t first_;
    Flags* flags_;
    StrandSystem<T> system_;
    Frame* frame_;
    V *x_, *x_before_, *v_, *v_before_;
    V *at_, *rate_;                            // positions and velocities at which forces are taken
    V* core_;                                  // the core's force along each edge
    V* limit_edge_ = nullptr;                  // edges at which the strain limit is taken
    T *pushed_, *gap_, *mass_, *rest_length_;  // gap: from surfaces where particles were first expected
};

}  // namespace wetcurl

// The bodies of the stages of an implicit substep (solver/chain/stages.h) for a few strands and a team of
// threads, which keep the strands near while a frame's substeps are taken. What is independent along a strand
// is shared out by particle: frames, forces, rows of the matrix, contact; what runs along it, twists and the
// core's filter, goes by chunks of it, and rounds between these that reach ever farther. Each strand is
// solved as often as it needs. Terms and formulas are those of solver/chain/substep.h, which is the
// reference.
#pragma once

#include "cuda/chain/strand_chunks.h"
#include "cuda/chain/strand_parts.h"
#include "cuda/chain/strand_system.h"
#include "cuda/device/thread_team.h"
#include "solver/chain/stages.h"

namespace wetcurl {

// What a team shares of a strand beside its workspace.
struct StrandFlags {
    unsigned now, seen;
};

// Numbers of workspace for so many strands.
template <class T>
WETCURL_HD size_t strand_workspace(int n, int count, bool limits) {
    const size_t of_a_particle = 4 + 7 * 3 + 2 + (limits ? 3 : 0);
    return size_t(StrandSystem<T>::numbers_of(n, count)) + size_t(count) * size_t(n) * of_a_particle;
}

// Set: what is there of the scene, ExactSet or AnySet.
template <class T, class Set, class Barrier>
class StrandStep {
    using V = Vec3<T>;
    using Q = Quat<T>;
    using M = Mat3<T>;
    struct alignas(4 * sizeof(T)) Frame : Q {};  // read and written whole
    using TwistRow = wetcurl::TwistRow<T>;
    using Smoothed = wetcurl::Smoothed<T>;

  public:
    int limited = 0;  // edges that this thread saw held at their strain limit

    // Strands first .. first + count - 1. `workspace`: strand_workspace, aligned to four numbers; `flags`
    // (count).
    WETCURL_HD StrandStep(const StrandMemory<T>& m, const ChainConstants<T>& constants, const Set& set,
                          const ThreadTeam<Barrier>& team, int first, int count, T* workspace,
                          StrandFlags* flags)
        : m_(m),
          k_(constants),
          set_(set),
          parts_(m, constants),
          team_(team),
          count_(count),
          first_(size_t(first)),
          flags_(flags),
          chunks_(m.n - 1) {
        const size_t cells = size_t(count) * size_t(m.n);
        auto room = [&](size_t numbers) {
            T* at = workspace;
            workspace += numbers * cells;
            return at;
        };
        system_ = {m.n, workspace};
        workspace += StrandSystem<T>::numbers_of(m.n, count);
        frame_ = reinterpret_cast<Frame*>(room(4));
        for (V** vectors : {&x_, &x_before_, &v_, &v_before_, &at_, &rate_, &core_})
            *vectors = reinterpret_cast<V*>(room(3));
        pushed_ = room(1), gap_ = room(1);
        if (has<StrainLimit>(set)) limit_edge_ = reinterpret_cast<V*>(room(3));
    }

    // From the memory, and back.
    WETCURL_HD void load() {
        for_each_particle(0, m_.n, [&](int g, int i) {
            const int k = cell(g, i);
            const size_t from = first_ * size_t(m_.n) + size_t(k);
            x_[k] = m_.x[from], x_before_[k] = m_.x_before[from];
            v_[k] = m_.v[from], v_before_[k] = m_.v_before[from];
            if (has<Bend>(set_)) frame_[k] = Frame{m_.frame[from]};
            if (set_.has(present::contact)) pushed_[k] = m_.pushed[from];
        });
    }
    WETCURL_HD void store() const {
        for_each_particle(0, m_.n, [&](int g, int i) {
            const int k = cell(g, i);
            const size_t to = first_ * size_t(m_.n) + size_t(k);
            m_.x[to] = x_[k], m_.x_before[to] = x_before_[k];
            m_.v[to] = v_[k], m_.v_before[to] = v_before_[k];
            if (has<Bend>(set_)) m_.frame[to] = frame_[k];
            if (set_.has(present::contact)) m_.pushed[to] = pushed_[k];
        });
    }

    // One substep, `first` of a run (no history) or not.
    WETCURL_HD void step(const SubstepMotion<T>& motion, bool first) {
        begin(motion, first);
        take_implicit_substep(*this);
        end();
    }
    // Before its stages, and after them.
    WETCURL_HD void begin(const SubstepMotion<T>& motion, bool first) {
        motion_ = &motion;
        scheme_ = Bdf2<T>(k_.dt, first, k_.share);
    }
    WETCURL_HD void end() {
        // What was written over the older state is the newer one.
        const auto x = x_, v = v_;
        x_ = x_before_, v_ = v_before_;
        x_before_ = x, v_before_ = v;
    }

    WETCURL_HD void take(stage::Predict, stage::FindHolds) {
        team_.share(count_, 1, [&](int g, int) { flags_[g] = {active | solved, 0}; });
        for_each_particle(0, m_.n, [&](int g, int i) {
            const int k = cell(g, i);
            const V x = scheme_.predicted(x_[k], x_before_[k], v_[k]);
            at_[k] = x, rate_[k] = scheme_.expected_velocity(v_[k]);
            if (!set_.has(present::contact) || i < 2) return;
            T momentum = pushed_[k];
            const Hold<T> hold = parts_.expected_hold(*motion_, scheme_, particle(k), x, momentum);
            gap_[k] = hold.gap;
            if (!(momentum > 0)) return;
            pushed_[k] = hold.weight > 0 ? momentum : -momentum;
            Barrier::raise(flags_[g].now, touches);
        });
    }
    WETCURL_HD void take(stage::CarryFrames at, stage::PlaceLimit) {
        if (has<Bend>(set_) || has<StrainLimit>(set_))
            for_each_particle(0, m_.n - 1, [&](int g, int i) {
                if (!is(active, g)) return;
                const int k = cell(g, i);
                const V e = edge_at(k);
                if (has<StrainLimit>(set_)) limit_edge_[k] = e;
                if (!has<Bend>(set_)) return;
                const Q frame = frame_[k];
                frame_[k] = Frame{transported(at.begins ? root_of(g).turn * frame : frame, e)};
            });
    }
    WETCURL_HD void take(stage::RelaxTwist, stage::Prepare) {
        if (has<Core>(set_) || has<Twist>(set_)) take_along();
    }
    // Elements sample where they need it.
    WETCURL_HD void take(stage::SampleSurfaces) const {}
    WETCURL_HD void take(stage::Solve) const {
        assemble();
        system_.solve(team_, count_, [&](int g) { return is(solved, g); });
    }
    WETCURL_HD bool take(stage::MoveLimit of_limit, stage::MoveHolds of_holds) {
        const int n = m_.n;
        auto way_of = [&](int g, int edge) {
            return scheme_.h * (system_.right(g, edge + 1) - system_.right(g, edge));
        };
        const bool limits = has<StrainLimit>(set_) && of_limit.may_move(), entering = k_.rules.holds_entering,
                   holds = set_.has(present::contact) && of_holds.may_move(entering);
        for_each_particle(2, n, [&](int g, int i) {
            if (!is(solved, g)) return;
            const int k = cell(g, i);
            const V way = way_of(g, i - 1);
            const T rest = of(m_.rest_length, k - 1);
            const bool contacts = is(touches, g);
            unsigned seen = 0;
            if (turned_far<T>(way, rest, far_turn(k_.relinearise_angle, T(contacts))) > 0) seen |= turned;
            if (limits &&
                get<StrainLimit>(k_.rules.terms).unsettled(edge_at(k - 1) + way, limit_edge_[k - 1], rest) >
                    0)
                seen |= limit_moved;
            if (holds && contacts && pushed_[k] != 0) {
                Hold<T> hold = parts_.hold_of(*motion_, scheme_, particle(k), pushed_[k]);
                if (weigh_again(scheme_.h, system_.right(g, i), hold) > 0)
                    pushed_[k] = -pushed_[k], seen |= hold_changed;
            } else if (const V d = system_.right(g, i);
                       holds && entering && may_enter(scheme_.h, is(looked_anew, g) ? T(0) : gap_[k], d)) {
                Hold<T> hold = parts_.hold_of(*motion_, scheme_, particle(k), -T(a_bit));
                if (weigh_again(scheme_.h, d, hold) > 0)
                    pushed_[k] = T(a_bit), seen |= hold_changed | entered;
            }
            if (seen) Barrier::raise(flags_[g].seen, seen);
        });
        if (has<StrainLimit>(set_) && limits)
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
            if (seen & entered) now |= touches;
            if (!(seen & (limit_moved | hold_changed))) now &= ~solved;
            flags_[g].now = now;
            again |= now & solved;
        });
        return team_.any(again);
    }
    // Where edges turn far is seen while limit and holds are.
    WETCURL_HD bool take(stage::Relinearise at) {
        if (at.linearisations == k_.max_linearisations) return false;
        bool anew = false;
        team_.each(count_, [&](int g) {
            unsigned& now = flags_[g].now;
            const bool goes_on = now & active && now & far_off;
            now = goes_on ? (now & ~far_off) | looked_anew | solved : now & ~active;
            anew |= goes_on;
        });
        if (!team_.any(anew)) return false;
        for_each_particle(0, m_.n, [&](int g, int i) {
            if (!is(active, g)) return;
            const V d = system_.right(g, i);
            at_[cell(g, i)] += scheme_.h * d, rate_[cell(g, i)] += d;
        });
        return true;
    }
    WETCURL_HD void take(stage::Place, stage::MeetSolids, stage::UpdateTouching) {
        for_each_particle(0, m_.n, [&](int g, int i) {
            const int k = cell(g, i);
            const V d = system_.right(g, i), expected = at_[k];
            V x = i < 2 ? placed_root(g, i) : expected + scheme_.h * d, v = rate_[k] + d;
            if (has<StrainLimit>(set_) && i >= 2)
                limited +=
                    get<StrainLimit>(k_.rules.terms).holds(limit_edge_[k - 1], of(m_.rest_length, k - 1));
            if (has<Adhesion>(set_)) parts_.touch(set_, *motion_, place(k), expected);
            if (set_.has(present::contact) && i >= 2 &&
                parts_.may_meet(scheme_, is(looked_anew, g), pushed_[k], gap_[k], d)) {
                Particle<T> p = particle(k);
                parts_.meet(*motion_, scheme_, d, p, pushed_[k], x, v);
                x_[k] = p.x, v_[k] = p.v;
            }
            x_before_[k] = x, v_before_[k] = v;
        });
    }
    WETCURL_HD void take(stage::EndFrames) {
        if (has<Bend>(set_))
            for_each_particle(0, m_.n - 1, [&](int g, int i) {
                const int k = cell(g, i);
                frame_[k] = Frame{transported(Q(frame_[k]), x_before_[k + 1] - x_before_[k])};
            });
    }

  protected:
    // Of a strand: its forces are taken; its system is solved; surfaces push it; an edge turns far; forces
    // have been taken more than once.
    enum : unsigned { active = 1, solved = 2, touches = 4, far_off = 8, looked_anew = 16 };
    // Seen in its solution.
    enum : unsigned { limit_moved = 1, hold_changed = 2, turned = 4, entered = 8 };

    WETCURL_HD int cell(int g, int i) const { return g * m_.n + i; }
    WETCURL_HD bool is(unsigned what, int g) const { return flags_[g].now & what; }
    // Of what is in the memory alone.
    WETCURL_HD size_t place(int k) const { return first_ * size_t(m_.n) + size_t(k); }
    template <class E>
    WETCURL_HD E of(const E* numbers, int k) const {
        return numbers[place(k)];
    }
    WETCURL_HD Particle<T> particle(int k) const {
        return {x_[k],  x_before_[k], v_[k],          v_before_[k],
                at_[k], rate_[k],     of(m_.mass, k), m_.rest_depth ? of(m_.rest_depth, k) : T(0)};
    }
    // f(strand, particle) for first <= particle < end. Waits.
    template <class F>
    WETCURL_HD void for_each_particle(int first, int end, F f) const {
        if (first < end) team_.share(count_, end - first, [&](int g, int k) { f(g, first + k); });
    }
    // In the place of a strand's system, until there is one: rows of twists, those of chunks' last edges, and
    // what the filter has there, each of the last two twice.
    WETCURL_HD TwistRow* twist(int g) const { return reinterpret_cast<TwistRow*>(system_.numbers(g)); }
    WETCURL_HD TwistRow* last_twist(int g, bool other) const {
        return twist(g) + m_.n + (other ? chunks_.count : 0);
    }
    WETCURL_HD Smoothed* smoothed(int g, int which, bool other) const {
        return reinterpret_cast<Smoothed*>(twist(g) + m_.n + 2 * chunks_.count) +
               (2 * which + other) * chunks_.count;
    }
    WETCURL_HD V edge_at(int k) const { return at_[k + 1] - at_[k]; }
    WETCURL_HD V placed_root(int g, int i) const {
        return parts_.placed_root(set_, *motion_, first_ + size_t(g), i);
    }
    WETCURL_HD const RootMotion<T>& root_of(int g) const {
        return parts_.root_of(set_, *motion_, first_ + size_t(g));
    }
    WETCURL_HD V known(int g, int i) const {
        return (T(1) / scheme_.h) * (placed_root(g, i) - at_[cell(g, i)]);
    }

    // --- what runs along the whole strand

    // f(strand, chunk) of strands whose forces are taken. Waits.
    template <class F>
    WETCURL_HD void for_each_chunk(F f) const {
        team_.share(count_, chunks_.count, [&](int g, int c) {
            if (is(active, g)) f(g, chunks_.chunk(c));
        });
    }
    // The turns of edges about themselves and the core's forces.
    WETCURL_HD void take_along() {
        const T q = T(1) - (has<Core>(set_) ? T(get<Core>(k_.rules.terms).beta) : T(1));
        for_each_chunk([&](int g, const Chunk& c) {
            if (has<Twist>(set_)) eliminate_twists(g, c);
            if (has<Core>(set_)) {
                Smoothed edges, rates;
                each_from_root(
                    g, c, [&](int, const V& e, const V& rate) { edges.next(e, q), rates.next(rate, q); });
                smoothed(g, 0, false)[c.number] = edges, smoothed(g, 1, false)[c.number] = rates;
            }
        });
        if (has<Twist>(set_))
            for_each_chunk([&](int g, const Chunk& c) {
                if (c.end < 2) return;
                TwistRow row = twist(g)[c.end - 1];
                // A row alone is its chunk's last one.
                if (c.end + 2 < m_.n) row.take_after(twist(g)[c.end]);
                last_twist(g, false)[c.number] = row;
            });
        const bool last = chunks_.in_rounds(false, q, [&](bool other, int reach, T share) {
            for_each_chunk([&](int g, const Chunk& c) {
                if (has<Twist>(set_))
                    last_twist(g, !other)[c.number] = chunks_.reduced(last_twist(g, other), c.number, reach);
                if (!has<Core>(set_)) return;
                for (int which = 0; which < 2; ++which)
                    smoothed(g, which, !other)[c.number] =
                        chunks_.carried(smoothed(g, which, other), c.number, -reach, share);
            });
        });
        const bool adjoint = has<Core>(set_) && !get<Core>(k_.rules.terms).printed;
        for_each_chunk([&](int g, const Chunk& c) {
            if (has<Twist>(set_)) turn(g, c, last_twist(g, last));
            if (!has<Core>(set_)) return;
            Smoothed edges = chunks_.at(smoothed(g, 0, last), c.number - 1),
                     rates = chunks_.at(smoothed(g, 1, last), c.number - 1);
            pull(g, c, q, edges, rates);
            if (!adjoint) return;
            Smoothed back;
            for (int i = c.end - 1; i >= c.begin; --i) back.next(core_[cell(g, i)], q);
            smoothed(g, 0, !last)[c.number] = back;
        });
        if (!adjoint) return;
        const bool end = chunks_.in_rounds(!last, q, [&](bool other, int reach, T share) {
            for_each_chunk([&](int g, const Chunk& c) {
                smoothed(g, 0, !other)[c.number] =
                    chunks_.carried(smoothed(g, 0, other), c.number, reach, share);
            });
        });
        for_each_chunk([&](int g, const Chunk& c) {
            Smoothed back = chunks_.at(smoothed(g, 0, end), c.number + 1);
            for (int i = c.end - 1; i >= c.begin; --i) {
                V& core = core_[cell(g, i)];
                back.next(core, q);
                core = back.twice;
            }
        });
    }
    // f(edge, e, rate) of a chunk, less those at the root: before it the strand goes on straight.
    template <class F>
    WETCURL_HD void each_from_root(int g, const Chunk& c, F f) const {
        const int root = cell(g, 0), first = cell(g, c.begin);
        const V e0 = edge_at(root), rate0 = rate_[root + 1] - rate_[root];
        V x = at_[first], v = rate_[first];
        for (int i = c.begin; i < c.end; ++i) {
            const int k = cell(g, i);
            const V x_next = at_[k + 1], v_next = rate_[k + 1];
            f(i, x_next - x - e0, v_next - v - rate0);
            x = x_next, v = v_next;
        }
    }
    // The core's force along each edge, for the adjoint to begin with where the scene asks for it.
    WETCURL_HD void pull(int g, const Chunk& c, T q, Smoothed edges, Smoothed rates) const {
        const Core& core = get<Core>(k_.rules.terms);
        const T factor = (T(1) - q) * (T(1) - q), weight = core.printed ? T(1) : factor;
        const int root = cell(g, 0);
        const V e0 = edge_at(root), rate0 = rate_[root + 1] - rate_[root];
        each_from_root(g, c, [&](int i, const V& e, const V& rate) {
            const int k = cell(g, i);
            edges.next(e, q), rates.next(rate, q);
            core_[k] = weight * core.pull(e0 + factor * edges.twice, rate0 + factor * rates.twice,
                                          of(m_.rest_core, k));
        });
    }
    // Where it is of the memory's `springs`; null without a fibre.
    WETCURL_HD const T* own(const T* springs, int k) const {
        return set_.has(present::fibre) ? springs + place(k) : nullptr;
    }
    // Of springs, edge by edge; of a fibre's edge i, of its whole turn.
    WETCURL_HD T lag(int k) const {
        return set_.has(present::fibre) ? T(0) : get<Twist>(k_.rules.terms).lag(scheme_.h, of(m_.mass, k));
    }
    WETCURL_HD T lag_of_turn(int i, int k) const {
        return set_.has(present::fibre) && i + 2 < m_.n
                   ? Twist::lag_of_fibre(scheme_.h, of(m_.mass, k), m_.bend_spring[place(k + 1)],
                                         of(m_.target, k + 1))
                   : T(0);
    }
    // In the end a chunk's rows are coupled to the last ones of this chunk and of the one before alone.
    WETCURL_HD void eliminate_twists(int g, const Chunk& c) const {
        const Twist& springs = get<Twist>(k_.rules.terms);
        const int first = c.begin > 0 ? c.begin : 1;
        if (first >= c.end) return;
        TwistRow* rows = twist(g);
        Q frame = frame_[cell(g, first)];
        TwistJoint<T> before =
            springs.joint(own(m_.twist_spring, cell(g, first)), of(m_.rest_length, cell(g, first)),
                          Q(frame_[cell(g, first - 1)]), frame);
        TwistRow near{};
        for (int i = first; i < c.end; ++i) {
            const int k = cell(g, i);
            T slope(0), bound(0);
            TwistJoint<T> after{T(0), T(0)};
            Q next{};
            if (i + 2 < m_.n) {
                next = frame_[k + 1];
                after = springs.joint(own(m_.twist_spring, k + 1), of(m_.rest_length, k + 1), frame, next);
                const T* bend = own(m_.bend_spring, k + 1);
                bend_by_turn(bend ? *bend : T(get<Bend>(k_.rules.terms).k_b), frame, of(m_.target, k + 1),
                             edge_at(k + 1), slope, bound);
            }
            TwistRow row = twist_row(i, before, after, slope, bound, lag(k));
            if (i > first) row.take_before(near);
            rows[i] = near = row;
            frame = next, before = after;
        }
        for (int i = c.end - 3; i >= first; --i) {
            // What the row after is coupled to before is not this row any more.
            TwistRow row = rows[i];
            const T before = row.after * rows[i + 1].inverse() * rows[i + 1].before;
            row.take_after(rows[i + 1]);
            row.before += before;
            rows[i] = row;
        }
    }
    // `last`: rows of chunks' last edges, coupled to none.
    WETCURL_HD void turn(int g, const Chunk& c, const TwistRow* last) const {
        auto turn_of = [&](int chunk) { return last[chunk].right * last[chunk].inverse(); };
        if (c.end < 2) return;
        const T x = turn_of(c.number), x_before = c.number > 0 ? turn_of(c.number - 1) : T(0);
        for (int i = c.begin > 0 ? c.begin : 1; i < c.end; ++i) {
            const TwistRow row = twist(g)[i];
            const T angle =
                i + 1 == c.end ? x : (row.before * x_before + row.after * x + row.right) * row.inverse();
            const int k = cell(g, i);
            Frame& frame = frame_[k];
            frame = Frame{turned_about_itself(Q(frame), angle / (T(1) + lag_of_turn(i, k)))};
        }
    }

    // --- the system

    // Those that end at particle j of strand g.
    WETCURL_HD Element<T> element(int g, int j) const {
        const int k = cell(g, j);
        Window<T> w;
        for (int l = 0; l < 3; ++l)
            w.x[l] = at_[k - 2 + l], w.v[l] = rate_[k - 2 + l], w.mass[l] = of(m_.mass, k - 2 + l);
        w.rest_length[1] = of(m_.rest_length, k - 1);
        if (set_.has(present::fibre)) {
            w.stretch_spring[1] = of(m_.stretch_spring, k - 1), w.bend_spring[1] = of(m_.bend_spring, k - 1);
            if (has<Twist>(set_)) w.twist_spring[1] = of(m_.twist_spring, k - 1);
        }
        if (has<Bend>(set_))
            w.frame[0] = frame_[k - 2], w.frame[1] = frame_[k - 1], w.target[1] = of(m_.target, k - 1);
        if (has<Core>(set_)) w.core[1] = core_[k - 1];
        if (has<StrainLimit>(set_)) w.limit_edge[1] = limit_edge_[k - 1];
        if (has<CurlPush>(set_)) w.chord = at_[cell(g, m_.n - 1)] - at_[cell(g, 0)];
        w.saturation[2] = parts_.sees_water(set_) ? of(m_.saturation, k) : T(0);
        parts_.fill(set_, *motion_, place(k), w);
        return parts_.element(set_, root_of(g), scheme_, w);
    }
    // The rows of strands that are to be solved. Elements that share one take turns.
    WETCURL_HD void assemble() const {
        const int n = m_.n, jobs = system_.jobs();
        team_.share(count_, 4, [&](int g, int k) {
            if (is(solved, g)) system_.clear(g, k);
        });
        for (int begin = 0; begin < count_ * jobs; begin += team_.threads) {
            const int job = begin + team_.thread, g = int((float(job) + 0.5f) / float(jobs)),
                      j = system_.element_of(job - g * jobs);
            const bool mine = job < count_ * jobs && j < n && is(solved, g);
            Element<T> e;
            if (mine) e = element(g, j);
            for (int turn = 0; turn < 3; ++turn) {
                if (mine) system_.add(g, j, turn, e);
                team_.wait();
            }
        }
        for_each_particle(0, n, [&](int g, int i) {
            if (!is(solved, g)) return;
            V& r = system_.right(g, i);
            if (i < 2) {
                r = known(g, i);
                return;
            }
            const int k = cell(g, i);
            const Particle<T> p = particle(k);
            Sym3<T> diagonal = identity_times(T(0));
            r = parts_.own_row(set_, scheme_, place(k), p, system_.gathered(g, i), diagonal);
            if (i < 4) r -= system_.known_part(g, i, known(g, 0), known(g, 1));
            const T pushed = set_.has(present::contact) ? pushed_[k] : T(0);
            if (pushed > 0)
                add_hold(parts_.hold_of(*motion_, scheme_, p, pushed), scheme_.h, p.rate, diagonal, r);
            system_.add_diagonal(g, i, diagonal);
        });
    }

    const StrandMemory<T>& m_;
    const ChainConstants<T>& k_;
    const Set set_;
    const StrandParts<T> parts_;
    ThreadTeam<Barrier> team_;
    int count_;
    size_t first_;
    StrandFlags* flags_;
    const SubstepMotion<T>* motion_ = nullptr;  // of the substep, and its scheme
    Bdf2<T> scheme_{T(0), true};
    StrandSystem<T> system_;
    Frame* frame_;
    V *x_, *x_before_, *v_, *v_before_;
    V *at_, *rate_;            // positions and velocities at which forces are taken
    V* core_;                  // the core's force along each edge
    V* limit_edge_ = nullptr;  // edges at which the strain limit is taken
    T *pushed_, *gap_;         // gap: from surfaces where particles were first expected
    const Chunks chunks_;      // of a strand
};

}  // namespace wetcurl

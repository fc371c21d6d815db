// The implicit substep of a strand by one thread, where strands are many: all that runs along it is taken on
// the way. A sweep from the root carries frames along and takes what twists and the core's filter need; one
// from the tip ends these, assembles the system row by row and eliminates each row as soon as it is whole;
// one from the root substitutes. The formulas are those of solver/passes/chain_step.h, which is the
// reference; rows are eliminated from the tip, since the core's forces come from there.
#pragma once

#include "cuda/strand_parts.h"

namespace wetcurl {

// The numbers of a strand as lanes hold them: 32 strands side by side, particle after particle, of each all
// its numbers, so that a number of 32 strands is one line of memory. Here is which of a particle's numbers
// begin what; what the scene has not has no place.
struct LaneNumbers {
    static constexpr int lanes = 32;
    static constexpr unsigned nowhere = ~0u;
    unsigned at = 0, rate = 0, v = 0, v_before = 0, x = 0, x_before = 0, frame = 0, pushed = 0;
    unsigned mass = 0, rest_length = 0, target = 0, rest_core = 0, saturation = 0, rest_depth = 0, gap = 0,
             twist = 0, core = 0, limit_edge = 0;
    unsigned right = 0, coupling = 0;
    unsigned count = 0;  // of a particle; 0: strands are not held so

    LaneNumbers() = default;
    LaneNumbers(const ChainTerms& terms, bool contact) {
        auto take = [&](unsigned& first, unsigned numbers, bool needed) {
            first = needed ? count : nowhere;
            count += needed ? numbers : 0;
        };
        const bool bends = named<Bend>(terms), cores = named<Core>(terms);
        // Sweeps read what comes first together.
        take(at, 3, true), take(rate, 3, true), take(mass, 1, true), take(rest_length, 1, true);
        take(frame, 4, bends), take(target, 3, bends), take(twist, 2, named<Twist>(terms));
        take(core, 3, cores), take(rest_core, 1, cores), take(v, 3, true), take(v_before, 3, true);
        take(x, 3, true), take(x_before, 3, true), take(pushed, 1, contact), take(gap, 1, contact);
        take(rest_depth, 1, contact), take(saturation, 1, named<Adhesion>(terms) || named<Stiffness>(terms));
        take(limit_edge, 3, named<StrainLimit>(terms)), take(right, 3, true), take(coupling, 18, true);
    }
    // Of all strands.
    size_t total(int n, int strands) const {
        return size_t((strands + lanes - 1) / lanes) * lanes * size_t(n) * count;
    }
    WETCURL_HD size_t place(int n, int strand, int particle, unsigned number) const {
        return (size_t(strand / lanes) * size_t(n) + size_t(particle)) * count * lanes + number * lanes +
               size_t(strand % lanes);
    }

  private:
    template <class Term>
    static bool named(const ChainTerms& terms) {
        return std::get<Slot<Term>>(terms).has_value();
    }
};

// A buffer of the strands that lanes take along.
template <class T>
struct TakenAlong {
    const T* values;   // (strand, particle)
    T* changed;        // the same where substeps change them; else null
    unsigned first;    // which of a particle's numbers they become
    unsigned after;    // which it is after an even or `odd` number of substeps
    unsigned numbers;  // of a particle
};
// Calls f(TakenAlong) for each that there is, and a place for it.
template <class T, class F>
void for_each_taken_along(const StrandMemory<T>& m, const LaneNumbers& of, bool odd, F f) {
    auto state = [&](auto* values, unsigned first, unsigned after) {
        T* plain = reinterpret_cast<T*>(values);
        if (plain && first != LaneNumbers::nowhere)
            f(TakenAlong<T>{plain, plain, first, after, unsigned(sizeof *values / sizeof(T))});
    };
    auto constant = [&](const auto* values, unsigned first) {
        if (values && first != LaneNumbers::nowhere)
            f(TakenAlong<T>{reinterpret_cast<const T*>(values), nullptr, first, first,
                            unsigned(sizeof *values / sizeof(T))});
    };
    state(m.x, of.x, odd ? of.x_before : of.x), state(m.x_before, of.x_before, odd ? of.x : of.x_before);
    state(m.v, of.v, odd ? of.v_before : of.v), state(m.v_before, of.v_before, odd ? of.v : of.v_before);
    state(m.frame, of.frame, of.frame), state(m.pushed, of.pushed, of.pushed);
    constant(m.mass, of.mass), constant(m.rest_length, of.rest_length), constant(m.target, of.target);
    constant(m.rest_core, of.rest_core), constant(m.rest_depth, of.rest_depth);
    constant(m.saturation, of.saturation);
}

template <class T>
class LaneStep {
    using V = Vec3<T>;
    using Q = Quat<T>;
    using M = Mat3<T>;

  public:
    // Strand `strand`; `numbers`: of all.
    WETCURL_HD LaneStep(const StrandMemory<T>& m, const ChainConstants<T>& constants, const LaneNumbers& of,
                        T* numbers, int strand)
        : m_(m),
          k_(constants),
          parts_(m, constants),
          of_(of),
          numbers_(numbers + of.place(m.n, strand, 0, 0)),
          strand_(size_t(strand)),
          x_(of.x),
          x_before_(of.x_before),
          v_(of.v),
          v_before_(of.v_before) {}

    // One substep, `first` of a run (no history) or not. Returns how many edges were held at their strain
    // limit. The next one takes x and x_before, v and v_before the other way round.
    template <class Set>
    WETCURL_HD int step(const Set& set, const SubstepMotion<T>& motion, bool first) {
        const Bdf2<T> scheme(k_.dt, first, k_.share);
        touches_ = false;
        int looks = 1;
        for (;; ++looks) {
            sweep_out(set, motion, scheme, looks == 1);
            const bool far_off = solve(set, motion, scheme);
            if (!far_off || looks >= k_.looks) break;
            // Forces are taken anew where the solution has led the strand.
            for (int i = 0; i < m_.n; ++i) {
                const V d = vector(of_.right, i);
                put(of_.at, i, vector(of_.at, i) + scheme.h * d);
                put(of_.rate, i, vector(of_.rate, i) + d);
            }
        }
        const int limited = finish(set, motion, scheme, looks > 1);
        // What was written over the older state is the newer one.
        const unsigned x = x_, v = v_;
        x_ = x_before_, v_ = v_before_;
        x_before_ = x, v_before_ = v;
        return limited;
    }

  private:
    enum : unsigned { limit_moved = 1, hold_changed = 2, turned = 4 };  // seen in a solution
    // Particles that a sweep asks for before it comes to them.
    static constexpr int ahead_out = 4, ahead_in = 2, ahead_substitution = 8, ahead_finish = 4;

    // --- numbers of particle or edge i

    static constexpr int lanes = LaneNumbers::lanes;
    WETCURL_HD T* first(unsigned which, int i) const {
        return numbers_ + (unsigned(i) * of_.count + which) * unsigned(lanes);
    }
    WETCURL_HD T& number(unsigned which, int i) const { return *first(which, i); }
    WETCURL_HD static V vector_at(const T* p) { return {p[0], p[lanes], p[2 * lanes]}; }
    WETCURL_HD static void put_at(T* p, const V& a) { p[0] = a.x, p[lanes] = a.y, p[2 * lanes] = a.z; }
    WETCURL_HD V vector(unsigned which, int i) const { return vector_at(first(which, i)); }
    WETCURL_HD void put(unsigned which, int i, const V& a) const { put_at(first(which, i), a); }
    WETCURL_HD Q frame(int i) const {
        const T* p = first(of_.frame, i);
        return {p[0], p[lanes], p[2 * lanes], p[3 * lanes]};
    }
    WETCURL_HD void put_frame(int i, const Q& q) const {
        T* p = first(of_.frame, i);
        p[0] = q.w, p[lanes] = q.x, p[2 * lanes] = q.y, p[3 * lanes] = q.z;
    }
    // What couples row i to the one (which = 0) or two (1) before it, in the substitution.
    WETCURL_HD M coupling(int i, int which) const {
        const T* p = first(of_.coupling, i) + 9 * which * lanes;
        return {vector_at(p), vector_at(p + 3 * lanes), vector_at(p + 6 * lanes)};
    }
    WETCURL_HD void put_coupling(int i, int which, const M& a) const {
        T* p = first(of_.coupling, i) + 9 * which * lanes;
        put_at(p, a.r0), put_at(p + 3 * lanes, a.r1), put_at(p + 6 * lanes, a.r2);
    }
    // 32 numbers of particle i, from one on, are soon to be read: a line for each lane to ask for. What is
    // read next waits in registers already: all loads of a sweep's turn come before its first store.
    WETCURL_HD void expect_to_read([[maybe_unused]] unsigned which, [[maybe_unused]] int i) const {
#ifdef __CUDA_ARCH__
        if (i < 0 || i >= m_.n) return;
        const T* line = first(which, i) + (int(strand_) % lanes) * (lanes - 1);
        asm volatile("prefetch.global.L2 [%0];" ::"l"(line));
#endif
    }
    WETCURL_HD size_t place(int i) const { return strand_ * size_t(m_.n) + size_t(i); }
    WETCURL_HD T rest_depth(int i) const { return m_.rest_depth ? number(of_.rest_depth, i) : T(0); }
    WETCURL_HD Particle<T> particle(int i) const {
        return {vector(x_, i),     vector(x_before_, i), vector(v_, i),       vector(v_before_, i),
                vector(of_.at, i), vector(of_.rate, i),  number(of_.mass, i), rest_depth(i)};
    }

    // --- from the root: where forces are taken, and what they need of the whole strand

    struct Motion {
        V x, rate;
    };
    // What the way over edge i to particle i + 1 asks for.
    struct OnTheWayOut {
        V x, x_before, v, target;  // not in the first look: x, v are where forces are taken
        Q frame;
        T rest_core, rest_length, mass, pushed, rest_depth;
    };
    template <class Set>
    WETCURL_HD OnTheWayOut on_the_way_out(const Set& set, bool first, int i) const {
        OnTheWayOut o{};
        o.x = vector(first ? x_ : of_.at, i + 1), o.v = vector(first ? v_ : of_.rate, i + 1);
        o.mass = number(of_.mass, i + 1);
        if (first) o.x_before = vector(x_before_, i + 1);
        if (first && set.has(present::contact))
            o.pushed = number(of_.pushed, i + 1), o.rest_depth = rest_depth(i + 1);
        if (i < 0) return o;
        if (has<Core>(set)) o.rest_core = number(of_.rest_core, i);
        if (has<Bend>(set)) o.frame = frame(i), o.target = vector(of_.target, i);
        if (has<Twist>(set)) o.rest_length = number(of_.rest_length, i);
        return o;
    }
    // Where particle i is expected.
    template <class Set>
    WETCURL_HD Motion expect(const Set& set, const SubstepMotion<T>& motion, const Bdf2<T>& scheme, int i,
                             const OnTheWayOut& o) {
        const Motion at{scheme.predicted(o.x, o.x_before, o.v), scheme.expected_velocity(o.v)};
        put(of_.at, i, at.x), put(of_.rate, i, at.rate);
        if (!set.has(present::contact) || i < 2) return at;
        Particle<T> p{};
        p.v = o.v, p.mass = o.mass, p.rest_depth = o.rest_depth;
        T momentum = o.pushed;
        const Hold<T> hold = parts_.expected_hold(motion, scheme, p, at.x, momentum);
        number(of_.gap, i) = hold.gap;
        if (!(momentum > 0)) return at;
        number(of_.pushed, i) = hold.weight > 0 ? momentum : -momentum;
        touches_ = true;
        return at;
    }
    template <class Set>
    WETCURL_HD void sweep_out(const Set& set, const SubstepMotion<T>& motion, const Bdf2<T>& scheme,
                              bool first) {
        auto place = [&](int i, const OnTheWayOut& o) {
            return first ? expect(set, motion, scheme, i, o) : Motion{o.x, o.v};
        };
        for (int i = 0; i < ahead_out; ++i) expect_to_read(0, i);
        OnTheWayOut here = on_the_way_out(set, first, -1), ahead = on_the_way_out(set, first, 0);
        Motion now = place(0, here);
        const T beta = has<Core>(set) ? T(get<Core>(k_.rules.terms).beta) : T(1);
        EdgeFilter<T> edges(beta, V{}), rates(beta, V{});
        TwistElimination<T> row;
        Q before{};
        T stiffness(0), torque(0), mass(0);  // of the joint before edge i, and of the particle there
        for (int i = 0; i + 1 < m_.n; ++i) {
            const T mass_here = here.mass;
            here = ahead;
            if (i + 2 < m_.n) ahead = on_the_way_out(set, first, i + 1);
            expect_to_read(0, i + ahead_out);
            const Motion next = place(i + 1, here);
            const V e = next.x - now.x, rate = next.rate - now.rate;
            now = next;
            if (has<StrainLimit>(set)) put(of_.limit_edge, i, e);
            if (has<Core>(set)) {
                if (i == 0) edges = EdgeFilter<T>(beta, e), rates = EdgeFilter<T>(beta, rate);
                put(of_.core, i, get<Core>(k_.rules.terms).pull(edges(e), rates(rate), here.rest_core));
            }
            if (!has<Bend>(set)) continue;
            const Q carried = transported(first ? motion.root_turn * here.frame : here.frame, e);
            put_frame(i, carried);
            if (!has<Twist>(set)) continue;
            if (i > 0) {
                const Twist& springs = get<Twist>(k_.rules.terms);
                const T k = springs.stiffness(here.rest_length),
                        own = k * Twist::HalfAngle<T>(before, carried).sine_of_whole();
                if (i > 1) {
                    T slope, bound;
                    bend_by_turn(get<Bend>(k_.rules.terms), before, here.target, e, slope, bound);
                    row.next(i == 2, stiffness, torque, k, own, slope, bound, springs.lag(scheme.h, mass));
                    put_twist(i - 1, row);
                }
                stiffness = k, torque = own, mass = mass_here;
            }
            before = carried;
        }
        if (!has<Twist>(set) || m_.n < 3) return;
        row.next(m_.n == 3, stiffness, torque, T(0), T(0), T(0), T(0),
                 get<Twist>(k_.rules.terms).lag(scheme.h, mass));
        put_twist(m_.n - 2, row);
    }
    WETCURL_HD void put_twist(int i, const TwistElimination<T>& row) const {
        T* p = first(of_.twist, i);
        p[0] = row.pivot, p[lanes] = row.right;
    }

    // --- from the tip: forces, rows of the matrix, elimination

    // What row j asks for: of particle and edge j - 2, edge j - 1, particle j.
    struct OnTheWayIn {
        V at, rate, core, target, limit_edge, v, v_before;
        Q frame;
        T mass, rest_length, twist_pivot, twist_right, pushed, saturation, rest_depth;
    };
    template <class Set>
    WETCURL_HD OnTheWayIn on_the_way_in(const Set& set, bool ended, int j) const {
        OnTheWayIn o{};
        edge_on_the_way_in(set, ended, j - 2, o);
        o.at = vector(of_.at, j - 2), o.rate = vector(of_.rate, j - 2), o.mass = number(of_.mass, j - 2);
        if (has<Bend>(set)) o.target = vector(of_.target, j - 1);
        if (has<StrainLimit>(set)) o.limit_edge = vector(of_.limit_edge, j - 1);
        o.v = vector(v_, j), o.v_before = vector(v_before_, j);
        if (set.has(present::contact)) o.pushed = number(of_.pushed, j), o.rest_depth = rest_depth(j);
        if (parts_.sees_water(set)) o.saturation = number(of_.saturation, j);
        return o;
    }
    template <class Set>
    WETCURL_HD void edge_on_the_way_in(const Set& set, bool ended, int i, OnTheWayIn& o) const {
        o.rest_length = number(of_.rest_length, i);
        if (has<Bend>(set)) o.frame = frame(i);
        if (has<Core>(set)) o.core = vector(of_.core, i);
        if (!has<Twist>(set) || ended || i < 1) return;
        const T* p = first(of_.twist, i);
        o.twist_pivot = p[0], o.twist_right = p[lanes];
    }
    // Ends what the sweep from the root began, edge by edge from the tip: twists and the core's forces.
    struct Ends {
        EdgeFilterAdjoint<T> adjoint;
        T turn = 0, after = 0;
        WETCURL_HD explicit Ends(T beta) : adjoint(beta) {}
    };
    template <class Set>
    WETCURL_HD void end(const Set& set, Ends& ends, int i, OnTheWayIn& o) const {
        if (i < 1) return;
        if (has<Twist>(set)) {
            ends.turn = (o.twist_right + ends.after * ends.turn) / o.twist_pivot;
            ends.after = get<Twist>(k_.rules.terms).stiffness(o.rest_length);
            put_frame(i, o.frame = turned_about_itself(o.frame, ends.turn));
        }
        if (has<Core>(set) && !get<Core>(k_.rules.terms).printed)
            put(of_.core, i, o.core = ends.adjoint(o.core));
    }
    // `ended`: an earlier one of these has ended twists and cores.
    template <class Set>
    WETCURL_HD void sweep_in(const Set& set, const SubstepMotion<T>& motion, const Bdf2<T>& scheme,
                             const V (&known)[2], bool ended) const {
        const int n = m_.n;
        const V zero{T(0), T(0), T(0)};
        const M none{zero, zero, zero};
        // Of row j and the one before it: what elements and rows beyond have left there.
        Sym3<T> diagonal = identity_times(T(0)), diagonal_before = diagonal;
        V right = zero, right_before = zero;
        M u1 = none;  // what couples row j to the one before
        Ends ends(has<Core>(set) ? T(get<Core>(k_.rules.terms).beta) : T(1));
        Window<T> w;
        if (has<CurlPush>(set)) w.chord = vector(of_.at, n - 1) - vector(of_.at, 0);
        for (int l = 1; l < 3; ++l)
            w.x[l] = vector(of_.at, n - 3 + l), w.v[l] = vector(of_.rate, n - 3 + l),
            w.mass[l] = number(of_.mass, n - 3 + l);
        OnTheWayIn here{};
        edge_on_the_way_in(set, ended, n - 2, here);
        if (!ended) end(set, ends, n - 2, here);
        w.frame[1] = here.frame, w.core[1] = here.core, w.rest_length[1] = here.rest_length;
        OnTheWayIn ahead{};
        if (n > 2) ahead = on_the_way_in(set, ended, n - 1);
        for (int j = n - 1; j >= 2; --j) {
            here = ahead;
            if (j > 2) ahead = on_the_way_in(set, ended, j - 1);
            expect_to_read(0, j - 2 - ahead_in);
            w.x[0] = here.at, w.v[0] = here.rate, w.mass[0] = here.mass;
            if (!ended) end(set, ends, j - 2, here);
            w.frame[0] = here.frame, w.target[1] = here.target, w.limit_edge[1] = here.limit_edge;
            w.saturation[2] = here.saturation;
            parts_.fill(set, motion, place(j), w);
            const Element<T> e = parts_.element(set, motion, scheme, w);
            // Row j is whole.
            diagonal += e.diagonal[2];
            u1 += transposed(e.upper1[1]);
            M u2 = transposed(e.upper2[0]);
            Particle<T> p{{}, {}, here.v, here.v_before, w.x[2], w.v[2], w.mass[2], here.rest_depth};
            const T pushed = set.has(present::contact) ? here.pushed : T(0);
            if (pushed > 0 || set.has(present::given)) p.x = vector(x_, j), p.x_before = vector(x_before_, j);
            V r = right + parts_.own_row(set, scheme, place(j), p, e.force[2], diagonal);
            if (j == 2) r -= u1 * known[1] + u2 * known[0];
            if (j == 3) r -= u2 * known[1];
            if (pushed > 0)
                add_hold(parts_.hold_of(motion, scheme, p, pushed), scheme.h, p.rate, diagonal, r);
            Sym3<T> next = diagonal_before;
            next += e.diagonal[1];
            V next_right = right_before + scheme.h * e.force[1];
            M next_u1 = transposed(e.upper1[0]);
            Sym3<T> after = e.diagonal[0];
            V after_right = scheme.h * e.force[0];
            if (j == 2) u1 = none;
            if (j <= 3) u2 = none;
            eliminate(Row<T>{diagonal, &u1, &u2, r}, &next, &next_right, &next_u1, &after, &after_right);
            put_coupling(j, 0, u1), put_coupling(j, 1, u2), put(of_.right, j, r);
            diagonal = next, diagonal_before = after, right = next_right, right_before = after_right;
            u1 = next_u1;
            for (int l = 2; l > 0; --l) w.x[l] = w.x[l - 1], w.v[l] = w.v[l - 1], w.mass[l] = w.mass[l - 1];
            w.frame[1] = here.frame, w.core[1] = here.core, w.rest_length[1] = here.rest_length;
        }
    }

    // --- from the root: the solution

    // What is to be seen in it: `limits`, `holds` where it may still be sought again.
    template <class Set>
    WETCURL_HD unsigned substitute(const Set&, const SubstepMotion<T>& motion, const Bdf2<T>& scheme,
                                   const V (&known)[2], bool limits, bool holds) const {
        unsigned seen = 0;
        V d2 = known[0], d1 = known[1];
        put(of_.right, 0, d2), put(of_.right, 1, d1);
        const T far = far_turn(k_.turn, T(touches_));
        struct Asked {
            V right;
            M u1, u2;
            T rest, pushed;  // rest: length of the edge before
        };
        auto ask = [&](int j) {
            return Asked{vector(of_.right, j), coupling(j, 0), coupling(j, 1), number(of_.rest_length, j - 1),
                         holds ? number(of_.pushed, j) : T(0)};
        };
        for (int j = 2; j < 2 + ahead_substitution; ++j) expect_to_read(of_.right, j);
        Asked here{}, ahead{};
        if (m_.n > 2) ahead = ask(2);
        for (int j = 2; j < m_.n; ++j) {
            here = ahead;
            if (j + 1 < m_.n) ahead = ask(j + 1);
            expect_to_read(of_.right, j + ahead_substitution);
            const V d = here.right - here.u1 * d1 - here.u2 * d2;
            put(of_.right, j, d);
            const V way = scheme.h * (d - d1);
            d2 = d1, d1 = d;
            const T rest = here.rest;
            if (turned_far<T>(way, rest, far) > 0) seen |= turned;
            if (limits && get<StrainLimit>(k_.rules.terms)
                                  .unsettled(edge_at(j - 1) + way, vector(of_.limit_edge, j - 1), rest) > 0)
                seen |= limit_moved;
            if (!touches_ || here.pushed == 0) continue;
            Hold<T> hold = parts_.hold_of(motion, scheme, particle(j), here.pushed);
            if (weigh_again(scheme.h, d, hold) > 0)
                number(of_.pushed, j) = -here.pushed, seen |= hold_changed;
        }
        return seen;
    }
    WETCURL_HD V edge_at(int i) const { return vector(of_.at, i + 1) - vector(of_.at, i); }

    // Until the edges at their strain limit and the particles that surfaces hold are found. Whether an edge
    // turns far.
    template <class Set>
    WETCURL_HD bool solve(const Set& set, const SubstepMotion<T>& motion, const Bdf2<T>& scheme) const {
        V known[2];
        for (int i = 0; i < 2; ++i)
            known[i] = (T(1) / scheme.h) * (parts_.placed_root(motion, strand_, i) - vector(of_.at, i));
        for (int solves = 1;; ++solves) {
            const bool limits = has<StrainLimit>(set) && solves < StrainLimit::most_solves,
                       holds = set.has(present::contact) && solves < most_contact_solves;
            sweep_in(set, motion, scheme, known, solves > 1);
            const unsigned seen = substitute(set, motion, scheme, known, limits, holds);
            if (has<StrainLimit>(set) && seen & limit_moved)
                for (int i = 1; i + 1 < m_.n; ++i)
                    put(of_.limit_edge, i,
                        edge_at(i) + scheme.h * (vector(of_.right, i + 1) - vector(of_.right, i)));
            if (!(seen & (limit_moved | hold_changed))) return seen & turned;
        }
    }

    // --- where the step ends

    template <class Set>
    WETCURL_HD int finish(const Set& set, const SubstepMotion<T>& motion, const Bdf2<T>& scheme,
                          bool looked_anew) const {
        int limited = 0;
        V before{};
        struct Asked {
            V right, at, rate;
            Q frame;  // of the edge before
            T pushed, gap;
        };
        auto ask = [&](int i) {
            Asked a{vector(of_.right, i), vector(of_.at, i), vector(of_.rate, i), {}, T(0), T(0)};
            if (has<Bend>(set) && i > 0) a.frame = frame(i - 1);
            if (set.has(present::contact) && i > 1)
                a.pushed = number(of_.pushed, i), a.gap = number(of_.gap, i);
            return a;
        };
        Asked here{}, ahead = ask(0);
        for (int i = 0; i < m_.n; ++i) {
            here = ahead;
            if (i + 1 < m_.n) ahead = ask(i + 1);
            expect_to_read(0, i + ahead_finish), expect_to_read(of_.right, i + ahead_finish);
            const V d = here.right, expected = here.at;
            V x = i < 2 ? parts_.placed_root(motion, strand_, i) : expected + scheme.h * d, v = here.rate + d;
            if (has<StrainLimit>(set) && i >= 2)
                limited += get<StrainLimit>(k_.rules.terms)
                               .holds(vector(of_.limit_edge, i - 1), number(of_.rest_length, i - 1));
            if (has<Adhesion>(set)) parts_.touch(set, motion, place(i), expected);
            if (set.has(present::contact) && i >= 2 &&
                parts_.may_meet(scheme, looked_anew, here.pushed, here.gap, d)) {
                Particle<T> p = particle(i);
                parts_.meet(motion, scheme, d, p, here.pushed, x, v);
                number(of_.pushed, i) = here.pushed, put(x_, i, p.x), put(v_, i, p.v);
            }
            put(x_before_, i, x), put(v_before_, i, v);
            if (has<Bend>(set) && i > 0) put_frame(i - 1, transported(here.frame, x - before));
            before = x;
        }
        return limited;
    }

    const StrandMemory<T>& m_;
    const ChainConstants<T>& k_;
    const StrandParts<T> parts_;
    const LaneNumbers& of_;
    T* const numbers_;
    const size_t strand_;
    unsigned x_, x_before_, v_, v_before_;
    bool touches_ = false;  // surfaces push it
};

}  // namespace wetcurl

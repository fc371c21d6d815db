// The implicit substep of a block of strands by a team, a lane a strand. What is independent along a strand
// is shared out among the members by particle: frames, forces, rows of the matrix, contact. What runs along
// it goes to one of them: twists, the core's filter, elimination and substitution. Terms, formulas and order
// are those of solver/passes/chain_step.h, which is the reference.
#pragma once

#include <utility>

#include "cuda/present.h"
#include "cuda/strand_memory.h"
#include "cuda/strand_system.h"
#include "cuda/team.h"

namespace wetcurl {

template <class T>
class StrandStep {
    using V = Vec3<T>;
    using Q = Quat<T>;
    using M = Mat3<T>;

  public:
    // `middle`: StrandSystem<T>::middle_size rows of lanes that the team shares.
    WETCURL_HD StrandStep(const StrandMemory<T>& m, const ChainConstants<T>& constants, int block,
                          const Team& team, T* middle)
        : m_(m), k_(constants), block_(size_t(block)), team_(team) {
        x_ = of<V>(m.x), x_before_ = of<V>(m.x_before), v_ = of<V>(m.v), v_before_ = of<V>(m.v_before);
        system_ = {m.n, block_ * size_t(m.n), m.rows + team.lane, middle + team.lane, of<V>(m.solution)};
    }

    // One substep, `first` of a run (no history) or not. Returns how many edges this member saw held at their
    // strain limit.
    template <class Set>
    WETCURL_HD int step(const Set& set, const SubstepMotion<T>& motion, bool first) {
        const Bdf2<T> scheme(k_.dt, first, k_.share);
        looks_ = 1;
        const bool contacts = expect(set, motion, scheme);
        bool active = true;
        do {
            look(set, motion, scheme, active);
            const bool far = solve(set, motion, scheme, contacts, active);
            active = active && far && looks_ < k_.looks;
            if (!team_.any(active)) break;
            // Forces are taken anew where the solution has led those strands.
            team_.share(active, 0, m_.n, [&](int i) {
                const V d = of<V>(m_.solution)[i];
                of<V>(m_.at).set(i, of<V>(m_.at)[i] + scheme.h * d);
                of<V>(m_.change).set(i, change_at(i) + d);
            });
            looks_ += active;
        } while (true);
        const int limited = finish(set, motion, scheme);
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
                                                    team_.lane};
    }
    // Of velocities until forces were taken anew.
    WETCURL_HD V change_at(int i) const { return looks_ > 1 ? V(of<V>(m_.change)[i]) : V{T(0), T(0), T(0)}; }
    // The velocity at which forces are taken.
    WETCURL_HD V look_velocity(const Bdf2<T>& scheme, int i) const {
        return scheme.expected_velocity(v_[i]) + change_at(i);
    }
    WETCURL_HD V edge_at(int i) const {
        const auto at = of<V>(m_.at);
        return at[i + 1] - at[i];
    }
    WETCURL_HD V placed_root(const SubstepMotion<T>& motion, int i) const {
        const LaneArray<V, const T> root{m_.root + block_ * 2 * 3 * Lanes<T>::lanes + team_.lane};
        return rotate(motion.head_rotation, root[i]) + motion.head_translation;
    }

    // --- where particles are expected, and which surfaces hold them

    // The contact of particle i, which a solid has pushed or is to push: held while `pushed` is above 0;
    // below it the surface may hold it again.
    WETCURL_HD Hold<T> hold_of(int i, const SubstepMotion<T>& motion, const Bdf2<T>& scheme, T pushed) const {
        T momentum = pushed < 0 ? -pushed : pushed;
        Hold<T> hold = expected_contact(motion, m_.rest_depth ? T(of<const T>(m_.rest_depth)[i]) : T(0),
                                        hold_stiffness(k_.spring_sum, scheme.h, T(of<const T>(m_.mass)[i])),
                                        scheme.predicted(x_[i], x_before_[i], v_[i]), V(v_[i]), momentum);
        hold.gap += scheme.h * dot(change_at(i), hold.normal);
        hold.weight = pushed > 0 ? hold.stiff : T(0);
        return hold;
    }
    // Returns whether surfaces push the strand.
    template <class Set>
    WETCURL_HD bool expect(const Set& set, const SubstepMotion<T>& motion, const Bdf2<T>& scheme) {
        struct Loaded {
            V x, x_before, v;
            T pushed, mass, rest_depth;
        };
        const bool touches = set.has(present::contact);
        bool contact = false;
        team_.share(
            true, 0, m_.n,
            [&](int i) {
                Loaded in{x_[i], x_before_[i], v_[i], T(0), T(0), T(0)};
                if (!touches) return in;
                in.pushed = of<T>(m_.pushed)[i], in.mass = of<const T>(m_.mass)[i];
                if (m_.rest_depth) in.rest_depth = of<const T>(m_.rest_depth)[i];
                return in;
            },
            [&](int i, const Loaded& in) {
                const V x = scheme.predicted(in.x, in.x_before, in.v);
                of<V>(m_.at).set(i, x);
                if (!touches || i < 2) return;
                T momentum = in.pushed;
                const Hold<T> hold =
                    expected_contact(motion, in.rest_depth, hold_stiffness(k_.spring_sum, scheme.h, in.mass),
                                     x, in.v, momentum);
                of<T>(m_.gap).set(i, hold.gap);
                if (!(momentum > 0)) return;
                contact = true;
                of<T>(m_.pushed).set(i, hold.weight > 0 ? momentum : -momentum);
            });
        return team_.together(contact);
    }

    // --- what forces need of the whole strand

    struct LoadedFrame {
        Q frame;
        V e;
    };

    template <class Set>
    WETCURL_HD void look(const Set& set, const SubstepMotion<T>& motion, const Bdf2<T>& scheme, bool active) {
        const int edges = m_.n - 1;
        const auto ahead = of<Q>(m_.ahead);
        if (has<StrainLimit>(set))
            team_.share(active, 1, edges, [&](int i) { of<V>(m_.limit_edge).set(i, edge_at(i)); });
        if (has<Bend>(set))
            team_.share(
                active, 0, edges,
                [&](int i) {
                    return LoadedFrame{looks_ == 1 ? Q(of<Q>(m_.frame)[i]) : Q(ahead[i]), edge_at(i)};
                },
                [&](int i, const LoadedFrame& in) {
                    ahead.set(i, transported(looks_ == 1 ? motion.root_turn * in.frame : in.frame, in.e));
                });
        if (has<Twist>(set)) team_.share(active, 1, edges, [&](int i) { meet_at_joint(scheme, i); });
        // What runs along the strand, a job each.
        team_.share(active, 0, 7, [&](int job) {
            if (job == 6 && has<Twist>(set)) turn_edges();
            if (job < 6 && has<Core>(set)) smooth_along(job > 2, job % 3);
        });
        if (has<Core>(set)) {
            const Core& core = get<Core>(k_.terms);
            const auto pull = of<V>(m_.core), rate = of<V>(m_.solution);
            const auto rest = of<const T>(m_.rest_core);
            team_.share(active, 0, edges, [&](int i) { pull.set(i, core.pull(pull[i], rate[i], rest[i])); });
            if (!core.printed) team_.share(active, 0, 3, [&](int axis) { pull_along(axis); });
        }
        if (has<Twist>(set))
            team_.share(active, 1, edges,
                        [&](int i) { ahead.set(i, turned_about_itself(ahead[i], of<V>(m_.twist)[i].x)); });
    }
    // The row of edge i in the system of the turns of edges about themselves: its coupling to the edge
    // before, right side, diagonal.
    WETCURL_HD void meet_at_joint(const Bdf2<T>& scheme, int i) {
        const Twist& twist = get<Twist>(k_.terms);
        const auto ahead = of<Q>(m_.ahead);
        const auto rest_length = of<const T>(m_.rest_length);
        const Q frame = ahead[i];
        const T k = twist.stiffness(rest_length[i]);
        const T torque = k * Twist::HalfAngle<T>(ahead[i - 1], frame).sine_of_whole();
        T k_next(0), torque_next(0), slope(0), bound(0);
        if (i + 2 < m_.n) {
            k_next = twist.stiffness(rest_length[i + 1]);
            torque_next = k_next * Twist::HalfAngle<T>(frame, ahead[i + 1]).sine_of_whole();
            bend_by_turn(get<Bend>(k_.terms), frame, of<const V>(m_.target)[i + 1], edge_at(i + 1), slope,
                         bound);
        }
        const T lag = twist.lag(scheme.h, of<const T>(m_.mass)[i]);
        of<V>(m_.twist).set(
            i, {i == 1 ? T(0) : k, torque_next - torque - slope, (T(1) + lag) * (bound + k + k_next)});
    }
    // A few elements are loaded at once: one after the other each would wait for memory.
    static constexpr int at_once = 8;
    // As relax_twist does.
    WETCURL_HD void turn_edges() {
        const int edges = m_.n - 1;
        const auto rows = of<V>(m_.twist);
        TwistElimination<T> row;
        V some[at_once]{};
        for (int begin = 1; begin < edges; begin += at_once) {
            for (int k = 0; k < at_once; ++k)
                if (begin + k < edges) some[k] = rows[begin + k];
            for (int k = 0; k < at_once; ++k) {
                if (begin + k >= edges) continue;
                row.next(some[k].x, some[k].y, some[k].z);
                rows.set(begin + k, {some[k].x, row.right, T(1) / row.pivot});
            }
        }
        T turn(0), after(0);
        for (int end = edges; end > 1; end -= at_once) {
            for (int k = 1; k <= at_once; ++k)
                if (end - k > 0) some[k - 1] = rows[end - k];
            for (int k = 1; k <= at_once; ++k) {
                if (end - k < 1) continue;
                turn = (some[k - 1].y + after * turn) * some[k - 1].z;
                after = some[k - 1].x;
                rows.set(end - k, {turn, T(0), T(0)});
            }
        }
    }
    // One coordinate of this lane's vectors.
    template <class P>
    WETCURL_HD P* axis_of(P* buffer, int axis) const {
        return buffer + (block_ * size_t(m_.n) * 3 + size_t(axis)) * Lanes<T>::lanes + team_.lane;
    }
    static constexpr int next_vector = 3 * Lanes<T>::lanes;
    // What Core::prepare smooths, one coordinate of edges or of their rates; `solution` holds the rates until
    // there is one.
    WETCURL_HD void smooth_along(bool of_rates, int axis) const {
        const T beta = T(get<Core>(k_.terms).beta), a = 2 * (1 - beta), b = (1 - beta) * (1 - beta),
                c = beta * beta;
        const T *at = axis_of(m_.at, axis), *v = v_.p + axis * Lanes<T>::lanes,
                *change = axis_of(m_.change, axis);
        T* to = axis_of(of_rates ? m_.solution : m_.core, axis);
        auto value = [&](int i) {
            if (!of_rates) return at[i * next_vector];
            return k_.share * v[i * next_vector] + (looks_ > 1 ? change[i * next_vector] : T(0));
        };
        const int edges = m_.n - 1;
        T before = value(0), d1 = value(1) - before, d2 = d1, some[at_once]{};
        for (int begin = 0; begin < edges; begin += at_once) {
            for (int k = 0; k < at_once; ++k)
                if (begin + k < edges) some[k] = value(begin + k + 1);
            for (int k = 0; k < at_once; ++k) {
                if (begin + k >= edges) continue;
                const T d = a * d1 - b * d2 + c * (some[k] - before);
                d2 = d1, d1 = d, before = some[k];
                to[(begin + k) * next_vector] = d;
            }
        }
    }
    // Its adjoint, but for the edge at the root, which moves nothing.
    WETCURL_HD void pull_along(int axis) const {
        const T beta = T(get<Core>(k_.terms).beta), a = 2 * (1 - beta), b = (1 - beta) * (1 - beta),
                c = beta * beta;
        T* pull = axis_of(m_.core, axis);
        T d1(0), d2(0), some[at_once]{};
        for (int end = m_.n - 1; end > 1; end -= at_once) {
            for (int k = 1; k <= at_once; ++k)
                if (end - k > 0) some[k - 1] = pull[(end - k) * next_vector];
            for (int k = 1; k <= at_once; ++k) {
                if (end - k < 1) continue;
                const T d = a * d1 - b * d2 + some[k - 1];
                d2 = d1, d1 = d;
                pull[(end - k) * next_vector] = c * d;
            }
        }
    }

    // --- the system

    template <class Set, size_t... place>
    WETCURL_HD void assemble_present(const Set& set, const ChainView<T>& view, const ChainSystem<T>& system,
                                     std::index_sequence<place...>) const {
        ((set.has(int(place)) ? std::get<place>(k_.terms)->assemble(view, system, 2, 3) : void()), ...);
    }

    // Rows begin .. end-1, by the elements that reach them, in a window of three particles that moves to the
    // tip.
    template <class Set>
    WETCURL_HD void assemble_rows(const Set& set, const SubstepMotion<T>& motion, const Bdf2<T>& scheme,
                                  int begin, int end) const {
        const int n = m_.n;
        const V zero{T(0), T(0), T(0)};
        const Sym3<T> no_sym = identity_times(T(0));
        const M no_mat = to_mat3(no_sym);
        V x[3], v[3], force[3] = {zero, zero, zero};
        Sym3<T> diagonal[3] = {no_sym, no_sym, no_sym};
        M upper1[2] = {no_mat, no_mat}, upper2[1];
        V target[2], core[2], push[2], limit_edge[2], normal[3], surface_velocity[3];
        Q frame[2];
        T mass[3], rest_length[2], saturation[3], touching[3], phi[3];
        normal[2] = {T(0), T(1), T(0)}, surface_velocity[2] = zero;
        const auto at = of<V>(m_.at);
        const auto ahead = of<Q>(m_.ahead);
        const auto masses = of<const T>(m_.mass);

        ChainView<T> view{};
        view.n = 3;
        view.x = x, view.v = v, view.mass = mass, view.rest_length = rest_length;
        view.limit_edge = limit_edge;
        view.target = target, view.frame = frame, view.core_pull = core, view.push = push;
        view.saturation = saturation, view.touching = touching, view.phi = phi, view.normal = normal;
        view.surface_velocity = surface_velocity;
        view.turn = motion.turn, view.turn_center = motion.turn_center, view.drift = motion.drift;
        if (has<CurlPush>(set)) view.chord = at[n - 1] - at[0];
        const ChainSystem<T> system{scheme.h, force, diagonal, upper1, upper2};

        const int start = begin < 2 ? 2 : begin;
        for (int k = 1; k < 3; ++k) {
            const int i = start - 3 + k;
            x[k] = at[i], v[k] = look_velocity(scheme, i), mass[k] = masses[i];
        }
        if (has<Bend>(set)) frame[1] = ahead[start - 2];
        for (int j = start; j < end + 2; ++j) {
            for (int k = 0; k < 2; ++k) {
                x[k] = x[k + 1], v[k] = v[k + 1], mass[k] = mass[k + 1];
                force[k] = force[k + 1], diagonal[k] = diagonal[k + 1];
            }
            force[2] = zero, diagonal[2] = no_sym;
            upper1[0] = upper1[1], upper1[1] = no_mat, upper2[0] = no_mat;
            if (j < n) {
                x[2] = at[j], v[2] = look_velocity(scheme, j), mass[2] = masses[j];
                rest_length[1] = of<const T>(m_.rest_length)[j - 1];
                if (has<Bend>(set)) {
                    frame[0] = frame[1], frame[1] = ahead[j - 1];
                    target[1] = of<const V>(m_.target)[j - 1];
                }
                if (has<Core>(set)) core[1] = of<V>(m_.core)[j - 1];
                if (has<CurlPush>(set)) push[1] = of<const V>(m_.push)[j - 1];
                if (has<StrainLimit>(set)) limit_edge[1] = of<V>(m_.limit_edge)[j - 1];
                if ((has<Adhesion>(set) || has<Stiffness>(set)) && m_.saturation)
                    saturation[2] = of<const T>(m_.saturation)[j];
                else
                    saturation[2] = T(0);
                if (has<Adhesion>(set)) {
                    touching[2] = of<T>(m_.touching)[j];
                    sample_nearest(motion, x[2], phi[2], normal[2], surface_velocity[2]);
                }
                assemble_present(set, view, system,
                                 std::make_index_sequence<std::tuple_size_v<ChainTerms>>());
            }
            const int i = j - 2;
            if (i < begin || i >= end) continue;
            SystemRow<T> row{diagonal[0], zero, upper1[0], upper2[0]};
            if (i >= 2) {
                row.r =
                    scheme.right_side(mass[0], v_[i], v_before_[i], v[0], force[0] + mass[0] * k_.gravity);
                row.diagonal += identity_times(mass[0]);
                const T pushed = set.has(present::contact) ? of<T>(m_.pushed)[i] : T(0);
                if (pushed > 0)
                    add_hold(hold_of(i, motion, scheme, pushed), scheme.h, v[0], row.diagonal, row.r);
            }
            system_.put(set, i, row);
        }
    }

    // Solves until the edges at their strain limit and the particles that surfaces hold are found. Returns
    // whether an edge turned far.
    template <class Set>
    WETCURL_HD bool solve(const Set& set, const SubstepMotion<T>& motion, const Bdf2<T>& scheme,
                          bool contacts, bool active) {
        enum : unsigned { limit_moved = 1, hold_changed = 2, turned = 4 };
        const int n = m_.n, part = (n + team_.members - 1) / team_.members, begin = part * team_.member,
                  end = begin + part < n ? begin + part : n;
        const auto solution = of<V>(m_.solution), edge_limited = of<V>(m_.limit_edge);
        const auto pushed = of<T>(m_.pushed);
        const auto rest_length = of<const T>(m_.rest_length);
        const T far = far_turn(k_.turn, T(contacts));
        auto way_of = [&](int edge) { return scheme.h * (solution[edge + 1] - solution[edge]); };
        bool again = active, far_off = false;
        for (int solves = 1;; ++solves) {
            if (again && begin < end) assemble_rows(set, motion, scheme, begin, end);
            team_.wait();
            system_.solve(set, team_, again, [&](int i) {
                return (T(1) / scheme.h) * (placed_root(motion, i) - of<V>(m_.at)[i]);
            });
            team_.wait();
            const bool limits = has<StrainLimit>(set) && solves < StrainLimit::most_solves,
                       holds = set.has(present::contact) && contacts && solves < most_contact_solves;
            unsigned seen = 0;
            for (int i = 2 + team_.member; again && i < n; i += team_.members) {
                const V way = way_of(i - 1);
                const T rest = rest_length[i - 1];
                if (turned_far<T>(way, rest, far) > 0) seen |= turned;
                if (limits &&
                    get<StrainLimit>(k_.terms).unsettled(edge_at(i - 1) + way, edge_limited[i - 1], rest) > 0)
                    seen |= limit_moved;
                if (!holds || pushed[i] == 0) continue;
                Hold<T> hold = hold_of(i, motion, scheme, pushed[i]);
                if (!(weigh_again(scheme.h, solution[i], hold) > 0)) continue;
                pushed.set(i, -pushed[i]);
                seen |= hold_changed;
            }
            const unsigned all = team_.together(seen);
            if (again) far_off = all & turned;
            again = again && (all & (limit_moved | hold_changed));
            if (!team_.any(again)) return far_off;
            if (has<StrainLimit>(set))
                team_.share(again && (all & limit_moved), 1, n - 1,
                            [&](int i) { edge_limited.set(i, edge_at(i) + way_of(i)); });
        }
    }

    // --- where the step ends

    template <class Set>
    WETCURL_HD int finish(const Set& set, const SubstepMotion<T>& motion, const Bdf2<T>& scheme) {
        const int n = m_.n;
        const auto at = of<V>(m_.at), solution = of<V>(m_.solution);
        int limited = 0;
        struct Loaded {
            V d, expected, v;
            T pushed, gap;
        };
        const bool touches = set.has(present::contact);
        team_.share(
            true, 0, n,
            [&](int i) {
                Loaded in{solution[i], at[i], v_[i], T(0), T(0)};
                if (touches && i >= 2) in.pushed = of<T>(m_.pushed)[i], in.gap = of<T>(m_.gap)[i];
                return in;
            },
            [&](int i, const Loaded& in) {
                const V d = in.d;
                V x = i < 2 ? placed_root(motion, i) : in.expected + scheme.h * d,
                  v = scheme.expected_velocity(in.v) + change_at(i) + d;
                if (has<StrainLimit>(set) && i >= 2)
                    limited += get<StrainLimit>(k_.terms).holds(of<V>(m_.limit_edge)[i - 1],
                                                                of<const T>(m_.rest_length)[i - 1]);
                if (has<Adhesion>(set)) {
                    T phi;
                    V normal, surface_velocity;
                    sample_nearest(motion, in.expected, phi, normal, surface_velocity);
                    const auto touching = of<T>(m_.touching);
                    touching.set(i, updated_touching(touching[i], phi, T(get<Adhesion>(k_.terms).h_a)));
                }
                // Where forces were taken once the gap tells which particles no surface can have met.
                const T way = scheme.h * norm(d);
                if (touches && i >= 2 && (in.pushed != 0 || looks_ > 1 || !(in.gap - way > T(1e-6)))) {
                    T pushed =
                        in.pushed > 0 ? pushed_by(hold_of(i, motion, scheme, in.pushed), scheme.h, d) : T(0);
                    V x_old = x_[i], v_old = in.v;
                    bool moved = false;
                    for (const auto& solid : motion)
                        moved |= resolve_contact(
                            solid, T(0),
                            solid.attached && m_.rest_depth ? T(of<const T>(m_.rest_depth)[i]) : T(0), k_.dt,
                            of<const T>(m_.mass)[i], pushed, x, x_old, v, v_old);
                    of<T>(m_.pushed).set(i, pushed);
                    if (moved) x_.set(i, x_old), v_.set(i, v_old);
                }
                x_before_.set(i, x), v_before_.set(i, v);
            });
        if (has<Bend>(set))
            team_.share(
                true, 0, n - 1,
                [&](int i) {
                    return LoadedFrame{of<Q>(m_.ahead)[i], x_before_[i + 1] - x_before_[i]};
                },
                [&](int i, const LoadedFrame& in) { of<Q>(m_.frame).set(i, transported(in.frame, in.e)); });
        return limited;
    }

    const StrandMemory<T>& m_;
    const ChainConstants<T>& k_;
    size_t block_;
    Team team_;
    StrandSystem<T> system_;
    int looks_ = 1;  // how often forces were taken in this step
    LaneArray<V, T> x_, x_before_, v_, v_before_;
};

}  // namespace wetcurl

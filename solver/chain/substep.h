// The bodies of the stages for a block of strands, a lane a strand: on the CPU, and with plain numbers in the
// reference kernel, one strand a thread. Their order is that of solver/chain/stages.h.
#pragma once

#include "solver/chain/chain_step.h"
#include "solver/chain/stages.h"
#include "solver/compared/iben2013.h"

namespace wetcurl {

// What is the same for all blocks and substeps.
template <class T>
struct SubstepRules {
    ChainTerms terms;
    std::optional<Iben2013> iben;
    bool implicit;
    T spring_sum;
    // What only the solution of a step leads into a solid is held as what was expected there. Seen: of stiff
    // strands each projection out of a solid bends a few edges, and they gain energy without end.
    bool holds_entering;
};

// In the place of a WorkMeter.
struct NoMeter {
    static constexpr int limiter = 0, solids = 0;
};

// One substep of a block. `view`: the block's data, its given adhesion and the head's motion among them.
// `surfaces`: SolidsInALoop or what offers the same. The new state is left in step.x_before and
// step.v_before. `meter`: null, or what counts the work.
template <class S, class Surfaces, class Meter>
class BlockStages {
    using T = Plain<S>;
    using V = Vec3<S>;

  public:
    int limited = 0;  // edges that were held at their strain limit, over all lanes

    WETCURL_HD BlockStages(const SubstepRules<T>& rules, BlockStep<S>& step, const ChainView<S>& view,
                           const NearestView<S>& near, const S* rest_depth, const Surfaces& surfaces,
                           ChainScratch<S>& scratch, Meter* meter)
        : rules_(rules),
          b_(step),
          view_(view),
          near_(near),
          rest_depth_(rest_depth),
          surfaces_(surfaces),
          s_(scratch),
          meter_(meter),
          scheme_(step.dt, step.first, step.share),
          n_(step.n),
          more_(names_more(rules.terms)),
          penta_(scratch.upper2 != nullptr) {
        view_.phi = near.phi, view_.normal = near.normal, view_.surface_velocity = near.velocity;
        view_.touching = near.touching, view_.frame = step.frame;
        view_.x = step.x, view_.v = step.v;
        view_.core_pull = scratch.core_pull, view_.limit_edge = scratch.limit_edge;
    }

    // Stages of a pass: one after the other.
    template <class First, class Second, class... More>
    WETCURL_HD void take(First first, Second second, More... more) {
        take(first), take(second), (take(more), ...);
    }
    WETCURL_HD bool take(stage::MoveLimit limit, stage::MoveHolds holds) {
        const bool moved = take(limit);
        return take(holds) || moved;
    }

    WETCURL_HD void take(stage::Predict) {
        view_.x = s_.predicted_x, view_.v = s_.expected_v;
        s_.system.h = scheme_.h, s_.system.ring = s_.ring - 1;
        for (int i = 1; i <= s_.ring; ++i) s_.system.forget_row(i);
        for (int i = 0; i < n_; ++i) {
            s_.predicted_x[i] = scheme_.predicted(b_.x[i], b_.x_before[i], b_.v[i]);
            s_.expected_v[i] = scheme_.expected_velocity(b_.v[i]);
        }
    }
    WETCURL_HD void take(stage::FindHolds) {
        if (!s_.hold) return;
        surfaces_.expect([&](auto contact) {
            for (int i = 2; i < n_; ++i) {
                const Hold<S> hold = contact_of(contact, i, view_.x[i], b_.pushed[i]);
                s_.gap[i] = hold.gap;
                if (any_positive(b_.pushed[i])) s_.hold[i] = hold;
            }
        });
    }

    WETCURL_HD void take(stage::CarryFrames at) {
        if (b_.frame)
            transport_frames(n_, b_.frame, at.begins ? b_.root_turn : Quat<S>::identity(), view_.x, b_.frame);
    }
    WETCURL_HD void take(stage::PlaceLimit) {
        for (int i = 0; limit() && i + 1 < n_; ++i)
            s_.limit_edge[i] =
                anew_ ? select(active_ > S(0), edge(view_, i), s_.limit_edge[i]) : edge(view_, i);
    }
    WETCURL_HD void take(stage::RelaxTwist) {
        if (!b_.frame) return;
        relax_frames(rules_.terms, view_, rules_.implicit ? scheme_.h : S(0), s_.twist, b_.frame);
        for (int i = 0; anew_ && i + 1 < n_; ++i)
            b_.frame[i] = select(active_ > S(0), b_.frame[i], s_.kept_frame[i]);
    }
    WETCURL_HD void take(stage::Prepare) {
        view_.chord = view_.x[n_ - 1] - view_.x[0];
        for_each_present(rules_.terms, more_, [&](const auto& term) {
            if constexpr (requires { term.prepare(view_); }) term.prepare(view_);
        });
    }
    WETCURL_HD void take(stage::SampleSurfaces) {
        if (adhesion() && !view_.given_adhesion) surfaces_.sample(n_, view_.x, near_);
    }

    // A few rows at a time, which stay in the nearest cache from their first element to their elimination.
    WETCURL_HD void take(stage::Solve) {
        V* r = s_.solution;
        for (int i = 0; i < 2; ++i) known_[i] = (S(1) / scheme_.h) * (b_.root[i] - view_.x[i]);
        Sym3<S> diagonal[3]{};  // of the last rows, which wait for their elimination
        int whole = 0;
        for (int begin = 0; begin < n_; begin += s_.at_once) {
            const int end = begin + s_.at_once < n_ ? begin + s_.at_once : n_;
            for_each_present(rules_.terms, more_,
                             [&](const auto& term) { term.assemble(view_, s_.system, begin, end); });
            for (const int elements_left_at = end < n_ ? end - 2 : n_; whole < elements_left_at; ++whole) {
                complete(whole, diagonal[2]);
                eliminate(whole - 2, diagonal);
                diagonal[0] = diagonal[1], diagonal[1] = diagonal[2];
            }
        }
        eliminate(n_ - 2, diagonal);
        diagonal[0] = diagonal[1];
        eliminate(n_ - 1, diagonal);
        if (penta_)
            substitute_rows<true>(2, n_, s_.upper1, s_.upper2, r);
        else
            substitute_rows<false>(2, n_, s_.upper1, s_.upper2, r);
        for (int i = 0; i < 2; ++i) r[i] = known_[i];
        for (int i = 0; anew_ && i < n_; ++i) r[i] = select(active_ > S(0), r[i], s_.kept[i]);
    }
    WETCURL_HD bool take(stage::MoveLimit at) {
        return limit() && at.may_move() &&
               update_limit_edges(*limit(), view_, scheme_.h, s_.solution, active_, s_.limit_edge);
    }
    WETCURL_HD bool take(stage::MoveHolds at) {
        if (!b_.pushed || !at.may_move(rules_.holds_entering)) return false;
        const bool changed = update_holds(n_, scheme_.h, s_.solution, b_.pushed, active_, s_.hold);
        return (rules_.holds_entering && hold_entering()) || changed;
    }

    WETCURL_HD bool take(stage::Relinearise at) {
        const V* r = s_.solution;
        if (at.linearisations == b_.max_linearisations) return false;
        active_ = active_ * turned_far(view_, scheme_.h, r, b_.pushed, b_.relinearise_angle);
        if (!any_positive(active_)) return false;
        anew_ = true;
        for (int i = 0; i < n_; ++i) {
            s_.kept[i] = r[i];
            const V dv = active_ * r[i], way = scheme_.h * dv;
            s_.predicted_x[i] += way, s_.expected_v[i] += dv;
            if (b_.pushed && i > 1 && any_positive(b_.pushed[i]))
                s_.hold[i].gap += dot(way, s_.hold[i].normal);
        }
        for (int i = 0; b_.frame && i + 1 < n_; ++i) s_.kept_frame[i] = b_.frame[i];
        return true;
    }

    WETCURL_HD void take(stage::Place) {
        const V* r = s_.solution;
        if (b_.reaction) put_reaction();
        for (int i = 0; i < n_; ++i) {
            b_.v_before[i] = view_.v[i] + r[i];
            b_.x_before[i] = i < 2 ? b_.root[i] : s_.predicted_x[i] + scheme_.h * r[i];
        }
        for (int i = 2; b_.pushed && i < n_; ++i) {
            if (any_positive(b_.pushed[i])) b_.pushed[i] = pushed_by(s_.hold[i], scheme_.h, r[i]);
            // Where forces were taken anew the gap is a guess.
            s_.gap[i] = anew_ ? S(-1) : s_.gap[i] - scheme_.h * norm(r[i]);
        }
        look_from_new_state();
        for (int i = 1; limit() && i + 1 < n_; ++i)
            limited += count_lanes<S>(limit()->holds(s_.limit_edge[i], view_.rest_length[i]));
    }
    WETCURL_HD void take(stage::MeetSolids) {
        V *x = b_.x_before, *x_old = b_.x, *v = b_.v_before, *v_old = b_.v;
        surfaces_.for_each_met(n_, x, [&](const auto& solid, bool moves) {
            bool met = false;
            auto resolve = [&] {
                met = resolve_contact(solid, rules_.implicit ? T(0) : solid.friction, n_, rest_depth_, s_.gap,
                                      b_.dt, view_.mass, b_.pushed, x, x_old, v, v_old);
            };
            if (moves)
                counted(Meter::solids, resolve);
            else
                resolve();
            return met;
        });
    }
    WETCURL_HD void take(stage::UpdateTouching) {
        if (adhesion()) update_touching(n_, view_.phi, T(adhesion()->h_a), near_.touching);
    }
    WETCURL_HD void take(stage::EndFrames) {
        if (b_.frame) transport_frames(n_, b_.frame, turn_left(), b_.x_before, b_.frame);
    }

    // --- of the explicit substep

    WETCURL_HD void take(stage::Push) {
        const V gravity = cast<S>(b_.gravity), zero{S(0), S(0), S(0)};
        s_.system.h = S(b_.dt), s_.system.ring = s_.system.whole;
        for (int i = 0; i < n_; ++i) s_.system.force(i) = s_.system.pull(i) = zero;
        for_each_present(rules_.terms, [&](const auto& term) { term.assemble(view_, s_.system, 0, n_); });
        for (int i = 0; i < n_; ++i) {
            V force = s_.system.whole_force(i, n_) + view_.mass[i] * gravity;
            if (b_.external) force += b_.external[i];
            const V v =
                i < 2 ? S(1 / b_.dt) * (b_.root[i] - b_.x[i]) : b_.v[i] + (S(b_.dt) / view_.mass[i]) * force;
            if (b_.reaction && i < 2) b_.reaction[i] = (view_.mass[i] * S(1 / b_.dt)) * (v - b_.v[i]) - force;
            b_.v_before[i] = v;
            b_.x_before[i] = i < 2 ? b_.root[i] : b_.x[i] + S(b_.dt) * v;
        }
    }
    WETCURL_HD void take(stage::LimitVelocities) {
        if (rules_.iben) rules_.iben->limit_velocities(n_, b_.dt, b_.x_before, b_.v_before);
        look_from_new_state();
    }
    WETCURL_HD void take(stage::LimitStrain) {
        if (!limit()) return;
        V *x = b_.x_before, *x_old = b_.x, *v = b_.v_before, *v_old = b_.v;
        counted(Meter::limiter, [&] {
            V* unlimited = s_.predicted_x;
            for (int i = 0; i < n_; ++i) unlimited[i] = x[i];
            limited = limit_strain(n_, view_.rest_length, T(limit()->most), x);
            for (int i = 2; i < n_; ++i) {
                const V dx = x[i] - unlimited[i], dv = S(T(1 / b_.dt)) * dx;
                x_old[i] += dx, v[i] += dv, v_old[i] += dv;
            }
        });
    }

  private:
    WETCURL_HD const Slot<StrainLimit>& limit() const { return std::get<Slot<StrainLimit>>(rules_.terms); }
    WETCURL_HD const Slot<Adhesion>& adhesion() const { return std::get<Slot<Adhesion>>(rules_.terms); }
    // Of the frames, to where the substep ends.
    WETCURL_HD Quat<S> turn_left() const { return rules_.implicit ? Quat<S>::identity() : b_.root_turn; }

    // Nothing more is added to row i of K: it becomes one of the system, `diagonal` its own block.
    WETCURL_HD void complete(int i, Sym3<S>& diagonal) {
        V* r = s_.solution;
        const S h = scheme_.h;
        V force = s_.system.whole_force(i, n_) + view_.mass[i] * cast<S>(b_.gravity);
        if (b_.external) force += b_.external[i];
        s_.system.whole_row(i, n_, diagonal, &s_.upper1[i], penta_ ? &s_.upper2[i] : nullptr);
        s_.system.forget_row(i);
        if (i < 2) {
            root_force_[i] = force, root_diagonal_[i] = diagonal;
            return;
        }
        if (b_.external_stiffness) {
            const S k = b_.external_stiffness[i];
            force -= k * (view_.x[i] - scheme_.predicted(b_.x[i], b_.x_before[i], b_.v[i]));
            add_identity(diagonal, h * h * k);
        }
        r[i] = scheme_.right_side(view_.mass[i], b_.v[i], b_.v_before[i], view_.v[i], force);
        add_identity(diagonal, view_.mass[i]);
        if (b_.pushed && any_positive(b_.pushed[i])) add_hold(s_.hold[i], h, view_.v[i], diagonal, r[i]);
        if (i == 2) r[i] -= transposed_times(s_.upper1[1], known_[1]);
        if (penta_ && i < 4) r[i] -= transposed_times(s_.upper2[i - 2], known_[i - 2]);
    }
    WETCURL_HD void eliminate(int i, Sym3<S>* diagonal) {
        if (i < 2) return;
        if (penta_)
            eliminate_row<true>(i, n_, diagonal, s_.upper1, s_.upper2, s_.solution);
        else
            eliminate_row<false>(i, n_, diagonal, s_.upper1, s_.upper2, s_.solution);
    }
    // Of particle i, expected at x, by what the surfaces offer to ask.
    template <class Contact>
    WETCURL_HD Hold<S> contact_of(const Contact& contact, int i, const V& x, S& pushed) const {
        return contact(i, rest_depth_ ? rest_depth_[i] : S(0),
                       hold_stiffness(rules_.spring_sum, scheme_.h, view_.mass[i]), x, b_.v[i], pushed);
    }
    // Holds particles that the solution leads into solids where none were expected. Returns whether there
    // are.
    WETCURL_HD bool hold_entering() {
        S entered(0);
        surfaces_.expect([&](auto contact) {
            for (int i = 2; i < n_; ++i) {
                const V& d = s_.solution[i];
                const auto may = may_enter(scheme_.h, anew_ ? S(0) : s_.gap[i], d);
                const S free = select(b_.pushed[i] > S(0), S(0), select(may, active_, S(0)));
                if (!any_positive(free)) continue;
                S pushed{T(a_bit)};
                Hold<S> hold =
                    contact_of(contact, i, scheme_.predicted(b_.x[i], b_.x_before[i], b_.v[i]), pushed);
                hold.gap += scheme_.h * dot(view_.v[i] - scheme_.expected_velocity(b_.v[i]), hold.normal);
                hold.weight = S(0);
                const S enters = free * weigh_again(scheme_.h, d, hold);
                if (!any_positive(enters)) continue;
                entered += enters;
                if (!any_positive(b_.pushed[i])) s_.hold[i] = no_contact<S>();
                take_over(enters, hold, s_.hold[i]);
                b_.pushed[i] = select(enters > S(0), pushed, b_.pushed[i]);
            }
        });
        return any_positive(entered);
    }
    // What rows 0 and 1 lack: h R = A d - r.
    WETCURL_HD void put_reaction() {
        const V *r = s_.solution, *d0 = known_, *d1 = known_ + 1;
        V row[2] = {root_diagonal_[0] * *d0 + s_.upper1[0] * *d1,
                    transposed_times(s_.upper1[0], *d0) + root_diagonal_[1] * *d1};
        if (n_ > 2) row[1] += s_.upper1[1] * r[2];
        if (penta_ && n_ > 2) row[0] += s_.upper2[0] * r[2];
        if (penta_ && n_ > 3) row[1] += s_.upper2[1] * r[3];
        for (int i = 0; i < 2; ++i)
            b_.reaction[i] = (S(1) / scheme_.h) * (row[i] + view_.mass[i] * known_[i] -
                                                   scheme_.right_side(view_.mass[i], b_.v[i], b_.v_before[i],
                                                                      view_.v[i], root_force_[i]));
    }

    // Terms and meter see the strands where the step has led them, before limits and contact.
    WETCURL_HD void look_from_new_state() {
        view_.x = b_.x_before, view_.v = b_.v_before;
        if constexpr (!std::is_same_v<Meter, NoMeter>)
            if (meter_) meter_->add_step(b_, view_, turn_left(), b_.x, s_);
    }
    template <class Kind, class Act>
    WETCURL_HD void counted(Kind kind, Act act) {
        if constexpr (!std::is_same_v<Meter, NoMeter>)
            if (meter_) return meter_->add_change(kind, b_, view_, turn_left(), act);
        act();
    }

    const SubstepRules<T>& rules_;
    BlockStep<S>& b_;
    ChainView<S> view_;  // where forces are taken; in the end, of the new state
    const NearestView<S>& near_;
    const S* rest_depth_;
    const Surfaces& surfaces_;
    ChainScratch<S>& s_;
    Meter* meter_;
    const Bdf2<S> scheme_;
    const int n_;
    const bool more_, penta_;  // terms beside the common ones; rows are coupled to the second after them
    // Lanes that are solved for, the others keep their solution; whether forces have been taken more than
    // once.
    S active_ = S(1);
    bool anew_ = false;
    // Of particles 0 and 1: by how much their velocities change, forces on them, their diagonals of K.
    V known_[2], root_force_[2];
    Sym3<S> root_diagonal_[2];
};

// As above. Returns how many edges were held at their strain limit.
template <class S, class Surfaces, class Meter>
WETCURL_HD int take_substep(const SubstepRules<Plain<S>>& rules, BlockStep<S>& step, const ChainView<S>& view,
                            const NearestView<S>& near, const S* rest_depth, const Surfaces& surfaces,
                            ChainScratch<S>& scratch, Meter* meter) {
    BlockStages<S, Surfaces, Meter> strands(rules, step, view, near, rest_depth, surfaces, scratch, meter);
    if (rules.implicit)
        take_implicit_substep(strands);
    else
        take_explicit_substep(strands);
    return strands.limited;
}

}  // namespace wetcurl

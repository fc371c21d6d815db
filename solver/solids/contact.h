// Contact of a block's particles with solids: what lies on a surface is held there within the implicit step,
// what goes in is projected onto the level set; Coulomb friction, and what adhesion needs to know.
// Bridson 2002, Sec. 7.2 for friction on velocities; depth against min(0, phi at rest) is ours, and so is the
// holding: bends that push into a solid would else be stretched by each step's projection.
#pragma once

#include "base/geometry/shapes.h"
#include "base/vec3.h"

namespace wetcurl {

// A solid at the end of a substep, moving rigidly. Body: a Shape, or what a device holds of it.
template <class T, class Body = Shape>
struct PosedSolid {
    using Number = T;
    const Body* shape;
    Quat<T> rotation;
    Vec3<T> translation, velocity, spin;  // velocity of its origin [m/s], angular velocity [rad/s]
    T friction;
    bool attached;  // to the head: real grooms are drawn into it
};

// Distance and outward normal in the world at x.
template <class S, class Body>
WETCURL_HD DistanceSample<S> distance_in_world(const PosedSolid<Plain<S>, Body>& solid, const Vec3<S>& x) {
    const Vec3<S> arm = x - cast<S>(solid.translation);
    const Quat<S> r = cast<S>(solid.rotation);
    const bool ball = is_ball(*solid.shape);
    DistanceSample<S> d = distance(*solid.shape, ball ? arm : rotate(conjugate(r), arm));
    if (!ball) d.normal = rotate(r, d.normal);
    return d;
}

// Of the surface at x: rigid motion, and what a deforming one adds.
template <class S, class Body>
WETCURL_HD Vec3<S> velocity_at(const PosedSolid<Plain<S>, Body>& solid, const Vec3<S>& x) {
    const Vec3<S> arm = x - cast<S>(solid.translation);
    const Vec3<S> v = cast<S>(solid.velocity) + cross(cast<S>(solid.spin), arm);
    auto deforming = [&](const MovingGrid& grid) {
        const Quat<S> r = cast<S>(solid.rotation);
        return v + rotate(r, surface_velocity(grid, rotate(conjugate(r), arm)));
    };
    if constexpr (std::is_same_v<Body, MovingGrid>) return deforming(*solid.shape);
    if constexpr (std::is_same_v<Body, ShapeView>)
        if (solid.shape->kind == ShapeView::Kind::moving_grid) return deforming(solid.shape->grid);
    return v;
}

// Points pushed out of each in turn, as far as `allowed` for what is attached to the head.
template <int count, class Solids>
WETCURL_HD void push_out(const Solids& solids, Vec3f (&x)[count], const float (&allowed)[count]) {
    for (const auto& solid : solids) {
        const int rounds = pushes_of(*solid.shape);
        bool pushed = true;
        for (int round = 0; round < rounds && pushed; ++round) {
            pushed = false;
            WETCURL_UNROLL(count)
            for (int k = 0; k < count; ++k) {
                const auto d =
                    distance_in_world(solid, cast<typename std::decay_t<decltype(solid)>::Number>(x[k]));
                const float depth = (solid.attached ? allowed[k] : 0.f) - float(d.phi);
                if (depth > (round > 0 ? float(near_surface) : 0.f))
                    x[k] += depth * cast<float>(d.normal), pushed = true;
            }
        }
    }
}
template <class Solids>
WETCURL_HD Vec3f pushed_out(const Solids& solids, const Vec3f& x, float allowed) {
    Vec3f one[] = {x};
    push_out(solids, one, {allowed});
    return one[0];
}

// Which of two solids counts: the nearer one, the earlier where both are as near.
struct Nearer {
    template <class S>
    WETCURL_HD auto operator()(const S& distance, const S& so_far) const {
        return distance < so_far;
    }
};

// A contact within the implicit step: where the particle is expected, `gap` [m] beyond what is allowed along
// the normal.
template <class S>
struct Hold {
    Vec3<S> normal, surface_velocity;
    S gap, friction;
    S stiff;   // [kg] of the spring that may close the gap; 0 where no surface pushed before
    S weight;  // likewise, while it is held; 0: not held
    S drag;    // [kg] of friction on what slides, while it is held
};
template <class S>
WETCURL_HD Hold<S> no_contact() {
    const Vec3<S> zero{S(0), S(0), S(0)};
    return {zero, zero, S(1e9), S(0), S(0), S(0), S(0)};
}
// The hold becomes that of `solid` where its gap is the smaller one.
template <class S, class Solid, class Counts = Nearer>
WETCURL_HD void take_deeper(const Solid& solid, const S& rest_depth, const Vec3<S>& x, Hold<S>& hold,
                            Counts counts = {}) {
    const DistanceSample<S> d = distance_in_world(solid, x);
    const S gap = d.phi - (solid.attached ? rest_depth : S(0));
    const auto nearer = counts(gap, hold.gap);
    hold.normal = select(nearer, d.normal, hold.normal);
    hold.surface_velocity = select(nearer, velocity_at(solid, x), hold.surface_velocity);
    hold.friction = select(nearer, S(solid.friction), hold.friction);
    hold.gap = select(nearer, gap, hold.gap);
}
// How particles slide along the surface at velocities v.
template <class S>
WETCURL_HD Vec3<S> slide_of(const Hold<S>& hold, const Vec3<S>& v) {
    const Vec3<S> relative = v - hold.surface_velocity;
    return relative - dot(relative, hold.normal) * hold.normal;
}
// A first guess: a particle on its way out is let go. Coulomb's friction of the momentum `pushed` is taken as
// a drag that gives as much at the velocity v that is expected, so that it only ever takes energy; what
// hardly moves creeps.
template <class S>
WETCURL_HD void weigh(const S& pushed, const S& stiff, const Vec3<S>& v, Hold<S>& hold) {
    constexpr Plain<S> creep = 1e-6;  // [m/s]
    hold.stiff = select(pushed > S(0), stiff, S(0));
    hold.weight = select(hold.gap < S(Plain<S>(near_surface)), hold.stiff, S(0));
    hold.drag = minimum(hold.friction * pushed / maximum(norm(slide_of(hold, v)), S(creep)), hold.stiff);
}
// Whether the row's solution d leaves the particle with the surface says whether it is held: not where the
// surface would have to pull, and where it would go in. Returns 0 where that was known.
template <class S>
WETCURL_HD S weigh_again(const S& h, const Vec3<S>& d, Hold<S>& hold) {
    const S weight = select(hold.gap + h * dot(d, hold.normal) < S(0), hold.stiff, S(0));
    const S change = weight - hold.weight;
    hold.weight = weight;
    return change * change;
}
// So often is the system solved at most while holds change; more often where what enters is held.
constexpr int most_contact_solves = 2, most_entering_solves = 8;
// The gap alone that a particle at x has to the solid that it is deepest in.
template <class S, class Solids>
WETCURL_HD S least_gap(const Solids& solids, const S& rest_depth, const Vec3<S>& x) {
    S least = no_contact<S>().gap;
    for (const auto& solid : solids)
        least = minimum(least, distance_in_world(solid, x).phi - (solid.attached ? rest_depth : S(0)));
    return least;
}
// The solid that a particle at x is deepest in, not yet weighed.
template <class S, class Solids>
WETCURL_HD Hold<S> deepest_contact(const Solids& solids, const S& rest_depth, const Vec3<S>& x) {
    Hold<S> hold = no_contact<S>();
    for (const auto& solid : solids) take_deeper(solid, rest_depth, x, hold);
    return hold;
}
// What is expected inside counts as pushed: a bit [kg m/s], without friction yet.
constexpr double a_bit = 1e-30;
template <class S>
WETCURL_HD void expect_push(const S& gap, S& pushed) {
    pushed = select(gap < S(0), maximum(pushed, S(Plain<S>(a_bit))), pushed);
}
// Of a particle at x, with velocity v, that a surface `pushed` in the step before or is to push now: a spring
// of `stiff` [kg] that closes the gap, and friction.
template <class S, class Solids>
WETCURL_HD Hold<S> expected_contact(const Solids& solids, const S& rest_depth, const S& stiff,
                                    const Vec3<S>& x, const Vec3<S>& v, S& pushed) {
    Hold<S> hold = deepest_contact(solids, rest_depth, x);
    expect_push(hold.gap, pushed);
    if (any_positive(pushed)) weigh(pushed, stiff, v, hold);
    return hold;
}
// Whether a step that changes its velocity by d can lead a particle into a solid; `gap` where it is expected.
template <class S>
WETCURL_HD auto may_enter(const S& h, const S& gap, const Vec3<S>& d) {
    return gap - h * norm(d) < S(Plain<S>(1e-6));
}
// The hold becomes `other` where `where` is above 0.
template <class S>
WETCURL_HD void take_over(const S& where, const Hold<S>& other, Hold<S>& hold) {
    const auto taken = where > S(0);
    hold.normal = select(taken, other.normal, hold.normal);
    hold.surface_velocity = select(taken, other.surface_velocity, hold.surface_velocity);
    hold.gap = select(taken, other.gap, hold.gap);
    hold.friction = select(taken, other.friction, hold.friction);
    hold.stiff = select(taken, other.stiff, hold.stiff);
    hold.weight = select(taken, other.weight, hold.weight);
    hold.drag = select(taken, other.drag, hold.drag);
}
// Adds spring and drag to a particle's row, A d = r with d beside the velocity v.
template <class S>
WETCURL_HD void add_hold(const Hold<S>& hold, const S& h, const Vec3<S>& v, Sym3<S>& diagonal, Vec3<S>& r) {
    const S drag = select(hold.weight > S(0), hold.drag, S(0));
    diagonal += isotropic_plus_outer(drag, hold.weight - drag, hold.normal);
    r -= (hold.weight * hold.gap / h) * hold.normal + drag * slide_of(hold, v);
}
// The momentum [kg m/s] that the surface gave for the row's solution d; 0 where it would have had to pull.
template <class S>
WETCURL_HD S pushed_by(const Hold<S>& hold, const S& h, const Vec3<S>& d) {
    return select(hold.weight > S(0), maximum(-hold.weight * (dot(d, hold.normal) + hold.gap / h), S(0)),
                  S(0));
}
// The momentum [kg m/s] of friction on a held particle that leaves the step with velocity v.
template <class S>
WETCURL_HD Vec3<S> friction_of(const Hold<S>& hold, const Vec3<S>& v) {
    return select(hold.weight > S(0), -hold.drag, S(0)) * slide_of(hold, v);
}

// A position pushed out to `allowed` (≤ 0: how deep the particle may lie), its velocity relieved of its
// inward part and slowed along the surface by `friction` (0 where holds have it: seen, a stiff strand that a
// projection slows unevenly gains energy). Corrections go to the step before alike, so that the history of
// the integrator stays what it was. `pushed` (mass given) is raised to the push's momentum. Whether there was
// a contact.
template <class S, class Body>
WETCURL_HD bool resolve_contact(const PosedSolid<Plain<S>, Body>& solid, Plain<S> friction, const S& allowed,
                                Plain<S> dt, const S& mass, S& pushed, Vec3<S>& x, Vec3<S>& x_before,
                                Vec3<S>& v, Vec3<S>& v_before) {
    const Vec3<S> zero{S(0), S(0), S(0)};
    constexpr int rounds = 4;  // in a crease one push along the gradient does not reach the surface
    for (int round = 0; round < rounds; ++round) {
        const DistanceSample<S> d = distance_in_world(solid, x);
        const S depth = allowed - d.phi;
        if (!any_positive(depth - S(round > 0 ? Plain<S>(near_surface) : 0))) return round > 0;
        const auto hit = depth > S(0);
        const Vec3<S> relative = v - velocity_at(solid, x);
        const S inward = minimum(dot(relative, d.normal), S(0));
        const Vec3<S> slide = relative - dot(relative, d.normal) * d.normal;
        const S speed = maximum(norm(slide), S(tiny_length<S>));
        const S lost = minimum(S(1), S(friction) * (depth * S(1 / dt) - inward) / speed);
        const Vec3<S> dx = select(hit, depth * d.normal, zero);
        const Vec3<S> dv = select(hit, -inward * d.normal - lost * slide, zero);
        pushed = select(hit, maximum(pushed, mass * depth * S(1 / dt)), pushed);
        x += dx;
        x_before += dx;
        v += dv;
        v_before += dv;
    }
    return true;
}
// The same for n particles; 0 and 1 are prescribed, and those with some `gap` left need no look. Null: all
// do.
template <class S, class Body>
WETCURL_HD bool resolve_contact(const PosedSolid<Plain<S>, Body>& solid, Plain<S> friction, int n,
                                const S* rest_depth, const S* gap, Plain<S> dt, const S* mass, S* pushed,
                                Vec3<S>* x, Vec3<S>* x_before, Vec3<S>* v, Vec3<S>* v_before) {
    bool met = false;
    for (int i = 2; i < n; ++i)
        if (!gap || any_positive(S(Plain<S>(1e-6)) - gap[i]))
            met |= resolve_contact(solid, friction, solid.attached ? rest_depth[i] : S(0), dt, mass[i],
                                   pushed[i], x[i], x_before[i], v[i], v_before[i]);
    return met;
}

// What adhesion sees becomes `solid`'s where that is nearer than `phi`.
template <class S, class Solid, class Counts = Nearer>
WETCURL_HD void take_nearer(const Solid& solid, const Vec3<S>& x, S& phi, Vec3<S>& normal,
                            Vec3<S>& surface_velocity, Counts counts = {}) {
    const DistanceSample<S> d = distance_in_world(solid, x);
    const auto nearer = counts(d.phi, phi);
    normal = select(nearer, d.normal, normal);
    surface_velocity = select(nearer, velocity_at(solid, x), surface_velocity);
    phi = select(nearer, d.phi, phi);
}
// The nearest solid at a particle, as adhesion sees it; normal and velocity stay where there is none.
template <class S, class Solids>
WETCURL_HD void sample_nearest(const Solids& solids, const Vec3<S>& x, S& phi, Vec3<S>& normal,
                               Vec3<S>& surface_velocity) {
    phi = S(1e9);
    for (const auto& solid : solids) take_nearer(solid, x, phi, normal, surface_velocity);
}
template <class S>
void sample_nearest(const std::vector<PosedSolid<Plain<S>>>& solids, int n, const Vec3<S>* x, S* phi,
                    Vec3<S>* normal, Vec3<S>* surface_velocity) {
    for (int i = 0; i < n; ++i) sample_nearest(solids, x[i], phi[i], normal[i], surface_velocity[i]);
}

// The contact flag with hysteresis: on at the surface, off beyond the range h.
template <class S>
WETCURL_HD S updated_touching(const S& touching, const S& phi, Plain<S> range) {
    return select(phi > S(range), S(0), select(phi < S(Plain<S>(0.1) * range), S(1), touching));
}
template <class S>
WETCURL_HD void update_touching(int n, const S* phi, Plain<S> range, S* touching) {
    for (int i = 0; i < n; ++i) touching[i] = updated_touching(touching[i], phi[i], range);
}

// A block's part of the surfaces nearest to its particles (n); null without adhesion.
template <class S>
struct NearestView {
    S* phi;
    Vec3<S>*normal, *velocity;
    S* touching;
};

// The surfaces of solids in a plain loop, as take_substep asks for them.
template <class S, class Solids>
struct SolidsInALoop {
    const Solids& solids;

    // Calls use(contact) with contact(particle, rest_depth, stiff, x, v, pushed) -> Hold, of which the gap
    // alone counts where nothing pushes.
    template <class Use>
    WETCURL_HD void expect(Use use) const {
        use([&](int, const S& rest_depth, const S& stiff, const Vec3<S>& x, const Vec3<S>& v, S& pushed) {
            Hold<S> hold;
            hold.gap = least_gap(solids, rest_depth, x);
            expect_push(hold.gap, pushed);
            if (any_positive(pushed)) hold = expected_contact(solids, rest_depth, stiff, x, v, pushed);
            return hold;
        });
    }
    // The nearest ones of n particles.
    WETCURL_HD void sample(int n, const Vec3<S>* x, const NearestView<S>& near) const {
        for (int i = 0; i < n; ++i)
            sample_nearest(solids, x[i], near.phi[i], near.normal[i], near.velocity[i]);
    }
    // Calls meet(solid, whether it moves) for each that may hold some of x; it says whether it moved any.
    template <class Meet>
    WETCURL_HD void for_each_met(int, const Vec3<S>*, Meet meet) const {
        for (const auto& solid : solids) meet(solid, norm(solid.velocity) + norm(solid.spin) > 0);
    }
};

}  // namespace wetcurl

// Where a scene's head and solids are at the end of a substep, and how they move.
#pragma once

#include <vector>

#include "solver/motion/root_motion.h"
#include "solver/scene/scene.h"
#include "solver/solids/solid_tree.h"

namespace wetcurl {

// In the solver's precision.
template <class T>
struct PosedScene {
    Pose head;
    RootMotion<T> head_motion;
    std::vector<RootMotion<T>> roots;   // (strand) that ride on a solid; empty: all move with the head
    std::vector<PosedSolid<T>> solids;  // rigid ones
    std::vector<PosedSolid<T, MovingGrid>> deforming;
    std::optional<SolidTree<T>> tree;  // of `solids`, where they are many
    RidingRoots::Room room, room_before;
    double begins;  // [s] the substep that ends here
    T dt;           // [s] its length
    // Whether a plain loop over `solids` is all there is to do.
    bool few() const { return !tree && deforming.empty(); }
    // The longest way [m] from `before` to x, a substep later, that a rigid solid sees.
    template <class S>
    S way(const Vec3<S>& before, const Vec3<S>& x) const {
        S longest(0);
        for (const auto& solid : solids) {
            const Vec3<S> arm = x - cast<S>(solid.translation);
            const T turn = dt * norm(solid.spin);  // its second order is kept apart
            longest = maximum(
                longest, norm(x - before - S(dt) * velocity_at(solid, x)) + S(turn * turn / 2) * norm(arm));
        }
        return longest;
    }
};

// Where a block's particles are far from all solids, from one substep to the next.
template <class S>
struct FarFromSolids {
    std::vector<S> left;         // (particle) [m] to go before a gap may close; below 0: not known
    std::vector<Vec3<S>> asked;  // (particle) where it was in the substep before

    explicit FarFromSolids(int n) : left(size_t(n)), asked(size_t(n), {S(0), S(0), S(0)}) { forget(); }
    void forget() { std::fill(left.begin(), left.end(), S(-1)); }
    // Of particle i, which now is at x. A sampled distance falls by up to sqrt(3) of a way within a grid,
    // which is interpolated along three axes, and by the way itself up to its border.
    bool is_far(int i, const Vec3<S>& x, const PosedScene<Plain<S>>& p) {
        S& to_go = left[size_t(i)];
        to_go -= S(3) * p.way(asked[size_t(i)], x);
        asked[size_t(i)] = x;
        return !any_positive(S(Plain<S>(1e-3)) - to_go);
    }
};

// expected_contact and sample_nearest where the solids are not few.
template <class S>
Hold<S> expected_contact_of_all(const PosedScene<Plain<S>>& p, const S& rest_depth, const S& stiff,
                                const Vec3<S>& x, const Vec3<S>& v, S& pushed) {
    Hold<S> hold =
        p.tree ? deepest_contact(*p.tree, p.solids, rest_depth, x) : deepest_contact(p.solids, rest_depth, x);
    for (const auto& solid : p.deforming) take_deeper(solid, rest_depth, x, hold);
    expect_push(hold.gap, pushed);
    if (any_positive(pushed)) weigh(pushed, stiff, v, hold);
    return hold;
}
template <class S>
void sample_nearest_of_all(const PosedScene<Plain<S>>& p, const Vec3<S>& x, S& phi, Vec3<S>& normal,
                           Vec3<S>& surface_velocity) {
    if (p.tree)
        sample_nearest(*p.tree, p.solids, x, phi, normal, surface_velocity);
    else
        sample_nearest(p.solids, x, phi, normal, surface_velocity);
    for (const auto& solid : p.deforming) take_nearer(solid, x, phi, normal, surface_velocity);
}
// Of n particles, whatever the solids are.
template <class S>
void sample_nearest(const PosedScene<Plain<S>>& p, int n, const Vec3<S>* x, S* phi, Vec3<S>* normal,
                    Vec3<S>* surface_velocity) {
    if (p.few()) return sample_nearest(p.solids, n, x, phi, normal, surface_velocity);
    for (int i = 0; i < n; ++i) sample_nearest_of_all(p, x[i], phi[i], normal[i], surface_velocity[i]);
}

// The surfaces of a posed scene as a substep asks for them. `far`: null where asking costs as much as
// remembering.
template <class S>
struct SurfacesOf {
    const PosedScene<Plain<S>>& p;
    FarFromSolids<S>* far = nullptr;

    template <class Use>
    void expect(Use use) const {
        if (p.few() && !far) return SolidsInALoop<S, std::vector<PosedSolid<Plain<S>>>>{p.solids}.expect(use);
        use([&](int i, const S& rest_depth, const S& stiff, const Vec3<S>& x, const Vec3<S>& v, S& pushed) {
            if (!far) return expected_contact_of_all(p, rest_depth, stiff, x, v, pushed);
            Hold<S> hold = no_contact<S>();
            // Who was pushed is held by the gap as it is.
            if (far->is_far(i, x, p) && !any_positive(pushed))
                hold.gap = far->left[size_t(i)];
            else
                hold = expected_contact_of_all(p, rest_depth, stiff, x, v, pushed),
                far->left[size_t(i)] = hold.gap;
            return hold;
        });
    }
    // All are asked for: to remember who is far took longer than it saved.
    void sample(int n, const Vec3<S>* x, const NearestView<S>& near) const {
        sample_nearest(p, n, x, near.phi, near.normal, near.velocity);
    }
    template <class Meet>
    void for_each_met(int n, const Vec3<S>* x, Meet meet) const {
        auto meet_rigid = [&](const PosedSolid<Plain<S>>& solid) {
            return meet(solid, norm(solid.velocity) + norm(solid.spin) > 0);
        };
        if (p.tree)
            p.tree->for_each_met(n, x, [&](size_t solid) { return meet_rigid(p.solids[solid]); });
        else
            for (const auto& solid : p.solids) meet_rigid(solid);
        for (const auto& solid : p.deforming) meet(solid, true);
    }
};

// The surface nearest to each particle, (block, particle); empty where no present term needs it.
template <class S>
struct NearestSurface {
    std::vector<S> phi;  // [m]
    std::vector<Vec3<S>> normal, velocity;
};

// At `time`, coming from where all was dt earlier. `moving` = false: all is held as it is. `surfaces`: of
// each deforming solid in the scene's order, at that time; null: the scene has none. `room`: an earlier
// one, whose memory is used again.
template <class T>
PosedScene<T> posed_scene_at(const Scene& scene, double time, double dt, bool moving = true,
                             const MovingGrid* surfaces = nullptr, PosedScene<T> room = {}) {
    const Pose head = scene.head_at(time, room.room),
               head_before = moving ? scene.head_at(time - dt, room.room) : head;
    PosedScene<T> p{.head = head,
                    .head_motion = root_motion<T>(head_before, head, dt),
                    .roots = std::move(room.roots),
                    .solids = std::move(room.solids),
                    .deforming = std::move(room.deforming),
                    .tree = std::move(room.tree),
                    .room = std::move(room.room),
                    .room_before = std::move(room.room_before),
                    .begins = moving ? time - dt : time,
                    .dt = T(dt)};
    p.solids.clear(), p.deforming.clear();
    if (scene.riding) {
        scene.root_poses_at(time, p.room);
        if (moving) scene.root_poses_at(time - dt, p.room_before);
        const auto &now = p.room.pose, &before = moving ? p.room_before.pose : now;
        p.roots.resize(now.size());
        for (size_t s = 0; s < now.size(); ++s) p.roots[s] = root_motion<T>(before[s], now[s], dt);
    }
    for (const auto& solid : scene.solids) {
        const double then = solid.cuts.beyond(time);
        const bool steady = moving && !solid.cuts.within(time);  // no jump on the way
        const auto pose_at = [&](double t, const Pose& of_head) {
            return solid.deformation ? scene.surface_frame(solid, t, of_head) : solid.at(t, of_head);
        };
        const Pose now = pose_at(then, head), before = steady ? pose_at(time - dt, head_before) : now;
        auto posed = [&]<class Body>(const Body* body) {
            return PosedSolid<T, Body>{.shape = body,
                                       .rotation = cast<T>(now.rotation),
                                       .translation = cast<T>(now.translation),
                                       .velocity = cast<T>((1 / dt) * (now.translation - before.translation)),
                                       .spin = cast<T>(angular_velocity(before.rotation, now.rotation, dt)),
                                       .friction = T(solid.friction),
                                       .attached = solid.moves_with_roots()};
        };
        if (solid.deformation)
            p.deforming.push_back(posed(surfaces++));
        else
            p.solids.push_back(posed(&solid.shape));
    }
    if (p.solids.size() <= most_solids_in_a_loop) {
        p.tree.reset();
    } else {
        if (!p.tree) p.tree.emplace();
        p.tree->pose(p.solids);
    }
    return p;
}

}  // namespace wetcurl

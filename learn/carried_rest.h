// A strand's own rest shape, carried by how the low-resolution strands around it have moved from theirs: the
// base that a strand network starts from, and the best way without one.
// Ours. All in the strand's root frame (learn/root_frame.h), offsets from the root, so that neither the
// head's pose nor the place on the scalp is in them.
#pragma once

#include <vector>

#include "base/pack.h"
#include "learn/core_detail.h"
#include "learn/root_frame.h"
#include "learn/stencil.h"

namespace wetcurl {

// What a rest shape says of one particle; of edges: the one to the next particle, 0 for the tip's.
template <class S>
struct RestParticle {
    Vec3<S> edge;    // of the drawn strand's core, as long as the curled strand's core is there [m]
    S length;        // of the curled strand's core's edge over that of the drawn one's
    Vec3<S> curled;  // of the curled strand's core [m]
    Vec3<S> detail;  // of the curled strand around its core [m]
};

// One strand of `n` particles, or a strand a lane: the drawn core, moved, its edges as much shorter as the
// curled core's are, and the curled detail around it. `rest(i)` gives a RestParticle, `moved(i)` how far the
// core's particle i has moved [m], `store(i, offset)` takes the result in order.
template <class S, class Rest, class Moved, class Store>
WETCURL_HD void carry_rest(int n, Rest rest, Moved moved, Store store) {
    CarriedTurn<S> turn;
    Vec3<S> at{S(0), S(0), S(0)}, before = moved(0);
    for (int i = 0; i < n; ++i) {
        const RestParticle<S> p = rest(i);
        Vec3<S> edge{S(0), S(0), S(0)};
        if (i + 1 < n) {
            const Vec3<S> next = moved(i + 1);
            edge = p.edge + p.length * (next - before);
            before = next;
            turn.follow(p.curled, edge);
        }
        store(i, at + rotate(turn.turn, p.detail));  // the tip takes the last edge's turn
        at += edge;
    }
}

class RestCarrier {
  public:
    // `shape` (high strands): how they lie at rest in the head's frame, null: as drawn. Throws Error where it
    // does not fit.
    // `low_is_wet`: the low-resolution strands are curled and shortened by their water too, and are kept as
    // they are.
    RestCarrier(const Stencil& stencil, const Groom& high, const Groom& low, const Strands* shape,
                bool low_is_wet = false);
    // low (low strands): world positions [m]; out (high strands): offsets in the root frames [m]. Throws
    // Error for other strands.
    void apply(const Stencil& stencil, const Strands& low, const Pose& head, Strands& out);
    RestParticle<float> rest(int strand, int particle) const;
    bool low_is_wet() const { return low_is_wet_; }

  private:
    using S = Pack<float>;
    int particles_;
    bool low_is_wet_;
    std::vector<RestParticle<S>> rest_;  // (block of lanes, particle)
    std::vector<Quat<S>> to_root_;       // (block): head's frame to the root frames
    Strands low_rest_cores_;
    Strands moved_;  // (low strands) how far their cores are from rest, in the head's frame [m]
};

// Offsets in the root frames to world positions at a head pose; `world` may be `offsets`.
void place_in_world(const RootFrames& roots, const Strands& offsets, const Pose& head, Strands& world);

}  // namespace wetcurl

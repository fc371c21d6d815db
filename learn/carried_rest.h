// A strand's own rest shape, carried by how the low-resolution strands around it have moved from theirs: the
// base that a strand network starts from, and the best way without one.
// Ours. All in the strand's root frame (learn/root_frame.h), offsets from the root, so that neither the
// head's pose nor the place on the scalp is in them.
#pragma once

#include <vector>

#include "learn/core_detail.h"
#include "learn/root_frame.h"
#include "learn/stencil.h"

namespace wetcurl {

// What a rest shape says of one particle; of edges: the one to the next particle, 0 for the tip's.
struct RestParticle {
    Vec3f edge;    // of the drawn strand's core, as long as the curled strand's core is there [m]
    float length;  // of the curled strand's core's edge over that of the drawn one's
    Vec3f curled;  // of the curled strand's core [m]
    Vec3f detail;  // of the curled strand around its core [m]
};

// One strand of `n` particles: the drawn core, moved, its edges as much shorter as the curled core's are, and
// the curled detail around it. `rest(i)` gives a RestParticle, `moved(i)` how far the core's particle i has
// moved [m], `store(i, offset)` takes the result in order.
template <class Rest, class Moved, class Store>
WETCURL_HD void carry_rest(int n, Rest rest, Moved moved, Store store) {
    CarriedTurn turn;
    Vec3f at{0, 0, 0}, before = moved(0);
    for (int i = 0; i < n; ++i) {
        const RestParticle p = rest(i);
        Vec3f edge{0, 0, 0};
        if (i + 1 < n) {
            const Vec3f next = moved(i + 1);
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
    RestCarrier(const Stencil& stencil, const Groom& high, const Groom& low, const Strands* shape);
    // low (low strands): world positions [m]; out (high strands): offsets in the root frames [m].
    void apply(const Stencil& stencil, const RootFrames& roots, const Strands& low, const Pose& head,
               Strands& out);
    // (high strand, particle)
    const std::vector<RestParticle>& rest() const { return rest_; }
    // Of the low strands, in the head's frame.
    const Strands& low_rest_cores() const { return low_rest_cores_; }

  private:
    std::vector<RestParticle> rest_;
    Strands low_rest_cores_;
    Strands moved_;  // (low strands) how far their cores are from rest, in the head's frame [m]
};

// Offsets in the root frames to world positions at a head pose; `world` may be `offsets`.
void place_in_world(const RootFrames& roots, const Strands& offsets, const Pose& head, Strands& world);

}  // namespace wetcurl

// A strand's own rest shape, carried by how the low-resolution strands around it have moved from theirs: the
// base that a strand network starts from, and the best way without one.
// All in the strand's root frame (learn/codec/root_frame.h), offsets from the root, so that neither the
// head's pose nor the place on the scalp is in them.
//
// Where hair parts, a strand goes with those that are drawn as it is: of the strands around it each counts
// by the inverse square of how far their cores lie apart at rest (Shepard 1968). What then is its own, it
// keeps as far as low-resolution strands keep what those beside them do not have. A strand of another length
// moves as much by its length: a fringe does not go the way of what hangs to the waist.
#pragma once

#include <vector>

#include "base/network_channels.h"
#include "base/pack.h"
#include "learn/codec/core_detail.h"
#include "learn/codec/stencil.h"
#include "learn/codec/strand_lanes.h"

namespace wetcurl {

// What a rest shape says of one particle; of edges: the one to the next particle, 0 for the tip's.
template <class S>
struct RestParticle {
    Vec3<S> edge;    // of the drawn strand's core, as long as the curled strand's core is there [m]
    S length;        // of the curled strand's core's edge over that of the drawn one's
    Vec3<S> curled;  // of the curled strand's core [m]
    Vec3<S> detail;  // of the curled strand around its core [m]
    Vec3<S> own;     // of `edge`, what the strands around do not have [m]
};

// One strand of `n` particles, or a strand a lane: the drawn core, moved, its edges as much shorter as the
// curled core's are, less what it does not keep of its own, and the curled detail around it. `rest(i)` gives
// a RestParticle, `moved(i)` how far the core's particle i has moved [m], `store(i, offset)` takes the result
// in order; `lost`: share of its own, 0 to 1.
template <class S, class Rest, class Moved, class Store>
WETCURL_HD void carry_rest(int n, const S& lost, Rest rest, Moved moved, Store store) {
    CarriedTurn<S> turn;
    Vec3<S> at{S(0), S(0), S(0)}, before = moved(0);
    for (int i = 0; i < n; ++i) {
        const RestParticle<S> p = rest(i);
        Vec3<S> edge{S(0), S(0), S(0)};
        if (i + 1 < n) {
            const Vec3<S> next = moved(i + 1);
            edge = p.edge + p.length * (next - before) - lost * p.own;
            before = next;
            turn.follow(p.curled, edge);
        }
        store(i, at + rotate(turn.turn, p.detail));  // the tip takes the last edge's turn
        at += edge;
    }
}

// How much an edge of a low-resolution strand has lost of `own`, by which it differs at rest from the mean of
// those beside it, both by their lengths. `step(strand)` gives how far that edge of a strand has moved, by
// the strand's length. V: a vector, or numbers of one, of which the results add up.
WETCURL_HD inline float product(const Vec3f& a, const Vec3f& b) { return dot(a, b); }
WETCURL_HD inline float product(float a, float b) { return a * b; }
inline Pack<float> product(Pack<float> a, Pack<float> b) { return a * b; }
template <class V, class Step>
WETCURL_HD auto lost_of_edge(const V& own, int strand, const Beside& beside, Step step) {
    V sum{};
    int count = 0;
    for (int other : beside.strand)
        if (other >= 0) sum += step(other), ++count;
    return product(own, count > 0 ? 1.f / float(count) * sum - step(strand) : V{});
}

// Where dry low-resolution strands would be, were they wet: `share` (low strands) of their offsets from the
// root, and `more` (low strands, particles) [m], both in the head's frame.
struct Settled {
    std::vector<float> share;
    Strands more;
};
// Of how strands come to rest dry and wet, offsets in the head's frame: at rest they are where wet ones are.
// Where these are far from the dry ones, on another side of the head, they move less with them.
Settled settled_between(const Strands& dry, const Strands& wet);

// Particle of `n` at one of the places, 0 to doubt_places - 1, at which doubt is measured.
WETCURL_HD constexpr int doubt_particle(int n, int place) { return (n - 1) * (place + 1) / doubt_places; }

class RestCarrier {
  public:
    using S = Pack<float>;
    // `lanes`: the high-resolution strands; `around`: the low-resolution ones around each.
    // `shape` (high strands): how they lie at rest in the head's frame, null: as drawn.
    // `low_is_wet`: the low-resolution strands are curled and shortened by their water too, and are kept as
    // they are. `settled`: they are dry ones, and taken for wet where it puts them.
    // Throws Error where these do not fit.
    RestCarrier(RootLanes lanes, Stencil around, const Groom& high, const Groom& low, const Strands* shape,
                bool low_is_wet = false, const Settled* settled = nullptr);

    const RootLanes& lanes() const { return lanes_; }
    int particles() const { return particles_; }
    // A frame: low (low strands, particles) in the world [m]. One thread calls it, or all of a team, each
    // with the same.
    void follow(const Vec3f* low, const Pose& head);
    // Of the frame followed last, out (particles): offsets of a block's strands in their root frames [m]. Any
    // threads. `doubt`, where given, receives how differently the strands around have moved, at doubt_places
    // of the strand, by its length, and how much they have lost of their own, 0 to 1.
    void carry(int block, Vec3<S>* out, S* doubt = nullptr) const;

    // The strands around each, weighed.
    const Stencil& around() const { return around_; }
    bool low_is_wet() const { return low_is_wet_; }
    RestParticle<float> rest(int strand, int particle) const;
    const std::vector<Beside>& beside() const { return around_.beside; }  // (low strand)
    const Strands& own() const { return own_; }  // (low strand, edge) in the head's frame, by its length
    const Settled& settled() const { return settled_; }  // empty: as they are
    // (high strand, width): what a strand loses of its own is the sum of these by what low-resolution
    // strands lose of theirs, but at least 0 and at most 1.
    const std::vector<float>& lost_weight() const { return lost_weight_; }
    const std::vector<float>& per_low_length() const { return per_low_length_; }  // (low strand) [1/m]

  private:
    void weigh(const Strands& drawn_cores);
    void find_own(const Groom& low, const Strands& drawn_cores);
    void start_from(const Settled& settled);
    float lost_of(int low_strand) const;

    RootLanes lanes_;
    int particles_;
    bool low_is_wet_;
    Stencil around_;
    std::vector<float> lost_weight_;
    std::vector<float> per_low_length_;  // (low strands) [1/m], of stubs less
    std::vector<S> block_length_;        // (block) [m]
    std::vector<RestParticle<S>> rest_;  // (block, particle)
    Strands low_rest_cores_;             // less those of Settled::more
    Strands own_;
    Settled settled_;
    // As blocks read them, (block, lane, width): the strands around, their weights, those of what is lost;
    // and the low-resolution strand that is kept as it is, (block, lane) or -1, where any is.
    std::vector<int> from_, kept_;
    std::vector<float> weight_, lost_share_;

    // Of a frame.
    StrandLanes low_lanes_;
    std::vector<Vec3<S>> offsets_, cores_;  // (low block, particle) in the head's frame [m]
    Strands low_offsets_;                   // (low strands), where any is kept
    Strands moved_;            // (low strands) how far their cores are from rest, in the head's frame, by
                               // their lengths
    std::vector<float> lost_;  // (low strands) of their own, by the squares of their lengths
};

}  // namespace wetcurl

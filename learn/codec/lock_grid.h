// The strands of a network drawn together into locks by Eq 10, on the CPU, a strand a lane: those before it,
// and displayed ones, which a network leaves between the locks that they may end in.
//
// No neighbours are searched: a grid carries what hair is around (cloud in cell, Birdsall and Fuss 1969).
// Some particles of each strand deposit their volume V, their wet volume sigma V, and that times their place,
// at the corners of their cells by trilinear weights. Each is drawn to the mean place of the wet volume that
// other strands left at its corners, by the same weights; its own strand is a part of the volume alone. Two
// particles weigh for each other, in the mean over the grid's place, by a product of cubic splines; the size
// of cells gives it the variance of Eq 10's kernel. The grid stands in the head's frame, so that hair which
// moves with the head finds the same weights in each frame. Differs from Eq 10 in solver/terms/cohesion.h: a
// particle's volume goes by the length of hair that it stands for alone, not by the diameter of a fibre.
#pragma once

#include <vector>

#include "learn/codec/lock_terms.h"
#include "learn/codec/strand_lanes.h"

namespace wetcurl {

class LockGrid {
  public:
    using S = Pack<float>;
    // edges, saturation (strand, particle): how long the edge to a particle is at rest [m], and its water;
    // lanes must outlive it. Throws Error where `terms` are not of Eq 10, or its reach is too small for the
    // hair: a grid of it would not fit the memory.
    LockGrid(LockTerms terms, const RootLanes& lanes, int particles, const std::vector<float>& edges,
             const std::vector<float>& saturation);

    // ---- A frame, in order; `first`: of a run ----
    void begin(bool first) { slot_ = (slot_ + 1) % terms_.frames, first_ = first; }
    // Where a block's strands (particle) are to be put in the world [m], for `take`.
    Vec3<S>* strands(int block) { return &placed_[size_t(block) * particles_]; }
    void take(int block, const Pose& head);
    // When all blocks are taken, by one thread or by all of a team.
    void draw();
    // Then moves a block's `strands`.
    void show(int block, const Pose& head);

  private:
    // At a corner: volume, wet volume, and that times its place; three are not used.
    typedef float Sums __attribute__((vector_size(32)));
    struct Box {  // of whole cells: the lowest corner, and how many corners each way
        int low[3], size[3];
        size_t at(int x, int y, int z) const { return (size_t(x) * size[1] + y) * size[2] + z; }
    };
    struct Extent {
        Vec3<float> low, high;  // [cells]
    };
    int turn_of(int block) const { return block % every_; }
    Vec3<S>* asked(std::vector<Vec3<S>>& of, int block) const { return &of[size_t(block) * count_]; }
    void measure(int block);
    void lay_out();
    void deposit();
    void pull_of_own(int block, Vec3<S>* pull) const;
    void find(int block, float lambda);

    LockTerms terms_;
    const RootLanes& lanes_;
    size_t particles_;
    int every_, count_;            // of a strand's particles every so-manieth is asked, and the tip
    float cell_;                   // [m]
    float most_cells_ = 0;         // from the middle of the head
    std::vector<int> at_;          // (turn, count): which particle
    std::vector<int> before_;      // (turn, particle): it lies between this one of those and the next,
    std::vector<float> after_;     // so much of the way
    std::vector<S> volume_, wet_;  // (block, count): of what each stands for, in lengths of hair [m]
    std::vector<S> beta_;          // (block)
    std::vector<Vec3<S>> placed_;  // (block, particle) [m]
    std::vector<Vec3<S>> from_, now_, by_;  // (block, count) in the head's frame [cells]
    std::vector<Extent> extent_;            // (block) of now_
    Box box_{};
    std::vector<int> slab_;       // (threads + 1): planes of corners that a thread fills
    std::vector<int> corner_at_;  // (corner of the box): its number, 0: none yet
    std::vector<Sums> corners_;   // by number
    std::vector<size_t> place_;   // of a number: its corner of the box
    std::vector<Vec3<S>> drawn_;  // (terms_.frames, round robin; block, count): displacements [cells]
    int slot_ = 0;                // of them, this frame's
    bool first_ = true;
    int numbered_ = 0;  // numbers that were given out
};

}  // namespace wetcurl

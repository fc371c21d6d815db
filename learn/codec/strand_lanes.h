// Strands as vector registers see them on the CPU: a block is a register of strands, a lane a strand.
#pragma once

#include <vector>

#include "base/pack.h"
#include "learn/codec/root_frame.h"

namespace wetcurl {

class StrandLanes {
  public:
    using S = Pack<float>;
    static constexpr int lanes = S::lanes;

    // Strands 0 to count - 1 in their order.
    static StrandLanes in_order(int count);
    // A block holds pixels of one row of the grid, from left to right, and every row begins a block. Throws
    // Error where one of `count` strands has no pixel.
    static StrandLanes on_grid(const RootGrid& grid, int count);

    int blocks() const { return int(holds_.size()); }
    int count() const { return int(place_of_.size()); }
    // Of a lane of a block, -1 where it has none.
    int strand(int block, int lane) const { return strand_[size_t(block) * lanes + lane]; }
    // block * lanes + lane of a strand.
    int place_of(int strand) const { return place_of_[size_t(strand)]; }
    // 1 where a lane has a strand, else 0.
    const S& holds(int block) const { return holds_[size_t(block)]; }

    // columns (count): the block's of rows (strand, count); 0 where a lane has no strand.
    void load(int block, int count, const float* rows, S* columns) const;
    // The way back; a lane without a strand writes nothing.
    void store(int block, int count, const S* columns, float* rows) const;

  private:
    StrandLanes(std::vector<int> strand, int count);

    std::vector<int> strand_;    // (block, lane)
    std::vector<int> place_of_;  // (strand)
    std::vector<S> holds_;       // (block)
};

// With the frames at their roots.
class RootLanes : public StrandLanes {
  public:
    RootLanes(StrandLanes strands, const RootFrames& frames);

    // Of the root frames to the head's; of a lane without a strand the identity.
    const Quat<S>& rotation(int block) const;
    const Vec3<S>& root(int block) const;  // in the head's frame [m]
    // At a head pose: root frames to the world, and roots there.
    Quat<S> rotation_at(int block, const Pose& head) const;
    Vec3<S> root_at(int block, const Pose& head) const;

  private:
    std::vector<Quat<S>> rotation_;  // (block)
    std::vector<Vec3<S>> root_;      // (block)
};

}  // namespace wetcurl

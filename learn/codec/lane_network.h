// A residual network for strands on the CPU, a pixel a lane: what stands between codec and codec
// (learn/codec/strand_codec.h) stays in registers and the nearest caches. LibTorch computes the same, and is
// what a test compares it with (models/strand_mlp.h).
//
// What does not change from frame to frame is multiplied once. Where the processor multiplies bytes, the
// matrices of the blocks are rounded to them, by the largest weight of an output, and what they multiply by
// the largest number of a pixel; all else is in single precision. (Products of bfloat16 were
// no faster than those of single precision on an Intel processor that has both.)
#pragma once

#include <cstdint>
#include <vector>

#include "base/thread_room.h"
#include "learn/codec/crop.h"
#include "learn/codec/strand_lanes.h"
#include "models/strand_layers.h"

namespace wetcurl {

class LaneNetwork {
  public:
    using S = Pack<float>;
    // Blocks that go together, neighbours in a row of the grid; a row's last group may be smaller.
    static constexpr int together = 2;
    struct Group {
        int first, count;  // blocks
        bool seen;         // whether any of its pixels is
    };

    // Whether this processor multiplies bytes.
    static const bool has_bytes;
    // `lanes`: of the grid. `fixed` (block, fixed_inputs): the first inputs, which stay; the others, of a
    // block at a time, are what `begin` gets. `single`: nothing is rounded to bytes. Throws Error where
    // layers and inputs do not fit.
    LaneNetwork(const StrandLayers& layers, const RootGrid& grid, const StrandLanes& lanes, int fixed_inputs,
                const std::vector<S>& fixed, bool single = false);

    // From now on pixels beyond crop.seen are as if they held no strand, and those beyond crop.answered have
    // the answer 0.
    void crop(const Crop& crop);

    // All of the grid.
    const std::vector<Group>& groups() const { return groups_; }
    // A frame: `prepare` by one thread; then, by one or by all of a team, `begin` for each group, `run`, and
    // `end` for each group, with a barrier between these.
    void prepare() { room_.require(3 * size_t(together) * size_t(channels_)); }
    // input (block of the group, inputs that do not stay).
    void begin(const Group& group, const S* input);
    void run();
    // answer (block of the group, outputs).
    void end(const Group& group, S* answer);

  private:
    // Of the outputs that are computed at once, `tile` of them side by side: (outputs / tile, inputs, tile).
    using Panels = std::vector<float>;
    // The same of bytes, four inputs in an integer: weight = scale * byte.
    struct Bytes {
        std::vector<int32_t> panels;  // (outputs / tile, inputs / 4, tile)
        std::vector<float> scale;     // (outputs)
        std::vector<int32_t> sum;     // (outputs) of an output's bytes
    };
    struct Dense {
        Panels panels;
        Bytes bytes;  // in place of the panels
        std::vector<float> bias;
    };
    struct Block {
        std::vector<float> around;  // (channels, kernel, kernel); empty: no look around
        Dense in, out;
    };
    Dense dense_of(const StrandLayers::Dense& layer) const;
    static Bytes bytes_of(const std::vector<float>& weight, int outputs, int inputs);
    // end(output, block, bias + sum) over in (block, channels); `positive`: so is what is in. room (block,
    // channels / 4).
    template <int count, class End>
    void multiply_dense(const Dense& layer, bool positive, const S* in, S* room, End end) const;
    template <int count>
    void begin_group(int block, const S* input);
    template <int count>
    void run_group(int block, const Block& layer, const float* from, float* to);
    template <int count>
    void end_group(int block, S* answer);
    // x of a channel at the first pixel of a block.
    size_t at(int block, int channel) const;

    bool in_bytes_;
    int channels_, outputs_, inputs_;  // inputs that do not stay
    int height_, row_blocks_;
    size_t stride_;         // of a channel's part of a row
    std::vector<S> start_;  // (block, channels): the first layer of what stays
    Panels first_, last_;
    std::vector<float> last_bias_;
    std::vector<Block> blocks_;
    std::vector<S> strands_, seen_, answered_;  // (block) 1 or 0 for a pixel: holds a strand, as Crop
    std::vector<Group> groups_;
    // (row and two beyond either end, channel, pixel and zeros after the last) of two layers in turn.
    std::vector<float> x_[2];
    ThreadRoom<S> room_;
};

}  // namespace wetcurl

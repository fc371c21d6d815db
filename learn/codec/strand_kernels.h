// The strand codec on a CUDA device, what of it is no matrix product. No torch here.
// The same formulas as learn/codec/carried_rest.h and learn/codec/strand_codec.cpp.
//
// A strand is a pixel of the root grid, S of them; one that holds none has only zeros. Interleaved:
// neighbours in memory are neighbours on the grid.
#pragma once

#include <cuda_runtime.h>

#include "base/device_buffer.h"
#include "learn/codec/head_state.h"
#include "learn/codec/learned_strands.h"

namespace wetcurl {

// RestParticle in whole numbers of a strand's units: half the bytes, to 2^-16 of the largest along the
// strand. `curled`, of which the direction alone counts, is as long as `length` says.
struct alignas(16) RestEdge {
    int16_t edge[3], curled[3], own_xy[2];
};
struct alignas(8) RestDetail {
    int16_t detail[3], own_z;
};
struct alignas(16) RestUnits {
    float edge, curled, detail, own;
};

class StrandKernels {
  public:
    // Copies what it needs to the current device.
    StrandKernels(const StrandCodec& codec, const Groom& low);

    int particles() const { return n_; }
    int low_strands() const { return low_; }
    int high_strands() const { return high_; }
    int pixels() const { return pixels_; }

    // (strand_channels, S): the network's input, its static channels filled.
    float* image() const { return image_.data(); }
    // Before each frame.
    void begin_frame(const HeadWindow& heads, bool first);
    HeadState& head() const { return head_host_[0]; }

    // Strands are moved out of these and led around them from now on.
    void keep_outside(const HeadShapes& head);

    // In this order, all on `stream`: the head to the device; X from world positions; M, how far their cores
    // are; the base B, offsets in root frames, and its amplitudes in the image; the other dynamic channels;
    // (the network); the mean of its answers and those before; world positions (high, n).
    void take_head(cudaStream_t stream) const;
    void depart(const Vec3f* low, cudaStream_t stream) const;
    void move_cores(cudaStream_t stream) const;
    void carry(cudaStream_t stream) const;
    void describe(cudaStream_t stream) const;
    // Returns the mean of `answer` and of those of the frames before (StrandCodec::averaged), in memory of
    // this; both (S, strand_outputs), 16 bytes aligned.
    const float* average(const float* answer, cudaStream_t stream) const;
    // Of B and what the network answered: (S, strand_outputs), 16 bytes aligned, null: nothing. So many
    // rounds lead edges toward their lengths.
    // `within_shapes`: where they are, even in what is attached to the head.
    void place(const float* answer, int rounds, Vec3f* out, cudaStream_t stream,
               bool within_shapes = false) const;

  private:
    void take_rest(const StrandCodec& codec);
    // (high strand, particle) to (n, S), 0 where there is no strand.
    DeviceBuffer<float> by_pixels(const std::vector<float>& of_particles,
                                  const std::vector<int>& strand) const;
    float* dynamic() const { return image_.data() + size_t(static_channels) * pixels_; }

    int n_, low_, high_, pixels_, width_;
    std::array<int, history_lags.size()> lags_;  // [frames]
    int slots_, averaged_;
    PinnedBuffer<HeadState> head_host_{1};
    DeviceBuffer<HeadState> head_{1};
    DeviceBuffer<Vec3f> low_start_;           // (low, n) offsets at rest from the root, less Settled::more
    DeviceBuffer<int> kept_;                  // (S): low-resolution strand that is kept as it is, or -1
    DeviceBuffer<float4> low_rest_;           // (n, low): of those, offsets at rest, in the head's frame
    DeviceBuffer<float> share_;               // (low): Settled::share, else 1
    DeviceBuffer<RestUnits> units_;           // (S)
    DeviceBuffer<RestEdge> edges_;            // (n, S)
    DeviceBuffer<RestDetail> details_;        // (n, S)
    DeviceBuffer<int> from_;                  // (width, S)
    DeviceBuffer<float> weight_;              // (width, S)
    DeviceBuffer<float> lost_weight_;         // (width, S)
    DeviceBuffer<Beside> beside_;             // (low)
    DeviceBuffer<float> per_low_length_;      // (low) [1/m]
    DeviceBuffer<float4> own_;                // (n, low): edges in the head's frame
    DeviceBuffer<float> lost_;                // (low)
    DeviceBuffer<Quatf> turn_;                // (S): root frame to the head's
    DeviceBuffer<Vec3f> root_;                // (S): in the head's frame
    DeviceBuffer<float> strand_length_;       // (S): L [m]
    DeviceBuffer<float> per_length_, swing_;  // (S): 1 / L, T [s]
    DeviceBuffer<int> strand_;                // (S): of the pixel, or -1
    std::vector<DeviceBuffer<float>> grids_;  // of level sets
    DeviceBuffer<ShapeView> shapes_;          // attached to the head
    DeviceBuffer<float> depth_;               // (n, S), as of HeadShapes
    DeviceBuffer<float> length_;              // (n, S): of the edge to a particle at rest
    DeviceBuffer<unsigned char> torn_;        // (S)
    DeviceBuffer<float> past_;                // (slots, past_layout.count, S)
    DeviceBuffer<float4> answers_;            // (averaged_, S, 18), round robin
    DeviceBuffer<float4> mean_;               // (S, strand_outputs / 4)
    DeviceBuffer<float> amplitudes_;          // (n, 24): of unit offsets
    DeviceBuffer<float> offsets_;             // (n, 24): of unit amplitudes
    // (n, low): X, how far the low strands are from rest, and M, how far their cores are; the fourth numbers
    // are 0.
    DeviceBuffer<float4> departed_, moved_;
    DeviceBuffer<float> image_;
    DeviceBuffer<float> base_;  // (3, n, S): B
};

}  // namespace wetcurl

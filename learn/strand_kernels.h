// The strand codec on a CUDA device, what of it is no matrix product. No torch here.
// Ours. The same formulas as learn/carried_rest.h and learn/strand_codec.cpp; what is linear there (cores,
// amplitudes) is left to matrix products between the kernels: cores = F X, amplitudes = E B.
//
// A strand is a pixel of the root grid, S of them; one that holds none has only zeros. Interleaved:
// neighbours in memory are neighbours on the grid.
#pragma once

#include <cuda_runtime.h>

#include "base/device_buffer.h"
#include "learn/learned_strands.h"

namespace wetcurl {

// What a frame brings, but for the strands; in the head's frame, but for the pose.
struct HeadState {
    Quatf rotation;          // head to world
    Vec3f translation;       // [m]
    Vec3f gravity, turning;  // [m/s^2], [rad/s]
    Vec3f pull, pull_x[3];   // acceleration of the point x: pull + sum_a pull_x[a] x_a [m/s^2]
    int first;               // whether there is no frame before
    int slot = 0;            // of the past, which is a ring, the frame's
    HeadState() = default;
    HeadState(const HeadWindow& heads, bool first);
};

class StrandKernels {
  public:
    // Copies what it needs to the current device.
    StrandKernels(const StrandCodec& codec, const Groom& low);

    int particles() const { return n_; }
    int low_strands() const { return low_; }
    int high_strands() const { return high_; }
    int pixels() const { return pixels_; }

    // Of the matrix products, on the device: F (n, n), E (24, n), row-major.
    const float* cores() const { return cores_.data(); }
    const float* amplitudes() const { return amplitudes_.data(); }
    // X (3, n, low): how far the low strands are from rest; M (3, n, low) = F X: how far their cores are.
    float* departed() const { return departed_.data(); }
    float* moved() const { return moved_.data(); }
    // B (3, n, S): the base, offsets in root frames.
    float* base() const { return base_.data(); }
    // (238, S): the network's input, its static channels filled.
    float* image() const { return image_.data(); }
    // Before each frame.
    void begin_frame(const HeadWindow& heads, bool first);
    HeadState& head() const { return head_host_[0]; }

    // Strands are moved out of these from now on.
    void keep_outside(const HeadShapes& head);

    // In this order, all on `stream`: the head to the device; X from world positions; (M = F X); B; (E B into
    // the image); the other dynamic channels; (the network); world positions (high, n).
    void take_head(cudaStream_t stream) const;
    void depart(const Vec3f* low, cudaStream_t stream) const;
    void carry(cudaStream_t stream) const;
    void describe(cudaStream_t stream) const;
    // Of B and what the network answered: amplitudes (S, 72), null: nothing. `within_shapes`: where they are,
    // even in what is attached to the head.
    void place(const float* answer, Vec3f* out, cudaStream_t stream, bool within_shapes = false) const;

  private:
    int n_, low_, high_, pixels_, width_;
    bool low_is_wet_;
    PinnedBuffer<HeadState> head_host_{1};
    DeviceBuffer<HeadState> head_{1};
    DeviceBuffer<Vec3f> low_rest_;            // (low, n) offsets from the root, in the head's frame
    DeviceBuffer<Vec3f> low_start_;           // the same, less Settled::more
    DeviceBuffer<float> share_;               // (low): Settled::share, else 1
    DeviceBuffer<float> rest_;                // (n, 13, S): RestParticle
    DeviceBuffer<int> from_;                  // (width, S)
    DeviceBuffer<float> weight_;              // (width, S)
    DeviceBuffer<float> lost_weight_;         // (width, S)
    DeviceBuffer<Beside> beside_;             // (low)
    DeviceBuffer<float> own_;                 // (3, n, low): edges in the head's frame
    DeviceBuffer<float> lost_;                // (low)
    DeviceBuffer<Quatf> turn_;                // (S): root frame to the head's
    DeviceBuffer<Vec3f> root_;                // (S): in the head's frame
    DeviceBuffer<int> strand_;                // (S): of the pixel, or -1
    DeviceBuffer<int> twin_;                  // (low): pixel
    std::vector<DeviceBuffer<float>> grids_;  // of level sets
    DeviceBuffer<ShapeView> shapes_;          // attached to the head
    DeviceBuffer<float> depth_;               // (n, S)
    DeviceBuffer<float> past_;                // (9, 18, S)
    DeviceBuffer<float> cores_, amplitudes_, offsets_, departed_, moved_, base_, image_;
};

}  // namespace wetcurl

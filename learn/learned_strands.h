// Learned wet strands, frame by frame: load, bind input and output, run. What a program includes that runs a
// strand network beside its own simulation; no torch here.
// Ours.
#pragma once

#include <memory>

#include "learn/network.h"
#include "learn/strand_codec.h"

namespace wetcurl {

class LearnedStrands {
  public:
    virtual ~LearnedStrands() = default;
    virtual const ModelCard& card() const = 0;
    // Where the frames lie: low (low strands, particles) world positions of the dry low-resolution strands
    // [m], out (high strands, particles) the wet ones; both in the host's memory, or both in that of the CUDA
    // device it runs on, where nothing is copied then. Throws Error where the device is another's.
    virtual void bind(const Vec3f* low, Vec3f* out, bool on_device = false) = 0;
    // One frame, from `low` to `out`; returns when it is there. For every frame of a run, in order. Nothing
    // is allocated from the second frame on (CUDA; on the CPU LibTorch keeps what it needs for itself).
    virtual void run(const HeadWindow& heads) = 0;
    // The next frame is the first of another run.
    virtual void restart() = 0;
    // The frame run last, had the network said nothing: (high strands, particles), world [m].
    virtual Strands base(const Pose& head) = 0;
};

// On the CPU; the network alone may run elsewhere. Throws Error where network and codec do not fit.
std::unique_ptr<LearnedStrands> learned_strands(std::unique_ptr<Network> network, StrandCodec codec);

// Throws Error unless the card's network takes the codec's inputs.
void require_inputs_of_codec(const ModelCard& card);

}  // namespace wetcurl

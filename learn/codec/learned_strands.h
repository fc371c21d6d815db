// Learned wet strands, frame by frame: load, bind input and output, run. What a program includes that runs a
// strand network beside its own simulation; no torch here.
#pragma once

#include <memory>
#include <vector>

#include "base/device_stream.h"
#include "learn/codec/edge_lengths.h"
#include "learn/codec/head_shapes.h"
#include "learn/codec/lock_terms.h"
#include "learn/codec/network.h"
#include "learn/codec/strand_codec.h"

namespace wetcurl {

class LearnedStrands {
  public:
    virtual ~LearnedStrands() = default;
    virtual const ModelCard& card() const = 0;
    // From now on strands are moved out of these and led around them, edges of more than about twice their
    // length shortened to that; roots stay. For networks of displayed strands and for locks: elsewhere Eq 10
    // by neighbours follows, and does the same. Throws Error where depths are not one a particle.
    virtual void keep_outside(const HeadShapes& head) = 0;
    // From now on edges are led toward their lengths at rest in so many rounds (learn/codec/edge_lengths.h),
    // 0 to most_length_rounds; until then in length_rounds_of(card()). Throws Error on other numbers.
    virtual void lead_edges(int rounds) = 0;
    // From now on strands are drawn together after the network's answer, before they are kept outside
    // (learn/codec/lock_grid.h). saturation (high
    // strand, particle). Throws Error on a CUDA device, and as LockGrid does.
    virtual void draw_together(const LockTerms& terms, const std::vector<float>& saturation) = 0;
    // From now on the network is asked for the smallest rectangle of the root grid alone that holds the
    // strands wanted, (high strands) 0 or 1; beyond it strands are `base`. In it nothing changes: it still
    // sees what is around. Throws Error for a network that looks at the whole grid.
    virtual void crop(const std::vector<uint8_t>& wanted) = 0;
    // Where the frames lie: low (low strands, particles) world positions of the dry low-resolution strands
    // [m], out (high strands, particles) the wet ones; both in the host's memory, or both in that of the CUDA
    // device it runs on, where nothing is copied then. Throws Error where the device is another's.
    virtual void bind(const Vec3f* low, Vec3f* out, bool on_device = false) = 0;
    // One frame, from `low` to `out`; returns when it is there. For every frame of a run, in order, at the
    // rate that the network learned from. Throws Error where `low` is not finite in the host's memory; on a
    // device what writes it must be through. Nothing is allocated from the third frame on (CUDA; on the CPU
    // from the second on, for networks with strand_layers(): for others LibTorch keeps what it needs for
    // itself).
    virtual void run(const HeadWindow& heads) = 0;
    // The same begun, where they are bound on a device: what follows on this stream finds the strands there.
    // Throws Error where they are bound in the host's memory.
    virtual DeviceStream begin(const HeadWindow& heads) = 0;
    // The next frame is the first of another run.
    virtual void restart() = 0;
    // How many frames before one it depends on.
    virtual int memory() const = 0;
    // The frame run last, had the network said nothing, wherever the head is: (high strands, particles),
    // world [m].
    virtual Strands base(const Pose& head) = 0;
    // Of the frame run last, how far from the simulation each piece of a strand is expected to be on average,
    // root first: (high strands, error_pieces) [m].
    virtual std::vector<float> expected_errors() = 0;
    // Of the frame run last, what the network saw: (high strands, strand_channels).
    virtual std::vector<float> inputs() = 0;
};

// On the CPU; a network without strand_layers() may run elsewhere. `body`: of those with them; others have
// been made with theirs. Throws Error where network and codec do not fit.
std::unique_ptr<LearnedStrands> learned_strands(std::unique_ptr<Network> network, StrandCodec codec,
                                                Body body = Body::fastest);

// All there are, but one for displayed strands: their edges are shorter than at rest, if Eq 10 does not
// follow.
int length_rounds_of(const ModelCard& card);
// Throws Error unless there are so many rounds.
void require_rounds(int rounds);
// What a network answers of errors (strand, error_pieces), in metres; pixel_of (strand), length (pixel) [m].
std::vector<float> in_metres(std::vector<float> answered, const std::vector<int>& pixel_of,
                             const std::vector<float>& length);
// Throws Error unless the card's network takes what the codec gives.
void require_fit(const ModelCard& card, const StrandCodec& codec);
// Throws Error, naming strand and particle, where one of `count` positions is not finite.
void require_finite(const Vec3f* low, size_t count, int particles);

}  // namespace wetcurl

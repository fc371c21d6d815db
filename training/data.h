// What a training step sees: batches drawn from pairs files, in an order that (seed, epoch) alone decides, so
// that a resumed training draws what the uninterrupted one would have. Ours; patches as in section V, 1:1
// sampling of contact and free particles as in section IV.D.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/ranks.h"
#include "learn/codec/pairs.h"
#include "models/layers.h"
#include "models/model_card.h"
#include "training/recipe.h"

namespace wetcurl {

// Single precision; of codecs strand and root on the training's device, of codec adhesion on the CPU.
struct Batch {
    Tensor input;   // strand (P, C, 1, 1): masked pixels, or for a network that sees neighbours whole frames
                    // (B, C, H, W); root (B, 3, h, w); adhesion (n, 12, 1, 1)
    Tensor target;  // strand (P, 72, 1, 1); root (B, 3, 2h, 2w); adhesion (n, 1, 1, 1)
    // strand (P, 72): amplitudes of the base; root (B, 3, 2h, 2w): up(input); adhesion: F.n before
    Tensor base;
    // Root (B, 1, 2h, 2w): 1 where a strand is; adhesion, held out (n, 1, 1, 1): 1 in contact.
    Tensor mask;
    Tensor pixels;             // strand, whole frames with holes: (P) which of the B H W pixels hold a strand
    Tensor length{};           // strand (P, 1) [m], by which its target, base and answer are told
    Tensor relative_length{};  // strand (P, 1): that length over the mean of its run's, which is a scene's
    // Strand: whether the second half of the rows are those of the first a frame later.
    bool in_pairs = false;
    Batch to(torch::Device device) const;
    bool empty() const { return !target.defined(); }
};

class TrainingData {
  public:
    virtual ~TrainingData() = default;
    // Fills what a model of these data must know: channels, particles, arrays.
    virtual void describe(ModelCard& card) const = 0;
    // Draws the order of an epoch.
    virtual void begin_epoch(long epoch) = 0;
    virtual long steps() const = 0;  // an epoch
    // 0 ≤ step < steps(). Of several processes each sees every so many of the batch's samples, all of them
    // together what one would see; it may be empty.
    virtual Batch batch(long step) const = 0;
    virtual long validation_batches() const = 0;  // of held-out data; 0: none is held out
    virtual Batch validation_batch(long i) const = 0;
    // Codec root: diagonal of the box [m]; others: 1.
    virtual double unit() const = 0;

    Ranks ranks;

  protected:
    // Where in an epoch's order of `count` samples this process's share of a step's batch lies.
    std::vector<long> share(long step, double batch, size_t count) const;
};

// The first `trained` of the files are trained on; the others are held out, in place of the last frames of
// each run (codecs strand and root). Throws Error where the files disagree, hold a value that is not finite,
// or too little to train on.
std::unique_ptr<TrainingData> open_data(const std::vector<PairsReader*>& pairs, size_t trained,
                                        const Recipe& recipe, torch::Device device, const Ranks& ranks = {});

}  // namespace wetcurl

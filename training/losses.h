// What training minimises, one a codec, and the distances that it reports.
// Strand: docs/method.md, section 7. Root: Eq 17, the mean over the pixels that hold a strand. Adhesion:
// Eq 20.
#pragma once

#include <memory>

#include "training/data.h"

namespace wetcurl {

class Loss {
  public:
    virtual ~Loss() = default;
    // A scalar, the mean over the batch. `output`: what the model gave for batch.input.
    virtual Tensor of(const Tensor& output, const Batch& batch) const = 0;
    // The output of no network at all: interpolation (strand, root), the force of the step before (adhesion).
    virtual Tensor base_output(const Batch& batch) const = 0;
    // Mean distance to the target [m]; undefined where the codec has no positions.
    virtual Tensor distance(const Tensor& output, const Batch& batch) const = 0;
    // How much a batch counts in a mean over batches: its strands, pixels, samples.
    virtual double count(const Batch& batch) const = 0;
};

// `unit` of TrainingData.
std::unique_ptr<Loss> make_loss(Codec codec, const Recipe& recipe, int particles, double unit,
                                torch::Device device);

}  // namespace wetcurl

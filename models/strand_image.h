// The paper's networks on the strand codec: at the resolution of the roots, over all inputs of a pixel.
#pragma once

#include "models/layers.h"

namespace wetcurl {

// ImageNetwork: UnetVgg19 or RecursiveResidual. Any grid fits.
template <class ImageNetwork>
class StrandImage : public TorchNetwork {
  public:
    // `mean`, `deviation` (C) and `scale` (outputs) as of StrandMlp.
    StrandImage(double width, const Tensor& mean, const Tensor& deviation, const Tensor& scale)
        : mean_(register_buffer("mean", mean)),
          deviation_(register_buffer("deviation", deviation)),
          scale_(register_buffer("scale", scale)),
          image_(register_module("image",
                                 std::make_shared<ImageNetwork>(
                                     width, ImageChannels{int(mean.size(0)), int(scale.size(0)), false}))) {}

    // As of StrandMlp; pixels whose inputs are all 0 hold no strand and come in as 0.
    Tensor forward(const Tensor& input) override {
        const Tensor rows = to_rows(input);
        Tensor known = normalised(rows, mean_, deviation_, body);
        if (!whole_grid) known = known * rows.ne(0).any(1, true).to(body);
        image_->body = body;
        return image_->residual(from_rows(known, input)) * scale_.view({1, -1, 1, 1});
    }

  private:
    Tensor mean_, deviation_, scale_;  // stored with the card, not with the weights
    std::shared_ptr<ImageNetwork> image_;
};

}  // namespace wetcurl

// Whole strands: by interpolation, or by a strand network.
#include <filesystem>

#include "app/engine/learned_hair.h"
#include "app/inference/predictor.h"
#include "base/network_channels.h"
#include "learn/codec/encode_runs.h"
#include "solver/scene/rest_state.h"

namespace wetcurl {

namespace {

class Interpolated final : public Predictor {
  public:
    Interpolated(const InterpolationMethod& method, const PredictionInput& input, const Strands* shape)
        : name_(method.name + " interpolation" + suffix_of(method.roots) +
                (method.settled ? ", settled" : "") + (shape ? ", Eq 9" : "") +
                (input.clumps ? ", Eq 10" : "")),
          interpolator_(method.kind, stencil_of(method.roots, input.scene.groom, input.low.groom),
                        input.scene.groom, input.low.groom, shape, simulated_wet(input.low), input.settled),
          clumps_(input.clumps) {}
    std::string name() const override { return name_; }
    void apply(int, const RunFrame& low, const HeadWindow&, Strands& p) override {
        interpolator_.apply(clumps_ ? low.positions : low.seen(), low.head, p);
    }

  private:
    std::string name_;
    Interpolator interpolator_;
    bool clumps_;
};

class NetworkStrands final : public Predictor {
  public:
    NetworkStrands(const StrandNetworkMethod& method, const PredictionInput& input)
        : learned_(learned_strands_of(method.model, input.scene, input.scene_file, input.low.groom,
                                      input.device, input.threads, input.settled)),
          name_(method.card.architecture + " " + std::filesystem::path(method.model).stem().string() +
                (method.settled ? ", settled" : "") + (method.crop ? ", cropped" : "") +
                (input.clumps ? ", Eq 10" : "")),
          low_(input.low.groom.rest),
          out_(input.scene.groom.rest) {
        if (method.crop) learned_->crop(wet_strands_of(input.scene));
        if (input.clumps) learned_->lead_edges(most_length_rounds);
        learned_->bind(low_.points.data(), out_.points.data());
    }
    std::string name() const override { return name_; }
    void apply(int, const RunFrame& low, const HeadWindow& heads, Strands& p) override {
        std::copy(low.positions.points.begin(), low.positions.points.end(), low_.points.begin());
        learned_->run(heads);
        p = out_;
    }
    int memory() const override { return history_lags.back(); }
    Strands without_network(const RunFrame& low) override { return learned_->base(low.head); }

  private:
    std::unique_ptr<LearnedStrands> learned_;
    std::string name_;
    Strands low_, out_;  // where the network reads and writes
};

}  // namespace

std::string suffix_of(int roots) { return roots == 3 ? ", 3 roots" : ""; }
Stencil stencil_of(int roots, const Groom& high, const Groom& low) {
    return roots == 3 ? triangle_stencil(high, low) : quad_stencil(high, low);
}

std::unique_ptr<Predictor> predictor_of(const InterpolationMethod& method, const PredictionInput& input) {
    const Strands shape = method.wet_shape ? shape_at_rest(input.scene) : Strands();
    return std::make_unique<Interpolated>(method, input, method.wet_shape ? &shape : nullptr);
}

std::unique_ptr<Predictor> predictor_of(const StrandNetworkMethod& method, const PredictionInput& input) {
    return std::make_unique<NetworkStrands>(method, input);
}

}  // namespace wetcurl

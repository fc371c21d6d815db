// A trained network in Eq 11's place.
#include "app/engine/network_adhesion.h"

#include "learn/codec/network_module.h"

namespace wetcurl {

namespace {

class NetworkAdhesion final : public AdhesionPredictor {
  public:
    explicit NetworkAdhesion(std::unique_ptr<Network> network)
        : network_(std::move(network)), layers_(network_->layers()) {}
    void evaluate(const float* inputs, size_t count, float* outputs) override {
        network_->run(inputs, {long(count), AdhesionFeatures::inputs, 1, 1}, outputs);
    }
    const DenseLayers* layers() const override { return layers_ ? &*layers_ : nullptr; }

  private:
    std::unique_ptr<Network> network_;
    std::optional<DenseLayers> layers_;
};

}  // namespace

std::unique_ptr<AdhesionPredictor> adhesion_predictor_of(const Scene& scene, int threads) {
    if (scene.adhesion_model.empty()) return nullptr;
    auto network = network_module().load(scene.adhesion_model, "cpu", threads);
    if (network->card().codec != "adhesion")
        throw Error(scene.adhesion_model + ": found a model of codec '" + network->card().codec +
                    "', [adhesion] needs 'adhesion'");
    return std::make_unique<NetworkAdhesion>(std::move(network));
}

}  // namespace wetcurl

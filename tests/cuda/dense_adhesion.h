// A network in Eq 11's place that is nothing but dense layers, its weights drawn.
#pragma once

#include "solver/adhesion/adhesion_network_coupling.h"
#include "tests/base/scratch.h"

namespace wetcurl::testing {

// As wide as the released one.
inline DenseLayers drawn_layers(unsigned seed) {
    Random random(seed);
    std::vector<float> numbers(142);
    for (float& a : numbers) a = float(random.number(-0.6, 0.6));
    return {{AdhesionFeatures::inputs, 6, 5, 4, 1}, numbers};
}

struct DenseAdhesion : AdhesionPredictor {
    DenseLayers all;
    bool gives_layers;
    size_t asked = 0;  // on the host
    float largest = 0;
    explicit DenseAdhesion(unsigned seed, bool gives_layers = true)
        : all(drawn_layers(seed)), gives_layers(gives_layers) {}
    void evaluate(const float* inputs, size_t count, float* outputs) override {
        for (size_t k = 0; k < count; ++k) {
            outputs[k] = all.evaluate(inputs + k * AdhesionFeatures::inputs);
            largest = std::max(largest, std::abs(outputs[k]));
        }
        asked += count;
    }
    const DenseLayers* layers() const override { return gives_layers ? &all : nullptr; }
};

}  // namespace wetcurl::testing

// A small network of dense layers with LeakyReLU between them and one answer, as plain numbers: for any
// device, without LibTorch.
#pragma once

#include <vector>

#include "base/host_device.h"

namespace wetcurl {

// Where its numbers lie in whatever memory.
struct DenseView {
    static constexpr int widest = 16, most_layers = 8;
    static constexpr float slope = 0.01f;  // of LeakyReLU below 0: LibTorch's own
    int sizes[most_layers + 1], layers;
    const float* numbers;

    WETCURL_HD float evaluate(const float* inputs) const {
        float values[2][widest];
        const float *from = inputs, *weight = numbers;
        for (int layer = 0; layer < layers; ++layer) {
            const int in = sizes[layer], out = sizes[layer + 1];
            const float* const bias = weight + in * out;
            float* const to = values[layer % 2];
            for (int o = 0; o < out; ++o) {
                float sum = bias[o];
                for (int i = 0; i < in; ++i) sum += *weight++ * from[i];
                to[o] = sum < 0 && layer + 1 < layers ? slope * sum : sum;
            }
            weight += out, from = to;
        }
        return from[0];
    }
};

class DenseLayers {
  public:
    // `sizes`: of the input, then of each layer's output. `numbers`: of each layer its weights (out, in),
    // then its biases (out). Throws Error where they do not fit each other or a DenseView.
    DenseLayers(std::vector<int> sizes, std::vector<float> numbers);
    int inputs() const { return sizes_.front(); }
    const std::vector<float>& numbers() const { return numbers_; }
    // Of a copy of the numbers.
    DenseView view(const float* numbers) const;
    float evaluate(const float* inputs) const { return view(numbers_.data()).evaluate(inputs); }

  private:
    std::vector<int> sizes_;
    std::vector<float> numbers_;
};

}  // namespace wetcurl

// A residual network for strands as plain numbers, for any device, without LibTorch: what
// models/strand_mlp.cpp computes.
#pragma once

#include <vector>

namespace wetcurl {

// x = first(input), then for each block x += out(relu(in(x + around(x)))), then scale last(relu(x)). A pixel
// that holds no strand counts as 0 where others look around. Matrices are (outputs, inputs), row-major.
struct StrandLayers {
    static constexpr int kernel = 5;  // of the look around, each way
    struct Dense {
        std::vector<float> weight, bias;
    };
    struct Block {
        std::vector<float>
            around;     // (channels, kernel, kernel), of each channel by itself; empty: no look around
        Dense in, out;  // (channels, channels)
    };
    int inputs = 0, channels = 0, outputs = 0;
    std::vector<float> mean, deviation;  // of the inputs: a network sees (input - mean) / deviation
    Dense first;                         // (channels, inputs)
    std::vector<Block> blocks;
    Dense last;                // (outputs, channels)
    std::vector<float> scale;  // (outputs)

    // Pixels around one that its output depends on.
    int reach() const {
        int sum = 0;
        for (const Block& block : blocks) sum += block.around.empty() ? 0 : kernel / 2;
        return sum;
    }
};

}  // namespace wetcurl

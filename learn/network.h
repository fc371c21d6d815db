// A trained network behind one narrow interface: load once, run many. No torch here.
// Ours.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

namespace wetcurl {

// What a model file says of itself.
struct ModelCard {
    std::string codec;         // root | strand | adhesion
    std::string architecture;  // a name of models/registry.h
    double width = 1;          // channel multiplier
    int input_channels = 0, output_channels = 0;
    int upscale = 1;    // output pixels per input pixel, each way
    int particles = 0;  // of a strand (codec strand), else 0
    long parameters = 0;
    std::map<std::string, double> numbers;  // validation error, steps… and the pairs' own numbers
    // input_mean, input_std, output_scale (applied inside the network); everything that lies beside the runs in
    // the pairs file: b_min, b_max, a saturation profile…
    std::map<std::string, std::vector<float>> arrays;
    std::string recipe;  // the resolved recipe, TOML
    std::string inputs;  // "file hash" of what it was trained on, one a line
};

class Network {
  public:
    virtual ~Network() = default;
    virtual const ModelCard& card() const = 0;
    // input (B, C, H, W), row-major in host memory, C = card().input_channels, in the units of the pairs file:
    // normalisation happens inside. output (B, card().output_channels, H * upscale, W * upscale), allocated by the
    // caller: codec root gives the colours up(input) + residual (Eq 17; any H, W: the network pads to its multiple of
    // 32 and crops), codec strand the residual coefficients [m] over the base, codec adhesion the scaled F.n.
    // Per-strand and per-particle networks take any grid, (P, C, 1, 1) for P masked pixels too; the latter costs
    // no transposition. Throws Error for a wrong C. Not for two threads at once.
    virtual void run(const float* input, std::array<long, 4> shape, float* output) = 0;
};

}  // namespace wetcurl

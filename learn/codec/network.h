// A trained network behind one narrow interface: load once, run many. No torch here.
#pragma once

#include <array>
#include <optional>

#include "base/dense_layers.h"
#include "models/model_card.h"
#include "models/strand_layers.h"

namespace wetcurl {

// What a network's body computes in. `fastest`: half precision on a CUDA device; on processors that multiply
// in them bytes, for strand networks (learn/codec/lane_network.h), or bfloat16; codec adhesion: single
// precision.
enum class Body { fastest, single_precision };

class Network {
  public:
    virtual ~Network() = default;
    virtual const ModelCard& card() const = 0;
    // input (B, C, H, W), row-major in host memory, C = card().input_channels, in the units of the pairs
    // file: normalisation happens inside. output (B, card().output_channels, H * upscale, W * upscale),
    // allocated by the caller: codec root gives the colours up(input) + residual (Eq 17; any H, W: the
    // network pads to its multiple of 32 and crops), codec strand the residual coefficients [m] over the
    // base, codec adhesion the scaled F.n. Per-strand and per-particle networks take any grid, (P, C, 1, 1)
    // for P masked pixels too; the latter costs no transposition. `on_device`: both lie in the memory of the
    // CUDA device that the network runs on, and what writes the input is through. Throws Error for a wrong C.
    // Not for two threads at once.
    virtual void run(const float* input, std::array<long, 4> shape, float* output,
                     bool on_device = false) = 0;
    // How many pixels around one its output depends on; below 0: all there are.
    virtual int reach() const = 0;
    // The same function of a pixel's channels, normalisation included, where the network is nothing but dense
    // layers with LeakyReLU between them and one output.
    virtual std::optional<DenseLayers> layers() const = 0;
    // The same function, where the network is a residual one for strands.
    virtual std::optional<StrandLayers> strand_layers() const { return std::nullopt; }
};

}  // namespace wetcurl

// What the networks share: the base of a model, its layers in either precision, the up() of the residual.
// Ours, but up(): Eq 17, vertex-aligned.
#pragma once

#include <torch/nn/init.h>
#include <torch/nn/modules/container/modulelist.h>
#include <torch/nn/modules/conv.h>
#include <torch/nn/modules/linear.h>
#include <torch/types.h>

#include <optional>
#include <vector>

#include "base/dense_layers.h"
#include "base/network_channels.h"
#include "models/strand_layers.h"

namespace wetcurl {

using torch::Tensor;

// A network as LibTorch sees it; what the rest of the program sees is a Network (learn/codec/network.h).
struct TorchNetwork : torch::nn::Module {
    // (B, C, H, W) to (B, output_channels, upscale * H, upscale * W), single precision in and out.
    virtual Tensor forward(const Tensor& input) = 0;
    // The same function of a pixel, where nothing but dense layers makes it.
    virtual std::optional<DenseLayers> dense_layers() const { return std::nullopt; }
    // The same function, where it is that of a residual network for strands.
    virtual std::optional<StrandLayers> strand_layers() const { return std::nullopt; }
    // How many pixels around one its output depends on; below 0: all there are.
    virtual int reach() const { return -1; }
    // For inference alone: the weights of the body take its type and the order of the device's convolutions,
    // which they are else brought into at each run.
    virtual void freeze();
    // The type that the body computes in; weights, first and last values stay in single precision, until
    // frozen.
    torch::ScalarType body = torch::kFloat;
    // Strand networks: whether every pixel holds a strand, so that no look for those that do not is needed.
    bool whole_grid = false;
};

// What an image network takes and gives: channels, and whether at twice the resolution.
struct ImageChannels {
    int in = colour_channels, out = colour_channels;
    bool doubles = true;
};

// Multiplications and additions of the layers in a run on `input`, on the CPU; depthwise ones apart.
double operations_of(TorchNetwork& model, const Tensor& input);

// `channels` at width 1, multiplied and rounded up to a multiple of 8.
int scaled_channels(int channels, double width);
long parameter_count(const TorchNetwork& model);

// A convolution with an odd square kernel that keeps the size (stride 1), by He's initialisation.
torch::nn::Conv2d convolution(int in, int out, int kernel);
torch::nn::Linear dense(int in, int out);
void set_zero(torch::nn::Module& layer);

// The layer on x, its weights cast to x's type.
Tensor run_layer(torch::nn::Conv2d& layer, const Tensor& x);
// relu of it, on a GPU in one kernel where Convolutions::fastest allows it (models/device.h).
Tensor run_relu(torch::nn::Conv2d& layer, const Tensor& x);
// (P, C) rows to (P, out): what a 1x1 convolution does to P pixels.
Tensor run_layer(torch::nn::Linear& layer, const Tensor& rows);
// rows (P, C) times weight (O, C) transposed, plus bias (O) where it is defined.
Tensor linear_rows(const Tensor& rows, const Tensor& weight, const Tensor& bias = {});
// A transposed convolution 2x2, stride 2, of weight (C, O, 2, 2), as rows (4 O, C): a pixel's four, their
// channels side by side.
Tensor doubling_rows(const Tensor& weight);
// Such a layer: (B, C, H, W) to (B, O, 2H, 2W).
Tensor run_doubling(torch::nn::ConvTranspose2d& layer, const Tensor& x);

// (B, C, H, W) to rows (B H W, C) and back.
Tensor to_rows(const Tensor& image);
Tensor from_rows(const Tensor& rows, const Tensor& like);

// Half precision ends at 65504. Inputs of hair reach 32 deviations under strong forces and signals 142 in
// trained networks: from the furthest input allowed they stay in range.
inline constexpr double half_reach = 64;

// (P, C) rows less `mean` over `deviation` (C), cast to a body's type as they are written; in half
// precision they end at half_reach.
Tensor normalised(const Tensor& rows, const Tensor& mean, const Tensor& deviation, torch::ScalarType body);

// (…, H, W) to (…, 2H, 2W): out[2i] = in[i], odd ones the mean of their neighbours, the last extrapolated.
Tensor up(const Tensor& image);

}  // namespace wetcurl

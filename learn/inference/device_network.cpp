// A network on a CUDA device.
#include "learn/inference/device_network.h"

#include <c10/core/InferenceMode.h>
#include <c10/cuda/CUDAGuard.h>
#include <c10/cuda/CUDAStream.h>

#include "base/device_buffer.h"
#include "learn/inference/captured.h"
#include "learn/inference/inference.h"
#include "models/device.h"

namespace wetcurl {
namespace {

class NetworkOnCuda final : public Network {
  public:
    NetworkOnCuda(const ModelCard& card, std::shared_ptr<TorchNetwork> model, torch::Device device, bool half)
        : device_(device),
          stream_(c10::cuda::getStreamFromPool(/*isHighPriority=*/true, device.index())),
          card_(card),
          model_(std::move(model)) {
        choose(Convolutions::fastest);
        model_->to(device_);
        model_->body = half ? torch::kHalf : torch::kFloat;
        model_->freeze();
    }

    const ModelCard& card() const override { return card_; }
    int reach() const override { return model_->reach(); }
    std::optional<DenseLayers> layers() const override { return model_->dense_layers(); }

    void run(const float* input, std::array<long, 4> shape, float* output, bool on_device) override {
        require_shape(card_, shape);
        const auto [b, c, h, w] = shape;
        if (b * h * w == 0) return;
        const c10::cuda::CUDAGuard guard(device_);
        const c10::cuda::CUDAStreamGuard on_stream(stream_);
        const c10::InferenceMode inference;
        if (shape != shape_) {
            captured_.forget();
            input_ = torch::empty({b, c, h, w}, torch::dtype(torch::kFloat).device(device_));
            shape_ = shape;
        }
        const torch::Device there = on_device ? device_ : torch::Device(torch::kCPU);
        const auto as = torch::dtype(torch::kFloat).device(there);
        input_.copy_(torch::from_blob(const_cast<float*>(input), {b, c, h, w}, as), /*non_blocking=*/true);
        captured_.run([&] { output_ = model_->forward(input_); });
        torch::from_blob(output, output_.sizes(), as).copy_(output_, /*non_blocking=*/true);
        check_cuda(cudaStreamSynchronize(stream_), "network");
    }

  private:
    torch::Device device_;
    c10::cuda::CUDAStream stream_;
    ModelCard card_;
    std::shared_ptr<TorchNetwork> model_;
    std::array<long, 4> shape_{};
    Tensor input_, output_;
    Captured captured_;
};

}  // namespace

std::unique_ptr<Network> device_network(const ModelCard& card, std::shared_ptr<TorchNetwork> model,
                                        torch::Device device, bool half) {
    return std::make_unique<NetworkOnCuda>(card, std::move(model), device, half);
}

}  // namespace wetcurl

// Learned wet strands on a CUDA device.
#include "learn/inference/device_strands.h"

#include <c10/core/InferenceMode.h>
#include <c10/cuda/CUDAGuard.h>
#include <c10/cuda/CUDAStream.h>
#include <torch/types.h>

#include <optional>

#include "learn/codec/crop.h"
#include "learn/codec/strand_kernels.h"
#include "learn/inference/captured.h"
#include "models/device.h"
#include "models/model_file.h"

namespace wetcurl {
namespace {

// Memory of the codec's as a tensor.
Tensor view(const float* data, std::initializer_list<long> shape, torch::Device device) {
    return torch::from_blob(const_cast<float*>(data), std::vector<int64_t>(shape),
                            torch::dtype(torch::kFloat).device(device));
}

class StrandsOnCuda final : public LearnedStrands {
  public:
    StrandsOnCuda(const std::string& path, const std::string& device, const StrandCodec& codec,
                  const Groom& low, bool half)
        : device_(device_named(device)),
          stream_(c10::cuda::getStreamFromPool(/*isHighPriority=*/true, device_.index())),
          grid_(codec.grid()),
          pixel_of_(codec.pixel_of()),
          length_(codec.length()),
          memory_(codec.memory()) {
        const c10::cuda::CUDAGuard guard(device_);
        kernels_.emplace(codec, low);
        std::tie(card_, model_) = load_model(path);
        require_fit(card_, codec);
        rounds_ = length_rounds_of(card_);
        model_->to(device_);
        model_->body = half ? torch::kHalf : torch::kFloat;
        model_->whole_grid = kernels_->high_strands() == kernels_->pixels();
        model_->freeze();
        image_ = view(kernels_->image(), {1, strand_channels, grid_.height, grid_.width}, device_);
    }

    const ModelCard& card() const override { return card_; }

    void keep_outside(const HeadShapes& head) override {
        const c10::cuda::CUDAGuard guard(device_);
        kernels_->keep_outside(head);
        begin_anew();
    }

    void lead_edges(int rounds) override {
        require_rounds(rounds);
        const c10::cuda::CUDAGuard guard(device_);
        rounds_ = rounds;
        begin_anew();
    }

    void draw_together(const LockTerms&, const std::vector<float>&) override {
        throw Error(
            "learned strands: found locks on a CUDA device, allowed on the CPU; without them Eq 10 by "
            "neighbours "
            "follows on the device");
    }

    void crop(const std::vector<uint8_t>& wanted) override {
        const c10::cuda::CUDAGuard guard(device_);
        crop_ = crop_to(grid_, wanted, model_->reach(), card_.architecture);
        begin_anew();
    }

    void bind(const Vec3f* low, Vec3f* out, bool on_device) override {
        const c10::cuda::CUDAGuard guard(device_);
        const size_t reads = size_t(kernels_->low_strands()) * kernels_->particles(),
                     writes = size_t(kernels_->high_strands()) * kernels_->particles();
        if (on_device) {
            require_here(low), require_here(out);
            host_low_ = nullptr, host_out_ = nullptr, low_ = low, out_ = out;
        } else {
            if (!own_low_.size())
                own_low_ = DeviceBuffer<Vec3f>(reads), own_out_ = DeviceBuffer<Vec3f>(writes);
            host_low_ = low, host_out_ = out, low_ = own_low_.data(), out_ = own_out_.data();
        }
        begin_anew();
    }

    void run(const HeadWindow& heads) override {
        const c10::cuda::CUDAGuard guard(device_);
        launch(heads);
        check_cuda(cudaStreamSynchronize(stream_), "frame");
    }

    DeviceStream begin(const HeadWindow& heads) override {
        if (host_out_)
            throw Error(
                "learned strands: found a frame begun that is bound in the host's memory, allowed is "
                "the device's");
        const c10::cuda::CUDAGuard guard(device_);
        check_cuda(cudaStreamSynchronize(stream_), "frame");  // the one before has read its head
        launch(heads);
        return stream_;
    }

    void restart() override { first_ = true; }
    int memory() const override { return memory_; }

    Strands base(const Pose& head) override {
        const c10::cuda::CUDAGuard guard(device_);
        const c10::cuda::CUDAStreamGuard on_stream(stream_);
        const c10::InferenceMode inference;
        DeviceBuffer<Vec3f> world(size_t(kernels_->high_strands()) * kernels_->particles());
        check_cuda(cudaStreamSynchronize(stream_), "frame");  // it has read its head
        kernels_->head().rotation = cast<float>(head.rotation);
        kernels_->head().translation = cast<float>(head.translation);
        kernels_->take_head(stream_);
        kernels_->place(nullptr, rounds_, world.data(), stream_, /*within_shapes=*/true);
        check_cuda(cudaStreamSynchronize(stream_), "base");
        Strands out(kernels_->high_strands(), kernels_->particles());
        world.download(out.points.data());
        return out;
    }

    std::vector<float> expected_errors() override {
        const c10::cuda::CUDAGuard guard(device_);
        const c10::InferenceMode inference;
        check_cuda(cudaStreamSynchronize(stream_), "frame");
        const Tensor answered = answer_.view({-1, strand_outputs})
                                    .narrow(1, answered_errors.first, answered_errors.count)
                                    .to(torch::kCPU)
                                    .contiguous();
        const float* const of_pixel = answered.data_ptr<float>();
        std::vector<float> out;
        for (const int pixel : pixel_of_)
            out.insert(out.end(), of_pixel + size_t(pixel) * error_pieces,
                       of_pixel + size_t(pixel + 1) * error_pieces);
        return in_metres(std::move(out), pixel_of_, length_);
    }

    std::vector<float> inputs() override {
        const c10::cuda::CUDAGuard guard(device_);
        const c10::InferenceMode inference;
        check_cuda(cudaStreamSynchronize(stream_), "frame");
        const Tensor image = image_.view({strand_channels, -1}).t().to(torch::kCPU).contiguous();
        const float* const of_pixel = image.data_ptr<float>();
        std::vector<float> out;
        for (const int pixel : pixel_of_)
            out.insert(out.end(), of_pixel + size_t(pixel) * strand_channels,
                       of_pixel + size_t(pixel + 1) * strand_channels);
        return out;
    }

  private:
    void launch(const HeadWindow& heads) {
        const c10::cuda::CUDAStreamGuard on_stream(stream_);
        const c10::InferenceMode inference;
        kernels_->begin_frame(heads, first_);
        if (host_low_) {
            require_finite(host_low_, own_low_.size(), kernels_->particles());
            check_cuda(cudaMemcpyAsync(own_low_.data(), host_low_, own_low_.bytes(), cudaMemcpyHostToDevice,
                                       stream_),
                       "low-resolution strands");
        }
        captured_.run([&] { frame(); });
        if (host_out_)
            check_cuda(cudaMemcpyAsync(host_out_, own_out_.data(), own_out_.bytes(), cudaMemcpyDeviceToHost,
                                       stream_),
                       "wet strands");
        first_ = false;
    }

    // Whatever was captured is of other memory; what was uploaded is there.
    void begin_anew() {
        captured_.forget();
        check_cuda(cudaDeviceSynchronize(), "device");
    }

    void require_here(const void* memory) const {
        cudaPointerAttributes found{};
        const cudaError_t status = cudaPointerGetAttributes(&found, memory);
        cudaGetLastError();  // an unknown pointer is no failure of what follows
        if (status != cudaSuccess || found.type != cudaMemoryTypeDevice || found.device != device_.index())
            throw Error("learned strands: found memory that is not of CUDA device " +
                        std::to_string(device_.index()) + ", where this one runs");
    }

    void frame() {
        kernels_->take_head(stream_);
        kernels_->depart(low_, stream_);
        kernels_->move_cores(stream_);
        kernels_->carry(stream_);
        kernels_->describe(stream_);
        ask();
        kernels_->place(kernels_->average(answer_.data_ptr<float>(), stream_), rounds_, out_, stream_);
    }

    // answer_ becomes (S, strand_outputs).
    void ask() {
        if (!crop_) {
            answer_ = to_rows(model_->forward(image_)).contiguous();
            return;
        }
        const auto [answered, seen] = *crop_;
        answer_ = torch::zeros({grid_.height, grid_.width, strand_outputs}, image_.options());
        if (!answered.height) return;
        const Tensor said = model_->forward(
            image_.narrow(2, seen.row, seen.height).narrow(3, seen.column, seen.width).contiguous());
        answer_.narrow(0, answered.row, answered.height)
            .narrow(1, answered.column, answered.width)
            .copy_(said[0]
                       .narrow(1, answered.row - seen.row, answered.height)
                       .narrow(2, answered.column - seen.column, answered.width)
                       .permute({1, 2, 0}));
    }

    torch::Device device_;
    c10::cuda::CUDAStream stream_;
    const RootGrid grid_;
    std::vector<int> pixel_of_;  // (strand)
    std::vector<float> length_;  // (pixel) [m]
    int memory_;
    std::optional<StrandKernels> kernels_;
    ModelCard card_;
    std::shared_ptr<TorchNetwork> model_;
    Tensor image_, answer_;
    const Vec3f *low_ = nullptr, *host_low_ = nullptr;
    Vec3f *out_ = nullptr, *host_out_ = nullptr;
    DeviceBuffer<Vec3f> own_low_, own_out_;
    int rounds_ = 0;  // that lead edges
    std::optional<Crop> crop_;
    Captured captured_;
    bool first_ = true;
};

}  // namespace

std::unique_ptr<LearnedStrands> device_strands(const std::string& path, const std::string& device,
                                               const StrandCodec& codec, const Groom& low, bool half) {
    return std::make_unique<StrandsOnCuda>(path, device, codec, low, half);
}

}  // namespace wetcurl

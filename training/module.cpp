// What the library of the networks shows to the program.
#include "base/error.h"
#ifdef WETCURL_NETWORKS_ON_DEVICE
#include "learn/inference/device_strands.h"
#endif
#include "learn/codec/network_module.h"
#include "learn/inference/inference.h"
#include "models/device.h"
#include "models/model_file.h"
#include "training/loop.h"
#include "training/measured.h"

namespace wetcurl {
namespace {

struct TorchModule : NetworkModule {
    std::unique_ptr<Network> load(const std::string& path, const std::string& device, int threads) override {
        return load_network(path, device, threads);
    }
    std::unique_ptr<LearnedStrands> load_strands(const std::string& path, StrandCodec codec,
                                                 [[maybe_unused]] const Groom& low, const std::string& device,
                                                 int threads) override {
        if (device.rfind("cuda", 0) != 0)
            return learned_strands(load_network(path, device, threads), std::move(codec));
#ifdef WETCURL_NETWORKS_ON_DEVICE
        return device_strands(path, device, codec, low, /*half=*/true);
#else
        device_named(device);  // says where there is none
        throw Error("device " + device + ": this build has no CUDA kernels (cmake --preset cuda)");
#endif
    }
    ModelCard card(const std::string& path) override { return read_card(path); }
    void train(const TrainRequest& request) override { wetcurl::train(request); }
    MeasuredNetwork measured_inference(const ModelCard& card, std::array<long, 4> shape,
                                       const std::string& device, int threads) override {
        return wetcurl::measured_inference(card, shape, device, threads);
    }
    MeasuredNetwork measured_training(const ModelCard& card, std::array<long, 4> shape,
                                      const std::string& device, int threads, bool deterministic) override {
        return wetcurl::measured_training(card, shape, device, threads, deterministic);
    }
};

}  // namespace
}  // namespace wetcurl

extern "C" wetcurl::NetworkModule* wetcurl_network_module() {
    static wetcurl::TorchModule module;
    return &module;
}

// What the library of the networks shows to the program.
// Ours.
#include "learn/inference.h"
#include "learn/network_module.h"
#include "models/model_file.h"
#include "training/loop.h"

namespace wetcurl {
namespace {

struct TorchModule : NetworkModule {
    std::unique_ptr<Network> load(const std::string& path, const std::string& device, int threads) override {
        return load_network(path, device, threads);
    }
    ModelCard card(const std::string& path) override { return read_card(path); }
    void train(const TrainRequest& request) override { wetcurl::train(request); }
};

}  // namespace
}  // namespace wetcurl

extern "C" wetcurl::NetworkModule* wetcurl_network_module() {
    static wetcurl::TorchModule module;
    return &module;
}

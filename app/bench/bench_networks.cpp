// The paper's networks alone, without codec and hair: patches through them and steps of their training.
#include <fmt/format.h>

#include "app/bench/bench.h"
#include "learn/codec/network_module.h"

namespace wetcurl::bench {

namespace {

constexpr int side = 128, batch = 128;

ModelCard card_of(const std::string& architecture) {
    ModelCard card;
    card.codec = "root", card.architecture = architecture;
    card.input_channels = card.output_channels = 3, card.upscale = 2;
    card.width = 1;
    return card;
}

Entry entry(const std::string& name, long patches,
            std::function<MeasuredNetwork(const std::array<long, 4>& shape)> make) {
    return {{name},
            "network",
            [=](Results& results) {
                const MeasuredNetwork network = make({patches, 3, side, side});
                for (int warm = 0; warm < 2; ++warm) network.run();
                Line line;
                line.name = line.series = name;
                line.item = "patch", line.items = line.size = double(patches);
                line.bytes = double(patches) * 3 * side * side * (1 + 4) * sizeof(float);
                line.operations = network.operations;
                line.seconds = repeated([&] { return network.run; });
                results.lines.push_back(line);
            },
            ""};
}

}  // namespace

std::vector<Entry> network_entries(const std::string& device, int threads) {
    std::vector<Entry> out;
    for (const char* architecture : {"unet_vgg19", "recursive_residual"}) {
        const ModelCard card = card_of(architecture);
        const auto inference = [=](const std::array<long, 4>& shape) {
            return network_module().measured_inference(card, shape, device, threads);
        };
        for (long patches : {1, 16})
            out.push_back(
                entry(fmt::format("network {}, {} of {} x {}", architecture,
                                  patches == 1 ? "patch" : fmt::format("{} patches", patches), side, side),
                      patches, inference));
        for (const bool deterministic : {true, false}) {
            const std::string training = fmt::format("network {}, training step of {}{}", architecture, batch,
                                                     deterministic ? "" : ", fastest");
            if (device == "cpu")
                out.push_back(
                    {{training}, "network", nullptr, "training steps are measured on a CUDA device"});
            else
                out.push_back(entry(training, batch, [=](const std::array<long, 4>& shape) {
                    return network_module().measured_training(card, shape, device, threads, deterministic);
                }));
        }
    }
    return out;
}

}  // namespace wetcurl::bench

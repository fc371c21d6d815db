// Training of a network on pairs files, by the library that holds LibTorch.
#include "app/engine/train_network.h"

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/engine/device.h"
#include "app/files/results.h"
#include "base/log.h"
#include "base/progress.h"
#include "base/ranks.h"
#include "learn/codec/network_module.h"

namespace wetcurl {

void train_network(const TrainingRequest& o) {
    std::vector<std::string> inputs = o.pairs;
    inputs.insert(inputs.end(), o.validation.begin(), o.validation.end());
    inputs.insert(inputs.end(), {o.recipe, o.from});
    check_files(o, o.output, inputs);
    TrainRequest request;
    request.kind = o.kind;
    request.pairs = o.pairs, request.validation = o.validation;
    request.output = o.output;
    request.recipe = o.recipe;
    request.set = o.set;
    request.architecture = o.architecture;
    request.width = o.width;
    request.from = o.from;
    if (!o.from.empty()) {
        const ModelCard card = network_module().card(o.from);
        if (o.architecture.empty()) request.architecture = card.architecture;
        if (!o.width) request.width = card.width;
        request.target = card.target;
    }
    request.device = o.device == "cpu" ? "" : o.device;  // the recipe may name one
    request.seed = o.seed;
    request.threads = o.threads;
    request.overwrite = o.overwrite;
    request.resume = o.resume;
    request.ranks = ranks_of_launcher();
    ResultFile results(request.ranks.first() ? o.json : "", o.overwrite);
    std::unique_ptr<Progress> bar;  // how many steps there are is known at the first
    if (request.ranks.first()) {
        request.log = log_info;
        request.progress = [&](long done, long total, const std::string& note) {
            if (!bar) bar = std::make_unique<Progress>("train", total, "step");
            bar->update(done, note);
        };
    }
    if (o.device != "cpu" && !names_of_cuda_devices().empty()) require_device(o.device);  // notes its name
    network_module().train(request);
    bar.reset();
    if (!request.ranks.first()) return;

    const ModelCard card = network_module().card(o.output);
    Json json{{"model", o.output},
              {"architecture", card.architecture},
              {"codec", card.codec},
              {"parameters", card.parameters}};
    for (const auto& [name, value] : card.numbers) json[name] = value;
    results.write_json(json);
    if (o.json != "-") {
        std::string line = fmt::format("{}: {}, {} parameters", o.output, card.architecture, card.parameters);
        for (const auto& [name, value] : card.numbers) line += fmt::format(", {} {:.4g}", name, value);
        std::puts(line.c_str());
    }
}

}  // namespace wetcurl

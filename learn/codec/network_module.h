// The door to LibTorch: a library opened on demand, so that a command without a network never loads it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/ranks.h"
#include "learn/codec/learned_strands.h"
#include "learn/codec/network.h"

namespace wetcurl {

struct TrainRequest {
    std::string kind;                     // sr | adhesion
    std::vector<std::string> pairs;       // pairs files of one codec
    std::vector<std::string> validation;  // held out in place of the last frames of each run
    std::string output;  // the model; OUTPUT.checkpoint and OUTPUT.jsonl stand beside it meanwhile
    std::string recipe;  // TOML file, "" for the defaults
    std::string from;    // model whose weights are begun with, of the same architecture and width; "": random
    std::vector<std::string> set;  // key.path=value over the recipe
    std::string target;            // where the recipe names none: "strands" or "displayed"; "": its default
    // These go before the recipe where they are given.
    std::string architecture;  // "" : the recipe's
    std::optional<double> width;
    std::string device;  // "": the recipe's; cpu | cuda | cuda:n
    std::optional<long> seed;
    int threads = 0;  // 0: all
    // Steps between two looks at what came of them: a GPU that is waited for stands idle. 0: 32 on a GPU,
    // else 1.
    int looks_apart = 0;
    bool overwrite = false;
    bool resume = false;
    Ranks ranks;  // of several processes the first alone writes; "cuda" is a GPU for each
    // After every look: `done` of this call's `total` steps, and the loss in words. May be empty.
    std::function<void(long done, long total, const std::string& note)> progress;
    // Lines worth a log entry. May be empty.
    std::function<void(const std::string& text)> log;
};

// A network with the weights that training begins with, on noise: a call is one repetition and waits for it.
struct MeasuredNetwork {
    std::function<void()> run;
    double operations;  // multiplications and additions of a repetition
};

struct NetworkModule {
    virtual ~NetworkModule() = default;
    // Throws Error for a bad model file or an absent device, Misuse for an unknown device name.
    virtual std::unique_ptr<Network> load(const std::string& path, const std::string& device,
                                          int threads) = 0;
    // A strand network with its codec; `low`: the rest groom of the dry run. On a CUDA device both are there,
    // the network's body in half precision; where this build has no kernels or its LibTorch no CUDA: Error.
    virtual std::unique_ptr<LearnedStrands> load_strands(const std::string& path, StrandCodec codec,
                                                         const Groom& low, const std::string& device,
                                                         int threads) = 0;
    // The card alone, without a network being made.
    virtual ModelCard card(const std::string& path) = 0;
    // Throws Interrupted with a checkpoint left, Error (bad pairs, diverged loss) or Misuse (recipe).
    virtual void train(const TrainRequest& request) = 0;
    // For `bench`; codec root. `shape` of the input; in the memory of the device.
    virtual MeasuredNetwork measured_inference(const ModelCard& card, std::array<long, 4> shape,
                                               const std::string& device, int threads) = 0;
    // Gradients and a step of the optimiser, the body in bfloat16. `deterministic` as in a recipe.
    virtual MeasuredNetwork measured_training(const ModelCard& card, std::array<long, 4> shape,
                                              const std::string& device, int threads, bool deterministic) = 0;
};

// Opens libwetcurl_networks on first use: beside the program or the library that holds this code, else
// where it is installed. Throws Error where it is not there or does not load. The module, and so every
// Network, lives until the program ends.
NetworkModule& network_module();

}  // namespace wetcurl

extern "C" wetcurl::NetworkModule* wetcurl_network_module();

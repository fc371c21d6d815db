// One way from low-resolution frames to high-resolution strands.
#pragma once

#include <memory>

#include "app/inference/method.h"
#include "learn/codec/frame_window.h"
#include "learn/codec/stencil.h"
#include "solver/scene/scene.h"

namespace wetcurl {

class Predictor {
  public:
    virtual ~Predictor() = default;
    // "quad interpolation, 3 roots"
    virtual std::string name() const = 0;
    // Frame `frame` of the run; frames come in order, from one on that it needs no earlier ones for but those
    // of its memory: the strands p (high strands, particles), world [m], before Eq 10 where that
    // follows.
    virtual void apply(int frame, const RunFrame& low, const HeadWindow& heads, Strands& p) = 0;
    // How many frames before one it must have seen to predict that one.
    virtual int memory() const { return 0; }
    // Of the frame applied last, as RunFrame has it; empty: nothing is known of errors.
    virtual std::vector<float> expected_error() { return {}; }
    // Of the frame applied last, what a strand network saw: (high strands, strand_channels); empty: no such
    // network is there.
    virtual std::vector<float> inputs() { return {}; }
    // What `apply` would have returned without the network, of the frame applied last; empty where there is
    // none.
    virtual Strands without_network(const RunFrame&) { return {}; }
};

// What a prediction starts from.
struct PredictionInput {
    const Scene& scene;      // at the resolution to predict, its saturation known
    std::string scene_file;  // for messages
    const RunHeader& low;    // of the low-resolution run
    std::string low_file;
    bool clumps;         // whether Eq 10 follows
    std::string device;  // as of --device
    int threads;
    const Settled* settled;  // null: the low-resolution strands are where they should be
};

// Throw Error where files and scene do not fit.
std::unique_ptr<Predictor> predictor_of(const InterpolationMethod& method, const PredictionInput& input);
std::unique_ptr<Predictor> predictor_of(const StrandNetworkMethod& method, const PredictionInput& input);
std::unique_ptr<Predictor> predictor_of(const RootNetworkMethod& method, const PredictionInput& input);
std::unique_ptr<Predictor> predictor_of(const OracleMethod& method, const PredictionInput& input);

// Roots around each new strand, 3 or 4; and how names say so.
Stencil stencil_of(int roots, const Groom& high, const Groom& low);
std::string suffix_of(int roots);

}  // namespace wetcurl

// What `infer` is asked for, as one value.
#pragma once

#include <variant>

#include "app/inference/infer_options.h"
#include "base/shift_units.h"
#include "learn/codec/interpolate.h"
#include "learn/codec/network.h"
#include "learn/codec/quad_transform.h"

namespace wetcurl {

// How colours become strands; none: the model's own, else the default.
struct TransformSettings {
    Reconstruction form = Reconstruction::core;
    int roots = 4;
    std::optional<double> gain;
    std::optional<ShiftUnits> units;
};

// No network.
struct InterpolationMethod {
    Interpolation kind;
    std::string name;  // of the kind
    int roots;
    bool wet_shape, settled;
};
// The wet run `truth` in place of a network of the root codec: its colours, or the weights that come nearest
// to it.
struct OracleMethod {
    std::string truth;
    bool by_weights;
    ShiftUnits colour_units;
    TransformSettings transform;
};
struct StrandNetworkMethod {
    std::string model;
    ModelCard card;
    bool settled, crop;
    int locks;  // passes of Eq 10 that draw its strands together by a grid; 0: none
    bool is_displayed() const { return card.target == "displayed"; }
};
struct RootNetworkMethod {
    std::string model;
    ModelCard card;
    TransformSettings transform;
};
// In place of Eq 11, inside the simulation.
struct AdhesionNetworkMethod {
    std::string model;
};

// Eq 10 after a prediction; none: the scene's.
struct ClumpingAfter {
    std::optional<int> passes;
    std::optional<double> spacing, relaxation;  // [m], [1]
    // The option given, "" for none.
    std::string given() const {
        return passes ? "--passes" : spacing ? "--spacing" : relaxation ? "--relaxation" : "";
    }
};

struct Method {
    std::variant<InterpolationMethod, OracleMethod, StrandNetworkMethod, RootNetworkMethod,
                 AdhesionNetworkMethod>
        prediction;
    bool clumps = false;  // whether Eq 10 follows, where the scene has one
    ClumpingAfter clumping = {};

    template <class Kind>
    const Kind* as() const {
        return std::get_if<Kind>(&prediction);
    }
    bool is_settled() const;
    // Of a network that predicts from a low-resolution run; null: there is none.
    const ModelCard* card() const;
    // Files beside the low-resolution run.
    std::vector<std::string> inputs() const;
};

// What the options say by themselves, before any file is read. Throws Misuse for what does not go together.
void check_options(const InferOptions& o);
// Of options that name a way; reads the card of a model. Throws Misuse for what does not go together.
Method method_of(const InferOptions& o);

}  // namespace wetcurl

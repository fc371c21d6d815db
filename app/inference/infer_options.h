// The options of `wetcurl infer`, as given.
#pragma once

#include "app/options/common_options.h"

namespace wetcurl {

struct InferOptions : CommonOptions {
    static constexpr const char
        *command = "infer",
        *summary = "predict wet high-resolution hair from a low-resolution run, dry or as the model learned";
    std::string input, model, interpolate, reconstruct, wetness, output;
    std::optional<int> frames;                   // the first so many alone
    std::optional<int> stride, guides;           // of a scene: which of its strands are simulated
    std::optional<int> strands;                  // that are predicted, at most
    bool any_roots = false;                      // the run's strands may be none of them
    std::string oracle_colours, oracle_weights;  // a wet run, in place of a network's
    std::optional<double> gain;                  // kappa of Eq 18; none: the scene's or the model's
    std::string units, colour_units;             // of Eq 18, of Eq 16; "": the scene's or the model's
    int roots = 4;                               // around a new strand: the grid's four, or the three nearest
    bool wet_shape = false;                      // of an interpolation: Eq 9 before it
    bool settled = false;          // the run is dry, and is moved to where wet strands come to rest
    std::optional<double> within;  // strands that are expected to be off by more are simulated [mm]
    std::optional<int> locks;      // passes of Eq 10 that draw strands together by a grid
    bool crop = false;             // the network is asked where hair is wet alone
    bool cohesion = false;         // Eq 10 after it
    // Of Eq 10, in place of the scene's.
    std::optional<int> passes;
    std::optional<double> spacing, relaxation;  // [m], [1]
};

}  // namespace wetcurl

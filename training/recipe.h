// The recipe of a training: TOML, one table of keys with their defaults for each codec.
// Ours; the root codec's batch, rate and optimiser are the paper's (section V), its epochs are not printed.
#pragma once

#include <string>
#include <vector>

#include "learn/codec/network_module.h"
#include "learn/codec/pairs.h"

namespace wetcurl {

struct Recipe {
    double epochs, batch, learning_rate, weight_decay, gradient_clip, patch, epoch_samples, width, seed;
    double validation, validate_every, checkpoint_seconds;
    double position, edge, curvature, length, steady;  // weights of the losses
    double gain;                                       // kappa of Eq 18, codec root
    std::string architecture, schedule, device, precision;
    bool deterministic;     // on CUDA devices
    std::string target;     // codec strand: "strands", which Eq 10 follows, or "displayed", after it
    std::string units;      // of Eq 18, codec root: "length" or "printed" (base/shift_units.h)
    std::string leave_out;  // codec strand: names of inputs (base/network_channels.h), blanks between
    std::string
        text;  // the whole recipe as TOML, `device` and `checkpoint_seconds` apart: they change no result
};

// One key that is a number. A codec without a default (NaN) does not have the key.
struct RecipeRow {
    const char* key;  // "loss.edge" lies in the table [loss]
    double Recipe::*member;
    double strand, root, adhesion;  // defaults
    double minimum, maximum;
    bool whole;
    const char* meaning;
    double fallback(Codec codec) const;
};
const std::vector<RecipeRow>& recipe_rows();

// The file of `request` (or the defaults), its assignments, and what the request gives itself, which goes
// first. Throws Misuse with file and line for an unknown key, a wrong type, a value out of range.
Recipe read_recipe(const TrainRequest& request, Codec codec, const std::vector<std::string>& architectures);

}  // namespace wetcurl

// The ways from low-resolution frames to strands, and which options of `infer` go with which.
#pragma once

#include <string>

#include "app/inference/infer_options.h"
#include "learn/codec/network.h"

namespace wetcurl {

enum Way : unsigned {
    nearest_way = 1 << 0,  // interpolations
    quad_way = 1 << 1,
    core_way = 1 << 2,
    rest_way = 1 << 3,
    skin_way = 1 << 4,
    oracle_colours_way = 1 << 5,
    oracle_weights_way = 1 << 6,
    strands_of_dry_way = 1 << 7,  // models of whole strands, which learned from dry or wet runs
    strands_of_wet_way = 1 << 8,
    displayed_of_dry_way = 1 << 9,  // the same of displayed strands
    displayed_of_wet_way = 1 << 10,
    root_model_way = 1 << 11,
    adhesion_model_way = 1 << 12,
};
using Ways = unsigned;  // a set of them

inline constexpr Ways interpolation_ways = nearest_way | quad_way | core_way | rest_way | skin_way,
                      oracle_ways = oracle_colours_way | oracle_weights_way,
                      displayed_model_ways = displayed_of_dry_way | displayed_of_wet_way,
                      strand_model_ways = strands_of_dry_way | strands_of_wet_way | displayed_model_ways,
                      model_ways = strand_model_ways | root_model_way | adhesion_model_way;

// The ways that the command line leaves open: one, or all of models, whose kind only the model file says.
// Throws Misuse where it names two ways.
Ways ways_named(const InferOptions& o);
Way way_of(const ModelCard& card);

// Throws Misuse for an option that goes with none of the ways: a table says which does. `who` names them in
// the message: "--interpolate quad", "MODEL.h5 (a model of the root codec)".
void require_options_that_go_with(const InferOptions& o, Ways ways, const std::string& who);

// "--interpolate, models of the root codec"
std::string text_of(Ways ways);

}  // namespace wetcurl

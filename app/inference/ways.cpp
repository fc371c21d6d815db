// The ways of `infer`, and their options.
#include "app/inference/ways.h"

#include <fmt/format.h>

#include "base/error.h"
#include "learn/codec/interpolate.h"

namespace wetcurl {

namespace {

struct Name {
    Ways ways;
    const char* text;
};
// Larger sets first.
constexpr Name names[] = {
    {interpolation_ways, "--interpolate"},
    {nearest_way, "--interpolate nearest"},
    {quad_way, "--interpolate quad"},
    {core_way, "--interpolate core"},
    {rest_way, "--interpolate rest"},
    {skin_way, "--interpolate skin"},
    {oracle_colours_way, "--oracle-colours"},
    {oracle_weights_way, "--oracle-weights"},
    {model_ways, "models"},
    {strand_model_ways, "models of whole strands"},
    {displayed_model_ways, "models of whole strands as displayed"},
    {strands_of_wet_way | displayed_of_wet_way, "models of whole strands that learned from wet runs"},
    {strands_of_dry_way | displayed_of_dry_way, "models of whole strands that learned from dry runs"},
    {strands_of_wet_way, "models of whole strands before Eq 10 that learned from wet runs"},
    {strands_of_dry_way, "models of whole strands before Eq 10 that learned from dry runs"},
    {displayed_of_wet_way, "models of whole strands as displayed that learned from wet runs"},
    {displayed_of_dry_way, "models of whole strands as displayed that learned from dry runs"},
    {root_model_way, "models of the root codec"},
    {adhesion_model_way, "adhesion models"},
};

// Which options go with which ways.
struct Row {
    const char* option;
    bool (*is_given)(const InferOptions&);
    Ways ways;
    const char* why;
};
constexpr Row table[] = {
    {"--reconstruct", [](const InferOptions& o) { return !o.reconstruct.empty(); },
     oracle_ways | root_model_way, "the other ways say themselves how strands are made"},
    {"--gain", [](const InferOptions& o) { return o.gain.has_value(); }, oracle_colours_way | root_model_way,
     "it scales the weights of Eq 18, which the other ways do not have"},
    {"--units", [](const InferOptions& o) { return !o.units.empty(); }, oracle_colours_way | root_model_way,
     "it is how Eq 18 is read, which the other ways do not compute"},
    {"--colour-units", [](const InferOptions& o) { return !o.colour_units.empty(); }, oracle_colours_way,
     "a model has the colours that it learned, and the other ways have none"},
    {"--roots 3", [](const InferOptions& o) { return o.roots == 3; },
     quad_way | core_way | rest_way | skin_way | oracle_ways | root_model_way,
     "nearest copies the strand of one root, and models of whole strands learned with four"},
    {"--settled", [](const InferOptions& o) { return o.settled; },
     rest_way | strands_of_wet_way | displayed_of_wet_way,
     "it moves dry strands to where wet ones rest, which only these start from"},
    {"--crop", [](const InferOptions& o) { return o.crop; }, strand_model_ways,
     "the other ways use no network, or one that needs the whole image"},
    {"--locks", [](const InferOptions& o) { return o.locks.has_value(); }, strand_model_ways,
     "its grid draws together what a network of whole strands answers, and the other ways run none"},
    {"--within", [](const InferOptions& o) { return o.within.has_value(); }, strand_model_ways,
     "no other way knows how far it is off"},
    {"--wet-shape", [](const InferOptions& o) { return o.wet_shape; }, rest_way,
     "it alone starts from a shape at rest, as drawn or after Eq 9"},
    {"--cohesion", [](const InferOptions& o) { return o.cohesion; }, interpolation_ways | strand_model_ways,
     "the root codec predicts what Eq 10 has displayed, and a simulation has its own"},
    {"--passes", [](const InferOptions& o) { return o.passes.has_value(); },
     interpolation_ways | strand_model_ways, "no Eq 10 follows the other ways"},
    {"--spacing", [](const InferOptions& o) { return o.spacing.has_value(); },
     interpolation_ways | strand_model_ways, "no Eq 10 follows the other ways"},
    {"--relaxation", [](const InferOptions& o) { return o.relaxation.has_value(); },
     interpolation_ways | strand_model_ways, "no Eq 10 follows the other ways"},
    {"--wetness", [](const InferOptions& o) { return !o.wetness.empty(); },
     interpolation_ways | strand_model_ways | root_model_way,
     "the run of an oracle and the scene of an adhesion model say themselves how wet the hair is"},
    {"--device", [](const InferOptions& o) { return o.device != "cpu"; },
     (interpolation_ways & ~skin_way) | model_ways, "skin and oracles run on the CPU alone"},
};

}  // namespace

Ways ways_named(const InferOptions& o) {
    if (!o.model.empty() + !o.interpolate.empty() + !o.oracle_colours.empty() + !o.oracle_weights.empty() > 1)
        throw Misuse(
            "infer needs one of --model MODEL.h5, --interpolate nearest|quad|core|rest|skin, "
            "--oracle-colours WET.h5 and --oracle-weights WET.h5; found more than one");
    if (!o.oracle_colours.empty()) return oracle_colours_way;
    if (!o.oracle_weights.empty()) return oracle_weights_way;
    if (o.interpolate.empty()) return model_ways;
    switch (interpolation_named(o.interpolate)) {
        case Interpolation::nearest:
            return nearest_way;
        case Interpolation::quad:
            return quad_way;
        case Interpolation::core:
            return core_way;
        case Interpolation::skin:
            return skin_way;
        case Interpolation::rest:
            break;
    }
    return rest_way;
}

Way way_of(const ModelCard& card) {
    if (card.codec == "root") return root_model_way;
    if (card.codec == "adhesion") return adhesion_model_way;
    if (card.target == "displayed") return card.low == "wet" ? displayed_of_wet_way : displayed_of_dry_way;
    return card.low == "wet" ? strands_of_wet_way : strands_of_dry_way;
}

void require_options_that_go_with(const InferOptions& o, Ways ways, const std::string& who) {
    for (const Row& row : table)
        if (row.is_given(o) && !(row.ways & ways))
            throw Misuse(fmt::format("{}: found with {}, allowed with {}: {}", row.option, who,
                                     text_of(row.ways), row.why));
}

std::string text_of(Ways ways) {
    std::string text;
    for (const Name& name : names) {
        if (!ways || (ways & name.ways) != name.ways) continue;
        text += (text.empty() ? "" : ", ") + std::string(name.text);
        ways &= ~name.ways;
    }
    return text;
}

}  // namespace wetcurl

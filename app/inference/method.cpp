// The options of `infer` to one value.
#include "app/inference/method.h"

#include "app/inference/ways.h"
#include "learn/codec/network_module.h"

namespace wetcurl {

namespace {

TransformSettings transform_of(const InferOptions& o) {
    TransformSettings t;
    if (!o.reconstruct.empty()) t.form = reconstruction_named(o.reconstruct);
    t.roots = o.roots;
    t.gain = o.gain;
    if (!o.units.empty()) t.units = shift_units_named(o.units);
    return t;
}

Method method_of_model(const InferOptions& o) {
    const ModelCard card = network_module().card(o.model);
    const Way way = way_of(card);
    require_options_that_go_with(o, way, o.model + ", one of the " + text_of(way));
    if (way == adhesion_model_way) return {AdhesionNetworkMethod{o.model}};
    if (way == root_model_way) return {RootNetworkMethod{o.model, card, transform_of(o)}};
    return {StrandNetworkMethod{o.model, card, o.settled, o.crop, o.locks.value_or(0)},
            o.cohesion || !(o.locks || way & displayed_model_ways),
            {o.passes, o.spacing, o.relaxation}};
}

}  // namespace

bool Method::is_settled() const {
    if (const auto* interpolation = as<InterpolationMethod>()) return interpolation->settled;
    if (const auto* network = as<StrandNetworkMethod>()) return network->settled;
    return false;
}

const ModelCard* Method::card() const {
    if (const auto* network = as<StrandNetworkMethod>()) return &network->card;
    if (const auto* network = as<RootNetworkMethod>()) return &network->card;
    return nullptr;
}

std::vector<std::string> Method::inputs() const {
    if (const auto* oracle = as<OracleMethod>()) return {oracle->truth};
    if (const auto* network = as<StrandNetworkMethod>()) return {network->model};
    if (const auto* network = as<RootNetworkMethod>()) return {network->model};
    return {};
}

void check_options(const InferOptions& o) {
    const Ways ways = ways_named(o);
    require_options_that_go_with(o, ways, ways == model_ways ? "a model" : text_of(ways));
}

Method method_of(const InferOptions& o) {
    const Ways ways = ways_named(o);
    if (ways == model_ways) return method_of_model(o);
    if (ways & oracle_ways) {
        const bool by_weights = ways == oracle_weights_way;
        return {OracleMethod{by_weights ? o.oracle_weights : o.oracle_colours, by_weights,
                             o.colour_units.empty() ? ShiftUnits::length : shift_units_named(o.colour_units),
                             transform_of(o)}};
    }
    return {InterpolationMethod{interpolation_named(o.interpolate), o.interpolate, o.roots, o.wet_shape,
                                o.settled},
            o.cohesion,
            {o.passes, o.spacing, o.relaxation}};
}

}  // namespace wetcurl

// A trained network in Eq 11's place: joins the solver's question to learn's answer. Ours.
#pragma once

#include <memory>

#include "solver/simulation.h"

namespace wetcurl {

// Null where the scene names no adhesion model. Loads LibTorch otherwise.
std::unique_ptr<AdhesionModel> adhesion_model_of(const Scene& scene, const std::string& device, int threads);

}  // namespace wetcurl

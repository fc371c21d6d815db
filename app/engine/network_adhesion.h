// A trained network in Eq 11's place: the solver's inputs, the network's output.
#pragma once

#include <memory>

#include "solver/run/simulation.h"

namespace wetcurl {

// Null where the scene names no adhesion model. Loads LibTorch otherwise, which answers on the CPU: devices
// ask the network's layers themselves.
std::unique_ptr<AdhesionPredictor> adhesion_predictor_of(const Scene& scene, int threads);

}  // namespace wetcurl

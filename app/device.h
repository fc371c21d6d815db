// Which of the solver's backends `--device` names. Ours.
#pragma once

#include <memory>
#include <string>

#include "cuda/display.h"
#include "solver/simulation.h"

namespace wetcurl {

// Throws Error where the device that `--device` names ("cpu", "cuda", "cuda:n") is not there.
void require_device(const std::string& device);

// The scene's simulation on it; precision "float" or "double".
std::unique_ptr<Simulation> make_simulation_on(const std::string& device, const Scene& scene,
                                               const std::string& precision);

// Eq 10 of the scene on it; null where it is for the host (solver/display.h): --device cpu, no such backend,
// or solids that deform.
std::unique_ptr<DeviceDisplay> make_display_on(const std::string& device, const Scene& scene);

// What a CUDA device does at most, measured there.
struct DeviceRates {
    std::string name;
    double copy_bytes, operations;  // a second: a copy's, read and written; of float multiply-adds, two each
};
DeviceRates rates_of_cuda_device(const std::string& device);

// Names of the CUDA devices there are; empty where the program was built without CUDA.
std::vector<std::string> names_of_cuda_devices();

}  // namespace wetcurl

// The solver's other backend: a scene simulated on a CUDA device, every substep of a frame in one launch.
#pragma once

#include <memory>
#include <string>

#include "solver/simulation.h"

namespace wetcurl {

// `precision` as for make_simulation; `device` counts from 0. The scene must outlive the simulation. Throws
// Error where there is no such device, and for what this backend does not cover: the explicit integrator, a
// network in Eq 11's place, records of adhesion.
std::unique_ptr<Simulation> make_cuda_simulation(const Scene& scene, const std::string& precision,
                                                 int device);

// Throws Error where there is no such device, with what the driver said.
void require_cuda_device(int device);

// Names of the devices there are; none is no error. `reason`: what the driver said where there are none.
std::vector<std::string> cuda_devices(std::string* reason = nullptr);

}  // namespace wetcurl

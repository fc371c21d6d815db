// The solver's other backend: a scene simulated on a CUDA device, a frame as one CUDA graph.
#pragma once

#include <memory>
#include <string>

#include "solver/run/simulation.h"

namespace wetcurl {

// Who steps strands: a block of threads some of them; the CPU's own pass, a thread each, as explicit steps
// and builds for parity always do.
enum class Stepping { chosen, by_reference };

// `precision` as for make_simulation; `device` counts from 0. The scene must outlive the simulation. Strands,
// what they do to each other, cohesion on display, contact with solids, level sets that deform, water that
// flows, networks of dense layers in Eq 11's place and the air are the device's; the rest (trees of meshes
// that deform; other networks; in builds for parity all networks and what strands do to each other) the host
// computes between launches. Throws Error where there is no such device.
std::unique_ptr<Simulation> make_cuda_simulation(const Scene& scene, const std::string& precision, int device,
                                                 Stepping stepping = Stepping::chosen);

// Makes it that of the calling thread, where a simulation on it may have been made in another.
void enter_cuda_device(int device);

// Throws Error where there is no such device, with what the driver said.
void require_cuda_device(int device);

// Names of the devices there are; none is no error. `reason`: what the driver said where there are none.
std::vector<std::string> cuda_devices(std::string* reason = nullptr);

}  // namespace wetcurl

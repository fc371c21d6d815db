// Which of the solver's backends `--device` names.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "cuda/run/display.h"
#include "solver/cohesion/display.h"
#include "solver/run/simulation.h"
#include "solver/solids/deforming_solids.h"

namespace wetcurl {

// Throws Error where the device that `--device` names ("cpu", "cuda", "cuda:n") is not there.
void require_device(const std::string& device);

// Makes it that of the calling thread, which is asked for where simulations are made in other threads.
void enter_device(const std::string& device);

// The scene's simulation on it; precision "float" or "double".
std::unique_ptr<Simulation> make_simulation_on(const std::string& device, const Scene& scene,
                                               const std::string& precision);

// What is seen of strands, Eq 10, computed there where this program can and the scene's solids are rigid,
// else by the host.
class DisplayOn {
  public:
    // For a scene with [cohesion], which must outlive it.
    DisplayOn(const std::string& device, const Scene& scene);
    // Positions p of all strands of the scene's groom become p^w, at a pose of the head and a time [s].
    void apply(Strands& p, const Pose& head, double time);
    // For strands that lie on the device; null: the host computes.
    DeviceDisplay* device() const { return device_.get(); }

  private:
    std::unique_ptr<DeviceDisplay> device_;
    std::optional<Display> host_;
    std::optional<DeformingSolids> surfaces_;
};

// What a CUDA device does at most, measured there.
struct DeviceRates {
    std::string name;
    double copy_bytes, operations;  // a second: a copy's, read and written; of float multiply-adds, two each
};
DeviceRates rates_of_cuda_device(const std::string& device);

// Names of the CUDA devices there are; empty where the program was built without CUDA.
std::vector<std::string> names_of_cuda_devices();

}  // namespace wetcurl

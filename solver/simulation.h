// A running simulation: what the scene names, stepped frame by frame.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/run_cache.h"
#include "solver/scene.h"

namespace wetcurl {

// Who gives the adhesion force in Eq 11's place (a network): F.n / (sigma m a_max) from the twelve inputs of
// EQUATIONS Sec. 6, {contact, v.n / sqrt(a_max h), phi / h, F.n / (sigma m a_max)} of particles i-1, i, i+1.
class AdhesionModel {
  public:
    virtual ~AdhesionModel() = default;
    // inputs (count, 12) -> outputs (count)
    virtual void evaluate(const float* inputs, size_t count, float* outputs) = 0;
};

// A particle's twelve inputs and Eq 11's answer: what an adhesion network is trained on.
struct AdhesionRecord {
    float inputs[12], target;
    bool contact;
};

struct BufferSize {
    std::string name;
    size_t bytes;
};

// Why a run cannot go on.
struct Divergence {
    int strand;
    std::string largest_term;  // the kind of energy that grew most
};

class Simulation {
  public:
    virtual ~Simulation() = default;
    // One frame: the substeps, then the displayed positions.
    virtual void advance() = 0;
    // The state as it is; `frame` is filled whole.
    virtual void snapshot(RunFrame& frame) const = 0;
    // The first strand that is not finite or has left the scene (ten strand lengths from its root).
    virtual std::optional<Divergence> divergence() const = 0;
    virtual std::vector<BufferSize> buffers() const = 0;
    virtual double neighbours_mean() const = 0;
    virtual long limited_edges() const = 0;  // by the strain limiter, so far
    virtual void use_adhesion_model(AdhesionModel* model) = 0;
    // From now on every substep's particles near solids are appended to `records` (null: stop).
    virtual void record_adhesion(std::vector<AdhesionRecord>* records) = 0;

    std::vector<std::string> energy_kinds;  // columns of RunFrame::energy
    std::vector<std::string> stages;        // columns of RunFrame::stage_seconds
};

// `precision`: "float" or "double". The scene must outlive the simulation.
std::unique_ptr<Simulation> make_simulation(const Scene& scene, const std::string& precision);
std::unique_ptr<Simulation> make_simulation(Scene&&, const std::string&) = delete;

// What the scene names and what it leaves out, by the names of terms and passes.
struct Presence {
    std::vector<std::string> present, absent;
};
Presence presence_of(const Scene& scene);

// The largest h² k / m of the scene's springs in one substep; above 1e5 a float factorisation is not to be
// trusted.
double stiffness_number(const Scene& scene);

}  // namespace wetcurl

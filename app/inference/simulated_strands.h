// Strands that a network is not trusted with: which they are, and their simulation in its place.
#pragma once

#include <string>
#include <vector>

#include "app/inference/low_run.h"
#include "app/inference/predict_run.h"
#include "app/inference/predictor.h"
#include "base/interrupt.h"

namespace wetcurl {

// Strands that the predictor expects to be off by more than `within` [m], mean over the first `frames`.
// Throws Interrupted where a signal asks to stop.
std::vector<int> not_trusted(Predictor& predictor, LowRun& low, int frames, double within,
                             const InterruptGuard& guard);

// Strands of a prediction that are simulated in its place, alone.
class SimulatedStrands {
  public:
    // `scene`: all of the hair, wet. Eq 10 draws them together with the others, predicted ones.
    SimulatedStrands(const Scene& scene, const std::string& file, std::vector<int> strands,
                     const PredictionRequest& request);
    const std::vector<int>& strands() const { return strands_; }
    // Their next frame into p. Throws Error where the head is elsewhere than at `head`.
    void put(const Pose& head, Strands& p);

  private:
    std::vector<int> strands_;
    LowRun run_;
    RunFrame frame_;
};

}  // namespace wetcurl

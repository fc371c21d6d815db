// What the adhesion network sees and predicts: twelve scalars of a particle and its two chain neighbours.
// Section IV.D and Eq 20. Differs: scalars along n = grad phi(x_i) instead of vectors (12 = 3 x 4 holds for
// these alone, and the force is then equivariant), and the force of the step before as input, since in print
// the force is input and target at once.
#pragma once

#include <array>
#include <cstdint>

#include "base/network_channels.h"

namespace wetcurl {

struct AdhesionSample {
    std::array<float, adhesion_inputs> input{};  // AdhesionChannels
    float target = 0;                            // F.n / (sigma m a_max) of this step
    uint8_t contact = 0;  // whether particle i is in contact: training draws as many of each kind
};

}  // namespace wetcurl

// What the adhesion network sees and predicts: twelve scalars of a particle and its two chain neighbours.
// Section IV.D and Eq 20. Differs: scalars along n = grad phi(x_i) instead of vectors (12 = 3 x 4 holds for
// these alone, and the force is then equivariant), and the force of the step before as input, since in print
// the force is input and target at once.
#pragma once

#include <array>
#include <cstdint>

namespace wetcurl {

inline constexpr int adhesion_inputs = 12;

struct AdhesionSample {
    // Particles i-1, i, i+1; for each: contact flag, v.n / sqrt(a_max h), phi / h, F.n / (sigma m a_max) of
    // the step before.
    std::array<float, adhesion_inputs> input{};
    float target = 0;     // F.n / (sigma m a_max) of this step
    uint8_t contact = 0;  // whether particle i is in contact: training draws as many of each kind
};

}  // namespace wetcurl

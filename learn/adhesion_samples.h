// What the adhesion network sees and predicts: twelve scalars of a particle and its two chain neighbours.
// Section IV.D and Eq 20. Differs: scalars along n = grad phi(x_i) instead of vectors (12 = 3 x 4 holds for
// these alone, and the force is then equivariant), and the force of the step before as input, since in print
// the force is input and target at once.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "base/vec3.h"

namespace wetcurl {

inline constexpr int adhesion_inputs = 12;

struct AdhesionSample {
    // Particles i-1, i, i+1; for each: contact flag, v.n / sqrt(a_max h), phi / h, F.n / (sigma m a_max) of
    // the step before.
    std::array<float, adhesion_inputs> input{};
    float target = 0;     // F.n / (sigma m a_max) of this step
    uint8_t contact = 0;  // whether particle i is in contact: training draws as many of each kind
};

// The state of one particle before the step.
struct AdhesionParticle {
    bool contact = false;
    Vec3f velocity{0, 0, 0};  // [m/s]
    float phi = 0;            // distance to the solid [m]
    float force = 0;          // F.n of the step before [N]
    float scale = 0;          // sigma m a_max [N]
};

// The twelve inputs of particle i with unit normal n. At a strand's end the missing neighbour is particle i
// itself. a_max [m/s^2], h [m] the shell. A particle with scale 0 (dry) bears no force, and 0 stands for its
// share.
inline std::array<float, adhesion_inputs> adhesion_input(const AdhesionParticle& before,
                                                         const AdhesionParticle& at,
                                                         const AdhesionParticle& after, const Vec3f& n,
                                                         float a_max, float h) {
    std::array<float, adhesion_inputs> out;
    const float speed = 1 / std::sqrt(a_max * h);
    float* o = out.data();
    for (const AdhesionParticle* p : {&before, &at, &after}) {
        *o++ = p->contact ? 1.0f : 0.0f;
        *o++ = speed * dot(p->velocity, n);
        *o++ = p->phi / h;
        *o++ = p->scale > 0 ? p->force / p->scale : 0.0f;
    }
    return out;
}

}  // namespace wetcurl

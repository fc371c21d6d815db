// A strand as 3 x 24 amplitudes: cosines (DCT-I) of its offsets from the root along its length, of mean
// square 1 each, so that a strand has the same amplitudes [m] however many particles it is sampled at.
// The kept amplitudes are the least-squares fit among the curves that vanish at particle 0, so that roots are
// exact: c = B x - b_0 (b_0 . B x) / (b_0 . b_0), b_0 the basis at particle 0.
#pragma once

#include <vector>

#include "base/network_channels.h"
#include "base/vec3.h"

namespace wetcurl {

class StrandDct {
  public:
    // `particles` of a strand, 2 or more. Amplitudes k ≥ particles do not exist and stay zero.
    explicit StrandDct(int particles);

    int particles() const { return particles_; }
    // B[k * particles + i] = s_k cos(pi k i / (particles - 1)), s_k = 1 for k = 0 and particles - 1, else
    // sqrt(2).
    const std::vector<float>& basis() const { return basis_; }
    // (24): b_0 / |b_0|, along which what is encoded must vanish.
    const std::vector<float>& projection() const { return projection_; }
    // Offsets from the root (particles) [m] to amplitudes (72) [m], of a strand or of a strand a lane. S:
    // float or a Pack of it.
    template <class S>
    void encode(const Vec3<S>* offsets, S* coefficients) const;
    // Amplitudes (72) to offsets (particles), less the offset at particle 0.
    template <class S>
    void decode(const S* coefficients, Vec3<S>* offsets) const;

  private:
    int particles_;
    std::vector<float> basis_;     // (24, particles)
    std::vector<float> weighted_;  // (particles, 24): by the weight of a particle in the mean
    std::vector<float> rise_;      // (particles, 24): less that at particle 0
    std::vector<float> projection_;
};

}  // namespace wetcurl

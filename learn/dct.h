// A strand as 3 x 16 amplitudes: orthonormal DCT-II of its offsets from the root.
// Ours. The kept amplitudes are the least-squares fit among the curves that vanish at particle 0,
// so that roots are exact: c = B x - b_0 (b_0 . B x) / (b_0 . b_0), b_0 the basis at particle 0.
#pragma once

#include <vector>

#include "base/vec3.h"

namespace wetcurl {

inline constexpr int dct_kept = 16;                       // amplitudes an axis
inline constexpr int strand_coefficients = 3 * dct_kept;  // channel = 16 * axis + k

class StrandDct {
  public:
    // `particles` of a strand, 2 or more. Amplitudes k ≥ particles do not exist and stay zero.
    explicit StrandDct(int particles);

    int particles() const { return particles_; }
    // B[k * particles + i] = s_k cos(pi k (i + 1/2) / particles), s_0 = sqrt(1/particles), else
    // sqrt(2/particles).
    const std::vector<float>& basis() const { return basis_; }
    // Offsets from the root (particles) [m] to amplitudes (48) [m].
    void encode(const Vec3f* offsets, float* coefficients) const;
    // Amplitudes (48) to offsets (particles), less the offset at particle 0.
    void decode(const float* coefficients, Vec3f* offsets) const;

  private:
    int particles_;
    std::vector<float> basis_;       // (16, particles)
    std::vector<float> projection_;  // (16): b_0 / |b_0|
};

}  // namespace wetcurl

// A whole strand in one pixel: what the per-strand network sees, and what its answer means.
// Ours (`strand` codec). Encoding for training and inference go through the same class, so their features are
// the same.
//
// static (58): 0-47 amplitudes of the strand's rest shape, 48-55 saturation profile (means over eighths of
// the strand,
//   root first), 56 length [m], 57 curl radius at rest [m].
// dynamic (57): 0-47 base, the amplitudes of the quad interpolation of the dry low-resolution run, 48-50
// gravity [m/s^2],
//   51-53 angular velocity of the head [rad/s], 54-56 acceleration of the root [m/s^2].
// target (48): amplitudes of the wet strand before cohesion, less the base.
// All vectors in the strand's head-fixed root frame (learn/root_frame.h); amplitudes: learn/dct.h. Pixels
// without a strand hold zeros.
#pragma once

#include "learn/dct.h"
#include "learn/frame_window.h"
#include "learn/interpolate.h"

namespace wetcurl {

inline constexpr int saturation_pieces = 8;
inline constexpr int static_channels = strand_coefficients + saturation_pieces + 2;
inline constexpr int dynamic_channels = strand_coefficients + 9;

class StrandCodec {
  public:
    // high: the rest groom at full resolution; low: that of the dry run, every second root each way of it;
    // saturation: (high strand, particle), empty for dry. Throws Error where these do not fit.
    StrandCodec(const Groom& high, const Groom& low, const std::vector<float>& saturation);

    int height() const { return grid_.height; }
    int width() const { return grid_.width; }
    int particles() const { return dct_.particles(); }
    size_t pixels() const { return size_t(grid_.height) * grid_.width; }
    const StrandDct& dct() const { return dct_; }

    const std::vector<float>& fixed() const { return fixed_; }    // "static": (58, H, W)
    const std::vector<uint8_t>& mask() const { return mask_; }    // (H, W)
    const std::vector<float>& length() const { return length_; }  // (H, W) [m]

    // out (57, H, W): features of one frame; low: world positions of the dry low-resolution strands [m].
    void dynamic(const Strands& low, const HeadWindow& heads, float* out);
    // out (48, H, W): amplitudes of world strands (high strands) at a head pose.
    void encode(const Strands& strands, const Pose& head, float* out) const;
    // World strands (high strands) of amplitudes (48, H, W) at a head pose; roots are exact.
    void decode(const float* coefficients, const Pose& head, Strands& out) const;

  private:
    RootGrid grid_;
    std::vector<int> pixel_of_;  // (strand)
    StrandDct dct_;
    Interpolator base_;
    Strands scratch_;  // the base of the frame at hand
    std::vector<float> fixed_, length_;
    std::vector<uint8_t> mask_;
};

}  // namespace wetcurl

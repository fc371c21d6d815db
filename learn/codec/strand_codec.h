// A whole strand in one pixel: what the per-strand network sees, and what its answer means.
// Ours (`strand` codec). Encoding for training and inference go through the same class, so their features are
// the same.
//
// The base is the strand's own rest shape, curled by its water (Eq 9), and moved as the low-resolution
// strands around it have moved from theirs (learn/codec/carried_rest.h), at full resolution; the network sees
// its amplitudes, and answers with those of what is to be added to it.
//
// static (85): 0-71 amplitudes of that rest shape, 72-79 saturation profile (means over eighths of the
//   strand, root first), 80 length [m], 81 curl radius at rest [m], 82 whether the low-resolution run has the
//   strand, 83 mean distance to the roots beside it on the grid [m], 84 reach of Eq 10 [m].
// dynamic (153): 0-71 amplitudes of the base, 72-74 gravity [m/s^2], 75-77 angular velocity of the head
//   [rad/s], 78-80 acceleration of the root [m/s^2]; then 18 for each of the frames 1, 2, 4 and 8 before:
//   how the first 4 amplitudes an axis of the base have changed since (12) [m], angular velocity and
//   acceleration at that frame (6). Before the first frame all was as in it.
// target (72): amplitudes of the wet strand before cohesion, less the base; displayed (72): after it.
// All vectors in the strand's head-fixed root frame (learn/codec/root_frame.h); amplitudes:
// learn/codec/dct.h. Pixels without a strand hold zeros.
#pragma once

#include <array>

#include "learn/codec/carried_rest.h"
#include "learn/codec/dct.h"
#include "learn/codec/frame_window.h"

namespace wetcurl {

inline constexpr int saturation_pieces = 8;
inline constexpr std::array<int, 4> history_lags{1, 2, 4, 8};  // [frames]
inline constexpr int history_modes = 4;                        // amplitudes an axis
inline constexpr int history_numbers = 3 * history_modes + 6;  // of a strand and frame
inline constexpr int static_channels = strand_coefficients + saturation_pieces + 5;
inline constexpr int motion_channels = 9;
inline constexpr int dynamic_channels =
    strand_coefficients + motion_channels + int(history_lags.size()) * history_numbers;

// The inputs by name, static ones first: what a training can leave out.
struct InputGroup {
    const char* name;
    int first, count;
};
inline constexpr std::array<InputGroup, 10> strand_inputs{{
    {"rest", 0, strand_coefficients},
    {"saturation", strand_coefficients, saturation_pieces},
    {"length", static_channels - 5, 1},
    {"radius", static_channels - 4, 1},
    {"shared", static_channels - 3, 1},
    {"density", static_channels - 2, 2},
    {"base", static_channels, strand_coefficients},
    {"gravity", static_channels + strand_coefficients, 3},
    {"motion", static_channels + strand_coefficients + 3, 6},
    {"history", static_channels + strand_coefficients + motion_channels,
     dynamic_channels - strand_coefficients - motion_channels},
}};

class StrandCodec {
  public:
    // high: the rest groom at full resolution; low: that of the dry run, every second root each way of it;
    // saturation: (high strand, particle), empty for dry; shape: the high strands at rest with their water,
    // in the head's frame, null: as drawn; low_is_wet: the low-resolution run is a wet one; reach: of Eq 10
    // [m], 0 without it; settled: as of RestCarrier. Throws Error where these do not fit.
    StrandCodec(const Groom& high, const Groom& low, const std::vector<float>& saturation,
                const Strands* shape = nullptr, bool low_is_wet = false, double reach = 0,
                const Settled* settled = nullptr);

    const RootGrid& grid() const { return grid_; }
    int height() const { return grid_.height; }
    int width() const { return grid_.width; }
    int particles() const { return dct_.particles(); }
    int low_strands() const { return int(carrier_.around().twin.size()); }
    size_t pixels() const { return size_t(grid_.height) * grid_.width; }
    const StrandDct& dct() const { return dct_; }
    const RootFrames& roots() const { return roots_; }
    const RestCarrier& carrier() const { return carrier_; }
    const std::vector<int>& pixel_of() const { return pixel_of_; }  // (strand)

    const std::vector<float>& fixed() const { return fixed_; }    // "static": (85, H, W)
    const std::vector<uint8_t>& mask() const { return mask_; }    // (H, W)
    const std::vector<float>& length() const { return length_; }  // (H, W) [m]
    // (strand, particle): how long the edge to it is at rest [m], 0 at the root.
    const std::vector<float>& edges() const { return edges_; }

    // out (153, H, W): features of one frame, whose base it takes up; low: world positions of the dry
    // low-resolution strands [m]. For every frame of a run, in order.
    void dynamic(const Strands& low, const HeadWindow& heads, float* out);
    // The next frame is the first of another run.
    void restart() { frames_ = 0; }
    // World positions (high strands) of the base of the frame taken up last.
    Strands base(const Pose& head) const;
    // out (72, H, W): amplitudes of world strands (high strands) at a head pose.
    void encode(const Strands& strands, const Pose& head, float* out) const;
    // World strands (high strands): the base and, added to it, amplitudes (72, H, W) at a head pose; roots
    // are exact.
    void decode(const float* coefficients, const Pose& head, Strands& out) const;
    void decode(const float* coefficients, const Pose& head, Vec3f* out) const;  // (high strand, particle)

    // What was decoded (high strand, particle), its edges led toward their lengths in so many rounds
    // (learn/codec/edge_lengths.h).
    void lead_edges(int rounds, Vec3f* strands) const;

  private:
    // Amplitudes of offsets in root frames.
    void project(const Strands& offsets, float* out) const;

    RootGrid grid_;
    std::vector<int> pixel_of_;  // (strand)
    StrandDct dct_;
    RootFrames roots_;
    RestCarrier carrier_;
    Strands base_;             // offsets in the root frames
    std::vector<float> past_;  // (lag 0 to 8, round robin; strand, 18)
    long frames_ = 0;
    std::vector<float> fixed_, length_, edges_;
    std::vector<uint8_t> mask_;
};

}  // namespace wetcurl

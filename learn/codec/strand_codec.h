// A whole strand in one pixel: what the per-strand network sees, and what its answer means.
// Ours (`strand` codec). Encoding for training and inference go through the same class, so their features are
// the same.
//
// The base is the strand's own rest shape, curled by its water (Eq 9), and moved as the low-resolution
// strands around it have moved from theirs (learn/codec/carried_rest.h), at full resolution; the network sees
// its amplitudes, and answers with those of what is to be added to it.
//
// Its images, channel by channel: base/network_channels.h. Static is what does not change from frame to
// frame, dynamic what one frame brings. A target is the amplitudes of the wet strand, before cohesion or
// after it (displayed), less those of the base.
#pragma once

#include <cmath>

#include "base/network_channels.h"
#include "learn/codec/carried_rest.h"
#include "learn/codec/dct.h"
#include "learn/codec/head_state.h"

namespace wetcurl {

// What is told of the hair beside its shape and its water; what is 0 is not known.
struct HairTraits {
    double rigidity = 0, wet_rigidity = 0;  // EI [N m^2], dry and at saturation 1
    double density = 0, wet_density = 0;    // of its length [kg/m], likewise
    double drag = 0, wet_drag = 0;          // on its motion against the root [1/s], likewise
    double reach = 0;                       // of Eq 10 [m], 0 without it
    double low_step = 0;                    // of the low-resolution run [s]
    double fps = history_fps;               // frames a second
};

// Frames before one that a network sees: history_lags at so many frames a second.
std::array<int, history_lags.size()> lags_in_frames(double fps);

// Frames, one and those before it, over which a network's answers are averaged: those of a twenty-fourth of a
// second, in whole frames. What is added to the base changes slowly, and an answer errs in each frame for
// itself.
int averaged_frames(double fps);

class StrandCodec {
  public:
    using S = Pack<float>;
    // high: the rest groom at full resolution; low: that of the low-resolution run, a grid of its roots or
    // any others; saturation: (high strand, particle), empty for dry; shape: the high strands at rest with
    // their water, in the head's frame, null: as drawn; low_is_wet: the low-resolution run is a wet one;
    // settled: as of RestCarrier. Throws Error where these do not fit.
    StrandCodec(const Groom& high, const Groom& low, const std::vector<float>& saturation,
                const Strands* shape = nullptr, bool low_is_wet = false, const HairTraits& traits = {},
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
    const RootLanes& lanes() const { return carrier_.lanes(); }     // rows of the grid
    const std::vector<int>& pixel_of() const { return pixel_of_; }  // (strand)

    const std::vector<float>& fixed() const { return fixed_; }    // "static": (static_channels, H, W)
    const std::vector<uint8_t>& mask() const { return mask_; }    // (H, W)
    const std::vector<float>& length() const { return length_; }  // (H, W): L [m]
    const std::array<int, history_lags.size()>& lags() const { return lags_; }  // [frames]
    int averaged() const { return averaged_; }                                  // of averaged_frames
    // Frames that are kept, a multiple of these.
    int slots() const { return (lags_.back() / averaged_ + 1) * averaged_; }
    // How many frames before one it depends on, with a network's answers.
    int memory() const { return lags_.back() + averaged_ - 1; }
    const HeadState& now() const { return head_; }  // of the frame begun last
    // (strand): 1 / L [1/m] and T [s].
    float per_length(int strand) const { return 1 / length_[size_t(pixel_of_[size_t(strand)])]; }
    float swing(int strand) const { return std::sqrt(1 / (per_length(strand) * standard_gravity)); }
    // (strand, particle): how long the edge to it is at rest [m], 0 at the root.
    const std::vector<float>& edges() const { return edges_; }

    // ---- A frame, block by block ----
    // For every frame of a run, in order: `begin`, then `follow`, by one thread or by all of a team, each
    // with the same `low` (low strands, particles) world positions [m], then `describe` for each block, as
    // often as its features are wanted.
    void begin(const HeadWindow& heads);
    void follow(const Vec3f* low) { carrier_.follow(low, pose_); }
    // out (dynamic_channels): features of a block's strands, whose base it takes up.
    void describe(int block, S* out);
    // Places a block's strands in the world at the frame's head pose: `answer` (72) amplitudes [L], added to
    // the base; null: nothing is. Edges are led toward their lengths in so many rounds. out (particles) [m].
    void place(int block, const S* answer, int rounds, const Pose& head, Vec3<S>* out) const;

    // ---- Whole images ----
    // out (dynamic_channels, H, W): features of a frame, whose base it takes up; low: as of `follow`.
    // For every frame of a run, in order.
    void dynamic(const Strands& low, const HeadWindow& heads, float* out);
    // The next frame is the first of another run.
    void restart() { frames_ = 0; }
    // World positions (high strands) of the base of the frame taken up last.
    Strands base(const Pose& head, int rounds = 0) const;
    // out (72, H, W): amplitudes [L] of world strands (high strands) at a head pose.
    void encode(const Strands& strands, const Pose& head, float* out) const;
    // World strands (high strands): the base and, added to it, amplitudes (72, H, W) at a head pose; roots
    // are exact.
    void decode(const float* coefficients, const Pose& head, Strands& out, int rounds = 0) const;
    void decode(const float* coefficients, const Pose& head, Vec3f* out, int rounds = 0) const;

    // A block's part of an image (channels, H, W), and the way back.
    void read_image(int block, int channels, const float* image, S* out) const;
    void write_image(int block, int channels, const S* numbers, float* image) const;

  private:
    RootGrid grid_;
    std::vector<int> pixel_of_;  // (strand)
    std::array<int, history_lags.size()> lags_;
    int averaged_;
    StrandDct dct_;
    RootFrames roots_;
    RestCarrier carrier_;
    std::vector<Vec3<S>> base_;  // (block, particle) offsets in the root frames
    // (slots(), round robin; block, past_layout.count): the amplitudes themselves where past_layout has their
    // change.
    std::vector<S> past_;
    long frames_ = 0;  // begun
    HeadState head_{};
    Pose pose_;
    std::vector<float> fixed_, length_, edges_;
    std::vector<S> block_edges_;                        // (block, particle)
    std::vector<S> block_length_, per_length_, swing_;  // (block): L [m], 1 / L or 0, T [s]
    std::vector<uint8_t> mask_;
};

}  // namespace wetcurl

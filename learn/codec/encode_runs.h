// Pairs of runs to pairs files.
// Ours; Eq 14-17 for codec root.
#pragma once

#include <memory>

#include "base/run_cache.h"
#include "learn/codec/pairs.h"
#include "learn/codec/root_codec.h"
#include "learn/codec/strand_codec.h"

namespace wetcurl {

// A low-resolution run and the wet one that it goes with.
struct RunPair {
    std::unique_ptr<RunReader> dry, wet;
    // Opens both. Throws Error unless they show the same seed, frames, rate and head motion, the first has
    // fewer strands, which are the other's, and the wet run knows its saturation.
    RunPair(const std::string& dry_path, const std::string& wet_path);
    // Throws Error unless the first has every second root each way of the other.
    void require_nested() const;

  private:
    void require_part() const;
};

// Whether water acted on the strands of a run.
inline bool simulated_wet(const RunHeader& run) { return run.method.starts_with("simulated wet"); }

// Frames of low-resolution and wet high-resolution strands as codec strand pairs them.
class StrandEncoder {
  public:
    // As of a StrandCodec.
    StrandEncoder(const Groom& high, const Groom& low, const std::vector<float>& saturation,
                  const Strands* shape, bool low_is_wet = false, const HairTraits& traits = {});
    StrandPairs begin(int frames, bool displayed) const;
    // Every frame of the low-resolution run, in order: world positions.
    void take_up(const Strands& low, const HeadWindow& heads);
    // The features of the frame taken up last: dynamic (dynamic_channels, H, W).
    const std::vector<float>& dynamic() const { return dynamic_; }
    // World positions of the wet strands then, as amplitudes over the base: (72, H, W). Returns the mean
    // distance that this costs them [mm].
    double encode(const Strands& wet, std::vector<float>& target);

  private:
    StrandCodec codec_;
    Pose head_;
    std::vector<float> dynamic_;
    Strands decoded_;
};

// Of codec root: colours (3, height, width) of `strands` whose roots are shifted by Eq 16.
std::vector<float> root_colours(const RootImage& image, const Strands& strands,
                                const std::vector<float>& saturation, float support_radius,
                                const ColourBox& box);

// These throw Interrupted; what was added is in `out`.

// Adds the pair to `out` (codec strand); `shape` and `traits` as of a StrandCodec. Returns the mean distance
// that encoding costs the wet strands before cohesion [mm].
double encode_strands(const RunPair& pair, PairsWriter& out, const Strands* shape = nullptr,
                      const HairTraits& traits = {});

// The roots of a pair's frames [m]: dry ones, and wet ones shifted by Eq 16.
struct PairRoots {
    std::vector<std::vector<Vec3f>> dry, wet;
};
// Grows `box` by all of them; `support_radius` h of Eq 16 [m].
PairRoots roots_of(const RunPair& pair, float support_radius, ShiftUnits units, ColourBox& box);

// Adds the pairs to `out` (codec root) with one box for all.
void encode_roots(const std::vector<RunPair>& pairs, float support_radius, PairsWriter& out,
                  ShiftUnits units = ShiftUnits::length);

}  // namespace wetcurl

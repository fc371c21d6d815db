// The pairs file: what training reads. HDF5 "wetcurl pairs", version 5, one group runs/NNN an encoded pair of
// runs.
//
// Attributes: `codec` (strand | root | adhesion), `particles` a strand, `low` (dry, or wet where the
// low-resolution runs were simulated wet too), `low_substeps` (the fewest of theirs a frame), `floor_mm`
// (codec strand: mean distance that encoding alone costs), `support_radius` (codec root: h of Eq 16 [m],
// where they agree, or 0), `colour_units` (codec root: how Eq 16 is read, length | printed; absent: length),
// and the inputs with their hashes ("input 000 dry", "input 000 wet": "FILE HASH").
//
// codec strand, F frames, (H, W) the high-resolution root grid:
//   static (static_channels, H, W) f32, dynamic (F, dynamic_channels, H, W) f32: base/network_channels.h; the
//   first 72 of `dynamic` are the base; target (F, 72, H, W) f32: wet amplitudes before cohesion, less the
//   base, by the strand's length;
//   displayed (F, 72, H, W) f32, where known: the same after cohesion; mask (H, W) u8: 1 where a strand is;
//   length (H, W) f32 [m]; frame (F) i32, where known: which of the run's frames these are, rising.
//   Amplitudes: learn/codec/dct.h.
// codec root: b_min, b_max (3) f64 [m] at the top, shared by all runs; input (F, 3, h, w) f32 colours of the
//   dry low-resolution roots, target (F, 3, 2h, 2w) f32 of the wet ones; h, w multiples of 32; mask_low (h,
//   w) and mask (2h, 2w) u8. Colours outside the mask repeat the nearest strand's.
// codec adhesion: input (n, 12) f32, target (n) f32, contact (n) u8: learn/codec/adhesion_samples.h.
#pragma once

#include <string>
#include <vector>

#include "base/hdf5.h"
#include "learn/codec/adhesion_samples.h"

namespace wetcurl {

inline constexpr const char* pairs_format = "wetcurl pairs";
inline constexpr int pairs_version = 6, oldest_pairs_version = 6;  // before: another base

enum class Codec { strand, root, adhesion };
std::string name_of(Codec codec);
// Throws Misuse for another name.
Codec codec_named(const std::string& name);

// One run of codec strand, its frames left on disk.
struct StrandPairs {
    int frames = 0, static_channels = 0, dynamic_channels = 0, height = 0, width = 0;
    std::vector<float> fixed;   // dataset "static": (Cs, H, W)
    std::vector<uint8_t> mask;  // (H, W)
    std::vector<float> length;  // (H, W) [m]
    bool displayed = false;     // whether frames have the strands after cohesion too
    std::vector<int> frame;     // (frames): which of the run's they are, rising; empty: not known
    size_t pixels() const { return size_t(height) * width; }
};

// One run of codec root, its frames left on disk.
struct RootPairs {
    int frames = 0, height = 0, width = 0;  // of the input; the target's are twice these
    std::vector<uint8_t> mask_low;          // (h, w)
    std::vector<uint8_t> mask;              // (2h, 2w)
    size_t pixels() const { return size_t(height) * width; }
};

class PairsWriter {
  public:
    // Throws Error where the file cannot be made, or is there and `overwrite` is false.
    PairsWriter(const std::string& path, Codec codec, int particles, bool overwrite)
        : PairsWriter(OutputFile(path, overwrite), codec, particles) {}
    // Into a place that was secured before.
    PairsWriter(OutputFile place, Codec codec, int particles);

    // Each begins the next group; its frames follow by `append` (dynamic, target and, where there is one,
    // displayed; or input and target).
    void begin(const StrandPairs& run);
    void begin(const RootPairs& run);
    void append(const float* inputs, const float* target, const float* displayed = nullptr);
    // The next group is the first of another file, whose path starts at this one's folder.
    void link(const std::string& file);
    // A group of its own.
    void add(const std::vector<AdhesionSample>& samples);
    // What the low-resolution runs are; substeps: the fewest a frame, 0: not known.
    void low(bool wet, int substeps);
    // b_min, b_max of codec root [m].
    void box(const double lower[3], const double upper[3]);
    void attribute(const std::string& name, const std::string& value) { file_.attribute(name, value); }
    void attribute(const std::string& name, double value) { file_.attribute(name, value); }
    // The group begun last: "runs/003".
    const std::string& group() const { return group_; }
    void commit() { file_.commit(); }

  private:
    void next_group();
    H5Writer file_;
    int runs_ = 0;
    std::string group_, inputs_name_;
    std::vector<size_t> inputs_shape_, target_shape_;
};

class PairsReader {
  public:
    // Throws Error with what is wrong with the file.
    explicit PairsReader(const std::string& path);

    Codec codec() const { return codec_; }
    int particles() const { return particles_; }
    int runs() const { return runs_; }
    const std::string& path() const { return file_.path(); }
    // What the low-resolution runs are: dry | wet.
    std::string low() const;
    int low_substeps() const;  // the fewest of theirs a frame, 0: not known

    // 0 ≤ run < runs(), 0 ≤ frame < frames. Shapes are checked against each other; Error names what differs.
    StrandPairs strand(int run) const;
    RootPairs root(int run) const;
    std::vector<AdhesionSample> adhesion(int run) const;
    // Codec strand: (Cd, H, W) and (72, H, W), before or, where known, after cohesion; codec root: (3, h, w)
    // and (3, 2h, 2w).
    void frame(int run, int frame, float* inputs, float* target, bool displayed = false) const;
    void box(double lower[3], double upper[3]) const;
    bool has_attribute(const std::string& name) const { return file_.has_attribute(name); }
    std::string text(const std::string& attribute) const { return file_.text(attribute); }
    double number(const std::string& attribute) const { return file_.number(attribute); }

  private:
    void require(Codec wanted) const;
    H5Reader file_;
    Codec codec_;
    int particles_ = 0, runs_ = 0;
};

}  // namespace wetcurl

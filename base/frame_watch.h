// What nobody should miss in a run: edges far beyond their rest length, how fast hair is, and energy that
// grows.
#pragma once

#include <optional>
#include <vector>

#include "base/run_cache.h"

namespace wetcurl {

// A value at a particle of a frame; of an edge the particle before it.
struct FrameExtreme {
    double value = 0;
    int frame = 0, strand = 0, particle = 0;
};

class FrameWatch {
  public:
    // Of an edge's length over its rest length: beyond this a run warns.
    static constexpr double warning_stretch = 3;
    // And beyond this way of a particle over time [m/s]: a fall from 500 m in a vacuum makes as much.
    static constexpr double warning_speed = 100;

    FrameWatch(const Groom& groom, double fps);
    // A frame of simulated or predicted positions. Each in turn; after one that was left out, speed and
    // energy begin anew.
    void look(int frame, const RunFrame& now);

    // Largest edge length over rest length so far; none before the first frame.
    const std::optional<FrameExtreme>& stretch() const { return stretch_; }
    // The first edge beyond `warning_stretch`, the longest of its frame.
    const std::optional<FrameExtreme>& overstretched() const { return overstretched_; }
    // Largest way of a particle from one frame to the next over the time between them [m/s], cuts left out.
    const std::optional<FrameExtreme>& speed() const { return speed_; }
    // The first frame with a particle beyond `warning_speed`, the fastest of it.
    const std::optional<FrameExtreme>& overspeed() const { return overspeed_; }
    // Largest growth of the energy of all strands from one frame to the next [J]; `value` and `frame` alone.
    const std::optional<FrameExtreme>& energy_growth() const { return energy_growth_; }

  private:
    bool is_cut_to(const std::vector<Vec3f>& x) const;
    int strands_, particles_;
    double fps_;
    std::vector<float> per_square_length_;  // (strand, particle) [1/m²] of the edge after it
    std::vector<Vec3f> before_;             // (strand, particle) in the frame before
    int frame_ = -2;
    std::optional<double> energy_;
    std::optional<FrameExtreme> stretch_, overstretched_, speed_, overspeed_, energy_growth_;
};

}  // namespace wetcurl

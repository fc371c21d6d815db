// How far one run is from another: position, orientation, curvature, curl, stretch, depth in solids, clumps,
// motion. What is seen counts: displayed positions p^w where a run has them.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/run_cache.h"

namespace wetcurl {

// Signed distance [m] of a world point to the nearest solid, negative inside, with the head at a pose, at a
// time [s].
using SolidDistance = std::function<float(const Vec3f& x, const Pose& head, double time)>;

struct Spread {
    double mean = 0, p95 = 0, max = 0, median = 0;
};

struct Comparison {
    std::string file, method, kind;  // kind: as kind_of says (base/run_cache.h)
    int frames = 0;                  // compared
    // Mean over the compared frames but frame 0.
    double seconds_per_frame = 0, seconds_per_frame_reference = 0;
    // Distance of equal particles [mm]; shared: strands of even pixels (the low-resolution ones), the rest
    // new.
    Spread position_mm, shared_mm, new_mm;
    double position_rel = 0;           // mean distance over the strand's rest length
    std::vector<double> mm_per_frame;  // (compared frame) mean distance of equal particles [mm]
    // The mean over time of the error in the head's frame, and the root mean square of what that leaves [mm].
    double static_mm = 0, dynamic_mm = 0;
    // Harmonic mean of precision and recall of points with a counterpart within (2, 3, 4 mm) and (20, 30, 40
    // degrees) of direction, on at most 16 frames and 50,000 points of each.
    std::array<double, 3> f1{};
    double curvature_error =
        0;  // mean |1/R - 1/R_ref| over mean 1/R_ref, R the circumradius of three neighbours
    double curl_radius_ratio = 0;  // mean curl radius over the reference's (learn/codec/core_detail.h)
    // Mean distance of equal particles of the strands themselves, p, before Eq 10 moves what is seen [mm];
    // none where a run has nothing but what is seen.
    std::optional<double> strands_mm;
    // |e|/l - 1, l at rest; of its size the mean.
    double stretch_max = 0, stretch_max_reference = 0, stretch_mean = 0, stretch_mean_reference = 0;
    // Share of particles deeper than 0.1 mm in a solid, where depth is below min(0, phi at rest); mean over
    // those [mm].
    double penetration_fraction = 0, penetration_mean_mm = 0, penetration_max_mm = 0;
    // How much nearer to a solid, or farther, a particle is than the reference's [mm]; over those within 2 cm
    // of one in either run.
    Spread solid_distance_mm;
    // Mean distance of a tip to its four nearest other tips, and groups of tips (linked when closer than half
    // the roots' median nearest distance), on at most 16 frames.
    double tip_spread_mm = 0, tip_spread_reference_mm = 0, tip_spread_ratio = 0;
    double clumps = 0, clumps_reference = 0;
    // How many particles of other strands lie within 4 mm of one, on at most 16 frames and 50,000 particles:
    // locks are dense all along.
    double crowd = 0, crowd_reference = 0;
    // Root mean square third difference over frames while the head stands still [mm]; none where it never
    // does.
    std::optional<double> jitter_mm, jitter_reference_mm;
    // How far strands were expected to be off by the network itself [mm], and how well it ranks them by their
    // means over the frames (Spearman's rank correlation); none where it did not say.
    std::optional<double> expected_mm, expected_rank;
    double velocity_error = 0;  // mean |v - v_ref| [m/s], v by differences of frames
};

// Frames from `first_frame` on that both runs have. `solid` may be empty: no penetration is measured. Throws
// Error where the runs do not show the same strands (groom), the same motion and frame rate, where no frame
// is left, or where a position is not finite.
Comparison compare(const RunReader& reference, const RunReader& other, int first_frame,
                   const SolidDistance& solid);

// Spearman's: of the ranks of equally many values; 0 where one has only equal values.
double rank_correlation(const std::vector<double>& a, const std::vector<double>& b);

// The parts, each of one frame.

// 1/R of the circle through three points [1/m]; 0 on a line.
double inverse_circumradius(const Vec3f& a, const Vec3f& b, const Vec3f& c);
std::array<double, 3> oriented_f1(const Strands& reference, const Strands& other);
// Mean distance of a tip to its `k` nearest others [m]; fewer where there are fewer.
double tip_spread(const Strands& strands, int k = 4);
// Groups of tips linked when nearer than `link` [m].
int clump_count(const Strands& strands, float link);
// Particles of other strands within `reach` [m] of a particle, mean.
double crowd(const Strands& strands, float reach);
// Half the median distance of a root to its nearest other [m].
float clump_link(const Groom& groom);

}  // namespace wetcurl

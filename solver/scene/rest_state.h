// The rest state of a scene's strands: lengths, targets of the bend, core lengths and masses, in double.
// Ours; `sag_free` is an inverse solve: the drawn shape in equilibrium under gravity.
#pragma once

#include <vector>

#include "solver/scene/scene.h"

namespace wetcurl {

struct StrandRest {
    std::vector<Vec3d>
        start;  // (n) where the strand begins: as drawn, or as far as it is wet in its wet curl [m]
    std::vector<double> mass;         // (n) [kg], wet weight included
    std::vector<double> rest_length;  // (n-1) [m]
    std::vector<Vec3d> target;        // (n-1) tbar_i, curl included
    std::vector<double> rest_core;    // (n-1) |bbar_i| [m]
    std::vector<Quatd> frame;         // (n-1) F_i at the start, in the head's frame
    Fibre::Springs springs;           // (n-1) wet; empty without a fibre
};

// Frames along p (n), n at least 2, without any twist, from the root's -> (n-1).
std::vector<Quatd> frames_along(const std::vector<Vec3d>& p);

// How all strands lie at rest with the scene's water in them: StrandRest::start.
Strands shape_at_rest(const Scene& scene);

// What of it follows the water in the hair, and from what.
struct Soaking {
    std::vector<double> dry_mass;  // (n) [kg]
    std::optional<WetCurl> curl;   // that is blended
    std::vector<double> core,
        rest_core;           // (n-1) |bbar_i| of the dry target, and as drawn; empty without both
    Fibre::Springs springs;  // (n-1) dry; empty without a fibre
};

// Strand `s` of the scene's groom; `soaking`, where given, receives what `soak` needs of it.
StrandRest rest_state_of(const Scene& scene, int s, Soaking* soaking = nullptr);
// Mass, springs, target and core lengths of `rest` at another saturation (n) of the strand; the last two are
// left as they are where no curl blends them. In the memory of `rest`; `points`: room.
void soak(const Scene& scene, const Soaking& soaking, const float* saturation, StrandRest& rest,
          std::vector<Vec3d>& points);

// Dry masses (n) [kg] of a strand p (n) [m]: half of each segment to either end. density [kg/m].
std::vector<double> dry_masses(const std::vector<Vec3d>& p, double density);
// Of strand `s` of a scene's groom.
std::vector<double> dry_masses(const Scene& scene, int s);
// |bbar_i| (n-1) [m]: lengths of a strand's edges p (n) smoothed by a core's filter.
std::vector<double> core_lengths(const std::vector<Vec3d>& p, double beta);
// [m] of a strand p (n): (n-1).
std::vector<double> edge_lengths(const std::vector<Vec3d>& p);
// A strand's points in double, (n).
std::vector<Vec3d> points_of(const Strands& strands, int s);

// Mean rest length of a segment over the whole groom [m].
double mean_segment(const Groom& groom);

// V = m / rho (strand, particle) [m^3], as Eq 10 takes it.
std::vector<float> volumes_of(const Scene& scene);

}  // namespace wetcurl

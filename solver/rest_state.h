// The rest state of a scene's strands: lengths, targets of the bend, core lengths and masses, in double.
// Ours; `sag_free` is an inverse solve: the drawn shape in equilibrium under gravity.
#pragma once

#include <vector>

#include "solver/scene.h"

namespace wetcurl {

struct StrandRest {
    std::vector<Vec3d>
        start;  // (n) where the strand begins: as drawn, or as far as it is wet in its wet curl [m]
    std::vector<double> mass;         // (n) [kg], wet weight included
    std::vector<double> rest_length;  // (n-1) [m]
    std::vector<Vec3d> target;        // (n-1) tbar_i, curl included
    std::vector<double> rest_core;    // (n-1) |bbar_i| [m]
    std::vector<Quatd> frame;         // (n-1) F_i at the start, in the head's frame
};

// Frames along p (n), n at least 2, without any twist, from the root's -> (n-1).
std::vector<Quatd> frames_along(const std::vector<Vec3d>& p);

// Strand `s` of the scene's groom.
StrandRest rest_state_of(const Scene& scene, int s);

// Mean rest length of a segment over the whole groom [m].
double mean_segment(const Groom& groom);

// How deep each particle may lie in what is attached to the head: min(0, phi at rest) [m], (strand,
// particle); empty where nothing is attached.
std::vector<float> rest_depths_of(const Scene& scene);

// V = m / rho (strand, particle) [m^3], as Eq 10 takes it.
std::vector<float> volumes_of(const Scene& scene);

}  // namespace wetcurl

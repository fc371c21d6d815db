// Turns of curls, and how many particles stand for them well.
#pragma once

#include "solver/grooms/readers.h"

namespace wetcurl {

// Measured on hanging coils of 2 to 4 mm radius, 12 to 24 turns, stiffness EI / l³ of one fibre, no drag:
// against 24 particles a turn a coil lengthens under its own weight by 0.55 as much with 3 particles a turn,
// 0.67 with 4, 0.84 with 6, 0.91 with 8 and 0.98 with 12; its radius stays within 1 % in all. A polyline of 8
// comes within 8 % of the curve that it stands for, one of 6 within 13 %.
inline constexpr double enough_particles_of_a_turn = 8;
// With fewer, a polyline has no radius that is its curl's.
inline constexpr double fewest_particles_of_a_turn = 3;

struct CurlTurns {
    double turns = 0;   // 0: straight
    double radius = 0;  // [m]
};
// Of one strand's points, root first. What winds by less than half a millimetre, or without a regular hand,
// is taken for straight: it is noise.
CurlTurns turns_of(const std::vector<Vec3d>& strand);
// Of strands the one that three quarters of them turn no more than; at most 256 are looked at.
CurlTurns turns_of(const StrandPoints& strands);

// How many particles of a strand would do.
int enough_particles(const CurlTurns& curl);

}  // namespace wetcurl

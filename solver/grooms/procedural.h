// The built-in groom: roots on a grid over a scalp, strands that leave it, part from the face, fall, and curl
// round their fall.
#pragma once

#include "base/parameters.h"
#include "base/strands.h"
#include "solver/grooms/import.h"
#include "solver/grooms/root_grid.h"
#include "solver/grooms/scalp.h"
#include "solver/grooms/turns.h"

namespace wetcurl {

struct ProceduralGroom {
    int width = 32, height = 32;  // roots each way
    int particles = 50;           // of each strand
    unsigned long long seed = 0;

    double length;                      // along the strand [m]
    double curl_radius;                 // [m]; 0: straight
    double pitch;                       // along the core, a turn [m]
    double phase_noise;                 // [rad]
    double radius_noise, length_noise;  // fractions
    double lift;                        // how far a strand stands out before it falls [m]
    double comb;                        // pull away from the part, against gravity's 1
    double scalp_radius;                // [m]
    double coverage;                    // from the cap's pole to its rim [rad]
    double tilt;                        // of the pole, back from straight up [rad]

    std::shared_ptr<const ScalpMesh> head;  // instead of the ball, where given
    Vec3d scalp_centre{0, 0, 0};            // [m]
};

inline constexpr Parameter<ProceduralGroom> procedural_parameters[] = {
    {"length", &ProceduralGroom::length, "m", 0.25, 1e-3, 10, "length along a strand"},
    {"curl_radius", &ProceduralGroom::curl_radius, "m", 0.006, 0, 0.1, "radius of the helix round the core"},
    {"pitch", &ProceduralGroom::pitch, "m", 0.025, 1e-4, 10, "of the helix: advance along the core, a turn"},
    {"phase_noise", &ProceduralGroom::phase_noise, "rad", 1.5, 0, 3.141592653589793,
     "largest shift of the helix's phase"},
    {"radius_noise", &ProceduralGroom::radius_noise, "1", 0.1, 0, 0.9,
     "largest change of the curl radius, a fraction"},
    {"length_noise", &ProceduralGroom::length_noise, "1", 0.1, 0, 0.9,
     "largest change of the length, a fraction"},
    {"lift", &ProceduralGroom::lift, "m", 0.02, 1e-3, 0.2, "how far a strand stands out before it falls"},
    {"comb", &ProceduralGroom::comb, "1", 1.5, 0, 10,
     "pull away from the part at the brow, against gravity's 1"},
    {"scalp_radius", &ProceduralGroom::scalp_radius, "m", 0.095, 0.01, 1,
     "of the ball; of a mesh: its centre's depth below the top"},
    {"coverage", &ProceduralGroom::coverage, "rad", 1.6, 0.1, 3.0,
     "from the middle of the hair to its rim, seen from the centre"},
    {"tilt", &ProceduralGroom::tilt, "rad", 0.7, 0, 1.5,
     "of the middle of the hair, back from straight up: the face (+Z) stays free"},
};

// Reads `[groom]`: the rows above, `grid` = [W, H] (1 to 4096), `particles` (2 to 10000), `scalp_centre` [m],
// and a head mesh, `scalp`, in the ball's place. Throws Misuse for what is out of range.
ProceduralGroom read_procedural(const Table& table, unsigned long long seed);

// `[groom] grid` = [W, H].
GridSize read_grid(const Table& table, GridSize fallback);
// `[groom] units` (m | cm | mm | auto) and `up` (y | z), of hair and scalp.
FileUnits read_units(const Table& table);
// The head's mesh that `[groom] scalp` names, with `scalp_units` and `scalp_up` where they are not those of
// the hair; null where it names none.
std::shared_ptr<const ScalpMesh> read_scalp(const Table& table);

// Of a strand of no noise, as its curl winds once it is open.
CurlTurns turns_of(const ProceduralGroom& groom);

// Root (i, j) at (i / width, j / height) of the parameter square. A strand depends on that place, the seed
// and the parameters, never on the size of the grid: grids nest to the bit.
Groom make_procedural(const ProceduralGroom& groom);

}  // namespace wetcurl

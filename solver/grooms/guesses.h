// What a file and a scene leave open of units and axes, guessed from shapes. Callers print a guess as a
// guess.
#pragma once

#include <string>
#include <vector>

#include "base/geometry/mesh.h"
#include "solver/grooms/readers.h"

namespace wetcurl {

// A guess, and why; an empty word where nothing fits.
struct Guess {
    std::string word, reason;
    double away = 0;  // [m] of roots from a mesh, in the median
};

// The one of `units` (m, cm, mm) in which roots [m] lie on the mesh, whose numbers are the file's.
Guess guessed_unit(const Mesh& mesh, const std::vector<Vec3d>& roots, const std::vector<std::string>& units);
// The unit in which the mesh has the size of a head or a body.
Guess guessed_unit(const Mesh& mesh);

// The axis of a file (of axis_words) that points up, by two signs: hair falls from roots to tips, and roots
// lie on the upper side of a head. "y" unless both are clearly for another one.
Guess guessed_up(const StrandPoints& strands);

}  // namespace wetcurl

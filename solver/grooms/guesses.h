// What a file and a scene leave open of units, guessed from shapes; who uses a guess says it.
#pragma once

#include <string>
#include <vector>

#include "base/geometry/mesh.h"

namespace wetcurl {

// A guess, and why.
struct Guess {
    std::string word, reason;
};

// The unit in which roots [m] lie on the mesh, given in units of its file; without roots the one in which it
// has the size of a head or a body. An empty word where no unit fits.
Guess guessed_unit(const Mesh& mesh, const std::vector<Vec3d>& roots);

}  // namespace wetcurl

// Scenes that nobody would write: keys at random, by the rows of the tables.
#pragma once

#include <string>

namespace wetcurl {

// A scene as TOML, a function of the seed alone. Tables are there or not; a key that is written has a value
// between a tenth and ten times its default, in its range; solids lie anywhere and move. It may be one that
// is refused when it is read.
std::string storm_scene(unsigned long long seed);

}  // namespace wetcurl

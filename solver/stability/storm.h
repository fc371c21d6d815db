// Scenes that nobody would write: keys at random, by the rows of the tables.
#pragma once

#include <map>
#include <string>

namespace wetcurl {

struct RandomScene {
    std::string text;                          // TOML
    std::map<std::string, std::string> files;  // meshes that it names, by name: what stands in them
};

// A function of the seed alone. Tables are there or not; a key that is written has a value between a tenth
// and ten times its default, in its range; solids lie anywhere and move, meshes among them, one of which may
// deform and carry the roots; the shot may have a cut and a preroll. It may be one that is refused when it is
// read.
RandomScene storm_scene(unsigned long long seed);

}  // namespace wetcurl

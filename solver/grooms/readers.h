// Readers of strand files: points as they stand in the file (its units, its up axis), root first. Ours;
// layouts by the formats' authors (Yuksel; Hu 2015 USC-HairSalon; Shen 2023 CT2Hair; AMD TressFX 4; Turk 1994
// PLY). Each throws Error with file, byte or strand, what was found and what is allowed: for a file that is
// missing, empty, cut short, foreign, of another version, with counts beyond its size, with NaN or infinite
// points.
#pragma once

#include <string>
#include <vector>

#include "base/vec3.h"

namespace wetcurl {

using StrandPoints = std::vector<std::vector<Vec3d>>;

StrandPoints read_hair(const std::string& path);  // Cem Yuksel
StrandPoints read_data(const std::string& path);  // USC-HairSalon
StrandPoints read_bin(const std::string& path);   // CT2Hair
StrandPoints read_ply(const std::string& path);   // `element strand {nsegs}`, or 100 vertices a strand
StrandPoints read_tfx(const std::string& path);   // TressFX 4

}  // namespace wetcurl

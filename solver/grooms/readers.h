// Readers of strand files: points as they stand in the file (its units, its up axis), root first, strands in
// the order of the file. Layouts by the formats' authors (Yuksel; Hu 2015 USC-HairSalon; Shen 2023 CT2Hair;
// AMD TressFX 4; Turk 1994 PLY; Wavefront; Rosu 2025 DiffLocks). Each throws Error with file, byte, line or
// strand, what was found and what is allowed: for a file that is missing, empty, cut short, foreign, of
// another version, with counts beyond its size, with NaN or infinite points.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/exchange/scene_file.h"
#include "base/vec3.h"

namespace wetcurl {

using StrandPoints = std::vector<std::vector<Vec3d>>;  // (strand, point)
using StrandWidths = std::vector<std::vector<float>>;  // (strand, point): diameters

// What a file holds of its strands; what it does not say is empty.
struct StrandFile {
    StrandPoints points;
    StrandWidths widths;                        // in the unit of the points
    std::vector<int> ids, groups;               // (strand)
    std::vector<std::array<float, 2>> root_uv;  // (strand)
    FileAxes axes;
};

StrandFile read_hair(const std::string& path);  // Cem Yuksel
StrandFile read_data(const std::string& path);  // USC-HairSalon
StrandFile read_bin(const std::string& path);   // CT2Hair
// `element strand {nsegs}`; or `element edge {vertex1, vertex2}`, whose edges join vertices to strands; or
// 100 vertices a strand.
StrandFile read_ply(const std::string& path);
StrandFile read_tfx(const std::string& path);  // TressFX 4
StrandFile read_obj(const std::string& path);  // `l` lines; faces are passed over
StrandFile read_npz(const std::string& path);  // DiffLocks: positions (strand, point, 3), root_uv (strand, 2)
// All curves of a .abc or .usda file (base/exchange), object after object, at the first sample of each. Cubic
// ones become points, four for each piece: the knots and three between them.
StrandFile read_curves(const std::string& path);

}  // namespace wetcurl

// Strands and scalps from files of other programs, brought to metres and Y up; degenerate strands dropped and
// counted, units never guessed silently; and strands written for them.
#pragma once

#include <string>

#include "base/geometry/mesh.h"
#include "solver/grooms/readers.h"

namespace wetcurl {

// How a file's numbers are meant.
struct FileUnits {
    std::string units = "auto";  // m | cm | mm | auto: as the file says, else guessed by its size
    // x | -x | y | -y | z | -z | auto: as the file says, else y, or another one by how hair falls
    std::string up = "auto";
};

struct ImportedStrands {
    StrandPoints strands;  // metres, Y up, root first; two points or more each, no point twice in a row
    std::vector<size_t> numbers;  // (strand): its number in the file
    // What the file says of them, else empty; of the strands above, in their order.
    StrandWidths widths;                        // diameters [m]
    std::vector<int> ids, groups;               // (strand)
    std::vector<std::array<float, 2>> root_uv;  // (strand)

    Vec3d origin{0, 0, 0};  // where the file's origin has come to lie [m]

    size_t found = 0;  // strands in the file, the dropped ones included
    // Dropped strands, by reason.
    size_t no_points = 0, one_point = 0, no_length = 0;
    std::vector<size_t> dropped_numbers;
    size_t repeated_points =
        0;                 // points left out of strands that were kept, since they stand on the one before
    std::string units;     // m | cm | mm, or "0.0254 m", as used
    bool guessed = false;  // by the file's size, and said in the log
    std::string up;        // the file's axis that points up, as used
    // Why, where it was guessed; empty where it is told, or y in want of a sign of another one.
    std::string up_reason;
    bool up_told = false;  // by the caller or the file

    size_t dropped() const { return no_points + one_point + no_length; }
};

// A strand that is shorter has no length: about the width of a hair [m].
inline constexpr double shortest_strand = 1e-4;

// Endings that import_strands reads, and write_strands writes: ".hair .data ...".
std::string readable_endings();
std::string writable_endings();

// Reads by the file's ending. Where the file says its units or up axis and `meant` says another, `meant`
// holds, with a warning. Throws Misuse for an ending, units or an up axis that are not known; Error for bad
// data, for a file without a strand, and for one whose strands are all degenerate.
ImportedStrands import_strands(const std::string& path, const FileUnits& meant);
// Strands that are in memory [m], Y up; `what` names them in errors, which are the same.
ImportedStrands strands_in_metres(const StrandPoints& points, const std::string& what);
// A head or scalp mesh [m], Y up, as it first stands in its file; units as above.
Mesh import_mesh(const std::string& path, const FileUnits& meant);

// Throws Misuse where the ending of `path` is none that write_strands knows, Error where the file exists and
// `overwrite` is not given: to be found out before the work is done.
void require_writable(const std::string& path, bool overwrite);
// Writes strands, Y up, by the ending of `path`, as an OutputFile. `widths`: one a point, or empty. `unit`:
// of both. Throws as above; Error where writing fails, a strand has fewer than two points or more than the
// format holds, or widths do not fit the strands.
void write_strands(const std::string& path, const StrandPoints& strands, bool overwrite,
                   const StrandWidths& widths = {}, const std::string& unit = "metres");

}  // namespace wetcurl

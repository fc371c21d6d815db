// Strands and scalps from files of other programs, brought to metres and Y up; degenerate strands dropped and
// counted, units never guessed silently; and strands written for them.
#pragma once

#include <string>

#include "base/geometry/mesh.h"
#include "solver/grooms/readers.h"

namespace wetcurl {

// How a file's numbers are meant.
struct FileUnits {
    std::string units = "auto";  // m | cm | mm | auto
    std::string up = "y";        // y | z
};

struct ImportedStrands {
    StrandPoints strands;  // metres, Y up, root first; two points or more each, no point twice in a row
    std::vector<int> numbers;  // (strand): its number in the file, from 0
    size_t found = 0;      // strands in the file, the dropped ones included
    // Dropped strands, by reason.
    size_t no_points = 0, one_point = 0, no_length = 0;
    size_t repeated_points =
        0;                 // points left out of strands that were kept, since they stand on the one before
    std::string units;     // m | cm | mm, as used
    bool guessed = false;  // by the file's size, and said in the log

    size_t dropped() const { return no_points + one_point + no_length; }
};

// Endings that import_strands reads, and write_strands writes: ".hair .data ...".
std::string readable_endings();
std::string writable_endings();

// Reads by the file's ending. Throws Misuse for an ending, units or an up axis that are not known; Error for
// bad data, for a file without a strand, and for one whose strands are all degenerate.
ImportedStrands import_strands(const std::string& path, const FileUnits& meant);
// A head or scalp mesh [m], Y up; units as above.
Mesh import_mesh(const std::string& path, const FileUnits& meant);

// Throws Misuse where the ending of `path` is none that write_strands knows, Error where the file exists and
// `overwrite` is not given: to be found out before the work is done.
void require_writable(const std::string& path, bool overwrite);
// Writes metres, Y up, by the ending of `path`, as an OutputFile.
// Throws as above; Error where writing fails or a strand has more points than the format holds.
void write_strands(const std::string& path, const StrandPoints& strands, bool overwrite);

}  // namespace wetcurl

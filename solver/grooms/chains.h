// Strands of files that say only which points are joined.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace wetcurl {

// The chains that `edges` (pairs of vertices) make of `vertices` vertices, in the order of their lowest
// vertex. A chain begins at the end from which its edges lead away; where they lead both ways, at the end of
// lower number. A vertex without an edge is a chain of one. Throws Error, which begins with `path`, for
// vertices that are not there, and for a vertex where a chain branches or closes.
std::vector<std::vector<size_t>> chains_of(const std::vector<std::array<size_t, 2>>& edges, size_t vertices,
                                           const std::string& path);

}  // namespace wetcurl

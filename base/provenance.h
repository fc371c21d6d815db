// Provenance: the program, its build and the machine that made a file. Every HDF5 file and every JSON result
// holds it.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace wetcurl {

// Name and text of each fact: version; revision of the sources (the commit's first twelve digits, ", changed"
// where the sources had changes that no commit holds, or "unknown" outside of git); preset of CMake ("none");
// compiler; instruction_set: AVX-512, AVX2 or SSE, and the build's -march; processor, as the system names it;
// gpu ("none"); date (UTC, or that of SOURCE_DATE_EPOCH).
using Provenance = std::vector<std::pair<std::string, std::string>>;
Provenance provenance();

// The machine's processor, as the system names it, or "unknown".
std::string processor_name();

// The GPU that this process computes on.
void note_gpu(const std::string& name);

}  // namespace wetcurl

// Pairs of runs to pairs files.
// Ours; Eq 14-17 for codec root.
#pragma once

#include <memory>

#include "base/run_cache.h"
#include "learn/pairs.h"

namespace wetcurl {

// A dry run and its wet twin of twice the resolution each way.
struct RunPair {
    std::unique_ptr<RunReader> dry, wet;
    // Opens both. Throws Error unless they show the same seed, frames, rate and head motion, the dry grid
    // nests in the wet one, and the wet run knows its saturation.
    RunPair(const std::string& dry_path, const std::string& wet_path);
};

// Both throw Interrupted; what was added is in `out`.

// Adds the pair to `out` (codec strand). Returns the mean distance that encoding costs the wet strands [mm].
double encode_strands(const RunPair& pair, PairsWriter& out);

// Adds the pairs to `out` (codec root) with one box for all; `support_radius` h of Eq 16 [m].
void encode_roots(const std::vector<RunPair>& pairs, float support_radius, PairsWriter& out);

}  // namespace wetcurl

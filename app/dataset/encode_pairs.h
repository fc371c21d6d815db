// Training pairs of runs or, for the adhesion network, of scenes.
#pragma once

#include <string>
#include <vector>

#include "app/options/common_options.h"

namespace wetcurl {

struct PairsRequest : CommonOptions {
    std::vector<std::string> inputs;  // DRY.h5 WET.h5 pairs, or wet runs for adhesion samples
    std::string output, codec = "strand";
    std::string colour_units;  // of Eq 16, codec root; "": length
};

// Encodes all of them into the file `output`. Throws Misuse for inputs that do not go together, Error for
// files that do not fit, and Interrupted after a signal.
void encode_pairs(const PairsRequest& request);

}  // namespace wetcurl

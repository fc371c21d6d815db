// What a simulation carries from frame to frame beside the strands' arrays.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace wetcurl {

// Numbers by name; of one scene and device, each name has the same number of them in every frame. What holds
// single precision or whole numbers below 2^53 comes back to the bit.
using Carried = std::map<std::string, std::vector<double>>;

}  // namespace wetcurl

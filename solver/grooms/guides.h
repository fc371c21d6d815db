// Which strands of a groom to simulate, where the others follow them.
// Ours: k-medoids of roots and shapes, begun with the farthest first (Gonzalez 1985).
#pragma once

#include <vector>

#include "base/strands.h"

namespace wetcurl {

// So many strands of the groom, rising, spread so that few lie far, at their roots or along them, from the
// guide nearest to them: there are more of them where hair parts and changes. The same groom gives the same
// guides. Throws Misuse unless 1 ≤ count ≤ number of strands.
std::vector<int> chosen_guides(const Groom& full, int count);

}  // namespace wetcurl

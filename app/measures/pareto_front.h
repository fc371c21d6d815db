// Ways weighed by two costs at once, the run time of a frame and its error: which of them no other betters,
// and how much of the plane they take. Pareto front; hypervolume: Zitzler and Thiele 1999, here of
// logarithms.
#pragma once

#include <cstddef>
#include <vector>

namespace wetcurl {

struct Cost {
    double seconds = 0, mm = 0;  // of a frame [s]; mean error [mm]
};

// Indices of those that no other betters (no dearer in either, cheaper in one), by rising time, then error,
// then index. Equals are all on the front.
std::vector<size_t> front_of(const std::vector<Cost>& costs);

// Where the hypervolume starts and ends: what costs more than `worst_cost` in either counts for nothing, what
// costs less than `best_cost` counts as that much, since logarithms have no end there.
inline constexpr Cost worst_cost{1, 100}, best_cost{1e-5, 0.01};

// Area [decades²] of the points (log10 s, log10 mm) that some cost is no dearer than and that are no dearer
// than the worst; 0 of none, 20 of one that is no dearer than the best.
double log_hypervolume(const std::vector<Cost>& costs, const Cost& worst = worst_cost,
                       const Cost& best = best_cost);

}  // namespace wetcurl

// The most that any colours could reach through Eq 18: of the weights that it gives a strand's neighbours,
// those that bring the strand nearest to where it should be. Whatever the colours, the gain and the units, a
// weight is one number a neighbour and strand, and never negative.
#pragma once

#include <array>
#include <vector>

#include "base/vec3.h"

namespace wetcurl {

inline constexpr int most_neighbours = 4;
using NeighbourWeights = std::array<double, most_neighbours>;

// Of a x = b in the least squares sense, x ≥ 0, from the normal equations: `square` (width, width) a^T a,
// `right` (width) a^T b, width ≤ 4. Exact: every set of positive unknowns is tried.
NeighbourWeights nonnegative_least_squares(const double square[most_neighbours][most_neighbours],
                                           const double right[most_neighbours], int width);

// The weights w ≥ 0 that minimise sum_i |distance_i - sum_k w_k pull_ki|, by least squares reweighted
// (Weiszfeld) until the sum falls by less than 1e-4 of itself. distance (n) [m], pull (width, n).
NeighbourWeights nearest_weights(const std::vector<Vec3d>& distance, const std::vector<Vec3d>& pull,
                                 int width);

}  // namespace wetcurl

// Turns of curls.
#include "solver/grooms/turns.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/strands.h"
#include "solver/terms/curl.h"

namespace wetcurl {

CurlTurns turns_of(const std::vector<Vec3d>& strand) {
    constexpr double least_radius = 5e-4, least_coherence = 0.5;
    const int n = int(strand.size());
    if (n < 4) return {};
    // Even segments: a turn is counted by them.
    const auto even = resampled(strand, n);
    const Turning turning = turning_of(intrinsic_shape(even));
    const double half = std::numbers::pi / turning.segments_of_a_turn();
    const double segment = arc_length(even.data(), n) / (n - 1);
    // sin(theta/2) = sin(alpha) sin(half) of a helix whose edges, 2 r sin(half) / sin(alpha) long, stand at
    // alpha to its axis.
    const double radius = segment * std::sin(turning.theta / 2) / (2 * std::sin(half) * std::sin(half));
    const double turns = (n - 1) / turning.segments_of_a_turn();
    if (turns < 1 || radius < least_radius || turning.coherence < least_coherence) return {};
    return {turns, radius};
}

CurlTurns turns_of(const StrandPoints& strands) {
    constexpr size_t most = 256;
    std::vector<CurlTurns> all;
    for (size_t s = 0; s < strands.size(); s += 1 + strands.size() / most)
        all.push_back(turns_of(strands[s]));
    if (all.empty()) return {};
    const auto middle = all.begin() + long(all.size() / 2);
    std::nth_element(all.begin(), middle, all.end(),
                     [](const CurlTurns& a, const CurlTurns& b) { return a.turns < b.turns; });
    return *middle;
}

int enough_particles(const CurlTurns& curl) {
    return int(std::ceil(enough_particles_of_a_turn * curl.turns)) + 1;
}

}  // namespace wetcurl

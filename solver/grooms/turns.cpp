// Turns of curls.
#include "solver/grooms/turns.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/strands.h"
#include "solver/terms/curl.h"

namespace wetcurl {

namespace {

// Of a strand by so many points at even distances: its turns, and the radius of the helix of such edges.
struct TurnsByPoints {
    CurlTurns curl;
    double coherence;
    bool right_handed;
    TurnsByPoints(const std::vector<Vec3d>& strand, int points) {
        const auto even = resampled(strand, points);
        const Turning turning = turning_of(intrinsic_shape(even));
        const double half = std::numbers::pi / turning.segments_of_a_turn();
        const double segment = arc_length(even.data(), points) / (points - 1);
        // sin(theta/2) = sin(alpha) sin(half) of a helix whose edges, 2 r sin(half) / sin(alpha) long, stand
        // at alpha to its axis.
        curl = {(points - 1) / turning.segments_of_a_turn(),
                segment * std::sin(turning.theta / 2) / (2 * std::sin(half) * std::sin(half))};
        coherence = turning.coherence, right_handed = turning.phase > 0;
    }
};

}  // namespace

// Noise and corners between sparse control points spoil fine points, and few points show fast turns as slow
// ones, of another number for another count of points and of either hand. So the turns are those on which two
// counts agree, the most coherent two.
CurlTurns turns_of(const std::vector<Vec3d>& strand) {
    constexpr double least_radius = 5e-4, least_coherence = 0.5, regular = 0.9, alike = 0.1;
    constexpr int fewest_points = 8;
    const int n = int(strand.size());
    if (n < 4) return {};
    TurnsByPoints finer(strand, n);
    CurlTurns found;
    double best = least_coherence;
    if (finer.coherence >= regular) found = finer.curl;  // a helix
    for (int points = n * 2 / 3; points >= fewest_points; points = points * 2 / 3) {
        const TurnsByPoints coarser(strand, points);
        const double coherence = std::min(finer.coherence, coarser.coherence);
        if (finer.right_handed == coarser.right_handed && coherence > best &&
            std::abs(finer.curl.turns - coarser.curl.turns) < alike * finer.curl.turns)
            found = finer.curl, best = coherence;
        finer = coarser;
    }
    return found.turns < 1 || found.radius < least_radius ? CurlTurns() : found;
}

CurlTurns turns_of(const StrandPoints& strands) {
    constexpr size_t most = 256;
    std::vector<CurlTurns> all;
    for (size_t s = 0; s < strands.size(); s += 1 + strands.size() / most)
        all.push_back(turns_of(strands[s]));
    if (all.empty()) return {};
    const auto curly = all.begin() + long(all.size() * 3 / 4);
    std::ranges::nth_element(all, curly, {}, &CurlTurns::turns);
    return *curly;
}

int enough_particles(const CurlTurns& curl) {
    return int(std::ceil(enough_particles_of_a_turn * curl.turns)) + 1;
}

}  // namespace wetcurl

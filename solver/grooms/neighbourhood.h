// How near strands lie to each other.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/strands.h"

namespace wetcurl {

// Distances between particles of different strands: of some to some of all others.
class Neighbourhood {
  public:
    explicit Neighbourhood(const Strands& hair) {
        constexpr size_t most = 200, most_others = 5000;  // a million distances
        const size_t all = hair.points.size(), looked_at = std::min(all, most),
                     others = std::min(all, most_others);
        // The i-th of a sequence that fills the hair evenly and has no step in common with its strands.
        const auto spread = [&](size_t i, double turn) {
            const double turns = double(i) * turn;
            return std::min(all - 1, size_t((turns - std::floor(turns)) * double(all)));
        };
        const auto strand_of = [&](size_t k) { return k / size_t(hair.particles); };
        for (size_t i = 0; i < looked_at; ++i) {
            const size_t k = looked_at == all ? i : spread(i, 0.7548776662466927);
            for (size_t j = 0; j < others; ++j) {
                const size_t other = others == all ? j : spread(i * others + j, 0.6180339887498949);
                if (strand_of(other) != strand_of(k))
                    distances_.push_back(norm(hair.points[k] - hair.points[other]));
            }
        }
        std::sort(distances_.begin(), distances_.end());
        for_one_ = double(others) / double(std::max<size_t>(all, 1)) * double(looked_at);
    }
    // Of one particle, in the mean, within a radius [m].
    double within(double radius) const {
        const auto end = std::upper_bound(distances_.begin(), distances_.end(), float(radius));
        return distances_.empty() ? 0 : double(end - distances_.begin()) / for_one_;
    }
    // [m] within which there are `count`, fewer than there are in all.
    double radius_of(double count) const { return distances_[size_t(count * for_one_)]; }

  private:
    std::vector<float> distances_;  // [m] rising
    double for_one_ = 1;            // distances for each neighbour of a particle
};

}  // namespace wetcurl

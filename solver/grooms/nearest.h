// The nearest of a set of points, by a sweep along x: exact, and quick enough for every root of a groom.
#pragma once

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include "base/vec3.h"

namespace wetcurl {

class NearestPoint {
  public:
    explicit NearestPoint(std::vector<Vec3d> points) : points_(std::move(points)), order_(points_.size()) {
        std::iota(order_.begin(), order_.end(), 0);
        std::sort(order_.begin(), order_.end(),
                  [&](int a, int b) { return points_[size_t(a)].x < points_[size_t(b)].x; });
    }

    // Distance [m] from x to the nearest point, the one of index `but` left out; infinite where there is
    // none.
    double distance(const Vec3d& x, int but = -1) const {
        double best = std::numeric_limits<double>::infinity();
        // False once the sweep is farther along x than the best found.
        auto consider = [&](int index) {
            const Vec3d away = points_[size_t(index)] - x;
            if (std::abs(away.x) >= best) return false;
            if (index != but) best = std::min(best, norm(away));
            return true;
        };
        const auto middle = std::lower_bound(order_.begin(), order_.end(), x.x, [&](int index, double at) {
            return points_[size_t(index)].x < at;
        });
        for (auto up = middle; up != order_.end() && consider(*up);) ++up;
        for (auto down = middle; down != order_.begin() && consider(*(down - 1));) --down;
        return best;
    }

  private:
    std::vector<Vec3d> points_;
    std::vector<int> order_;  // by x
};

}  // namespace wetcurl

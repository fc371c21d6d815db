// How hair falls, as the paper measures it in pictures (Fig 31, Table 2): the box around it, and the angle
// that strands make where they meet a solid. Beside them how far tips hang below roots (Fig 21), and how hair
// bounces on a solid (Fig 41).
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "app/measures/metrics.h"

namespace wetcurl {

inline constexpr float on_solid = 5e-3f;  // [m], where wet hair is held

struct Fall {
    double width = 0, height = 0;  // along X and Y [m]
    double drop = 0;               // of the tips below their roots, mean over the strands [m]
    // Between the free part of a strand and the part that lies on a solid, 180 straight on [degrees], the
    // mean over the strands that lie on one; none: none does.
    std::optional<double> angle;
};

// `solid`: distance to the solids that hair may lie on; empty: there are none.
inline Fall fall_of(const Strands& p, const SolidDistance& solid, const Pose& head, double time) {
    Fall out;
    if (p.points.empty()) return out;
    Vec3f low = p.points[0], high = low;
    for (const Vec3f& x : p.points) {
        low = {std::min(low.x, x.x), std::min(low.y, x.y), 0};
        high = {std::max(high.x, x.x), std::max(high.y, x.y), 0};
    }
    out.width = high.x - low.x;
    out.height = high.y - low.y;
    for (int s = 0; s < p.count; ++s) out.drop += double(p.at(s, 0).y - p.at(s, p.particles - 1).y) / p.count;
    const int n = p.particles, part = n / 5;  // of a strand, on either side: a turn of a curl or more
    if (!solid || part < 1) return out;
    double sum = 0;
    int strands = 0;
    for (int s = 0; s < p.count; ++s) {
        int i = part;
        while (i < n - part && solid(p.at(s, i), head, time) > on_solid) ++i;
        if (i == part || i >= n - part) continue;  // it begins there, or does not lie on it
        const Vec3f free = p.at(s, i - part) - p.at(s, i), held = p.at(s, i + part) - p.at(s, i);
        const double cosine = dot(free, held) / std::max(1e-12f, norm(free) * norm(held));
        sum += std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
        ++strands;
    }
    if (strands > 0) out.angle = sum / strands;
    return out;
}

// How hair bounces on a solid over which it slides (the paper, Sec. VI.C and Fig 41).
class Bounce {
  public:
    // The next frame: distance of each particle to the solid [m].
    void add(std::vector<float> distance) {
        for (size_t i = 0; i < distance.size() && i < last_.size() && i < before_.size(); ++i) {
            if (std::max({distance[i], last_[i], before_[i]}) > on_solid) continue;
            const double second = double(distance[i]) - 2 * double(last_[i]) + double(before_[i]);
            sum_ += second * second;
            ++count_;
        }
        before_ = std::move(last_);
        last_ = std::move(distance);
    }
    // Root mean square second difference of the distance over frames [m], over particles that lie on the
    // solid for three frames in a row; none: none does.
    std::optional<double> value() const {
        return count_ ? std::optional(std::sqrt(sum_ / double(count_))) : std::nullopt;
    }

  private:
    std::vector<float> last_, before_;  // (particle) [m], of the last frame and the one before
    double sum_ = 0;
    size_t count_ = 0;
};

}  // namespace wetcurl

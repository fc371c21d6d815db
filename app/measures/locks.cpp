#include "app/measures/locks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/geometry/neighbor_grid.h"

namespace wetcurl {

namespace {

// Four times the standard deviation across `along` of the points of `strands` that are listed.
double width_of(const Strands& strands, const std::vector<uint32_t>& listed, const Vec3d& along) {
    Vec3d mean{0, 0, 0};
    for (const uint32_t k : listed) mean += cast<double>(strands.points[k]);
    mean = (1 / double(listed.size())) * mean;
    double sum = 0;
    for (const uint32_t k : listed) {
        const Vec3d from = cast<double>(strands.points[k]) - mean, across = from - dot(from, along) * along;
        sum += dot(across, across);
    }
    return 4 * std::sqrt(sum / 2 / double(listed.size() - 1));
}

struct Sum {
    double gathered = 0, drawn = 0, strands = 0, count = 0;
};

}  // namespace

Locks locks_of(const Strands& simulated, const Strands& displayed, float reach) {
    constexpr int asked = 1000;
    const int n = displayed.particles, step = std::max(1, displayed.count / asked);
    Locks out;
    if (displayed.count == 0 || n < 3) return out;
    NeighborGrid grid;
    grid.build(displayed.points.data(), displayed.points.size(), reach);
    // The lock at particle i of strands, those of which a sum holds.
    const auto at = [&](int i) {
        Sum sum;
        std::vector<std::array<uint32_t, 2>> near;  // strand, particle of all
        std::vector<uint32_t> lock;
        for (int s = 0; s < displayed.count; s += step) {
            const Vec3f here = displayed.at(s, i);
            const auto far = [&](uint32_t k) { return norm(displayed.points[k] - here); };
            near.clear(), lock.clear();
            grid.around(here, [&](uint32_t k) {
                if (const uint32_t p = grid.order()[k]; far(p) <= reach) near.push_back({p / uint32_t(n), p});
            });
            std::sort(near.begin(), near.end());
            // The nearest of each strand.
            for (size_t k = 0; k < near.size(); ++k)
                if (k == 0 || near[k][0] != near[k - 1][0])
                    lock.push_back(near[k][1]);
                else if (far(near[k][1]) < far(lock.back()))
                    lock.back() = near[k][1];
            if (lock.size() < 3) continue;
            const Vec3d along =
                normalized(cast<double>(simulated.at(s, i + 1) - simulated.at(s, i - 1)), Vec3d{0, -1, 0});
            sum.gathered += width_of(simulated, lock, along), sum.drawn += width_of(displayed, lock, along);
            sum.strands += double(lock.size()), sum.count += 1;
        }
        return sum;
    };
    const int middle = std::clamp(2 * n / 3, 1, n - 2), tip = std::clamp(19 * n / 20, 1, n - 2);
    const Sum sum = at(middle), tips = at(tip);
    out.share = sum.count / double((displayed.count + step - 1) / step);
    if (sum.count > 0)
        out.gathered = sum.gathered / sum.count, out.drawn = sum.drawn / sum.count,
        out.strands = sum.strands / sum.count;
    if (tips.count > 0) out.tips = tips.drawn / tips.count;
    return out;
}

}  // namespace wetcurl

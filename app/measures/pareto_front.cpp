// Pareto front and hypervolume of two costs.
#include "app/measures/pareto_front.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace wetcurl {

std::vector<size_t> front_of(const std::vector<Cost>& costs) {
    std::vector<size_t> order(costs.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
        return std::tie(costs[a].seconds, costs[a].mm) < std::tie(costs[b].seconds, costs[b].mm);
    });
    std::vector<size_t> front;
    for (size_t k : order) {
        const Cost* last = front.empty() ? nullptr : &costs[front.back()];
        const bool equal = last && last->seconds == costs[k].seconds && last->mm == costs[k].mm;
        if (!last || equal || costs[k].mm < last->mm) front.push_back(k);
    }
    return front;
}

double log_hypervolume(const std::vector<Cost>& costs, const Cost& worst, const Cost& best) {
    double area = 0, left_mm = std::log10(worst.mm);  // what the faster ones leave
    for (size_t k : front_of(costs)) {
        const double s = std::log10(std::max(costs[k].seconds, best.seconds)),
                     mm = std::log10(std::max(costs[k].mm, best.mm));
        if (s >= std::log10(worst.seconds) || mm >= left_mm) continue;
        area += (std::log10(worst.seconds) - s) * (left_mm - mm);
        left_mm = mm;
    }
    return area;
}

}  // namespace wetcurl

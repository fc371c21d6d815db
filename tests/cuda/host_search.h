// The search on the host, particle by particle as the device's threads, with a scan between.
#pragma once

#include <numeric>
#include <utility>
#include <vector>

#include "cuda/device/cell_search.h"

namespace wetcurl::testing {

struct HostSearch {
    std::vector<uint32_t> rank, start, sorted_id;
    std::vector<SortedPoint> arrived, sorted;
    CellSearch view;

    HostSearch(const std::vector<Vec3f>& p, int particles, double radius, const Vec3f& origin)
        : rank(p.size()),
          start(wrapped_grid(p.size(), radius).cells() + 2),
          sorted_id(p.size()),
          arrived(p.size()),
          sorted(p.size() + CellSearch::at_once - 1),
          view{uint32_t(p.size()),
               particles,
               rank.data(),
               start.data(),
               arrived.data(),
               sorted_id.data(),
               sorted.data(),
               wrapped_grid(p.size(), radius),
               origin,
               float(radius)} {
        // The last come first: threads come in any order.
        for (uint32_t k = view.count; k-- > 0;)
            view.count_in(k, p[k], [](uint32_t& shared, uint32_t more) {
                return std::exchange(shared, shared + more);
            });
        std::exclusive_scan(start.begin(), start.end(), start.begin(), 0u);
        for (uint32_t k = 0; k < view.count; ++k) view.arrive(k, p[k]);
        for (uint32_t k = 0; k < view.count; ++k) view.settle(k);
    }
};

}  // namespace wetcurl::testing

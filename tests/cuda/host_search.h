// The search on the host, particle by particle as the device's threads, with a sort between. Ours.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "cuda/cell_search.h"

namespace wetcurl::testing {

struct HostSearch {
    std::vector<uint32_t> key, id, sorted_key, sorted_id;
    std::vector<SortedPoint> sorted;
    std::vector<CellRange> cell;
    CellSearch view;

    HostSearch(const std::vector<Vec3f>& p, int particles, double radius, const Vec3f& origin)
        : key(p.size()),
          id(p.size()),
          sorted_key(p.size()),
          sorted_id(p.size()),
          sorted(p.size() + CellSearch::at_once - 1),
          view{uint32_t(p.size()),
               particles,
               key.data(),
               id.data(),
               sorted_key.data(),
               sorted_id.data(),
               sorted.data(),
               nullptr,
               wrapped_grid(p.size(), radius),
               origin,
               float(radius)} {
        cell.resize(view.grid.cells());
        view.cell = cell.data();
        for (uint32_t k = 0; k < view.grid.cells(); ++k) view.empty_cell(k);
        for (uint32_t k = 0; k < view.count; ++k) view.place(k, p[k]);
        std::iota(sorted_id.begin(), sorted_id.end(), 0u);
        std::stable_sort(sorted_id.begin(), sorted_id.end(),
                         [&](uint32_t i, uint32_t j) { return key[i] < key[j]; });
        for (uint32_t k = 0; k < view.count; ++k) sorted_key[k] = key[sorted_id[k]];
        for (uint32_t k = 0; k < view.count; ++k) view.mark_cell(k, p[sorted_id[k]]);
    }
};

}  // namespace wetcurl::testing

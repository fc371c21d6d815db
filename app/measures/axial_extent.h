// How far hair reaches along the axes of its curls: what water shortens (the paper, Fig 28).
#pragma once

#include "learn/codec/core_detail.h"

namespace wetcurl {

// Mean length of the strands' cores (the smoothed strands) [m]; the strand's own length where it is straight.
inline double axial_extent(const Strands& strands) {
    const int n = strands.particles;
    if (strands.count == 0 || n < 2) return 0;
    std::vector<Vec3f> core(static_cast<size_t>(n));
    double sum = 0;
    for (int s = 0; s < strands.count; ++s) {
        core_of(strands.strand(s), n, core_beta(n), core.data());
        sum += arc_length(core.data(), n);
    }
    return sum / strands.count;
}

}  // namespace wetcurl

// Guides by farthest points.
#include "app/exchange/guides.h"

#include <algorithm>
#include <string>

#include "base/error.h"

namespace wetcurl {

Guides guides_of(const std::vector<Vec3f>& roots, int count) {
    if (count < 1 || size_t(count) > roots.size())
        throw Misuse("--guides: found " + std::to_string(count) + ", allowed 1 to " +
                     std::to_string(roots.size()) + ", the strands that there are");
    Guides out;
    Vec3f middle{0, 0, 0};
    for (const auto& x : roots) middle += (1.0f / float(roots.size())) * x;
    std::vector<float> distance(roots.size());  // to the guides so far
    for (size_t s = 0; s < roots.size(); ++s) distance[s] = norm(roots[s] - middle);
    for (int k = 0; k < count; ++k) {
        const auto next = std::max_element(distance.begin(), distance.end()) - distance.begin();
        out.strands.push_back(int(next));
        for (size_t s = 0; s < roots.size(); ++s) {
            const float from_next = norm(roots[s] - roots[size_t(next)]);
            distance[s] = k == 0 ? from_next : std::min(distance[s], from_next);
        }
        distance[size_t(next)] = -1;  // taken, also where roots lie on each other
    }
    std::sort(out.strands.begin(), out.strands.end());

    out.nearest.resize(roots.size()), out.weights.resize(roots.size());
#pragma omp parallel for schedule(static)
    for (size_t s = 0; s < roots.size(); ++s) {
        auto closer = [&](int a, int b) {
            const float to_a = norm(roots[size_t(a)] - roots[s]), to_b = norm(roots[size_t(b)] - roots[s]);
            return std::pair(to_a, a) < std::pair(to_b, b);
        };
        std::vector<int> by_distance = out.strands;
        const size_t wanted = std::min<size_t>(3, by_distance.size());
        std::partial_sort(by_distance.begin(), by_distance.begin() + long(wanted), by_distance.end(), closer);
        const bool is_guide = std::binary_search(out.strands.begin(), out.strands.end(), int(s));
        float sum = 0;
        for (size_t k = 0; k < 3; ++k) {
            // Of fewer than three guides the last one is named again, with no weight.
            const int guide = is_guide ? int(s) : by_distance[std::min(k, wanted - 1)];
            const float weight = is_guide     ? (k == 0 ? 1.0f : 0.0f)
                                 : k < wanted ? 1 / (norm(roots[size_t(guide)] - roots[s]) + 1e-9f)
                                              : 0;
            out.nearest[s][k] = guide, out.weights[s][k] = weight;
            sum += weight;
        }
        for (float& weight : out.weights[s]) weight /= sum;
    }
    return out;
}

}  // namespace wetcurl

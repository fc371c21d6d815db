// Which strands of a groom to simulate.
#include "solver/grooms/guides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "base/error.h"

namespace wetcurl {

namespace {

constexpr int pieces = 4;  // equal ones of a strand, over which curls even out
constexpr int features = 3 * (1 + pieces);
using Features = std::array<float, features>;

// The root, and from there to the means over the pieces, each of which counts by its share of a strand: the
// square of a distance is that of the roots and the mean one of the shapes [m^2].
Features features_of(const Vec3f* strand, int n) {
    const float share = std::sqrt(1.f / pieces);
    Features out{strand[0].x, strand[0].y, strand[0].z};
    for (int k = 0; k < pieces; ++k) {
        const int first = k * (n - 1) / pieces, end = std::max(first + 1, (k + 1) * (n - 1) / pieces);
        Vec3f sum{0, 0, 0};
        for (int i = first; i < end; ++i) sum += strand[i + 1] - strand[0];
        const Vec3f mean = (share / float(end - first)) * sum;
        out[3 * (k + 1)] = mean.x, out[3 * (k + 1) + 1] = mean.y, out[3 * (k + 1) + 2] = mean.z;
    }
    return out;
}

float square_apart(const Features& a, const Features& b) {
    float sum = 0;
    for (int f = 0; f < features; ++f) sum += (a[f] - b[f]) * (a[f] - b[f]);
    return sum;
}

// Each strand with the guide nearest to it, and the square of how far that is.
struct Nearest {
    std::vector<int> guide;
    std::vector<float> square;

    explicit Nearest(size_t strands)
        : guide(strands, 0), square(strands, std::numeric_limits<float>::max()) {}
    void look_at(const std::vector<Features>& strands, int number, const Features& at) {
#pragma omp parallel for schedule(static)
        for (size_t s = 0; s < strands.size(); ++s)
            if (const float d = square_apart(strands[s], at); d < square[s]) square[s] = d, guide[s] = number;
    }
};

// Of each guide's strands the one nearest to their mean.
std::vector<int> medoids(const std::vector<Features>& strands, const Nearest& nearest,
                         std::vector<int> guides) {
    std::vector<Features> mean(guides.size(), Features{});
    std::vector<float> count(guides.size(), 0), best(guides.size(), std::numeric_limits<float>::max());
    for (size_t s = 0; s < strands.size(); ++s) {
        const size_t g = size_t(nearest.guide[s]);
        for (int f = 0; f < features; ++f) mean[g][f] += strands[s][f];
        ++count[g];
    }
    for (size_t g = 0; g < guides.size(); ++g)
        for (float& f : mean[g]) f /= std::max(count[g], 1.f);
    for (size_t s = 0; s < strands.size(); ++s) {
        const size_t g = size_t(nearest.guide[s]);
        if (const float d = square_apart(strands[s], mean[g]); d < best[g]) best[g] = d, guides[g] = int(s);
    }
    return guides;
}

}  // namespace

std::vector<int> chosen_guides(const Groom& full, int count) {
    if (count < 1 || count > full.rest.count)
        throw Misuse("guides: found " + std::to_string(count) + ", allowed 1 to " +
                     std::to_string(full.rest.count) + ", the strands of this groom");
    std::vector<Features> strands(static_cast<size_t>(full.rest.count));
    for (int s = 0; s < full.rest.count; ++s)
        strands[size_t(s)] = features_of(full.rest.strand(s), full.rest.particles);

    std::vector<int> guides;
    Nearest nearest(strands.size());
    for (int next = 0; int(guides.size()) < count;
         next =
             int(std::max_element(nearest.square.begin(), nearest.square.end()) - nearest.square.begin())) {
        guides.push_back(next);
        nearest.look_at(strands, int(guides.size()) - 1, strands[size_t(next)]);
        nearest.square[size_t(next)] = -1;  // it is one, and no other's, even where two strands are the same
        nearest.guide[size_t(next)] = int(guides.size()) - 1;
    }
    // The farthest first are the oddest; a few rounds bring them to the middle of those that follow them.
    constexpr int rounds = 4;
    for (int round = 0; round < rounds; ++round) {
        guides = medoids(strands, nearest, guides);
        nearest = Nearest(strands.size());
        for (size_t g = 0; g < guides.size(); ++g) {
            nearest.look_at(strands, int(g), strands[size_t(guides[g])]);
            nearest.square[size_t(guides[g])] = -1;
            nearest.guide[size_t(guides[g])] = int(g);
        }
    }
    guides = medoids(strands, nearest, guides);
    std::sort(guides.begin(), guides.end());
    return guides;
}

}  // namespace wetcurl

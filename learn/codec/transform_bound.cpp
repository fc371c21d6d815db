// Non-negative least squares of up to four unknowns, and the weights nearest in the mean.
#include "learn/codec/transform_bound.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace wetcurl {
namespace {

// Solves for the unknowns that `set` names, the others 0, by Gauss-Jordan elimination; false where they
// depend on one another (then another set serves as well) or one of them is negative.
bool solved_for(unsigned set, const double square[most_neighbours][most_neighbours],
                const double right[most_neighbours], int width, NeighbourWeights& x) {
    int member[most_neighbours], count = 0;
    for (int k = 0; k < width; ++k)
        if (set >> k & 1) member[count++] = k;
    double a[most_neighbours][most_neighbours + 1];
    for (int r = 0; r < count; ++r) {
        for (int c = 0; c < count; ++c) a[r][c] = square[member[r]][member[c]];
        a[r][count] = right[member[r]];
    }
    for (int p = 0; p < count; ++p) {
        // What is left of the pivot is the part of this column that the earlier ones do not span.
        if (!(a[p][p] > 1e-12 * square[member[p]][member[p]])) return false;
        for (int r = 0; r < count; ++r) {
            if (r == p) continue;
            const double share = a[r][p] / a[p][p];
            for (int c = p; c <= count; ++c) a[r][c] -= share * a[p][c];
        }
    }
    x = {};
    for (int p = 0; p < count; ++p) {
        x[size_t(member[p])] = a[p][count] / a[p][p];
        if (x[size_t(member[p])] < 0) return false;
    }
    return true;
}

}  // namespace

NeighbourWeights nonnegative_least_squares(const double square[most_neighbours][most_neighbours],
                                           const double right[most_neighbours], int width) {
    NeighbourWeights best{}, x;
    double least = 0;  // of x^T square x - 2 right^T x, which is 0 for x = 0
    for (unsigned set = 1; set < 1u << width; ++set) {
        if (!solved_for(set, square, right, width, x)) continue;
        double sum = 0;  // at a solution the first term is half of the second
        for (int k = 0; k < width; ++k) sum -= right[k] * x[size_t(k)];
        if (sum < least) least = sum, best = x;
    }
    return best;
}

NeighbourWeights nearest_weights(const std::vector<Vec3d>& distance, const std::vector<Vec3d>& pull,
                                 int width) {
    constexpr int most_rounds = 50;
    constexpr double closest = 1e-6;  // [m]: nearer ones weigh no more
    const size_t n = distance.size();
    NeighbourWeights best{};
    double least = 0;
    for (const Vec3d& d : distance) least += norm(d);
    std::vector<double> importance(n, 1);
    for (int round = 0; round < most_rounds; ++round) {
        double square[most_neighbours][most_neighbours] = {}, right[most_neighbours] = {};
        for (size_t i = 0; i < n; ++i)
            for (int k = 0; k < width; ++k) {
                const Vec3d g = importance[i] * pull[size_t(k) * n + i];
                right[k] += dot(g, distance[i]);
                for (int j = 0; j < width; ++j) square[k][j] += dot(g, pull[size_t(j) * n + i]);
            }
        const NeighbourWeights x = nonnegative_least_squares(square, right, width);
        double sum = 0;
        for (size_t i = 0; i < n; ++i) {
            Vec3d left = distance[i];
            for (int k = 0; k < width; ++k) left -= x[size_t(k)] * pull[size_t(k) * n + i];
            sum += norm(left);
            importance[i] = 1 / std::max(norm(left), closest);
        }
        const double before = least;
        if (sum < least) least = sum, best = x;
        if (round > 0 && sum > (1 - 1e-4) * before) break;
    }
    return best;
}

}  // namespace wetcurl

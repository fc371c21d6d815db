// The bound of Eq 18: weights known beforehand are found, and no colours come nearer.
#include <limits>

#include "learn/codec/quad_transform.h"
#include "learn/codec/transform_bound.h"
#include "tests/learn/hair.h"

namespace wetcurl::testing {
namespace {

double mean_distance(const Strands& a, const Strands& b) {
    double sum = 0;
    for (size_t k = 0; k < a.points.size(); ++k) sum += norm(a.points[k] - b.points[k]);
    return sum / double(a.points.size());
}

double unexplained(const std::vector<Vec3d>& distance, const std::vector<Vec3d>& pull, int width,
                   const NeighbourWeights& w) {
    double sum = 0;
    for (size_t i = 0; i < distance.size(); ++i) {
        Vec3d left = distance[i];
        for (int k = 0; k < width; ++k) left -= w[size_t(k)] * pull[size_t(k) * distance.size() + i];
        sum += norm(left);
    }
    return sum;
}

// Distances that these weights explain wholly.
struct Known {
    std::vector<Vec3d> distance, pull;
    Known(const NeighbourWeights& w, int width, size_t n = 20, unsigned seed = 3) : distance(n) {
        Random random(seed);
        for (size_t k = 0; k < size_t(width) * n; ++k) pull.push_back(random.vector());
        for (size_t i = 0; i < n; ++i)
            for (int k = 0; k < width; ++k) distance[i] += w[size_t(k)] * pull[size_t(k) * n + i];
    }
};

TEST(TransformBound, finds_the_weights_that_a_strand_was_moved_with) {
    for (int width : {3, 4}) {
        const NeighbourWeights w{0.7, 0, 1.3, width == 4 ? 0.2 : 0};
        const Known known(w, width);
        const NeighbourWeights found = nearest_weights(known.distance, known.pull, width);
        for (size_t k = 0; k < w.size(); ++k) EXPECT_NEAR(found[k], w[k], 1e-9);
    }
}

// One pull away from where the strand should be: nothing is better than to stay.
TEST(TransformBound, never_pushes) {
    const Known known({-1, 0, 0, 0}, 1);
    const NeighbourWeights found = nearest_weights(known.distance, known.pull, 1);
    EXPECT_EQ(found[0], 0);
}

// Two equal neighbours have no weights of their own, only a sum.
TEST(TransformBound, equal_neighbours_share_what_one_would_have) {
    Known known({0.4, 0.5, 0, 0}, 2);
    const size_t n = known.distance.size();
    for (size_t i = 0; i < n; ++i) {
        known.pull[n + i] = known.pull[i];
        known.distance[i] = 0.9 * known.pull[i];
    }
    const NeighbourWeights found = nearest_weights(known.distance, known.pull, 2);
    EXPECT_NEAR(found[0] + found[1], 0.9, 1e-9);
}

// Most particles are explained by 1, a third lie elsewhere: the mean of the squares is pulled there, the mean
// of the distances is not.
TEST(TransformBound, is_of_the_mean_distance_and_not_of_its_square) {
    const size_t n = 9;
    std::vector<Vec3d> distance(n, {1, 0, 0});
    const std::vector<Vec3d> pull(n, {1, 0, 0});
    for (size_t i = 0; i < 3; ++i) distance[i] = {10, 0, 0};
    EXPECT_NEAR(nearest_weights(distance, pull, 1)[0], 1, 1e-2);
}

// Random weights are tried against the found ones, with a third of the pulls in vain.
TEST(TransformBound, no_other_weights_explain_more) {
    Random random(5);
    for (unsigned trial = 0; trial < 10; ++trial) {
        Known known({random.number(0, 1), random.number(0, 1), random.number(-1, 0), random.number(0, 1)}, 4,
                    20, trial);
        for (auto& d : known.distance) d += random.vector(0.3);
        const double least =
            unexplained(known.distance, known.pull, 4, nearest_weights(known.distance, known.pull, 4));
        ASSERT_GT(least, 0.1);
        for (int k = 0; k < 2000; ++k) {
            const NeighbourWeights other{random.number(0, 1.2), random.number(0, 1.2), random.number(0, 0.2),
                                         random.number(0, 1.2)};
            EXPECT_GE(unexplained(known.distance, known.pull, 4, other), (1 - 1e-3) * least);
        }
    }
}

// What any colours and any gain make of curls, against curls that hang elsewhere.
TEST(TransformBound, lies_below_every_gain_of_any_colours) {
    const float reach = 0.02f;
    const Groom high = curly_groom({}), low = coarsened(high, 2);
    Curls shorter;
    shorter.radius = 0.005;
    const Strands truth = curly_groom(shorter).rest;
    std::vector<float> saturation(low.rest.points.size());
    Random random(6);
    for (float& sigma : saturation) sigma = float(random.number(0, 1));
    for (Reconstruction form : {Reconstruction::paper, Reconstruction::core})
        for (bool triangles : {false, true}) {
            const Stencil stencil = triangles ? triangle_stencil(high, low) : quad_stencil(high, low);
            auto transform = [&](float gain) {
                return QuadTransform(form, stencil, high, low, saturation, reach, gain);
            };
            Strands out;
            QuadTransform none = transform(0);
            none.interpolate(low.rest, Pose{}, out);
            const double still = mean_distance(out, truth);
            none.apply_nearest(low.rest, Pose{}, truth, out);
            const double bound = mean_distance(out, truth);
            EXPECT_LT(bound, 0.99 * still);
            double best = std::numeric_limits<double>::max();
            for (unsigned seed = 0; seed < 5; ++seed) {
                std::vector<Vec3f> colours;
                for (int s = 0; s < high.rest.count; ++s) colours.push_back(cast<float>(random.vector()));
                for (float gain : {0.1f, 1.0f, 10.0f, 100.0f}) {
                    transform(gain).apply(low.rest, Pose{}, colours, out);
                    best = std::min(best, mean_distance(out, truth));
                }
            }
            EXPECT_LE(bound, best);
        }
}

// A truth that the transform itself made is met, whatever gain and units it was made with.
TEST(TransformBound, meets_what_colours_have_made) {
    const float reach = 0.02f;
    const Groom high = curly_groom({}), low = coarsened(high, 2);
    const std::vector<float> saturation(low.rest.points.size(), 0.8f);
    Random random(7);
    std::vector<Vec3f> colours;
    for (int s = 0; s < high.rest.count; ++s) colours.push_back(cast<float>(random.vector()));
    QuadTransform transform(Reconstruction::paper, quad_stencil(high, low), high, low, saturation, reach, 3);
    Strands truth, out;
    transform.interpolate(low.rest, Pose{}, out);
    transform.apply(low.rest, Pose{}, colours, truth);
    ASSERT_GT(mean_distance(out, truth), 1e-4);
    transform.apply_nearest(low.rest, Pose{}, truth, out);
    EXPECT_LT(mean_distance(out, truth), 1e-6);
    expect_error([&] { transform.apply_nearest(low.rest, Pose{}, low.rest, out); },
                 {"found 16 strands", "allowed 64"});
}

}  // namespace
}  // namespace wetcurl::testing

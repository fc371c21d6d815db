// What nobody should miss in a run.
#include "base/frame_watch.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace wetcurl {

namespace {

// An edge that was drawn shorter than a hundredth of its strand's mean edge, or than a micrometre, counts as
// that long: what rounding moves its ends by is no stretch.
constexpr double least_share = 0.01, least_length = 1e-6;

// Of squares(k) for k < count, 0 or more.
template <class Squares>
float largest(int count, Squares squares) {
    float most = 0;
#pragma omp simd reduction(max : most)
    for (int k = 0; k < count; ++k) most = std::max(most, squares(k));
    return most;
}

// The first k with that value.
template <class Squares>
int place_of(float value, int count, Squares squares) {
    for (int k = 0; k < count; ++k)
        if (squares(k) == value) return k;
    return 0;
}

void take_larger(std::optional<FrameExtreme>& most, const FrameExtreme& found) {
    if (!most || found.value > most->value) most = found;
}

}  // namespace

FrameWatch::FrameWatch(const Groom& groom, double fps)
    : strands_(groom.rest.count),
      particles_(groom.rest.particles),
      fps_(fps),
      per_square_length_(groom.rest.points.size()) {
    for (int s = 0; s < strands_; ++s) {
        const Vec3f* p = groom.rest.strand(s);
        const double least =
            std::max(least_length, least_share * arc_length(p, particles_) / (particles_ - 1));
        for (int i = 0; i + 1 < particles_; ++i) {
            const double length = std::max(least, double(norm(p[i + 1] - p[i])));
            per_square_length_[size_t(s) * size_t(particles_) + size_t(i)] = float(1 / (length * length));
        }
    }
}

// Whether a root goes farther than any body does: a cut.
bool FrameWatch::is_cut_to(const std::vector<Vec3f>& x) const {
    constexpr double fastest = 40;  // [m/s]: a sprinter makes 12
    for (size_t root = 0; root < x.size(); root += size_t(particles_))
        if (fps_ * double(norm(x[root] - before_[root])) > fastest) return true;
    return false;
}

void FrameWatch::look(int frame, const RunFrame& now) {
    const std::vector<Vec3f>& x = now.positions.points;
    const bool follows = frame == frame_ + 1 && !is_cut_to(x);
    FrameExtreme stretch{0, frame, 0, 0}, speed = stretch;
    float most_stretch = 0, most_way = 0;
    for (int s = 0; s < strands_; ++s) {
        const size_t first = size_t(s) * size_t(particles_);
        const Vec3f *p = &x[first], *was = follows ? &before_[first] : nullptr;
        const float* per_square = &per_square_length_[first];
        const auto stretch_of = [=](int i) {
            const Vec3f edge = p[i + 1] - p[i];
            return dot(edge, edge) * per_square[i];
        };
        if (const float most = largest(particles_ - 1, stretch_of); most > most_stretch)
            most_stretch = most, stretch.strand = s,
            stretch.particle = place_of(most, particles_ - 1, stretch_of);
        if (!follows) continue;
        const auto way_of = [=](int i) {
            const Vec3f way = p[i] - was[i];
            return dot(way, way);
        };
        if (const float most = largest(particles_, way_of); most > most_way)
            most_way = most, speed.strand = s, speed.particle = place_of(most, particles_, way_of);
    }
    stretch.value = std::sqrt(double(most_stretch));
    take_larger(stretch_, stretch);
    if (!overstretched_ && stretch.value > warning_stretch) overstretched_ = stretch;
    speed.value = fps_ * std::sqrt(double(most_way));
    if (follows) take_larger(speed_, speed);
    if (follows && !overspeed_ && speed.value > warning_speed) overspeed_ = speed;
    before_ = x;

    const std::optional<double> energy =
        now.energy.empty() ? std::nullopt
                           : std::optional(std::accumulate(now.energy.begin(), now.energy.end(), 0.0));
    if (follows && energy && energy_) take_larger(energy_growth_, {*energy - *energy_, frame, 0, 0});
    energy_ = energy;
    frame_ = frame;
}

}  // namespace wetcurl

// A hair as an elastic fibre.
#include "solver/terms/fibre.h"

#include <algorithm>
#include <numbers>
#include <numeric>

namespace wetcurl {

namespace {

constexpr double pi = std::numbers::pi;
double fourth_power(double d) { return d * d * d * d; }

}  // namespace

double Fibre::area() const { return pi / 4 * diameter * diameter; }
double Fibre::linear_density() const { return density * area(); }
// Of an ellipse of this area I is pi d⁴ / 64 times the ratio of its axes, or by it; J is pi d⁴ / 16 by the
// sum of both.
double Fibre::flexural_rigidity() const {
    return youngs_modulus * pi / 32 * fourth_power(diameter) / (ellipticity + 1 / ellipticity);
}
double Fibre::torsional_rigidity() const {
    return shear_modulus * pi / 16 * fourth_power(diameter) / (ellipticity + 1 / ellipticity);
}

Fibre::Springs Fibre::springs(const std::vector<double>& rest_length) const {
    const double length = std::accumulate(rest_length.begin(), rest_length.end(), 0.0),
                 ten_weights = 10 * 9.81 * linear_density() * length, of_substance = youngs_modulus * area(),
                 along = strain > 0 ? std::min(of_substance, ten_weights / strain) : of_substance;
    Springs out;
    for (size_t i = 0; i < rest_length.size(); ++i) {
        const double l = rest_length[i], before = i > 0 ? rest_length[i - 1] : 0,
                     joint = i == 1 ? before + l / 2 : (before + l) / 2;
        out.stretch.push_back(along / l);
        out.bend.push_back(flexural_rigidity() / (joint * l * l));
        out.twist.push_back(torsional_rigidity() / joint);
    }
    return out;
}

Fibre::Springs Fibre::soaked(const Springs& dry, const float* saturation) const {
    Springs out = dry;
    for (size_t i = 0; saturation && i < dry.stretch.size(); ++i) {
        const WetShares by = wet_shares(double(saturation[i]));
        out.stretch[i] *= by.stretch, out.bend[i] *= by.bend, out.twist[i] *= by.twist;
    }
    return out;
}

}  // namespace wetcurl

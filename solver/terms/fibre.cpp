// A hair as an elastic fibre.
#include "solver/terms/fibre.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "solver/terms/root_noise.h"

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

std::vector<double> Fibre::thickness(const Groom& full, unsigned long long seed) const {
    if (spread == 0) return {};
    std::vector<double> out(size_t(full.rest.count), 1);
    for_each_root(full, [&](int strand, double u, double v) {
        // A normal deviate (Box and Muller 1958), from the seed's streams 1 and 2.
        const double a = 1 - root_noise(seed, 1, u, v), b = root_noise(seed, 2, u, v),
                     deviate = std::sqrt(-2 * std::log(a)) * std::cos(2 * pi * b);
        constexpr double farthest = 3;
        out[size_t(strand)] = 1 + spread * std::clamp(deviate, -farthest, farthest);
    });
    return out;
}

double Fibre::profile_at(double along) const {
    if (profile.empty()) return 1;
    const double place = std::clamp(along, 0.0, 1.0) * double(profile.size() - 1);
    const size_t k = std::min(size_t(place), profile.size() - 1), next = std::min(k + 1, profile.size() - 1);
    return profile[k] + (place - double(k)) * (profile[next] - profile[k]);
}

Fibre::Springs Fibre::springs(const std::vector<double>& rest_length, double thickness) const {
    const double length = std::accumulate(rest_length.begin(), rest_length.end(), 0.0),
                 ten_weights = 10 * 9.81 * linear_density() * length, of_substance = youngs_modulus * area(),
                 along = strain > 0 ? std::min(of_substance, ten_weights / strain) : of_substance;
    Springs out;
    double from_root = 0;  // [m] of the joint
    for (size_t i = 0; i < rest_length.size(); ++i) {
        const double l = rest_length[i], before = i > 0 ? rest_length[i - 1] : 0,
                     joint = i == 1 ? before + l / 2 : (before + l) / 2,
                     of_edge = thickness * profile_at((from_root + l / 2) / length),
                     of_joint = fourth_power(thickness * profile_at(from_root / length));
        out.stretch.push_back(of_edge * of_edge * along / l);
        out.bend.push_back(of_joint * flexural_rigidity() / (joint * l * l));
        out.twist.push_back(of_joint * torsional_rigidity() / joint);
        from_root += l;
    }
    return out;
}

std::vector<double> Fibre::masses(const std::vector<double>& rest_length, double thickness) const {
    const double length = std::accumulate(rest_length.begin(), rest_length.end(), 0.0);
    std::vector<double> out(rest_length.size() + 1, 0);
    double from_root = 0;  // [m]
    for (size_t i = 0; i < rest_length.size(); ++i) {
        const double l = rest_length[i], across = thickness * profile_at((from_root + l / 2) / length),
                     half = 0.5 * linear_density() * across * across * l;
        out[i] += half, out[i + 1] += half;
        from_root += l;
    }
    return out;
}

Fibre::Springs Fibre::soaked(const Springs& dry, const float* saturation) const {
    const WetSprings wet = wet_springs();
    Springs out = dry;
    for (size_t i = 0; saturation && i < dry.stretch.size(); ++i) {
        const WetSprings::Factors by = wet.at(double(saturation[i]));
        out.stretch[i] *= by.stretch, out.bend[i] *= by.bend, out.twist[i] *= by.twist;
    }
    return out;
}

}  // namespace wetcurl

// S6 of fibres: kinds of hair at many numbers of particles against the finest.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "solver/stability/cases.h"

namespace wetcurl::stability {

namespace {

constexpr double reach = 0.15;  // [m] along the hair
constexpr int finest = 400;
// Of a curl; water adds turns to it.
constexpr double fewest_a_turn = 20, turns_by_water = 1.5;

// What is measured of a strand that has come to rest, and of its swing after that.
struct Measures {
    double height, radius, period;  // [m], [m], [s]
    Points tip;                     // over the frames of the swing [m]
};

// At n points whose distances along the hair grow from root to tip by `uneven` (1: all alike).
Points hair_of(const HairKind& kind, int n, double uneven) {
    const Points fine = kind.curl_radius > 0
                            ? helix_points(20 * finest + 1, reach, kind.curl_radius, kind.pitch)
                            : straight_points(20 * finest + 1, reach, {0, -1, 0});
    Points out;
    for (int i = 0; i < n; ++i) {
        const double place = double(fine.size() - 1) * std::pow(double(i) / (n - 1), uneven);
        const size_t k = std::min(size_t(place), fine.size() - 2);
        out.push_back(fine[k] + (place - double(k)) * (fine[k + 1] - fine[k]));
    }
    return out;
}

double turn_of(const HairKind& kind) {
    return kind.curl_radius > 0 ? std::hypot(2 * std::numbers::pi * kind.curl_radius, kind.pitch) : 0;
}

// What belongs to each particle: half of the edges beside it [m].
std::vector<double> shares(const Points& p) {
    std::vector<double> out(p.size(), 0);
    for (size_t i = 0; i + 1 < p.size(); ++i) {
        const double half = norm(p[i + 1] - p[i]) / 2;
        out[i] += half, out[i + 1] += half;
    }
    return out;
}
Vec3d centre_of(const Points& p) {
    const std::vector<double> share = shares(p);
    Vec3d sum{0, 0, 0};
    double length = 0;
    for (size_t i = 0; i < p.size(); ++i) sum += share[i] * p[i], length += share[i];
    return (1 / length) * sum;
}
// Root mean square distance from the vertical through the centre.
double radius_of(const Points& p) {
    const std::vector<double> share = shares(p);
    const Vec3d centre = centre_of(p);
    double square = 0, length = 0;
    for (size_t i = 0; i < p.size(); ++i) {
        const Vec3d d = p[i] - centre;
        square += share[i] * (d.x * d.x + d.z * d.z), length += share[i];
    }
    return std::sqrt(square / length);
}

// Of the mean of two swings, by where x crosses the place that it hung at.
double period_of(const std::vector<double>& x, double hung, double dt) {
    std::vector<double> crossings;
    for (size_t f = 1; f < x.size(); ++f) {
        const double a = x[f - 1] - hung, b = x[f] - hung;
        if (a * b < 0) crossings.push_back(dt * (double(f - 1) + a / (a - b)));
    }
    return crossings.size() < 5 ? NAN : (crossings[4] - crossings[0]) / 2;
}

Measures measured(const Battery& b, const HairKind& kind, const Points& shape, const std::string& wet) {
    StrandSetup setup{.shapes = {shape}, .dt = 1.0 / 60, .drag = 8, .more = wet, .fibre = kind.diameter};
    setup.set = {std::string("fibre.hair='") + kind.name + "'", "fibre.damping=1e-3"};
    Trial trial(b.method, scene_of(setup, b.method));
    trial.advance_for(4);
    const Points hung = trial.simulation().state().x;
    Measures out{-hung.back().y, radius_of(hung), 0, {}};
    setup.drag = 0.1;
    trial.go_on_in(scene_of(setup, b.method));
    SimulationState s = trial.simulation().state();
    const int n = int(shape.size());
    for (int i = 2; i < n; ++i) {  // as a whole, about its root
        const size_t k = size_t(i);
        s.x[k] = s.x[1] + rotate(rotation_about({0, 0, 1}, 0.15), s.x[k] - s.x[1]);
    }
    carry_frames(s, n);
    for (Vec3d& v : s.v) v = {0, 0, 0};
    s.v_before = s.v, s.first = true;
    trial.set(s);
    std::vector<double> x;
    for (double t = 0; t < 2.5; t += setup.dt) {
        trial.advance();
        const Points now = trial.simulation().state().x;
        if (t < 1) out.tip.push_back(now.back());
        x.push_back(centre_of(now).x);
    }
    out.period = period_of(x, centre_of(hung).x, setup.dt);
    return out;
}

double farthest_apart(const Points& a, const Points& b) {
    double most = 0;
    for (size_t f = 0; f < a.size(); ++f) most = std::max(most, norm(a[f] - b[f]));
    return most;
}

StabilityCase order_of(const Battery& b, const HairKind& kind, const std::string& what,
                       const std::string& wet, double uneven) {
    StabilityCase c = b.named("S6", std::string("order in N of ") + kind.name + what, {});
    constexpr double allowed = 0.02;
    const Measures fine = measured(b, kind, hair_of(kind, finest, uneven), wet);
    std::vector<std::pair<double, double>> errors;  // by number of particles
    bool close = true;
    const double turns = turn_of(kind) > 0 ? (wet.empty() ? 1 : turns_by_water) * reach / turn_of(kind) : 0;
    for (int n : {16, 32, 64, 100, 200, 300}) {
        // Uneven points are farthest apart at the tip.
        if (n < fewest_a_turn * turns * uneven) continue;
        const Measures m = measured(b, kind, hair_of(kind, n, uneven), wet);
        const double height = std::abs(m.height - fine.height) / fine.height,
                     radius = turn_of(kind) > 0 ? std::abs(m.radius - fine.radius) / fine.radius : 0,
                     period = std::abs(m.period - fine.period) / fine.period,
                     tip = farthest_apart(m.tip, fine.tip) / reach;
        // Straight hair of 16 particles swings as if its first edge were clamped, which its tip tells.
        const double most = std::max({height, radius, period}), with_tip = std::max(most, tip);
        close = close && (n == 16 ? most : with_tip) <= allowed;
        errors.emplace_back(n, with_tip);
        const std::string of = "_of_" + std::to_string(n);
        for (const auto& [name, error] :
             Figures{{"height", height}, {"radius", radius}, {"period", period}, {"tip", tip}})
            c.measured.emplace_back(name + of, error);
        c.finite = c.finite && std::isfinite(height + radius + period + tip);
    }
    // Against a finest that has an error of its own, as of order one: (1/n - 1/finest).
    double least = unbounded;
    for (size_t k = 0; k + 1 < errors.size(); ++k) {
        const auto& [n, e] = errors[k];
        const auto& [m, f] = errors[k + 1];
        least = std::min(least, std::log(e / f) / std::log((1 / n - 1.0 / finest) / (1 / m - 1.0 / finest)));
    }
    if (errors.size() > 1) c.measured.emplace_back("order", least);
    c.rest_error = errors.empty() ? NAN : errors.front().second;
    // Where the last error is a thousandth it says nothing of an order.
    const bool falls = errors.size() < 2 || errors.back().second < 1e-3 || least >= 0.8;
    c.passed = c.finite && close && falls && !errors.empty();
    return c;
}

}  // namespace

Cases orders_of_fibres(const Battery& b, const char* hair) {
    const HairKind& kind = *hair_named(hair);
    return {order_of(b, kind, ", dry", "", 1), order_of(b, kind, ", wet", "[wetness]\n[curl]\n", 1),
            order_of(b, kind, ", uneven", "", 1.5)};
}

}  // namespace wetcurl::stability

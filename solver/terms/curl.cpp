// Curl exaggeration on the rest shape.
#include "solver/terms/curl.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <tuple>
#include <utility>

#include "base/geometry/frames.h"

namespace wetcurl {

using std::numbers::pi;

double helix_angle(double r, double p, double l) {
    auto excess = [&](double w) { return std::hypot(2 * r * std::sin(w / 2), p * w) - l; };
    double high = p > 0 ? l / p : pi;
    high = std::min(high, pi);  // half a turn for each segment is the most that a polyline shows
    if (excess(high) < 0) return high;
    double low = 0;
    for (int k = 0; k < 80; ++k) {
        const double middle = (low + high) / 2;
        (excess(middle) < 0 ? low : high) = middle;
    }
    return (low + high) / 2;
}

std::vector<Vec3d> intrinsic_shape(const std::vector<Vec3d>& p) {
    const size_t edges = p.size() - 1;
    std::vector<Vec3d> tbar(edges);
    Vec3d e = p[1] - p[0], direction = normalized(e, Vec3d{1, 0, 0});
    tbar[0] = {norm(e), 0, 0};
    Quatd f = root_frame_of(direction);
    for (size_t i = 1; i < edges; ++i) {
        e = p[i + 1] - p[i];
        tbar[i] = rotate(conjugate(f), e);
        direction = normalized(e, direction);
        f = transported(f, direction);
    }
    return tbar;
}

std::vector<Vec3d> shape_from_intrinsic(const std::vector<Vec3d>& tbar, const Vec3d& root,
                                        const Quatd& frame) {
    std::vector<Vec3d> p{root};
    Quatd f = frame;
    for (const auto& t : tbar) {
        const Vec3d e = rotate(f, t);
        p.push_back(p.back() + e);
        f = transported(f, e);
    }
    return p;
}

double Turning::segments_of_a_turn() const {
    const double omega = 2 * std::acos(std::cos(theta / 2) * std::cos(phase / 2));
    return 2 * pi / std::clamp(omega, 1e-3, pi);
}

Turning turning_of(const std::vector<Vec3d>& tbar) {
    double theta = 0, most = 0;
    std::complex<double> advance = 0, before = 0;
    for (size_t i = 1; i < tbar.size(); ++i) {
        const std::complex<double> kappa(tbar[i].y, tbar[i].z);
        theta += std::atan2(std::abs(kappa), tbar[i].x);
        advance += kappa * std::conj(before);
        most += std::abs(kappa) * std::abs(before);
        before = kappa;
    }
    const double count = double(std::max<size_t>(1, tbar.size() - 1));
    return {theta / count, std::abs(advance) > 0 ? std::arg(advance) : 0,
            most > 0 ? std::abs(advance) / most : 0};
}

namespace {

std::complex<double> across(const Vec3d& t) { return {t.y, t.z}; }

// tbar with the turn at each vertex multiplied by q, its direction and length kept.
Vec3d turned(const Vec3d& t, double q) {
    const double across = std::hypot(t.y, t.z), length = norm(t);
    if (across < 1e-12 * length) return t;
    const double theta = std::min(q * std::atan2(across, t.x), 0.9 * pi);
    const double s = length * std::sin(theta) / across;
    return {length * std::cos(theta), s * t.y, s * t.z};
}

// Point at the place x of the polyline, in segments.
Vec3d point_at(const std::vector<Vec3d>& p, double x) {
    const size_t k = std::min(size_t(x), p.size() - 2);
    return p[k] + (x - double(k)) * (p[k + 1] - p[k]);
}

// Segments of one turn of the strand's curl: the shift at the first peak of the correlation of edges with
// later ones, which the strand's bends beside its curl lower and do not move. 1 where there is none: no curl.
double turn_of_curl(const std::vector<Vec3d>& p) {
    std::vector<Vec3d> t;
    for (size_t i = 0; i + 1 < p.size(); ++i) t.push_back(normalized(p[i + 1] - p[i], Vec3d{1, 0, 0}));
    auto correlation = [&](size_t shift) {
        double sum = 0;
        for (size_t i = 0; i + shift < t.size(); ++i) sum += dot(t[i], t[i + shift]);
        return sum / double(t.size() - shift);
    };
    const size_t most = t.size() * 3 / 4;  // beyond it too few edges have a later one
    bool rises = false;
    double c[3] = {1, 1, 1};
    for (size_t shift = 1; shift < most; ++shift) {
        c[0] = c[1], c[1] = c[2], c[2] = correlation(shift);
        if (rises && c[2] < c[1]) return double(shift) - 1 + (c[2] - c[0]) / (2 * (2 * c[1] - c[0] - c[2]));
        rises = c[2] > c[1];
    }
    return 1;
}

// Chord of the turn about the middle of edge i, of the first and the last whole turn at the ends.
Vec3d chord_of_turn(const std::vector<Vec3d>& p, double turn, size_t i) {
    const double from = std::clamp(double(i) + 0.5 - turn / 2, 0.0, double(p.size() - 1) - turn);
    return point_at(p, from + turn) - point_at(p, from);
}

// Each edge in the frame, carried along, of the strand's axis, the chord of the turn about it. Both (n-1).
using FramesAndEdges = std::pair<std::vector<Quatd>, std::vector<Vec3d>>;
FramesAndEdges about_axis(const std::vector<Vec3d>& p, double turn) {
    turn = std::clamp(turn, 1.0, double(p.size() - 1));
    FramesAndEdges out;
    Quatd f = Quatd::identity();
    for (size_t i = 0; i + 1 < p.size(); ++i) {
        const Vec3d axis = chord_of_turn(p, turn, i);
        f = i == 0 ? root_frame_of(normalized(axis, Vec3d{1, 0, 0})) : transported(f, axis);
        out.first.push_back(f);
        out.second.push_back(rotate(conjugate(f), p[i + 1] - p[i]));
    }
    return out;
}

std::vector<Vec3d> polyline(const std::vector<Vec3d>& edges) {
    std::vector<Vec3d> p{{0, 0, 0}};
    for (const auto& e : edges) p.push_back(p.back() + e);
    return p;
}

// The helix turned about its axis so that it leaves the root to the side to which `edges` do: over a quarter
// of a turn, since the two may have different turns.
void start_alike(std::vector<Vec3d>& helix, const std::vector<Vec3d>& edges, double turn) {
    std::complex<double> phase = 0;
    for (size_t i = 0; i < edges.size() && double(i) <= turn / 4; ++i)
        phase += across(edges[i]) * std::conj(across(helix[i]));
    phase = std::abs(phase) > 0 ? phase / std::abs(phase) : 1;
    for (auto& e : helix) {
        const auto to = across(e) * phase;
        e = {e.x, to.real(), to.imag()};
    }
}

// Length of the axis that edges lie about.
double extent(const std::vector<Vec3d>& edges) {
    double sum = 0;
    for (const auto& e : edges) sum += e.x;
    return sum;
}

// Between two shapes by angle and direction of each turn, s (n-1) of the way: curls of two phases added as
// vectors would straighten each other.
std::vector<Vec3d> between(const std::vector<Vec3d>& tbar, const std::vector<Vec3d>& other,
                           const std::vector<double>& s) {
    std::vector<Vec3d> out = tbar;
    double ahead = 0;  // of the other's direction, followed along the strand over whole turns
    for (size_t i = 1; i < tbar.size(); ++i) {
        const auto from = across(tbar[i]), to = across(other[i]);
        if (const auto change = to * std::conj(from); std::abs(change) > 0)
            ahead += std::remainder(std::arg(change) - ahead, 2 * pi);
        const double theta =
            (1 - s[i]) * std::atan2(std::abs(from), tbar[i].x) + s[i] * std::atan2(std::abs(to), other[i].x);
        const double direction = std::abs(from) > 0 ? std::arg(from) + s[i] * ahead : std::arg(to);
        const double length = norm(tbar[i]), aside = length * std::sin(theta);
        out[i] = {length * std::cos(theta), aside * std::cos(direction), aside * std::sin(direction)};
    }
    return out;
}

// Edges about their axis of the helix of Eq 6, of the same lengths and handedness.
std::vector<Vec3d> helix_about_axis(const std::vector<Vec3d>& edges, double handedness, double radius,
                                    double pitch) {
    std::vector<Vec3d> out;
    double t = 0;
    for (const auto& e : edges) {
        const double omega = helix_angle(radius, pitch / (2 * pi), norm(e));
        const double across = 2 * radius * std::sin(omega / 2), middle = t + omega / 2;
        out.push_back({std::sqrt(std::max(0.0, dot(e, e) - across * across)), across * std::cos(middle),
                       handedness * across * std::sin(middle)});
        t += omega;
    }
    return out;
}

}  // namespace

WetCurl::WetCurl(const Curl& curl, const std::vector<Vec3d>& tbar) : weight_(curl.w_h), dry_(tbar) {
    const auto p = shape_from_intrinsic(tbar, {0, 0, 0}, Quatd::identity());
    turn_ = turn_of_curl(p);
    double length = 0, axis = 0;
    for (size_t i = 0; i < tbar.size(); ++i)
        length += norm(tbar[i]), axis += norm(chord_of_turn(p, turn_, i)) / turn_;
    // A flat coil has no length to lose, and an axis that its points do not tell well.
    const double slender = std::clamp((axis / length - 0.15) / 0.1, 0.0, 1.0);
    if (slender == 0) turn_ = double(tbar.size());

    std::tie(frames_, edges_) = about_axis(p, turn_);
    straight_ = intrinsic_shape(polyline(edges_));
    std::tie(bend_left_, drawn_) = about_axis(polyline(edges_), turn_);
    const Turning turning = turning_of(straight_);
    segments_ = turning.segments_of_a_turn();
    if (curl.radius) {
        helix_ = intrinsic_shape(
            polyline(helix_about_axis(edges_, turning.phase < 0 ? -1 : 1, *curl.radius, *curl.pitch)));
        return;
    }
    auto tightened_by = [&](double q) {
        std::vector<Vec3d> t = straight_;
        for (size_t i = 1; i < t.size(); ++i) t[i] = turned(t[i], q);
        return t;
    };
    auto extent_at = [&](double q) { return extent(straightened(tightened_by(q))); };
    const double want = curl.contraction * extent_at(1);
    double low = 1, high = 1 + slender * (curl.tightening - 1);
    for (int k = 0; k < 24; ++k) {
        const double middle = (low + high) / 2;
        (extent_at(middle) > want ? low : high) = middle;
    }
    helix_ = tightened_by((low + high) / 2);
}

std::vector<Vec3d> WetCurl::straightened(const std::vector<Vec3d>& tbar) const {
    return about_axis(shape_from_intrinsic(tbar, {0, 0, 0}, Quatd::identity()),
                      turn_ * turning_of(tbar).segments_of_a_turn() / segments_)
        .second;
}

std::vector<Vec3d> WetCurl::at(const float* saturation) const {
    std::vector<double> s(dry_.size());
    for (size_t i = 0; i < s.size(); ++i) s[i] = weight_ * saturation[i];
    if (std::all_of(s.begin() + 1, s.end(), [](double x) { return x == 0; })) return dry_;
    auto edges = straightened(between(straight_, helix_, s));
    start_alike(edges, drawn_, turn_);
    // Along the axis as it is drawn, as far as the wet strand goes.
    double along = 0, passed = 0;
    size_t k = 0;
    for (size_t i = 0; i < edges.size(); ++i) {
        const Vec3d e = rotate(bend_left_[i], edges[i]);
        const double middle = along + e.x / 2;
        while (k + 1 < edges_.size() && passed + edges_[k].x < middle) passed += edges_[k++].x;
        along += e.x;
        edges[i] = rotate(frames_[k], e);
    }
    edges[0] = dry_[0];  // the root holds it
    auto out = intrinsic_shape(polyline(edges));
    for (size_t i = 0; i < out.size() && (i == 0 || s[i] == 0); ++i) out[i] = dry_[i];
    return out;
}

size_t WetCurl::bytes() const {
    return sizeof(Vec3d) * (dry_.capacity() + straight_.capacity() + helix_.capacity() + edges_.capacity() +
                            drawn_.capacity()) +
           sizeof(Quatd) * (frames_.capacity() + bend_left_.capacity());
}

std::vector<Vec3d> curled(const Curl& curl, const std::vector<Vec3d>& tbar, const float* saturation) {
    return WetCurl(curl, tbar).at(saturation);
}

Mat3<double> helix_rotation(const Vec3d& h, const Vec3d& p, const Vec3d& axis) {
    const double c = dot(h, p);
    if (c < -1 + 1e-12) {
        Vec3d u = normalized(axis - dot(axis, h) * h, normalized(any_perpendicular(h), Vec3d{1, 0, 0}));
        return {2 * u.x * u - Vec3d{1, 0, 0}, 2 * u.y * u - Vec3d{0, 1, 0}, 2 * u.z * u - Vec3d{0, 0, 1}};
    }
    const Vec3d g = cross(h, p);
    const double s = 1 / (1 + c), gg = dot(g, g);
    auto row = [&](const Vec3d& unit, double gi) { return unit + cross(unit, g) + s * (gi * g - gg * unit); };
    return {row({1, 0, 0}, g.x), row({0, 1, 0}, g.y), row({0, 0, 1}, g.z)};
}

}  // namespace wetcurl

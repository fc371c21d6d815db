// Curl exaggeration on the rest shape.
#include "solver/terms/curl.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

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

Vec3d printed_edge(const Curl& curl, double l, int i) {
    const double r = *curl.radius, p = *curl.pitch / (2 * pi), omega = helix_angle(r, p, l);
    return {p * omega, r * (std::cos(omega * (i + 1)) - std::cos(omega * i)),
            r * (std::sin(omega * (i + 1)) - std::sin(omega * i))};
}

std::vector<Vec3d> intrinsic_shape(const std::vector<Vec3d>& p) {
    std::vector<Vec3d> tbar(p.size() - 1);
    intrinsic_shape(int(tbar.size()), p.data(), tbar.data());
    return tbar;
}

std::vector<Vec3d> shape_from_intrinsic(const std::vector<Vec3d>& tbar, const Vec3d& root,
                                        const Quatd& frame) {
    std::vector<Vec3d> p(tbar.size() + 1);
    shape_from_intrinsic(int(tbar.size()), tbar.data(), root, frame, p.data());
    return p;
}

Turning turning_of(const std::vector<Vec3d>& tbar) { return turning_of(int(tbar.size()), tbar.data()); }

namespace {

// tbar with the turn at each vertex multiplied by q, its direction and length kept.
Vec3d turned(const Vec3d& t, double q) {
    const double across = std::hypot(t.y, t.z), length = norm(t);
    if (across < 1e-12 * length) return t;
    const double theta = std::min(q * std::atan2(across, t.x), 0.9 * pi);
    const double s = length * std::sin(theta) / across;
    return {length * std::cos(theta), s * t.y, s * t.z};
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

using FramesAndEdges = std::pair<std::vector<Quatd>, std::vector<Vec3d>>;
FramesAndEdges about_axis(const std::vector<Vec3d>& p, double turn) {
    FramesAndEdges out;
    about_axis(int(p.size()) - 1, p.data(), turn, [&](size_t, const Quatd& f, const Vec3d& e) {
        out.first.push_back(f), out.second.push_back(e);
    });
    return out;
}

std::vector<Vec3d> polyline(const std::vector<Vec3d>& edges) {
    std::vector<Vec3d> p(edges.size() + 1);
    polyline(int(edges.size()), edges.data(), p.data());
    return p;
}

// Length of the axis that edges lie about.
double extent(const std::vector<Vec3d>& edges) {
    double sum = 0;
    for (const auto& e : edges) sum += e.x;
    return sum;
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

WetCurl::WetCurl(const Curl& curl, const std::vector<Vec3d>& tbar) : dry_(tbar) {
    const int edges = int(tbar.size());
    auto p = shape_from_intrinsic(tbar, {0, 0, 0}, Quatd::identity());
    double turn = turn_of_curl(p);
    double length = 0, axis = 0;
    for (int i = 0; i < edges; ++i)
        length += norm(tbar[size_t(i)]), axis += norm(chord_of_turn(edges, p.data(), turn, i)) / turn;
    // A flat coil has no length to lose, and an axis that its points do not tell well.
    const double slender = std::clamp((axis / length - 0.15) / 0.1, 0.0, 1.0);
    if (slender == 0) turn = double(edges);

    std::tie(frames_, straight_edges_) = about_axis(p, turn);
    straight_ = intrinsic_shape(polyline(straight_edges_));
    std::tie(bend_left_, drawn_) = about_axis(polyline(straight_edges_), turn);
    const Turning turning = turning_of(straight_);
    curl_ = {curl.w_h, turn, turning.segments_of_a_turn()};
    if (curl.radius) {
        helix_ = intrinsic_shape(polyline(
            helix_about_axis(straight_edges_, turning.phase < 0 ? -1 : 1, *curl.radius, *curl.pitch)));
        return;
    }
    auto tightened_by = [&](double q) {
        std::vector<Vec3d> t = straight_;
        for (size_t i = 1; i < t.size(); ++i) t[i] = turned(t[i], q);
        return t;
    };
    auto extent_at = [&](double q) {
        auto t = tightened_by(q);
        view().straighten(t.data(), p.data());
        return extent(t);
    };
    // Hair with hardly any curl would frizz: it contracts in proportion to what is there.
    constexpr double curly = 0.2;  // of the length, which a curl takes up
    const double there = std::min(1.0, (1 - axis / length) / curly);
    const double want =
        (there < 1 ? 1 - there * there * (1 - curl.contraction) : curl.contraction) * extent_at(1);
    double low = 1, high = 1 + slender * (curl.tightening - 1);
    for (int k = 0; k < 24; ++k) {
        const double middle = (low + high) / 2;
        (extent_at(middle) > want ? low : high) = middle;
    }
    helix_ = tightened_by((low + high) / 2);
}

WetCurlView<const Vec3d*, const Quatd*> WetCurl::view() const {
    return {int(dry_.size()), curl_,          dry_.data(),       straight_edges_.data(), straight_.data(),
            helix_.data(),    frames_.data(), bend_left_.data(), drawn_.data()};
}

std::vector<Vec3d> WetCurl::at(const float* saturation) const {
    std::vector<Vec3d> out, points;
    at(saturation, out, points);
    return out;
}

void WetCurl::at(const float* saturation, std::vector<Vec3d>& out, std::vector<Vec3d>& points) const {
    out.resize(dry_.size()), points.resize(dry_.size() + 1);
    view().at(saturation, out.data(), points.data());
}

size_t WetCurl::bytes() const {
    return sizeof(Vec3d) * (dry_.capacity() + straight_.capacity() + helix_.capacity() +
                            straight_edges_.capacity() + drawn_.capacity()) +
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

// Curl exaggeration on the rest shape.
#include "solver/terms/curl.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

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

// tbar with the turn at each vertex multiplied by q, its direction and length kept.
Vec3d turned(const Vec3d& t, double q) {
    const double across = std::hypot(t.y, t.z), length = norm(t);
    if (across < 1e-12 * length) return t;
    const double theta = std::min(q * std::atan2(across, t.x), 0.9 * pi);
    const double s = length * std::sin(theta) / across;
    return {length * std::cos(theta), s * t.y, s * t.z};
}

// Length of the strand's axis: the mean chord from a point to the one a turn of the curl further along the
// polyline, `turn` segments, as many times as the strand has turns.
double axial_extent(const std::vector<Vec3d>& p, double turn) {
    const size_t n = p.size();
    turn = std::clamp(turn, 1.0, double(n - 1));
    const size_t whole = std::min(size_t(turn), n - 2);
    const double rest = turn - double(whole);
    double sum = 0;
    for (size_t i = 0; i + whole + 1 < n; ++i) {
        const Vec3d end = p[i + whole] + rest * (p[i + whole + 1] - p[i + whole]);
        sum += norm(end - p[i]);
    }
    return sum / double(n - whole - 1) * double(n - 1) / turn;
}

std::vector<Vec3d> tightened(const std::vector<Vec3d>& tbar, double contraction, double most) {
    const Quatd frame = Quatd::identity();
    auto extent_at = [&](double q) {
        std::vector<Vec3d> t = tbar;
        for (size_t i = 1; i < t.size(); ++i) t[i] = turned(t[i], q);
        return axial_extent(shape_from_intrinsic(t, {0, 0, 0}, frame), turning_of(t).segments_of_a_turn());
    };
    const double want = contraction * extent_at(1);
    double low = 1, high = most;
    for (int k = 0; k < 24; ++k) {
        const double middle = (low + high) / 2;
        (extent_at(middle) > want ? low : high) = middle;
    }
    std::vector<Vec3d> out = tbar;
    for (size_t i = 1; i < out.size(); ++i) out[i] = turned(tbar[i], (low + high) / 2);
    return out;
}

// The helix of Eq 6 by its intrinsic shape: handedness and phase fitted to the dry strand, lengths kept.
std::vector<Vec3d> fitted_helix(const std::vector<Vec3d>& tbar, double radius, double pitch) {
    std::vector<Vec3d> p{{radius, 0, 0}};
    const double sign = turning_of(tbar).phase < 0 ? -1 : 1;
    double t = 0;
    for (const auto& e : tbar) {
        const double omega = helix_angle(radius, pitch / (2 * pi), norm(e));
        t += omega;
        const double rise =
            std::sqrt(std::max(0.0, dot(e, e) - std::pow(2 * radius * std::sin(omega / 2), 2)));
        p.push_back({radius * std::cos(t), sign * radius * std::sin(t), p.back().z + rise});
    }
    std::vector<Vec3d> helix = intrinsic_shape(p);
    std::complex<double> offset = 0;
    for (size_t i = 1; i < tbar.size(); ++i)
        offset += std::complex<double>(tbar[i].y, tbar[i].z) *
                  std::conj(std::complex<double>(helix[i].y, helix[i].z));
    if (std::abs(offset) > 0)
        offset /= std::abs(offset);
    else
        offset = 1;
    for (auto& h : helix) {
        const auto turned_by = std::complex<double>(h.y, h.z) * offset;
        h.y = turned_by.real();
        h.z = turned_by.imag();
    }
    return helix;
}

}  // namespace

std::vector<Vec3d> fully_curled(const Curl& curl, const std::vector<Vec3d>& tbar) {
    return curl.radius ? fitted_helix(tbar, *curl.radius, *curl.pitch)
                       : tightened(tbar, curl.contraction, curl.tightening);
}

std::vector<Vec3d> partly_curled(const Curl& curl, const std::vector<Vec3d>& tbar,
                                 const std::vector<Vec3d>& helix, const float* saturation) {
    std::vector<Vec3d> out = tbar;
    for (size_t i = 1; i < tbar.size(); ++i) {
        const double s = curl.w_h * saturation[i];
        if (s == 0) continue;
        const Vec3d mixed = (1 - s) * tbar[i] + s * helix[i];
        out[i] = norm(tbar[i]) * normalized(mixed, normalized(tbar[i], Vec3d{1, 0, 0}));
    }
    return out;
}

std::vector<Vec3d> curled(const Curl& curl, const std::vector<Vec3d>& tbar, const float* saturation) {
    return partly_curled(curl, tbar, fully_curled(curl, tbar), saturation);
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

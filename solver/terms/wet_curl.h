// How a strand curls as it takes up water, on any device: what WetCurl answers, over one strand's arrays,
// which are read and written by [index] alone. Ours; solver/terms/curl.h says after what.
#pragma once

#include <cmath>
#include <numbers>

#include "base/geometry/filter.h"
#include "base/geometry/frames.h"

namespace wetcurl {

// Across a strand's axis, as a complex number: kernels have no std::complex.
struct Across {
    double y, z;
    WETCURL_HD double length() const { return std::hypot(y, z); }
    WETCURL_HD double angle() const { return std::atan2(z, y); }
};
WETCURL_HD inline Across across(const Vec3d& t) { return {t.y, t.z}; }
// a times b's conjugate, as which its angle is that from b to a; and a turned by b.
WETCURL_HD inline Across from_to(const Across& b, const Across& a) {
    return {a.y * b.y + a.z * b.z, a.z * b.y - a.y * b.z};
}
WETCURL_HD inline Across turned_by(const Across& a, const Across& b) {
    return {a.y * b.y - a.z * b.z, a.y * b.z + a.z * b.y};
}

// tbar (edges) of points p (edges + 1).
template <class Points, class Shape>
WETCURL_HD void intrinsic_shape(int edges, const Points& p, const Shape& tbar) {
    Vec3d e = p[1] - p[0], direction = normalized(e, Vec3d{1, 0, 0});
    tbar[0] = {norm(e), 0, 0};
    Quatd f = root_frame_of(direction);
    for (size_t i = 1; i < size_t(edges); ++i) {
        e = p[i + 1] - p[i];
        tbar[i] = rotate(conjugate(f), e);
        direction = normalized(e, direction);
        f = transported(f, direction);
    }
}
// And back.
template <class Shape, class Points>
WETCURL_HD void shape_from_intrinsic(int edges, const Shape& tbar, const Vec3d& root, const Quatd& frame,
                                     const Points& p) {
    Vec3d at = root;
    Quatd f = frame;
    p[0] = at;
    for (size_t i = 0; i < size_t(edges); ++i) {
        const Vec3d e = rotate(f, tbar[i]);
        p[i + 1] = at = at + e;
        f = transported(f, e);
    }
}
// From the origin; p (edges + 1).
template <class Edges, class Points>
WETCURL_HD void polyline(int edges, const Edges& e, const Points& p) {
    Vec3d at{0, 0, 0};
    p[0] = at;
    for (size_t i = 0; i < size_t(edges); ++i) p[i + 1] = at = at + e[i];
}

// Mean turn at a vertex and mean angle by which successive curvature directions advance: the two make one
// rotation a segment, cos(omega/2) = cos(theta/2) cos(phase/2).
struct Turning {
    double theta, phase;  // radians a segment; phase is signed (handedness)
    double coherence;     // of the advance: 1 on a helix, near 0 in noise
    WETCURL_HD double segments_of_a_turn() const {
        constexpr double pi = std::numbers::pi;
        const double omega = 2 * std::acos(std::cos(theta / 2) * std::cos(phase / 2));
        return 2 * pi / minimum(maximum(omega, 1e-3), pi);
    }
};
template <class Shape>
WETCURL_HD Turning turning_of(int edges, const Shape& tbar) {
    double theta = 0, most = 0, length_before = 0;
    Across advance{0, 0}, before{0, 0};
    for (size_t i = 1; i < size_t(edges); ++i) {
        const Across kappa = across(tbar[i]), on = from_to(before, kappa);
        const double length = kappa.length();
        theta += std::atan2(length, tbar[i].x);
        advance = {advance.y + on.y, advance.z + on.z};
        most += length * length_before;
        before = kappa, length_before = length;
    }
    const double count = double(maximum(1, edges - 1));
    return {theta / count, advance.length() > 0 ? advance.angle() : 0,
            most > 0 ? advance.length() / most : 0};
}

// Point at the place x of the polyline p, in segments.
template <class Points>
WETCURL_HD Vec3d point_at(int edges, const Points& p, double x) {
    const size_t k = size_t(minimum(x, double(edges - 1)));
    return p[k] + (x - double(k)) * (p[k + 1] - p[k]);
}
// Chord of the turn about the middle of edge i, of the first and the last whole turn at the ends.
template <class Points>
WETCURL_HD Vec3d chord_of_turn(int edges, const Points& p, double turn, int i) {
    const double from = minimum(maximum(double(i) + 0.5 - turn / 2, 0.0), double(edges) - turn);
    return point_at(edges, p, from + turn) - point_at(edges, p, from);
}
// Each edge in the frame, carried along, of the strand's axis, the chord of the turn about it: store(i,
// frame, edge), for which p is read up to its end.
template <class Points, class Store>
WETCURL_HD void about_axis(int edges, const Points& p, double turn, Store store) {
    turn = minimum(maximum(turn, 1.0), double(edges));
    Quatd f = Quatd::identity();
    for (int i = 0; i < edges; ++i) {
        const Vec3d axis = chord_of_turn(edges, p, turn, i);
        f = i == 0 ? root_frame_of(normalized(axis, Vec3d{1, 0, 0})) : transported(f, axis);
        store(size_t(i), f, rotate(conjugate(f), p[size_t(i) + 1] - p[size_t(i)]));
    }
}

// The helix turned about its axis so that it leaves the root to the side to which `edges` do: over a quarter
// of a turn, since the two may have different turns.
template <class Helix, class Edges>
WETCURL_HD void start_alike(int count, const Helix& helix, const Edges& edges, double turn) {
    Across phase{0, 0};
    for (size_t i = 0; i < size_t(count) && double(i) <= turn / 4; ++i) {
        const Across on = from_to(across(helix[i]), across(edges[i]));
        phase = {phase.y + on.y, phase.z + on.z};
    }
    const double length = phase.length();
    phase = length > 0 ? Across{phase.y / length, phase.z / length} : Across{1, 0};
    for (size_t i = 0; i < size_t(count); ++i) {
        const Vec3d e = helix[i];
        const Across to = turned_by(across(e), phase);
        helix[i] = {e.x, to.y, to.z};
    }
}

// Between two shapes by angle and direction of each turn, share(i) of the way: curls of two phases added as
// vectors would straighten each other.
template <class Shape, class Share, class Out>
WETCURL_HD void between(int edges, const Shape& tbar, const Shape& other, Share share, const Out& out) {
    constexpr double pi = std::numbers::pi;
    out[0] = tbar[0];
    double ahead = 0;  // of the other's direction, followed along the strand over whole turns
    for (size_t i = 1; i < size_t(edges); ++i) {
        const double s = share(i);
        const Across from = across(tbar[i]), to = across(other[i]);
        if (const Across change = from_to(from, to); change.length() > 0)
            ahead += std::remainder(change.angle() - ahead, 2 * pi);
        const double aside_from = from.length();
        const double theta =
            (1 - s) * std::atan2(aside_from, tbar[i].x) + s * std::atan2(to.length(), other[i].x);
        const double direction = aside_from > 0 ? from.angle() + s * ahead : to.angle();
        const double length = norm(tbar[i]), aside = length * std::sin(theta);
        out[i] = {length * std::cos(theta), aside * std::cos(direction), aside * std::sin(direction)};
    }
}

struct CurlOfStrand {
    double weight, turn, segments;  // segments of a turn, and as the mean of turns tells them
};
// A view of a WetCurl's arrays, (edge).
template <class Vectors, class Rotations>
struct WetCurlView {
    int edges;
    CurlOfStrand curl;
    Vectors dry;
    // Of the strand laid straight by the frames along its axis: edges, and tbar dry and fully curled.
    Vectors straight_edges, straight, helix;
    Rotations frames;
    // How far from straight it is still, near the root, where hair lifts off: frames, and edges in them.
    Rotations bend_left;
    Vectors drawn;

    // Edges about the axis of a strand that is curled by turns alone, in the place of its tbar.
    template <class Edges, class Points>
    WETCURL_HD void straighten(const Edges& tbar, const Points& points) const {
        shape_from_intrinsic(edges, tbar, {0, 0, 0}, Quatd::identity(), points);
        const double turn = curl.turn * turning_of(edges, tbar).segments_of_a_turn() / curl.segments;
        about_axis(edges, points, turn, [&](size_t i, const Quatd&, const Vec3d& e) { tbar[i] = e; });
    }
    // tbar at `saturation` (n) -> out. Up to where it is first above 0, the dry bits. `points` (n) is room
    // for it.
    template <class Out, class Points>
    WETCURL_HD void at(const float* saturation, const Out& out, const Points& points) const {
        auto share = [&](size_t i) { return curl.weight * saturation[i]; };
        bool wet = false;
        for (size_t i = 1; i < size_t(edges); ++i) wet |= share(i) != 0;
        if (!wet) {
            for (size_t i = 0; i < size_t(edges); ++i) out[i] = dry[i];
            return;
        }
        between(edges, straight, helix, share, out);
        straighten(out, points);
        start_alike(edges, out, drawn, curl.turn);
        // Along the axis as it is drawn, as far as the wet strand goes.
        double along = 0, passed = 0;
        size_t k = 0;
        for (size_t i = 0; i < size_t(edges); ++i) {
            const Vec3d e = rotate(bend_left[i], out[i]);
            const double middle = along + e.x / 2;
            while (k + 1 < size_t(edges) && passed + straight_edges[k].x < middle)
                passed += straight_edges[k++].x;
            along += e.x;
            out[i] = rotate(frames[k], e);
        }
        out[0] = dry[0];  // the root holds it
        polyline(edges, out, points);
        intrinsic_shape(edges, points, out);
        for (size_t i = 0; i < size_t(edges) && (i == 0 || share(i) == 0); ++i) out[i] = dry[i];
    }
};

// Core lengths (edge) of a strand whose bend has a new target: those drawn, as much longer as those of the
// target are than `core`, those of the dry one. store(i, length); `points` (n) is room for it.
template <class Shape, class Lengths, class Points, class Store>
WETCURL_HD void core_of_curl(int edges, double beta, const Shape& target, const Lengths& core,
                             const Lengths& drawn, const Points& points, Store store) {
    shape_from_intrinsic(edges, target, {0, 0, 0}, Quatd::identity(), points);
    smoothed_lengths(edges, beta, points, [&](int i, double after) {
        const size_t k = size_t(i);
        store(k, after == core[k] ? drawn[k] : drawn[k] * (after / core[k]));
    });
}

}  // namespace wetcurl

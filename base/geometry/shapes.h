// Solid shapes in body coordinates and their signed distance; analytic ones over any scalar, Pack among them.
// Source: ours (the box after Quilez's distance functions).
#pragma once

#include <memory>
#include <variant>

#include "base/geometry/moving_level_set.h"

namespace wetcurl {

// Lengths [m], each above 0 (a capsule's half_length may be 0).
struct Sphere {
    double radius = 0.1;
};
struct Capsule {
    double half_length = 0.1;  // of the segment along y that carries the caps' centres
    double radius = 0.05;
};
struct Box {
    Vec3d half{0.1, 0.1, 0.1};
};
// y = 0, outside above.
struct Plane {};

using Shape = std::variant<Sphere, Capsule, Box, Plane, std::shared_ptr<const LevelSet>>;

template <class S>
WETCURL_HD DistanceSample<S> distance(const Capsule& capsule, const Vec3<S>& x) {
    const S half(capsule.half_length);
    const Vec3<S> from_axis{x.x, x.y - minimum(maximum(x.y, -half), half), x.z};
    // Every direction across the axis is a normal on it.
    return {norm(from_axis) - S(capsule.radius), normalized(from_axis, Vec3<S>{S(1), S(0), S(0)})};
}

template <class S>
WETCURL_HD DistanceSample<S> distance(const Sphere& sphere, const Vec3<S>& x) {
    return distance(Capsule{0, sphere.radius}, x);
}

template <class S>
WETCURL_HD DistanceSample<S> distance(const Box& box, const Vec3<S>& x) {
    const Vec3<S> side{select(x.x < S(0), S(-1), S(1)), select(x.y < S(0), S(-1), S(1)),
                       select(x.z < S(0), S(-1), S(1))};
    const Vec3<S> q{side.x * x.x - S(box.half.x), side.y * x.y - S(box.half.y), side.z * x.z - S(box.half.z)};
    const Vec3<S> over{maximum(q.x, S(0)), maximum(q.y, S(0)), maximum(q.z, S(0))};
    // Inside, the nearest face decides.
    const S deepest = maximum(q.x, maximum(q.y, q.z));
    const Vec3<S> along_y{S(0), side.y, S(0)}, along_z{S(0), S(0), side.z};
    const Vec3<S> face =
        select(deepest <= q.x, Vec3<S>{side.x, S(0), S(0)}, select(deepest <= q.y, along_y, along_z));
    const Vec3<S> outward{side.x * over.x, side.y * over.y, side.z * over.z};
    return {norm(over) + minimum(deepest, S(0)), normalized(outward, face)};
}

template <class S>
WETCURL_HD DistanceSample<S> distance(const Plane&, const Vec3<S>& x) {
    return {x.y, Vec3<S>{S(0), S(1), S(0)}};
}

template <class S>
DistanceSample<S> distance(const std::shared_ptr<const LevelSet>& level_set, const Vec3<S>& x) {
    return sample(level_set->grid(), x);
}
template <class S>
DistanceSample<S> distance(const MovingGrid& grid, const Vec3<S>& x) {
    return sample(grid, x);
}

// Signed distance [m] and unit outward normal at x [m], S float, double or a Pack of them.
template <class S>
DistanceSample<S> distance(const Shape& shape, const Vec3<S>& x) {
    return std::visit([&x](const auto& s) { return distance(s, x); }, shape);
}

// A shape by value, as any device samples it; `grid` lies in that device's memory. Of one that rests it is a
// DistanceGrid alone.
struct ShapeView {
    enum class Kind { round, box, plane, grid, moving_grid } kind = Kind::plane;
    Capsule round;
    Box box;
    MovingGrid grid{};
};
ShapeView view_of(const Shape& shape);

// A box in body coordinates whose distance is nowhere above the shape's sampled one; a plane's is all of
// space.
Bounds bounds_of(const Shape& shape);

// Whether it is the same however it is turned.
WETCURL_HD inline bool is_ball(const ShapeView& shape) {
    return shape.kind == ShapeView::Kind::round && shape.round.half_length == 0;
}
inline bool is_ball(const Shape& shape) {
    const auto* capsule = std::get_if<Capsule>(&shape);
    return std::holds_alternative<Sphere>(shape) || (capsule && capsule->half_length == 0);
}
WETCURL_HD inline bool is_ball(const MovingGrid&) { return false; }

// How many pushes along the gradient bring a point to its surface: one, but where the distance is sampled;
// most in a crease, to which each push comes a part of the way (a learned groom on a head: 4 leave 0.02 % of
// it up to 2.7 mm inside, 16 0.001 % up to 0.7, 64 one in 10^6 up to 0.2). Those after the first are for what
// is deeper than `near_surface` [m].
constexpr int most_pushes = 64;
constexpr double near_surface = 1e-5;
WETCURL_HD inline int pushes_of(const ShapeView& shape) {
    return shape.kind == ShapeView::Kind::grid || shape.kind == ShapeView::Kind::moving_grid ? most_pushes
                                                                                             : 1;
}
inline int pushes_of(const Shape& shape) {
    return std::holds_alternative<std::shared_ptr<const LevelSet>>(shape) ? most_pushes : 1;
}
WETCURL_HD inline int pushes_of(const MovingGrid&) { return most_pushes; }

template <class S>
WETCURL_HD DistanceSample<S> distance(const ShapeView& shape, const Vec3<S>& x) {
    switch (shape.kind) {
        case ShapeView::Kind::round:
            return distance(shape.round, x);
        case ShapeView::Kind::box:
            return distance(shape.box, x);
        case ShapeView::Kind::grid:
            return sample(static_cast<const DistanceGrid&>(shape.grid), x);
        case ShapeView::Kind::moving_grid:
            return sample(shape.grid, x);
        default:
            return distance(Plane{}, x);
    }
}

// x moved out to where its distance is `allowed` [m], at most 0, if it is deeper.
WETCURL_HD inline Vec3f pushed_out(const ShapeView& shape, Vec3f x, float allowed) {
    const int rounds = pushes_of(shape);
    for (int round = 0; round < rounds; ++round) {
        const DistanceSample<float> d = distance(shape, x);
        if (!(d.phi < allowed - (round > 0 ? float(near_surface) : 0.f))) break;
        x += (allowed - d.phi) * d.normal;
    }
    return x;
}

// Of a strand whose particles were pushed out each by itself, two in a row may lie on either side of a solid.
// The edge between them is torn: longer than `most` [m], here often so many times its length at rest.
constexpr float torn_lengths = 2;
WETCURL_HD inline bool is_torn(const Vec3f& edge, float most) { return norm(edge) > most; }
// Then x is led around from `before`, the particle before it, as far as `most`; the last push may make the
// edge somewhat longer. Wherever an edge is so long, that is, whatever made it so. out(x) pushes out.
template <class Out>
WETCURL_HD Vec3f led_around(const Vec3f& before, const Vec3f& x, float most, Out out) {
    constexpr int turns = 4;  // each leaves more of the edge along the surface
    if (!is_torn(x - before, most)) return x;
    Vec3f to = x;
    for (int turn = 0; turn < turns; ++turn) {
        const Vec3f edge = to - before;
        to = out(before + (most / maximum(norm(edge), tiny_length<float>)) * edge);
    }
    return to;
}

// For drawing: round shapes with `around` corners a turn, inscribed; a plane as a quad of 1 m; a level set as
// the mesh that it was made from. Triangles turn anticlockwise seen from outside.
Mesh triangulated(const Shape& shape, int around = 48);

}  // namespace wetcurl

// The built-in groom.
#include "solver/grooms/procedural.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "base/exchange/scene_mesh.h"
#include "base/geometry/bust.h"

namespace wetcurl {
namespace {

constexpr double two_pi = 2 * std::numbers::pi;
constexpr Vec3d down{0, -1, 0};

// SplitMix64 (Steele 2014), its finaliser.
uint64_t mixed(uint64_t z) {
    z += 0x9e3779b97f4a7c15ull;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
}

// Random numbers of one strand or lock: a function of the seed and the place alone. i / W and (2 i) / (2 W)
// are the same double, since division rounds the same quotient.
class Noise {
  public:
    template <class... Place>
    explicit Noise(uint64_t seed, Place... place) : state_(mixed(seed)) {
        ((state_ = mixed(state_ ^ std::bit_cast<uint64_t>(double(place)))), ...);
    }
    // In [-1, 1).
    double next() { return double((state_ = mixed(state_)) >> 11) * 0x1p-52 - 1; }

  private:
    uint64_t state_;
};

double smoothstep(double x) {
    x = std::clamp(x, 0.0, 1.0);
    return x * x * (3 - 2 * x);
}

// One strand's own numbers.
struct Shape {
    double length, radius, phase, turn;  // turn: +1 or -1, the helix's hand
};

Shape shape_of(const ProceduralGroom& g, Noise noise) {
    Shape shape;
    shape.phase = g.phase_noise * noise.next();
    shape.radius = g.curl_radius * (1 + g.radius_noise * noise.next());
    shape.length = g.length * (1 + g.length_noise * noise.next());
    shape.turn = noise.next() < 0 ? -1 : 1;
    return shape;
}

// The middle of the lock that a root at `place` belongs to, and the lock's noise: of points that lie at
// random, one in each cube of `width`, the nearest (Worley 1996).
struct Lock {
    Vec3d middle;
    Noise noise;
    Lock(uint64_t seed, double width, const Vec3d& place) : noise(seed, 0, 0) {
        const Vec3d at = (1 / width) * place;
        double least = std::numeric_limits<double>::infinity();
        for (int n = 0; n < 27; ++n) {
            const Vec3d cube{std::floor(at.x) + n % 3 - 1, std::floor(at.y) + n / 3 % 3 - 1,
                             std::floor(at.z) + n / 9 - 1};
            Noise own(seed, cube.x, cube.y, cube.z);
            const auto within = [&] { return 0.5 + 0.5 * own.next(); };
            const Vec3d point{cube.x + within(), cube.y + within(), cube.z + within()};
            if (const double far = norm(point - at); far < least)
                least = far, middle = width * point, noise = own;
        }
    }
};

Cap cap_of(const ProceduralGroom& g) {
    return {{0, std::cos(g.tilt), -std::sin(g.tilt)},
            {1, 0, 0},
            g.coverage,
            g.hairline == "natural" ? hairline : nullptr};
}

// The part: a point before the rim of the hair, in the middle of the brow. Strands run away from it.
Vec3d part_of(const ProceduralGroom& g) {
    constexpr double before_rim = 0.15;  // [rad]
    const double rim = g.hairline == "natural" ? hairline({0, 0, 1}) : g.coverage - g.tilt,
                 angle = rim + before_rim;
    return rotate(rotation_about({0, 1, 0}, g.part_turn), {0, std::cos(angle), std::sin(angle)});
}

class Grower {
  public:
    explicit Grower(const ProceduralGroom& g)
        : g_(g), scalp_(g.scalp_centre, g.scalp_radius, g.head), cap_(cap_of(g)), part_(part_of(g)) {}

    // Writes the strand at (u, v) of the square to points[0 .. particles); returns the scalp's normal there.
    Vec3d grow(double u, double v, Vec3f* points) const;

  private:
    Vec3d away_from_part(const Vec3d& out) const {
        return normalized(dot(part_, out) * out - part_, Vec3d{0, 0, -1});
    }
    Vec3d fall(const Vec3d& x, double height) const;
    Shape shape_at(double u, double v, const Vec3d& root) const;

    const ProceduralGroom& g_;
    Scalp scalp_;
    Cap cap_;
    Vec3d part_;
};

// Where a strand at x is drawn: down, and away from the part, the less the farther from it and from the
// scalp.
Vec3d Grower::fall(const Vec3d& x, double height) const {
    const Vec3d out = normalized(x - scalp_.centre(), Vec3d{0, 1, 0});
    const double near = 0.5 * (1 + dot(part_, out)), close = 1 - smoothstep(height / g_.scalp_radius);
    return normalized(down + (g_.comb * near * near * close) * away_from_part(out), down);
}

// Strands of a lock have its curl, but for a share of their own, and are in phase side by side.
Shape Grower::shape_at(double u, double v, const Vec3d& root) const {
    Shape shape = shape_of(g_, Noise(g_.seed, u, v));
    if (!(g_.curl_lock > 0)) return shape;
    constexpr double own = 0.15;
    const Lock lock(g_.seed, g_.curl_lock, root);
    const Shape shared = shape_of(g_, lock.noise);
    const double ahead = dot(root - lock.middle, fall(root, 0));
    shape.radius = shared.radius + own * (shape.radius - shared.radius);
    shape.phase = shared.phase + own * shape.phase + shared.turn * two_pi * ahead / g_.pitch;
    shape.turn = shared.turn;
    return shape;
}

Vec3d Grower::grow(double u, double v, Vec3f* points) const {
    const ScalpPoint root = scalp_.root(cap_.direction(u, v));
    const Shape shape = shape_at(u, v, root.place);
    ScalpPoint here = root;
    // The core keeps this height where it glides over the scalp, so that the curl stays outside.
    const double glide = shape.radius + 1e-3;
    const double step = std::min(shape.radius > 0 ? g_.pitch / 48 : g_.lift / 16, g_.lift / 16);
    constexpr double ramp = 0.15;  // of the length, over which the curl opens

    Vec3d core = root.place, t = root.normal;
    Vec3d side = normalized(cross(away_from_part(root.normal), t), any_perpendicular(t));
    Vec3d before = root.place, last = root.place;
    double along = 0, spent = 0;  // arc length of the core and of the strand [m]
    points[0] = cast<float>(root.place);
    for (int i = 1; i < g_.particles; ++i) {
        const double want = shape.length * i / (g_.particles - 1);
        double stride = norm(last - before);
        while (spent < want) {
            // The core turns toward its fall within `lift`, losing what would bring it below the glide
            // height.
            Vec3d turned = normalized(t + (step / g_.lift) * (fall(core, here.height) - t), t);
            const double inward = -dot(turned, here.normal),
                         held = 1 - smoothstep((here.height - glide) / g_.lift);
            if (inward > 0) turned = normalized(turned + (held * inward) * here.normal, t);
            side = rotate(minimal_rotation(t, turned), side);
            t = turned;
            core += step * t;
            along += step;
            here = scalp_.under(core);

            const double opened = shape.radius * smoothstep(spent / (ramp * shape.length));
            const double radius = std::min(opened, 0.9 * std::max(0.0, here.height));
            const double angle = shape.phase + shape.turn * two_pi * along / g_.pitch;
            before = last;
            last = core + radius * (std::cos(angle) * side + std::sin(angle) * cross(t, side));
            stride = norm(last - before);
            spent += stride;
        }
        const double back = stride > 0 ? (spent - want) / stride : 0;
        points[i] = cast<float>(last + back * (before - last));
    }
    return root.normal;
}

}  // namespace

std::shared_ptr<const ScalpMesh> read_scalp(const GroomTable& groom,
                                            const std::shared_ptr<const ScalpMesh>& of_solid,
                                            const std::string& up_of_hair) {
    if (groom.scalp.empty()) return of_solid;
    FileUnits meant = groom.units_of_scalp(up_of_hair);
    const FileAxes says = axes_of_mesh(groom.scalp);
    if (says.metres_per_unit && groom.scalp_units.empty()) meant.units = "auto";
    if (says.up && groom.scalp_up.empty()) meant.up = "auto";
    return std::make_shared<const ScalpMesh>(import_mesh(groom.scalp, meant));
}

ProceduralGroom read_procedural(const Table& table, unsigned long long seed,
                                const std::shared_ptr<const ScalpMesh>& of_solid) {
    GroomTable read;
    read_parameters(read, GroomTable::parameters, table);
    ProceduralGroom g;
    g.seed = seed;
    g.width = read.grid[0], g.height = read.grid[1];
    g.particles = read.particles;
    read_parameters(g, procedural_parameters, table);
    g.head = read_scalp(read, of_solid);
    const Vec3d usual = g.head ? head_centre(g.head->mesh(), g.scalp_radius) : Vec3d{0, 0, 0};
    g.scalp_centre = read.scalp_centre.value_or(usual);
    return g;
}

CurlTurns turns_of(const ProceduralGroom& g) {
    if (!(g.curl_radius > 0)) return {};
    return {g.length / std::hypot(two_pi * g.curl_radius, g.pitch), g.curl_radius};
}

Groom make_procedural(const ProceduralGroom& g) {
    const int count = g.width * g.height;
    Groom out;
    out.rest = Strands(count, g.particles);
    out.normal.resize(size_t(count));
    out.grid = {g.width, g.height, std::vector<int>(size_t(count))};
    const Grower grower(g);
#pragma omp parallel for schedule(dynamic, 16)
    for (int s = 0; s < count; ++s) {
        const double u = double(s % g.width) / g.width, v = double(s / g.width) / g.height;
        out.normal[size_t(s)] = cast<float>(grower.grow(u, v, out.rest.strand(s)));
        out.grid.strand[size_t(s)] = s;
    }
    return out;
}

}  // namespace wetcurl

// Draws strands and solids: camera, rasteriser and lights. Every pixel belongs to one tile and every tile is
// drawn by one thread in a fixed order, so the bits do not depend on the number of threads.
#include "app/drawing/picture.h"

#include <omp.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "app/drawing/opacity.h"
#include "app/drawing/shading.h"
#include "base/error.h"

namespace wetcurl {

namespace {

constexpr int fine = 2;               // subpixels a pixel, each way
constexpr int tile_edge = 64;         // subpixels; a multiple of `fine`
constexpr float nearest = 1e-3f;      // [m] in front of the eye; nothing nearer is drawn
constexpr double field_of_view = 26;  // of a fitted camera, vertical [degrees]
// A strand that touches a solid lies on it: in front of the solid by this much more than its axis says [m].
constexpr float lying = 1e-3f;
const Vec3f bright_back = linear_of_srgb(Vec3f{0.86f, 0.865f, 0.875f});
const Vec3f dim_back = linear_of_srgb(Vec3f{0.56f, 0.575f, 0.60f});
const Vec3f skin = linear_of_srgb(Vec3f{0.60f, 0.575f, 0.555f});

Vec3f lerp(const Vec3f& a, const Vec3f& b, float t) { return a + t * (b - a); }

// Directions spread evenly over the sphere (Fibonacci).
std::vector<Vec3f> spread_directions(int n) {
    std::vector<Vec3f> result;
    for (int i = 0; i < n; ++i) {
        double y = 1 - (2 * i + 1.0) / n, r = std::sqrt(1 - y * y),
               angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
        result.push_back({float(r * std::cos(angle)), float(y), float(r * std::sin(angle))});
    }
    return result;
}

// The points that lie outermost in 96 directions.
std::vector<Vec3f> outermost_of(const std::vector<Vec3f>& points) {
    std::vector<Vec3f> result;
    if (points.empty()) return result;
    for (const Vec3f& d : spread_directions(96))
        result.push_back(*std::max_element(points.begin(), points.end(), [&](const Vec3f& a, const Vec3f& b) {
            return dot(a, d) < dot(b, d);
        }));
    return result;
}

float diagonal_of(const std::vector<Vec3f>& points) {
    if (points.empty()) return 0;
    Vec3f low = points[0], high = points[0];
    for (const Vec3f& x : points) {
        low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
        high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
    }
    return norm(high - low);
}

std::vector<Vec3f> world_vertices(const PosedMesh& solid) {
    std::vector<Vec3f> result;
    result.reserve(solid.mesh.vertices.size());
    for (const Vec3f& v : solid.mesh.vertices) result.push_back(cast<float>(solid.pose(cast<double>(v))));
    return result;
}

// A solid counts for camera and shadows where it is at most this many times as large as the hair.
constexpr float comparable = 2.5f;

}  // namespace

// ---------------------------------------------------------------- camera

Vec3f Camera::project(const Vec3f& x) const {
    const Vec3f d = x - eye;
    const float depth = -dot(d, back);
    return {0.5f * width + focal * dot(d, right) / depth, 0.5f * height - focal * dot(d, up) / depth, depth};
}

Camera camera_at(const Vec3f& eye, const Vec3f& target, double view_degrees, int width, int height) {
    Camera camera;
    camera.eye = eye;
    camera.back = normalized(eye - target, Vec3f{0, 0, 1});
    camera.right = normalized(cross(Vec3f{0, 1, 0}, camera.back), Vec3f{1, 0, 0});
    camera.up = cross(camera.back, camera.right);
    camera.focal = float(0.5 * height / std::tan(view_degrees * std::numbers::pi / 360));
    camera.width = width;
    camera.height = height;
    return camera;
}

void Extent::add(const Strands& strands) {
    for (const Vec3f& x : strands.points)
        if (!std::isfinite(x.x + x.y + x.z))
            throw Error("cannot draw strands with positions that are not finite");
    const std::vector<Vec3f> outer = outermost_of(strands.points);
    strands_diagonal_ = std::max(strands_diagonal_, diagonal_of(outer));
    points_.insert(points_.end(), outer.begin(), outer.end());
}

void Extent::add(const PosedMesh& solid) {
    const std::vector<Vec3f> outer = outermost_of(world_vertices(solid));
    if (diagonal_of(outer) <= comparable * strands_diagonal_)
        points_.insert(points_.end(), outer.begin(), outer.end());
}

Camera carried(const Camera& camera, const Pose& from, const Pose& to) {
    Camera out = camera;
    const Quatd turn = to.rotation * conjugate(from.rotation);
    out.eye = cast<float>(to(from.inverse(cast<double>(camera.eye))));
    for (Vec3f* axis : {&out.right, &out.up, &out.back})
        *axis = cast<float>(rotate(turn, cast<double>(*axis)));
    return out;
}

Camera fitted_camera(const Extent& extent, const View& view, int width, int height) {
    const std::vector<Vec3f>& points = extent.outermost();
    if (points.empty()) throw Error("there is nothing to draw: no strands");
    const float angle = float(view.yaw * std::numbers::pi / 180),
                pitch = float(view.pitch * std::numbers::pi / 180);
    const Vec3f back{std::sin(angle) * std::cos(pitch), std::sin(pitch), std::cos(angle) * std::cos(pitch)};
    // Margins in pixels: the label stands on the last rows.
    const float side = 0.06f * width, top = 0.05f * height, bottom = 0.09f * height;
    const float size = std::max(diagonal_of(points), 1e-4f);
    Vec3f target = points[0];
    float distance = 4 * size;
    Camera camera;
    // Each round scales the distance by how far the picture over- or underfills, then recentres.
    for (int round = 0; round < 12; ++round) {
        camera = camera_at(target + distance * back, target, field_of_view, width, height);
        float left = 1e30f, right = -1e30f, low = 1e30f, high = -1e30f;
        for (const Vec3f& x : points) {
            Vec3f p = camera.project(x);
            left = std::min(left, p.x), right = std::max(right, p.x);
            low = std::min(low, p.y), high = std::max(high, p.y);
        }
        const float metre = distance / camera.focal;  // of a pixel at the target
        target += (metre * (0.5f * (left + right) - 0.5f * width)) * camera.right;
        target += (-metre * (0.5f * (low + high) - 0.5f * (top + height - bottom))) * camera.up;
        const float fill =
            std::max({(right - left) / (width - 2 * side), (high - low) / (height - top - bottom), 0.05f});
        distance = std::max(distance * fill, 0.6f * size);
    }
    camera.focal *= float(view.zoom);
    return camera;
}

// ---------------------------------------------------------------- colour

Vec3f rainbow_color(float share) {
    // Hue from 240 degrees (blue) to 0 (red) at full strength, softened a little for the eye.
    const float h = 4 * (1 - std::clamp(share, 0.f, 1.f));  // sixths of the circle
    auto channel = [&](float centre) { return std::clamp(2 - std::fabs(h - centre), 0.f, 1.f); };
    const float red = std::clamp(2 - h, 0.f, 1.f);
    return lerp({red, channel(2), channel(4)}, {0.5f, 0.5f, 0.5f}, 0.08f);
}

namespace {

// ---------------------------------------------------------------- lights

struct Light {
    Vec3f direction;  // to the light, unit
    Vec3f color;      // linear
};

// Lights stand where the camera stands, so that every view is lit alike: key from the upper left, rim from
// behind.
struct Lights {
    Light key, rim;
    Vec3f sky{0, 1, 0}, sky_color{0.62f, 0.66f, 0.72f}, front_color{0.40f, 0.38f, 0.37f};

    Lights(const Camera& c, const Panel& panel)
        : key{toward(c, panel.light_yaw, panel.light_pitch), {3.1f, 2.98f, 2.8f}},
          rim{normalized(0.75f * c.right + 0.55f * c.up - 0.75f * c.back, c.back), {1.5f, 1.6f, 1.75f}} {}

  private:
    static Vec3f toward(const Camera& c, double yaw_degrees, double pitch_degrees) {
        const float yaw = float(yaw_degrees * std::numbers::pi / 180),
                    pitch = float(pitch_degrees * std::numbers::pi / 180);
        return normalized(
            std::cos(pitch) * (std::sin(yaw) * c.right + std::cos(yaw) * c.back) + std::sin(pitch) * c.up,
            c.back);
    }
};

// What lies between a point and each light: hair, and solids apart, since a surface must not shade itself.
struct Shadows {
    Opacity key, rim, sky, front, solid_key, solid_rim;

    Shadows(const std::vector<Vec3f>& around, const Lights& lights, const Camera& camera, float cell)
        : key(around, lights.key.direction, cell),
          rim(around, lights.rim.direction, cell),
          sky(around, lights.sky, cell),
          front(around, camera.back, cell),
          solid_key(around, lights.key.direction, cell),
          solid_rim(around, lights.rim.direction, cell) {}
};

// Light at a point, after shadows.
struct Received {
    float key, rim, sky, front;
};

Received light_at(const Shadows& s, const Lights& lights, const Vec3f& x, const Vec3f& lifted) {
    const float clear = 2.5f * s.solid_key.cell();
    return {s.key.transmittance(x) * s.solid_key.transmittance(lifted + clear * lights.key.direction),
            s.rim.transmittance(x) * s.solid_rim.transmittance(lifted + clear * lights.rim.direction),
            s.sky.transmittance(x), s.front.transmittance(x)};
}

// ---------------------------------------------------------------- what is drawn

// A point of a strand on the picture; coordinates in subpixels.
struct StrandVertex {
    float column, row, depth;
    float half_width, opacity;
    Vec3f color;  // linear
};
struct Triangle {
    std::array<Vec3f, 3> world, normal;
    std::array<Vec3f, 3> seen;  // column, row [subpixel], depth [m]
};

uint32_t scrambled(uint32_t i) {
    i = (i ^ 61u) ^ (i >> 16);
    i *= 9u;
    i ^= i >> 4;
    i *= 0x27d4eb2du;
    return i ^ (i >> 15);
}
float unit_random(uint32_t i) { return float(scrambled(i) >> 8) / float(1 << 24); }

// Centripetal-free Catmull-Rom between b and c: the particles lie nearly evenly.
Vec3f catmull_rom(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d, float t) {
    return b + (0.5f * t) * ((c - a) + t * ((2.f * a - 5.f * b + 4.f * c - d) + t * (3.f * (b - c) + d - a)));
}

// A strand subdivided: `points` and, at each, how far along it lies (particle number, fractional).
struct Curve {
    std::vector<Vec3f> points;
    std::vector<float> along;
};

void subdivide(const Vec3f* p, int n, int pieces, Curve& curve) {
    curve.points.clear();
    curve.along.clear();
    auto at = [&](int i) {
        if (i < 0) return 2.f * p[0] - p[1];
        if (i >= n) return 2.f * p[n - 1] - p[n - 2];
        return p[i];
    };
    for (int i = 0; i + 1 < n; ++i)
        for (int k = 0; k < pieces; ++k) {
            float t = float(k) / pieces;
            curve.points.push_back(catmull_rom(at(i - 1), p[i], p[i + 1], at(i + 2), t));
            curve.along.push_back(i + t);
        }
    curve.points.push_back(p[n - 1]);
    curve.along.push_back(float(n - 1));
}

// Width of a drawn strand [m]: few strands stand for many hairs and are drawn thicker; 0.07 mm is a real one.
float drawn_width(int strands) {
    return std::clamp(0.80e-3f * std::sqrt(1000.f / std::max(strands, 1)), 0.07e-3f, 1.1e-3f);
}

class PanelScene {
  public:
    PanelScene(const Panel& panel, const Camera& camera)
        : camera_(camera), lights_(camera, panel), shadows_(make_shadows(panel)) {
        for (const PosedMesh& solid : panel.solids) add_solid(solid);
        for (const StrandLayer& layer : panel.layers) add_layer(layer);
    }

    Image draw() const;

  private:
    Shadows make_shadows(const Panel& panel) const;
    void add_solid(const PosedMesh& solid);
    void add_triangle(const Triangle& t);
    void add_layer(const StrandLayer& layer);
    HairMaterial material(const StrandLayer& layer, int s, float along) const;
    Vec3f shade_strand(const HairMaterial& m, const Vec3f& x, const Vec3f& tangent) const;
    Vec3f shade_solid(const Vec3f& x, Vec3f n) const;
    Vec3f background(float column, float row) const;
    Vec3f seen(const Vec3f& x) const {
        Vec3f p = camera_.project(x);
        return {fine * p.x, fine * p.y, p.z};
    }

    using TileLists = std::vector<std::vector<uint32_t>>;
    template <class BoxOf>
    TileLists in_tiles(size_t count, BoxOf box) const;
    void draw_tile(int tile, const std::vector<uint32_t>& triangles, std::vector<uint32_t>& segments,
                   Image& image) const;

    int tiles_across() const { return (camera_.width * fine + tile_edge - 1) / tile_edge; }
    int tiles_down() const { return (camera_.height * fine + tile_edge - 1) / tile_edge; }

    const Camera& camera_;
    Lights lights_;
    Shadows shadows_;
    std::vector<Triangle> triangles_;
    std::vector<StrandVertex> vertices_;
    std::vector<uint32_t> segments_;  // first vertex of each; the second follows it
};

int pieces_of(const Strands& strands, const Camera& camera) {
    // Pieces of about three subpixels, judged by the mean segment at the mean distance.
    double length = 0, depth = 0;
    long n = 0;
    for (int s = 0; s < strands.count; s += std::max(1, strands.count / 64))
        for (int i = 0; i + 1 < strands.particles; ++i, ++n) {
            length += norm(strands.at(s, i + 1) - strands.at(s, i));
            depth += camera.project(strands.at(s, i)).z;
        }
    const double subpixels = n && depth > 0 ? fine * camera.focal * length / depth : 1;
    return std::clamp(int(std::lround(subpixels / 3)), 1, 12);
}

Shadows PanelScene::make_shadows(const Panel& panel) const {
    Extent around;
    for (const StrandLayer& layer : panel.layers) around.add(*layer.strands);
    for (const PosedMesh& solid : panel.solids) around.add(solid);
    std::vector<Vec3f> corners = around.outermost();
    if (corners.empty())
        for (const PosedMesh& solid : panel.solids)
            for (const Vec3f& v : world_vertices(solid)) corners.push_back(v);
    if (corners.empty()) corners.push_back({0, 0, 0});
    const float cell = std::max(diagonal_of(corners) / 128, 1e-5f);
    Shadows shadows(corners, lights_, camera_, cell);

    struct Blocker {
        Vec3f at;
        float area;  // [m^2]
    };
    std::vector<Blocker> hair, surface;
    Curve curve;
    for (const StrandLayer& layer : panel.layers) {
        const Strands& strands = *layer.strands;
        const float width = drawn_width(strands.count);
        for (int s = 0; s < strands.count && strands.particles > 1; ++s) {
            const Vec3f* p = strands.strand(s);
            const int pieces = std::clamp(int(std::ceil(norm(p[1] - p[0]) / cell)), 1, 8);
            subdivide(p, strands.particles, pieces, curve);
            for (size_t i = 0; i + 1 < curve.points.size(); ++i) {
                const Vec3f step = curve.points[i + 1] - curve.points[i];
                hair.push_back({curve.points[i] + 0.5f * step, width * norm(step)});
            }
        }
    }
    for (const PosedMesh& solid : panel.solids) {
        const std::vector<Vec3f> v = world_vertices(solid);
        if (diagonal_of(v) > diagonal_of(corners) * 1.01f) continue;
        for (const auto& t : solid.mesh.triangles) {
            const Vec3f e = v[t[1]] - v[t[0]], f = v[t[2]] - v[t[0]];
            const int steps = std::max(1, int(std::ceil(2 * std::max(norm(e), norm(f)) / cell)));
            const float share = 0.5f * norm(cross(e, f)) / (0.5f * steps * (steps + 1));
            for (int i = 0; i < steps; ++i)
                for (int j = 0; i + j < steps; ++j)
                    surface.push_back(
                        {v[t[0]] + ((i + 0.33f) / steps) * e + ((j + 0.33f) / steps) * f, share});
        }
    }
    struct Filling {
        Opacity* opacity;
        const std::vector<Blocker>& blockers;
        float share;  // of their area that counts
        bool wide;
    };
    const Filling fillings[] = {
        {&shadows.key, hair, 0.8f, false},       {&shadows.rim, hair, 0.8f, false},
        {&shadows.sky, hair, 0.5f, true},        {&shadows.front, hair, 0.5f, true},
        {&shadows.solid_key, surface, 8, false}, {&shadows.solid_rim, surface, 8, false}};
#pragma omp parallel for schedule(dynamic, 1)
    for (const Filling& f : fillings) {
        for (const Blocker& b : f.blockers) f.opacity->deposit(b.at, f.share * b.area);
        f.opacity->accumulate(f.wide);
        if (&f.blockers == &surface) f.opacity->soften();
    }
    return shadows;
}

void PanelScene::add_solid(const PosedMesh& solid) {
    const std::vector<Vec3f> v = world_vertices(solid);
    std::vector<Vec3f> normal(v.size(), Vec3f{0, 0, 0});
    for (const auto& t : solid.mesh.triangles) {
        const Vec3f area = cross(v[t[1]] - v[t[0]], v[t[2]] - v[t[0]]);
        for (int k : t) normal[k] += area;
    }
    for (const auto& t : solid.mesh.triangles) {
        const Vec3f flat = normalized(cross(v[t[1]] - v[t[0]], v[t[2]] - v[t[0]]), Vec3f{0, 1, 0});
        Triangle triangle;
        for (int k = 0; k < 3; ++k) {
            const Vec3f smooth = normalized(normal[t[k]], flat);
            triangle.world[k] = v[t[k]];
            // An edge sharper than 60 degrees stays an edge.
            triangle.normal[k] = dot(smooth, flat) > 0.5f ? smooth : flat;
        }
        add_triangle(triangle);
    }
}

// Keeps what lies in front of the eye, cut at the nearest plane.
void PanelScene::add_triangle(const Triangle& t) {
    std::vector<std::pair<Vec3f, Vec3f>> corners;
    auto in_front = [&](int k) { return -dot(t.world[k] - camera_.eye, camera_.back) - nearest; };
    for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3;
        const float a = in_front(k), b = in_front(l);
        if (a > 0) corners.push_back({t.world[k], t.normal[k]});
        if ((a > 0) != (b > 0))
            corners.push_back(
                {lerp(t.world[k], t.world[l], a / (a - b)), lerp(t.normal[k], t.normal[l], a / (a - b))});
    }
    for (size_t k = 2; k < corners.size(); ++k) {
        Triangle part;
        const size_t pick[3] = {0, k - 1, k};
        for (int c = 0; c < 3; ++c) {
            part.world[c] = corners[pick[c]].first;
            part.normal[c] = corners[pick[c]].second;
            part.seen[c] = seen(part.world[c]);
        }
        triangles_.push_back(part);
    }
}

HairMaterial PanelScene::material(const StrandLayer& layer, int s, float along) const {
    // Of (strand, particle) numbers; 0 where there are none.
    auto between = [&](const std::vector<float>* numbers) {
        if (!numbers || numbers->empty()) return 0.f;
        const float* row = numbers->data() + size_t(s) * layer.strands->particles;
        const int i = std::min(int(along), layer.strands->particles - 2);
        return std::clamp(row[i] + (along - i) * (row[i + 1] - row[i]), 0.f, 1.f);
    };
    if (layer.shown) return {linear_of_srgb(rainbow_color(between(layer.shown))), 0};
    const float wet = between(layer.saturation);
    // Strands differ by a sixth in brightness and a little in warmth.
    const float bright = 0.84f + 0.32f * unit_random(2 * s), warm = 0.04f * (unit_random(2 * s + 1) - 0.5f);
    const Vec3f dry = times(bright * linear_of_srgb(layer.color), {1 + warm, 1, 1 - warm});
    // Water in the hair and around it takes light away: the colour deepens (Lekner and Dorf 1988).
    return {(1 - 0.45f * wet) * power(dry, 1 + 0.12f * wet), wet};
}

Vec3f PanelScene::shade_strand(const HairMaterial& m, const Vec3f& x, const Vec3f& tangent) const {
    const Vec3f view = normalized(camera_.eye - x, camera_.back);
    const Received r = light_at(shadows_, lights_, x, x);
    // Light that comes through other hairs takes their colour.
    auto tinted = [&](float through) {
        return through * lerp(m.color + Vec3f{0.25f, 0.25f, 0.25f}, {1, 1, 1}, through);
    };
    const Vec3f key = times(tinted(r.key), lights_.key.color), rim = times(tinted(r.rim), lights_.rim.color);
    const Vec3f around = r.sky * lights_.sky_color + r.front * lights_.front_color;
    const float sin_t = dot(tangent, view);
    const float facing = 0.35f + 0.65f * std::sqrt(std::max(0.f, 1 - sin_t * sin_t));
    return times(key, hair_reflection(m, tangent, lights_.key.direction, view)) +
           times(rim, hair_reflection(m, tangent, lights_.rim.direction, view)) +
           0.55f * facing * times(around, m.color);
}

Vec3f PanelScene::shade_solid(const Vec3f& x, Vec3f n) const {
    const Vec3f view = normalized(camera_.eye - x, camera_.back);
    if (dot(n, view) < 0) n = -n;  // open meshes are seen from within too
    const Vec3f lifted = x + 1.5f * shadows_.key.cell() * n;
    const Received r = light_at(shadows_, lights_, x, lifted);
    const Vec3f around = r.sky * (0.5f + 0.5f * n.y) * lights_.sky_color + r.front * lights_.front_color;
    return r.key * times(lights_.key.color, solid_reflection(skin, n, lights_.key.direction, view)) +
           r.rim * times(lights_.rim.color, solid_reflection(skin, n, lights_.rim.direction, view)) +
           0.45f * times(around, skin);
}

void PanelScene::add_layer(const StrandLayer& layer) {
    const Strands& strands = *layer.strands;
    const int n = strands.particles;
    if (n < 2 || strands.count == 0) return;
    if (layer.saturation && !layer.saturation->empty() && layer.saturation->size() != strands.points.size())
        throw Error("saturation has " + std::to_string(layer.saturation->size()) + " values for " +
                    std::to_string(strands.points.size()) + " particles");
    const int pieces = pieces_of(strands, camera_), points = (n - 1) * pieces + 1;
    const float width = drawn_width(strands.count);
    const size_t first = vertices_.size();
    vertices_.resize(first + size_t(strands.count) * points);
#pragma omp parallel
    {
        Curve curve;
#pragma omp for schedule(dynamic, 16)
        for (int s = 0; s < strands.count; ++s) {
            subdivide(strands.strand(s), n, pieces, curve);
            StrandVertex* out = vertices_.data() + first + size_t(s) * points;
            Vec3f tangent{0, -1, 0};
            for (int i = 0; i < points; ++i) {
                const Vec3f& x = curve.points[i];
                tangent = normalized(
                    curve.points[std::min(i + 1, points - 1)] - curve.points[std::max(i - 1, 0)], tangent);
                const Vec3f at = seen(x);
                const float taper = std::clamp(5 * (1 - curve.along[i] / (n - 1)), 0.f, 1.f);
                const float half =
                    0.5f * width * (0.45f + 0.55f * taper) * camera_.focal * fine / std::max(at.z, nearest);
                // Thinner than a subpixel: a subpixel wide and so much fainter.
                out[i] = {at.x,
                          at.y,
                          at.z,
                          std::max(half, 0.5f),
                          0.96f * std::min(1.f, half / 0.5f),
                          shade_strand(material(layer, s, curve.along[i]), x, tangent)};
            }
        }
    }
    for (int s = 0; s < strands.count; ++s)
        for (int i = 0; i + 1 < points; ++i) {
            const size_t v = first + size_t(s) * points + i;
            if (vertices_[v].depth > nearest && vertices_[v + 1].depth > nearest)
                segments_.push_back(uint32_t(v));
        }
}

// ---------------------------------------------------------------- tiles

struct TileBox {
    float left, top, right, bottom;  // subpixels
};

// For each tile the numbers of the things whose box touches it, in order.
template <class BoxOf>
PanelScene::TileLists PanelScene::in_tiles(size_t count, BoxOf box) const {
    const int across = tiles_across(), down = tiles_down();
    TileLists lists(size_t(across) * down);
    auto tile = [](float x, int last) {
        return int(std::clamp(std::floor(x / tile_edge), -1.f, float(last + 1)));
    };
    for (size_t i = 0; i < count; ++i) {
        const TileBox b = box(i);
        for (int r = std::max(0, tile(b.top, down - 1)); r <= std::min(down - 1, tile(b.bottom, down - 1));
             ++r)
            for (int c = std::max(0, tile(b.left, across - 1));
                 c <= std::min(across - 1, tile(b.right, across - 1)); ++c)
                lists[size_t(r) * across + c].push_back(uint32_t(i));
    }
    return lists;
}

Image PanelScene::draw() const {
    const TileLists triangles = in_tiles(triangles_.size(), [&](size_t i) {
        const auto& p = triangles_[i].seen;
        return TileBox{std::min({p[0].x, p[1].x, p[2].x}), std::min({p[0].y, p[1].y, p[2].y}),
                       std::max({p[0].x, p[1].x, p[2].x}), std::max({p[0].y, p[1].y, p[2].y})};
    });
    TileLists segments = in_tiles(segments_.size(), [&](size_t i) {
        const StrandVertex &a = vertices_[segments_[i]], &b = vertices_[segments_[i] + 1];
        const float w = std::max(a.half_width, b.half_width) + 1;
        return TileBox{std::min(a.column, b.column) - w, std::min(a.row, b.row) - w,
                       std::max(a.column, b.column) + w, std::max(a.row, b.row) + w};
    });
    Image image(camera_.width, camera_.height);
#pragma omp parallel for schedule(dynamic, 1)
    for (int tile = 0; tile < int(triangles.size()); ++tile)
        draw_tile(tile, triangles[tile], segments[tile], image);
    return image;
}

Vec3f PanelScene::background(float column, float row) const {
    const float x = column / camera_.width - 0.5f, y = row / camera_.height - 0.42f;
    const float fall = std::min(1.f, 1.5f * (x * x + y * y));
    return lerp(bright_back, dim_back, fall);
}

// The subpixels of one tile.
struct Canvas {
    static constexpr int size = tile_edge * tile_edge;
    int left, top;
    std::array<float, size> depth;
    std::array<Vec3f, size> color;
    std::array<int, size> triangle;       // in front, or -1
    std::array<float, 2 * size> weights;  // of its corners 1 and 2, in space

    static int at(int column, int row) { return row * tile_edge + column; }
};

// The range of subpixel centres within [low, high], inside a tile that starts at `start`.
std::pair<int, int> covered(float low, float high, int start) {
    return {int(std::clamp(std::ceil(low - 0.5f - start), 0.f, float(tile_edge))),
            int(std::clamp(std::floor(high - 0.5f - start), -1.f, float(tile_edge - 1)))};
}

void draw_triangle(const Triangle& t, int number, Canvas& canvas) {
    const auto& p = t.seen;
    const float area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y);
    if (area == 0) return;
    const auto [c0, c1] =
        covered(std::min({p[0].x, p[1].x, p[2].x}), std::max({p[0].x, p[1].x, p[2].x}), canvas.left);
    const auto [r0, r1] =
        covered(std::min({p[0].y, p[1].y, p[2].y}), std::max({p[0].y, p[1].y, p[2].y}), canvas.top);
    for (int r = r0; r <= r1; ++r)
        for (int c = c0; c <= c1; ++c) {
            const float x = canvas.left + c + 0.5f, y = canvas.top + r + 0.5f;
            const float w1 = ((x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (y - p[0].y)) / area;
            const float w2 = ((p[1].x - p[0].x) * (y - p[0].y) - (x - p[0].x) * (p[1].y - p[0].y)) / area;
            if (w1 < 0 || w2 < 0 || w1 + w2 > 1) continue;
            const float inverse = (1 - w1 - w2) / p[0].z + w1 / p[1].z + w2 / p[2].z;
            const int k = Canvas::at(c, r);
            if (1 / inverse >= canvas.depth[k]) continue;
            canvas.depth[k] = 1 / inverse;
            canvas.triangle[k] = number;
            canvas.weights[2 * k] = w1 / p[1].z / inverse;
            canvas.weights[2 * k + 1] = w2 / p[2].z / inverse;
        }
}

// Blends one piece of a strand over what lies behind it. Its ends are cut square, so that neighbouring
// pieces cover each subpixel once.
void draw_segment(const StrandVertex& a, const StrandVertex& b, Canvas& canvas) {
    const float dx = b.column - a.column, dy = b.row - a.row, length2 = std::max(dx * dx + dy * dy, 1e-8f);
    const float reach = std::max(a.half_width, b.half_width) + 0.5f, inverse_length = 1 / std::sqrt(length2);
    const auto [c0, c1] =
        covered(std::min(a.column, b.column) - reach, std::max(a.column, b.column) + reach, canvas.left);
    const auto [r0, r1] = covered(std::min(a.row, b.row) - reach, std::max(a.row, b.row) + reach, canvas.top);
    for (int r = r0; r <= r1; ++r)
        for (int c = c0; c <= c1; ++c) {
            const float x = canvas.left + c + 0.5f - a.column, y = canvas.top + r + 0.5f - a.row;
            const float t = (x * dx + y * dy) / length2;
            if (t < 0 || t >= 1) continue;
            const float half = a.half_width + t * (b.half_width - a.half_width);
            const float aside = std::fabs(x * dy - y * dx) * inverse_length;
            const float cover =
                std::min(1.f, half + 0.5f - aside) * (a.opacity + t * (b.opacity - a.opacity));
            const int k = Canvas::at(c, r);
            if (cover <= 0 || a.depth + t * (b.depth - a.depth) - lying >= canvas.depth[k]) continue;
            // A strand is round: it darkens towards its sides.
            const float side = std::min(1.f, aside / half);
            canvas.color[k] =
                lerp(canvas.color[k], (1.06f - 0.35f * side * side) * lerp(a.color, b.color, t), cover);
        }
}

void PanelScene::draw_tile(int tile, const std::vector<uint32_t>& triangles, std::vector<uint32_t>& segments,
                           Image& image) const {
    Canvas canvas;
    canvas.left = tile % tiles_across() * tile_edge;
    canvas.top = tile / tiles_across() * tile_edge;
    canvas.depth.fill(1e30f);
    canvas.triangle.fill(-1);
    for (uint32_t t : triangles) draw_triangle(triangles_[t], int(t), canvas);
    for (int r = 0; r < tile_edge; ++r)
        for (int c = 0; c < tile_edge; ++c) {
            const int k = Canvas::at(c, r);
            if (canvas.triangle[k] < 0) {
                canvas.color[k] = background((canvas.left + c + 0.5f) / fine, (canvas.top + r + 0.5f) / fine);
                continue;
            }
            const Triangle& t = triangles_[canvas.triangle[k]];
            const float w1 = canvas.weights[2 * k], w2 = canvas.weights[2 * k + 1], w0 = 1 - w1 - w2;
            canvas.color[k] =
                shade_solid(w0 * t.world[0] + w1 * t.world[1] + w2 * t.world[2],
                            normalized(w0 * t.normal[0] + w1 * t.normal[1] + w2 * t.normal[2], camera_.back));
        }

    auto depth = [&](uint32_t s) {
        return vertices_[segments_[s]].depth + vertices_[segments_[s] + 1].depth;
    };
    std::stable_sort(segments.begin(), segments.end(),
                     [&](uint32_t a, uint32_t b) { return depth(a) > depth(b); });
    for (uint32_t s : segments) draw_segment(vertices_[segments_[s]], vertices_[segments_[s] + 1], canvas);

    for (int r = 0; r < tile_edge / fine; ++r)
        for (int c = 0; c < tile_edge / fine; ++c) {
            const int column = canvas.left / fine + c, row = canvas.top / fine + r;
            if (column >= image.width || row >= image.height) continue;
            Vec3f sum{0, 0, 0};
            for (int k = 0; k < fine * fine; ++k)
                sum += canvas.color[Canvas::at(fine * c + k % fine, fine * r + k / fine)];
            sum = (1.f / (fine * fine)) * sum;
            float* out = image.pixel(column, row);
            out[0] = srgb_of_linear(sum.x), out[1] = srgb_of_linear(sum.y), out[2] = srgb_of_linear(sum.z);
        }
}

}  // namespace

Image draw_panel(const Panel& panel, const Camera& camera) { return PanelScene(panel, camera).draw(); }

Image side_by_side(const std::vector<Image>& images) {
    int width = 0;
    for (const Image& i : images) width += i.width;
    Image all(width, images.empty() ? 0 : images[0].height);
    for (int row = 0; row < all.height; ++row) {
        float* out = all.pixel(0, row);
        for (const Image& i : images) out = std::copy_n(i.pixel(0, row), size_t(i.width) * 3, out);
    }
    return all;
}

}  // namespace wetcurl

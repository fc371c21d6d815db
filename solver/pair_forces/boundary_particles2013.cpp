// Sampling of surfaces, and adhesion to the samples.
#include "solver/compared/boundary_particles2013.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <unordered_map>

#include "base/error.h"
#include "base/geometry/neighbor_grid.h"
#include "solver/pair_forces/pair_forces.h"

namespace wetcurl {

std::vector<Vec3f> sampled_surface(const Shape& shape, double spacing) {
    const Mesh mesh = triangulated(shape);
    struct Corners {
        Vec3d a, ab, ac;
    };
    std::vector<Corners> triangles;
    std::vector<double> area;
    double sum = 0;
    for (const auto& t : mesh.triangles) {
        const Vec3d a = cast<double>(mesh.vertices[size_t(t[0])]);
        const Vec3d ab = cast<double>(mesh.vertices[size_t(t[1])]) - a,
                    ac = cast<double>(mesh.vertices[size_t(t[2])]) - a;
        triangles.push_back({a, ab, ac});
        sum += area.emplace_back(norm(cross(ab, ac)) / 2);
    }
    // Twenty darts for each square of the spacing leave no hole where another would fit.
    const double darts = 20 * sum / (spacing * spacing);
    if (!(darts < 2e8))
        throw Error("[baseline] boundary_spacing: more than ten million boundary particles; raise it");
    const double cell = 0.7 * spacing;
    const auto key = [](long i, long j, long k) {
        return (uint64_t(i) & 0x1fffff) << 42 | (uint64_t(j) & 0x1fffff) << 21 | (uint64_t(k) & 0x1fffff);
    };
    std::vector<Vec3f> kept;
    std::unordered_map<uint64_t, std::vector<uint32_t>> cells;
    std::mt19937_64 random(1);
    const auto number = [&] { return double(random() >> 11) * 0x1p-53; };
    double due = 0;
    for (size_t t = 0; t < triangles.size(); ++t)
        for (due += darts * area[t] / sum; due >= 1; --due) {
            double u = number(), v = number();
            if (u + v > 1) u = 1 - u, v = 1 - v;
            const Vec3d p = triangles[t].a + u * triangles[t].ab + v * triangles[t].ac;
            const long i = long(std::floor(p.x / cell)), j = long(std::floor(p.y / cell)),
                       k = long(std::floor(p.z / cell));
            bool free = true;
            for (int n = 0; n < 27 && free; ++n) {
                const auto found = cells.find(key(i + n % 3 - 1, j + n / 3 % 3 - 1, k + n / 9 - 1));
                if (found == cells.end()) continue;
                for (uint32_t other : found->second)
                    free = free && norm(cast<double>(kept[other]) - p) >= cell;
            }
            if (!free) continue;
            cells[key(i, j, k)].push_back(uint32_t(kept.size()));
            kept.push_back(cast<float>(p));
        }
    return kept;
}

std::vector<double> boundary_volumes(const std::vector<Vec3f>& points, double h) {
    NeighborGrid grid;
    grid.build(points.data(), points.size(), float(h));
    std::vector<double> volume(points.size());
#pragma omp parallel for schedule(static)
    for (size_t k = 0; k < points.size(); ++k) {
        double sum = 0;
        grid.around(points[k],
                    [&](uint32_t l) { sum += kernel(double(norm(grid.sorted(l) - points[k])), h); });
        volume[k] = 1 / sum;
    }
    return volume;
}

namespace {

// A solid's boundary particles, in its own coordinates: their grid is built once.
struct SampledSolid {
    const Solid* solid;
    NeighborGrid grid;
    std::vector<double> volume;  // in the grid's order [m^3]
};

class BoundaryForces final : public PairForces {
  public:
    BoundaryForces(const BoundaryParticles2013& method, const Scene& scene)
        : method_(method),
          scene_(scene),
          mass_(particle_masses(scene)),
          adhesion_(akinci2013::adhesion_kernel, method.h) {
        for (const auto& solid : scene.solids) {
            const auto points = sampled_surface(solid.shape, method.spacing);
            const auto volume = boundary_volumes(points, method.h);
            auto& s = solids_.emplace_back();
            s.solid = &solid;
            s.grid.build(points.data(), points.size(), float(method.h));
            for (uint32_t k : s.grid.order()) s.volume.push_back(volume[k]);
        }
    }

    void evaluate(const std::vector<Vec3d>& x, double time, std::vector<Vec3d>& force) override {
        force.assign(x.size(), {0, 0, 0});
        pairs_.assign(x.size(), 0);
        for_each(x, time,
                 [&](size_t i, double wet_mass, const Vec3d& d, const Quatd& rotation, double volume) {
                     force[i] += rotate(rotation, method_.pair_force(d, wet_mass, volume));
                     ++pairs_[i];
                 });
        mean_ = double(std::accumulate(pairs_.begin(), pairs_.end(), size_t(0))) / double(x.size());
    }
    double potential(const std::vector<Vec3d>& x, double time) override {
        std::vector<double> of(x.size(), 0);
        for_each(x, time, [&](size_t i, double wet_mass, const Vec3d& d, const Quatd&, double volume) {
            of[i] -= method_.strength(wet_mass, volume) * adhesion_(norm(d));
        });
        return std::accumulate(of.begin(), of.end(), 0.0);
    }
    double given(const std::vector<Vec3d>& x, double from, double to) override {
        return potential(x, to) - potential(x, from);
    }
    double neighbours_mean() const override { return mean_; }
    size_t bytes() const override {
        size_t sum =
            mass_.capacity() * sizeof(double) + adhesion_.bytes() + pairs_.capacity() * sizeof(uint32_t);
        for (const auto& s : solids_) sum += s.grid.bytes() + s.volume.capacity() * sizeof(double);
        return sum;
    }

  private:
    // Calls visit(i, sigma m [kg], x_i - y [m], rotation, volume [m^3]) with the boundary particles y in
    // reach of each wet particle, in the coordinates of their solid: all of an i by one thread.
    template <class Visit>
    void for_each(const std::vector<Vec3d>& x, double time, Visit visit) const {
        const Pose head = scene_.head_at(time);
        for (const auto& s : solids_) {
            const Pose pose = s.solid->at(time, head);
#pragma omp parallel for schedule(dynamic, 256)
            for (size_t i = 0; i < x.size(); ++i) {
                const double wet_mass = double(scene_.saturation[i]) * mass_[i];
                if (!(wet_mass > 0)) continue;
                const Vec3d at = pose.inverse(x[i]);
                s.grid.around(cast<float>(at), [&](uint32_t k) {
                    const Vec3d d = at - cast<double>(s.grid.sorted(k));
                    if (method_.reaches(d)) visit(i, wet_mass, d, pose.rotation, s.volume[k]);
                });
            }
        }
    }

    const BoundaryParticles2013 method_;
    const Scene& scene_;
    const std::vector<double> mass_;
    std::vector<SampledSolid> solids_;
    const akinci2013::KernelSum adhesion_;
    std::vector<uint32_t> pairs_;  // (particle) in the last evaluation
    double mean_ = 0;
};

}  // namespace

std::unique_ptr<PairForces> BoundaryParticles2013::forces(const Scene& scene) const {
    return std::make_unique<BoundaryForces>(*this, scene);
}

}  // namespace wetcurl

// Forces on all particles at once, taken once a substep: of a compared method, or of cohesion inside the
// solve.
#pragma once

#include <memory>
#include <numeric>
#include <vector>

#include "base/geometry/neighbor_list.h"
#include "solver/scene/scene.h"

namespace wetcurl {

class PairForces {
  public:
    virtual ~PairForces() = default;
    virtual const char* name() const { return "baseline"; }
    // x (strand, particle) [m] at `time` [s], when a substep begins -> force (strand, particle) [N].
    virtual void evaluate(const std::vector<Vec3d>& x, double time, std::vector<Vec3d>& force) = 0;
    // (strand, particle) [N/m] that outweigh the slopes of those forces taken together, so that an implicit
    // step may take them anywhere, and takes them where it expects to end; null: explicit forces.
    virtual const std::vector<double>* stiffness() const { return nullptr; }
    // [J] of those forces that have a potential, particles at x.
    virtual double potential(const std::vector<Vec3d>& x, double time) = 0;
    // [J] that solids give while they move and hair at x does not.
    virtual double given(const std::vector<Vec3d>&, double /*from*/, double /*to*/) { return 0; }
    virtual double neighbours_mean() const = 0;  // of the last call
    virtual size_t bytes() const = 0;
};

// m (strand, particle) [kg], water included.
std::vector<double> particle_masses(const Scene& scene);

// Pairs of wet particles on different strands, found anew each substep.
class NeighbourPairs {
  public:
    NeighbourPairs(const Scene& scene, double radius);
    void find(const std::vector<Vec3d>& x);

    // Calls visit(i, j), j within the radius on another strand, both wet: all j of an i by one thread.
    template <class Visit>
    void for_each(Visit visit) const {
        for_each([](size_t) {}, visit);
    }
    // The same, with begin(i) before them for every wet i.
    template <class Begin, class Visit>
    void for_each(Begin begin, Visit visit) const {
        const long count = long(grid_.size());
#pragma omp parallel for schedule(dynamic, 256)
        for (long k = 0; k < count; ++k) {
            if (!(wet_[size_t(k)] > 0)) continue;
            const size_t i = grid_.order()[size_t(k)];
            begin(i);
            list_.visit_neighbours(size_t(k), [&](size_t other) {
                if (wet_[other] > 0) visit(i, size_t(grid_.order()[other]));
            });
        }
    }
    // The sum of value(i, j) over pairs, each counted once.
    template <class Value>
    double sum(Value value) const {
        std::vector<double> of(grid_.size(), 0);
        for_each([&](size_t i, size_t j) { of[i] += 0.5 * value(i, j); });
        return std::accumulate(of.begin(), of.end(), 0.0);
    }
    double saturation(size_t i) const { return double(saturation_[i]); }
    double neighbours_mean() const { return list_.neighbours_mean(); }
    size_t bytes() const;

  private:
    const std::vector<float>& saturation_;
    const int particles_;
    const float radius_;
    NeighborGrid grid_;
    NeighborList list_;
    std::vector<Vec3f> near_;  // x in the precision of the search
    // In the grid's order, a vector longer than there are points.
    std::vector<float> wet_;
};

}  // namespace wetcurl

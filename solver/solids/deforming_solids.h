// The level sets of a scene's deforming solids, rebuilt once a frame: a block of strands goes through all
// substeps of a frame at once, and between the frame's ends phi is linear in time.
#pragma once

#include <deque>
#include <vector>

#include "base/buffer_list.h"
#include "base/geometry/moving_level_set.h"
#include "solver/scene/scene.h"

namespace wetcurl {

// What a solid's level set is of: as MovingLevelSet's arguments, in its own frame (Scene::surface_frame).
struct DeformingSurface {
    Mesh mesh;
    Bounds box;
    double spacing, band;
};
// Of a solid that deforms, where its run begins.
DeformingSurface surface_of(const Scene& scene, const Solid& solid);

// MovingSurface: a MovingLevelSet, or what a device has in its place.
template <class MovingSurface>
class DeformingSolidsOf {
  public:
    // At rest as where the run begins. The scene must outlive it.
    template <class... OfSurface>
    explicit DeformingSolidsOf(const Scene& scene, const OfSurface&... of_surface) : scene_(scene) {
        for (const auto& solid : scene.solids) {
            if (!solid.deformation) continue;
            solids_.push_back(&solid);
            const DeformingSurface s = surface_of(scene, solid);
            level_sets_.emplace_back(s.mesh, s.box, s.spacing, s.band, of_surface...);
        }
        lay_views(1);
    }
    // All is held as it is at `time` [s].
    void hold(double time) {
        for (size_t k = 0; k < solids_.size(); ++k) level_sets_[k].hold(vertices_at(k, time));
        lay_views(1);
    }
    // As hair is bound to those that carry roots; the others as at time 0.
    void hold_at_rest() {
        for (size_t k = 0; k < solids_.size(); ++k)
            level_sets_[k].hold(solids_[k]->carries_roots ? solids_[k]->deformation->rest().vertices
                                                          : vertices_at(k, 0));
        lay_views(1);
    }
    // Rebuilds them for a span [s] of so many substeps, from `begin` [s] on; `hair` is not read. A solid that
    // is cut to elsewhere within it is there from the begin on, and rests.
    template <class H>
    void advance(const H&, double begin, double span, int substeps) {
        const StageTimer timer(seconds);
        for (size_t k = 0; k < solids_.size(); ++k) {
            const std::vector<Vec3f>& vertices = vertices_at(k, begin + span);
            if (solids_[k]->cuts.within(begin + span)) level_sets_[k].hold(vertices);
            level_sets_[k].advance(vertices, span);
        }
        lay_views(substeps);
    }
    void finish() {}  // once the frame is shown
    // A view of each deforming solid in the scene's order, where `substeps` of the span are done. Valid until
    // the next hold or advance.
    const MovingGrid* after(int substeps) const { return &views_[size_t(substeps) * level_sets_.size()]; }
    // The same at the span's end.
    const MovingGrid* at_end() const { return &views_[views_.size() - level_sets_.size()]; }

    const std::deque<MovingSurface>& level_sets() const { return level_sets_; }
    void list(BufferList& buffers) const {
        size_t sum = 0;
        for (const auto& level_set : level_sets_) sum += level_set.bytes();
        buffers.push_back({"level sets of deforming solids", sum});
    }
    double seconds = 0;  // in the frame at hand

  private:
    // Valid until the next call.
    const std::vector<Vec3f>& vertices_at(size_t k, double time) {
        scene_.surface_vertices(*solids_[k], time, vertices_);
        return vertices_;
    }
    void lay_views(int substeps) {
        views_.clear();
        for (int done = 0; done <= substeps; ++done)
            for (const auto& level_set : level_sets_)
                views_.push_back(level_set.grid(double(done) / substeps));
    }
    const Scene& scene_;
    std::vector<const Solid*> solids_;      // those that deform
    std::deque<MovingSurface> level_sets_;  // they stay where they are made
    std::vector<MovingGrid> views_;         // (substep and one, solid)
    std::vector<Vec3f> vertices_;
};

using DeformingSolids = DeformingSolidsOf<MovingLevelSet>;

}  // namespace wetcurl

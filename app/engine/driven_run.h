// A simulation that a caller drives frame by frame: where things are, for how long, and how wet.
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/engine/scene_run.h"

namespace wetcurl {

// What is moved is there at the end of the next frame, on a way that is C1 and known from what came before.
// From its first move on a thing is the caller's and stands still in frames in which it is not moved; until
// then it goes as the scene says.
class DrivenRun {
  public:
    struct Given {
        bool strands = false;  // the scene's are the caller's, who numbers them
        bool roots = false;    // the caller drives each root
    };
    // Arguments as SceneRun's. Throws Error too where the scene has cuts, which are the caller's, or roots
    // that are driven ride on a solid or have a preroll.
    DrivenRun(Scene scene, const Given& given, const std::string& device, const std::string& precision,
              int threads);

    int strands() const { return scene().groom.rest.count; }
    int particles() const { return scene().groom.rest.particles; }
    double time() const { return run_.simulation().time(); }  // [s]

    // From rest. Throws Error where roots do not go with the head.
    void move_head(const Pose& pose);
    // Throws Error where there is no such solid, or it goes with the head.
    void move_solid(const std::string& name, const Pose& pose);
    // Throws Error where the caller brought no such mesh.
    size_t vertices(const std::string& name) const;
    // (vertex) [m] in the frame of the solid. Throws Error likewise, and for another number of vertices.
    void move_mesh(const std::string& name, std::vector<Vec3f> vertices);
    // (strand) each from rest. Throws Error where roots are not driven.
    void move_roots(const std::vector<Pose>& poses);
    // (strand, particle) from now on, 0 to 1. Throws Error without [wetness.flow].
    void wet(const float* saturation);

    // A frame of so many seconds, up to `longest_frame`; 0: none. Throws Diverged.
    void advance(double seconds);
    static constexpr double longest_frame = 1;  // [s]
    // What was moved is there at once; the hair begins anew.
    void cut();

    // (strand, particle) as of the frame that is over.
    void positions(Vec3f* to) const { give(frame_.positions.points, to); }          // [m]
    void displayed(Vec3f* to) const { give(frame_.seen().points, to); }             // [m]
    void velocities(Vec3f* to) const { give(run_.simulation().velocities(), to); }  // [m/s]
    void saturation(float* to) const;                                               // 0 of a dry scene

  private:
    // For the frame that follows.
    struct Moves {
        std::optional<Pose> head;
        std::map<size_t, Pose> solids;
        std::map<size_t, std::vector<Vec3f>> meshes;  // by solid
        std::vector<Pose> roots;                      // (strand)
    };
    const Scene& scene() const { return run_.scene(); }
    size_t solid_named(const std::string& name) const;
    // Calls go(what a caller drives, where it is to be) for all of it; both are a rigid motion's or a mesh's.
    template <class Go>
    void for_each_driven(Go go);
    void look();
    template <class Value>
    void give(const std::vector<Value>& values, Value* to) const {
        const size_t n = size_t(particles());
        for (size_t s = 0; s < place_.size(); ++s)
            std::copy_n(values.data() + s * n, n, to + size_t(place_[s]) * n);
    }

    SceneRun run_;
    std::vector<int> place_;  // (strand) of a strand in the caller's arrays
    bool head_is_driven_ = false;
    std::vector<bool> solid_is_driven_;  // (solid)
    Moves moves_;
    RunFrame frame_;
    FrameWatch watch_;
    int frames_ = 0;
};

}  // namespace wetcurl

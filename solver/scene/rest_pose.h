// The pose in which hair was made, where it is not that of a scene's first frame.
#pragma once

#include "base/exchange/scene_mesh.h"
#include "solver/motion/mesh_frames.h"
#include "solver/scene/read_solids.h"

namespace wetcurl {

// In units and axes of the file that is animated: there roots lie on the mesh. No mesh: that of the scene's
// frame 0.
struct RestPose {
    std::optional<Mesh> mesh;
    std::string name;
};

// A file of its own. `said`: by the file that is animated; where both say their unit or axis, the pose is
// brought to that one's. Throws Misuse, with file and line.
RestPose rest_of(const Table& t, const SolidTable& read, const FileAxes& said);
// The same, or a frame of the animated file, whose numbers are counted at `fps` a second. Between the samples
// of a scene file, which leaves out those that repeat the one before, and before the first one, if the shot
// begins there, the mesh holds still.
RestPose rest_of(const Table& t, const SolidTable& read, const MeshFrames& frames, double fps);

// Warn where a mesh of one sample stands still, and where the samples of a file that does not say its rate do
// not lie on frames of `fps`.
void warn_of_still_mesh(const SolidTable& read);
void warn_of_other_rate(const SolidTable& read, const MeshFrames& frames, double fps);

}  // namespace wetcurl

// USD text (.usda): the kind of USD file that needs no library. Written after the layout that Blender,
// Houdini, Unreal and Pixar's own library read; read as these programs and Maya write it.
#pragma once

#include <memory>
#include <string>

#include "base/exchange/scene_file.h"

namespace wetcurl {

// Reads curves (BasisCurves) and meshes (Mesh) with the transforms above them. Points stay in the file until
// points_of_curves or points_of_mesh reads them. Times are time codes divided by timeCodesPerSecond.
//
// - Points and transforms between two samples are interpolated, as USD does.
// - Widths become one a control point; ids, groups and uv of roots are those of primvars (groom_id, id;
//   groom_group_id; groom_root_uv, st, surface_uv_coordinate).
// - Curves of wrap "pinned" get the two control points that this word stands for.
// - Hidden objects are marked: invisible at all times, or of purpose guide or proxy, they or a prim above.
// - Faces of left-handed meshes, and of mirrored ones, are turned round.
// - Left out with a warning: closed curves, NurbsCurves, objects without points; what a skeleton would do.
// - Not followed: references, payloads, sublayers, variants. Without geometry of its own such a file is an
//   Error that names `usdcat --flatten`; otherwise a warning.
//
// The file's bytes decide, not its ending. Throws Error, with file and line, where it is missing, binary
// (.usdc, .usdz: the text names `usdcat`), cut short or malformed.
std::unique_ptr<SceneReader> open_usda(const std::string& path);

// Writes one prim for each object, at its path; characters that names in USD cannot have become '_'. A
// frame's number is its time code. Each attribute's samples stand together in the text, so frames are put
// aside in a file without a name beside the output, 12 bytes a point (24 with velocities), and become text in
// `finish`. `for_unreal` changes nothing: what Unreal looks for is always written.
//
// add_curves and add_mesh throw Error for arrays that do not fit together, strands of fewer than two points,
// and once a frame was given; append_curves and append_mesh for another number of points than the object has,
// for numbers that are not finite, and for velocities or wetness that some frames have and others lack;
// finish where objects have different numbers of frames, or none.
std::unique_ptr<SceneWriter> create_usda(const std::string& path, bool overwrite,
                                         const SceneFileSettings& settings);

}  // namespace wetcurl

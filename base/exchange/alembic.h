// Alembic files (.abc) behind the interfaces of scene_file.h: Ogawa (ogawa.h), Alembic's objects and
// properties in it, and AbcGeom's Xform, Curves and PolyMesh in these. The layout follows what files of
// Alembic 1.8 hold.
//
// Alembic lists the corners of a face clockwise, seen from outside; here they are turned round, so that
// MeshObject has them counterclockwise.
#pragma once

#include <memory>
#include <string>

#include "base/exchange/scene_file.h"

namespace wetcurl {

// Curves (linear, or cubic of one basis), PolyMesh and SubD of the file; hidden ones are marked. An object
// moves at its own samples and at those of the transforms above it: `times` holds both, and between samples
// points and transforms are interpolated linearly. A warning names curves that are left out: periodic ones,
// and those of variable order or of a basis that scene_file.h lacks. Throws Error.
std::unique_ptr<SceneReader> open_abc(const std::string& path);

// Each folder of an object's path becomes a Xform at rest. What stays the same over all frames, and equal
// arrays of any frames, are stored once. Throws Misuse and Error as OutputFile does, and Misuse for settings
// that Alembic cannot hold: `fps` that is not positive, a negative first frame.
std::unique_ptr<SceneWriter> create_abc(const std::string& path, bool overwrite,
                                        const SceneFileSettings& settings);

}  // namespace wetcurl

// Reading [[solid]].
#include "solver/scene/read_solids.h"

#include "base/geometry/bust.h"

namespace wetcurl {

namespace {

Shape level_set_of(const Table& t, const SolidTable& read) {
    const Mesh mesh = mesh_of(t, read.file, read.metres());
    try {
        return LevelSet::cached(mesh, read.spacing);
    } catch (const Error& e) {
        throw Error(t.where("file") + ": " + read.file + ": " + e.what());
    }
}

void read_mesh_solid(Solid& solid, const Table& t, const SolidTable& read) {
    solid.spacing = read.spacing;
    if (t.has("mesh")) {
        if (t.has("file"))
            t.fail("file",
                   "is the mesh of a solid that keeps its shape; [[solid.mesh]] are one's that deforms");
        solid.deformation = std::make_shared<const Deformation>(t, read.metres());
    } else if (!read.file.empty()) {
        solid.shape = level_set_of(t, read);
    } else {
        t.fail("shape",
               "'mesh' needs file = \"….obj\" or \"….ply\", or [[solid.mesh]] tables to deform between");
    }
}

Solid read_solid(const Table& t, size_t index) {
    SolidTable read;
    read_parameters(read, SolidTable::parameters, t);
    Solid solid;
    solid.name = t.has("name") ? read.name : "solid " + std::to_string(index);
    if (read.shape == "sphere") solid.shape = Sphere{read.radius};
    if (read.shape == "capsule") solid.shape = Capsule{read.half_length, read.radius};
    if (read.shape == "box") solid.shape = Box{read.half};
    if (read.shape == "plane") solid.shape = Plane{};
    if (read.shape == "head")
        solid.spacing = read.spacing, solid.shape = LevelSet::cached(bust_mesh(read.radius), read.spacing);
    if (read.shape == "mesh") read_mesh_solid(solid, t, read);
    solid.attached = read.attached;
    solid.friction = read.friction;
    if (solid.attached && t.has("motion"))
        t.fail("motion", "a solid that is attached to the head moves with it");
    if (!solid.attached) solid.motion = Motion(t.table("motion"));
    return solid;
}

}  // namespace

std::vector<Solid> read_solids(const Table& root) {
    std::vector<Solid> solids;
    for (const Table& t : root.tables("solid")) solids.push_back(read_solid(t, solids.size()));
    return solids;
}

}  // namespace wetcurl

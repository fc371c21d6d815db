// Reading [[solid]].
#include "solver/scene/read_solids.h"

#include <cmath>
#include <filesystem>

#include "base/geometry/bust.h"
#include "base/log.h"
#include "solver/grooms/guesses.h"

namespace wetcurl {

namespace {

std::string name_of(const Table& t, const SolidTable& read, size_t index) {
    return t.has("name") ? read.name : "solid " + std::to_string(index);
}

// Whether hair grows on a solid, or may: it moves with the head.
enum class Hair { elsewhere, may_grow, grows };

// How the numbers of a mesh of the file are meant, from what the scene says, the file, and guesses.
FileFrame frame_of(const Table& t, const SolidTable& read, const std::string& file, const FileAxes& said,
                   const Mesh& mesh, Hair hair, const std::vector<Vec3d>& roots) {
    FileFrame out{1, "y", rotation_of(read.rotation), read.scale, read.offset};
    if (read.up != "auto")
        out.up = read.up;
    else if (said.up && *said.up != 'y')
        out.up = *said.up, log_info(file + ": says that " + out.up + " points up");
    const bool open = read.units == "auto";
    if (!open) {
        out.metres = metres_of(read.units);
    } else if (said.metres_per_unit) {
        out.metres = *said.metres_per_unit;
        if (out.metres != 1) log_info(file + ": says that its unit is " + std::to_string(out.metres) + " m");
    } else if (hair != Hair::elsewhere || t.has("units")) {
        Mesh placed = mesh;
        FileFrame at_origin = out;
        at_origin.offset = {0, 0, 0};
        at_origin.place(placed.vertices);
        std::vector<Vec3d> around;
        for (const Vec3d& root : roots) around.push_back(root - out.offset);
        const Guess guess = guessed_unit(placed, hair != Hair::elsewhere ? around : std::vector<Vec3d>{});
        if (guess.word.empty() && hair != Hair::grows && !t.has("units")) return out;
        if (guess.word.empty())
            log_warning(t.where("file") + ": " + file + ": units not given, and none of m, cm, mm " +
                        (roots.empty() ? "makes it as large as a head or a body"
                                       : "brings it to the roots of the hair") +
                        "; took m");
        else if (out.metres = metres_of(guess.word); out.metres != 1 || t.has("units"))
            log_warning(t.where("file") + ": " + file + ": units not given, guessed " + guess.word + " (" +
                        guess.reason + "); say units = \"" + guess.word + "\" to be sure");
    }
    return out;
}

// Says what was mended, and where nothing tells inside from outside.
void judge(const Table& t, const std::string& file, const Winding& winding, const Mesh& mesh,
           double spacing) {
    if (winding.changed()) log_info(file + ": " + winding.text());
    const double apart = 0.5 * (spacing > 0 ? spacing : usual_spacing(bounding_box(mesh)));
    if (!(apart > 0)) return;  // the level set refuses it
    const double unclear = share_without_sides(mesh, apart);
    if (unclear < 0.02) return;
    log_warning(
        t.where("shape") + ": " + file + ": on " + std::to_string(int(std::lround(100 * unclear))) +
        " % of the surface nothing tells inside from outside, and hair passes through it there: it is a "
        "sheet, a shell thinner than " +
        std::to_string(1000 * apart) + " mm, or open; a closed surface collides");
}

Mesh wound(const Table& t, const std::string& file, const Mesh& mesh, double spacing) {
    Winding winding;
    Mesh out = consistently_wound(mesh, &winding);
    judge(t, file, winding, out, spacing);
    return out;
}
void wind(const Table& t, const std::string& file, Deformation& deformation, double spacing) {
    Winding winding;
    deformation.wind(winding);
    judge(t, file, winding, deformation.at(0), spacing);
}

Shape level_set_of(const Table& t, const SolidTable& read, Mesh mesh) {
    try {
        return LevelSet::cached(std::move(mesh), read.spacing);
    } catch (const Error& e) {
        throw Error(t.where("file") + ": " + read.file + ": " + e.what());
    }
}

void read_animated(Solid& solid, const Table& t, const SolidTable& read, Hair hair,
                   const AroundSolids& around, const ShotCuts& cuts) {
    const double fps = read.file_fps.value_or(around.fps);
    std::unique_ptr<MeshFrames> frames;
    try {
        frames = open_mesh_frames(read.file, read.object, fps);
    } catch (const Misuse& e) {
        t.fail("file", e.what());
    }
    Mesh first{frames->vertices(0), frames->triangles()};
    const FileFrame frame = frame_of(t, read, read.file, frames->axes(), first, hair, around.roots);
    if (frames->times().size() == 1 && read.rest.empty()) {
        frame.place(first.vertices);
        solid.shape = level_set_of(t, read, wound(t, read.file, first, read.spacing));
        return;
    }
    const double begin = read.first_file_frame ? *read.first_file_frame / fps : frames->times().front();
    log_info(read.file + ": " + std::to_string(frames->times().size()) + " frames from " +
             std::to_string(frames->times().front()) + " s to " + std::to_string(frames->times().back()) +
             " s; the scene begins at " + std::to_string(begin) + " s of it");
    auto deformation = std::make_shared<Deformation>(std::move(frames), frame, begin, cuts);
    if (!read.rest.empty()) {
        if (!std::filesystem::exists(read.rest)) t.fail("rest", "no file '" + read.rest + "'");
        deformation->rest_as(read_mesh(read.rest, 1), read.rest);
    }
    wind(t, read.file, *deformation, read.spacing);
    solid.deformation = deformation;
}

void read_mesh_solid(Solid& solid, const Table& t, const SolidTable& read, Hair hair,
                     const AroundSolids& around, const ShotCuts& cuts) {
    solid.spacing = read.spacing;
    if (const auto mesh = around.brought.find(solid.name); mesh != around.brought.end()) {
        if (t.has("mesh") || t.has("file"))
            t.fail(t.has("file") ? "file" : "mesh", "the mesh of '" + solid.name + "' comes from the caller");
        solid.driven = std::make_shared<Deformation>(wound(t, "mesh in memory", mesh->second, read.spacing));
        solid.deformation = solid.driven;
        return;
    }
    if (!t.has("mesh") && read.file.empty())
        t.fail("shape",
               "'mesh' needs file = \"….obj\" or \"….ply\", or [[solid.mesh]] tables to deform between");
    const bool animated = !t.has("mesh") && names_frames(read.file);
    for (const char* of_frames : {"object", "file_fps", "first_file_frame"})
        if (!animated && t.has(of_frames))
            t.fail(of_frames, "belongs to an animated file, .abc, .usda or numbered as body.####.obj");
    if (animated) return read_animated(solid, t, read, hair, around, cuts);
    if (t.has("mesh")) {
        if (t.has("file"))
            t.fail("file",
                   "is the mesh of a solid that keeps its shape; [[solid.mesh]] are one's that deforms");
        const auto keys = t.tables("mesh");
        MeshKeyframeTable first;
        read_parameters(first, MeshKeyframeTable::parameters, keys.front());
        FileFrame frame{1, "y", rotation_of(read.rotation), read.scale, read.offset};
        if (!first.file.empty())
            frame =
                frame_of(t, read, first.file, {}, mesh_of(keys.front(), first.file, 1), hair, around.roots);
        auto deformation = std::make_shared<Deformation>(t, frame, cuts);
        if (!read.rest.empty()) deformation->rest_as(read_mesh(read.rest, 1), read.rest);
        wind(t, first.file, *deformation, read.spacing);
        solid.deformation = deformation;
        return;
    }
    if (!read.rest.empty()) t.fail("rest", "is the pose of a mesh that deforms in which its hair was made");
    Mesh mesh = mesh_of(t, read.file, read.units == "auto" ? 1 : metres_of(read.units));
    FileFrame frame = frame_of(t, read, read.file, {}, mesh, hair, around.roots);
    if (read.units != "auto") frame.metres = 1;
    frame.place(mesh.vertices);
    solid.shape = level_set_of(t, read, wound(t, read.file, mesh, read.spacing));
}

Solid read_solid(const Table& t, size_t index, const AroundSolids& around) {
    SolidTable read;
    read_parameters(read, SolidTable::parameters, t);
    Solid solid;
    solid.name = name_of(t, read, index);
    solid.attached = read.attached;
    solid.friction = read.friction;
    if (solid.attached && t.has("motion"))
        t.fail("motion", "a solid that is attached to the head moves with it");
    if (!solid.attached) {
        solid.motion = Motion(t.table("motion"));
        solid.cuts = cuts_of(t.table("motion"), around.fps);
    }
    const ShotCuts cuts = around.cuts.joined(solid.cuts);
    solid.motion.rest_at(cuts);
    if (read.shape != "mesh" && around.brought.contains(solid.name))
        t.fail("shape", "found '" + read.shape + "' for a mesh that the caller brings, allowed is mesh");
    if (read.shape == "sphere") solid.shape = Sphere{read.radius};
    if (read.shape == "capsule") solid.shape = Capsule{read.half_length, read.radius};
    if (read.shape == "box") solid.shape = Box{read.half};
    if (read.shape == "plane") solid.shape = Plane{};
    if (read.shape == "head")
        solid.spacing = read.spacing, solid.shape = LevelSet::cached(bust_mesh(read.radius), read.spacing);
    if (read.shape == "mesh")
        read_mesh_solid(solid, t, read,
                        solid.name == around.scalp ? Hair::grows
                        : solid.attached           ? Hair::may_grow
                                                   : Hair::elsewhere,
                        around, cuts);
    return solid;
}

}  // namespace

std::vector<Solid> read_solids(const Table& root, const AroundSolids& around) {
    std::vector<Solid> solids;
    for (const Table& t : root.tables("solid")) solids.push_back(read_solid(t, solids.size(), around));
    return solids;
}

std::vector<std::string> names_of_solids(const Table& root) {
    std::vector<std::string> names;
    for (const Table& t : root.tables("solid")) {
        SolidTable read;
        const auto& row = *std::ranges::find(SolidTable::parameters, std::string_view("name"),
                                             [](const KeyRow& r) { return std::string_view(r.key); });
        read_parameter(read, row, t);
        names.push_back(name_of(t, read, names.size()));
    }
    return names;
}

}  // namespace wetcurl

// Reading [[solid]].
#include "solver/scene/read_solids.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "base/exchange/scene_mesh.h"
#include "base/geometry/bust.h"
#include "base/log.h"
#include "solver/grooms/guesses.h"
#include "solver/scene/rest_pose.h"

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
    const std::string where = t.where("file") + ": " + file + ": ";
    const bool open_up = read.up == "auto" && !said.up,
               open_unit = read.units == "auto" && !said.metres_per_unit;
    if (read.up != "auto")
        out.up = read.up;
    else if (said.up && *said.up != 'y')
        out.up = *said.up, log_info(file + ": says that " + out.up + " points up");
    if (read.units != "auto") {
        out.metres = metres_of(read.units);
    } else if (said.metres_per_unit) {
        out.metres = *said.metres_per_unit;
        if (out.metres != 1) log_info(file + ": says that its unit is " + std::to_string(out.metres) + " m");
    }
    const bool by_roots = hair != Hair::elsewhere && !roots.empty();
    if (!by_roots && !(open_unit && (hair == Hair::grows || t.has("units")))) return out;
    const std::vector<std::string> units =
        open_unit ? std::vector<std::string>{"m", "cm", "mm"} : std::vector<std::string>{"m"};
    const auto unit_if = [&](const std::string& up) {
        FileFrame at_origin = out;
        at_origin.up = up, at_origin.offset = {0, 0, 0};
        Mesh placed = mesh;
        at_origin.place(placed.vertices);
        if (!by_roots) return guessed_unit(placed);
        std::vector<Vec3d> around;
        for (const Vec3d& root : roots) around.push_back(root - out.offset);
        return guessed_unit(placed, around, units);
    };
    Guess unit = unit_if(out.up);
    constexpr double on_it = 0.01;  // [m]
    if (by_roots && open_up && (unit.word.empty() || unit.away > on_it))
        if (const Guess turned = unit_if("z"); !turned.word.empty() && turned.away < on_it &&
                                               (unit.word.empty() || turned.away < 0.5 * unit.away)) {
            unit = turned, out.up = "z";
            log_warning(where + "up axis not given, guessed z (" + unit.reason +
                        "); up = \"z\" in the [[solid]] says so");
        }
    if (!open_unit) return out;
    if (!unit.word.empty()) {
        out.metres = metres_of(unit.word);
        if (out.metres != 1 || t.has("units"))
            log_warning(where + "units not given, guessed " + unit.word + " (" + unit.reason +
                        "); units = \"" + unit.word + "\" in the [[solid]] says so");
    } else if (hair == Hair::grows || t.has("units")) {
        log_warning(
            where + "units not given, and none of m, cm, mm " +
            (by_roots ? "brings it to the roots of the hair" : "makes it as large as a head or a body") +
            "; took m");
    }
    return out;
}

using Level = Finding::Level;

// Adds what was mended of a mesh, and where nothing tells inside from outside.
void judge(Solid& solid, const std::string& file, const Winding& winding, const Mesh& mesh) {
    const auto add = [&](Level level, const char* name, const std::string& text, const std::string& remedy) {
        solid.findings.push_back(
            {level, name, "[[solid]] '" + solid.name + "', " + file + ": " + text, remedy});
    };
    const std::string all = " of " + std::to_string(mesh.triangles.size() + winding.doubled) + " faces ";
    if (winding.doubled)
        add(Level::warning, "doubled_faces",
            std::to_string(winding.doubled) + all + "are there twice; each is taken once", "");
    if (winding.turned)
        add(Level::warning, "turned_faces",
            std::to_string(winding.turned) + all + "are turned against the others; they are turned round",
            "");
    if (winding.no_area)
        add(Level::note, "no_area",
            std::to_string(winding.no_area) + all + "have no area and count for nothing", "");
    if (winding.open)
        add(Level::note, "open_mesh",
            std::to_string(winding.open) +
                " edges are open; what is inside is told by the winding of the faces",
            "");
    const double apart = 0.5 * (solid.spacing > 0 ? solid.spacing : usual_spacing(bounding_box(mesh)));
    if (!(apart > 0)) return;  // the level set refuses it
    const double unclear = share_without_sides(mesh, apart);
    if (unclear < 0.02) return;
    add(Level::warning, "no_inside",
        fmt::format(
            "on {:.0f} % of the surface nothing tells inside from outside, and hair passes through it "
            "there: it is a sheet, a shell thinner than {:.2g} mm, or open",
            100 * unclear, 1000 * apart),
        "spacing of that [[solid]], if it is a shell; else a closed surface");
}

Mesh wound(Solid& solid, const std::string& file, const Mesh& mesh) {
    Winding winding;
    Mesh out = consistently_wound(mesh, &winding);
    judge(solid, file, winding, out);
    return out;
}
void wind(Solid& solid, const std::string& file, Deformation& deformation) {
    Winding winding;
    deformation.wind(winding);
    judge(solid, file, winding, deformation.at(0));
}

Shape level_set_of(const Table& t, const SolidTable& read, Mesh mesh) {
    try {
        return LevelSet::cached(std::move(mesh), read.spacing);
    } catch (const Error& e) {
        throw Error(t.where("file") + ": " + read.file + ": " + e.what());
    }
}

void read_animated(Solid& solid, const Table& t, const SolidTable& read, Hair hair,
                   const AroundSolids& around) {
    if (t.has("file_fps") && is_scene_file(read.file) && !t.has("first_file_frame") && !t.has("rest_frame"))
        t.fail("file_fps", read.file +
                               " tells the times of its frames; of such a file it counts those of "
                               "first_file_frame and rest_frame alone");
    std::unique_ptr<MeshFrames> frames;
    try {
        frames = open_mesh_frames(read.file, read.object, read.file_fps.value_or(around.fps));
    } catch (const Misuse& e) {
        t.fail(t.has("object") && std::filesystem::exists(read.file) ? "object" : "file", e.what());
    }
    const auto& times = frames->times();
    const double fps = read.file_fps.value_or(frames->axes().rate.value_or(around.fps));
    if (t.has("first_file_frame") || t.has("rest_frame")) warn_of_other_rate(read, *frames, fps);
    Mesh first{frames->vertices(0), frames->triangles()};
    RestPose rest = rest_of(t, read, *frames, fps);
    const FileFrame frame =
        frame_of(t, read, read.file, frames->axes(), rest.mesh ? *rest.mesh : first, hair, around.roots);
    if (times.size() == 1 && (hair == Hair::grows || t.has("first_file_frame") || rest.mesh))
        warn_of_still_mesh(read);
    if (times.size() == 1 && !rest.mesh) {
        frame.place(first.vertices);
        solid.shape = level_set_of(t, read, wound(solid, read.file, first));
        return;
    }
    const double start = std::min(frames->axes().start.value_or(times.front()), times.back()),
                 begin = read.first_file_frame ? *read.first_file_frame / fps : start;
    log_info(fmt::format("{}: {} frames from {:g} s to {:g} s; the scene begins at {:g} s of it", read.file,
                         times.size(), times.front(), times.back(), begin));
    if (const double end = times.back() - begin; times.size() > 1 && end < 0)
        log_warning(
            fmt::format("{}: ends before the scene begins; the mesh stands still (found first_file_frame {}, "
                        "its frames end at {})",
                        read.file, int(std::lround(begin * fps)), int(std::lround(times.back() * fps))));
    else if (times.size() > 1 && std::isfinite(around.seconds) && end < around.seconds - 0.5 / around.fps)
        log_warning(
            fmt::format("{}: ends at frame {} of the scene, which has {}; the mesh stands still from "
                        "there on (first_file_frame, file_fps, or fewer frames mend it)",
                        read.file, int(std::floor(end * around.fps + 0.5)),
                        int(std::lround(around.seconds * around.fps)) + 1));
    if (const double before = start - begin; times.size() > 1 && before > 0.5 / around.fps)
        log_warning(fmt::format(
            "{}: begins at frame {} of the scene; the mesh stands still before it (first_file_frame "
            "or file_fps mend it)",
            read.file, int(std::floor(before * around.fps + 0.5))));
    auto deformation = std::make_shared<Deformation>(std::move(frames), frame, begin);
    if (rest.mesh) deformation->rest_as(std::move(*rest.mesh), rest.name);
    wind(solid, read.file, *deformation);
    solid.deformation = deformation;
}

void read_mesh_solid(Solid& solid, const Table& t, const SolidTable& read, Hair hair,
                     const AroundSolids& around) {
    solid.spacing = read.spacing;
    if (const auto mesh = around.brought.find(solid.name); mesh != around.brought.end()) {
        if (t.has("mesh") || t.has("file"))
            t.fail(t.has("file") ? "file" : "mesh", "the mesh of '" + solid.name + "' comes from the caller");
        solid.driven = true;
        solid.deformation = std::make_shared<Deformation>(wound(solid, "mesh in memory", mesh->second));
        return;
    }
    if (!t.has("mesh") && read.file.empty())
        t.fail("shape",
               "'mesh' needs file = \"….obj\", \"….ply\" or \"….glb\", or [[solid.mesh]] tables to deform "
               "between");
    const bool animated = !t.has("mesh") && names_frames(read.file);
    for (const char* of_frames : {"object", "file_fps", "first_file_frame", "rest_frame"})
        if (!animated && t.has(of_frames))
            t.fail(of_frames, "belongs to an animated file, .abc, .usda or numbered as body.####.obj");
    if (animated) return read_animated(solid, t, read, hair, around);
    if (t.has("mesh")) {
        if (t.has("file"))
            t.fail("file",
                   "is the mesh of a solid that keeps its shape; [[solid.mesh]] are one's that deforms");
        const auto keys = t.tables("mesh");
        MeshKeyframeTable first;
        read_parameters(first, MeshKeyframeTable::parameters, keys.front());
        FileFrame frame{1, "y", rotation_of(read.rotation), read.scale, read.offset};
        RestPose rest = rest_of(t, read, first.file.empty() ? FileAxes() : axes_of_mesh(first.file));
        if (!first.file.empty())
            frame =
                frame_of(t, read, first.file, axes_of_mesh(first.file),
                         rest.mesh ? *rest.mesh : mesh_of(keys.front(), first.file, 1), hair, around.roots);
        auto deformation = std::make_shared<Deformation>(t, frame);
        if (rest.mesh) deformation->rest_as(std::move(*rest.mesh), rest.name);
        wind(solid, first.file, *deformation);
        solid.deformation = deformation;
        return;
    }
    if (!read.rest.empty()) t.fail("rest", "is the pose of a mesh that deforms in which its hair was made");
    FileFrame frame =
        frame_of(t, read, read.file, axes_of_mesh(read.file), mesh_of(t, read.file, 1), hair, around.roots);
    // Units are taken as numbers are read, in double precision.
    Mesh mesh = mesh_of(t, read.file, std::exchange(frame.metres, 1));
    frame.place(mesh.vertices);
    solid.shape = level_set_of(t, read, wound(solid, read.file, mesh));
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
        solid.cuts = cuts_of(t.table("motion"), around.fps, around.seconds);
    }
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
                        around);
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

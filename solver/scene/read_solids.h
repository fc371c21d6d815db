// Reading [[solid]].
#pragma once

#include "solver/scene/scene.h"

namespace wetcurl {

// [[solid]] as it is written.
struct SolidTable {
    static constexpr const char* shapes[] = {"sphere", "capsule", "box", "plane", "head", "mesh"};
    static constexpr const char* attached_words[] = {"none", "head"};
    static constexpr When of_mesh{"shape", "mesh"};
    std::string name, shape, file, object, rest, units = "auto", up = "auto";
    double radius = 0, half_length = 0, spacing = 0, friction = 0;  // [m] but the friction
    double scale = 1;
    Vec3d half{0, 0, 0}, offset{0, 0, 0};  // [m]
    Vec3d rotation{0, 0, 0};               // [degrees]
    std::optional<double> file_fps;
    std::optional<int> first_file_frame, rest_frame;
    bool attached = false;

    static constexpr Parameter<SolidTable> parameters[] = {
        {KeyRow::text("name", "", "Name of the solid in messages, and for [groom] scalp.")
             .without_default("solid and its number"),
         &SolidTable::name},
        {KeyRow::one_of("shape", shapes, "sphere", "Shape of the solid; a plane is solid below y = 0."),
         &SolidTable::shape},
        {KeyRow::number("radius", "m", 0.1, 1e-4, 100, "Radius of the sphere.", "",
                        {"shape", "sphere", true}),
         &SolidTable::radius},
        {KeyRow::number("radius", "m", 0.05, 1e-4, 100, "Radius of the capsule.", "", {"shape", "capsule"}),
         &SolidTable::radius},
        {KeyRow::number("radius", "m", 0.095, 1e-4, 100,
                        "Radius of a ball as large as the skull of the head.", "", {"shape", "head"}),
         &SolidTable::radius},
        {KeyRow::number("half_length", "m", 0.1, 0, 100,
                        "Half of the distance between the centres of the capsule's ends.", "",
                        {"shape", "capsule"}),
         &SolidTable::half_length},
        {KeyRow::numbers("half", "m", {0.1, 0.1, 0.1}, 1e-4, 100, "Half of the sides of the box.", "",
                         {"shape", "box"}),
         &SolidTable::half},
        {KeyRow::path("file", "[[solid.mesh]] tables",
                      "Mesh: .obj, .ply or .glb keeps its shape; .abc, .usda, and numbered files as "
                      "body.####.obj are animated.",
                      "", of_mesh),
         &SolidTable::file},
        {KeyRow::text("object", "", "Path of one mesh in an .abc or .usda file, or of a group of them.", "",
                      of_mesh)
             .without_default("all meshes of the file"),
         &SolidTable::object},
        {KeyRow::number("file_fps", "1/s", 24, 1, 10000,
                        "Frames of a second in the numbers of an animated file.", "", of_mesh)
             .without_default("what the file says, else fps"),
         &SolidTable::file_fps},
        {KeyRow::integer("first_file_frame", 1, -1'000'000, 1'000'000,
                         "Number of the animated file's frame that is frame 0 of the scene.", "", of_mesh)
             .without_default("where its file says that the shot begins, else its first"),
         &SolidTable::first_file_frame},
        {KeyRow::path("rest", "the mesh at frame 0",
                      "Mesh of the pose in which the hair was made, with the triangles of the animated one.",
                      "", of_mesh),
         &SolidTable::rest},
        {KeyRow::integer("rest_frame", 0, -1'000'000, 1'000'000,
                         "Number of the animated file's frame in which the hair was made, in the place of a "
                         "file of its own.",
                         "", of_mesh)
             .without_default("the scene's frame 0"),
         &SolidTable::rest_frame},
        {KeyRow::one_of("units", unit_words, "auto", "Unit of the numbers in the meshes.", "", of_mesh)
             .without_default("what the file says, else m; guessed where hair grows on it"),
         &SolidTable::units},
        {KeyRow::one_of("up", axis_words, "auto", "Axis that points up in the meshes.", "", of_mesh)
             .without_default("what the file says, else y; guessed where hair grows on it"),
         &SolidTable::up},
        {KeyRow::numbers("rotation", "degrees", {0, 0, 0}, -3600, 3600,
                         "Rotation of the meshes about x, then y, then z.", "", of_mesh),
         &SolidTable::rotation},
        {KeyRow::number("scale", "1", 1, 1e-6, 1e6, "Factor of the meshes.", "", of_mesh),
         &SolidTable::scale},
        {KeyRow::numbers("offset", "m", {0, 0, 0}, -1e4, 1e4,
                         "Translation of the meshes, after rotation and scale.", "", of_mesh),
         &SolidTable::offset},
        {KeyRow::number("spacing", "m", 0, 0, 1, "Spacing of the level set of a mesh; 0: chosen by its size.",
                        "", of_mesh),
         &SolidTable::spacing},
        {KeyRow::number("spacing", "m", 0, 0, 1,
                        "Spacing of the level set of the head; 0: chosen by its size.", "",
                        {"shape", "head"}),
         &SolidTable::spacing},
        {KeyRow::one_of("attached", attached_words, "none", "Whether the solid moves with the head."),
         &SolidTable::attached},
        {KeyRow::number("friction", "1", 0.3, 0, 100, "Coefficient of friction of hair on it.", "Coulomb"),
         &SolidTable::friction},
    };
};

// What the reading of solids sees of the scene.
struct AroundSolids {
    double fps, seconds;                         // of the run, until its last frame; no end: infinite
    std::string scalp;                           // name of the solid that hair grows on; "": none
    std::vector<Vec3d> roots;                    // [m]; empty: not known yet
    const std::map<std::string, Mesh>& brought;  // meshes by name of solid [m], which a caller drives
};

// All solids of a scene. Throws Misuse with file and line, Error for bad meshes.
std::vector<Solid> read_solids(const Table& root, const AroundSolids& around);
// Their names, without reading them.
std::vector<std::string> names_of_solids(const Table& root);

}  // namespace wetcurl

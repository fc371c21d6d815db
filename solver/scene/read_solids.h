// Reading [[solid]].
#pragma once

#include "solver/scene/scene.h"

namespace wetcurl {

// [[solid]] as it is written.
struct SolidTable {
    static constexpr const char* shapes[] = {"sphere", "capsule", "box", "plane", "head", "mesh"};
    static constexpr const char *units_words[] = {"m", "cm", "mm"}, *attached_words[] = {"none", "head"};
    std::string name, shape, file, units = "m";
    double radius = 0, half_length = 0, spacing = 0, friction = 0;  // [m] but the friction
    Vec3d half{0, 0, 0};                                            // [m]
    bool attached = false;

    double metres() const { return units == "m" ? 1 : units == "cm" ? 0.01 : 0.001; }
    static constexpr Parameter<SolidTable> parameters[] = {
        {KeyRow::text("name", "", "Name of the solid in messages.").without_default("solid and its number"),
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
        {KeyRow::path("file", "[[solid.mesh]] tables", "Mesh of a solid that keeps its shape, .obj or .ply.",
                      "", {"shape", "mesh"}),
         &SolidTable::file},
        {KeyRow::one_of("units", units_words, "m", "Unit of the numbers in the meshes.", "",
                        {"shape", "mesh"}),
         &SolidTable::units},
        {KeyRow::number("spacing", "m", 0, 0, 1, "Spacing of the level set of a mesh; 0: chosen by its size.",
                        "", {"shape", "mesh"}),
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

// All solids of a scene. Throws Misuse with file and line, Error for bad meshes.
std::vector<Solid> read_solids(const Table& root);

}  // namespace wetcurl

// The built-in groom: roots on a grid over a scalp, strands that leave it, part from the face, fall, and curl
// round their fall.
#pragma once

#include <memory>
#include <string>

#include "base/geometry/file_frame.h"
#include "base/parameters.h"
#include "base/strands.h"
#include "solver/grooms/import.h"
#include "solver/grooms/root_grid.h"
#include "solver/grooms/scalp.h"
#include "solver/grooms/turns.h"

namespace wetcurl {

struct ProceduralGroom {
    int width = 32, height = 32;  // roots each way
    int particles = 50;           // of each strand
    unsigned long long seed = 0;

    double length;                      // along the strand [m]
    double curl_radius;                 // [m]; 0: straight
    double pitch;                       // along the core, a turn [m]
    double phase_noise;                 // [rad]
    double curl_lock;                   // [m]; 0: each strand curls by itself
    double radius_noise, length_noise;  // fractions
    double lift;                        // how far a strand stands out before it falls [m]
    double comb;                        // pull away from the part, against gravity's 1
    double scalp_radius;                // [m]
    double coverage;                    // from the cap's pole to its rim [rad]
    double tilt;                        // of the pole, back from straight up [rad]
    std::string hairline;               // "round": the cap's rim; "natural": a head's (base/geometry/bust.h)
    double part_turn;                   // of the part, from the middle of the brow toward +x [rad]

    std::shared_ptr<const ScalpMesh> head;  // instead of the ball, where given
    Vec3d scalp_centre{0, 0, 0};            // [m]
};

// [groom], less the rows of the built-in groom alone (procedural_parameters) and those of the hair's
// substance (solver/scene/scene.h).
struct GroomTable {
    std::array<int, 2> grid;  // roots each way
    int particles;            // of each strand
    std::string scalp;        // a file; "": none
    std::string scalp_units, scalp_up;
    std::optional<Vec3d> scalp_centre;  // [m]
    std::string file;                   // strands; "": the built-in groom
    std::string units = "auto", up = "auto";
    Vec3d rotation{0, 0, 0};  // [degrees]
    double scale = 1;
    Vec3d offset{0, 0, 0};  // [m]
    bool tip_first = false, repair = false;

    FileUnits hair_units() const { return {units, up}; }
    // Those of the hair, where the scalp has none of its own. `up_of_hair`: as its file was read.
    FileUnits units_of_scalp(const std::string& up_of_hair) const {
        return {scalp_units.empty() ? units : scalp_units, !scalp_up.empty() ? scalp_up
                                                           : up != "auto"    ? up
                                                                             : up_of_hair};
    }
    static constexpr const char* orders[] = {"root_first", "tip_first"};
    static constexpr Parameter<GroomTable> parameters[] = {
        {KeyRow::integers("grid", {32, 32}, 1, 4096,
                          "Roots each way; of a file's strands, without it, the finest grid that they fill."),
         &GroomTable::grid},
        {KeyRow::integer("particles", 50, 2, 10000, "Particles of each strand."), &GroomTable::particles},
        {KeyRow::path(
             "scalp", "a ball",
             "Mesh of the head, .obj, .ply, .glb, .abc or .usda, on which the roots lie; or the name of a "
             "[[solid]] of the scene with shape = \"mesh\", on which they also ride."),
         &GroomTable::scalp},
        {KeyRow::one_of("scalp_units", unit_words, "", "Unit of the numbers in the scalp's file.", "",
                        {"scalp"})
             .without_default("what its file says, else as units"),
         &GroomTable::scalp_units},
        {KeyRow::one_of("scalp_up", axis_words, "", "Axis that points up in the scalp's file.", "", {"scalp"})
             .without_default("what its file says, else as up"),
         &GroomTable::scalp_up},
        {KeyRow::numbers("scalp_centre", "m", {0, 0, 0}, -100, 100, "Centre of the ball or of the head.")
             .without_default("the origin, or the middle of the scalp's mesh"),
         &GroomTable::scalp_centre},
        {KeyRow::path(
             "file", "the built-in groom",
             "Strands of another program: .hair, .data, .bin, .ply, .tfx, .obj, .npz, .abc or .usda."),
         &GroomTable::file},
        {KeyRow::one_of("units", unit_words, "auto",
                        "Unit of the numbers in the file; auto chooses by the size of the hair.", "",
                        {"file|scalp"}),
         &GroomTable::units},
        {KeyRow::one_of(
             "up", axis_words, "auto",
             "Axis that points up in the file; auto: as the file says, else y, or a guess by how hair falls.",
             "", {"file|scalp"}),
         &GroomTable::up},
        {KeyRow::numbers("rotation", "degrees", {0, 0, 0}, -3600, 3600,
                         "Rotation of the strands of the file about x, then y, then z.", "", {"file"}),
         &GroomTable::rotation},
        {KeyRow::number("scale", "1", 1, 1e-6, 1e6, "Factor of the strands of the file.", "", {"file"}),
         &GroomTable::scale},
        {KeyRow::numbers("offset", "m", {0, 0, 0}, -1e4, 1e4,
                         "Translation of those strands, after rotation and scale.", "", {"file"}),
         &GroomTable::offset},
        {KeyRow::one_of("order", orders, "root_first", "Where strands of the file begin.", "", {"file"}),
         &GroomTable::tip_first},
        {KeyRow::boolean("repair", false,
                         "Whether stray points are left out: at the origin, or far from those before them.",
                         "", {"file"}),
         &GroomTable::repair},
    };
};

inline constexpr const char* hairlines[] = {"round", "natural"};
inline constexpr Parameter<ProceduralGroom> procedural_parameters[] = {
    {KeyRow::number("length", "m", 0.25, 1e-3, 10, "Length along a strand."), &ProceduralGroom::length},
    {KeyRow::number("curl_radius", "m", 0.006, 0, 0.1, "Radius of the helix round the core; 0: straight."),
     &ProceduralGroom::curl_radius},
    {KeyRow::number("pitch", "m", 0.025, 1e-4, 10, "Advance of the helix along the core in a turn."),
     &ProceduralGroom::pitch},
    {KeyRow::number("phase_noise", "rad", 1.5, 0, 3.141592653589793,
                    "Largest shift of the phase of a helix."),
     &ProceduralGroom::phase_noise},
    {KeyRow::number("curl_lock", "m", 0, 0, 1,
                    "Width of the locks whose strands curl alike; 0: each strand by itself."),
     &ProceduralGroom::curl_lock},
    {KeyRow::number("radius_noise", "1", 0.1, 0, 0.9, "Largest change of the curl radius, as a share of it."),
     &ProceduralGroom::radius_noise},
    {KeyRow::number("length_noise", "1", 0.1, 0, 0.9, "Largest change of the length, as a share of it."),
     &ProceduralGroom::length_noise},
    {KeyRow::number("lift", "m", 0.02, 1e-3, 0.2, "How far a strand stands out before it falls."),
     &ProceduralGroom::lift},
    {KeyRow::number("comb", "1", 1.5, 0, 10, "Pull away from the part at the brow, against gravity's 1."),
     &ProceduralGroom::comb},
    {KeyRow::number("scalp_radius", "m", 0.095, 0.01, 1,
                    "Radius of the ball; of a mesh: depth of its centre below the top."),
     &ProceduralGroom::scalp_radius},
    {KeyRow::number("coverage", "rad", 1.6, 0.1, 3.0,
                    "Angle from the middle of the hair to its rim, seen from the centre.", "",
                    {"hairline", "round", true}),
     &ProceduralGroom::coverage},
    {KeyRow::number("tilt", "rad", 0.7, 0, 1.5,
                    "Angle of the middle of the hair, back from straight up: the face (+Z) stays free."),
     &ProceduralGroom::tilt},
    {KeyRow::one_of("hairline", hairlines, "round",
                    "Rim of the hair: a circle at coverage, or natural: above brow and temples, round the "
                    "ears, down to the "
                    "nape."),
     &ProceduralGroom::hairline},
    {KeyRow::number("part_turn", "rad", 0, -1.5, 1.5,
                    "Turn of the part from the middle of the brow, toward +X."),
     &ProceduralGroom::part_turn},
};

// Reads `[groom]`. `of_solid`: the scalp, where `scalp` names a solid. Throws Misuse for what is out of
// range.
ProceduralGroom read_procedural(const Table& table, unsigned long long seed,
                                const std::shared_ptr<const ScalpMesh>& of_solid = nullptr);

// The mesh in the file that `[groom] scalp` names, else that of the solid; null where it names none.
std::shared_ptr<const ScalpMesh> read_scalp(const GroomTable& groom,
                                            const std::shared_ptr<const ScalpMesh>& of_solid,
                                            const std::string& up_of_hair = "auto");

// Of a strand of no noise, as its curl winds once it is open.
CurlTurns turns_of(const ProceduralGroom& groom);

// Root (i, j) at (i / width, j / height) of the parameter square. A strand depends on that place, the seed
// and the parameters, never on the size of the grid: grids nest to the bit.
Groom make_procedural(const ProceduralGroom& groom);

}  // namespace wetcurl

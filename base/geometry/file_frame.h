// How the numbers of a file are meant: unit, axis that points up, and where its things are put. One way for
// hair, scalps, solids and characters.
#pragma once

#include <string>
#include <vector>

#include "base/geometry/mesh.h"

namespace wetcurl {

inline constexpr const char *unit_words[] = {"m", "cm", "mm", "auto"},
                            *axis_words[] = {"x", "-x", "y", "-y", "z", "-z", "auto"};

// Of a unit by its name. Throws std::logic_error for one that is none of m, cm, mm.
double metres_of(const std::string& unit);

// Turns coordinates so that the axis `up` (of axis_words, not auto) points along +y; about x where up is z,
// so that what faced -y faces +z. The others turn about z or x too. Throws Misuse for another word, "" before
// it.
Vec3d upright(const std::string& up, const Vec3d& x);
// Its inverse: coordinates with +y up to those of a file in which `up` is. Throws likewise.
Vec3d laid_along(const std::string& up, const Vec3d& y_up);

// By angles [degrees] about x, then y, then z.
Quatd rotation_of(const Vec3d& degrees);

// From a file to the scene: x -> scale R upright(metres x) + offset.
struct FileFrame {
    double metres = 1;
    std::string up = "y";
    Quatd rotation = Quatd::identity();
    double scale = 1;
    Vec3d offset{0, 0, 0};  // [m]
    Vec3d operator()(const Vec3d& x) const;
    bool changes() const;
    void place(std::vector<Vec3f>& points) const;
};

}  // namespace wetcurl

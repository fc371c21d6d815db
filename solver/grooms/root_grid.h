// Roots of a real groom laid on a grid, so that neighbours on the scalp are neighbours among the pixels.
#pragma once

#include <string>

#include "base/strands.h"
#include "solver/grooms/planar.h"
#include "solver/grooms/scalp.h"

namespace wetcurl {

// How well neighbours stay neighbours: 1 is as close as can be, a square lattice of roots.
struct GridQuality {
    int roots = 0, pixels = 0;  // pixels that hold a root; roots - pixels are left out
    double neighbour_mean = 0;  // distance of roots at neighbouring pixels [m]
    double nearest_mean = 0;    // distance of a root on the grid to the nearest other one [m]
    double ratio() const { return nearest_mean > 0 ? neighbour_mean / nearest_mean : 0; }
};

struct RootLayout {
    RootGrid grid;  // indices of the roots given, or -1
    GridQuality quality;
    std::string parameterisation;  // how roots came to the plane
    std::string assignment;        // how places came to pixels: the better one of those tried
};

// Sides of a near-square grid with a pixel for each root, and few more: multiples of 8 where at most a tenth
// of the roots' number stays empty, else of 4, 2 or 1. The first is the longer one.
struct GridSize {
    int width, height;
};
GridSize finest_grid(int roots);
// Pixels that may stay empty: those in odd columns of odd rows, where no coarser grid of every 2nd, 4th...
// root has one.
int most_holes(GridSize size);

// The roots [m] as a dome: middle, axis and curvature, by least squares; `flat` where they lie in a plane.
struct RootDome {
    Vec3d centre, axis, right;  // axis points outward; right is perpendicular to it
    double radius = 0;          // [m]
    bool flat = false;
    Vec3d outward(const Vec3d& x) const;
    // Azimuthal equal-distance projection about the axis; along the plane where flat [m].
    Planar project(const Vec3d& x) const;
};
RootDome dome_of(const std::vector<Vec3d>& roots);

// Places of the roots in a plane [m]: over the flattened scalp where one is given, else by the dome.
// `how`, where given, receives a line about it.
std::vector<Planar> parameterised(const std::vector<Vec3d>& roots, const ScalpMesh* scalp,
                                  std::string* how = nullptr);

// Ways of cutting roots and pixels in two, over and over, until each pixel has its roots.
enum class Cuts { longer_side, rows_first };
RootGrid assigned(const std::vector<Planar>& places, GridSize size, Cuts cuts);
// Exchanges roots of nearby pixels wherever that shortens the way between neighbours. Returns exchanges made.
int untangle(RootGrid& grid, const std::vector<Vec3d>& roots);

GridQuality grid_quality(const RootGrid& grid, const std::vector<Vec3d>& roots);

// Parameterises, tries the assignments, keeps the better. `size` = {0, 0}: finest_grid. Where it has fewer
// pixels than there are roots, roots are left out. Throws Error for no root, or where more pixels than
// most_holes would stay empty.
RootLayout lay_on_grid(const std::vector<Vec3d>& roots, const ScalpMesh* scalp, GridSize size = {0, 0});

// "88 x 88 pixels of 7905 roots: neighbours 3.1 mm apart, nearest roots 1.4 mm (2.2 times); ..."
std::string described(const RootLayout& layout);

}  // namespace wetcurl

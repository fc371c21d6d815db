// Strands and the grid that their roots lie on: the layout that both towers share.
#pragma once

#include <string>
#include <vector>

#include "base/vec3.h"

namespace wetcurl {

// `count` strands of `particles` particles each; points[s * particles + i], metres, root first.
struct Strands {
    int count = 0;
    int particles = 0;
    std::vector<Vec3f> points;

    Strands() = default;
    Strands(int count, int particles)
        : count(count), particles(particles), points(size_t(count) * particles) {}
    Vec3f* strand(int s) { return points.data() + size_t(s) * particles; }
    const Vec3f* strand(int s) const { return points.data() + size_t(s) * particles; }
    Vec3f& at(int s, int i) { return strand(s)[i]; }
    const Vec3f& at(int s, int i) const { return strand(s)[i]; }
};

// Roots on a W x H grid: strand[row * width + column] is the strand at that pixel, or -1.
// Pixel (column, row) sits at (column / width, row / height) of the scalp's parameter square, so every
// second pixel each way is the grid of half the size.
struct RootGrid {
    int width = 0;
    int height = 0;
    std::vector<int> strand;

    int at(int column, int row) const { return strand[size_t(row) * width + column]; }
};

// What the file that a strand came from says of it.
struct StrandOrigin {
    int number = 0;  // its place in the file, or in the scene's whole groom, from 0
    int id = 0;      // its number where the file says none
    int group = 0;
    float uv[2] = {0, 0};  // of its root; its pixel's place on the grid where the file says none
};

// A rest groom: strands in the head's frame at rest, the outward scalp normal at each root, their grid.
struct Groom {
    Strands rest;
    std::vector<Vec3f> normal;  // unit, one a strand
    RootGrid grid;
    std::vector<StrandOrigin> origin;  // (strand); empty: as they stand here
    std::vector<float> width;          // (strand, particle) diameter [m]; empty: the file says none
    std::string hash() const;          // of points and grid: two runs pair only where grooms nest
};

// Its `origin`, or, where that is empty, what it stands for.
std::vector<StrandOrigin> origins_of(const Groom& groom);

// The groom of every `stride`-th root each way, strands renumbered row by row.
// `kept`, where given, receives for each strand of the result its index in `full`.
Groom coarsened(const Groom& full, int stride, std::vector<int>* kept = nullptr);

// The groom of some of the strands, in this order, on a grid of one row: no strand of it has neighbours
// there.
Groom part_of(const Groom& full, const std::vector<int>& kept);

// Length of a polyline of n points [m].
double arc_length(const Vec3f* points, int n);
double arc_length(const Vec3d* points, int n);

// n points, spaced evenly by arc length on the centripetal Catmull-Rom spline through the given ones.
std::vector<Vec3d> resampled(const std::vector<Vec3d>& points, int n);

// FNV-1a of bytes, 16 hexadecimal digits.
std::string hash_bytes(const void* data, size_t bytes, unsigned long long seed = 14695981039346656037ull);
// The same of a whole file. Throws Error where it cannot be read.
std::string hash_of_file(const std::string& path);

}  // namespace wetcurl

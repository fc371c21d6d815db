// Roots as colours of a geometry image.
// Eq 14-16. Differs: Eq 16 has h^2 before its sum, unless it is read as printed (the shift is then one over a
// length), and W(0) of the root itself below (else one neighbour at the rim of the support throws the root to
// infinity); sigma is the strand's length-weighted mean.
#pragma once

#include <cstdint>
#include <vector>

#include "base/shift_units.h"
#include "base/strands.h"

namespace wetcurl {

// b_min, b_max of Eq 14 [m], world axes.
struct ColourBox {
    Vec3d lower{0, 0, 0}, upper{0, 0, 0};
    double diagonal() const { return norm(upper - lower); }
};
// Grows `box` by the points; an empty box (diagonal 0) takes the points' own.
void grow(ColourBox& box, const std::vector<Vec3f>& points);

// Eq 14 and 15: one scalar diagonal, so that colours keep angles. The box must not be a point.
inline Vec3f colour_of(const Vec3f& p, const ColourBox& box) {
    return cast<float>((1 / box.diagonal()) * (cast<double>(p) - box.lower));
}
inline Vec3f position_of(const Vec3f& colour, const ColourBox& box) {
    return cast<float>(box.diagonal() * cast<double>(colour) + box.lower);
}

// Length-weighted mean saturation of each strand, from (strand, particle).
std::vector<float> strand_saturation(const Strands& strands, const std::vector<float>& saturation);

// Eq 16 for every root: p + h^2 sum_j sigma_j grad W(p - p_j) / (W(0) + sum_j W(p - p_j)), j the particles of
// other strands within h [m]; `units` printed: without the h^2. `saturation` (strand, particle), empty for
// dry: then the roots themselves.
std::vector<Vec3f> shifted_roots(const Strands& strands, const std::vector<float>& saturation, float h,
                                 ShiftUnits units = ShiftUnits::length);

// How the roots of a grid lie in an image with sides of multiples of 32.
class RootImage {
  public:
    // Low-resolution image of `grid`, or (scale 2) the image of twice the low-resolution size that holds
    // `grid`.
    RootImage(const RootGrid& grid, int scale = 1);
    int height() const { return height_; }
    int width() const { return width_; }
    size_t pixels() const { return size_t(height_) * width_; }
    // (height, width): 1 where a strand is.
    std::vector<uint8_t> mask() const;
    // One colour a strand to (3, height, width); pixels without a strand repeat the nearest one that has.
    void draw(const std::vector<Vec3f>& colours, float* image) const;
    // (3, height, width) to one colour a strand.
    std::vector<Vec3f> read(const float* image) const;

  private:
    int height_, width_;
    std::vector<int> strand_;    // (height, width): of the pixel, or of the nearest pixel that has one
    std::vector<int> pixel_of_;  // (strand)
};

}  // namespace wetcurl

// Pictures of strands and solids, drawn in software: perspective, z-buffered solids, anti-aliased strands
// with highlights along the strand and shadows through the hair.
// Shading: Kajiya and Kay 1989 (diffuse), Marschner 2003 in the form of Karis 2016 (lobes); the rest ours.
#pragma once

#include <vector>

#include "app/engine/run_solids.h"
#include "base/strands.h"

namespace wetcurl {

// Red, green, blue in 0..1 as displayed (sRGB); rgb[(row * width + column) * 3 + channel].
struct Image {
    int width = 0, height = 0;
    std::vector<float> rgb;

    Image() = default;
    Image(int width, int height) : width(width), height(height), rgb(size_t(width) * height * 3) {}
    float* pixel(int column, int row) { return rgb.data() + (size_t(row) * width + column) * 3; }
    const float* pixel(int column, int row) const { return rgb.data() + (size_t(row) * width + column) * 3; }
};

// Strands to draw. `saturation` (strand, particle), 0..1, darkens the hair and makes it shine; null: dry.
// `shown` (strand, particle), 0..1, colours it by rainbow_color in place of hair's colour; null: hair.
struct StrandLayer {
    const Strands* strands = nullptr;
    const std::vector<float>* saturation = nullptr;
    Vec3f color{0.38f, 0.235f, 0.14f};  // of dry hair, as displayed
    const std::vector<float>* shown = nullptr;
};

// Perspective. Pixel (column, row) covers [column, column + 1) x [row, row + 1), row 0 at the top.
struct Camera {
    Vec3f eye{0, 0, 1};                                // [m]
    Vec3f right{1, 0, 0}, up{0, 1, 0}, back{0, 0, 1};  // unit; `back` points from the scene to the eye
    float focal = 1000;                                // [pixel]: of one metre seen from one metre away
    int width = 720, height = 900;

    // Column, row [pixel] and distance along the view [m] of a point in front of the eye.
    Vec3f project(const Vec3f& x) const;
};

// A camera that looks at `target` [m] from `eye`, with the vertical field of view in degrees; Y is up.
Camera camera_at(const Vec3f& eye, const Vec3f& target, double field_of_view, int width, int height);

// What a picture must show, gathered over frames and panels: the points [m] that lie outermost in many
// directions.
class Extent {
  public:
    void add(const Strands& strands);
    // A solid counts only where it is not much larger than the strands so far: a floor must not shrink the
    // hair.
    void add(const PosedMesh& solid);
    const std::vector<Vec3f>& outermost() const { return points_; }

  private:
    std::vector<Vec3f> points_;
    float strands_diagonal_ = 0;  // of the largest layer [m]
};

// From where a picture is taken.
struct View {
    double yaw = 30;      // beside the +Z axis [degrees]
    double pitch = 6.88;  // above the horizon [degrees]
    double zoom = 1;      // times as large as what fits
};
// A camera with a margin around all of them and room for a label below.
Camera fitted_camera(const Extent& extent, const View& view, int width, int height);
// The camera as it moves with what was at `from` and is at `to`.
Camera carried(const Camera& camera, const Pose& from, const Pose& to);

struct Panel {
    std::vector<StrandLayer> layers;
    std::vector<PosedMesh> solids;
    // Of the key light, from the camera: to the right of it, and above [degrees].
    double light_yaw = -36.25, light_pitch = 38.87;
};

// One panel without its label. The same bits for any number of threads.
Image draw_panel(const Panel& panel, const Camera& camera);

// Colour of a number in 0..1, from blue (0) through green to red (1).
Vec3f rainbow_color(float share);

// Images of the same height, left to right.
Image side_by_side(const std::vector<Image>& images);

}  // namespace wetcurl

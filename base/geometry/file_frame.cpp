// Units and axes of files.
#include "base/geometry/file_frame.h"

#include <numbers>
#include <stdexcept>

namespace wetcurl {

double metres_of(const std::string& unit) {
    if (unit == "m") return 1;
    if (unit == "cm") return 0.01;
    if (unit == "mm") return 0.001;
    throw std::logic_error("'" + unit + "' is no unit");
}

Vec3d upright(const std::string& up, const Vec3d& x) {
    if (up == "y") return x;
    if (up == "z") return {x.x, x.z, -x.y};
    if (up == "-z") return {x.x, -x.z, x.y};
    if (up == "-y") return {-x.x, -x.y, x.z};
    if (up == "x") return {-x.y, x.x, x.z};
    if (up == "-x") return {x.y, -x.x, x.z};
    throw Misuse("found the up axis '" + up + "', allowed x, -x, y, -y, z, -z");
}

Vec3d laid_along(const std::string& up, const Vec3d& y_up) {
    // upright() is a turn, whose inverse is its transpose.
    return {dot(upright(up, {1, 0, 0}), y_up), dot(upright(up, {0, 1, 0}), y_up),
            dot(upright(up, {0, 0, 1}), y_up)};
}

Quatd rotation_of(const Vec3d& degrees) {
    const double radians = std::numbers::pi / 180;
    return rotation_about({0, 0, 1}, radians * degrees.z) * rotation_about({0, 1, 0}, radians * degrees.y) *
           rotation_about({1, 0, 0}, radians * degrees.x);
}

Vec3d FileFrame::operator()(const Vec3d& x) const {
    return scale * rotate(rotation, upright(up, metres * x)) + offset;
}

bool FileFrame::changes() const {
    return metres != 1 || up != "y" || rotation.w != 1 || scale != 1 || norm(offset) > 0;
}

void FileFrame::place(std::vector<Vec3f>& points) const {
    if (!changes()) return;
    for (auto& x : points) x = cast<float>((*this)(cast<double>(x)));
}

}  // namespace wetcurl

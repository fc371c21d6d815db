// The root codec.
// Eq 14-16.
#include "learn/codec/root_codec.h"

#include <algorithm>
#include <string>

#include "base/error.h"
#include "base/geometry/kernels.h"
#include "base/geometry/neighbor_grid.h"

namespace wetcurl {

void grow(ColourBox& box, const std::vector<Vec3f>& points) {
    bool empty = !(box.diagonal() > 0);
    for (const Vec3f& q : points) {
        const Vec3d p = cast<double>(q);
        if (empty) box.lower = box.upper = p;
        empty = false;
        box.lower = {std::min(box.lower.x, p.x), std::min(box.lower.y, p.y), std::min(box.lower.z, p.z)};
        box.upper = {std::max(box.upper.x, p.x), std::max(box.upper.y, p.y), std::max(box.upper.z, p.z)};
    }
}

std::vector<float> strand_saturation(const Strands& strands, const std::vector<float>& saturation) {
    const int n = strands.particles;
    if (saturation.size() != strands.points.size())
        throw Error("saturation: found " + std::to_string(saturation.size()) +
                    " numbers, allowed one a particle: " + std::to_string(strands.points.size()));
    std::vector<float> out(size_t(strands.count));
    for (int s = 0; s < strands.count; ++s) {
        const Vec3f* p = strands.strand(s);
        const float* sigma = saturation.data() + size_t(s) * n;
        double sum = 0, length = 0;
        for (int i = 0; i + 1 < n; ++i) {
            const double l = norm(p[i + 1] - p[i]);
            sum += l * 0.5 * (sigma[i] + sigma[i + 1]);
            length += l;
        }
        out[size_t(s)] = float(length > 0 ? sum / length : sigma[0]);
    }
    return out;
}

std::vector<Vec3f> shifted_roots(const Strands& strands, const std::vector<float>& saturation, float h,
                                 ShiftUnits units) {
    const int n = strands.particles;
    const float unit = units == ShiftUnits::length ? h * h : 1;
    std::vector<Vec3f> out;
    for (int s = 0; s < strands.count; ++s) out.push_back(strands.at(s, 0));
    if (saturation.empty()) return out;
    const auto sigma = strand_saturation(strands, saturation);
    NeighborGrid grid;
    grid.build(strands.points.data(), strands.points.size(), h);
#pragma omp parallel for schedule(dynamic, 16)
    for (int s = 0; s < strands.count; ++s) {
        const Vec3f p = strands.at(s, 0);
        Vec3f shift{0, 0, 0};
        float sum = kernel_at_zero(h);
        grid.around(p, [&](uint32_t k) {
            const int j = int(grid.order()[k]) / n;
            if (j == s) return;
            const Vec3f r = p - grid.sorted(k);
            shift += sigma[size_t(j)] * kernel_gradient(r, h);
            sum += kernel(norm(r), h);
        });
        out[size_t(s)] += (unit / sum) * shift;
    }
    return out;
}

static int padded(int n) { return (n + 31) / 32 * 32; }

RootImage::RootImage(const RootGrid& grid, int scale)
    : height_(scale * padded((grid.height + scale - 1) / scale)),
      width_(scale * padded((grid.width + scale - 1) / scale)),
      strand_(pixels(), -1) {
    // Breadth first from the pixels that hold a strand: every other one takes the nearest's (in steps).
    std::vector<int> front;
    for (int row = 0; row < grid.height; ++row)
        for (int column = 0; column < grid.width; ++column)
            if (int s = grid.at(column, row); s >= 0) {
                const int pixel = row * width_ + column;
                strand_[size_t(pixel)] = s;
                if (s >= int(pixel_of_.size())) pixel_of_.resize(size_t(s) + 1, -1);
                pixel_of_[size_t(s)] = pixel;
                front.push_back(pixel);
            }
    if (front.empty()) throw Error("geometry image: the root grid holds no strand, allowed 1 or more");
    for (size_t k = 0; k < front.size(); ++k) {
        const int pixel = front[k], row = pixel / width_, column = pixel % width_;
        auto spread = [&](int r, int c) {
            if (r < 0 || c < 0 || r >= height_ || c >= width_ || strand_[size_t(r) * width_ + c] >= 0) return;
            strand_[size_t(r) * width_ + c] = strand_[size_t(pixel)];
            front.push_back(r * width_ + c);
        };
        spread(row - 1, column);
        spread(row + 1, column);
        spread(row, column - 1);
        spread(row, column + 1);
    }
}

std::vector<uint8_t> RootImage::mask() const {
    std::vector<uint8_t> out(pixels(), 0);
    for (int pixel : pixel_of_) out[size_t(pixel)] = 1;
    return out;
}

void RootImage::draw(const std::vector<Vec3f>& colours, float* image) const {
    if (colours.size() != pixel_of_.size())
        throw Error("geometry image: found " + std::to_string(colours.size()) +
                    " colours, allowed one a strand: " + std::to_string(pixel_of_.size()));
    for (size_t k = 0; k < pixels(); ++k) {
        const Vec3f& c = colours[size_t(strand_[k])];
        image[k] = c.x;
        image[pixels() + k] = c.y;
        image[2 * pixels() + k] = c.z;
    }
}

std::vector<Vec3f> RootImage::read(const float* image) const {
    std::vector<Vec3f> out;
    for (int pixel : pixel_of_)
        out.push_back({image[pixel], image[pixels() + pixel], image[2 * pixels() + pixel]});
    return out;
}

}  // namespace wetcurl

// The strand codec.
// Ours.
#include "learn/strand_codec.h"

#include <algorithm>

#include "learn/core_detail.h"
#include "learn/root_grid.h"

namespace wetcurl {

// Means of the n numbers over `saturation_pieces` equal pieces; a piece shorter than a particle takes the one
// it is in.
static void profile(const float* sigma, int n, float* out, size_t stride) {
    for (int k = 0; k < saturation_pieces; ++k) {
        const int first = k * n / saturation_pieces,
                  end = std::max(first + 1, (k + 1) * n / saturation_pieces);
        float sum = 0;
        for (int i = first; i < end; ++i) sum += sigma[i];
        out[size_t(k) * stride] = sum / float(end - first);
    }
}

StrandCodec::StrandCodec(const Groom& high, const Groom& low, const std::vector<float>& saturation,
                         const Strands* shape)
    : grid_(high.grid),
      pixel_of_(pixels_of_strands(high.grid, high.rest.count)),
      dct_(high.rest.particles),
      interpolator_(Interpolation::rest, quad_stencil(high, low), high, low, shape),
      base_(high.rest.count, high.rest.particles) {
    const int n = particles(), strands = high.rest.count;
    if (!saturation.empty() && saturation.size() != high.rest.points.size())
        throw Error("strand codec: found " + std::to_string(saturation.size()) +
                    " saturations, allowed one a particle of the high-resolution groom: " +
                    std::to_string(high.rest.points.size()));
    mask_.assign(pixels(), 0);
    for (int pixel : pixel_of_) mask_[size_t(pixel)] = 1;
    fixed_.assign(size_t(static_channels) * pixels(), 0);
    length_.assign(pixels(), 0);
    const Strands& rest = shape ? *shape : high.rest;
    encode(rest, Pose{}, fixed_.data());
    const auto radius = curl_radii(rest);
    for (int s = 0; s < strands; ++s) {
        const size_t pixel = size_t(pixel_of_[size_t(s)]);
        float* at = fixed_.data() + pixel;
        if (!saturation.empty())
            profile(saturation.data() + size_t(s) * n, n, at + size_t(strand_coefficients) * pixels(),
                    pixels());
        length_[pixel] = float(arc_length(high.rest.strand(s), n));
        at[size_t(static_channels - 2) * pixels()] = length_[pixel];
        at[size_t(static_channels - 1) * pixels()] = radius[size_t(s)];
    }
}

void StrandCodec::dynamic(const Strands& low, const HeadWindow& heads, float* out) {
    interpolator_.apply(low, heads.now, base_);
    encode(base_, heads.now, out);
    const RootFrames& frames = interpolator_.roots();
    float* motion = out + size_t(strand_coefficients) * pixels();
    std::fill_n(motion, size_t(dynamic_channels - strand_coefficients) * pixels(), 0.0f);
    const Vec3f gravity = cast<float>(heads.gravity), turning = cast<float>(heads.angular_velocity());
#pragma omp parallel for schedule(static)
    for (int s = 0; s < frames.count(); ++s) {
        const Quatf to_root = conjugate(frames.rotation_at(s, heads.now));
        const Vec3f pull = cast<float>(heads.acceleration(cast<double>(frames.root[size_t(s)])));
        float* at = motion + pixel_of_[size_t(s)];
        for (const Vec3f& v : {rotate(to_root, gravity), rotate(to_root, turning), rotate(to_root, pull)})
            for (float x : {v.x, v.y, v.z}) {
                *at = x;
                at += pixels();
            }
    }
}

void StrandCodec::encode(const Strands& strands, const Pose& head, float* out) const {
    const int n = particles();
    const RootFrames& frames = interpolator_.roots();
    if (strands.count != frames.count() || strands.particles != n)
        throw Error("strand codec: found " + std::to_string(strands.count) + " strands of " +
                    std::to_string(strands.particles) + " particles, allowed " +
                    std::to_string(frames.count()) + " of " + std::to_string(n));
    std::fill_n(out, size_t(strand_coefficients) * pixels(), 0.0f);
#pragma omp parallel
    {
        std::vector<Vec3f> offset(static_cast<size_t>(n));
        float c[strand_coefficients];
#pragma omp for schedule(static)
        for (int s = 0; s < strands.count; ++s) {
            const Quatf to_root = conjugate(frames.rotation_at(s, head));
            const Vec3f* p = strands.strand(s);
            for (int i = 0; i < n; ++i) offset[size_t(i)] = rotate(to_root, p[i] - p[0]);
            dct_.encode(offset.data(), c);
            float* at = out + pixel_of_[size_t(s)];
            for (int k = 0; k < strand_coefficients; ++k) at[size_t(k) * pixels()] = c[k];
        }
    }
}

void StrandCodec::decode(const float* coefficients, const Pose& head, Strands& out) const {
    const int n = particles();
    const RootFrames& frames = interpolator_.roots();
    if (out.count != frames.count() || out.particles != n) out = Strands(frames.count(), n);
#pragma omp parallel for schedule(static)
    for (int s = 0; s < out.count; ++s) {
        float c[strand_coefficients];
        const float* at = coefficients + pixel_of_[size_t(s)];
        for (int k = 0; k < strand_coefficients; ++k) c[k] = at[size_t(k) * pixels()];
        Vec3f* p = out.strand(s);
        dct_.decode(c, p);
        const Quatf to_world = frames.rotation_at(s, head);
        for (int i = 0; i < n; ++i) p[i] = base_.at(s, i) + rotate(to_world, p[i]);
    }
}

}  // namespace wetcurl

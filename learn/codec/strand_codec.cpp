// The strand codec.
#include "learn/codec/strand_codec.h"

#include <algorithm>

#include "learn/codec/edge_lengths.h"
#include "learn/codec/root_grid.h"

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

// Mean distance of a pixel's root to those of the pixels beside it, 0 where there are none.
static float root_spacing(const Groom& groom, int pixel) {
    const RootGrid& size = groom.grid;
    const int column = pixel % size.width, row = pixel / size.width;
    const Vec3f root = groom.rest.at(groom.grid.at(column, row), 0);
    float sum = 0;
    int count = 0;
    for (auto [c, r] :
         {std::pair{column - 1, row}, {column + 1, row}, {column, row - 1}, {column, row + 1}}) {
        if (c < 0 || r < 0 || c >= size.width || r >= size.height || groom.grid.at(c, r) < 0) continue;
        sum += norm(groom.rest.at(groom.grid.at(c, r), 0) - root);
        ++count;
    }
    return count ? sum / float(count) : 0;
}

StrandCodec::StrandCodec(const Groom& high, const Groom& low, const std::vector<float>& saturation,
                         const Strands* shape, bool low_is_wet, double reach, const Settled* settled)
    : grid_(high.grid),
      pixel_of_(pixels_of_strands(high.grid, high.rest.count)),
      dct_(high.rest.particles),
      roots_(root_frames(high)),
      carrier_(quad_stencil(high, low), high, low, shape, low_is_wet, settled),
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
    edges_.assign(high.rest.points.size(), 0);
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
        for (int i = 1; i < n; ++i)
            edges_[size_t(s) * n + i] = norm(high.rest.at(s, i) - high.rest.at(s, i - 1));
        at += size_t(strand_coefficients + saturation_pieces) * pixels();
        for (float x :
             {length_[pixel], radius[size_t(s)], 0.0f, root_spacing(high, int(pixel)), float(reach)}) {
            *at = x;
            at += pixels();
        }
    }
    constexpr int shared = static_channels - 3;
    for (int twin : carrier_.around().twin)
        fixed_[size_t(shared) * pixels() + size_t(pixel_of_[size_t(twin)])] = 1;
}

void StrandCodec::dynamic(const Strands& low, const HeadWindow& heads, float* out) {
    constexpr int slots = history_lags.back() + 1, modes = 3 * history_modes;
    carrier_.apply(low, heads.now, base_);
    project(base_, out);
    const size_t area = pixels(), strands = size_t(roots_.count());
    float* motion = out + size_t(strand_coefficients) * area;
    std::fill_n(motion, size_t(dynamic_channels - strand_coefficients) * area, 0.0f);
    const bool first = frames_ == 0;
    if (first) past_.resize(size_t(slots) * strands * history_numbers);
    auto past = [&](int lag, size_t s) {
        const size_t slot = size_t((frames_ + slots - lag) % slots);
        return past_.data() + (slot * strands + s) * history_numbers;
    };
    const Vec3f gravity = cast<float>(heads.gravity), turning = cast<float>(heads.angular_velocity());
#pragma omp parallel for schedule(static)
    for (size_t s = 0; s < strands; ++s) {
        const size_t pixel = size_t(pixel_of_[s]);
        const Quatf to_root = conjugate(roots_.rotation_at(int(s), heads.now));
        const Vec3f pull = cast<float>(heads.acceleration(cast<double>(roots_.root[s])));
        float* now = past(0, s);
        for (int m = 0; m < modes; ++m)
            now[m] = out[size_t(m / history_modes * dct_kept + m % history_modes) * area + pixel];
        const Vec3f g = rotate(to_root, gravity), w = rotate(to_root, turning), a = rotate(to_root, pull);
        const float moves[6] = {w.x, w.y, w.z, a.x, a.y, a.z};
        std::copy_n(moves, 6, now + modes);
        if (first)
            for (int lag = 1; lag < slots; ++lag) std::copy_n(now, history_numbers, past(lag, s));
        float* at = motion + pixel;
        auto put = [&](float x) {
            *at = x;
            at += area;
        };
        for (float x : {g.x, g.y, g.z}) put(x);
        for (float x : moves) put(x);
        for (int lag : history_lags) {
            const float* then = past(lag, s);
            for (int m = 0; m < modes; ++m) put(now[m] - then[m]);
            for (int m = modes; m < history_numbers; ++m) put(then[m]);
        }
    }
    ++frames_;
}

Strands StrandCodec::base(const Pose& head) const {
    Strands out;
    place_in_world(roots_, base_, head, out);
    return out;
}

void StrandCodec::project(const Strands& offsets, float* out) const {
    std::fill_n(out, size_t(strand_coefficients) * pixels(), 0.0f);
#pragma omp parallel for schedule(static)
    for (int s = 0; s < offsets.count; ++s) {
        float c[strand_coefficients];
        dct_.encode(offsets.strand(s), c);
        float* at = out + pixel_of_[size_t(s)];
        for (int k = 0; k < strand_coefficients; ++k) at[size_t(k) * pixels()] = c[k];
    }
}

void StrandCodec::encode(const Strands& strands, const Pose& head, float* out) const {
    const int n = particles();
    if (strands.count != roots_.count() || strands.particles != n)
        throw Error("strand codec: found " + std::to_string(strands.count) + " strands of " +
                    std::to_string(strands.particles) + " particles, allowed " +
                    std::to_string(roots_.count()) + " of " + std::to_string(n));
    Strands offsets(strands.count, n);
#pragma omp parallel for schedule(static)
    for (int s = 0; s < strands.count; ++s) {
        const Quatf to_root = conjugate(roots_.rotation_at(s, head));
        const Vec3f* p = strands.strand(s);
        for (int i = 0; i < n; ++i) offsets.at(s, i) = rotate(to_root, p[i] - p[0]);
    }
    project(offsets, out);
}

void StrandCodec::decode(const float* coefficients, const Pose& head, Strands& out) const {
    if (out.count != roots_.count() || out.particles != particles())
        out = Strands(roots_.count(), particles());
    decode(coefficients, head, out.points.data());
}

void StrandCodec::decode(const float* coefficients, const Pose& head, Vec3f* out) const {
    const int n = particles();
#pragma omp parallel for schedule(static)
    for (int s = 0; s < roots_.count(); ++s) {
        float c[strand_coefficients];
        const float* at = coefficients + pixel_of_[size_t(s)];
        for (int k = 0; k < strand_coefficients; ++k) c[k] = at[size_t(k) * pixels()];
        Vec3f* p = out + size_t(s) * n;
        dct_.decode(c, p);
        const Quatf to_world = roots_.rotation_at(s, head);
        const Vec3f root = roots_.root_at(s, head);
        for (int i = 0; i < n; ++i) p[i] = root + rotate(to_world, base_.at(s, i) + p[i]);
    }
}

void StrandCodec::lead_edges(int rounds, Vec3f* strands) const {
    const int n = particles();
#pragma omp parallel
    {
        std::vector<float> room(6 * size_t(n));
#pragma omp for schedule(static)
        for (int s = 0; s < roots_.count(); ++s)
            lead_to_lengths(n, &edges_[size_t(s) * n], rounds, strands + size_t(s) * n, room.data());
    }
}

}  // namespace wetcurl

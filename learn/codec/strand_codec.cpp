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
    auto plane = [&](const Channels& channels) { return fixed_.data() + size_t(channels.first) * pixels(); };
    length_.assign(pixels(), 0);
    edges_.assign(high.rest.points.size(), 0);
    const Strands& rest = shape ? *shape : high.rest;
    encode(rest, Pose{}, plane(static_layout.rest));
    const auto radius = curl_radii(rest);
    for (int s = 0; s < strands; ++s) {
        const size_t pixel = size_t(pixel_of_[size_t(s)]);
        if (!saturation.empty())
            profile(saturation.data() + size_t(s) * n, n, plane(static_layout.saturation) + pixel, pixels());
        length_[pixel] = float(arc_length(high.rest.strand(s), n));
        for (int i = 1; i < n; ++i)
            edges_[size_t(s) * n + i] = norm(high.rest.at(s, i) - high.rest.at(s, i - 1));
        plane(static_layout.length)[pixel] = length_[pixel];
        plane(static_layout.radius)[pixel] = radius[size_t(s)];
        plane(static_layout.spacing)[pixel] = root_spacing(high, int(pixel));
        plane(static_layout.reach)[pixel] = float(reach);
    }
    for (int twin : carrier_.around().twin) plane(static_layout.shared)[size_t(pixel_of_[size_t(twin)])] = 1;
}

void StrandCodec::dynamic(const Strands& low, const HeadWindow& heads, float* out) {
    constexpr int slots = history_lags.back() + 1;
    constexpr Channels change = past_layout.change;
    const size_t area = pixels(), strands = size_t(roots_.count()), numbers = size_t(past_layout.count);
    carrier_.apply(low, heads.now, base_);
    project(base_, out);
    std::fill(out + size_t(dynamic_layout.base.end()) * area, out + size_t(dynamic_channels) * area, 0.0f);
    const bool first = frames_ == 0;
    if (first) past_.resize(size_t(slots) * strands * numbers);
    auto past = [&](int lag, size_t s) {
        const size_t slot = size_t((frames_ + slots - lag) % slots);
        return past_.data() + (slot * strands + s) * numbers;
    };
    const Vec3f gravity = cast<float>(heads.gravity), turning = cast<float>(heads.angular_velocity());
#pragma omp parallel for schedule(static)
    for (size_t s = 0; s < strands; ++s) {
        const size_t pixel = size_t(pixel_of_[s]);
        auto at = [&](int channel) -> float& { return out[size_t(channel) * area + pixel]; };
        auto put = [&](const Channels& to, const Vec3f& v) {
            at(to.first) = v.x, at(to.first + 1) = v.y, at(to.first + 2) = v.z;
        };
        const Quatf to_root = conjugate(roots_.rotation_at(int(s), heads.now));
        const Vec3f pull = cast<float>(heads.acceleration(cast<double>(roots_.root[s])));
        put(dynamic_layout.gravity, rotate(to_root, gravity));
        put(dynamic_layout.turning, rotate(to_root, turning));
        put(dynamic_layout.acceleration, rotate(to_root, pull));

        float* now = past(0, s);
        for (int m = 0; m < change.count; ++m)
            now[change.first + m] = at(dynamic_layout.base.first + history_amplitude(m));
        for (int axis = 0; axis < 3; ++axis) {
            now[past_layout.turning.first + axis] = at(dynamic_layout.turning.first + axis);
            now[past_layout.acceleration.first + axis] = at(dynamic_layout.acceleration.first + axis);
        }
        if (first)
            for (int lag = 1; lag < slots; ++lag) std::copy_n(now, numbers, past(lag, s));
        for (size_t l = 0; l < history_lags.size(); ++l) {
            const float* then = past(history_lags[l], s);
            const int to = dynamic_layout.past(int(l)).first;
            for (int k = 0; k < past_layout.count; ++k)
                at(to + k) = change.holds(k) ? now[k] - then[k] : then[k];
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

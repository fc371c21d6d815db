// The strand codec.
#include "learn/codec/strand_codec.h"

#include <algorithm>
#include <cmath>
#include <cstring>

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

// Root mean square distance of the roots from their middle [m].
static double scalp_size(const Strands& rest) {
    Vec3d sum{0, 0, 0};
    double squares = 0;
    for (int s = 0; s < rest.count; ++s) {
        const Vec3d x = cast<double>(rest.at(s, 0));
        sum += x, squares += dot(x, x);
    }
    const Vec3d mean = (1.0 / rest.count) * sum;
    return std::sqrt(std::max(0.0, squares / rest.count - dot(mean, mean)));
}

// The channels `guides` of a strand, in metres where they are lengths.
static std::array<float, static_layout.guides.count> guides_around(int s, const Groom& high, const Groom& low,
                                                                   const Strands& cores,
                                                                   const Strands& low_cores,
                                                                   const Stencil& around) {
    float roots = 0, squares = 0, heaviest = 0, spacing = 0;
    for (size_t k = size_t(s) * around.width; k < size_t(s + 1) * around.width; ++k) {
        const int from = around.from[k];
        const float weight = around.weight[k];
        roots += weight * norm(low.rest.at(from, 0) - high.rest.at(s, 0));
        squares += weight * square_apart(cores.strand(s), low_cores.strand(from), high.rest.particles);
        heaviest = std::max(heaviest, weight);
        float sum = 0;
        int count = 0;
        for (int beside : around.beside[size_t(from)].strand)
            if (beside >= 0) sum += norm(low.rest.at(beside, 0) - low.rest.at(from, 0)), ++count;
        if (count) spacing += weight * sum / float(count);
    }
    return {roots, std::sqrt(squares), heaviest, spacing};
}

std::array<int, history_lags.size()> lags_in_frames(double fps) {
    std::array<int, history_lags.size()> out{};
    for (size_t l = 0; l < out.size(); ++l)
        out[l] = std::max(1, int(std::lround(history_lags[l] * fps / history_fps)));
    return out;
}

int averaged_frames(double fps) { return 1 + int(std::lround(fps / history_fps)); }

StrandCodec::StrandCodec(const Groom& high, const Groom& low, const std::vector<float>& saturation,
                         const Strands* shape, bool low_is_wet, const HairTraits& traits,
                         const Settled* settled)
    : grid_(high.grid),
      pixel_of_(pixels_of_strands(high.grid, high.rest.count)),
      lags_(lags_in_frames(traits.fps)),
      averaged_(averaged_frames(traits.fps)),
      dct_(high.rest.particles),
      roots_(root_frames(high)),
      carrier_(RootLanes(StrandLanes::on_grid(high.grid, high.rest.count), roots_),
               surrounding_stencil(high, low), high, low, shape, low_is_wet, settled),
      base_(size_t(lanes().blocks()) * high.rest.particles) {
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
    const size_t blocks = size_t(lanes().blocks());
    block_length_.assign(blocks, S(0)), per_length_ = swing_ = block_length_;
    for (int s = 0; s < strands; ++s) {
        const float length = std::max(float(arc_length(high.rest.strand(s), n)), tiny_length<float>);
        length_[size_t(pixel_of_[size_t(s)])] = length;
        const int place = lanes().place_of(s), lane = place % S::lanes;
        const size_t block = size_t(place / S::lanes);
        block_length_[block].set(lane, length);
        per_length_[block].set(lane, per_length(s)), swing_[block].set(lane, swing(s));
        for (int i = 1; i < n; ++i)
            edges_[size_t(s) * n + i] = norm(high.rest.at(s, i) - high.rest.at(s, i - 1));
    }
    block_edges_.resize(base_.size());
    for (int block = 0; block < lanes().blocks(); ++block)
        lanes().load(block, n, edges_.data(), &block_edges_[size_t(block) * n]);

    const Strands& rest = shape ? *shape : high.rest;
    encode(rest, Pose{}, plane(static_layout.rest));
    const auto radius = curl_radii(rest);
    const Strands cores = cores_of(high.rest), low_cores = cores_of(low.rest);
    const float scalp = float(scalp_size(high.rest));
    for (int s = 0; s < strands; ++s) {
        const size_t pixel = size_t(pixel_of_[size_t(s)]);
        const float per = per_length(s), T = swing(s);
        auto put = [&](const Channels& to, int k, float value) {
            plane(to)[size_t(k) * pixels() + pixel] = value;
        };
        if (!saturation.empty())
            profile(saturation.data() + size_t(s) * n, n, plane(static_layout.saturation) + pixel, pixels());
        put(static_layout.radius, 0, per * radius[size_t(s)]);
        put(static_layout.scalp, 0, per * scalp);
        put(static_layout.spacing, 0, per * root_spacing(high, int(pixel)));
        put(static_layout.reach, 0, per * float(traits.reach));
        const auto [roots, apart, heaviest, beside] =
            guides_around(s, high, low, cores, low_cores, carrier_.around());
        put(static_layout.guides, 0, per * roots), put(static_layout.guides, 1, per * apart);
        put(static_layout.guides, 2, heaviest), put(static_layout.guides, 3, per * beside);
        const auto ratio = [](double a, double b) { return a > 0 && b > 0 ? a / b : 1.0; };
        const double cube = std::pow(double(per), 3);
        put(static_layout.fibre, 0,
            float(std::log(ratio(traits.rigidity * cube, traits.density * double(standard_gravity)))));
        put(static_layout.fibre, 1, float(std::log(ratio(traits.wet_rigidity, traits.rigidity))));
        put(static_layout.fibre, 2, float(ratio(traits.wet_density, traits.density)));
        put(static_layout.fibre, 3, T * float(traits.drag));
        put(static_layout.fibre, 4, T * float(traits.wet_drag));
        put(static_layout.fibre, 5, float(traits.low_step) / T);
    }
}

void StrandCodec::begin(const HeadWindow& heads) {
    if (frames_ == 0) past_.resize(size_t(slots()) * lanes().blocks() * past_layout.count);
    const int slot = (head_.slot + 1) % slots();
    head_ = HeadState(heads, frames_ == 0);
    head_.slot = slot, pose_ = heads.now;
    ++frames_;
}

void StrandCodec::describe(int block, S* out) {
    Vec3<S>* const base = &base_[size_t(block) * particles()];
    S* const doubt = out + dynamic_layout.doubt.first;
    carrier_.carry(block, base, doubt);
    const S per = per_length_[size_t(block)], T = swing_[size_t(block)];
    dct_.encode(base, out + dynamic_layout.base.first);
    for (int m = 0; m < dynamic_layout.base.count; ++m) out[dynamic_layout.base.first + m] *= per;

    const Quat<S> to_root = conjugate(lanes().rotation(block));
    const Vec3<S>& root = lanes().root(block);
    const S per_gravity = lanes().holds(block) * S(1 / standard_gravity);
    auto put = [&](const Channels& to, const S& unit, const Vec3<S>& v) {
        const Vec3<S> turned = unit * rotate(to_root, v);
        out[to.first] = turned.x, out[to.first + 1] = turned.y, out[to.first + 2] = turned.z;
    };
    put(dynamic_layout.gravity, per_gravity, cast<S>(head_.gravity));
    put(dynamic_layout.turning, T, cast<S>(head_.turning));
    put(dynamic_layout.acceleration, per_gravity,
        cast<S>(head_.pull) + root.x * cast<S>(head_.pull_x[0]) + root.y * cast<S>(head_.pull_x[1]) +
            root.z * cast<S>(head_.pull_x[2]));

    constexpr Channels change = past_layout.change;
    auto past = [&](int lag) {
        const size_t slot = size_t((head_.slot + slots() - lag) % slots());
        return past_.data() + (slot * size_t(lanes().blocks()) + size_t(block)) * past_layout.count;
    };
    S* const now = past(0);
    for (int m = 0; m < change.count; ++m)
        now[change.first + m] = out[dynamic_layout.base.first + history_amplitude(m)];
    for (int axis = 0; axis < 3; ++axis) {
        now[past_layout.turning.first + axis] = out[dynamic_layout.turning.first + axis];
        now[past_layout.acceleration.first + axis] = out[dynamic_layout.acceleration.first + axis];
    }
    if (head_.first)
        for (int lag = 1; lag < slots(); ++lag) std::copy_n(now, past_layout.count, past(lag));
    for (size_t l = 0; l < lags_.size(); ++l) {
        const S* then = past(lags_[l]);
        S* const to = out + dynamic_layout.past(int(l)).first;
        for (int k = 0; k < past_layout.count; ++k) to[k] = change.holds(k) ? now[k] - then[k] : then[k];
    }
}

void StrandCodec::place(int block, const S* answer, int rounds, const Pose& head, Vec3<S>* out) const {
    const int n = particles();
    const Vec3<S>* const base = &base_[size_t(block) * n];
    if (answer) {
        const S length = block_length_[size_t(block)];
        dct_.decode(answer, out);
        for (int i = 0; i < n; ++i) out[i] = base[i] + length * out[i];
    } else {
        std::copy_n(base, n, out);
    }
    lead_to_lengths(n, &block_edges_[size_t(block) * n], rounds, out);
    const Quat<S> to_world = lanes().rotation_at(block, head);
    const Vec3<S> root = lanes().root_at(block, head);
    for (int i = 0; i < n; ++i) out[i] = root + rotate(to_world, out[i]);
}

namespace {

// f(channel, first pixel, count) of a block's part of an image of so many channels.
template <class F>
void for_each_row_part(const RootGrid& grid, int block, int channels, F f) {
    constexpr int lanes = StrandLanes::lanes;
    const int blocks = (grid.width + lanes - 1) / lanes, row = block / blocks,
              column = block % blocks * lanes, count = std::min(lanes, grid.width - column);
    const size_t area = size_t(grid.height) * grid.width;
    for (int channel = 0; channel < channels; ++channel)
        f(channel, size_t(channel) * area + size_t(row) * grid.width + size_t(column), size_t(count));
}

}  // namespace

void StrandCodec::read_image(int block, int channels, const float* image, S* out) const {
    for_each_row_part(grid_, block, channels, [&](int channel, size_t first, size_t count) {
        out[channel] = S(0);
        std::memcpy(&out[channel], image + first, count * sizeof(float));
    });
}

void StrandCodec::write_image(int block, int channels, const S* numbers, float* image) const {
    for_each_row_part(grid_, block, channels, [&](int channel, size_t first, size_t count) {
        std::memcpy(image + first, &numbers[channel], count * sizeof(float));
    });
}

void StrandCodec::dynamic(const Strands& low, const HeadWindow& heads, float* out) {
    if (low.count != low_strands() || low.particles != particles())
        throw Error("strand codec: found " + std::to_string(low.count) + " low-resolution strands of " +
                    std::to_string(low.particles) + " particles, allowed " + std::to_string(low_strands()) +
                    " of " + std::to_string(particles()));
    begin(heads);
#pragma omp parallel
    {
        follow(low.points.data());
#pragma omp for schedule(static)
        for (int block = 0; block < lanes().blocks(); ++block) {
            S numbers[dynamic_channels];
            describe(block, numbers);
            write_image(block, dynamic_channels, numbers, out);
        }
    }
}

Strands StrandCodec::base(const Pose& head, int rounds) const {
    Strands out(roots_.count(), particles());
    decode(nullptr, head, out, rounds);
    return out;
}

void StrandCodec::encode(const Strands& strands, const Pose& head, float* out) const {
    const int n = particles();
    if (strands.count != roots_.count() || strands.particles != n)
        throw Error("strand codec: found " + std::to_string(strands.count) + " strands of " +
                    std::to_string(strands.particles) + " particles, allowed " +
                    std::to_string(roots_.count()) + " of " + std::to_string(n));
#pragma omp parallel
    {
        std::vector<Vec3<S>> offsets(size_t(n), Vec3<S>{});
#pragma omp for schedule(static)
        for (int block = 0; block < lanes().blocks(); ++block) {
            lanes().load(block, 3 * n, &strands.points.data()->x, &offsets[0].x);
            const Quat<S> to_root = conjugate(lanes().rotation_at(block, head));
            const Vec3<S> root = offsets[0];
            for (Vec3<S>& x : offsets) x = rotate(to_root, x - root);
            S numbers[strand_coefficients];
            dct_.encode(offsets.data(), numbers);
            for (S& number : numbers) number *= per_length_[size_t(block)];
            write_image(block, strand_coefficients, numbers, out);
        }
    }
}

void StrandCodec::decode(const float* coefficients, const Pose& head, Strands& out, int rounds) const {
    if (out.count != roots_.count() || out.particles != particles())
        out = Strands(roots_.count(), particles());
    decode(coefficients, head, out.points.data(), rounds);
}

void StrandCodec::decode(const float* coefficients, const Pose& head, Vec3f* out, int rounds) const {
    const int n = particles();
#pragma omp parallel
    {
        std::vector<Vec3<S>> points(size_t(n), Vec3<S>{});
#pragma omp for schedule(static)
        for (int block = 0; block < lanes().blocks(); ++block) {
            S answer[strand_coefficients];
            if (coefficients) read_image(block, strand_coefficients, coefficients, answer);
            place(block, coefficients ? answer : nullptr, rounds, head, points.data());
            lanes().store(block, 3 * n, &points[0].x, &out->x);
        }
    }
}

}  // namespace wetcurl

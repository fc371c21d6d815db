// The strand codec on a CUDA device.
// Ours.
#include <algorithm>

#include "learn/strand_kernels.h"

namespace wetcurl {

namespace {

constexpr int threads = 128, tile = 32, tile_rows = 4, rest_numbers = 13;
constexpr int slots = history_lags.back() + 1, modes = 3 * history_modes;

unsigned blocks_of(int count, int size = threads) { return unsigned((count + size - 1) / size); }

void check_launch(const char* what) { check_cuda(cudaGetLastError(), what); }

__global__ void depart_kernel(const HeadState* head, const Vec3f* p, const float* share, const Vec3f* rest,
                              int low, int n, float* x) {
    const int k = int(blockIdx.x) * threads + int(threadIdx.x);
    if (k >= low * n) return;
    const int s = k % low, i = k / low;
    const size_t at = size_t(s) * n;
    const Vec3f d = share[s] * rotate(conjugate(head->rotation), p[at + i] - p[at]) - rest[at + i];
    const size_t plane = size_t(n) * low;
    x[k] = d.x, x[plane + k] = d.y, x[2 * plane + k] = d.z;
}

constexpr int lost_strands = 32, lost_parts = 8;

// What low-resolution strands have lost of their own; a block takes some, in parts.
__global__ void lost_kernel(int low, int n, const Beside* __restrict__ beside, const float* __restrict__ own,
                            const float* __restrict__ moved, float* __restrict__ lost) {
    __shared__ float part[lost_parts][lost_strands];
    const int s = int(blockIdx.x) * lost_strands + int(threadIdx.x), p = int(threadIdx.y);
    const size_t plane = size_t(n) * low;
    float sum = 0;
    if (s < low) {
        const Beside near = beside[s];
        for (int i = p; i + 1 < n; i += lost_parts) {
            const size_t at = size_t(i) * low;
            const float *from = moved + at, *to = from + low;
            sum += lost_of_edge({own[at + s], own[plane + at + s], own[2 * plane + at + s]}, s, near,
                                [&](int k) {
                                    return Vec3f{to[k] - from[k], to[plane + k] - from[plane + k],
                                                 to[2 * plane + k] - from[2 * plane + k]};
                                });
        }
    }
    part[p][threadIdx.x] = sum;
    __syncthreads();
    if (p > 0 || s >= low) return;
    for (int k = 1; k < lost_parts; ++k) sum += part[k][threadIdx.x];
    lost[s] = sum;
}

constexpr int carriers = 64;

// A strand goes along its particles one by one: what the next one needs is on its way meanwhile.
__global__ void carry_kernel(int pixels, int low, int n, int width, const int* __restrict__ strand,
                             const float* __restrict__ rest, const int* __restrict__ from,
                             const float* __restrict__ weight, const float* __restrict__ lost_weight,
                             const float* __restrict__ lost, const Quatf* __restrict__ turn,
                             const float* __restrict__ moved, float* __restrict__ base) {
    constexpr int most = 4;  // of a stencil
    const int s = int(blockIdx.x) * carriers + int(threadIdx.x);
    if (s >= pixels || strand[s] < 0) return;
    int neighbour[most];
    float share[most], lost_here = 0;
    for (int k = 0; k < most; ++k) {
        neighbour[k] = k < width ? from[k * pixels + s] : 0;
        share[k] = k < width ? weight[k * pixels + s] : 0;
        if (k < width) lost_here += lost_weight[k * pixels + s] * lost[neighbour[k]];
    }
    const Quatf to_root = conjugate(turn[s]);
    const size_t plane = size_t(n) * low, out = size_t(n) * pixels;
    struct Rest {
        float number[rest_numbers];
    };
    struct Moved {
        Vec3f of[most];
    };
    const auto rest_of = [&](int i) {
        Rest out;
        const float* r = rest + size_t(min(i, n - 1)) * rest_numbers * pixels + s;
#pragma unroll
        for (int k = 0; k < rest_numbers; ++k) out.number[k] = r[size_t(k) * pixels];
        return out;
    };
    const auto moved_of = [&](int i) {
        Moved out;
        const float* m = moved + size_t(min(i, n - 1)) * low;
#pragma unroll
        for (int k = 0; k < most; ++k)
            out.of[k] = {m[neighbour[k]], m[plane + neighbour[k]], m[2 * plane + neighbour[k]]};
        return out;
    };
    Rest next_rest = rest_of(0);
    Moved next_moved = moved_of(0);
    carry_rest<float>(
        n, fminf(fmaxf(lost_here, 0), 1),
        [&](int i) {
            const Rest r = next_rest;
            next_rest = rest_of(i + 1);
            return RestParticle<float>{{r.number[0], r.number[1], r.number[2]},
                                       r.number[3],
                                       {r.number[4], r.number[5], r.number[6]},
                                       {r.number[7], r.number[8], r.number[9]},
                                       {r.number[10], r.number[11], r.number[12]}};
        },
        [&](int i) {
            const Moved m = next_moved;
            next_moved = moved_of(i + 1);
            Vec3f sum{0, 0, 0};
#pragma unroll
            for (int k = 0; k < most; ++k) sum += share[k] * m.of[k];
            return rotate(to_root, sum);
        },
        [&](int i, const Vec3f& x) {
            const size_t at = size_t(i) * pixels + s;
            base[at] = x.x, base[out + at] = x.y, base[2 * out + at] = x.z;
        });
}

// Wet low-resolution strands are their twins' base as they are.
__global__ void keep_kernel(int pixels, int low, int n, const int* twin, const Quatf* turn, const Vec3f* rest,
                            const float* departed, float* base) {
    const int k = int(blockIdx.x) * threads + int(threadIdx.x);
    if (k >= low * n) return;
    const int s = k % low, i = k / low, pixel = twin[s];
    const size_t plane = size_t(n) * low, out = size_t(n) * pixels, at = size_t(i) * pixels + pixel;
    const Vec3f d{departed[k], departed[plane + k], departed[2 * plane + k]};
    const Vec3f x = rotate(conjugate(turn[pixel]), rest[size_t(s) * n + i] + d);
    base[at] = x.x, base[out + at] = x.y, base[2 * out + at] = x.z;
}

__global__ void describe_kernel(const HeadState* head, int pixels, const int* strand, const Quatf* turn,
                                const Vec3f* root, float* past, float* dynamic) {
    const int s = int(blockIdx.x) * threads + int(threadIdx.x);
    if (s >= pixels || strand[s] < 0) return;
    const Quatf to_root = conjugate(turn[s]);
    const Vec3f x = root[s];
    const Vec3f g = rotate(to_root, head->gravity), w = rotate(to_root, head->turning),
                a = rotate(to_root, head->pull + x.x * head->pull_x[0] + x.y * head->pull_x[1] +
                                        x.z * head->pull_x[2]);
    const float moves[6] = {w.x, w.y, w.z, a.x, a.y, a.z};
    float* at = dynamic + size_t(strand_coefficients) * pixels + s;
    auto put = [&](float value) {
        *at = value;
        at += pixels;
    };
    put(g.x), put(g.y), put(g.z);
    for (float m : moves) put(m);
    // A ring of the last frames: `slot` holds this one.
    auto then = [&](int slot, int m) -> float& {
        return past[(size_t(slot) * history_numbers + m) * pixels + s];
    };
    for (int m = 0; m < history_numbers; ++m) {
        const float now = m < modes
                              ? dynamic[size_t(m / history_modes * dct_kept + m % history_modes) * pixels + s]
                              : moves[m - modes];
        for (int k = 0; head->first && k < slots; ++k) then(k, m) = now;
        then(head->slot, m) = now;
        constexpr int lags[] = {history_lags[0], history_lags[1], history_lags[2], history_lags[3]};
        static_assert(sizeof lags / sizeof lags[0] == history_lags.size());
        for (int l = 0; l < int(sizeof lags / sizeof lags[0]); ++l) {
            const float before = then((head->slot + slots - lags[l]) % slots, m);
            const int channel = strand_coefficients + motion_channels + l * history_numbers + m;
            dynamic[size_t(channel) * pixels + s] = m < modes ? now - before : before;
        }
    }
}

// A block: `tile` strands of a row of the grid by `tile` particles, turned over in shared memory so that both
// sides are read and written in order. `offsets` (n, 24): of unit amplitudes.
__global__ void __launch_bounds__(tile* tile_rows)
    place_kernel(const HeadState* head, int pixels, int n, const int* strand, const Quatf* turn,
                 const Vec3f* root, const float* base, const float* offsets, const float* answer,
                 const ShapeView* shapes, int shape_count, const float* depth, Vec3f* out) {
    __shared__ float near[tile][3 * tile + 1];
    __shared__ float rise[tile][dct_kept];
    const int first = int(blockIdx.x) * tile, s = first + int(threadIdx.x), begin = int(blockIdx.y) * tile;
    const size_t plane = size_t(n) * pixels;
    for (int k = int(threadIdx.y) * tile + int(threadIdx.x); k < tile * dct_kept; k += tile * tile_rows)
        rise[k / dct_kept][k % dct_kept] = begin + k / dct_kept < n ? offsets[begin * dct_kept + k] : 0;
    __syncthreads();
    if (s < pixels && strand[s] >= 0) {
        const Quatf to_head = turn[s];
        float amplitude[strand_coefficients] = {};
        if (answer)
#pragma unroll
            for (int k = 0; k < strand_coefficients; ++k)
                amplitude[k] = answer[size_t(s) * strand_coefficients + k];
        for (int i = int(threadIdx.y); i < tile && begin + i < n; i += tile_rows) {
            const size_t k = size_t(begin + i) * pixels + s;
            Vec3f offset{0, 0, 0};
#pragma unroll
            for (int m = 0; m < dct_kept; ++m)
                offset +=
                    rise[i][m] * Vec3f{amplitude[m], amplitude[dct_kept + m], amplitude[2 * dct_kept + m]};
            offset += Vec3f{base[k], base[plane + k], base[2 * plane + k]};
            Vec3f x = root[s] + rotate(to_head, offset);
            for (int h = 0; h < shape_count && begin + i > 0; ++h)
                x = pushed_out(x, distance(shapes[h], x), depth[k]);
            const Vec3f p = head->translation + rotate(head->rotation, x);
            float* to = &near[threadIdx.x][3 * i];
            to[0] = p.x, to[1] = p.y, to[2] = p.z;
        }
    }
    __syncthreads();
    const int floats = 3 * (n - begin < tile ? n - begin : tile);
    for (int row = int(threadIdx.y); row < tile && first + row < pixels; row += tile_rows) {
        const int to = strand[first + row];
        if (to < 0) continue;
        float* p = &out[size_t(to) * n + begin].x;
        for (int k = int(threadIdx.x); k < floats; k += tile) p[k] = near[row][k];
    }
}

}  // namespace

HeadState::HeadState(const HeadWindow& heads, bool first)
    : rotation(cast<float>(heads.now.rotation)),
      translation(cast<float>(heads.now.translation)),
      first(first) {
    const Quatd to_head = conjugate(heads.now.rotation);
    auto in_head = [&](const Vec3d& v) { return cast<float>(rotate(to_head, v)); };
    gravity = in_head(heads.gravity), turning = in_head(heads.angular_velocity());
    const Vec3d at_origin = heads.acceleration({0, 0, 0});
    pull = in_head(at_origin);
    const Vec3d axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int a = 0; a < 3; ++a) pull_x[a] = in_head(heads.acceleration(axes[a]) - at_origin);
}

StrandKernels::StrandKernels(const StrandCodec& codec, const Groom& low)
    : n_(codec.particles()),
      low_(low.rest.count),
      high_(codec.roots().count()),
      pixels_(int(codec.pixels())),
      width_(codec.carrier().around().width),
      low_is_wet_(codec.carrier().low_is_wet()) {
    const size_t n = size_t(n_), S = size_t(pixels_), width = size_t(width_);
    head() = {};
    const RestCarrier& carrier = codec.carrier();
    std::vector<Vec3f> low_rest(low.rest.points);
    for (int s = 0; s < low_; ++s)
        for (int i = n_ - 1; i >= 0; --i) low_rest[size_t(s) * n + i] = low.rest.at(s, i) - low.rest.at(s, 0);
    if (low_is_wet_) low_rest_ = DeviceBuffer<Vec3f>(low_rest);
    const Settled& settled = carrier.settled();
    for (size_t k = 0; k < settled.more.points.size(); ++k) low_rest[k] -= settled.more.points[k];
    share_ = DeviceBuffer<float>(settled.share.empty() ? std::vector<float>(size_t(low_), 1) : settled.share);
    low_start_ = DeviceBuffer<Vec3f>(low_rest);

    const Stencil& around = carrier.around();
    std::vector<float> rest(n * rest_numbers * S, 0), weight(width * S, 0), lost_weight(width * S, 0);
    std::vector<int> from(width * S, 0), strand(S, -1);
    std::vector<Quatf> turn(S, Quatf::identity());
    std::vector<Vec3f> root(S, Vec3f{0, 0, 0});
    for (size_t s = 0; s < size_t(high_); ++s) {
        const size_t pixel = size_t(codec.pixel_of()[s]);
        strand[pixel] = int(s), turn[pixel] = codec.roots().rotation[s], root[pixel] = codec.roots().root[s];
        for (size_t k = 0; k < width; ++k) {
            from[k * S + pixel] = around.from[s * width + k];
            weight[k * S + pixel] = around.weight[s * width + k];
            lost_weight[k * S + pixel] = carrier.lost_weight()[s * width + k];
        }
        for (size_t i = 0; i < n; ++i) {
            const RestParticle<float> p = carrier.rest(int(s), int(i));
            const float numbers[rest_numbers] = {p.edge.x,   p.edge.y,   p.edge.z,   p.length,   p.curled.x,
                                                 p.curled.y, p.curled.z, p.detail.x, p.detail.y, p.detail.z,
                                                 p.own.x,    p.own.y,    p.own.z};
            for (size_t k = 0; k < rest_numbers; ++k) rest[(i * rest_numbers + k) * S + pixel] = numbers[k];
        }
    }
    std::vector<int> twin;
    for (int s : around.twin) twin.push_back(codec.pixel_of()[size_t(s)]);
    twin_ = DeviceBuffer<int>(twin);
    rest_ = DeviceBuffer<float>(rest), weight_ = DeviceBuffer<float>(weight);
    lost_weight_ = DeviceBuffer<float>(lost_weight), beside_ = DeviceBuffer<Beside>(carrier.beside());
    const size_t own_plane = n * size_t(low_);
    std::vector<float> own(3 * own_plane);
    for (size_t s = 0; s < size_t(low_); ++s)
        for (size_t i = 0; i < n; ++i) {
            const Vec3f& e = carrier.own().at(int(s), int(i));
            float* at = own.data() + i * size_t(low_) + s;
            at[0] = e.x, at[own_plane] = e.y, at[2 * own_plane] = e.z;
        }
    own_ = DeviceBuffer<float>(own), lost_ = DeviceBuffer<float>(size_t(low_));
    from_ = DeviceBuffer<int>(from), strand_ = DeviceBuffer<int>(strand);
    turn_ = DeviceBuffer<Quatf>(turn), root_ = DeviceBuffer<Vec3f>(root);
    past_ = DeviceBuffer<float>(size_t(slots) * history_numbers * S);

    // What unit strands give, column by column.
    std::vector<float> cores(n * n, 0), amplitudes(dct_kept * n, 0), offsets(n * dct_kept, 0);
    for (size_t j = 0; j < n; ++j) {
        std::vector<Vec3f> unit(n, Vec3f{0, 0, 0}), core(n);
        unit[j].x = 1;
        if (j > 0) {  // X is 0 at the root
            core_of(unit.data(), n_, core_beta(n_), core.data());
            for (size_t i = 0; i < n; ++i) cores[i * n + j] = core[i].x;
        }
        float c[strand_coefficients];
        codec.dct().encode(unit.data(), c);
        for (size_t k = 0; k < dct_kept; ++k) amplitudes[k * n + j] = c[k];
    }
    for (size_t k = 0; k < dct_kept; ++k) {
        std::vector<Vec3f> rise(n);
        float c[strand_coefficients] = {};
        c[k] = 1;
        codec.dct().decode(c, rise.data());
        for (size_t i = 0; i < n; ++i) offsets[i * dct_kept + k] = rise[i].x;
    }
    cores_ = DeviceBuffer<float>(cores), amplitudes_ = DeviceBuffer<float>(amplitudes);
    offsets_ = DeviceBuffer<float>(offsets);
    departed_ = DeviceBuffer<float>(3 * n * size_t(low_)), moved_ = DeviceBuffer<float>(3 * n * size_t(low_));
    base_ = DeviceBuffer<float>(std::vector<float>(3 * n * S, 0));
    std::vector<float> image(size_t(static_channels + dynamic_channels) * S, 0);
    std::copy(codec.fixed().begin(), codec.fixed().end(), image.begin());
    image_ = DeviceBuffer<float>(image);
}

void StrandKernels::keep_outside(const HeadShapes& head) {
    require_depths(head, size_t(high_) * n_);
    grids_.clear();
    std::vector<ShapeView> shapes;
    for (const Shape& shape : head.shapes) {
        ShapeView& view = shapes.emplace_back(view_of(shape));
        if (view.kind != ShapeView::Kind::grid) continue;
        DistanceGrid& grid = view.grid;
        const size_t nodes = size_t(grid.nx) * grid.ny * grid.nz;
        grids_.emplace_back(std::vector<float>(grid.phi, grid.phi + nodes));
        grid.phi = grids_.back().data();
    }
    shapes_ = DeviceBuffer<ShapeView>(shapes);
    std::vector<int> strand(size_t(pixels_), -1);
    strand_.download(strand.data());
    std::vector<float> depth(size_t(n_) * pixels_, 0);
    for (int i = 0; i < n_; ++i)
        for (int s = 0; s < pixels_; ++s)
            if (strand[size_t(s)] >= 0)
                depth[size_t(i) * pixels_ + s] = head.depth[size_t(strand[size_t(s)]) * n_ + i];
    depth_ = DeviceBuffer<float>(depth);
}

void StrandKernels::begin_frame(const HeadWindow& heads, bool first) {
    const int slot = (head().slot + 1) % slots;
    head() = HeadState(heads, first);
    head().slot = slot;
}

void StrandKernels::take_head(cudaStream_t stream) const {
    check_cuda(
        cudaMemcpyAsync(head_.data(), head_host_.data(), sizeof(HeadState), cudaMemcpyHostToDevice, stream),
        "the head's motion");
}

void StrandKernels::depart(const Vec3f* low, cudaStream_t stream) const {
    depart_kernel<<<blocks_of(low_ * n_), threads, 0, stream>>>(
        head_.data(), low, share_.data(), low_start_.data(), low_, n_, departed_.data());
    check_launch("departure from rest");
}

void StrandKernels::carry(cudaStream_t stream) const {
    lost_kernel<<<blocks_of(low_, lost_strands), dim3(lost_strands, lost_parts), 0, stream>>>(
        low_, n_, beside_.data(), own_.data(), moved_.data(), lost_.data());
    check_launch("what strands lose of their own");
    carry_kernel<<<blocks_of(pixels_, carriers), carriers, 0, stream>>>(
        pixels_, low_, n_, width_, strand_.data(), rest_.data(), from_.data(), weight_.data(),
        lost_weight_.data(), lost_.data(), turn_.data(), moved_.data(), base_.data());
    check_launch("rest shapes carried");
    if (!low_is_wet_) return;
    keep_kernel<<<blocks_of(low_ * n_), threads, 0, stream>>>(
        pixels_, low_, n_, twin_.data(), turn_.data(), low_rest_.data(), departed_.data(), base_.data());
    check_launch("wet strands kept");
}

void StrandKernels::describe(cudaStream_t stream) const {
    describe_kernel<<<blocks_of(pixels_), threads, 0, stream>>>(
        head_.data(), pixels_, strand_.data(), turn_.data(), root_.data(), past_.data(),
        image_.data() + size_t(static_channels) * pixels_);
    check_launch("features of motion");
}

void StrandKernels::place(const float* answer, Vec3f* out, cudaStream_t stream, bool within_shapes) const {
    const dim3 blocks(unsigned((pixels_ + tile - 1) / tile), unsigned((n_ + tile - 1) / tile));
    place_kernel<<<blocks, dim3(tile, tile_rows), 0, stream>>>(
        head_.data(), pixels_, n_, strand_.data(), turn_.data(), root_.data(), base_.data(), offsets_.data(),
        answer, shapes_.data(), within_shapes ? 0 : int(shapes_.size()), depth_.data(), out);
    check_launch("placement in the world");
}

}  // namespace wetcurl

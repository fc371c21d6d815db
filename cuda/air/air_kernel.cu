// Kernels of a step of the air: faces and cells a thread each; rows of diffusion and products with sines by
// tiles in a processor's own memory.
#include <algorithm>
#include <cmath>

#include "cuda/air/air_kernel.h"
#include "cuda/device/cuda_owners.h"

namespace wetcurl {

namespace {

// --- faces

constexpr int across = 32, rows = 4;  // of a block: faces along x, along y

unsigned parts(int count, int part) { return unsigned((count + part - 1) / part); }
// Enough for the faces of each component.
dim3 face_blocks(const StaggeredGrid& g) {
    return {parts(g.cells[0] + 1, across), parts(g.cells[1] + 1, rows), unsigned(3 * (g.cells[2] + 1))};
}
// f(axis, face, i, j, k) of this thread's face, where it has one.
template <class F>
__device__ void at_my_face(const StaggeredGrid& g, F f) {
    const int i = int(blockIdx.x * blockDim.x + threadIdx.x), j = int(blockIdx.y * blockDim.y + threadIdx.y),
              layers = g.cells[2] + 1, axis = int(blockIdx.z) / layers, k = int(blockIdx.z) % layers;
    if (i < g.faces(axis, 0) && j < g.faces(axis, 1) && k < g.faces(axis, 2))
        f(axis, g.index(axis, i, j, k), i, j, k);
}

struct Faces {
    double* of[3];
};

__global__ void advect(const __grid_constant__ StaggeredGrid g, const __grid_constant__ Faces next,
                       double step) {
    at_my_face(g, [&](int axis, int face, int i, int j, int k) {
        next.of[axis][face] = g.advected(axis, i, j, k, step);
    });
}

// `brakes`: k of all faces of all components, then kv; null: no hair.
__global__ void blow_and_brake(const __grid_constant__ StaggeredGrid g, const BlowingBall* balls, int count,
                               const long long* brakes, double unit) {
    at_my_face(g, [&](int axis, int face, int i, int j, int k) {
        double u = g.u[axis][face];
        for (int b = 0; b < count; ++b)
            u = blown(u, balls[b].gust,
                      share_of_ball(balls[b].center, balls[b].radius, g.place(axis, i, j, k)),
                      along(balls[b].velocity, axis));
        if (brakes) {
            int at = face;
            for (int a = 0; a < axis; ++a) at += g.faces(a);
            const int all = g.faces(0) + g.faces(1) + g.faces(2);
            u = braked(u, unit * double(brakes[at]), unit * double(brakes[all + at]));
        }
        g.u[axis][face] = u;
    });
}

__global__ void take_divergence(const __grid_constant__ StaggeredGrid g) {
    const int i = int(blockIdx.x * blockDim.x + threadIdx.x), j = int(blockIdx.y * blockDim.y + threadIdx.y),
              k = int(blockIdx.z);
    if (i >= g.cells[0] || j >= g.cells[1]) return;
    g.pressure[(k * g.cells[1] + j) * g.cells[0] + i] = -g.divergence(i, j, k);
}

__global__ void take_off_gradient(const __grid_constant__ StaggeredGrid g, const __grid_constant__ Faces to) {
    at_my_face(g, [&](int axis, int face, int i, int j, int k) {
        to.of[axis][face] = g.u[axis][face] - g.pressure_gradient(axis, i, j, k);
    });
}

// --- diffusion

constexpr int lines = 32, line_threads = 128;  // of a block

struct Factors {
    const double *cells, *faces;  // of as many as the axis has cells, and of one more
};

// All lines of one component along `axis`, a few a block; blockIdx.y is the component.
__global__ void diffuse(const __grid_constant__ StaggeredGrid g, int axis, double a, const Factors factors) {
    extern __shared__ double tile[];  // (n, lines + 1), then a factor of each row
    const int component = int(blockIdx.y), n = g.faces(component, axis), row = g.faces(component, 0),
              layer = row * g.faces(component, 1), all = g.faces(component) / n,
              first = int(blockIdx.x) * lines, count = min(lines, all - first),
              step = axis == 0   ? 1
                     : axis == 1 ? row
                                 : layer;
    if (count <= 0) return;
    double* u = g.u[component];
    auto begin_of = [&](int line) {
        return axis == 0 ? line * n : axis == 1 ? line / row * layer + line % row : line;
    };
    // Neighbours in memory by neighbouring threads: along x they are of one line.
    auto each = [&](auto move) {
        const int lane = int(threadIdx.x) % 32, warp = int(threadIdx.x) / 32;
        const int slow = axis == 0 ? count : n, fast = axis == 0 ? n : count;
        for (int s = warp; s < slow; s += line_threads / 32)
            for (int f = lane; f < fast; f += 32) {
                const int line = axis == 0 ? s : f, i = axis == 0 ? f : s;
                move(tile[i * (lines + 1) + line], u[begin_of(first + line) + i * step]);
            }
    };
    double* factor = tile + n * (lines + 1);
    each([](double& near, double& far) { near = far; });
    for (int i = int(threadIdx.x); i < n; i += line_threads)
        factor[i] = (component == axis ? factors.faces : factors.cells)[i];
    __syncthreads();
    if (int(threadIdx.x) < count) {
        double* w = tile + threadIdx.x;
        // Some rows are read ahead: what is written might be what is read next, as far as a compiler knows.
        constexpr int ahead = 8;
        double last = 0, now[ahead];
        for (int begin = 0; begin < n; begin += ahead) {
            const int left = min(ahead, n - begin);
            for (int r = 0; r < ahead; ++r) now[r] = r < left ? w[(begin + r) * (lines + 1)] : 0;
            for (int r = 0; r < ahead; ++r)
                if (r < left) now[r] = last = eliminated(now[r], last, a, factor[begin + r]);
            for (int r = 0; r < ahead; ++r)
                if (r < left) w[(begin + r) * (lines + 1)] = now[r];
        }
        for (int end = n - 1; end > 0; end -= ahead) {
            const int left = min(ahead, end);
            for (int r = 0; r < ahead; ++r) now[r] = r < left ? w[(end - 1 - r) * (lines + 1)] : 0;
            for (int r = 0; r < ahead; ++r)
                if (r < left) now[r] = last = substituted(now[r], last, a, factor[end - 1 - r]);
            for (int r = 0; r < ahead; ++r)
                if (r < left) w[(end - 1 - r) * (lines + 1)] = now[r];
        }
    }
    __syncthreads();
    each([](double& near, double& far) { far = near; });
}

// --- products with sines

constexpr int tile_rows = 64, tile_columns = 16, depth = 16, product_threads = 128, of_rows = 4,
              of_columns = 2;

// The pressure's part of each product of sines.
struct Eigenvalues {
    const double *x, *y, *z;  // null: not divided by
};

// to = M from along one axis of n: columns lie `inner` apart, and M is `sines` or its transpose.
__global__ void __launch_bounds__(product_threads)
    multiply(const double* sines, bool transposed, int n, int inner, int columns, const double* from,
             double* to, int nx, const Eigenvalues divide) {
    __shared__ double m[depth][tile_rows + 2], b[depth][tile_columns + 2];
    constexpr int wide = tile_columns / of_columns, of_m = depth * tile_rows / product_threads,
                  of_b = depth * tile_columns / product_threads;
    const int first_row = int(blockIdx.y) * tile_rows, first_column = int(blockIdx.x) * tile_columns,
              my_row = int(threadIdx.x) / wide * of_rows, my_column = int(threadIdx.x) % wide * of_columns;
    auto base_of = [&](int column) { return column / inner * inner * n + column % inner; };
    // Where a thread's numbers of a step lie, neighbours in memory by neighbouring threads.
    auto of_sines = [&](int job, int& i, int& k) {
        i = transposed ? job / tile_rows : job % depth, k = transposed ? job % tile_rows : job / depth;
    };
    auto of_field = [&](int job, int& i, int& c) {
        i = inner == 1 ? job % depth : job / tile_columns, c = inner == 1 ? job / depth : job % tile_columns;
    };
    double next_m[of_m], next_b[of_b], sum[of_rows][of_columns]{};
    int base[of_b];
    for (int l = 0; l < of_b; ++l) {
        int i, c;
        of_field(int(threadIdx.x) + l * product_threads, i, c);
        base[l] = first_column + c < columns ? base_of(first_column + c) : -1;
    }
    auto fetch = [&](int begin) {
        for (int l = 0; l < of_m; ++l) {
            int i, k;
            of_sines(int(threadIdx.x) + l * product_threads, i, k);
            const int row = first_row + k, column = begin + i;
            next_m[l] = row < n && column < n ? sines[transposed ? column * n + row : row * n + column] : 0;
        }
        for (int l = 0; l < of_b; ++l) {
            int i, c;
            of_field(int(threadIdx.x) + l * product_threads, i, c);
            next_b[l] = begin + i < n && base[l] >= 0 ? from[base[l] + (begin + i) * inner] : 0;
        }
    };
    fetch(0);
    for (int begin = 0; begin < n; begin += depth) {
        for (int l = 0; l < of_m; ++l) {
            int i, k;
            of_sines(int(threadIdx.x) + l * product_threads, i, k);
            m[i][k] = next_m[l];
        }
        for (int l = 0; l < of_b; ++l) {
            int i, c;
            of_field(int(threadIdx.x) + l * product_threads, i, c);
            b[i][c] = next_b[l];
        }
        __syncthreads();
        if (begin + depth < n) fetch(begin + depth);
#pragma unroll 4
        for (int i = 0; i < depth; ++i) {
            double row[of_rows], column[of_columns];
            for (int r = 0; r < of_rows; ++r) row[r] = m[i][my_row + r];
            for (int c = 0; c < of_columns; ++c) column[c] = b[i][my_column + c];
            for (int r = 0; r < of_rows; ++r)
                for (int c = 0; c < of_columns; ++c) sum[r][c] += row[r] * column[c];
        }
        __syncthreads();
    }
    for (int c = 0; c < of_columns; ++c) {
        const int column = first_column + my_column + c;
        if (column >= columns) break;
        for (int r = 0; r < of_rows && first_row + my_row + r < n; ++r) {
            const int row = first_row + my_row + r;
            if (divide.x) sum[r][c] /= divide.x[column % nx] + divide.y[column / nx] + divide.z[row];
            to[base_of(column) + row * inner] = sum[r][c];
        }
    }
}

// --- hair

constexpr int particles_of_block = 256;
constexpr double fastest_hair = 1e3;  // [m/s]

template <class T>
__global__ void brake(const __grid_constant__ StaggeredGrid g, const __grid_constant__ BrakingHair<T> hair,
                      double each, double scale, long long* braked) {
    const size_t id = size_t(blockIdx.x) * particles_of_block + threadIdx.x;
    if (id >= hair.count) return;
    const Vec3d place = g.in_cells(cast<double>(cast<float>(hair.x[id]))), v = cast<double>(hair.v[id]);
    if (!g.inside(place)) return;
    const int i = int(id % size_t(hair.particles));
    const double length = 0.5 * ((i > 0 ? double(hair.rest_length[id - 1]) : 0) +
                                 (i + 1 < hair.particles ? double(hair.rest_length[id]) : 0));
    const int all = g.faces(0) + g.faces(1) + g.faces(2);
    int first = 0;
    for (int axis = 0; axis < 3; ++axis) {
        // What moves faster counts as this fast: sums must not overflow.
        const double speed = fmin(fmax(along(v, axis), -fastest_hair), fastest_hair);
        g.stencil(axis, place).for_each([&](int face, double weight) {
            weight *= each * hair.drag * length * scale;
            auto add = [&](int at, double value) {
                atomicAdd(reinterpret_cast<unsigned long long*>(braked + at),
                          static_cast<unsigned long long>(llrint(value)));
            };
            add(first + face, weight), add(all + first + face, weight * speed);
        });
        first += g.faces(axis);
    }
}

template <class T>
__global__ void sample(const __grid_constant__ StaggeredGrid g, const Vec3<T>* x, Vec3<T>* air,
                       size_t count) {
    const size_t id = size_t(blockIdx.x) * particles_of_block + threadIdx.x;
    if (id < count) air[id] = cast<T>(g.at(cast<double>(x[id])));
}

}  // namespace

AirDevice::AirDevice(const Air& air, double dt, double hair_length, double drag)
    : air_(air), host_balls_(air.sources.size()), balls_(air.sources.size()), all_drag_(drag * hair_length) {
    const double cell = cell_of(air);
    for (size_t axis = 0; axis < 3; ++axis) {
        const int n = air.grid[axis];
        const SineBasis basis(n, cell);
        axes_[axis] = {n, DeviceBuffer<double>(basis.vector), DeviceBuffer<double>(basis.value),
                       DeviceBuffer<double>(size_t(n) + 1), DeviceBuffer<double>(size_t(n) + 1)};
    }
    size_t faces = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const size_t count = size_t(view(u_).faces(axis));
        faces += count;
        u_[size_t(axis)] = DeviceBuffer<double>(std::vector<double>(count, along(air.wind, axis)));
        next_[size_t(axis)] = DeviceBuffer<double>(count);
    }
    const size_t cells = size_t(air.grid[0]) * size_t(air.grid[1]) * size_t(air.grid[2]);
    pressure_ = DeviceBuffer<double>(std::vector<double>(cells, 0.0)), spare_ = DeviceBuffer<double>(cells);
    allow_shared_memory(diffuse);
    if (air.two_way) braked_ = DeviceBuffer<long long>(2 * faces);
    take_steps_of(dt);
}

void AirDevice::take_steps_of(double dt) {
    if (dt == dt_) return;
    dt_ = dt;
    const double cell = cell_of(air_), a = air_.viscosity * dt / (cell * cell);
    for (Axis& axis : axes_) {
        if (!(a > 0)) break;
        std::vector<double> factors(size_t(axis.cells) + 1);
        diffusion_factors(axis.cells, a, factors.data());
        axis.factors.upload(factors.data(), factors.size());
        diffusion_factors(axis.cells + 1, a, factors.data());
        axis.more_factors.upload(factors.data(), factors.size());
    }
    // All of the hair at one face, as fast as any, is a number of 62 bits.
    const double all = dt * all_drag_ / (air_.density * cell * cell * cell);
    scale_ = 4e18 / (std::max(all, 1e-30) * fastest_hair);
}

StaggeredGrid AirDevice::view(const std::array<DeviceBuffer<double>, 3>& u) const {
    const double cell = cell_of(air_);
    return {{air_.grid[0], air_.grid[1], air_.grid[2]},
            cell,
            1 / cell,
            corner_of(air_),
            air_.wind,
            {u[0].data(), u[1].data(), u[2].data()},
            pressure_.data()};
}

void AirDevice::blow(double time) {
    for (size_t k = 0; k < air_.sources.size(); ++k) {
        const AirSource& source = air_.sources[k];
        host_balls_[k] = {source.center, source.velocity, source.radius, source.gust(time)};
    }
}

void AirDevice::launch_sines(int axis, bool back, const double* from, double* to, cudaStream_t stream) const {
    const int n = axes_[size_t(axis)].cells, columns = int(pressure_.size()) / n, nx = axes_[0].cells,
              inner = axis == 0   ? 1
                      : axis == 1 ? nx
                                  : nx * axes_[1].cells;
    const dim3 blocks(parts(columns, tile_columns), parts(n, tile_rows));
    Eigenvalues divide{};
    if (axis == 2 && !back)
        divide = {axes_[0].eigenvalues.data(), axes_[1].eigenvalues.data(), axes_[2].eigenvalues.data()};
    multiply<<<blocks, product_threads, 0, stream>>>(axes_[size_t(axis)].sines.data(), back, n, inner,
                                                     columns, from, to, nx, divide);
}

template <class T>
void AirDevice::launch_step(const BrakingHair<T>* hair, cudaStream_t stream) {
    const double cell = cell_of(air_), a = air_.viscosity * dt_ / (cell * cell);
    const dim3 block(across, rows);
    const StaggeredGrid old = view(u_), g = view(next_);
    advect<<<face_blocks(g), block, 0, stream>>>(old, {g.u[0], g.u[1], g.u[2]}, dt_ / cell);
    for (int axis = 0; axis < 3 && a > 0; ++axis) {
        size_t most = 0;
        for (int component = 0; component < 3; ++component)
            most = std::max(most, size_t(g.faces(component) / g.faces(component, axis)));
        diffuse<<<dim3(parts(int(most), lines), 3), line_threads,
                  sizeof(double) * size_t(g.cells[axis] + 1) * (lines + 2), stream>>>(
            g, axis, a, {axes_[size_t(axis)].factors.data(), axes_[size_t(axis)].more_factors.data()});
    }
    if (hair) {
        check_cuda(cudaMemsetAsync(braked_.data(), 0, braked_.bytes(), stream), "brake");
        brake<<<parts(int(hair->count), particles_of_block), particles_of_block, 0, stream>>>(
            g, *hair, dt_ / (air_.density * cell * cell * cell), scale_, braked_.data());
    }
    if (balls_.size())
        check_cuda(cudaMemcpyAsync(balls_.data(), host_balls_.data(), balls_.bytes(), cudaMemcpyHostToDevice,
                                   stream),
                   "sources");
    if (balls_.size() || hair)
        blow_and_brake<<<face_blocks(g), block, 0, stream>>>(g, balls_.data(), int(balls_.size()),
                                                             hair ? braked_.data() : nullptr, 1 / scale_);
    take_divergence<<<dim3(parts(g.cells[0], across), parts(g.cells[1], rows), unsigned(g.cells[2])), block,
                      0, stream>>>(g);
    double *here = pressure_.data(), *there = spare_.data();
    for (int axis : {0, 1, 2}) launch_sines(axis, false, here, there, stream), std::swap(here, there);
    for (int axis : {2, 1, 0}) launch_sines(axis, true, here, there, stream), std::swap(here, there);
    take_off_gradient<<<face_blocks(g), block, 0, stream>>>(g, {old.u[0], old.u[1], old.u[2]});
    check_cuda(cudaGetLastError(), "launch of the air");
}

template <class T>
void AirDevice::launch_sample(const Vec3<T>* x, Vec3<T>* air, size_t count, cudaStream_t stream) const {
    sample<<<parts(int(count), particles_of_block), particles_of_block, 0, stream>>>(view(u_), x, air, count);
    check_cuda(cudaGetLastError(), "launch of the air's sampling");
}

size_t AirDevice::bytes() const {
    size_t sum = pressure_.bytes() + spare_.bytes() + braked_.bytes();
    for (size_t axis = 0; axis < 3; ++axis)
        sum += u_[axis].bytes() + next_[axis].bytes() + axes_[axis].sines.bytes();
    return sum;
}

template void AirDevice::launch_step(const BrakingHair<float>*, cudaStream_t);
template void AirDevice::launch_step(const BrakingHair<double>*, cudaStream_t);
template void AirDevice::launch_sample(const Vec3<float>*, Vec3<float>*, size_t, cudaStream_t) const;
template void AirDevice::launch_sample(const Vec3<double>*, Vec3<double>*, size_t, cudaStream_t) const;

}  // namespace wetcurl

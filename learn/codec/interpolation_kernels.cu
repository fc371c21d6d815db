// Interpolation on a CUDA device.
#include "base/device_buffer.h"
#include "learn/codec/core_detail.h"
#include "learn/codec/interpolation_kernels.h"

namespace wetcurl {

namespace {

constexpr int threads = 128;

unsigned blocks_of(size_t count) { return unsigned((count + threads - 1) / threads); }

__device__ Vec3f mean_of(const StrandsToPlace& to, int s, int i, const Vec3f& root, const Vec3f* low) {
    Vec3f sum = root;
    for (int k = 0; k < to.width; ++k) {
        const size_t at = size_t(s) * to.width + k;
        const Vec3f* p = low + size_t(to.from[at]) * to.particles;
        sum += (to.weight ? to.weight[at] : 1.f) * (p[i] - p[0]);
    }
    return sum;
}
__device__ Vec3f root_of(const StrandsToPlace& to, int s) {
    return to.translation + rotate(to.rotation, to.root[s]);
}

// A thread a particle.
__global__ void mean_kernel(const StrandsToPlace to, const Vec3f* __restrict__ low, Vec3f* __restrict__ out) {
    const size_t k = size_t(blockIdx.x) * threads + threadIdx.x;
    if (k >= size_t(to.count) * to.particles) return;
    const int s = int(k / unsigned(to.particles)), i = int(k % unsigned(to.particles));
    out[k] = mean_of(to, s, i, root_of(to, s), low);
}

// A thread a strand.
__global__ void core_kernel(int strands, int n, float beta, const Vec3f* __restrict__ low,
                            Vec3f* __restrict__ cores) {
    const int s = int(blockIdx.x) * threads + int(threadIdx.x);
    if (s < strands) core_of(low + size_t(s) * n, n, beta, cores + size_t(s) * n);
}

__global__ void detail_kernel(const StrandsToPlace to, const int* __restrict__ nearest,
                              const Vec3f* __restrict__ low, const Vec3f* __restrict__ cores,
                              Vec3f* __restrict__ out) {
    const int s = int(blockIdx.x) * threads + int(threadIdx.x), n = to.particles;
    if (s >= to.count) return;
    const Vec3f root = root_of(to, s);
    const Vec3f *p = low + size_t(nearest[s]) * n, *core = cores + size_t(nearest[s]) * n;
    CarriedTurn<float> turn;
    Vec3f at = mean_of(to, s, 0, root, cores);
    for (int i = 0; i < n; ++i) {
        Vec3f next = at;
        if (i + 1 < n) {
            next = mean_of(to, s, i + 1, root, cores);
            turn.follow(core[i + 1] - core[i], next - at);
        }
        out[size_t(s) * n + i] = at + rotate(turn.turn, p[i] - core[i]);
        at = next;
    }
}

}  // namespace

void launch_means(const StrandsToPlace& to, const Vec3f* low, Vec3f* out, cudaStream_t stream) {
    mean_kernel<<<blocks_of(size_t(to.count) * size_t(to.particles)), threads, 0, stream>>>(to, low, out);
    check_cuda(cudaGetLastError(), "means of strands");
}

void launch_cores(int low_strands, int particles, const Vec3f* low, Vec3f* cores, cudaStream_t stream) {
    core_kernel<<<blocks_of(size_t(low_strands)), threads, 0, stream>>>(low_strands, particles,
                                                                        core_beta(particles), low, cores);
    check_cuda(cudaGetLastError(), "cores of strands");
}

void launch_details(const StrandsToPlace& to, const int* nearest, const Vec3f* low, const Vec3f* cores,
                    Vec3f* out, cudaStream_t stream) {
    detail_kernel<<<blocks_of(size_t(to.count)), threads, 0, stream>>>(to, nearest, low, cores, out);
    check_cuda(cudaGetLastError(), "details of strands");
}

}  // namespace wetcurl

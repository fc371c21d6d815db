// A copy far larger than any cache, and multiply-adds in registers alone.
#include <algorithm>

#include "base/device_buffer.h"
#include "cuda/device/rates.h"

namespace wetcurl {

namespace {

constexpr int chains = 8, rounds = 1 << 14, threads = 256, repetitions = 10;

__global__ void multiply_add(float a, float b, float* out) {
    float x[chains];
    for (int k = 0; k < chains; ++k) x[k] = float(threadIdx.x + k);
    for (int round = 0; round < rounds; ++round)
#pragma unroll
        for (int k = 0; k < chains; ++k) x[k] = fmaf(x[k], a, b);
    float sum = 0;
    for (int k = 0; k < chains; ++k) sum += x[k];
    out[blockIdx.x * threads + threadIdx.x] = sum;
}

// The shortest time of what `launch` puts on the default stream [s].
template <class Launch>
double shortest(Launch launch) {
    cudaEvent_t begin, end;
    check_cuda(cudaEventCreate(&begin), "event"), check_cuda(cudaEventCreate(&end), "event");
    double least = 1e9;
    for (int k = 0; k < repetitions; ++k) {
        check_cuda(cudaEventRecord(begin), "event");
        launch();
        check_cuda(cudaEventRecord(end), "event"),
            check_cuda(cudaEventSynchronize(end), "measuring the device");
        float milliseconds = 0;
        check_cuda(cudaEventElapsedTime(&milliseconds, begin, end), "event");
        least = std::min(least, 1e-3 * double(milliseconds));
    }
    cudaEventDestroy(begin), cudaEventDestroy(end);
    return least;
}

}  // namespace

CudaRates measured_cuda_rates(int device) {
    check_cuda(cudaSetDevice(device), "choice of the device");
    cudaDeviceProp properties;
    check_cuda(cudaGetDeviceProperties(&properties, device), "properties of the device");
    const DeviceBuffer<char> from(size_t(1) << 28), to(from.size());
    check_cuda(cudaMemset(from.data(), 1, from.bytes()), "filling memory");
    const double copying = shortest([&] {
        check_cuda(cudaMemcpyAsync(to.data(), from.data(), from.bytes(), cudaMemcpyDeviceToDevice), "copy");
    });
    const int blocks = 8 * properties.multiProcessorCount;
    const DeviceBuffer<float> sums(size_t(blocks) * threads);
    const double computing = shortest([&] {
        multiply_add<<<unsigned(blocks), threads>>>(0.999f, 0.001f, sums.data());
        check_cuda(cudaGetLastError(), "measuring the device");
    });
    return {2.0 * double(from.bytes()) / copying, 2.0 * chains * rounds * double(sums.size()) / computing};
}

}  // namespace wetcurl

// Memory of a CUDA device: owners of it, checks of calls, and what a block of threads may have. For what is
// built with CUDA alone.
#pragma once

#include <cuda_runtime.h>

#include <string>
#include <utility>
#include <vector>

#include "base/error.h"

namespace wetcurl {

inline void check_cuda(cudaError_t status, const char* what) {
    if (status != cudaSuccess) throw Error(std::string("CUDA: ") + what + ": " + cudaGetErrorString(status));
}

// A kernel may ask for all of the memory that a block of threads can have. The bound is the kernel's and not
// a launch's: what one simulation needs must not take it from another beside it. Returns the bytes beside the
// kernel's own.
template <class Kernel>
size_t allow_shared_memory(Kernel* kernel) {
    int device = 0, most = 0;
    check_cuda(cudaGetDevice(&device), "device");
    check_cuda(cudaDeviceGetAttribute(&most, cudaDevAttrMaxSharedMemoryPerBlockOptin, device), "device");
    cudaFuncAttributes own;
    check_cuda(cudaFuncGetAttributes(&own, kernel), "kernel");
    most -= int(own.sharedSizeBytes);
    check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, most),
               "memory of a processor");
    return size_t(most);
}

// `count` values on the current device.
template <class V>
class DeviceBuffer {
  public:
    DeviceBuffer() = default;
    explicit DeviceBuffer(size_t count) : count_(count) {
        if (count) check_cuda(cudaMalloc(&data_, bytes()), "out of memory");
    }
    explicit DeviceBuffer(const std::vector<V>& host) : DeviceBuffer(host.size()) {
        upload(host.data(), count_);
    }
    DeviceBuffer(DeviceBuffer&& other) noexcept { *this = std::move(other); }
    DeviceBuffer& operator=(DeviceBuffer&& other) noexcept {
        std::swap(data_, other.data_);
        std::swap(count_, other.count_);
        return *this;
    }
    ~DeviceBuffer() { cudaFree(data_); }

    V* data() const { return data_; }
    size_t size() const { return count_; }
    size_t bytes() const { return count_ * sizeof(V); }
    // Through on return, for every stream: a copy of pageable memory may else still be under way.
    void upload(const V* from, size_t count) {
        if (!count) return;
        check_cuda(cudaMemcpy(data_, from, count * sizeof(V), cudaMemcpyHostToDevice), "upload");
        check_cuda(cudaStreamSynchronize(cudaStreamLegacy), "upload");
    }
    void download(V* to) const {
        if (count_) check_cuda(cudaMemcpy(to, data_, bytes(), cudaMemcpyDeviceToHost), "download");
    }
    std::vector<V> host() const {
        std::vector<V> out(count_);
        download(out.data());
        return out;
    }

  private:
    V* data_ = nullptr;
    size_t count_ = 0;
};

// Page-locked memory of the host, which copies to and from the device read while the program goes on.
template <class V>
class PinnedBuffer {
  public:
    PinnedBuffer() = default;
    explicit PinnedBuffer(size_t count) : count_(count) {
        if (count) check_cuda(cudaMallocHost(&data_, count * sizeof(V)), "page-locked memory");
    }
    PinnedBuffer(const PinnedBuffer&) = delete;
    PinnedBuffer& operator=(const PinnedBuffer&) = delete;
    ~PinnedBuffer() { cudaFreeHost(data_); }
    V* data() const { return data_; }
    size_t size() const { return count_; }
    V& operator[](size_t k) const { return data_[k]; }

  private:
    V* data_ = nullptr;
    size_t count_ = 0;
};

}  // namespace wetcurl

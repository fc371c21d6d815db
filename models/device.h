// Where and how LibTorch computes: devices, threads, the choice of convolutions.
#pragma once

#include <torch/types.h>

#include <string>

namespace wetcurl {

// "cpu", "cuda" or "cuda:1". Throws Misuse for another name, Error where there is no such device.
torch::Device device_named(const std::string& name);
// How CUDA devices convolve from now on: by the same kernels each time; or by those that were the fastest
// when each size came first, which need not be the same, nor give the same bits, in the next process.
enum class Convolutions { repeatable, fastest };
void choose(Convolutions how);
// 0: all of the machine's.
void set_threads(int threads);

}  // namespace wetcurl

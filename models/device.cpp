// Where and how LibTorch computes.
#include "models/device.h"

#include <ATen/Context.h>
#include <torch/cuda.h>
#include <torch/utils.h>

#include <algorithm>
#include <cstdlib>
#include <thread>

#include "base/error.h"

namespace wetcurl {

torch::Device device_named(const std::string& name) {
    if (name == "cpu") return torch::kCPU;
    const bool numbered = name.rfind("cuda:", 0) == 0 && name.size() > 5 && name.size() < 9 &&
                          name.find_first_not_of("0123456789", 5) == std::string::npos;
    if (name != "cuda" && !numbered) throw Misuse("device: found '" + name + "', allowed cpu, cuda, cuda:N");
    const int index = numbered ? std::atoi(name.c_str() + 5) : 0;
    const int count = int(torch::cuda::device_count());
    if (index >= count)
        throw Error("device " + name + ": this machine and this LibTorch have " + std::to_string(count) +
                    " CUDA devices; --device cpu works everywhere");
    return torch::Device(torch::kCUDA, c10::DeviceIndex(index));
}

void choose(Convolutions how) {
    at::globalContext().setDeterministicCuDNN(how == Convolutions::repeatable);
    at::globalContext().setBenchmarkCuDNN(how == Convolutions::fastest);
}

void set_threads(int threads) {
    torch::set_num_threads(threads > 0 ? threads : int(std::max(1u, std::thread::hardware_concurrency())));
}

}  // namespace wetcurl

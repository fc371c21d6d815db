// What devices there are, and a simulation on one.
#include "cuda/run/simulation.h"

#include "cuda/run/cuda_hair.h"

namespace wetcurl {

std::vector<std::string> cuda_devices(std::string* reason) {
    int count = 0;
    std::vector<std::string> names;
    const cudaError_t status = cudaGetDeviceCount(&count);
    if (status != cudaSuccess) {
        if (reason) *reason = cudaGetErrorString(status);
        cudaGetLastError();  // forgotten: having none is no error
        return names;
    }
    for (int k = 0; k < count; ++k) {
        cudaDeviceProp properties;
        check_cuda(cudaGetDeviceProperties(&properties, k), "properties of the device");
        names.push_back(properties.name);
    }
    if (reason && names.empty()) *reason = "the driver lists none";
    return names;
}

void require_cuda_device(int device) {
    std::string reason;
    const auto names = cuda_devices(&reason);
    if (names.empty()) throw Error("--device cuda: no CUDA device is there (" + reason + ")");
    if (device < 0 || device >= int(names.size()))
        throw Error("--device cuda:" + std::to_string(device) + ": found " + std::to_string(names.size()) +
                    " device(s), counted from 0");
}

void enter_cuda_device(int device) { check_cuda(cudaSetDevice(device), "choice of the device"); }

std::unique_ptr<Simulation> make_cuda_simulation(const Scene& scene, const std::string& precision, int device,
                                                 Stepping stepping) {
    require_cuda_device(device);
    enter_cuda_device(device);
    if (precision == "double") return std::make_unique<SimulationOf<CudaHair<double>>>(scene, stepping);
    return std::make_unique<SimulationOf<CudaHair<float>>>(scene, stepping);
}

}  // namespace wetcurl

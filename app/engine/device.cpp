// Joins `--device` to the solver's backends.
#include "app/engine/device.h"

#include "base/error.h"
#include "base/provenance.h"
#ifdef WETCURL_HAVE_CUDA
#include "cuda/device/rates.h"
#include "cuda/run/simulation.h"
#endif

namespace wetcurl {

// -1: the CPU.
static int number_of(const std::string& device) {
    if (device == "cpu") return -1;
    if (device == "cuda") return 0;
    const std::string digits = device.rfind("cuda:", 0) == 0 ? device.substr(5) : "";
    if (digits.empty() || digits.size() > 4 || digits.find_first_not_of("0123456789") != std::string::npos)
        throw Misuse("--device: found '" + device + "', allowed: cpu, cuda, cuda:n");
    return std::stoi(digits);
}

std::vector<std::string> names_of_cuda_devices() {
#ifdef WETCURL_HAVE_CUDA
    return cuda_devices();
#else
    return {};
#endif
}

DeviceRates rates_of_cuda_device(const std::string& device) {
    require_device(device);
#ifdef WETCURL_HAVE_CUDA
    const CudaRates rates = measured_cuda_rates(number_of(device));
    return {cuda_devices()[size_t(number_of(device))], rates.copy_bytes, rates.operations};
#else
    return {};
#endif
}

void require_device(const std::string& device) {
    if (number_of(device) < 0) return;
#ifdef WETCURL_HAVE_CUDA
    require_cuda_device(number_of(device));
    note_gpu(cuda_devices()[size_t(number_of(device))]);
#else
    throw Error("--device " + device +
                ": this program was built without CUDA; the preset cuda builds it (scripts/build cuda)");
#endif
}

void enter_device([[maybe_unused]] const std::string& device) {
#ifdef WETCURL_HAVE_CUDA
    if (number_of(device) >= 0) enter_cuda_device(number_of(device));
#endif
}

std::unique_ptr<Simulation> make_simulation_on(const std::string& device, const Scene& scene,
                                               const std::string& precision) {
    require_device(device);
#ifdef WETCURL_HAVE_CUDA
    if (number_of(device) >= 0) return make_cuda_simulation(scene, precision, number_of(device));
#endif
    return make_simulation(scene, precision);
}

DisplayOn::DisplayOn([[maybe_unused]] const std::string& device, const Scene& scene) {
#ifdef WETCURL_HAVE_CUDA
    if (number_of(device) >= 0 && !cuda_devices().empty() && !scene.has_deforming_solid())
        device_ = make_cuda_display(scene, number_of(device));
#endif
    if (!device_) host_.emplace(scene);
    if (scene.has_deforming_solid()) surfaces_.emplace(scene);
}

void DisplayOn::apply(Strands& p, const Pose& head, double time) {
    if (device_) return device_->apply(p, head, time);
    if (surfaces_) surfaces_->hold(time);
    host_->apply(p, head, time, surfaces_ ? surfaces_->at_end() : nullptr);
}

}  // namespace wetcurl

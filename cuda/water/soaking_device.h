// What of the strands follows the water in them, on a device: masses, curl, core lengths, volumes of Eq 10.
#pragma once

#include <cuda_runtime.h>

#include "base/device_buffer.h"
#include "cuda/water/soaking_kernel_body.h"

namespace wetcurl {

struct Scene;

// Nothing is allocated and nothing read by the host after construction, so that launches can be captured.
class SoakingDevice {
  public:
    // rest_length (strand, particle) [m].
    template <class T>
    SoakingDevice(const Scene& scene, const std::vector<T>& rest_length);
    // At `saturation`, of hair of `dry_mass` [kg], both (strand, particle).
    template <class T>
    void launch(const float* saturation, const double* dry_mass, const SoakedStrands<T>& to,
                cudaStream_t stream) const;
    size_t bytes() const;

  private:
    const size_t count_;  // of particles
    Weighing weighing_;
    DryCurls dry_;
    DeviceBuffer<CurlOfStrand> curl_;
    DeviceBuffer<Vec3d> vectors_, printed_edge_;
    DeviceBuffer<Quatd> rotations_;
    DeviceBuffer<double> lengths_, springs_;
    DeviceBuffer<Vec3d> target_, points_;  // room: (edge, strand), (particle, strand)
};

}  // namespace wetcurl

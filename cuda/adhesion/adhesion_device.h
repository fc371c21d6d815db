// A network of dense layers in Eq 11's place on a device: its numbers and launches.
#pragma once

#include "base/device_buffer.h"
#include "cuda/adhesion/adhesion_kernel_body.h"

namespace wetcurl {

// Nothing is allocated and nothing read by the host after construction, so that launches can be captured.
template <class T>
class AdhesionDevice {
  public:
    // `particles` of all strands.
    AdhesionDevice(const Adhesion& term, const DenseLayers& layers, size_t particles);
    // From the strands as they are, where all is at `motion` in the device's memory -> the surfaces nearest
    // to them, and the answers in the place of those for the substep before.
    void launch(const StrandMemory<T>& memory, const SubstepMotion<T>* motion, const NearestView<T>& near,
                T* answer, cudaStream_t stream) const;
    size_t bytes() const { return numbers_.bytes() + before_.bytes(); }

  private:
    const AdhesionFeatures features_;
    DeviceBuffer<float> numbers_, before_;
    const DenseView network_;
};

extern template class AdhesionDevice<float>;
extern template class AdhesionDevice<double>;

}  // namespace wetcurl

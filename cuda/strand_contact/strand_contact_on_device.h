// Contact between strands on a device: buffers and launches, the frame loop's contact, as
// StrandContactCoupling is.
#pragma once

#include "base/carried.h"
#include "cuda/device/cell_search_device.h"
#include "cuda/strand_contact/strand_contact_kernel_body.h"
#include "solver/chain/chain_state.h"

namespace wetcurl {

// Nothing is allocated and nothing read by the host after construction, so that launches can be captured.
template <class T>
class StrandContactOnDevice {
  public:
    // For a scene with [strand_contact].
    StrandContactOnDevice(const Scene& scene, const ChainState<T>& state);
    // What others do at the end of a substep of dt [s]. Particles that are near are added to `pairs`, unless
    // it is null.
    void launch(const StrandMemory<T>& memory, double dt, unsigned long long* pairs, cudaStream_t stream);
    void weigh(const ChainState<T>&) {}  // masses are the strands' own
    // Neighbours are found anew in each substep.
    void save(Carried&) const {}
    void resume(const Carried&) {}
    double neighbours_mean() const { return double(pairs) / double(drawn_.size()); }  // within the radius
    void list(BufferList& buffers) const;
    unsigned long long pairs = 0;  // of the last substep
    double seconds = 0;            // in the frame at hand
    double work = 0;               // not counted here

  private:
    const StrandContact term_;
    DeviceBuffer<Vec3f> drawn_, positions_;
    CellSearchDevice search_;
    DeviceBuffer<StrandContactPoint> point_;
    DeviceBuffer<float> contacts_;
};

extern template class StrandContactOnDevice<float>;
extern template class StrandContactOnDevice<double>;

}  // namespace wetcurl

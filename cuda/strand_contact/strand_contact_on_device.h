// Contact between strands on a device: buffers and launches, the frame loop's contact, as
// StrandContactCoupling is.
#pragma once

#include <numeric>
#include <utility>

#include "base/carried.h"
#include "cuda/device/cell_search_device.h"
#include "cuda/device/cuda_owners.h"
#include "cuda/strand_contact/strand_contact_kernel_body.h"
#include "solver/chain/chain_state.h"

namespace wetcurl {

// Nothing is allocated and nothing read by the host after construction, so that launches can be captured.
template <class T>
class StrandContactOnDevice {
  public:
    // For a scene with [strand_contact], which must outlive it.
    StrandContactOnDevice(const Scene& scene, const ChainState<T>& state);
    // What acts on the strands in the substep of dt [s] that follows by `scheme` -> force [N], stiffness
    // [N/m] (strand, particle), added to what is there or new. In a frame's first substep links are found
    // anew, and their number is added to `links`.
    void launch(const StrandMemory<T>& memory, const Bdf2<T>& scheme, double dt, bool adds, Vec3<T>* force,
                T* stiffness, unsigned long long* links, cudaStream_t stream);
    void begin_frame() { left_ = 0; }
    // Whether links were found since the call before.
    bool found() { return std::exchange(found_now_, false); }
    void take_water(const ChainState<T>&) {}  // masses are the strands' own
    // [J] where the strands are; it waits.
    template <class H>
    double potential(const H& hair) const {
        launch_energies(hair.memory(), hair.stream());
        check_cuda(cudaStreamSynchronize(hair.stream()), "their energy");
        return total(energy_.device.host());
    }
    // The same for a run to keep; `recorded` waits for it, on any thread, before the next `begin_record`.
    template <class H>
    void begin_record(const H& hair) {
        launch_energies(hair.memory(), hair.stream());
        way_.begin(hair.stream(), [this](cudaStream_t out) { energy_.fetch(out); });
    }
    double recorded() const {
        way_.wait();
        return total(energy_.fetched());
    }
    void save(Carried& to) const;
    void resume(const Carried& from);
    double neighbours_mean() const {
        return double(links) / double(links_.size() / most_links);
    }  // links of a place
    void list(BufferList& buffers) const;
    unsigned long long links = 0;  // as they were found last
    double seconds = 0;            // in the frame at hand

  private:
    StrandContactOnDevice(const Scene& scene, const ChainState<T>& state, double longest_edge);
    StrandContactKernelBody<T> bodies(double dt) const;
    void launch_energies(const StrandMemory<T>& memory, cudaStream_t stream) const;
    static double total(const std::vector<double>& parts) {
        return std::accumulate(parts.begin(), parts.end(), 0.0);
    }

    const StrandContact term_;
    const StrandPlaces places_;
    const float reach_;
    const int substeps_;
    int left_ = 0;  // substeps until links are found again
    bool found_now_ = false;
    DeviceBuffer<Vec3f> drawn_;
    DeviceBuffer<LinkedParticle> particles_;
    DeviceBuffer<Vec3f> x_;
    CellSearchDevice search_;
    DeviceBuffer<StrandLink> links_, found_;
    DeviceBuffer<PlaceOnStrand> other_;
    DeviceBuffer<LinkForce> force_;
    DeviceBuffer<uint32_t> rank_, begin_, leading_;
    DeviceBuffer<char> scan_memory_;
    OnBoth<double> energy_;  // parts of it [J]
    WayOut way_;
};

extern template class StrandContactOnDevice<float>;
extern template class StrandContactOnDevice<double>;

}  // namespace wetcurl

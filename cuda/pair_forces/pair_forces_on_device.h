// Forces on all strands at once on a device: buffers and launches, the frame loop's forces, as
// PairForcesCoupling is.
#pragma once

#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "cuda/device/cell_search_device.h"
#include "cuda/device/cuda_owners.h"
#include "cuda/pair_forces/pair_forces_kernel.h"
#include "solver/chain/chain_state.h"

namespace wetcurl {

// Nothing is allocated and nothing read by the host after construction, so that launches can be captured.
template <class T>
class PairForcesOnDevice {
  public:
    // For a scene that names some, which must outlive it.
    PairForcesOnDevice(const Scene& scene, const ChainState<T>& state);
    // Explicit forces are those of the positions now, others of those that the scheme expects.
    bool has_stiffness() const { return std::holds_alternative<StrandPulls<CohesionPairs>>(pulls_.front()); }

    // Where solids are when a frame's substep begins, at `time` [s]; and all of it to the device, from
    // page-locked memory, which a graph reads anew each time it is replayed.
    void put_motion(int slot, double time) const;
    void upload_motion(cudaStream_t stream) const { upload_poses(0, slots_, stream); }
    // For the substep of that slot -> force [N], stiffness [N/m] (strand, particle). Pairs are added to
    // `pairs`, unless it is null.
    void launch(const StrandMemory<T>& memory, const Bdf2<T>& scheme, int slot, Vec3<T>* force, T* stiffness,
                unsigned long long* pairs, cudaStream_t stream) const;
    // [J] where the strands are; it waits.
    template <class H>
    double potential(const H& hair, double time) const {
        launch_energies_at(hair.memory(), time, hair.stream());
        check_cuda(cudaStreamSynchronize(hair.stream()), "their energy");
        return total(energy_.device.host());
    }
    // The same for a run to keep; `recorded` waits for it, on any thread, before the next `begin_record`.
    template <class H>
    void begin_record(const H& hair, double time) {
        launch_energies_at(hair.memory(), time, hair.stream());
        way_.begin(hair.stream(), [this](cudaStream_t out) { energy_.fetch(out); });
    }
    double recorded() const {
        way_.wait();
        return total(energy_.fetched());
    }

    const char* name() const { return name_; }
    double neighbours_mean() const { return double(pairs) / double(x_.size()); }
    void list(BufferList& buffers) const;
    unsigned long long pairs = 0;  // of the last substep
    double seconds = 0;            // in the frame at hand
    double work = 0;               // not counted here

  private:
    akinci2013::KernelTable take(const akinci2013::KernelSum& sum);
    PairMemory pairs_within(double radius);
    AnyPulls pulls_of(const Cohesion& method);
    AnyPulls pulls_of(const Lin2015& method);
    AnyPulls pulls_of(const Kim2016& method);
    AnyPulls pulls_of(const BoundaryParticles2013& method);
    // Calls launch(pulls, write) with those of each method, of particles as they are seen.
    template <class Launch>
    void for_each_seen(const StrandMemory<T>& memory, const Bdf2<T>* scheme, int slot, cudaStream_t stream,
                       Launch launch) const;
    void launch_energies_at(const StrandMemory<T>& memory, double time, cudaStream_t stream) const;
    void upload_poses(int slot, int slots, cudaStream_t stream) const;
    static double total(const std::vector<double>& parts) {
        return std::accumulate(parts.begin(), parts.end(), 0.0);
    }

    const Scene& scene_;
    const int particles_, slots_;
    const char* name_ = nullptr;
    DeviceBuffer<Vec3d> x_;  // (strand, particle) where forces are taken
    DeviceBuffer<double> mass_;
    DeviceBuffer<float> saturation_;
    std::vector<DeviceBuffer<double>> kernel_sums_;
    // Between strands, by one method of those.
    DeviceBuffer<Vec3f> near_;  // x from the first particle
    std::optional<CellSearchDevice> search_;
    DeviceBuffer<PairPoint> point_;
    DeviceBuffer<double> density_;
    DeviceBuffer<Vec3d> normal_;
    // By solids.
    std::vector<CellSearchDevice> surface_search_;
    std::vector<DeviceBuffer<double>> surface_volume_;
    std::vector<const Solid*> solids_;  // that have boundary particles
    DeviceBuffer<SampledSurface> surfaces_;
    std::optional<PinnedBuffer<Pose>> host_pose_;  // (slot and one for `potential`, surface)
    DeviceBuffer<Pose> pose_;
    OnBoth<double> energy_;  // parts of it [J]
    WayOut way_;
    std::vector<AnyPulls> pulls_;  // (method)
};

extern template class PairForcesOnDevice<float>;
extern template class PairForcesOnDevice<double>;

}  // namespace wetcurl

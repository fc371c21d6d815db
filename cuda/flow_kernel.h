// The flow of water on a device: the stages of FlowPass, by its bodies. Ours.
#pragma once

#include <cuda_runtime.h>

#include "cuda/cell_search_device.h"
#include "solver/passes/flow_bodies.h"

namespace wetcurl {

// Nothing is allocated and nothing read by the host from step to step, so that one can be captured.
class FlowDevice {
  public:
    // As a FlowPass, for steps of dt [s] under `gravity` [m/s²]; `origin`: where hair is.
    FlowDevice(const Flow& flow, const Strands& rest, double density, double absorbed, double dt,
               const Vec3d& gravity, const Vec3f& origin);

    // What sources do from `time` [s] on, for the step that follows.
    void aim(double time);
    // As FlowPass::step; strands seen at p (strand, particle).
    void launch_step(const Vec3f* p, cudaStream_t stream);
    // Another saturation; the balance begins anew.
    void restore(const std::vector<double>& saturation, cudaStream_t stream);

    // In the device's memory, (strand, particle).
    const float* saturation() const { return shown_.data(); }
    const double* dry_mass() const { return mass_.data(); }
    // In the host's, once the stream has come here.
    std::vector<double> exact(cudaStream_t stream) const { return host(sigma_, stream); }
    std::vector<float> shown(cudaStream_t stream) const { return host(shown_, stream); }
    WaterBalance water(cudaStream_t stream) const;
    size_t bytes() const;

  private:
    template <class V>
    static std::vector<V> host(const DeviceBuffer<V>& from, cudaStream_t stream);
    FlowBodies bodies() const;
    double held(cudaStream_t stream) const;

    const Flow flow_;
    const int strands_, n_;
    const double density_, absorbed_, dt_;
    const Vec3d down_;
    double start_ = 0;
    CellSearchDevice search_;
    DeviceBuffer<double> mass_, length_, sigma_, next_, limit_;  // (strand, particle)
    DeviceBuffer<float> shown_;
    DeviceBuffer<FlowRow> rows_;  // (particle, strand)
    DeviceBuffer<FlowLedger> ledger_;
    DeviceBuffer<double> held_;                    // (strand)
    std::vector<DeviceBuffer<float>> level_sets_;  // of sources, in their order; empty where one has none
    PinnedBuffer<FlowingSource> host_sources_;
    DeviceBuffer<FlowingSource> sources_;
};

}  // namespace wetcurl

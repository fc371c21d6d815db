// The flow of water on a device: the stages of FlowPass, by its bodies.
#pragma once

#include <cuda_runtime.h>

#include <optional>
#include <vector>

#include "base/run_cache.h"
#include "cuda/device/cell_search_device.h"
#include "cuda/device/cuda_owners.h"
#include "solver/water/flow_kernel_body.h"

namespace wetcurl {

// Nothing is allocated and nothing read by the host from step to step, so that one can be captured.
class FlowDevice {
  public:
    // As a FlowPass, under `gravity` [m/s²]; `origin`: where hair is.
    FlowDevice(const Flow& flow, const FlowHair& hair, double absorbed, const Vec3d& gravity,
               const Vec3f& origin);

    // The step that follows is of dt [s] from `time` on.
    void aim(double time, double dt);
    // As FlowPass::step; strands seen at p (strand, particle).
    void launch_step(const Vec3f* p, cudaStream_t stream);
    // Another saturation; the balance begins anew.
    void restore(const std::vector<double>& saturation, cudaStream_t stream);

    // As FlowPass's; they wait for the stream.
    std::vector<double> counted(cudaStream_t stream) const;
    void count_from(const std::vector<double>& counted, cudaStream_t stream);

    // In the device's memory, (strand, particle).
    const float* saturation() const { return shown_.data(); }
    const double* dry_mass() const { return mass_.data(); }
    // In the host's, once the stream has come here.
    std::vector<double> exact(cudaStream_t stream) const { return host(sigma_, stream); }
    std::vector<float> shown(cudaStream_t stream) const { return host(shown_, stream); }
    WaterBalance water(cudaStream_t stream) const;
    // What a run keeps of a frame, as it is once the stream has come here; `finish_record` waits for it, on
    // any thread, before the next `begin_record`.
    void begin_record(cudaStream_t stream);
    void finish_record(RunFrame& frame) const;
    size_t bytes() const;

  private:
    template <class V>
    static std::vector<V> host(const DeviceBuffer<V>& from, cudaStream_t stream);
    FlowKernelBody bodies() const;
    WaterBalance water(const std::vector<double>& held, const std::vector<FlowLedger>& ledger) const;

    const Flow flow_;
    const int strands_, n_;
    const double density_, absorbed_;
    double dt_ = 0;  // [s] of the step that follows
    const Vec3d down_;
    double start_ = 0;
    CellSearchDevice search_;
    DeviceBuffer<double> mass_, length_, sigma_, next_, limit_;  // (strand, particle)
    DeviceBuffer<float> shown_;
    DeviceBuffer<FlowRow> rows_;  // (particle, strand)
    DeviceBuffer<FlowLedger> ledger_;
    DeviceBuffer<double> held_;                    // (strand)
    std::vector<DeviceBuffer<float>> level_sets_;  // of sources, in their order; empty where one has none
    struct Record {
        Record(size_t particles, size_t strands) : saturation(particles), ledger(strands), held(strands) {}
        OnBoth<float> saturation;
        OnBoth<FlowLedger> ledger;
        OnBoth<double> held;
        WayOut way;
    };
    std::optional<Record> record_;  // once one is asked for
    PinnedBuffer<FlowingSource> host_sources_;
    DeviceBuffer<FlowingSource> sources_;
};

}  // namespace wetcurl

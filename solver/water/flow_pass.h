// The flow of water over a frame: sources, along each strand, between strands in contact, drying.
// Gathers only; each particle and each strand writes its own slot, so the result is the same for any number
// of threads, and what leaves one particle reaches another to rounding.
#pragma once

#include <vector>

#include "base/geometry/neighbor_list.h"
#include "solver/water/flow_kernel_body.h"

namespace wetcurl {

class FlowPass {
  public:
    // `absorbed`: m_absorbed; `saturation` (strand, particle) at the start, in [0, 1].
    FlowPass(const Flow& flow, FlowHair hair, double absorbed, const std::vector<float>& saturation);

    // dt [s] from `time` on, strands at p, under `gravity` [m/s²].
    void step(const Strands& p, double time, double dt, const Vec3d& gravity);

    // Its stages.
    void wet(const Strands& p, double time, double dt);
    void run_along(const Strands& p, double dt, const Vec3d& gravity);
    void exchange(const Strands& p, double dt);
    void dry(double dt);

    const std::vector<double>& exact() const { return sigma_; }         // (strand, particle)
    const std::vector<float>& saturation() const { return shown_; }     // the same, as others read it
    const std::vector<double>& dry_mass() const { return hair_.mass; }  // (strand, particle) [kg]
    // Another saturation; the balance begins anew.
    void restore(const std::vector<double>& saturation);
    // What the balance has counted.
    std::vector<double> counted() const { return carried_of(start_, ledger_); }
    void count_from(const std::vector<double>& counted) { start_ = take_carried(counted, ledger_); }
    WaterBalance water() const;
    size_t bytes() const;

  private:
    FlowKernelBody bodies();
    double held() const;
    void search(const Strands& p);
    void show();

    const Flow flow_;
    const FlowHair hair_;
    const double absorbed_;
    double start_ = 0;
    std::vector<double> sigma_, next_, limit_;  // (strand, particle)
    std::vector<float> shown_;
    std::vector<FlowLedger> ledger_;          // (strand)
    std::vector<std::vector<FlowRow>> rows_;  // (thread, particle)
    NeighborGrid grid_;
    NeighborList list_;
    std::vector<float> any_source_;
};

}  // namespace wetcurl

// The strands of a scene on the CPU, substep by substep: blocks of strands over threads, a lane a strand.
#pragma once

#include <optional>
#include <vector>

#include "solver/chain/chain_state.h"
#include "solver/chain/substep.h"
#include "solver/chain/work_meter.h"
#include "solver/solids/posed_scene.h"

namespace wetcurl {

// What others give to the strands for the substeps that follow, (block, particle); null: they do not.
template <class S>
struct GivenToChain {
    const Vec3<S>* force = nullptr;  // [N]
    const S* stiffness = nullptr;    // [N/m] of `force`, as of a BlockStep
    const S* adhesion = nullptr;     // F.n / (sigma m a_max) in Eq 11's place
};

template <class T>
class ChainStepper {
  public:
    using S = Pack<T>;
    // At rest on the head's first pose. The scene must outlive it.
    explicit ChainStepper(const Scene& scene);

    ChainState<S> state;
    Pose head;
    bool first = true;  // no history: the next substep is backward Euler
    // Only BDF2 looks at the step before.
    bool always_first() const { return scene_.integrator.kind != "implicit"; }
    Bdf2<S> scheme() const { return {T(dt_), first, share_}; }  // of the next implicit substep
    // Substeps of so many seconds follow.
    void take_steps_of(double dt) {
        if (dt == dt_) return;
        first = first || !state.retime(dt_, dt);
        dt_ = dt;
    }

    // Substeps along a path of posed scenes: each block all of them before the next, so that its strands stay
    // in cache.
    void run(const std::vector<PosedScene<T>>& path, const GivenToChain<S>& given);
    // The surfaces nearest to where the strands are, for a scene with [adhesion].
    void find_nearest(const PosedScene<T>& p);
    const NearestSurface<S>& nearest() const { return nearest_; }

    std::vector<double> energy() const;  // [J] of each of kinds_of_energy
    // The first strand that is not finite or ten strand lengths from its root.
    std::optional<Divergence> divergence() const;
    long limited_edges() const { return limited_; }
    void count_limited_from(long so_far) { limited_ = so_far; }

    // From now on the work that is done within substeps is counted.
    void count_work();
    bool counts_work() const { return !meters_.empty(); }
    Work work() const;
    // What `act`, which changes the strands between substeps, adds to their energy is added to `work` where
    // work is counted.
    template <class Act>
    void count_change(double& work, Act act) {
        const auto before = counts_work() ? energy() : std::vector<double>{};
        act();
        const auto after = counts_work() ? energy() : std::vector<double>{};
        for (size_t kind = 0; kind < after.size(); ++kind) work += after[kind] - before[kind];
    }

    void list(BufferList& buffers) const;

  private:
    // A block's strands now and one step ago.
    struct BlockState {
        Vec3<S>*x, *x_before, *v, *v_before;
    };
    // All is inlined: what stays a call hands packs over through memory.
    [[gnu::flatten]] void step_block(int block, const BlockState& now, const PosedScene<T>& p,
                                     const GivenToChain<S>& given, bool first, ChainScratch<S>& scratch,
                                     FarFromSolids<S>* far);
    ChainView<S> view_of(int block) const;
    RootMotion<S> root_motion_of(int block, const PosedScene<T>& p) const;
    std::vector<S> energy_of(int block) const;  // of each kind in each lane

    const Scene& scene_;
    const int n_;
    double dt_;  // [s] of a substep
    const SubstepRules<T> rules_;
    const T share_;
    NearestSurface<S> nearest_;
    std::vector<OwnScratch<S>> scratch_;  // (thread)
    std::vector<FarFromSolids<S>> far_;   // (thread); empty where it does not pay
    std::vector<WorkMeter<S>> meters_;    // (block); empty: not counted
    long limited_ = 0;
};

extern template class ChainStepper<float>;
extern template class ChainStepper<double>;

}  // namespace wetcurl

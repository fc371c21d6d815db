// The strands of a scene in a CUDA device's memory, and the air around them.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "cuda/adhesion/adhesion_device.h"
#include "cuda/air/air_kernel.h"
#include "cuda/chain/chain_kernel.h"
#include "cuda/cohesion/cohesion_kernel.h"
#include "cuda/pair_forces/pair_forces_on_device.h"
#include "cuda/run/frame_record.h"
#include "cuda/run/simulation.h"
#include "cuda/solids/deforming_solids_on_device.h"
#include "cuda/solids/rigid_shapes.h"
#include "cuda/strand_contact/strand_contact_on_device.h"
#include "cuda/water/water_coupling_on_device.h"
#include "solver/chain/scene_checks.h"
#include "solver/run/frame_loop.h"

namespace wetcurl {

template <class T>
class CudaHair;

// Hair and the air around it on a device, each once a frame where the other is: as AirCoupling.
template <class T>
class AirAround {
  public:
    AirAround(const Scene& scene, CudaHair<T>& hair)
        : scene_(scene),
          stream_(hair.stream()),
          field_(*scene.air, 1 / scene.fps, length_of(hair), scene.term<AirDrag>()->c) {
        sample(hair);
    }
    void advance(CudaHair<T>& hair, double time, double dt) {
        field_.take_steps_of(dt);
        field_.blow(time + dt);
        hair.queue([this, &hair](cudaStream_t stream) {
            begin_.record(stream);
            const BrakingHair<T> braking = hair.braking();
            field_.launch_step(scene_.air->two_way ? &braking : nullptr, stream);
            sample(hair);
            end_.record(stream);
        });
    }
    void finish() { seconds = end_.since(begin_); }
    void save(Carried& to) const {
        check_cuda(cudaStreamSynchronize(stream_), "air");
        for (int axis = 0; axis < 3; ++axis) to[air_component_names[axis]] = field_.velocities(axis);
    }
    void resume(const Carried& from) {
        check_cuda(cudaStreamSynchronize(stream_), "air");
        for (int axis = 0; axis < 3; ++axis) field_.blow_as(axis, from.at(air_component_names[axis]));
    }
    void list(BufferList& buffers) const { buffers.push_back({"air", field_.bytes()}); }
    double seconds = 0;  // in the frame at hand

  private:
    void sample(CudaHair<T>& hair) {
        field_.launch_sample(hair.braking().x, hair.air(), hair.braking().count, hair.stream());
    }
    static double length_of(const CudaHair<T>& hair) {
        double sum = 0;
        for (T length : hair.state.rest_length) sum += double(length);
        return sum;
    }
    const Scene& scene_;
    const cudaStream_t stream_;
    AirDevice field_;
    Event begin_, end_;
};

// The strands in a device's memory.
template <class T>
class CudaHair {
  public:
    using Number = T;
    using S = T;
    using Air = AirAround<T>;
    using Water = WaterCouplingOnDevice<CudaHair>;
    // In a build for parity too: bits are the CPU's but for those of atan2, which decide no more than a sign
    // where a winding number is a rounding away from 1/2.
    using Surfaces = DeformingSolidsOnDevice;
#ifdef WETCURL_PARITY
    // The CPU's own: sums over neighbours have its order, and a network's those of LibTorch.
    using Forces = PairForcesCoupling<T>;
    using StrandContacts = StrandContactCoupling<T>;
    static constexpr bool couples = false;
#else
    using Forces = PairForcesOnDevice<T>;
    using StrandContacts = StrandContactOnDevice<T>;
    static constexpr bool couples = true;
#endif

    CudaHair(const Scene& scene, Stepping stepping);

    // The host's view: as uploaded, and as fetched last.
    mutable ChainState<T> state;
    Pose head;
    bool first = true;  // no history: the next substep is backward Euler
    bool always_first() const { return scene_.integrator.kind != "implicit"; }
    Bdf2<T> scheme() const { return {T(dt_), first, T(predictor_share(scene_))}; }
    void take_steps_of(double dt);

    void begin_display(const std::vector<float>& saturation);
    double neighbours_mean() const { return neighbours_mean_; }

    void fetch() const;
    void fetch_history() const;
    void give_state();
    void give_velocities();
    void take_couplings(Forces* forces, StrandContacts* touching);
    void take_network(const DenseLayers* layers);
    bool asks_network() const { return adhesion_.has_value(); }
    void ask_from(const PosedScene<T>& p) { put_motion(slots_, p); }
    std::vector<double> answers() const;
    void give_answers(const std::vector<double>& answers);

    void find_nearest(const PosedScene<T>& p);
    const NearestSurface<T>& nearest() const { return nearest_; }

    // Launches on a stream that come before the substeps which follow, in a frame's graph with them: the same
    // ones each frame that has them.
    using Launches = std::function<void(cudaStream_t)>;
    void queue(Launches launches) { queued_.push_back(std::move(launches)); }
    // A whole frame without history to wait for is one graph, which shows it too.
    void run(const std::vector<PosedScene<T>>& path, const GivenToChain<T>& given, bool ends_frame);
    void show(double time, const MovingGrid* surfaces);
    const Vec3f* positions_on_device() const { return positions_.data(); }
    void begin_record(RunFrame& frame);
    void finish_record(RunFrame& frame) const { record_->finish(frame); }

    std::vector<double> energy() const;
    std::optional<Divergence> divergence() const;
    std::vector<Vec3f> velocities() const {
        std::vector<Vec3f> out;
        state.template unpack<float>(state.v, out);
        return out;
    }
    long limited_edges() const { return limited_; }
    void count_limited_from(long so_far) { limited_ = so_far; }
    void count_work() { throw_uncounted(); }
    Work work() const { return throw_uncounted(), Work(); }
    bool counts_work() const { return false; }
    template <class Act>
    void count_change(double&, Act act) {
        act();
    }
    void list(BufferList& buffers) const;
    StageSeconds seconds;

    // What the air meets, and what it gives.
    BrakingHair<T> braking() const {
        return {arrays_.x.data(), arrays_.v.data(), arrays_.rest_length.data(),
                state.n,          arrays_.x.size(), scene_.term<AirDrag>()->c};
    }
    Vec3<T>* air() const { return arrays_.air.data(); }
    StrandMemory<T> memory() const;
    cudaStream_t stream() const { return stream_.handle; }

    // What water asks: whether no strand is too far gone, by the last frame; where strands are seen; and what
    // of them follows it, which is new once it is taken.
    bool all_there() const { return report_.last().diverged >= state.strands; }
    const Vec3f* seen() const { return (cohesion_ ? displayed_ : positions_).data(); }
    SoakedStrands<T> soaked() const {
        return {arrays_.mass.data(),
                arrays_.saturation.data(),
                arrays_.rest_core.data(),
                arrays_.stretch_spring.data(),
                arrays_.bend_spring.data(),
                arrays_.twist_spring.data(),
                arrays_.target.data(),
                arrays_.push.data(),
                cohesion_ ? cohesion_->volumes() : nullptr,
                cohesion_ ? cohesion_->wet_volumes() : nullptr};
    }
    void take_water() { water_fetched_ = false; }

  private:
    [[noreturn]] static void throw_uncounted() {
        throw Error("the work done on hair is counted by --device cpu alone");
    }
    template <class V>
    static void upload(const std::vector<V>& host, DeviceBuffer<V>& to) {
        if (to.size() != host.size()) to = DeviceBuffer<V>(host.size());
        to.upload(host.data(), host.size());
    }
    template <class V>
    static void download(const DeviceBuffer<V>& from, std::vector<V>& host) {
        host.resize(from.size());
        from.download(host.data());
    }
    // The arrays of a part, to the device and back.
    void give(StrandPart part);
    void fetch(StrandPart part) const;
    void launch_queued() const;
    void fetch_water() const;
    void take_given(const GivenToChain<T>& given);
    void put_motion(int slot, const PosedScene<T>& p);
    void upload_motion();
    void launch_substeps(int substeps);
    void launch_chain(int slot, int substeps, bool begins);
    void launch_display();
    void launch_frame();
    void read_report();
    void read_couplings(int substeps);
    std::vector<T> energies() const;  // (strand, kind) [J]

    const Scene& scene_;
    double dt_;           // [s] of a substep
    bool shown_ = false;  // what was run last is seen already
    mutable bool fetched_ = true, history_fetched_ = true, water_fetched_ = true;
    mutable std::vector<Launches> queued_;

    StrandArrays<T, DeviceBuffer> arrays_;  // `state` there
    const bool by_reference_;               // stepped by the CPU's own pass
    StrandGroup group_{};
    DeviceBuffer<T> workspace_;  // of strands that do not fit a processor, or take the CPU's pass
    DeviceBuffer<Vec3f> positions_, displayed_;
    // What others give, and where adhesion was asked for; empty where nobody does.
    NearestSurface<T> nearest_;
    DeviceBuffer<Vec3<T>> given_force_, given_normal_, given_surface_velocity_;
    DeviceBuffer<T> given_stiffness_, given_adhesion_, given_phi_;
    // What acts on all strands before each substep; null where nothing does, or the host.
    PairForcesOnDevice<T>* forces_ = nullptr;
    StrandContactOnDevice<T>* strand_contact_ = nullptr;
    // (slot, each) and one: before forces, contact, the step.
    static constexpr size_t marks_each = 3;
    std::vector<Event> marks_;
    std::optional<AdhesionDevice<T>> adhesion_;  // asked before each substep
    // Solids.
    RigidShapes shapes_;
    // A frame's motion, substep by substep; with adhesion also where all is when the first begins.
    const int slots_;
    const size_t solids_each_, deforming_each_;
    OnBoth<SubstepMotion<T>> motion_;
    OnBoth<DeviceSolid<T>> solids_;
    OnBoth<ShapeView> deforming_;
    OnBoth<RootMotion<T>> roots_;  // of roots that ride; empty: none does
    FrameReports report_;
    std::optional<CohesionDevice> cohesion_;
    std::optional<FrameRecord<T>> record_;  // once one is asked for

    Stream stream_;
    std::array<Event, 4> events_;
    Graph graph_;  // of a frame
    size_t queued_in_graph_ = 0;
    double neighbours_mean_ = 0;
    long limited_ = 0;
};

extern template class CudaHair<float>;
extern template class CudaHair<double>;

}  // namespace wetcurl

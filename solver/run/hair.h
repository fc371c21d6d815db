// What a device offers to the frame loop: the strands of a scene there, and what acts on all of them at once.
// CpuHair (simulation.cpp) and CudaHair (cuda/run/cuda_hair.h) are such.
#pragma once

#include <concepts>
#include <optional>
#include <vector>

#include "base/buffer_list.h"
#include "base/carried.h"
#include "base/dense_layers.h"
#include "solver/chain/chain_stepper.h"
#include "solver/run/simulation.h"

namespace wetcurl {

// Of the frame at hand [s].
struct StageSeconds {
    double chain = 0, lists = 0, cohesion = 0;
};

// A stage that carries something from frame to frame.
template <class C>
concept Carrying = requires(C coupling, const C& now, Carried& to, const Carried& from) {
    now.save(to);
    coupling.resume(from);
};

// What couplings have in common: the time that they took in the frame at hand [s], and their buffers.
template <class C>
concept Coupling = requires(const C& now, BufferList& buffers) {
    { now.seconds } -> std::convertible_to<double>;
    now.list(buffers);
};

// [wetness.flow]: moves water and what of the hair follows it, once a frame from `time` [s] on, for so long
// [s].
template <class C, class H>
concept WaterCoupled = Coupling<C> && Carrying<C> && std::constructible_from<C, const Scene&, H&> &&
    requires(C water, const C& now, H& hair, double time, const std::vector<double>& saturation,
             RunFrame& frame) {
    water.advance(hair, time, time);
    water.finish();                   // the frame is shown
    water.restore(saturation, hair);  // (strand, particle)
    { now.exact() } -> std::convertible_to<std::vector<double>>;
    { now.saturation() } -> std::convertible_to<std::vector<float>>;
    { now.balance() } -> std::same_as<WaterBalance>;
    water.begin_record(frame);
    now.finish_record(frame);
    { now.work } -> std::convertible_to<double>;  // [J]
};

// [air]: moves the air, and samples it where the strands are, once a frame.
template <class C, class H>
concept AirCoupled = Coupling<C> && Carrying<C> && std::constructible_from<C, const Scene&, H&> &&
    requires(C air, H& hair, double time) {
    air.advance(hair, time, time);
    air.finish();
};

// [[solid.mesh]]: level sets of solids that deform, for each substep of a frame.
template <class C, class H>
concept SurfacesCoupled = Coupling<C> && std::constructible_from<C, const Scene&, H&> &&
    requires(C surfaces, const C& now, H& hair, double time) {
    surfaces.advance(hair, time, time, 1);  // from a time, for so long [s], in so many substeps
    surfaces.hold(time);                    // all as it is then
    surfaces.finish();
    { now.after(1) } -> std::same_as<const MovingGrid*>;  // so many substeps
    { now.at_end() } -> std::same_as<const MovingGrid*>;
};

// Forces between strands, in each substep.
template <class C, class H>
concept PairForcesCoupled = Coupling<C> && std::constructible_from < C,
        const Scene&, const ChainState<typename H::S>
& > &&requires(C forces, const C& now, const H& hair, double time) {
    { now.name() } -> std::convertible_to<const char*>;
    { now.potential(hair, time) } -> std::convertible_to<double>;  // [J]
    forces.begin_record(hair, time);
    { now.recorded() } -> std::convertible_to<double>;
    { now.neighbours_mean() } -> std::convertible_to<double>;
    { now.work } -> std::convertible_to<double>;
};

// [strand_contact]: contact between strands, in each substep; neighbours are found when a frame begins.
template <class C, class H>
concept StrandContactCoupled = Coupling<C> && Carrying<C> && std::constructible_from < C,
        const Scene&, const ChainState<typename H::S>
& > &&requires(C contact, const C& now, const H& hair) {
    contact.begin_frame();
    { now.potential(hair) } -> std::convertible_to<double>;  // [J]
    contact.begin_record(hair);
    { now.recorded() } -> std::convertible_to<double>;
    { now.neighbours_mean() } -> std::convertible_to<double>;
};

// The strands, made from a scene at rest on the head's first pose. The scene must outlive them.
template <class H>
concept Hair = requires {
    typename H::Number;  // float or double
    typename H::S;       // of `state`: a Pack of them, or one
    requires WaterCoupled<typename H::Water, H>;
    requires AirCoupled<typename H::Air, H>;
    requires SurfacesCoupled<typename H::Surfaces, H>;
    requires PairForcesCoupled<typename H::Forces, H>;
    requires StrandContactCoupled<typename H::StrandContacts, H>;
    // Whether forces, contact between strands and the answers of a network of dense layers come within `run`;
    // else the frame loop adds them between runs, on the host.
    { H::couples } -> std::convertible_to<bool>;
}
&&requires(H hair, const H& now, const std::vector<PosedScene<typename H::Number>>& path,
           const PosedScene<typename H::Number>& at, const GivenToChain<typename H::S>& given,
           typename H::Forces* forces, typename H::StrandContacts* touching, const DenseLayers* layers,
           const MovingGrid* surfaces, const std::vector<float>& saturation,
           const std::vector<double>& answers, RunFrame& frame, long count, double number, void (*act)(),
           BufferList& buffers) {
    // In the host's memory: the strands as uploaded, or as of the last fetch.
    requires std::same_as<std::remove_cvref_t<decltype(hair.state)>, ChainState<typename H::S>>;
    { hair.head } -> std::convertible_to<Pose>;             // after the last substep
    { hair.first } -> std::convertible_to<bool>;            // no history: the next substep is backward Euler
    { now.always_first() } -> std::same_as<bool>;           // of a scheme without history
    { now.scheme() } -> std::same_as<Bdf2<typename H::S>>;  // of the next implicit substep
    hair.take_steps_of(number);                             // [s], from now on
    { now.seconds } -> std::convertible_to<StageSeconds>;

    // For a scene with [cohesion]; `saturation` must outlive the hair.
    hair.begin_display(saturation);
    // What `run` lets act on the strands where it couples them; null: the scene has none.
    hair.take_couplings(forces, touching);
    // The network that `run` asks, and where all is when its first substep begins; null: `run` asks none.
    hair.take_network(layers);
    { now.asks_network() } -> std::same_as<bool>;
    hair.ask_from(at);
    // Its answers of the substep before (strand, particle), F.n / (sigma m a_max).
    { now.answers() } -> std::same_as<std::vector<double>>;
    hair.give_answers(answers);

    // A substep for each posed scene; `given`: what the host adds; whether a frame ends here.
    hair.run(path, given, true);
    // A frame is over, at a time [s]: what is seen of it.
    hair.show(number, surfaces);
    // Surfaces nearest to the strands, for a network on the host.
    hair.find_nearest(at);
    { now.nearest() } -> std::convertible_to<const NearestSurface<typename H::S>&>;

    // `state` from the device, and what of it is the step before; and back.
    now.fetch();
    now.fetch_history();
    hair.give_state();
    hair.give_velocities();
    // What a run keeps of a frame, in two halves: the second may run on another thread.
    hair.begin_record(frame);
    now.finish_record(frame);

    { now.energy() } -> std::same_as<std::vector<double>>;  // [J] of each of kinds_of_energy
    { now.divergence() } -> std::same_as<std::optional<Divergence>>;
    { now.limited_edges() } -> std::convertible_to<long>;
    hair.count_limited_from(count);
    { now.neighbours_mean() } -> std::convertible_to<double>;
    // Work from outside [J]; a device throws Error.
    hair.count_work();
    { now.counts_work() } -> std::same_as<bool>;
    { now.work() } -> std::same_as<Work>;
    hair.count_change(number, act);
    { now.velocities() } -> std::same_as<std::vector<Vec3f>>;     // (strand, particle) [m/s]
    { now.positions_on_device() } -> std::same_as<const Vec3f*>;  // null: on the CPU
    now.list(buffers);
};

}  // namespace wetcurl

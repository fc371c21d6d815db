// The frame loop, on whichever device the strands are: what a scene names that acts on all strands at once,
// and in what order.
#pragma once

#include <algorithm>
#include <cmath>

#include "solver/air/air_coupling.h"
#include "solver/chain/chain_stepper.h"
#include "solver/pair_forces/pair_forces_coupling.h"
#include "solver/run/hair.h"
#include "solver/run/simulation.h"
#include "solver/solids/deforming_solids.h"
#include "solver/strand_contact/strand_contact_coupling.h"
#include "solver/water/water_coupling.h"

namespace wetcurl {

// Where the host acts on the strands, it does so on the `state` of the hair, between fetch and give.
template <Hair H>
class SimulationOf final : public Simulation {
    using T = typename H::Number;
    using S = typename H::S;

  public:
    template <class... OfHair>
    explicit SimulationOf(const Scene& scene, const OfHair&... of_hair);
    void advance(bool shown = true) override {
        take_frame(1 / scene_.fps, scene_.integrator.substeps, 1 / (scene_.fps * scene_.integrator.substeps),
                   shown);
    }
    void advance_by(double seconds) override;
    double time() const override { return time_; }
    void cut(const std::function<void()>& move) override {
        begin_anew(time_, move);
        hair_.show(time_, surfaces_ ? surfaces_->at_end() : nullptr);
    }
    std::vector<Vec3f> velocities() const override { return hair_.fetch(), hair_.velocities(); }
    void begin_snapshot(RunFrame& frame) override;
    void finish_snapshot(RunFrame& frame) const override;
    std::optional<Divergence> divergence() const override { return hair_.divergence(); }
    BufferList buffers() const override;
    double neighbours_mean() const override {
        return scene_.cohesion   ? hair_.neighbours_mean()
               : forces_         ? forces_->neighbours_mean()
               : strand_contact_ ? strand_contact_->neighbours_mean()
                                 : 0;
    }
    const Vec3f* positions_on_device() const override { return hair_.positions_on_device(); }
    long limited_edges() const override { return hair_.limited_edges(); }
    std::optional<WaterBalance> water() const override {
        return water_ ? std::optional(water_->balance()) : std::nullopt;
    }
    void use_adhesion_predictor(AdhesionPredictor* model) override {
        if (model || network_) network().model = model, hair_.take_network(network_->layers());
    }
    void record_adhesion(std::vector<AdhesionRecord>* records) override {
        if (records || network_) network().records = records, hair_.take_network(network_->layers());
    }
    const Scene& scene() const override { return scene_; }
    SimulationState state() const override;
    void restore(const SimulationState& state) override { take_over(state, state.time); }
    void wet(const std::vector<double>& saturation) override {
        if (!water_) throw Error("found saturation for a scene without [wetness.flow], which moves it");
        water_->restore(saturation, hair_), follow_water();
    }
    RunState run_state() const override;
    void resume(const RunState& state) override;
    void count_work() override;
    Work work() const override;
    std::vector<double> energy() const override;

  private:
    AdhesionNetworkCoupling<S>& network() { return network_ ? *network_ : network_.emplace(); }
    // Where all is at a time [s] when `done` substeps of a frame are.
    PosedScene<T> posed_scene(double time, int done, bool moving = true, PosedScene<T> room = {}) const {
        return posed_scene_at<T>(scene_, time, dt_, moving, surfaces_ ? surfaces_->after(done) : nullptr,
                                 std::move(room));
    }
    // Stages on the host need all strands at the same substep.
    bool alone() const { return (H::couples || (!forces_ && !strand_contact_)) && !host_asks(); }
    bool host_asks() const { return network_ && network_->asked() && !hair_.asks_network(); }
    // A frame of so many substeps of dt [s].
    void take_frame(double seconds, int substeps, double dt, bool shown);
    void take_substeps(int substeps, bool ends_frame);
    void settle(double seconds);
    void begin_anew(
        double time, const std::function<void()>& move = [] {});
    void pull_strands(GivenToChain<S>& given);
    void ask_network(int done);
    void run(const std::vector<PosedScene<T>>& path, bool ends_frame);
    void follow_water();
    // surfaces_time [s]: of solids that deform.
    void take_over(const SimulationState& state, double surfaces_time);
    size_t particles() const { return scene_.groom.rest.points.size(); }
    // Calls f(name, seconds in the frame at hand) for each stage, in the order of their columns.
    template <class Self, class F>
    static void for_each_stage(Self& s, F f) {
        f("chain", s.hair_.seconds.chain);
        if (s.scene_.cohesion)
            f("neighbours", s.hair_.seconds.lists), f("cohesion", s.hair_.seconds.cohesion);
        if (s.water_) f("saturation", s.water_->seconds);
        if (s.air_) f("air", s.air_->seconds);
        if (s.surfaces_) f("level set", s.surfaces_->seconds);
        if (s.forces_) f(s.forces_->name(), s.forces_->seconds);
        if (s.strand_contact_) f(StrandContact::name, s.strand_contact_->seconds);
    }

    const Scene& scene_;
    double dt_;                            // [s] of a substep
    double time_ = 0, surfaces_time_ = 0;  // [s]; rounding tells them apart
    H hair_;
    // What the scene names.
    std::optional<typename H::Water> water_;
    std::optional<typename H::Air> air_;
    std::optional<typename H::Surfaces> surfaces_;
    std::optional<typename H::Forces> forces_;
    std::optional<typename H::StrandContacts> strand_contact_;
    std::optional<AdhesionNetworkCoupling<S>> network_;  // once it is asked for
    std::vector<PosedScene<T>> path_;                    // of the substeps at hand
    PosedScene<T> now_;                                  // where a network is asked
    double frame_seconds_ = 0;
};

template <Hair H>
template <class... OfHair>
SimulationOf<H>::SimulationOf(const Scene& scene, const OfHair&... of_hair)
    : scene_(scene), dt_(1 / (scene.fps * scene.integrator.substeps)), hair_(scene, of_hair...) {
    if (scene.flow) water_.emplace(scene, hair_);
    if (scene.cohesion) hair_.begin_display(water_ ? water_->saturation() : scene.saturation);
    if (scene.air) air_.emplace(scene, hair_);
    if (scene.has_deforming_solid()) surfaces_.emplace(scene, hair_);
    if (has_pair_forces(scene)) forces_.emplace(scene, hair_.state);
    if (scene.strand_contact) strand_contact_.emplace(scene, hair_.state);
    hair_.take_couplings(forces_ ? &*forces_ : nullptr, strand_contact_ ? &*strand_contact_ : nullptr);
    for_each_stage(*this, [&](const char* name, double) { stages.push_back(name); });
    energy_kinds = kinds_of_energy(scene.chain);
    if (forces_) energy_kinds.push_back(forces_->name());
    if (strand_contact_) energy_kinds.push_back(StrandContact::name);

    const int substeps = scene.integrator.substeps;
    for (int left = int(std::lround(-scene.begin() * scene.fps)); left > 0; --left) {
        time_ = -left / scene.fps;
        if (surfaces_) surfaces_->advance(hair_, time_, substeps * dt_, substeps);
        take_substeps(substeps, false);
    }
    time_ = 0;
    if (scene.preroll > 0 && surfaces_) surfaces_->hold(0);
    settle(scene.integrator.settle);
    hair_.show(time_, surfaces_ ? surfaces_->at_end() : nullptr);
    hair_.seconds.chain = 0;  // frame 0 has no substeps
}

template <Hair H>
void SimulationOf<H>::advance_by(double seconds) {
    if (seconds == 1 / scene_.fps) return advance(true);  // to the same bits
    const double longest = 1 / (scene_.fps * scene_.integrator.substeps);
    const int substeps = std::max(1, int(std::ceil(seconds / longest - 1e-6)));
    take_frame(seconds, substeps, seconds / substeps, true);
}

template <Hair H>
void SimulationOf<H>::take_frame(double seconds, int substeps, double dt, bool shown) {
    shown = shown || water_;
    hair_.take_steps_of(dt), dt_ = dt;
    for_each_stage(*this, [](const char*, double& seconds) { seconds = 0; });
    frame_seconds_ = 0;
    const StageTimer timer(frame_seconds_);
    const ShotCuts& cuts = scene_.cuts;
    const int frame = int(std::lround(time_ * scene_.fps)) + 1;
    if (cuts.at(frame)) {
        begin_anew(frame / scene_.fps);
        if (shown) hair_.show(time_, surfaces_ ? surfaces_->at_end() : nullptr);
        return;
    }
    if (water_) water_->advance(hair_, time_, seconds), follow_water();
    if (air_) air_->advance(hair_, time_, seconds);
    if (surfaces_) surfaces_->advance(hair_, time_, substeps * dt_, substeps);
    if (strand_contact_) strand_contact_->begin_frame();
    surfaces_time_ = time_ + substeps * dt_;
    take_substeps(substeps, shown);
    if (shown) hair_.show(time_, surfaces_ ? surfaces_->at_end() : nullptr);
    if (air_) air_->finish();
    if (water_) water_->finish();
    if (surfaces_) surfaces_->finish();
}

// Of a frame from the time as it is.
template <Hair H>
void SimulationOf<H>::take_substeps(int substeps, bool ends_frame) {
    for (int done = 0; done < substeps;) {
        ask_network(done);
        path_.resize(alone() ? size_t(substeps) : 1);
        double time = time_;
        for (auto& p : path_) {
            time += dt_;
            p = posed_scene(time, ++done, true, std::move(p));
        }
        run(path_, ends_frame && done == substeps);
        time_ = time;
    }
}

// With everything held at its pose.
template <Hair H>
void SimulationOf<H>::settle(double seconds) {
    const long steps = std::lround(seconds / dt_);
    if (steps <= 0) return;
    const std::vector<PosedScene<T>> held(alone() ? size_t(steps) : 1, posed_scene(time_, 0, false));
    for (long k = 0; k < steps; k += long(held.size())) run(held, false);
}

// At a cut each strand goes with its root to where that is at `time`, once `move` has put it there, and
// rests; time in between does not pass.
template <Hair H>
void SimulationOf<H>::begin_anew(double time, const std::function<void()>& move) {
    hair_.fetch(), hair_.fetch_history();
    RidingRoots::Room before, after;
    if (scene_.riding) scene_.root_poses_at(time_, before);
    const Pose head_before = scene_.head_at(time_);
    move();
    if (scene_.riding) scene_.root_poses_at(time, after);
    const Pose head = scene_.head_at(time);
    hair_.state.carry([&](size_t strand) {
        const Pose &from = scene_.riding ? before.pose[strand] : head_before,
                   &to = scene_.riding ? after.pose[strand] : head;
        const Quatd turn = to.rotation * conjugate(from.rotation);
        return Pose{turn, to.translation - rotate(turn, from.translation)};
    });
    time_ = surfaces_time_ = time;
    hair_.head = head, hair_.first = true;
    hair_.give_state();
    if (surfaces_) surfaces_->hold(time);
    // Hair that hangs swings for longer than that: it loses its velocity again and again, and rests at last.
    constexpr int rests = 8;
    for (int k = 0; k < rests && scene_.integrator.settle_after_cut > 0; ++k) {
        settle(scene_.integrator.settle_after_cut / rests);
        hair_.fetch(), hair_.fetch_history();
        hair_.state.carry([](size_t) { return Pose{}; });
        hair_.first = true;
        hair_.give_state();
    }
}

// From the state as it is; what a network answers holds for the substep that follows.
template <Hair H>
void SimulationOf<H>::ask_network(int done) {
    if (!hair_.asks_network() && !host_asks()) return;
    now_ = posed_scene(time_, done, true, std::move(now_));
    if (hair_.asks_network()) return hair_.ask_from(now_);
    const StageTimer timer(hair_.seconds.chain);
    hair_.fetch();
    hair_.find_nearest(now_);
    network_->evaluate(*scene_.term<Adhesion>(), hair_.state, hair_.nearest());
}

// Substeps from the time as it is: one where strands do not go alone.
template <Hair H>
void SimulationOf<H>::run(const std::vector<PosedScene<T>>& path, bool ends_frame) {
    GivenToChain<S> given;
    if constexpr (!H::couples) pull_strands(given);
    if (host_asks()) given.adhesion = network_->given();
    hair_.run(path, given, ends_frame);
}

template <Hair H>
void SimulationOf<H>::pull_strands(GivenToChain<S>& given) {
    if (!forces_ && !strand_contact_) return;
    hair_.fetch(), hair_.fetch_history();
    if (forces_) {
        forces_->evaluate(hair_.state, hair_.scheme(), time_, dt_, hair_.counts_work());
        given.force = forces_->force(), given.stiffness = forces_->stiffness();
    }
    if (strand_contact_) strand_contact_->evaluate(hair_.state, hair_.scheme(), dt_, given);
}

// What beside the strands themselves follows the water in them; couplings within `run` read the masses
// themselves.
template <Hair H>
void SimulationOf<H>::follow_water() {
    if (!H::couples && strand_contact_) hair_.fetch(), strand_contact_->take_water(hair_.state);
}

template <Hair H>
std::vector<double> SimulationOf<H>::energy() const {
    auto sum = hair_.energy();
    if (forces_) sum.push_back(forces_->potential(hair_, time_));
    if (strand_contact_) sum.push_back(strand_contact_->potential(hair_));
    return sum;
}

template <Hair H>
void SimulationOf<H>::count_work() {
    hair_.count_work();
    if (water_) water_->work = 0;
    if (forces_) forces_->work = 0;
}

template <Hair H>
Work SimulationOf<H>::work() const {
    Work sum = hair_.work();
    if (water_) sum.water = water_->work;
    if (forces_) sum.solids += forces_->work;
    return sum;
}

template <Hair H>
SimulationState SimulationOf<H>::state() const {
    hair_.fetch(), hair_.fetch_history();
    SimulationState out;
    out.time = time_, out.first = hair_.first;
    if (water_) out.saturation = water_->exact();
    hair_.state.save(out);
    return out;
}

template <Hair H>
void SimulationOf<H>::take_over(const SimulationState& from, double surfaces_time) {
    time_ = from.time, hair_.first = from.first || hair_.always_first();
    surfaces_time_ = surfaces_time;
    hair_.head = scene_.head_at(time_);
    if (surfaces_) surfaces_->hold(surfaces_time_);
    hair_.fetch(), hair_.fetch_history();
    hair_.state.restore(from);
    hair_.give_state();
    if (water_ && !from.saturation.empty()) water_->restore(from.saturation, hair_), follow_water();
    hair_.show(time_, surfaces_ ? surfaces_->at_end() : nullptr);
}

// Pair forces are taken anew in each substep and carry nothing; nor do neighbours of Eq 10.
template <Hair H>
RunState SimulationOf<H>::run_state() const {
    RunState out{state(), {}};
    out.carried["limited edges"] = {double(hair_.limited_edges())};
    out.carried["time of surfaces"] = {surfaces_time_};
    if (water_) water_->save(out.carried);
    if (air_) air_->save(out.carried);
    if (strand_contact_) strand_contact_->save(out.carried);
    if (network_) {
        auto& answers = out.carried["answers of the network"];
        answers = hair_.asks_network() ? hair_.answers() : network_->answers();
        answers.resize(particles(), 0);  // none came yet
    }
    return out;
}

template <Hair H>
void SimulationOf<H>::resume(const RunState& from) {
    take_over(from, from.carried.at("time of surfaces")[0]);
    hair_.count_limited_from(long(from.carried.at("limited edges")[0]));
    if (water_) water_->resume(from.carried);
    if (air_) air_->resume(from.carried);
    if (strand_contact_) strand_contact_->resume(from.carried);
    if (!network_) return;
    const auto& answers = from.carried.at("answers of the network");
    hair_.asks_network() ? hair_.give_answers(answers) : network_->give_answers(answers);
}

template <Hair H>
void SimulationOf<H>::begin_snapshot(RunFrame& frame) {
    frame.head = hair_.head;
    frame.saturation.clear(), frame.water.clear();
    hair_.begin_record(frame);
    if (water_) water_->begin_record(frame);
    if (forces_) forces_->begin_record(hair_, time_);
    if (strand_contact_) strand_contact_->begin_record(hair_);
    frame.seconds = frame_seconds_;
    frame.stage_seconds.clear();
    for_each_stage(*this,
                   [&](const char*, double seconds) { frame.stage_seconds.push_back(float(seconds)); });
}

template <Hair H>
void SimulationOf<H>::finish_snapshot(RunFrame& frame) const {
    hair_.finish_record(frame);
    if (water_) water_->finish_record(frame);
    if (forces_) frame.energy.push_back(float(forces_->recorded()));
    if (strand_contact_) frame.energy.push_back(float(strand_contact_->recorded()));
}

template <Hair H>
BufferList SimulationOf<H>::buffers() const {
    BufferList list;
    hair_.list(list);
    if (network_) network_->list(list);
    if (forces_) forces_->list(list);
    if (strand_contact_) strand_contact_->list(list);
    if (water_) water_->list(list);
    if (air_) air_->list(list);
    for (const auto& solid : scene_.solids)
        if (const auto* level_set = std::get_if<std::shared_ptr<const LevelSet>>(&solid.shape))
            list.push_back({"level set of " + solid.name, (*level_set)->bytes()});
    if (surfaces_) surfaces_->list(list);
    return list;
}

}  // namespace wetcurl

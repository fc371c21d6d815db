// The stepper on the CPU: a frame's schedule, and what a scene names that acts on all strands at once.
#include "solver/simulation.h"

#include <algorithm>
#include <cmath>

#include "solver/chain_stepper.h"
#include "solver/couplings/forces_on_strands.h"
#include "solver/couplings/hair_in_air.h"
#include "solver/couplings/touching_strands.h"
#include "solver/couplings/water_in_hair.h"
#include "solver/deforming_solids.h"
#include "solver/display.h"

namespace wetcurl {

namespace {

template <class T>
class CpuSimulation final : public Simulation {
    using S = Pack<T>;

  public:
    explicit CpuSimulation(const Scene& scene);
    void advance() override;
    void snapshot(RunFrame& frame) const override;
    std::optional<Divergence> divergence() const override { return chain_.divergence(); }
    BufferList buffers() const override;
    double neighbours_mean() const override {
        return display_           ? display_->neighbours_mean()
               : forces_          ? forces_->neighbours_mean()
               : between_strands_ ? between_strands_->neighbours_mean()
                                  : 0;
    }
    long limited_edges() const override { return chain_.limited_edges(); }
    std::optional<WaterBalance> water() const override {
        return water_ ? std::optional(water_->flow().water()) : std::nullopt;
    }
    void use_adhesion_model(AdhesionModel* model) override {
        if (model || network_) network().model = model;
    }
    void record_adhesion(std::vector<AdhesionRecord>* records) override {
        if (records || network_) network().records = records;
    }
    SimulationState state() const override;
    void restore(const SimulationState& state) override;
    void count_work() override;
    Work work() const override;
    std::vector<double> energy() const override;

  private:
    AdhesionNetwork<T>& network() { return network_ ? *network_ : network_.emplace(); }
    // Where all is at a time [s] when `done` substeps of a frame are.
    Placement<T> placement(double time, int done, bool moving = true) const {
        return placement_at<T>(scene_, time, dt_, moving, surfaces_ ? surfaces_->after(done) : nullptr);
    }
    // Who answers for all strands at once needs them at the same substep.
    bool alone() const { return !forces_ && !between_strands_ && !(network_ && network_->asked()); }
    void ask_network(int done);
    void run(const std::vector<Placement<T>>& path);
    void move_water();
    void follow_water();
    void touch_strands();
    void positions(Strands& out) const;
    void display();
    // Calls f(name, seconds in the frame at hand) for each stage, in the order of their columns.
    template <class Self, class F>
    static void for_each_stage(Self& s, F f) {
        f("chain", s.chain_seconds_);
        if (s.display_) f("neighbours", s.list_seconds_), f("cohesion", s.cohesion_seconds_);
        if (s.water_) f("saturation", s.water_->seconds);
        if (s.air_) f("air", s.air_->seconds);
        if (s.surfaces_) f("level set", s.surface_seconds_);
        if (s.forces_) f(s.forces_->name(), s.forces_->seconds);
        if (s.between_strands_) f(StrandContact::name, s.between_strands_->seconds);
    }

    const Scene& scene_;
    const double dt_;
    double time_ = 0;
    ChainStepper<T> chain_;
    // What the scene names.
    std::optional<WaterInHair<T>> water_;
    std::optional<Display> display_;
    Strands displayed_;  // or where the strands are, for water alone
    std::optional<HairInAir<T>> air_;
    std::optional<DeformingSolids> surfaces_;
    std::optional<ForcesOnStrands<T>> forces_;
    std::optional<TouchingStrands<T>> between_strands_;
    std::optional<AdhesionNetwork<T>> network_;  // once it is asked for
    double chain_seconds_ = 0, list_seconds_ = 0, cohesion_seconds_ = 0, surface_seconds_ = 0,
           frame_seconds_ = 0;
};

template <class T>
CpuSimulation<T>::CpuSimulation(const Scene& scene)
    : scene_(scene), dt_(1 / (scene.fps * scene.integrator.substeps)), chain_(scene) {
    if (scene.flow) water_.emplace(scene);
    if (scene.cohesion && water_)
        display_.emplace(scene, water_->flow().saturation(), scene.flow->reach);
    else if (scene.cohesion)
        display_.emplace(scene);
    if (scene.air) air_.emplace(scene, chain_.state);
    if (scene.has_deforming_solid()) surfaces_.emplace(scene);
    if (auto method = make_particle_forces(scene)) forces_.emplace(std::move(method), chain_.state);
    if (scene.strand_contact) between_strands_.emplace(scene, chain_.state);
    for_each_stage(*this, [&](const char* name, double) { stages.push_back(name); });
    energy_kinds = kinds_of_energy(scene.chain);
    if (forces_) energy_kinds.push_back(forces_->name());

    if (const long steps = std::lround(scene.integrator.settle / dt_); steps > 0) {
        const auto held = placement(0, 0, false);
        if (alone()) run(std::vector<Placement<T>>(size_t(steps), held));
        for (long k = 0; !alone() && k < steps; ++k) run({held});
        chain_seconds_ = 0;  // frame 0 has no substeps
    }
    display();
}

template <class T>
void CpuSimulation<T>::advance() {
    for_each_stage(*this, [](const char*, double& seconds) { seconds = 0; });
    frame_seconds_ = 0;
    const StageTimer timer(frame_seconds_);
    if (water_) move_water();
    if (air_) air_->advance(chain_.state, time_);
    const int substeps = scene_.integrator.substeps;
    if (surfaces_) {
        const StageTimer surface_timer(surface_seconds_);
        surfaces_->advance(time_, time_ + substeps * dt_, substeps);
    }
    for (int done = 0; done < substeps;) {
        ask_network(done);
        std::vector<Placement<T>> path;
        double time = time_;
        do {
            time += dt_;
            path.push_back(placement(time, ++done));
        } while (alone() && done < substeps);
        run(path);
        time_ = time;
    }
    display();
}

// From the state as it is; what a network answers holds for the substep that follows.
template <class T>
void CpuSimulation<T>::ask_network(int done) {
    if (!network_ || !network_->asked()) return;
    const StageTimer timer(chain_seconds_);
    chain_.find_nearest(placement(time_, done));
    network_->evaluate(*scene_.term<Adhesion>(), chain_.state, chain_.nearest());
}

// Substeps from the time as it is: one where strands do not go alone.
template <class T>
void CpuSimulation<T>::run(const std::vector<Placement<T>>& path) {
    if (forces_) forces_->evaluate(chain_.state, chain_.scheme(), time_, dt_, chain_.counts_work());
    {
        const StageTimer timer(chain_seconds_);
        GivenToChain<S> given;
        if (forces_) given.force = forces_->force(), given.stiffness = forces_->stiffness();
        if (network_) given.adhesion = network_->given();
        chain_.run(path, given);
    }
    if (between_strands_) touch_strands();
}

template <class T>
void CpuSimulation<T>::touch_strands() {
    const StageTimer timer(between_strands_->seconds);
    if (!between_strands_->look(chain_.state)) return;
    chain_.count_change(between_strands_->work, [&] { between_strands_->push(chain_.state, dt_); });
}

template <class T>
void CpuSimulation<T>::move_water() {
    const StageTimer timer(water_->seconds);
    if (!display_) positions(displayed_);
    if (!is_finite(displayed_.points)) return;
    chain_.count_change(water_->work, [&] {
        water_->step(displayed_, time_, display_ ? &*display_ : nullptr);
        follow_water();
    });
}

// All that follows the saturation.
template <class T>
void CpuSimulation<T>::follow_water() {
    water_->soak(chain_.state);
    if (display_) display_->take_up_water(water_->flow().dry_mass());
    if (between_strands_) between_strands_->weigh(chain_.state);
}

template <class T>
void CpuSimulation<T>::positions(Strands& out) const {
    out.count = chain_.state.strands, out.particles = chain_.state.n;
    chain_.state.template unpack<float>(chain_.state.x, out.points);
}

template <class T>
void CpuSimulation<T>::display() {
    if (!display_) return;
    positions(displayed_);
    if (!is_finite(displayed_.points)) return;
    display_->apply(displayed_, chain_.head, time_, surfaces_ ? surfaces_->at_end() : nullptr);
    list_seconds_ = display_->list_seconds();
    cohesion_seconds_ = display_->seconds() - list_seconds_;
}

template <class T>
std::vector<double> CpuSimulation<T>::energy() const {
    auto sum = chain_.energy();
    if (forces_) sum.push_back(forces_->potential(chain_.state, time_));
    return sum;
}

template <class T>
void CpuSimulation<T>::count_work() {
    chain_.count_work();
    if (water_) water_->work = 0;
    if (forces_) forces_->work = 0;
    if (between_strands_) between_strands_->work = 0;
}

template <class T>
Work CpuSimulation<T>::work() const {
    Work sum = chain_.work();
    if (water_) sum.water = water_->work;
    if (forces_) sum.solids += forces_->work;
    if (between_strands_) sum.strands = between_strands_->work;
    return sum;
}

// The buffers of a state beside those of the strands that it is read from, or that take it.
template <class Chain, class State, class F>
void for_each_pair(Chain& chain, State& state, F f) {
    f(chain.x, state.x), f(chain.x_before, state.x_before), f(chain.v, state.v);
    f(chain.v_before, state.v_before), f(chain.frame, state.frame);
    f(chain.touching, state.touching), f(chain.pushed, state.pushed);
}

template <class T>
SimulationState CpuSimulation<T>::state() const {
    SimulationState out;
    out.time = time_, out.first = chain_.first;
    if (water_) out.saturation = water_->flow().exact();
    for_each_pair(chain_.state, out,
                  [&](const auto& from, auto& to) { chain_.state.template unpack<double>(from, to); });
    return out;
}

template <class T>
void CpuSimulation<T>::restore(const SimulationState& from) {
    time_ = from.time, chain_.first = from.first || chain_.always_first();
    chain_.head = scene_.motion.at(time_);
    if (surfaces_) surfaces_->hold(time_);
    for_each_pair(chain_.state, from, [&](auto& to, const auto& values) {
        if (!to.empty() && !values.empty()) chain_.state.pack(values, to);
    });
    if (water_ && !from.saturation.empty()) water_->restore(from.saturation), follow_water();
    display();
}

template <class T>
void CpuSimulation<T>::snapshot(RunFrame& frame) const {
    frame.head = chain_.head;
    positions(frame.positions);
    frame.displayed = display_ ? displayed_ : Strands();
    frame.seconds = frame_seconds_;
    frame.stage_seconds.clear();
    for_each_stage(*this,
                   [&](const char*, double seconds) { frame.stage_seconds.push_back(float(seconds)); });
    const auto sum = energy();
    frame.energy.assign(sum.begin(), sum.end());
    frame.saturation = water_ ? water_->flow().saturation() : std::vector<float>{};
    frame.water.clear();
    if (const auto w = water()) frame.water = {w->held, w->taken, w->dripped, w->dried};
    frame.contact = chain_.state.contacts();
}

template <class T>
BufferList CpuSimulation<T>::buffers() const {
    BufferList list;
    chain_.list(list);
    if (network_) network_->list(list);
    if (forces_) forces_->list(list);
    if (between_strands_) between_strands_->list(list);
    if (water_) water_->list(list);
    if (display_) list.push_back({"cohesion lists", display_->bytes()});
    add_buffer(list, display_ ? "displayed positions" : "positions of the flow", displayed_.points);
    if (air_) air_->list(list);
    for (const auto& solid : scene_.solids)
        if (const auto* level_set = std::get_if<std::shared_ptr<const LevelSet>>(&solid.shape))
            list.push_back({"level set of " + solid.name, (*level_set)->bytes()});
    if (surfaces_) list.push_back({"level sets of deforming solids", surfaces_->bytes()});
    return list;
}

}  // namespace

std::unique_ptr<Simulation> make_simulation(const Scene& scene, const std::string& precision) {
    if (precision == "double") return std::make_unique<CpuSimulation<double>>(scene);
    return std::make_unique<CpuSimulation<float>>(scene);
}

}  // namespace wetcurl

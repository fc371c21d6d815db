// The stepper on the CPU: blocks of strands over threads, a lane a strand.
#include "solver/simulation.h"

#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "solver/air/air.h"
#include "solver/baselines/particle_forces.h"
#include "solver/chain_state.h"
#include "solver/deforming_solids.h"
#include "solver/display.h"
#include "solver/passes/chain_step.h"
#include "solver/passes/strand_contact.h"
#include "solver/placement.h"
#include "solver/plan.h"

namespace wetcurl {

namespace {

// A run that blew up has no neighbours to find; the caller asks `divergence` next.
bool is_finite(const Strands& p) {
    return std::all_of(p.points.begin(), p.points.end(),
                       [](const Vec3f& x) { return std::abs(x.x + x.y + x.z) < 1e6f; });
}

template <class T>
class CpuSimulation final : public Simulation {
    using S = Pack<T>;
    static constexpr int lanes = S::lanes;
    template <class V>
    using Buffer = std::vector<V>;

  public:
    explicit CpuSimulation(const Scene& scene);
    void advance() override;
    void snapshot(RunFrame& frame) const override;
    std::optional<Divergence> divergence() const override;
    std::vector<BufferSize> buffers() const override;
    double neighbours_mean() const override {
        return display_        ? display_->neighbours_mean()
               : forces_       ? forces_->neighbours_mean()
               : between_hair_ ? between_hair_->neighbours_mean()
                               : 0;
    }
    long limited_edges() const override { return limited_; }
    std::optional<WaterBalance> water() const override {
        return flow_ ? std::optional(flow_->water()) : std::nullopt;
    }
    void use_adhesion_model(AdhesionModel* model) override { model_ = model; }
    void record_adhesion(std::vector<AdhesionRecord>* records) override { records_ = records; }
    SimulationState state() const override;
    void restore(const SimulationState& state) override;
    void count_work() override;
    Work work() const override;
    std::vector<double> energy() const override;

  private:
    // A block's strands now and one step ago.
    struct BlockState {
        Vec3<S>*x, *x_before, *v, *v_before;
    };
    size_t at(int block, int i) const { return size_t(block) * size_t(n_) + size_t(i); }
    // Only BDF2 looks at the step before.
    bool always_first() const { return scene_.integrator.kind == "explicit"; }
    void run(const std::vector<Placement<T>>& path);
    void step_block(int block, const BlockState& now, const Placement<T>& p, bool first,
                    ChainScratch<S>& scratch);
    void set_root(int block, const Pose& head, Vec3<S>* root) const;
    int lanes_of_block(int block) const { return std::min(lanes, strands_ - block * lanes); }
    ChainView<S> view_of(int block) const;
    void move_water();
    void soak_strands();
    void evaluate_adhesion(int done);
    // Where all is after `done` substeps of a frame.
    Placement<T> placement(double time, int done, bool moving = true) const;
    void move_surfaces();
    void move_air();
    void sample_air();
    void gather_hair_in_air();
    bool positions(std::vector<Vec3d>& out) const;  // (strand, particle) [m]; false where they are not finite
    void evaluate_forces();
    void weigh_particles();
    void touch_strands();
    void display();
    void unpack(const Buffer<Vec3<S>>& x, Strands& out) const;
    // Energy of each kind in each lane of a block.
    std::vector<S> energy_of(int block) const;

    const Scene& scene_;
    ChainTerms terms_;
    const int strands_, n_, blocks_;
    const double dt_;
    const T spring_sum_, share_;
    double time_ = 0;
    bool first_ = true;
    Pose head_;

    ChainState<S> state_;
    Buffer<Vec3<S>>&x_ = state_.x, &x_before_ = state_.x_before, &v_ = state_.v, &v_before_ = state_.v_before,
    &root_ = state_.root, &target_ = state_.target, &push_ = state_.push, &air_velocity_ = state_.air;
    Buffer<S>&mass_ = state_.mass, &rest_length_ = state_.rest_length, &rest_core_ = state_.rest_core,
    &saturation_ = state_.saturation, &rest_depth_ = state_.rest_depth, &touching_ = state_.touching,
    &pushed_ = state_.pushed;
    Buffer<Quat<S>>& frame_ = state_.frame;
    Buffer<S> phi_, given_;
    Buffer<Vec3<S>> normal_, surface_velocity_;
    std::optional<FlowPass> flow_;
    std::vector<Soaking> soaking_;  // (strand), with flow
    size_t flow_stage_ = 0;
    double water_work_ = 0, pulled_work_ = 0;
    std::optional<Display> display_;
    Strands displayed_;
    std::vector<ChainScratch<S>> scratch_;
    std::optional<AirField> air_;
    std::vector<DragPoint> hair_in_air_;  // (strand, particle), where hair brakes the air
    std::optional<DeformingSolids> surfaces_;
    size_t air_stage_ = 0, surface_stage_ = 0, forces_stage_ = 0;
    std::unique_ptr<ParticleForces> forces_;  // of a compared method
    Buffer<Vec3<S>> external_;
    std::vector<Vec3d> force_x_, force_;  // (strand, particle): what it sees and gives
    const Iben2013* iben_ = nullptr;
    std::optional<StrandContactPass> between_hair_;
    size_t between_stage_ = 0;
    double between_work_ = 0;
    std::vector<double>
        stage_;  // chain, then what the scene names: neighbours and cohesion, saturation, air…
    double frame_seconds_ = 0;
    long limited_ = 0;
    AdhesionModel* model_ = nullptr;
    std::vector<AdhesionRecord>* records_ = nullptr;
    std::vector<WorkMeter<S>> meters_;  // (block); empty: not counted
    std::vector<float> answers_;        // F.n / (sigma m a_max) of the step before (block, particle, lane)
};

template <class T>
CpuSimulation<T>::CpuSimulation(const Scene& scene)
    : scene_(scene),
      terms_(scene.chain),
      strands_(scene.groom.rest.count),
      n_(scene.groom.rest.particles),
      blocks_((strands_ + lanes - 1) / lanes),
      dt_(1 / (scene.fps * scene.integrator.substeps)),
      spring_sum_(T(spring_sum(scene.chain))),
      share_(T(predictor_share(scene))),
      head_(scene.motion.at(0)),
      state_(scene) {
    if (!touching_.empty()) {
        const size_t cells = at(blocks_, 0);
        phi_.assign(cells, S(1e9));
        normal_.assign(cells, {S(0), S(1), S(0)}), surface_velocity_.assign(cells, {S(0), S(0), S(0)});
    }
    energy_kinds = kinds_of_energy(terms_);
    stages = {"chain"};
    if (scene.flow) {
        flow_.emplace(*scene.flow, scene.groom.rest, scene.linear_density, scene.wetness->absorbed,
                      scene.saturation);
        soaking_.resize(size_t(strands_));
#pragma omp parallel for schedule(static)
        for (int s = 0; s < strands_; ++s) rest_state_of(scene, s, &soaking_[size_t(s)]);
    }
    if (scene.cohesion) {
        stages.insert(stages.end(), {"neighbours", "cohesion"});
        if (flow_)
            display_.emplace(scene, flow_->saturation(), scene.flow->reach);
        else
            display_.emplace(scene);
    }
    if (flow_) {
        flow_stage_ = stages.size();
        stages.push_back("saturation");
    }
    if (scene.air) {
        air_stage_ = stages.size();
        stages.push_back("air");
        air_.emplace(*scene.air);
        if (scene.air->two_way) hair_in_air_.resize(scene.groom.rest.points.size());
        sample_air();
    }
    if (scene.has_deforming_solid()) {
        surface_stage_ = stages.size();
        stages.push_back("level set");
        surfaces_.emplace(scene);
    }
    if (scene.baseline) iben_ = std::get_if<Iben2013>(&*scene.baseline);
    if ((forces_ = make_particle_forces(scene))) {
        forces_stage_ = stages.size();
        stages.push_back("baseline");
        energy_kinds.push_back("baseline");
        external_.assign(at(blocks_, 0), {S(0), S(0), S(0)});
        force_x_.resize(scene.groom.rest.points.size());
    }
    if (scene.strand_contact) {
        between_stage_ = stages.size();
        stages.push_back(StrandContact::name);
        between_hair_.emplace(*scene.strand_contact, scene.groom.rest);
        weigh_particles();
    }
    stage_.assign(stages.size(), 0);
    scratch_.resize(size_t(omp_get_max_threads()));
    for (auto& s : scratch_) s.resize(n_, terms_, scene.integrator.kind == "implicit", !scene.solids.empty());
    if (scene.integrator.settle > 0) {
        const long steps = std::lround(scene.integrator.settle / dt_);
        const auto held = placement(0, 0, false);
        const bool together = forces_ || between_hair_;
        for (long k = 0; together && k < steps; ++k) {
            if (forces_) evaluate_forces();
            run({held});
            if (between_hair_) touch_strands();
        }
        if (!together) run(std::vector<Placement<T>>(size_t(steps), held));
    }
    display();
}

template <class T>
Placement<T> CpuSimulation<T>::placement(double time, int done, bool moving) const {
    return placement_at<T>(scene_, time, dt_, moving, surfaces_ ? surfaces_->after(done) : nullptr);
}

template <class T>
void CpuSimulation<T>::set_root(int block, const Pose& head, Vec3<S>* root) const {
    const Quat<S> r = cast<S>(cast<T>(head.rotation));
    const Vec3<S> t = cast<S>(cast<T>(head.translation));
    for (int i = 0; i < 2; ++i) root[i] = rotate(r, root_[size_t(block) * 2 + size_t(i)]) + t;
}

template <class T>
ChainView<Pack<T>> CpuSimulation<T>::view_of(int block) const {
    auto from = [&](const auto& buffer) { return buffer.empty() ? nullptr : buffer.data() + at(block, 0); };
    ChainView<S> view{};
    view.n = n_;
    view.x = from(x_);
    view.v = from(v_);
    view.mass = from(mass_);
    view.rest_length = from(rest_length_);
    view.target = from(target_);
    view.frame = from(frame_);
    view.rest_core = from(rest_core_);
    view.saturation = from(saturation_);
    view.push = from(push_);
    view.phi = from(phi_);
    view.normal = from(normal_);
    view.surface_velocity = from(surface_velocity_);
    view.touching = from(touching_);
    view.given_adhesion = from(given_);
    view.air = from(air_velocity_);
    return view;
}

// One substep. The new state is written over the one before.
template <class T>
void CpuSimulation<T>::step_block(int block, const BlockState& now, const Placement<T>& p, bool first,
                                  ChainScratch<S>& scratch) {
    const size_t k = at(block, 0);
    Vec3<S> root[2];
    set_root(block, p.head, root);
    const auto& bend = std::get<std::optional<Bend>>(terms_);
    const auto& adhesion = std::get<std::optional<Adhesion>>(terms_);
    BlockStep<S> step{n_,
                      T(dt_),
                      first,
                      now.x,
                      now.x_before,
                      now.v,
                      now.v_before,
                      root,
                      cast<T>(scene_.integrator.gravity),
                      p.root_turn,
                      bend ? &frame_[k] : nullptr,
                      pushed_.empty() ? nullptr : &pushed_[k],
                      external_.empty() ? nullptr : &external_[k],
                      share_};
    WorkMeter<S>* meter = meters_.empty() ? nullptr : &meters_[size_t(block)];
    if (meter) step.reaction = meter->begin(step);
    const S* rest_depth = rest_depth_.empty() ? nullptr : &rest_depth_[k];
    ChainView<S> view = view_of(block);
    view.turn = cast<S>(p.turn);
    view.turn_center = cast<S>(p.turn_center);
    view.drift = cast<S>(p.drift);
    auto sample = [&](const Vec3<S>* x, const Vec3<S>* v) {
        if (adhesion && given_.empty())
            sample_nearest(p, n_, x, &phi_[k], &normal_[k], &surface_velocity_[k]);
        const S h = Bdf2<S>(step.dt, first).h;
        auto hold = [&](auto contact) {
            for (int i = 2; i < int(scratch.hold.size()); ++i)
                if (any_positive(step.pushed[i]))
                    scratch.hold[size_t(i)] =
                        contact(rest_depth ? rest_depth[i] : S(0), step.pushed[i],
                                hold_stiffness(spring_sum_, h, mass_[k + size_t(i)]), x[i], v[i]);
        };
        if (p.few())
            hold([&](const auto&... a) { return expected_contact(p.solids, a...); });
        else
            hold([&](const auto&... a) { return expected_contact_of_all(p, a...); });
    };
    Quat<T> turn_left = Quat<T>::identity();  // of the frames, to where the step ends
    const bool implicit = scene_.integrator.kind == "implicit";
    if (implicit)
        implicit_step(terms_, step, view, scratch, sample);
    else
        explicit_step(terms_, step, view, scratch, sample), turn_left = step.root_turn;

    Vec3<S>*x = now.x_before, *x_old = now.x, *v = now.v_before, *v_old = now.v;
    if (iben_) iben_->limit_velocities(n_, T(dt_), x, v);
    view.x = x, view.v = v;
    if (meter) meter->add_step(step, view, turn_left, now.x, scratch);
    int limited = 0;
    auto counted = [&](double Work::*kind, auto act) {
        if (meter)
            meter->add_change(kind, step, view, turn_left, act);
        else
            act();
    };
    const auto& limit = std::get<std::optional<StrainLimit>>(terms_);
    if (limit && !scratch.limit_edge.empty())
        for (int i = 1; i + 1 < n_; ++i)
            limited +=
                count_lanes<S>(limit->holds(scratch.limit_edge[size_t(i)], rest_length_[k + size_t(i)]));
    else if (limit)
        counted(&Work::limiter, [&] {
            auto* unlimited = scratch.predicted_x.data();
            std::copy_n(x, n_, unlimited);
            limited = limit_strain(n_, &rest_length_[k], T(limit->most), x);
            for (int i = 2; i < n_; ++i) {
                const Vec3<S> dx = x[i] - unlimited[i], dv = S(T(1 / dt_)) * dx;
                x_old[i] += dx, v[i] += dv, v_old[i] += dv;
            }
        });
    if (limited > 0) {
#pragma omp atomic
        limited_ += limited;
    }
    auto meet = [&](const auto& solid, bool deforms) {
        bool met = false;
        auto resolve = [&] {
            met = resolve_contact(solid, implicit ? T(0) : solid.friction, n_, rest_depth, T(dt_), &mass_[k],
                                  step.pushed, x, x_old, v, v_old);
        };
        if (deforms || norm(solid.velocity) + norm(solid.spin) > 0)
            counted(&Work::solids, resolve);
        else
            resolve();
        return met;
    };
    if (p.tree)
        p.tree->for_each_met(n_, x, [&](size_t solid) { return meet(p.solids[solid], false); });
    else
        for (const auto& solid : p.solids) meet(solid, false);
    for (const auto& solid : p.deforming) meet(solid, true);
    if (adhesion) update_touching(n_, &phi_[k], T(adhesion->h_a), &touching_[k]);
    if (bend) transport_frames(n_, step.frame, turn_left, x, step.frame);
}

// Substeps along a path of poses: each block all of them before the next, so that its strands stay in cache.
template <class T>
void CpuSimulation<T>::run(const std::vector<Placement<T>>& path) {
#pragma omp parallel for schedule(dynamic)
    for (int block = 0; block < blocks_; ++block) {
        const size_t k = at(block, 0);
        BlockState now{&x_[k], &x_before_[k], &v_[k], &v_before_[k]};
        bool first = first_;
        for (const auto& p : path) {
            step_block(block, now, p, first, scratch_[size_t(omp_get_thread_num())]);
            std::swap(now.x, now.x_before);
            std::swap(now.v, now.v_before);
            first = always_first();
        }
    }
    if (path.size() % 2) {
        std::swap(x_, x_before_);
        std::swap(v_, v_before_);
    }
    head_ = path.back().head;
    first_ = always_first();
}

// The twelve inputs of every particle near a solid, from the state as it is; the network's answers hold for
// the substep that follows.
template <class T>
void CpuSimulation<T>::evaluate_adhesion(int done) {
    const Adhesion& term = *std::get<std::optional<Adhesion>>(terms_);
    const Placement<T> p = placement(time_, done);
    const size_t cells = at(blocks_, 0);
    if (answers_.empty()) answers_.assign(cells * lanes, 0.f);
    if (model_ && given_.empty()) given_.assign(cells, S(0));
    for (int block = 0; block < blocks_; ++block) {
        const size_t k = at(block, 0);
        sample_nearest(p, n_, &x_[k], &phi_[k], &normal_[k], &surface_velocity_[k]);
    }
    std::vector<AdhesionRecord> near;
    std::vector<std::array<int, 3>> where;
    const double speed = 1 / std::sqrt(term.a_max * term.h_a);
    auto answer = [&](int block, int i, int lane) -> float& {
        return answers_[at(block, i) * lanes + size_t(lane)];
    };
    for (int s = 0; s < strands_; ++s)
        for (int i = 1; i < n_; ++i) {
            const int block = s / lanes, lane = s % lanes;
            const size_t k = at(block, i);
            if (!(saturation_[k][lane] > 0) || phi_[k].v[lane] > 2 * term.h_a) continue;
            AdhesionRecord r;
            const Vec3<T> n{normal_[k].x[lane], normal_[k].y[lane], normal_[k].z[lane]};
            for (int side = -1; side <= 1; ++side) {
                const int j = i + side < n_ ? i + side : i;
                const size_t m = at(block, j);
                const Vec3<S> slide = v_[m] - surface_velocity_[k];
                float* in = r.inputs + 4 * (side + 1);
                in[0] = float(touching_[m][lane]);
                in[1] = float((slide.x[lane] * n.x + slide.y[lane] * n.y + slide.z[lane] * n.z) * speed);
                in[2] = float(std::min(phi_[m][lane] / T(term.h_a), T(4)));
                in[3] = answer(block, j, lane);
            }
            float value, slope;
            Adhesion::shape(float(phi_[k][lane] / T(term.h_a)), value, slope);
            r.contact = touching_[k][lane] > 0;
            r.target = r.contact ? -value : 0;
            near.push_back(r);
            where.push_back({block, i, lane});
        }
    std::vector<float> out(near.size());
    if (model_) {
        std::vector<float> inputs;
        for (const auto& r : near) inputs.insert(inputs.end(), r.inputs, r.inputs + 12);
        if (!near.empty()) model_->evaluate(inputs.data(), near.size(), out.data());
        std::fill(given_.begin(), given_.end(), S(0));
    }
    std::fill(answers_.begin(), answers_.end(), 0.f);
    for (size_t k = 0; k < near.size(); ++k) {
        const auto [block, i, lane] = where[k];
        const float f = model_ ? (near[k].contact ? out[k] : 0.f) : near[k].target;
        answer(block, i, lane) = f;
        if (model_) given_[at(block, i)].set(lane, T(f));
    }
    if (records_) records_->insert(records_->end(), near.begin(), near.end());
}

// All that follows the saturation.
template <class T>
void CpuSimulation<T>::soak_strands() {
    const float* saturation = flow_->saturation().data();
#pragma omp parallel for schedule(static)
    for (int block = 0; block < blocks_; ++block)
        for (int lane = 0; lane < lanes; ++lane) {
            const int s = std::min(block * lanes + lane, strands_ - 1);
            const float* sigma = saturation + size_t(s) * size_t(n_);
            StrandRest rest;
            for (int i = 0; !push_.empty() && i + 1 < n_; ++i)
                rest.rest_length.push_back(double(rest_length_[at(block, i)][lane]));
            soak(scene_, soaking_[size_t(s)], sigma, rest);
            state_.put_water(scene_, block, lane, rest, sigma);
        }
    if (display_) display_->take_up_water(flow_->dry_mass());
    if (between_hair_) weigh_particles();
}

// Once a frame, since a block goes through all substeps of a frame at once, from where strands are seen: wet
// strands that are drawn together touch, and a surface wets what is seen to cross it. Water that comes takes
// on the velocity of the hair that it comes to. BDF2 goes on with its history: seen with masses that
// quadruple within a few frames, no energy comes of it, and a restart each frame loses up to a fifth more.
template <class T>
void CpuSimulation<T>::move_water() {
    const double begin = omp_get_wtime();
    if (!display_) unpack(x_, displayed_);
    if (!is_finite(displayed_)) return;
    const auto before = meters_.empty() ? std::vector<double>{} : energy();
    flow_->step(displayed_, time_, 1 / scene_.fps, scene_.integrator.gravity,
                display_ ? &display_->grid() : nullptr, display_ ? &display_->list() : nullptr);
    soak_strands();
    const auto after = meters_.empty() ? std::vector<double>{} : energy();
    for (size_t kind = 0; kind < after.size(); ++kind) water_work_ += after[kind] - before[kind];
    stage_[flow_stage_] = omp_get_wtime() - begin;
}

// What the strands feel of the air, where they are now.
template <class T>
void CpuSimulation<T>::sample_air() {
#pragma omp parallel for schedule(static)
    for (int block = 0; block < blocks_; ++block)
        for (size_t k = at(block, 0); k < at(block + 1, 0); ++k)
            for (int lane = 0; lane < lanes; ++lane) {
                const Vec3d u =
                    air_->at({double(x_[k].x[lane]), double(x_[k].y[lane]), double(x_[k].z[lane])});
                air_velocity_[k].x.set(lane, T(u.x));
                air_velocity_[k].y.set(lane, T(u.y));
                air_velocity_[k].z.set(lane, T(u.z));
            }
}

template <class T>
void CpuSimulation<T>::gather_hair_in_air() {
    const AirDrag& term = *std::get<std::optional<AirDrag>>(terms_);
#pragma omp parallel for schedule(static)
    for (int s = 0; s < strands_; ++s)
        for (int i = 0; i < n_; ++i) {
            const int block = s / lanes, lane = s % lanes;
            const size_t k = at(block, i);
            auto edge_length = [&](size_t edge) { return double(rest_length_[edge][lane]); };
            const double length =
                0.5 * ((i > 0 ? edge_length(k - 1) : 0) + (i + 1 < n_ ? edge_length(k) : 0));
            auto lane_of = [&](const Vec3<S>& p) {
                return Vec3f{float(p.x[lane]), float(p.y[lane]), float(p.z[lane])};
            };
            hair_in_air_[size_t(s) * size_t(n_) + size_t(i)] = {lane_of(x_[k]), lane_of(v_[k]),
                                                                float(term.c * length)};
        }
}

// Once a frame: a step of the air costs more than a substep of the strands, it is stable at any length, and a
// block of strands still goes through all substeps of a frame at once.
template <class T>
void CpuSimulation<T>::move_air() {
    const double begin = omp_get_wtime(), dt = 1 / scene_.fps;
    if (scene_.air->two_way) gather_hair_in_air();
    air_->step(dt, time_ + dt, hair_in_air_);
    sample_air();
    stage_[air_stage_] = omp_get_wtime() - begin;
}

template <class T>
void CpuSimulation<T>::move_surfaces() {
    const double begin = omp_get_wtime();
    const int substeps = scene_.integrator.substeps;
    surfaces_->advance(time_, time_ + substeps * dt_, substeps);
    stage_[surface_stage_] = omp_get_wtime() - begin;
}

template <class T>
bool CpuSimulation<T>::positions(std::vector<Vec3d>& out) const {
    out.resize(size_t(strands_) * size_t(n_));
    bool finite = true;
    for (int s = 0; s < strands_; ++s)
        for (int i = 0; i < n_; ++i) {
            const Vec3<S>& p = x_[at(s / lanes, i)];
            const int lane = s % lanes;
            const Vec3d x{double(p.x[lane]), double(p.y[lane]), double(p.z[lane])};
            finite = finite && std::abs(x.x) + std::abs(x.y) + std::abs(x.z) < 1e6;
            out[size_t(s) * size_t(n_) + size_t(i)] = x;
        }
    return finite;
}

// A compared method's forces at the positions as they are, for the substep that follows.
template <class T>
void CpuSimulation<T>::evaluate_forces() {
    const double begin = omp_get_wtime();
    // A run that blew up has no neighbours to find; the caller asks `divergence` next.
    if (!positions(force_x_)) return;
    forces_->evaluate(force_x_, time_, force_);
    if (!meters_.empty()) pulled_work_ += forces_->given(force_x_, time_, time_ + dt_);
    for (int s = 0; s < strands_; ++s)
        for (int i = 0; i < n_; ++i) {
            const Vec3d& f = force_[size_t(s) * size_t(n_) + size_t(i)];
            Vec3<S>& to = external_[at(s / lanes, i)];
            const int lane = s % lanes;
            to.x.set(lane, T(f.x)), to.y.set(lane, T(f.y)), to.z.set(lane, T(f.z));
        }
    stage_[forces_stage_] += omp_get_wtime() - begin;
}

// 1/m as strands feel it of each other; particles 0 and 1 go where the head takes them.
template <class T>
void CpuSimulation<T>::weigh_particles() {
    for (int s = 0; s < strands_; ++s)
        for (int i = 2; i < n_; ++i)
            between_hair_->inverse_mass[size_t(s) * size_t(n_) + size_t(i)] =
                float(1 / mass_[at(s / lanes, i)][s % lanes]);
}

// Impulses between strands at the end of a substep change the velocities of the history alike. Seen: with its
// positions changed to match, hair at rest trembles three times as much.
template <class T>
void CpuSimulation<T>::touch_strands() {
    const double begin = omp_get_wtime();
    Strands &x = between_hair_->x, &v = between_hair_->v;
    unpack(x_, x), unpack(v_, v);
    if (!is_finite(x)) return;
    auto kinetic = [&] { return meters_.empty() ? 0.0 : energy()[0]; };
    const double before = kinetic();
    between_hair_->resolve(dt_);
#pragma omp parallel for schedule(static)
    for (int block = 0; block < blocks_; ++block)
        for (int i = 2; i < n_; ++i) {
            Vec3<S> dv;
            for (int lane = 0; lane < lanes; ++lane)
                ChainState<S>::put(dv, lane,
                                   cast<double>(v.at(std::min(block * lanes + lane, strands_ - 1), i)));
            v_[at(block, i)] += dv, v_before_[at(block, i)] += dv;
        }
    between_work_ += kinetic() - before;
    stage_[between_stage_] += omp_get_wtime() - begin;
}

template <class T>
void CpuSimulation<T>::advance() {
    double begin = omp_get_wtime();
    const double start = begin;
    std::fill(stage_.begin(), stage_.end(), 0.0);
    if (flow_) move_water(), begin = omp_get_wtime();
    if (air_) move_air(), begin = omp_get_wtime();
    if (surfaces_) move_surfaces(), begin = omp_get_wtime();
    // What answers for all strands at once needs them at the same substep.
    const bool together = model_ || records_ || forces_ || between_hair_;
    std::vector<Placement<T>> path;
    for (int k = 0; k < scene_.integrator.substeps; ++k) {
        if (model_ || records_) evaluate_adhesion(k);
        if (forces_) evaluate_forces();
        time_ += dt_;
        path.push_back(placement(time_, k + 1));
        if (!together && k + 1 < scene_.integrator.substeps) continue;
        run(path);
        path.clear();
        if (between_hair_) touch_strands();
    }
    stage_[0] = omp_get_wtime() - begin;
    if (forces_) stage_[0] -= stage_[forces_stage_];
    if (between_hair_) stage_[0] -= stage_[between_stage_];
    display();
    frame_seconds_ = omp_get_wtime() - start;
}

template <class T>
void CpuSimulation<T>::display() {
    if (!display_) return;
    unpack(x_, displayed_);
    if (!is_finite(displayed_)) return;
    display_->apply(displayed_, head_, time_, surfaces_ ? surfaces_->at_end() : nullptr);
    stage_[1] = display_->list_seconds();
    stage_[2] = display_->seconds() - stage_[1];
}

template <class T>
void CpuSimulation<T>::unpack(const Buffer<Vec3<S>>& x, Strands& out) const {
    if (out.points.empty()) out = Strands(strands_, n_);
#pragma omp parallel for schedule(static)
    for (int s = 0; s < strands_; ++s)
        for (int i = 0; i < n_; ++i) {
            const Vec3<S>& p = x[at(s / lanes, i)];
            const int lane = s % lanes;
            out.at(s, i) = {float(p.x[lane]), float(p.y[lane]), float(p.z[lane])};
        }
}

template <class T>
std::vector<Pack<T>> CpuSimulation<T>::energy_of(int block) const {
    const ChainView<S> view = view_of(block);
    return energies(terms_, view, scene_.integrator.gravity);
}

template <class T>
std::vector<double> CpuSimulation<T>::energy() const {
    std::vector<double> sum(energy_kinds.size(), 0);
    for (int block = 0; block < blocks_; ++block) {
        const auto e = energy_of(block);
        for (size_t kind = 0; kind < e.size(); ++kind)
            sum[kind] += sum_of_lanes(e[kind], lanes_of_block(block));
    }
    if (forces_) {
        std::vector<Vec3d> x;
        sum.back() = positions(x) ? forces_->potential(x, time_) : NAN;
    }
    return sum;
}

template <class T>
void CpuSimulation<T>::count_work() {
    meters_.clear(), water_work_ = pulled_work_ = between_work_ = 0;
    for (int block = 0; block < blocks_; ++block)
        meters_.emplace_back(terms_, scene_.integrator.gravity, n_, lanes_of_block(block));
}

template <class T>
Work CpuSimulation<T>::work() const {
    Work sum;
    for (const auto& meter : meters_) sum += meter.work();
    sum.water = water_work_, sum.solids += pulled_work_, sum.strands = between_work_;
    return sum;
}

// The buffers of a state beside those of the simulation that it is read from, or that takes it.
template <class Chain, class State, class F>
void for_each_pair(Chain& chain, State& state, F f) {
    f(chain.x, state.x), f(chain.x_before, state.x_before), f(chain.v, state.v);
    f(chain.v_before, state.v_before), f(chain.frame, state.frame);
    f(chain.touching, state.touching), f(chain.pushed, state.pushed);
}

template <class S>
double lane_of(const S& a, int lane) {
    return double(a[lane]);
}
template <class S>
Vec3d lane_of(const Vec3<S>& a, int lane) {
    return {lane_of(a.x, lane), lane_of(a.y, lane), lane_of(a.z, lane)};
}
template <class S>
Quatd lane_of(const Quat<S>& a, int lane) {
    return {lane_of(a.w, lane), lane_of(a.x, lane), lane_of(a.y, lane), lane_of(a.z, lane)};
}

template <class T>
SimulationState CpuSimulation<T>::state() const {
    SimulationState out;
    out.time = time_, out.first = first_;
    if (flow_) out.saturation = flow_->exact();
    for_each_pair(state_, out, [&](const auto& from, auto& to) {
        for (int s = 0; !from.empty() && s < strands_; ++s)
            for (int i = 0; i < n_; ++i) to.push_back(lane_of(from[at(s / lanes, i)], s % lanes));
    });
    return out;
}

template <class T>
void CpuSimulation<T>::restore(const SimulationState& from) {
    time_ = from.time, first_ = from.first;
    head_ = scene_.motion.at(time_);
    if (surfaces_) surfaces_->hold(time_);
    for_each_pair(state_, from, [&](auto& to, const auto& values) {
        for (int s = 0; !to.empty() && !values.empty() && s < blocks_ * lanes; ++s)
            for (int i = 0; i < n_; ++i)
                ChainState<S>::put(to[at(s / lanes, i)], s % lanes,
                                   values[size_t(std::min(s, strands_ - 1)) * size_t(n_) + size_t(i)]);
    });
    if (flow_ && !from.saturation.empty()) flow_->restore(from.saturation), soak_strands();
    display();
}

template <class T>
void CpuSimulation<T>::snapshot(RunFrame& frame) const {
    frame.head = head_;
    unpack(x_, frame.positions);
    frame.displayed = display_ ? displayed_ : Strands();
    frame.seconds = frame_seconds_;
    frame.stage_seconds.assign(stage_.begin(), stage_.end());
    const auto sum = energy();
    frame.energy.assign(sum.begin(), sum.end());
    frame.saturation = flow_ ? flow_->saturation() : std::vector<float>{};
    frame.water.clear();
    if (const auto w = water()) frame.water = {w->held, w->taken, w->dripped, w->dried};
    frame.contact.clear();
    if (!touching_.empty())
        for (int s = 0; s < strands_; ++s)
            for (int i = 0; i < n_; ++i) frame.contact.push_back(touching_[at(s / lanes, i)][s % lanes] > 0);
}

template <class T>
std::optional<Divergence> CpuSimulation<T>::divergence() const {
    for (int s = 0; s < strands_; ++s) {
        const int block = s / lanes, lane = s % lanes;
        double length = 0;
        for (int i = 0; i + 1 < n_; ++i) length += double(rest_length_[at(block, i)][lane]);
        auto position = [&](int i) {
            const Vec3<S>& p = x_[at(block, i)];
            return Vec3d{double(p.x[lane]), double(p.y[lane]), double(p.z[lane])};
        };
        for (int i = 0; i < n_; ++i) {
            // Written so that NaN counts as far away.
            if (norm(position(i) - position(0)) <= 10 * length) continue;
            const auto e = energy_of(block);
            std::vector<double> of_strand;
            for (const auto& kind : e) of_strand.push_back(double(kind[lane]));
            return Divergence{s, energy_kinds[largest_energy(of_strand)]};
        }
    }
    return std::nullopt;
}

template <class T>
std::vector<BufferSize> CpuSimulation<T>::buffers() const {
    std::vector<BufferSize> out;
    auto add = [&](const char* name, const auto& b) {
        using Value = typename std::decay_t<decltype(b)>::value_type;
        if (!b.empty()) out.push_back({name, b.capacity() * sizeof(Value)});
    };
    ChainState<S>::for_each_buffer(state_, add);
    add("adhesion distance", phi_), add("adhesion normal", normal_);
    add("adhesion surface velocity", surface_velocity_), add("adhesion given", given_),
        add("adhesion answers", answers_);
    add("baseline forces", external_), add("baseline particles", force_x_), add("baseline answers", force_);
    if (forces_) out.push_back({"baseline lists", forces_->bytes()});
    if (between_hair_) out.push_back({StrandContact::name, between_hair_->bytes()});
    if (flow_) {
        out.push_back({"flow of water", flow_->bytes()});
        size_t numbers = 0;
        for (const auto& s : soaking_)
            numbers += s.dry_mass.capacity() + s.core.capacity() + s.rest_core.capacity() +
                       3 * (s.target.capacity() + s.helix.capacity());
        out.push_back({"rest states dry", numbers * sizeof(double)});
        if (!display_) add("positions of the flow", displayed_.points);
    }
    if (display_) {
        out.push_back({"cohesion lists", display_->bytes()});
        add("displayed positions", displayed_.points);
    }
    if (air_) out.push_back({"air", air_->bytes()}), add("hair in the air", hair_in_air_);
    size_t scratch = 0;
    for (const auto& s : scratch_)
        scratch += (s.predicted_x.size() + s.force.size() + s.core_pull.size() + s.limit_edge.size()) *
                       sizeof(Vec3<S>) +
                   s.diagonal.size() * sizeof(Sym3<S>) +
                   (s.upper1.size() + s.upper2.size()) * sizeof(Mat3<S>) + s.twist.size() * sizeof(S) +
                   s.hold.size() * sizeof(Hold<S>);
    out.push_back({"scratch of the threads", scratch});
    for (const auto& solid : scene_.solids)
        if (const auto* level_set = std::get_if<std::shared_ptr<const LevelSet>>(&solid.shape))
            out.push_back({"level set of " + solid.name, (*level_set)->bytes()});
    if (surfaces_) out.push_back({"level sets of deforming solids", surfaces_->bytes()});
    return out;
}

}  // namespace

std::unique_ptr<Simulation> make_simulation(const Scene& scene, const std::string& precision) {
    if (precision == "double") return std::make_unique<CpuSimulation<double>>(scene);
    return std::make_unique<CpuSimulation<float>>(scene);
}

}  // namespace wetcurl

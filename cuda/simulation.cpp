// The stepper on a CUDA device: one graph a frame.
#include "cuda/simulation.h"

#include <algorithm>
#include <array>
#include <optional>

#include "base/device_buffer.h"
#include "cuda/air_kernel.h"
#include "cuda/chain_kernel.h"
#include "cuda/chain_setup.h"
#include "cuda/cohesion_kernel.h"
#include "cuda/driver.h"
#include "solver/schedule.h"

namespace wetcurl {

std::vector<std::string> cuda_devices(std::string* reason) {
    int count = 0;
    std::vector<std::string> names;
    const cudaError_t status = cudaGetDeviceCount(&count);
    if (status != cudaSuccess) {
        if (reason) *reason = cudaGetErrorString(status);
        cudaGetLastError();  // forgotten: having none is no error
        return names;
    }
    for (int k = 0; k < count; ++k) {
        cudaDeviceProp properties;
        check_cuda(cudaGetDeviceProperties(&properties, k), "properties of the device");
        names.push_back(properties.name);
    }
    if (reason && names.empty()) *reason = "the driver lists none";
    return names;
}

namespace {

template <class T>
class CudaHair;

// Hair and the air around it on a device, each once a frame where the other is: as HairInAir.
template <class T>
class AirAround {
  public:
    AirAround(const Scene& scene, CudaHair<T>& hair)
        : scene_(scene), field_(*scene.air, 1 / scene.fps, length_of(hair), scene.term<AirDrag>()->c) {
        sample(hair);
    }
    void advance(CudaHair<T>& hair, double time) {
        field_.blow(time + 1 / scene_.fps);
        begin_.record(hair.stream());
        graph_.replay(hair.stream(), [&] {
            const BrakingHair<T> braking = hair.braking();
            field_.launch_step(scene_.air->two_way ? &braking : nullptr, hair.stream());
            sample(hair);
        });
        end_.record(hair.stream());
    }
    void finish() { seconds = end_.since(begin_); }
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
    AirDevice field_;
    Graph graph_;
    Event begin_, end_;
};

// The strands in a device's memory: a schedule's Hair, as CpuHair is one.
template <class T>
class CudaHair {
  public:
    using Number = T;
    using S = T;
    using Air = AirAround<T>;

    CudaHair(const Scene& scene, bool by_reference);

    // The host's view: as uploaded, and as fetched last.
    mutable ChainState<T> state;
    Pose head;
    bool first = true;  // no history: the next substep is backward Euler
    bool always_first() const { return scene_.integrator.kind != "implicit"; }
    Bdf2<T> scheme() const { return {T(dt_), first, T(predictor_share(scene_))}; }

    void begin_display(const std::vector<float>& saturation, double reach);
    void take_up_water(const std::vector<double>& dry_mass);
    const Display* lent_neighbours() const { return nullptr; }  // they stay on the device
    double neighbours_mean() const { return neighbours_mean_; }

    void fetch() const;
    void fetch_history() const;
    void give_state();
    void give_velocities();
    void give_water();
    void take_surfaces(const DeformingSolids& surfaces);

    void find_nearest(const Placement<T>& p);
    const NearestSurface<T>& nearest() const { return nearest_; }

    // A whole frame without history to wait for is one graph, which shows it too.
    void run(const std::vector<Placement<T>>& path, const GivenToChain<T>& given, bool ends_frame);
    void show(double time, const MovingGrid* surfaces);
    void positions(Strands& out) const { download(positions_, out); }
    const Strands& seen() const;

    std::vector<double> energy() const;
    std::optional<Divergence> divergence() const;
    long limited_edges() const { return limited_; }
    void count_work() { throw_uncounted(); }
    Work work() const { return throw_uncounted(), Work(); }
    bool counts_work() const { return false; }
    template <class Act>
    void count_change(double&, Act act) {
        act();
    }
    void list(BufferList& buffers) const;
    HairSeconds seconds;

    // What the air meets, and what it gives.
    BrakingHair<T> braking() const {
        return {x_.data(), v_.data(), rest_length_.data(), state.n, x_.size(), scene_.term<AirDrag>()->c};
    }
    Vec3<T>* air() const { return air_.data(); }
    cudaStream_t stream() const { return stream_.handle; }

  private:
    struct DeviceSurface {
        DeviceBuffer<float> phi_before, phi;
        DeviceBuffer<Vec3f> velocity;
    };
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
    void download(const DeviceBuffer<Vec3f>& from, Strands& to) const {
        to.count = state.strands, to.particles = state.n;
        download(from, to.points);
    }
    StrandMemory<T> memory() const;
    void take_given(const GivenToChain<T>& given);
    void put_motion(int slot, const Placement<T>& p);
    void upload_motion();
    void launch_chain(int substeps);
    void launch_display();
    void launch_frame();
    void read_report();
    std::vector<double> energies_of(int strand) const;

    const Scene& scene_;
    const double dt_;
    bool shown_ = false;  // what was run last is seen already
    mutable bool fetched_ = true, history_fetched_ = true;

    DeviceBuffer<Vec3<T>> x_, x_before_, v_, v_before_, root_, target_, push_, air_;
    DeviceBuffer<Quat<T>> frame_;
    DeviceBuffer<T> touching_, pushed_, mass_, rest_length_, rest_core_, saturation_, rest_depth_;
    const bool by_reference_;  // stepped by the CPU's own pass
    StrandGroup group_{};
    DeviceBuffer<T> room_;  // of strands that do not fit a processor
    DeviceBuffer<Vec3f> positions_, displayed_;
    mutable Strands seen_;
    // What others give, and where adhesion was asked for; empty where nobody does.
    NearestSurface<T> nearest_;
    DeviceBuffer<Vec3<T>> given_force_, given_normal_, given_surface_velocity_;
    DeviceBuffer<T> given_stiffness_, given_adhesion_, given_phi_;
    // Solids.
    std::vector<DeviceBuffer<float>> level_sets_;
    DeviceBuffer<ShapeView> shapes_;  // of rigid ones
    std::vector<DeviceSurface> surfaces_;
    // A frame's motion, substep by substep.
    const int slots_;
    const size_t solids_each_, deforming_each_;
    PinnedBuffer<SubstepMotion<T>> host_motion_;
    DeviceBuffer<SubstepMotion<T>> motion_;
    PinnedBuffer<DeviceSolid<T>> host_solids_;
    DeviceBuffer<DeviceSolid<T>> solids_;
    PinnedBuffer<ShapeView> host_deforming_;
    DeviceBuffer<ShapeView> deforming_;
    PinnedBuffer<FrameReport> host_report_;  // a blank one, and the last frame's
    DeviceBuffer<FrameReport> report_;
    const std::vector<float>* display_saturation_ = nullptr;
    std::optional<CohesionDevice> cohesion_;

    Stream stream_;
    std::array<Event, 4> events_;
    Graph graph_;  // of a frame
    double neighbours_mean_ = 0;
    long limited_ = 0;
};

size_t deforming_in(const Scene& scene) {
    return size_t(std::count_if(scene.solids.begin(), scene.solids.end(),
                                [](const Solid& s) { return s.deformation != nullptr; }));
}

// The tuned kernel takes implicit steps; a build for parity has none.
bool needs_reference(const Scene& scene) {
#ifdef WETCURL_PARITY
    return true;
#endif
    return !scene.integrator.is_implicit();
}

template <class T>
CudaHair<T>::CudaHair(const Scene& scene, bool by_reference)
    : state(scene),
      head(scene.motion.at(0)),
      scene_(scene),
      dt_(1 / (scene.fps * scene.integrator.substeps)),
      by_reference_(by_reference || needs_reference(scene)),
      slots_(scene.integrator.substeps),
      solids_each_(scene.solids.size()),
      deforming_each_(deforming_in(scene)),
      host_motion_(size_t(slots_)),
      motion_(size_t(slots_)),
      host_solids_(size_t(slots_) * solids_each_),
      solids_(size_t(slots_) * solids_each_),
      host_deforming_(size_t(slots_) * deforming_each_),
      deforming_(size_t(slots_) * deforming_each_),
      host_report_(2),
      report_(1) {
    give_state(), give_water();
    upload(state.air, air_), upload(state.root, root_), upload(state.rest_length, rest_length_),
        upload(state.rest_depth, rest_depth_);
    if (by_reference_) {
        const auto rules = substep_rules<T>(scene);
        room_ =
            DeviceBuffer<T>(size_t(state.strands) * reference_room(state.n, rules, !scene.solids.empty()));
    } else {
        group_ = strand_group<T>(state.n, state.strands, scene.chain);
        const size_t blocks = size_t((state.strands + group_.strands - 1) / group_.strands);
        if (!group_.near) room_ = DeviceBuffer<T>(blocks * group_.bytes / sizeof(T));
    }
    positions_ = DeviceBuffer<Vec3f>(scene.groom.rest.points.size());
    host_report_[0] = host_report_[1] = {};

    std::vector<ShapeView> shapes;
    for (const auto& solid : scene.solids) {
        if (solid.deformation) continue;
        ShapeView view = view_of(solid.shape);
        if (const auto* level_set = std::get_if<std::shared_ptr<const LevelSet>>(&solid.shape)) {
            level_sets_.emplace_back((*level_set)->phi());
            view.grid.phi = level_sets_.back().data();
        }
        shapes.push_back(view);
    }
    shapes_ = DeviceBuffer<ShapeView>(shapes);
}

template <class T>
void CudaHair<T>::begin_display(const std::vector<float>& saturation, double) {
    display_saturation_ = &saturation;
    displayed_ = DeviceBuffer<Vec3f>(positions_.size());
    cohesion_.emplace(*scene_.cohesion, state.strands, state.n, cast<float>(head.translation),
                      rest_depths_of(scene_));
    cohesion_->take_volumes(volumes_of(scene_), saturation);
}

template <class T>
void CudaHair<T>::take_up_water(const std::vector<double>& dry_mass) {
    std::vector<float> volume;
    for (size_t k = 0; k < dry_mass.size(); ++k)
        volume.push_back(
            float(scene_.wetness->wet_mass(dry_mass[k], (*display_saturation_)[k]) / scene_.volume_density));
    cohesion_->take_volumes(volume, *display_saturation_);
}

template <class T>
void CudaHair<T>::fetch() const {
    if (fetched_) return;
    download(x_, state.x), download(v_, state.v);
    download(frame_, state.frame), download(touching_, state.touching);
    fetched_ = true;
}
template <class T>
void CudaHair<T>::fetch_history() const {
    if (history_fetched_) return;
    download(x_before_, state.x_before), download(v_before_, state.v_before);
    download(pushed_, state.pushed);
    history_fetched_ = true;
}
template <class T>
void CudaHair<T>::give_state() {
    upload(state.x, x_), upload(state.x_before, x_before_), upload(state.frame, frame_);
    upload(state.touching, touching_), upload(state.pushed, pushed_);
    give_velocities();
}
template <class T>
void CudaHair<T>::give_velocities() {
    upload(state.v, v_), upload(state.v_before, v_before_);
}
template <class T>
void CudaHair<T>::give_water() {
    upload(state.mass, mass_), upload(state.saturation, saturation_);
    upload(state.rest_core, rest_core_), upload(state.target, target_), upload(state.push, push_);
}

template <class T>
void CudaHair<T>::take_surfaces(const DeformingSolids& surfaces) {
    surfaces_.resize(surfaces.level_sets().size());
    for (size_t k = 0; k < surfaces_.size(); ++k) {
        const MovingLevelSet& from = surfaces.level_sets()[k];
        upload(from.phi_before(), surfaces_[k].phi_before), upload(from.phi(), surfaces_[k].phi);
        upload(from.velocity(), surfaces_[k].velocity);
    }
}

template <class T>
void CudaHair<T>::find_nearest(const Placement<T>& p) {
    const size_t cells = state.x.size();
    nearest_.phi.resize(cells, T(1e9)), nearest_.normal.resize(cells, {T(0), T(1), T(0)});
    nearest_.velocity.resize(cells, {T(0), T(0), T(0)});
#pragma omp parallel for schedule(static)
    for (int s = 0; s < state.strands; ++s) {
        const size_t k = state.at(s, 0);
        sample_nearest(p, state.n, &state.x[k], &nearest_.phi[k], &nearest_.normal[k], &nearest_.velocity[k]);
    }
}

template <class T>
StrandMemory<T> CudaHair<T>::memory() const {
    return {state.n,
            state.strands,
            x_.data(),
            x_before_.data(),
            v_.data(),
            v_before_.data(),
            touching_.data(),
            pushed_.data(),
            frame_.data(),
            root_.data(),
            target_.data(),
            push_.data(),
            air_.data(),
            mass_.data(),
            rest_length_.data(),
            rest_core_.data(),
            saturation_.data(),
            rest_depth_.data(),
            given_force_.data(),
            given_stiffness_.data(),
            given_adhesion_.data(),
            given_phi_.data(),
            given_normal_.data(),
            given_surface_velocity_.data()};
}

template <class T>
void CudaHair<T>::take_given(const GivenToChain<T>& given) {
    auto take = [&](const auto* from, auto& to) {
        if (from && !to.size()) to = std::decay_t<decltype(to)>(x_.size());
        if (from) to.upload(from, x_.size());
    };
    take(given.force, given_force_), take(given.stiffness, given_stiffness_);
    take(given.adhesion, given_adhesion_);
    if (!given.adhesion) return void(given_adhesion_ = {});
    upload(nearest_.phi, given_phi_), upload(nearest_.normal, given_normal_);
    upload(nearest_.velocity, given_surface_velocity_);
}

template <class T>
void CudaHair<T>::put_motion(int slot, const Placement<T>& p) {
    const size_t begin = size_t(slot) * solids_each_, begin_deforming = size_t(slot) * deforming_each_;
    for (size_t k = 0; k < deforming_each_; ++k) {
        ShapeView& view = host_deforming_[begin_deforming + k];
        view = {};
        view.kind = ShapeView::Kind::moving_grid, view.grid = *p.deforming[k].shape;
        view.grid.phi = surfaces_[k].phi.data(), view.grid.phi_before = surfaces_[k].phi_before.data();
        view.grid.velocity = surfaces_[k].velocity.data();
    }
    std::vector<DeviceSolid<T>> solids;
    SubstepMotion<T> motion = substep_motion(p, shapes_.data(), deforming_.data() + begin_deforming, solids);
    motion.solids = solids_.data() + begin;
    host_motion_[size_t(slot)] = motion;
    std::copy(solids.begin(), solids.end(), host_solids_.data() + begin);
}

// From page-locked memory, which a graph reads anew each time it is replayed.
template <class T>
void CudaHair<T>::upload_motion() {
    auto copy = [&](auto& to, const auto& from) {
        if (to.size())
            check_cuda(
                cudaMemcpyAsync(to.data(), from.data(), to.bytes(), cudaMemcpyHostToDevice, stream_.handle),
                "motion");
    };
    copy(motion_, host_motion_), copy(solids_, host_solids_), copy(deforming_, host_deforming_);
    check_cuda(cudaMemcpyAsync(report_.data(), host_report_.data(), sizeof(FrameReport),
                               cudaMemcpyHostToDevice, stream_.handle),
               "report");
}

// The last `substeps` of the motion.
template <class T>
void CudaHair<T>::launch_chain(int substeps) {
    const bool given = given_force_.size() || given_adhesion_.size();
    const ChainLaunch<T> launch{memory(),
                                chain_constants<T>(scene_, dt_),
                                motion_.data() + slots_ - substeps,
                                substeps,
                                first,
                                always_first(),
                                set_of(scene_, given),
                                &report_.data()->limited,
                                room_.data(),
                                group_};
    if (by_reference_)
        launch_reference(launch, stream_.handle);
    else
        wetcurl::launch_chain(launch, stream_.handle);
}

// All of a frame after its substeps, up to the report for the host.
template <class T>
void CudaHair<T>::launch_display() {
    launch_unpack(memory(), positions_.data(), &report_.data()->diverged, stream_.handle);
    events_[1].record(stream_.handle);
    if (cohesion_) cohesion_->launch_lists(positions_.data(), report_.data(), stream_.handle);
    events_[2].record(stream_.handle);
    if (cohesion_)
        cohesion_->launch_passes(positions_.data(), motion_.data() + slots_ - 1, displayed_.data(),
                                 stream_.handle);
    events_[3].record(stream_.handle);
    check_cuda(cudaMemcpyAsync(&host_report_[1], report_.data(), sizeof(FrameReport), cudaMemcpyDeviceToHost,
                               stream_.handle),
               "report");
}

template <class T>
void CudaHair<T>::launch_frame() {
    upload_motion();
    events_[0].record(stream_.handle);
    launch_chain(slots_);
    launch_display();
}

template <class T>
void CudaHair<T>::run(const std::vector<Placement<T>>& path, const GivenToChain<T>& given, bool ends_frame) {
    head = path.back().head;
    fetched_ = history_fetched_ = false;
    take_given(given);
    shown_ = ends_frame && path.size() == size_t(slots_) && first == always_first();
    if (shown_) {
        for (int k = 0; k < slots_; ++k) put_motion(k, path[size_t(k)]);
        return graph_.replay(stream_.handle, [&] { launch_frame(); });
    }
    const StageTimer timer(seconds.chain);
    for (size_t done = 0; done < path.size();) {
        const int substeps = int(std::min(path.size() - done, size_t(slots_)));
        for (int k = slots_ - substeps; k < slots_; ++k) put_motion(k, path[done++]);
        upload_motion();
        launch_chain(substeps);
        first = always_first();
        check_cuda(cudaMemcpyAsync(&host_report_[1], report_.data(), sizeof(FrameReport),
                                   cudaMemcpyDeviceToHost, stream_.handle),
                   "report");
        check_cuda(cudaStreamSynchronize(stream_.handle), "substeps");
        limited_ += long(host_report_[1].limited);
    }
}

template <class T>
void CudaHair<T>::show(double time, const MovingGrid* surfaces) {
    if (!shown_) {
        put_motion(slots_ - 1, placement_at<T>(scene_, time, dt_, false, surfaces));
        upload_motion();
        launch_display();
    }
    read_report();
    if (shown_) seconds.chain = events_[1].since(events_[0]);
    if (cohesion_)
        seconds.lists = events_[2].since(events_[1]), seconds.cohesion = events_[3].since(events_[2]);
    shown_ = false;
}

template <class T>
void CudaHair<T>::read_report() {
    check_cuda(cudaStreamSynchronize(stream_.handle), "frame");
    limited_ += long(host_report_[1].limited);
    while (host_report_[1].overflow) {
        // Longer lists than ever before: the display again, with room for them. The graph holds the old
        // addresses.
        cohesion_->grow();
        graph_.forget();
        upload_motion();
        launch_display();
        check_cuda(cudaStreamSynchronize(stream_.handle), "frame");
    }
    neighbours_mean_ = double(host_report_[1].pairs) / double(positions_.size());
}

template <class T>
const Strands& CudaHair<T>::seen() const {
    download(cohesion_ ? displayed_ : positions_, seen_);
    return seen_;
}

// From the host's view.
template <class T>
std::vector<double> CudaHair<T>::energies_of(int strand) const {
    // A strand's numbers lie one after the other.
    auto of = [&](const auto& numbers) { return numbers.empty() ? nullptr : &numbers[state.at(strand, 0)]; };
    ChainView<T> view{};
    view.n = state.n;
    view.x = of(state.x), view.v = of(state.v), view.target = of(state.target);
    view.mass = of(state.mass), view.rest_length = of(state.rest_length);
    view.rest_core = of(state.rest_core), view.frame = of(state.frame);
    const auto e = energies(scene_.chain, view, scene_.integrator.gravity);
    return {e.begin(), e.end()};
}

template <class T>
std::vector<double> CudaHair<T>::energy() const {
    std::vector<std::vector<double>> each(size_t(state.strands));
#pragma omp parallel for schedule(static)
    for (int s = 0; s < state.strands; ++s) each[size_t(s)] = energies_of(s);
    std::vector<double> sum(kinds_of_energy(scene_.chain).size(), 0);
    for (const auto& e : each)
        for (size_t kind = 0; kind < e.size(); ++kind) sum[kind] += e[kind];
    return sum;
}

template <class T>
std::optional<Divergence> CudaHair<T>::divergence() const {
    const int strand = host_report_[1].diverged;
    if (strand >= state.strands) return std::nullopt;
    fetch();
    return Divergence{strand, kinds_of_energy(scene_.chain)[largest_energy(energies_of(strand))]};
}

template <class T>
void CudaHair<T>::list(BufferList& out) const {
    state.list(out);
    auto add = [&](const std::string& name, size_t bytes) {
        if (bytes) out.push_back({name, bytes});
    };
    add("room of the strands", room_.bytes());
    add("shown positions", positions_.bytes()), add("displayed positions", displayed_.bytes());
    if (cohesion_) add("cohesion lists", cohesion_->bytes());
    add("given to the strands", given_force_.bytes() + given_stiffness_.bytes() + given_adhesion_.bytes() +
                                    given_phi_.bytes() + given_normal_.bytes() +
                                    given_surface_velocity_.bytes());
    for (const auto& s : surfaces_)
        add("level set that deforms", s.phi.bytes() + s.phi_before.bytes() + s.velocity.bytes());
}

}  // namespace

void require_cuda_device(int device) {
    std::string reason;
    const auto names = cuda_devices(&reason);
    if (names.empty()) throw Error("--device cuda: no CUDA device is there (" + reason + ")");
    if (device < 0 || device >= int(names.size()))
        throw Error("--device cuda:" + std::to_string(device) + ": found " + std::to_string(names.size()) +
                    " device(s), counted from 0");
}

std::unique_ptr<Simulation> make_cuda_simulation(const Scene& scene, const std::string& precision, int device,
                                                 bool by_reference) {
    require_cuda_device(device);
    check_cuda(cudaSetDevice(device), "choice of the device");
    if (precision == "double") return std::make_unique<SimulationOf<CudaHair<double>>>(scene, by_reference);
    return std::make_unique<SimulationOf<CudaHair<float>>>(scene, by_reference);
}

}  // namespace wetcurl

// The stepper on a CUDA device: one graph a frame.
#include "cuda/simulation.h"

#include <omp.h>

#include <algorithm>
#include <array>
#include <optional>

#include "base/device_buffer.h"
#include "cuda/chain_kernel.h"
#include "cuda/chain_setup.h"
#include "cuda/cohesion_kernel.h"
#include "solver/chain_state.h"

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

// Owners of what the driver makes.
struct Stream {
    cudaStream_t handle = nullptr;
    Stream() { check_cuda(cudaStreamCreateWithFlags(&handle, cudaStreamNonBlocking), "stream"); }
    Stream(const Stream&) = delete;
    ~Stream() { cudaStreamDestroy(handle); }
};
struct Event {
    cudaEvent_t handle = nullptr;
    Event() { check_cuda(cudaEventCreate(&handle), "event"); }
    Event(const Event&) = delete;
    ~Event() { cudaEventDestroy(handle); }
};
struct Graph {
    cudaGraphExec_t handle = nullptr;
    Graph() = default;
    Graph(const Graph&) = delete;
    ~Graph() { reset(); }
    void reset() {
        if (handle) cudaGraphExecDestroy(handle);
        handle = nullptr;
    }
};

template <class T>
class CudaSimulation final : public Simulation {
    using S = SingleLane<T>;

  public:
    explicit CudaSimulation(const Scene& scene);
    void advance() override;
    void snapshot(RunFrame& frame) const override;
    std::optional<Divergence> divergence() const override;
    BufferList buffers() const override;
    double neighbours_mean() const override { return neighbours_mean_; }
    long limited_edges() const override { return limited_; }
    void use_adhesion_model(AdhesionModel* model) override {
        if (model) throw Error("--device cuda does not run a network in the loop; --device cpu does");
    }
    void record_adhesion(std::vector<AdhesionRecord>* records) override {
        if (records) throw Error("--device cuda does not record adhesion; --device cpu does");
    }

  private:
    // A buffer of the state as plain numbers, and back.
    template <class V, class Of>
    static void upload(const std::vector<Of>& host, DeviceBuffer<V>& to) {
        static_assert(sizeof(V) == sizeof(Of));
        to = DeviceBuffer<V>(host.size());
        to.upload(reinterpret_cast<const V*>(host.data()), host.size());
    }
    template <class V, class Of>
    static void download(const DeviceBuffer<V>& from, std::vector<Of>& host) {
        from.download(reinterpret_cast<V*>(host.data()));
    }
    StrandMemory<T> memory() const;
    void put_motion(int slot, const Placement<T>& p);
    void upload_motion();
    void launch_chain(int substeps);
    void launch_frame();
    void replay();
    void read_report();
    void mark(size_t event);
    std::vector<double> energies_of(int strand) const;

    const Scene& scene_;
    const double dt_;
    double time_ = 0;
    Pose head_;
    bool first_ = true, capturing_ = false;

    mutable ChainState<S> state_;  // as uploaded; snapshots bring x, v and frames back
    DeviceBuffer<Vec3<T>> x_, x_before_, v_, v_before_, root_, target_, push_;
    DeviceBuffer<Quat<T>> frame_;
    DeviceBuffer<T> touching_, pushed_, mass_, rest_length_, rest_core_, saturation_, rest_depth_;
    StrandGroup group_;
    DeviceBuffer<T> room_;  // of strands that do not fit a processor
    DeviceBuffer<Vec3f> positions_, displayed_;
    std::vector<DeviceBuffer<float>> level_sets_;
    DeviceBuffer<ShapeView> shapes_;
    // A frame's motion, substep by substep.
    int slots_;
    PinnedBuffer<SubstepMotion<T>> host_motion_;
    DeviceBuffer<SubstepMotion<T>> motion_;
    PinnedBuffer<DeviceSolid<T>> host_solids_;
    DeviceBuffer<DeviceSolid<T>> solids_;
    PinnedBuffer<FrameReport> host_report_;  // a blank one, and the last frame's
    DeviceBuffer<FrameReport> report_;
    std::optional<CohesionDevice> cohesion_;

    Stream stream_;
    std::array<Event, 4> events_;
    Graph graph_;  // of a frame
    std::array<double, 3> stage_{};
    double frame_seconds_ = 0, neighbours_mean_ = 0;
    long limited_ = 0;
};

template <class T>
CudaSimulation<T>::CudaSimulation(const Scene& scene)
    : scene_(scene),
      dt_(1 / (scene.fps * scene.integrator.substeps)),
      head_(scene.motion.at(0)),
      state_(scene),
      slots_(scene.integrator.substeps),
      host_motion_(size_t(slots_)),
      motion_(size_t(slots_)),
      host_solids_(size_t(slots_) * scene.solids.size()),
      solids_(size_t(slots_) * scene.solids.size()),
      host_report_(2),
      report_(1) {
    upload(state_.x, x_), upload(state_.x_before, x_before_), upload(state_.v, v_);
    upload(state_.v_before, v_before_), upload(state_.root, root_), upload(state_.target, target_);
    upload(state_.push, push_), upload(state_.frame, frame_), upload(state_.touching, touching_);
    upload(state_.pushed, pushed_), upload(state_.mass, mass_), upload(state_.rest_length, rest_length_);
    upload(state_.rest_core, rest_core_), upload(state_.saturation, saturation_);
    upload(state_.rest_depth, rest_depth_);
    group_ = strand_group<T>(state_.n, state_.strands, scene.chain);
    if (!group_.near) {
        const size_t blocks = size_t((state_.strands + group_.strands - 1) / group_.strands);
        room_ = DeviceBuffer<T>(blocks * group_.bytes / sizeof(T));
    }
    positions_ = DeviceBuffer<Vec3f>(scene.groom.rest.points.size());
    host_report_[0] = {};

    std::vector<ShapeView> shapes;
    for (const auto& solid : scene.solids) {
        ShapeView view = view_of(solid.shape);
        if (const auto* level_set = std::get_if<std::shared_ptr<const LevelSet>>(&solid.shape)) {
            level_sets_.emplace_back((*level_set)->phi());
            view.grid.phi = level_sets_.back().data();
        }
        shapes.push_back(view);
    }
    shapes_ = DeviceBuffer<ShapeView>(shapes);

    energy_kinds = kinds_of_energy(scene.chain);
    stages = {"chain"};
    if (scene.cohesion) {
        stages.insert(stages.end(), {"neighbours", "cohesion"});
        displayed_ = DeviceBuffer<Vec3f>(positions_.size());
        const std::vector<float> volume = volumes_of(scene);
        std::vector<float> wet_volume;
        for (size_t k = 0; k < volume.size(); ++k) wet_volume.push_back(volume[k] * scene.saturation[k]);
        cohesion_.emplace(*scene.cohesion, scene.groom.rest.count, scene.groom.rest.particles,
                          cast<float>(head_.translation), volume, wet_volume, rest_depths_of(scene));
    }
    const Placement<T> at_rest = placement_at<T>(scene, 0, dt_, false);
    for (int slot = 0; slot < slots_; ++slot) put_motion(slot, at_rest);
    upload_motion();
    for (long left = std::lround(scene.integrator.settle / dt_); left > 0; left -= slots_)
        launch_chain(int(std::min(left, long(slots_))));
    launch_frame();
    read_report();
}

template <class T>
StrandMemory<T> CudaSimulation<T>::memory() const {
    return {state_.n,           state_.strands,    x_.data(),      x_before_.data(),    v_.data(),
            v_before_.data(),   touching_.data(),  pushed_.data(), frame_.data(),       root_.data(),
            target_.data(),     push_.data(),      mass_.data(),   rest_length_.data(), rest_core_.data(),
            saturation_.data(), rest_depth_.data()};
}

template <class T>
void CudaSimulation<T>::put_motion(int slot, const Placement<T>& p) {
    const size_t begin = size_t(slot) * p.solids.size();
    std::vector<DeviceSolid<T>> solids;
    SubstepMotion<T> motion = substep_motion(p, shapes_.data(), solids);
    motion.solids = solids_.data() + begin;
    host_motion_[size_t(slot)] = motion;
    std::copy(solids.begin(), solids.end(), host_solids_.data() + begin);
}

// From page-locked memory, which a graph reads anew each time it is replayed.
template <class T>
void CudaSimulation<T>::upload_motion() {
    auto copy = [&](auto& to, const auto& from) {
        if (to.size())
            check_cuda(
                cudaMemcpyAsync(to.data(), from.data(), to.bytes(), cudaMemcpyHostToDevice, stream_.handle),
                "motion");
    };
    copy(motion_, host_motion_), copy(solids_, host_solids_);
    check_cuda(cudaMemcpyAsync(report_.data(), host_report_.data(), sizeof(FrameReport),
                               cudaMemcpyHostToDevice, stream_.handle),
               "report");
}

template <class T>
void CudaSimulation<T>::launch_chain(int substeps) {
    const ChainLaunch<T> launch{
        memory(),       chain_constants<T>(scene_, dt_), motion_.data(), substeps, first_,
        set_of(scene_), &report_.data()->limited,        room_.data(),   group_};
    wetcurl::launch_chain(launch, stream_.handle);
    first_ = false;
}

template <class T>
void CudaSimulation<T>::mark(size_t event) {
    const unsigned flags = capturing_ ? cudaEventRecordExternal : cudaEventRecordDefault;
    check_cuda(cudaEventRecordWithFlags(events_[event].handle, stream_.handle, flags), "event");
}

// All of a frame after its substeps, up to the report for the host.
template <class T>
void CudaSimulation<T>::launch_frame() {
    launch_unpack(memory(), positions_.data(), &report_.data()->diverged, stream_.handle);
    mark(1);
    if (cohesion_) cohesion_->launch_lists(positions_.data(), report_.data(), stream_.handle);
    mark(2);
    if (cohesion_)
        cohesion_->launch_passes(positions_.data(), motion_.data() + slots_ - 1, displayed_.data(),
                                 stream_.handle);
    mark(3);
    check_cuda(cudaMemcpyAsync(&host_report_[1], report_.data(), sizeof(FrameReport), cudaMemcpyDeviceToHost,
                               stream_.handle),
               "report");
}

template <class T>
void CudaSimulation<T>::read_report() {
    check_cuda(cudaStreamSynchronize(stream_.handle), "frame");
    limited_ += long(host_report_[1].limited);
    while (host_report_[1].overflow) {
        // Longer lists than ever before: the display again, with room for them. The graph holds the old
        // addresses.
        cohesion_->grow();
        graph_.reset();
        upload_motion();
        launch_frame();
        check_cuda(cudaStreamSynchronize(stream_.handle), "frame");
    }
    neighbours_mean_ = double(host_report_[1].pairs) / double(positions_.size());
}

// The frame as a graph, captured the first time that it is asked for.
template <class T>
void CudaSimulation<T>::replay() {
    auto launch = [&] {
        upload_motion();
        mark(0);
        launch_chain(slots_);
        launch_frame();
    };
    if (first_) return launch();  // no history: a launch like no other
    if (!graph_.handle) {
        cudaGraph_t captured;
        capturing_ = true;
        check_cuda(cudaStreamBeginCapture(stream_.handle, cudaStreamCaptureModeThreadLocal), "capture");
        launch();
        check_cuda(cudaStreamEndCapture(stream_.handle, &captured), "capture");
        capturing_ = false;
        const cudaError_t status = cudaGraphInstantiate(&graph_.handle, captured, 0);
        cudaGraphDestroy(captured);
        check_cuda(status, "graph");
    }
    check_cuda(cudaGraphLaunch(graph_.handle, stream_.handle), "launch of the frame");
}

template <class T>
void CudaSimulation<T>::advance() {
    const double begin = omp_get_wtime();
    Placement<T> p;
    for (int k = 0; k < slots_; ++k) {
        time_ += dt_;
        p = placement_at<T>(scene_, time_, dt_);
        put_motion(k, p);
    }
    head_ = p.head;
    replay();
    read_report();
    for (size_t k = 0; k + 1 < events_.size(); ++k) {
        float milliseconds = 0;
        check_cuda(cudaEventElapsedTime(&milliseconds, events_[k].handle, events_[k + 1].handle), "time");
        stage_[k] = 1e-3 * milliseconds;
    }
    frame_seconds_ = omp_get_wtime() - begin;
}

// From what the last snapshot brought back.
template <class T>
std::vector<double> CudaSimulation<T>::energies_of(int strand) const {
    // A strand's numbers lie one after the other.
    auto of = [&](const auto& numbers, auto plain) {
        using V = decltype(plain);
        return numbers.empty() ? nullptr : reinterpret_cast<const V*>(&numbers[state_.at(strand, 0)]);
    };
    ChainView<T> view{};
    view.n = state_.n;
    const Vec3<T> vector{};
    view.x = of(state_.x, vector), view.v = of(state_.v, vector), view.target = of(state_.target, vector);
    view.mass = of(state_.mass, T()), view.rest_length = of(state_.rest_length, T());
    view.rest_core = of(state_.rest_core, T()), view.frame = of(state_.frame, Quat<T>());
    const auto e = energies(scene_.chain, view, scene_.integrator.gravity);
    return {e.begin(), e.end()};
}

template <class T>
void CudaSimulation<T>::snapshot(RunFrame& frame) const {
    frame.head = head_;
    frame.positions = Strands(state_.strands, state_.n);
    positions_.download(frame.positions.points.data());
    frame.displayed = {};
    if (cohesion_) {
        frame.displayed = Strands(state_.strands, state_.n);
        displayed_.download(frame.displayed.points.data());
    }
    frame.seconds = frame_seconds_;
    frame.stage_seconds.assign(stage_.begin(), stage_.begin() + long(stages.size()));

    download(x_, state_.x), download(v_, state_.v);
    download(frame_, state_.frame), download(touching_, state_.touching);
    std::vector<std::vector<double>> each(size_t(state_.strands));
#pragma omp parallel for schedule(static)
    for (int s = 0; s < state_.strands; ++s) each[size_t(s)] = energies_of(s);
    std::vector<double> sum(energy_kinds.size(), 0);
    for (const auto& e : each)
        for (size_t kind = 0; kind < e.size(); ++kind) sum[kind] += e[kind];
    frame.energy.assign(sum.begin(), sum.end());
    frame.contact = state_.contacts();
}

template <class T>
std::optional<Divergence> CudaSimulation<T>::divergence() const {
    const int strand = host_report_[1].diverged;
    if (strand >= state_.strands) return std::nullopt;
    RunFrame frame;
    snapshot(frame);
    return Divergence{strand, energy_kinds[largest_energy(energies_of(strand))]};
}

template <class T>
BufferList CudaSimulation<T>::buffers() const {
    BufferList out;
    state_.list(out);
    auto add = [&](const std::string& name, size_t bytes) {
        if (bytes) out.push_back({name, bytes});
    };
    add("room of the strands", room_.bytes());
    add("shown positions", positions_.bytes()), add("displayed positions", displayed_.bytes());
    if (cohesion_) add("cohesion lists", cohesion_->bytes());
    for (const auto& l : level_sets_) add("level set", l.bytes());
    return out;
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

std::unique_ptr<Simulation> make_cuda_simulation(const Scene& scene, const std::string& precision,
                                                 int device) {
    require_cuda_device(device);
    check_cuda(cudaSetDevice(device), "choice of the device");
    if (scene.baseline)
        throw Error("--device cuda runs no compared method; --device cpu runs [baseline] method = \"" +
                    name_of(*scene.baseline) + "\"");
    if (scene.integrator.kind != "implicit")
        throw Error("--device cuda runs [integrator] kind = \"implicit\" alone; --device cpu runs \"" +
                    scene.integrator.kind + "\"");
    if (scene.flow) throw Error("--device cuda keeps water where it is; --device cpu runs [wetness.flow]");
    if (scene.has_deforming_solid())
        throw Error("--device cuda does not rebuild the level sets of [[solid.mesh]]; --device cpu does");
    if (scene.cohesion && scene.cohesion->strength > 0)
        throw Error(
            "--device cuda shows cohesion and steps without it; --device cpu runs [cohesion] strength");
    if (scene.strand_contact)
        throw Error("--device cuda steps strands apart from each other; --device cpu runs [strand_contact]");
    if (scene.air) throw Error("--device cuda does not move the air of [air]; --device cpu does");
    if (!scene.adhesion_model.empty())
        throw Error("--device cuda does not run a network in the loop; --device cpu does");
    if (precision == "double") return std::make_unique<CudaSimulation<double>>(scene);
    return std::make_unique<CudaSimulation<float>>(scene);
}

}  // namespace wetcurl

// Strands between host and device, and the launches of a frame.
#include "cuda/run/cuda_hair.h"

#include <algorithm>

#include "cuda/chain/chain_setup.h"
#include "solver/solids/rest_depths.h"

namespace wetcurl {

namespace {

size_t deforming_in(const Scene& scene) {
    return size_t(std::count_if(scene.solids.begin(), scene.solids.end(),
                                [](const Solid& s) { return s.deformation != nullptr; }));
}

size_t motions_in(const Scene& scene) {
    return size_t(scene.integrator.substeps) + (scene.term<Adhesion>() ? 1 : 0);
}

// The tuned kernel takes implicit steps; a build for parity has none.
bool needs_reference(const Scene& scene) {
#ifdef WETCURL_PARITY
    return true;
#endif
    return !scene.integrator.is_implicit();
}

}  // namespace

template <class T>
CudaHair<T>::CudaHair(const Scene& scene, Stepping stepping)
    : state(scene),
      head(scene.head_at(scene.begin())),
      scene_(scene),
      dt_(1 / (scene.fps * scene.integrator.substeps)),
      by_reference_(stepping == Stepping::by_reference || needs_reference(scene)),
      shapes_(scene),
      slots_(scene.integrator.substeps),
      solids_each_(scene.solids.size()),
      deforming_each_(deforming_in(scene)),
      motion_(motions_in(scene)),
      solids_(motions_in(scene) * solids_each_),
      deforming_(motions_in(scene) * deforming_each_),
      roots_(scene.riding ? motions_in(scene) * size_t(state.strands) : 0) {
    give_state(), give(StrandPart::water), give(StrandPart::fixed);
    if (by_reference_) {
        const auto rules = substep_rules<T>(scene);
        workspace_ = DeviceBuffer<T>(size_t(state.strands) *
                                     reference_workspace(state.n, rules, !scene.solids.empty()));
    } else {
        group_ = strand_group<T>(state.n, state.strands, scene.chain);
        const size_t blocks = size_t((state.strands + group_.strands - 1) / group_.strands);
        if (!group_.near) workspace_ = DeviceBuffer<T>(blocks * group_.bytes / sizeof(T));
    }
    positions_ = DeviceBuffer<Vec3f>(scene.groom.rest.points.size());
}

template <class T>
void CudaHair<T>::begin_display(const std::vector<float>& saturation) {
    displayed_ = DeviceBuffer<Vec3f>(positions_.size());
    cohesion_.emplace(*scene_.cohesion, state.strands, Thinning(scene_.groom.rest, *scene_.cohesion),
                      cast<float>(head.translation), volumes_of(scene_), saturation, scene_.flow.has_value(),
                      rest_depths_of(scene_));
}

template <class T>
void CudaHair<T>::launch_queued() const {
    for (const auto& launches : queued_) launches(stream_.handle);
    queued_.clear();
}
template <class T>
void CudaHair<T>::give(StrandPart part) {
    for_each_strand_array(
        [&](const StrandArrayInfo& info, const auto& host, auto& device) {
            if (info.part == part) upload(host, device);
        },
        state, arrays_);
}
template <class T>
void CudaHair<T>::fetch(StrandPart part) const {
    for_each_strand_array(
        [&](const StrandArrayInfo& info, auto& host, const auto& device) {
            if (info.part == part) download(device, host);
        },
        state, arrays_);
}
template <class T>
void CudaHair<T>::fetch() const {
    launch_queued(), fetch_water();
    if (!fetched_) fetch(StrandPart::motion);
    fetched_ = true;
}
template <class T>
void CudaHair<T>::fetch_history() const {
    if (!history_fetched_) fetch(StrandPart::history);
    history_fetched_ = true;
}
// It may still be on its way: nobody has waited for it since the frame began.
template <class T>
void CudaHair<T>::fetch_water() const {
    if (water_fetched_) return;
    check_cuda(cudaStreamSynchronize(stream_.handle), "water");
    fetch(StrandPart::water);
    water_fetched_ = true;
}
template <class T>
void CudaHair<T>::give_state() {
    give(StrandPart::motion), give(StrandPart::history);
}
// On the host, as the CPU does it: frames of one length are the usual ones.
template <class T>
void CudaHair<T>::take_steps_of(double dt) {
    if (dt == dt_) return;
    fetch(), fetch_history();
    first = first || !state.retime(dt_, dt);
    give_state();
    graph_.forget();
    dt_ = dt;
}
template <class T>
void CudaHair<T>::give_velocities() {
    upload(state.v, arrays_.v), upload(state.v_before, arrays_.v_before);
}

template <class T>
void CudaHair<T>::take_couplings(Forces* forces, StrandContacts* touching) {
    if constexpr (couples) {
        forces_ = forces, strand_contact_ = touching;
        if (forces || touching) {
            given_force_ = DeviceBuffer<Vec3<T>>(arrays_.x.size());
            marks_ = std::vector<Event>(marks_each * size_t(slots_) + 1);
        }
        if (touching || (forces && forces->has_stiffness()))
            given_stiffness_ = DeviceBuffer<T>(arrays_.x.size());
    }
}

template <class T>
void CudaHair<T>::take_network(const DenseLayers* layers) {
    graph_.forget();  // it knows who gives adhesion
    adhesion_.reset();
    if (!couples || !layers) return;
    upload(std::vector<T>(arrays_.x.size(), T(0)), given_adhesion_);  // no answer came before
    given_phi_ = DeviceBuffer<T>(arrays_.x.size());
    given_normal_ = DeviceBuffer<Vec3<T>>(arrays_.x.size());
    given_surface_velocity_ = DeviceBuffer<Vec3<T>>(arrays_.x.size());
    adhesion_.emplace(*scene_.term<Adhesion>(), *layers, arrays_.x.size());
}

template <class T>
std::vector<double> CudaHair<T>::answers() const {
    check_cuda(cudaStreamSynchronize(stream_.handle), "adhesion network");
    const std::vector<T> of_device = given_adhesion_.host();
    return {of_device.begin(), of_device.end()};
}
template <class T>
void CudaHair<T>::give_answers(const std::vector<double>& answers) {
    check_cuda(cudaStreamSynchronize(stream_.handle), "adhesion network");
    upload(std::vector<T>(answers.begin(), answers.end()), given_adhesion_);
}

template <class T>
void CudaHair<T>::find_nearest(const PosedScene<T>& p) {
    if (!given_phi_.size())
        given_phi_ = DeviceBuffer<T>(arrays_.x.size()),
        given_normal_ = DeviceBuffer<Vec3<T>>(arrays_.x.size()),
        given_surface_velocity_ = DeviceBuffer<Vec3<T>>(arrays_.x.size());
    put_motion(slots_ - 1, p), upload_motion();
    launch_nearest(memory(), motion_.device.data() + slots_ - 1, given_phi_.data(), given_normal_.data(),
                   given_surface_velocity_.data(), stream_.handle);
    check_cuda(cudaStreamSynchronize(stream_.handle), "nearest surfaces");
    download(given_phi_, nearest_.phi), download(given_normal_, nearest_.normal);
    download(given_surface_velocity_, nearest_.velocity);
}

template <class T>
StrandMemory<T> CudaHair<T>::memory() const {
    StrandMemory<T> m{};
    for_each_strand_array([](auto, auto& to, const auto& buffer) { to = buffer.data(); }, m, arrays_);
    m.n = state.n, m.strands = state.strands;
    m.given_force = given_force_.data(), m.given_stiffness = given_stiffness_.data();
    m.given_adhesion = given_adhesion_.data(), m.given_phi = given_phi_.data();
    m.given_normal = given_normal_.data(), m.given_surface_velocity = given_surface_velocity_.data();
    return m;
}

template <class T>
void CudaHair<T>::take_given(const GivenToChain<T>& given) {
    auto take = [&](const auto* from, auto& to) {
        if (from && !to.size()) to = std::decay_t<decltype(to)>(arrays_.x.size());
        if (from) to.upload(from, arrays_.x.size());
    };
    take(given.force, given_force_), take(given.stiffness, given_stiffness_);
    if (adhesion_) return;
    take(given.adhesion, given_adhesion_);
    if (!given.adhesion) given_adhesion_ = {};
}

template <class T>
void CudaHair<T>::put_motion(int slot, const PosedScene<T>& p) {
    const size_t begin = size_t(slot) * solids_each_, begin_deforming = size_t(slot) * deforming_each_;
    for (size_t k = 0; k < deforming_each_; ++k) {
        ShapeView& view = deforming_.host[begin_deforming + k];
        view = {};
        view.kind = ShapeView::Kind::moving_grid, view.grid = *p.deforming[k].shape;
    }
    SubstepMotion<T> motion = substep_motion(p, shapes_.data(), deforming_.device.data() + begin_deforming,
                                             solids_.host.data() + begin);
    motion.solids = solids_.device.data() + begin;
    const size_t begin_roots = size_t(slot) * p.roots.size();
    std::copy(p.roots.begin(), p.roots.end(), roots_.host.data() + begin_roots);
    motion.roots = roots_.device.data() + begin_roots;
    motion_.host[size_t(slot)] = motion;
    if (forces_ && slot < slots_) forces_->put_motion(slot, p.begins);
}

template <class T>
void CudaHair<T>::upload_motion() {
    motion_.send(stream_.handle), solids_.send(stream_.handle), deforming_.send(stream_.handle);
    roots_.send(stream_.handle);
    if (forces_) forces_->upload_motion(stream_.handle);
    report_.clear(stream_.handle);
}

// The last `substeps` of the motion: at once, or one by one where others act on the strands in each.
template <class T>
void CudaHair<T>::launch_substeps(int substeps) {
    const int begin = slots_ - substeps;
    if (!forces_ && !strand_contact_ && !adhesion_) return launch_chain(begin, substeps, first);
    auto mark = [&](int slot, size_t k) {
        if (!marks_.empty()) marks_[marks_each * size_t(slot) + k].record(stream_.handle);
    };
    for (int slot = begin; slot < slots_; ++slot) {
        const bool begins = always_first() || (first && slot == begin), last = slot + 1 == slots_;
        const Bdf2<T> scheme{T(dt_), begins, T(predictor_share(scene_))};
        FrameReport* const report = report_.data();
        mark(slot, 0);
        if (forces_)
            forces_->launch(memory(), scheme, slot, given_force_.data(), given_stiffness_.data(),
                            last ? &report->pulled : nullptr, stream_.handle);
        mark(slot, 1);
        if (strand_contact_)
            strand_contact_->launch(memory(), scheme, dt_, forces_ != nullptr, given_force_.data(),
                                    given_stiffness_.data(), &report->touching, stream_.handle);
        mark(slot, 2);
        if (adhesion_)
            adhesion_->launch(memory(), motion_.device.data() + (slot == begin ? slots_ : slot - 1),
                              {given_phi_.data(), given_normal_.data(), given_surface_velocity_.data(),
                               arrays_.touching.data()},
                              given_adhesion_.data(), stream_.handle);
        launch_chain(slot, 1, begins);
    }
    mark(slots_, 0);
}

template <class T>
void CudaHair<T>::launch_chain(int slot, int substeps, bool begins) {
    const bool given = given_force_.size() || given_adhesion_.size();
    const ChainLaunch<T> launch{memory(),
                                chain_constants<T>(scene_, dt_),
                                motion_.device.data() + slot,
                                substeps,
                                begins,
                                always_first(),
                                set_of(scene_, given),
                                &report_.data()->limited,
                                workspace_.data(),
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
        cohesion_->launch_passes(positions_.data(), motion_.device.data() + slots_ - 1, displayed_.data(),
                                 stream_.handle);
    events_[3].record(stream_.handle);
    report_.fetch(stream_.handle);
}

template <class T>
void CudaHair<T>::launch_frame() {
    launch_queued();
    upload_motion();
    events_[0].record(stream_.handle);
    if (strand_contact_) strand_contact_->begin_frame();
    launch_substeps(slots_);
    launch_display();
}

template <class T>
void CudaHair<T>::run(const std::vector<PosedScene<T>>& path, const GivenToChain<T>& given, bool ends_frame) {
    head = path.back().head;
    fetched_ = history_fetched_ = false;
    take_given(given);
    shown_ = ends_frame && path.size() == size_t(slots_) && first == always_first();
    if (shown_) {
        for (int k = 0; k < slots_; ++k) put_motion(k, path[size_t(k)]);
        if (queued_in_graph_ != queued_.size()) graph_.forget();
        queued_in_graph_ = queued_.size();
        graph_.replay(stream_.handle, [&] { launch_frame(); });
        return queued_.clear();
    }
    launch_queued();
    const StageTimer timer(seconds.chain);
    for (size_t done = 0; done < path.size();) {
        const int substeps = int(std::min(path.size() - done, size_t(slots_)));
        for (int k = slots_ - substeps; k < slots_; ++k) put_motion(k, path[done++]);
        upload_motion();
        launch_substeps(substeps);
        first = always_first();
        report_.fetch(stream_.handle);
        check_cuda(cudaStreamSynchronize(stream_.handle), "substeps");
        limited_ += long(report_.last().limited);
        read_couplings(substeps);
    }
}

template <class T>
void CudaHair<T>::show(double time, const MovingGrid* surfaces) {
    if (!shown_) {
        put_motion(slots_ - 1, posed_scene_at<T>(scene_, time, dt_, false, surfaces));
        upload_motion();
        launch_display();
    }
    read_report();
    if (shown_) seconds.chain += events_[1].since(events_[0]);
    if (cohesion_)
        seconds.lists = events_[2].since(events_[1]), seconds.cohesion = events_[3].since(events_[2]);
    shown_ = false;
}

template <class T>
void CudaHair<T>::read_report() {
    check_cuda(cudaStreamSynchronize(stream_.handle), "frame");
    limited_ += long(report_.last().limited);
    if (shown_) read_couplings(slots_);
    while (cohesion_ && cohesion_->grow(report_.last())) {
        // Longer lists than ever before: the display again, with room for them. The graph holds the old
        // addresses.
        graph_.forget();
        upload_motion();
        launch_display();
        check_cuda(cudaStreamSynchronize(stream_.handle), "frame");
    }
    if (cohesion_) neighbours_mean_ = double(report_.last().pairs) / double(cohesion_->asked());
}

// Of substeps that are done: the time that was not the steps' own, and who was near.
template <class T>
void CudaHair<T>::read_couplings(int substeps) {
    if (!forces_ && !strand_contact_) return;
    double pulling = 0, touching = 0;
    for (size_t mark = marks_each * size_t(slots_ - substeps); mark + 1 < marks_.size(); mark += marks_each) {
        pulling += marks_[mark + 1].since(marks_[mark]);
        touching += marks_[mark + 2].since(marks_[mark + 1]);
    }
    seconds.chain -= pulling + touching;
    if (forces_) forces_->seconds += pulling, forces_->pairs = report_.last().pulled;
    if (!strand_contact_) return;
    strand_contact_->seconds += touching;
    if (strand_contact_->found() || substeps == slots_) strand_contact_->links = report_.last().touching;
}

template <class T>
void CudaHair<T>::begin_record(RunFrame&) {
    if (!record_) {
        record_.emplace(state.strands, state.n, kinds_of_energy(scene_.chain).size(), cohesion_.has_value(),
                        arrays_.touching.size() > 0);
        // The first frame need not wait for the capture, which is slow while another thread touches its
        // frame's memory for the first time.
        if (first == always_first() && queued_.size() == queued_in_graph_)
            graph_.prepare(stream_.handle, [&] { launch_frame(); });
    }
    record_->begin(memory(), chain_constants<T>(scene_, dt_), positions_.data(), displayed_.data(),
                   stream_.handle);
}

template <class T>
std::vector<T> CudaHair<T>::energies() const {
    DeviceBuffer<T> energy(size_t(state.strands) * kinds_of_energy(scene_.chain).size());
    launch_record<T>(memory(), chain_constants<T>(scene_, dt_), energy.data(), nullptr, stream_.handle);
    check_cuda(cudaStreamSynchronize(stream_.handle), "energies");
    return energy.host();
}

template <class T>
std::vector<double> CudaHair<T>::energy() const {
    return sum_over_strands(energies().data(), state.strands, kinds_of_energy(scene_.chain).size());
}

template <class T>
std::optional<Divergence> CudaHair<T>::divergence() const {
    const int strand = report_.last().diverged;
    if (strand >= state.strands) return std::nullopt;
    const auto kinds = kinds_of_energy(scene_.chain);
    const std::vector<T> all = energies();
    const auto first = all.begin() + long(size_t(strand) * kinds.size());
    return Divergence{strand, kinds[largest_energy({first, first + long(kinds.size())})]};
}

template <class T>
void CudaHair<T>::list(BufferList& out) const {
    state.list(out);
    auto add = [&](const std::string& name, size_t bytes, BufferUse use = BufferUse::coupling) {
        if (bytes) out.push_back({name, bytes, use});
    };
    add("scratch of the strands", workspace_.bytes(), BufferUse::scratch);
    add("shown positions", positions_.bytes(), BufferUse::scratch);
    add("displayed positions", displayed_.bytes(), BufferUse::displayed);
    if (cohesion_) add("cohesion lists", cohesion_->bytes(), BufferUse::lists);
    if (record_) add("frame on its way out", record_->bytes(), BufferUse::scratch);
    if (adhesion_) add("adhesion network", adhesion_->bytes());
    add("given to the strands", given_force_.bytes() + given_stiffness_.bytes() + given_adhesion_.bytes() +
                                    given_phi_.bytes() + given_normal_.bytes() +
                                    given_surface_velocity_.bytes());
}

static_assert(Hair<CudaHair<float>> && Hair<CudaHair<double>>);
template class CudaHair<float>;
template class CudaHair<double>;

}  // namespace wetcurl

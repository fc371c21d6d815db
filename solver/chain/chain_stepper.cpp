// The substep of a block of strands, and what is told of all of them.
#include "solver/chain/chain_stepper.h"

#include <omp.h>

#include <algorithm>

#include "solver/chain/scene_checks.h"

namespace wetcurl {

// Asking a level set gathers from its nodes, asking many solids walks a tree; those that deform come near by
// themselves.
static bool far_pays(const Scene& scene) {
    const auto sampled = [](const auto& solid) {
        return std::holds_alternative<std::shared_ptr<const LevelSet>>(solid.shape);
    };
    return scene.integrator.is_implicit() && !scene.has_deforming_solid() &&
           (scene.solids.size() > most_solids_in_a_loop || std::ranges::any_of(scene.solids, sampled));
}

template <class T>
ChainStepper<T>::ChainStepper(const Scene& scene)
    : state(scene),
      head(scene.head_at(scene.begin())),
      scene_(scene),
      n_(state.n),
      dt_(1 / (scene.fps * scene.integrator.substeps)),
      rules_(substep_rules<T>(scene)),
      share_(T(predictor_share(scene))) {
    const size_t cells = state.touching.size();
    nearest_.phi.assign(cells, S(1e9));
    nearest_.normal.assign(cells, {S(0), S(1), S(0)}), nearest_.velocity.assign(cells, {S(0), S(0), S(0)});
    while (scratch_.size() < size_t(omp_get_max_threads()))
        scratch_.emplace_back(n_, scene.chain, scene.integrator.is_implicit(), !scene.solids.empty());
    while (far_pays(scene) && far_.size() < scratch_.size()) far_.emplace_back(n_);
}

template <class T>
ChainView<Pack<T>> ChainStepper<T>::view_of(int block) const {
    auto from = [&](const auto& buffer) {
        return buffer.empty() ? nullptr : buffer.data() + state.at(block, 0);
    };
    ChainView<S> view{};
    view.n = n_;
    view.set_arrays(state.pointers(block));
    view.phi = from(nearest_.phi), view.normal = from(nearest_.normal);
    view.surface_velocity = from(nearest_.velocity);
    return view;
}

// Of the lanes of a block.
template <class T>
RootMotion<Pack<T>> ChainStepper<T>::root_motion_of(int block, const PosedScene<T>& p) const {
    if (p.roots.empty()) return cast<S>(p.head_motion);
    RootMotion<S> out;
    for (int lane = 0; lane < S::lanes; ++lane) {
        const RootMotion<T>& one = p.roots[size_t(state.strand_of(block, lane))];
        const auto put = [&](auto& to, const auto& value) {
            ChainState<S>::put(to, lane, cast<double>(value));
        };
        put(out.rotation, one.rotation), put(out.turn, one.turn), put(out.translation, one.translation);
        put(out.spin, one.spin), put(out.velocity, one.velocity);
    }
    return out;
}

// One substep. The new state is written over the one before.
template <class T>
void ChainStepper<T>::step_block(int block, const BlockState& now, const PosedScene<T>& p,
                                 const GivenToChain<S>& given, bool first, ChainScratch<S>& scratch,
                                 FarFromSolids<S>* far) {
    const size_t k = state.at(block, 0);
    auto from = [&](auto& buffer) { return buffer.empty() ? nullptr : &buffer[k]; };
    const RootMotion<S> of_root = root_motion_of(block, p);
    const Vec3<S>* in_frame = &state.root[size_t(block) * 2];
    const Vec3<S> root[2] = {of_root(in_frame[0]), of_root(in_frame[1])};
    BlockStep<S> step{.n = n_,
                      .dt = T(dt_),
                      .first = first,
                      .x = now.x,
                      .x_before = now.x_before,
                      .v = now.v,
                      .v_before = now.v_before,
                      .root = root,
                      .gravity = cast<T>(scene_.integrator.gravity),
                      .root_turn = of_root.turn,
                      .frame = from(state.frame),
                      .pushed = from(state.pushed),
                      .external = given.force ? given.force + k : nullptr,
                      .external_stiffness = given.stiffness ? given.stiffness + k : nullptr,
                      .share = share_,
                      .max_linearisations = scene_.integrator.max_linearisations,
                      .relinearise_angle = T(scene_.integrator.relinearise_angle)};
    WorkMeter<S>* meter = meters_.empty() ? nullptr : &meters_[size_t(block)];
    if (meter) step.reaction = meter->begin(step);
    ChainView<S> view = view_of(block);
    view.given_adhesion = given.adhesion ? given.adhesion + k : nullptr;
    view.set_root(of_root);
    const NearestView<S> near{from(nearest_.phi), from(nearest_.normal), from(nearest_.velocity),
                              from(state.touching)};
    const int limited =
        take_substep(rules_, step, view, near, from(state.rest_depth), SurfacesOf<S>{p, far}, scratch, meter);
    if (limited > 0) {
#pragma omp atomic
        limited_ += limited;
    }
}

template <class T>
void ChainStepper<T>::run(const std::vector<PosedScene<T>>& path, const GivenToChain<S>& given) {
#pragma omp parallel for schedule(dynamic)
    for (int block = 0; block < state.blocks; ++block) {
        const size_t k = state.at(block, 0);
        BlockState now{&state.x[k], &state.x_before[k], &state.v[k], &state.v_before[k]};
        const size_t thread = size_t(omp_get_thread_num());
        FarFromSolids<S>* far = far_.empty() ? nullptr : &far_[thread];
        if (far) far->forget();
        bool begins = first;
        for (const auto& p : path) {
            step_block(block, now, p, given, begins, scratch_[thread], far);
            std::swap(now.x, now.x_before);
            std::swap(now.v, now.v_before);
            begins = always_first();
        }
    }
    if (path.size() % 2) {
        std::swap(state.x, state.x_before);
        std::swap(state.v, state.v_before);
    }
    head = path.back().head;
    first = always_first();
}

template <class T>
void ChainStepper<T>::find_nearest(const PosedScene<T>& p) {
    for (int block = 0; block < state.blocks; ++block) {
        const size_t k = state.at(block, 0);
        sample_nearest(p, n_, &state.x[k], &nearest_.phi[k], &nearest_.normal[k], &nearest_.velocity[k]);
    }
}

template <class T>
std::vector<Pack<T>> ChainStepper<T>::energy_of(int block) const {
    const ChainView<S> view = view_of(block);
    return energies(scene_.chain, view, scene_.integrator.gravity);
}

template <class T>
std::vector<double> ChainStepper<T>::energy() const {
    std::vector<double> sum(kinds_of_energy(scene_.chain).size(), 0);
    for (int block = 0; block < state.blocks; ++block) {
        const auto e = energy_of(block);
        for (size_t kind = 0; kind < e.size(); ++kind)
            sum[kind] += sum_of_lanes(e[kind], state.strands_in(block));
    }
    return sum;
}

template <class T>
std::optional<Divergence> ChainStepper<T>::divergence() const {
    for (int s = 0; s < state.strands; ++s) {
        const int block = s / S::lanes, lane = s % S::lanes;
        const size_t k = state.at(block, 0);
        double length = 0;
        for (int i = 0; i + 1 < n_; ++i) length += double(state.rest_length[k + size_t(i)][lane]);
        auto position = [&](int i) { return state.template lane_of<double>(state.x[k + size_t(i)], lane); };
        for (int i = 0; i < n_; ++i) {
            // Written so that NaN counts as far away.
            if (norm(position(i) - position(0)) <= 10 * length) continue;
            std::vector<double> of_strand;
            for (const auto& kind : energy_of(block)) of_strand.push_back(double(kind[lane]));
            return Divergence{s, kinds_of_energy(scene_.chain)[largest_energy(of_strand)]};
        }
    }
    return std::nullopt;
}

template <class T>
void ChainStepper<T>::count_work() {
    meters_.clear();
    for (int block = 0; block < state.blocks; ++block)
        meters_.emplace_back(scene_.chain, scene_.integrator.gravity, n_, state.strands_in(block));
}

template <class T>
Work ChainStepper<T>::work() const {
    Work sum;
    for (const auto& meter : meters_) sum += meter.work();
    return sum;
}

template <class T>
void ChainStepper<T>::list(BufferList& buffers) const {
    state.list(buffers);
    add_buffer(buffers, "adhesion distance", nearest_.phi, BufferUse::written);
    add_buffer(buffers, "adhesion normal", nearest_.normal, BufferUse::written);
    add_buffer(buffers, "adhesion surface velocity", nearest_.velocity, BufferUse::written);
    size_t bytes = 0;
    for (const auto& s : scratch_) bytes += s.bytes();
    for (const auto& f : far_) bytes += f.left.size() * (sizeof(S) + sizeof(Vec3<S>));
    buffers.push_back({"scratch of the threads", bytes, BufferUse::scratch});
}

template class ChainStepper<float>;
template class ChainStepper<double>;

}  // namespace wetcurl

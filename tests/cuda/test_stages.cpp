// The stages of a substep (solver/chain/stages.h) over all shipped scenes: what each leaves of a block of
// strands, a lane a strand, beside what it leaves of the same strands held otherwise, which begin it from the
// same numbers. In implicit steps that is a team of threads, in explicit ones the reference kernel's plain
// numbers. Compiled without fused multiply-add: the same formula of the same numbers has the same bits.
#include <array>
#include <mutex>

#include "cuda/chain/chain_setup.h"
#include "solver/chain/chain_stepper.h"
#include "tests/cuda/host_team.h"
#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;
using S = Pack<double>;

// --- what stages leave

// Of each particle or edge of a strand, up to four numbers.
enum class Quantity {
    expected_position,
    expected_velocity,
    gap,
    holds,  // the momentum of surfaces; the spring that holds the particle and its friction, 0: not held
    frame,
    limit_edge,
    core_force,
    solution,
    position,
    velocity,
    position_before,
    velocity_before,
    momentum,
    touching
};
constexpr const char* names[] = {
    "expected position",        "expected velocity", "gap",      "holds",       "frame",
    "edge of the strain limit", "force of the core", "solution", "position",    "velocity",
    "position before",          "velocity before",   "momentum", "contact flag"};
using Numbers = std::array<double, 4>;
Numbers numbers_of(double a) { return {a, 0, 0, 0}; }
Numbers numbers_of(const Vec3d& a) { return {a.x, a.y, a.z, 0}; }
Numbers numbers_of(const Quatd& a) { return {a.w, a.x, a.y, a.z}; }
Vec3d vector_of(const Numbers& a) { return {a[0], a[1], a[2]}; }
// Of a strand of n particles it is there for first .. end - 1.
struct Range {
    int first, end;
};
Range range_of(Quantity q, int n) {
    switch (q) {
        case Quantity::gap:
        case Quantity::holds:
        case Quantity::momentum:
            return {2, n};
        case Quantity::limit_edge:
            return {1, n - 1};
        case Quantity::frame:
            return {0, n - 1};
        // That of edge 0 acts on prescribed particles alone: the team does not complete it.
        case Quantity::core_force:
            return {1, n - 1};
        default:
            return {0, n};
    }
}

// `bound`: how far it may be from the block's, of the largest of the strand or of `least`, in the quantity's
// unit. 0: the same bits.
struct Leaves {
    Quantity quantity;
    double bound = 0, least = 0;
};
using Left = std::vector<Leaves>;
Left left_by(stage::Predict) { return {{Quantity::expected_position}, {Quantity::expected_velocity}}; }
Left left_by(stage::FindHolds) { return {{Quantity::gap}, {Quantity::holds}}; }
Left left_by(stage::CarryFrames) { return {{Quantity::frame}}; }
Left left_by(stage::PlaceLimit) { return {{Quantity::limit_edge}}; }
// The team eliminates chunks of the tridiagonal system from both sides.
Left left_by(stage::RelaxTwist) { return {{Quantity::frame, 1e-9}}; }
// The team sums the filter of Eq 2 chunk by chunk. At rest the core's forces are rounding alone: 1e-7 N is
// less than the weight of a particle.
Left left_by(stage::Prepare) { return {{Quantity::core_force, 1e-9, 1e-7}}; }
// The block keeps them for later stages, the team asks again wherever it needs them.
Left left_by(stage::SampleSurfaces) { return {}; }
// The team eliminates the system from both ends of the strand.
Left left_by(stage::Solve) { return {{Quantity::solution, 1e-7, 1e-3}}; }
Left left_by(stage::MoveLimit) { return {{Quantity::limit_edge}}; }
Left left_by(stage::MoveHolds) { return {{Quantity::holds}}; }
Left left_by(stage::Relinearise) { return {{Quantity::expected_position}, {Quantity::expected_velocity}}; }
// Where forces are taken anew the block adds up how the gap changes, the team takes the change as a whole.
Left left_by(stage::Place) { return {{Quantity::momentum, 1e-9, 1e-12}}; }
Left left_by(stage::MeetSolids) {
    return {
        {Quantity::position}, {Quantity::velocity}, {Quantity::position_before}, {Quantity::velocity_before}};
}
Left left_by(stage::UpdateTouching) { return {{Quantity::touching}}; }
Left left_by(stage::EndFrames) { return {{Quantity::frame}}; }
Left left_by(stage::Push) { return {{Quantity::position}, {Quantity::velocity}}; }
Left left_by(stage::LimitVelocities) { return {{Quantity::position}, {Quantity::velocity}}; }
Left left_by(stage::LimitStrain) {
    return {{Quantity::position}, {Quantity::velocity}, {Quantity::velocity_before}};
}

// A pass: the stages that are taken together.
template <class... Stage>
std::string name_of_pass() {
    std::string name;
    ((name += std::string(name.empty() ? "" : " + ") + Stage::name), ...);
    return name;
}
template <class... Stage>
Left left_by_pass(Stage... stages) {
    Left all;
    for (const Left& left : {left_by(stages)...}) all.insert(all.end(), left.begin(), left.end());
    return all;
}

// Strands whose stages are followed by after(strands, what the pass returned or true, its stages...).
template <class Strands, class After>
struct Watched : Strands {
    After after;
    template <class... Args>
    explicit Watched(After after, Args&&... args) : Strands(args...), after(after) {}
    template <class... Stage>
    auto take(Stage... stages) {
        if constexpr (std::is_void_v<decltype(Strands::take(stages...))>) {
            Strands::take(stages...);
            after(*this, true, stages...);
        } else {
            const bool more = Strands::take(stages...);
            after(*this, more, stages...);
            return more;
        }
    }
};

// --- where strands have it

// One strand in a lane of a block.
template <class N>
struct InBlock {
    const BlockStep<N>& step;
    const ChainScratch<N>& scratch;
    const N* touching;
    int lane;

    Numbers get(Quantity q, int i) const {
        using State = ChainState<N>;
        auto vector = [&](const Vec3<N>* of) {
            return numbers_of(State::template lane_of<double>(of[i], lane));
        };
        auto number = [&](const N& of) { return State::template lane_of<double>(of, lane); };
        switch (q) {
            case Quantity::expected_position:
                return vector(scratch.predicted_x);
            case Quantity::expected_velocity:
                return vector(scratch.expected_v);
            case Quantity::gap:
                return numbers_of(number(scratch.gap[i]));
            case Quantity::holds: {
                const double pushed = number(step.pushed[i]);
                if (!(pushed > 0)) return {};
                return {pushed, number(scratch.hold[i].weight), number(scratch.hold[i].drag), 0};
            }
            case Quantity::frame:
                return numbers_of(State::template lane_of<double>(step.frame[i], lane));
            case Quantity::limit_edge:
                return vector(scratch.limit_edge);
            case Quantity::core_force:
                return vector(scratch.core_pull);
            case Quantity::solution:
                return vector(scratch.solution);
            case Quantity::position:
                return vector(step.x_before);
            case Quantity::velocity:
                return vector(step.v_before);
            case Quantity::position_before:
                return vector(step.x);
            case Quantity::velocity_before:
                return vector(step.v);
            case Quantity::momentum:
                return numbers_of(number(step.pushed[i]));
            case Quantity::touching:
                return numbers_of(number(touching[i]));
        }
        return {};
    }
    bool has(Quantity q) const {
        switch (q) {
            case Quantity::gap:
            case Quantity::holds:
                return scratch.hold;
            case Quantity::momentum:
                return step.pushed;
            case Quantity::frame:
                return step.frame;
            case Quantity::limit_edge:
                return scratch.limit_edge;
            case Quantity::core_force:
                return scratch.core_pull;
            case Quantity::touching:
                return touching;
            default:
                return true;
        }
    }
};

// A team's strands, open to the test.
template <class Barrier>
struct OpenTeam : StrandStep<double, AnySet, Barrier> {
    using Base = StrandStep<double, AnySet, Barrier>;
    using Base::Base, Base::team_;
    bool is_active(int g) const { return this->is(Base::active, g); }
    template <class F>
    void with(Quantity q, int g, int i, F f) {
        const int k = this->cell(g, i);
        switch (q) {
            case Quantity::expected_position:
                return f(this->at_[k]);
            case Quantity::expected_velocity:
                return f(this->rate_[k]);
            case Quantity::gap:
                return f(this->gap_[k]);
            case Quantity::holds:
            case Quantity::momentum:
                return f(this->pushed_[k]);
            case Quantity::frame:
                return f(static_cast<Quatd&>(this->frame_[k]));
            case Quantity::limit_edge:
                return f(this->limit_edge_[k]);
            case Quantity::core_force:
                return f(this->core_[k]);
            case Quantity::solution:
                return f(this->system_.right(g, i));
            case Quantity::position:
                return f(this->x_before_[k]);
            case Quantity::velocity:
                return f(this->v_before_[k]);
            case Quantity::position_before:
                return f(this->x_[k]);
            case Quantity::velocity_before:
                return f(this->v_[k]);
            case Quantity::touching:
                return f(this->m_.touching[this->place(k)]);
        }
    }
    Numbers get(Quantity q, int g, int i) {
        Numbers out{};
        with(q, g, i, [&](const auto& of) { out = numbers_of(of); });
        if (q != Quantity::holds || out[0] == 0) return out;
        const auto particle = this->particle(this->cell(g, i));
        const auto hold = this->parts_.hold_of(*this->motion_, this->scheme_, particle, out[0]);
        return {std::abs(out[0]), hold.weight, hold.drag, 0};
    }
    void set(Quantity q, int g, int i, const Numbers& to) {
        with(q, g, i, [&]<class V>(V& of) {
            if constexpr (std::is_same_v<V, Quatd>)
                of = {to[0], to[1], to[2], to[3]};
            else if constexpr (std::is_same_v<V, Vec3d>)
                of = vector_of(to);
            else
                of = q == Quantity::holds && to[1] == 0 ? -to[0] : to[0];
        });
    }
};

// --- the comparison

// What a pass left of the strands of a block.
struct Recorded {
    std::string pass;
    bool more;                                                    // what it returned
    std::map<std::pair<Quantity, int>, std::vector<Numbers>> of;  // (quantity, strand): by particle
};
using Record = std::vector<Recorded>;

// One substep of a scene's strands, one block of them, by both. Differences are told by the stage that makes
// them.
class Comparison {
  public:
    // `given`: forces from outside that act within the substep.
    Comparison(const Scene& scene, const ChainState<S>& from, bool first, const PosedScene<double>& p,
               bool given)
        : scene_(scene), first_(first), p_(p), packs_(from), plain_(scene) {
        StateArrays<double, HostArray> state;
        packs_.save(state);
        plain_.restore(state);
        plain_.air.clear();
        if (!packs_.air.empty()) packs_.unpack<double>(packs_.air, plain_.air);
        if (!given) return;
        Random random(7);
        for (size_t k = 0; k < plain_.x.size(); ++k) {
            force_.push_back(random.vector(2 * plain_.mass[k]));
            stiffness_.push_back(plain_.mass[k] * random.number(0, 1e3));
        }
        packed_force_.resize(packs_.x.size()), packed_stiffness_.resize(packs_.x.size());
        packs_.pack(force_, packed_force_), packs_.pack(stiffness_, packed_stiffness_);
    }
    // Stage by stage. The pass of that name is made to leave something else; "": none.
    void run_block(const std::string& disturbed = "") {
        record_.clear();
        ChainState<S> packs = packs_;
        const double dt = 1 / (scene_.fps * scene_.integrator.substeps);
        OwnScratch<S> scratch(packs.n, scene_.chain, implicit(), !scene_.solids.empty());
        std::vector<S> phi(packs.x.size(), S(1e9));
        std::vector<Vec3<S>> normal(phi.size(), {S(0), S(1), S(0)}), velocity(phi.size(), {S(0), S(0), S(0)});
        const auto of_root = cast<S>(p_.head_motion);
        const Vec3<S> root[2] = {of_root(packs.root[0]), of_root(packs.root[1])};
        auto step = step_of(packs, root, dt, packed_force_, packed_stiffness_);
        const NearestView<S> near{phi.data(), normal.data(), velocity.data(), data_of(packs.touching)};
        auto record = [&](auto&, bool more, auto... stages) {
            const auto pass = name_of_pass<decltype(stages)...>();
            Recorded& now = record_.emplace_back(Recorded{pass, more, {}});
            for (const Leaves& leaves : left_by_pass(stages...))
                for (int lane = 0; lane < packs.strands; ++lane) {
                    const InBlock<S> strand{step, scratch, near.touching, lane};
                    if (!strand.has(leaves.quantity)) continue;
                    auto& numbers = now.of[{leaves.quantity, lane}];
                    for (int i = 0; i < packs.n; ++i) {
                        const Range range = range_of(leaves.quantity, packs.n);
                        const bool there = i >= range.first && i < range.end;
                        numbers.push_back(there ? strand.get(leaves.quantity, i) : Numbers{});
                    }
                }
            if (pass == disturbed && !now.of.empty())
                now.of.begin()->second[3][0] += 1e-3 + std::abs(now.of.begin()->second[3][0]);
        };
        const SurfacesOf<S> surfaces{p_};
        Watched<BlockStages<S, SurfacesOf<S>, NoMeter>, decltype(record)> strands(
            record, rules_, step, view_of(packs, 0), near, data_of(packs.rest_depth), surfaces, scratch,
            static_cast<NoMeter*>(nullptr));
        if (implicit())
            take_implicit_substep(strands);
        else
            take_explicit_substep(strands);
    }
    const Record& record() const { return record_; }

    // Returns what differs, pass by pass; each goes on from what the block's has left.
    template <class Who>
    std::vector<std::string> by_team(Who who) {
        differences_.clear();
        ChainState<double> state = plain_;
        StrandMemory<double> memory{};
        memory.n = state.n, memory.strands = state.strands;
        for_each_strand_array([](auto, auto& to, auto& array) { to = array.data(); }, memory, state);
        if (!force_.empty()) memory.given_force = force_.data(), memory.given_stiffness = stiffness_.data();
        std::vector<ShapeView> shapes;
        for (const auto& solid : scene_.solids) shapes.push_back(view_of(solid.shape));
        std::vector<DeviceSolid<double>> solids(shapes.size());
        SubstepMotion<double> motion = substep_motion(p_, shapes.data(), nullptr, solids.data());
        motion.solids = solids.data();
        const auto constants = chain_constants<double>(scene_, 1 / (scene_.fps * scene_.integrator.substeps));
        const AnySet set{set_of(scene_, !force_.empty())};
        struct alignas(32) Aligned {
            double numbers[4];
        };
        std::vector<Aligned> workspace(strand_workspace<double>(state.n, state.strands, true) / 4 + 1);
        std::vector<StrandFlags> flags(size_t(state.strands));
        size_t passes = 0;
        as_a_team(who, [&]<class Barrier>(const ThreadTeam<Barrier>& team) {
            size_t pass = 0;
            auto compare = [&](auto& strands, bool more, auto... stages) {
                strands.team_.wait();
                if (team.thread == 0) {
                    const bool carries = (std::is_same_v<decltype(stages), stage::CarryFrames> || ...);
                    auto skips = [&](int g) { return carries && !strands.is_active(g); };
                    lay_over(pass, more, strands, skips, stages...);
                }
                ++pass;
                strands.team_.wait();
            };
            Watched<OpenTeam<Barrier>, decltype(compare)> strands(
                compare, memory, constants, set, team, 0, state.strands, workspace[0].numbers, flags.data());
            strands.load();
            strands.begin(motion, first_);
            take_implicit_substep(strands);
            if (team.thread == 0) passes = pass;
        });
        if (passes != record_.size()) differences_.push_back("the team takes other passes than the block");
        return differences_;
    }
    // The same of each strand in plain numbers, by the block's own bodies: what the reference kernel does.
    std::vector<std::string> by_plain_numbers() {
        differences_.clear();
        const double dt = 1 / (scene_.fps * scene_.integrator.substeps);
        ChainState<double> state = plain_;
        for (int strand = 0; strand < state.strands; ++strand) {
            const size_t k = state.at(strand, 0), n = size_t(state.n);
            OwnScratch<double> scratch(state.n, scene_.chain, implicit(), !scene_.solids.empty());
            std::vector<double> phi(n, 1e9);
            std::vector<Vec3d> normal(n, {0, 1, 0}), velocity(n, {0, 0, 0});
            const Vec3d* in_frame = &state.root[size_t(strand) * 2];
            const Vec3d root[2] = {p_.head_motion(in_frame[0]), p_.head_motion(in_frame[1])};
            auto step = step_of(state, root, dt, force_, stiffness_, k);
            const NearestView<double> near{phi.data(), normal.data(), velocity.data(),
                                           data_of(state.touching, k)};
            size_t pass = 0;
            auto compare = [&](auto&, bool more, auto... stages) {
                struct OneStrand : InBlock<double> {
                    Numbers get(Quantity q, int, int i) const { return InBlock<double>::get(q, i); }
                    void set(Quantity, int, int, const Numbers&) const {}
                };
                OneStrand one{{step, scratch, near.touching, 0}};
                lay_over(
                    pass++, more, one, [&](int g) { return g != strand; }, stages...);
            };
            const SurfacesOf<double> surfaces{p_};
            Watched<BlockStages<double, SurfacesOf<double>, NoMeter>, decltype(compare)> strands(
                compare, rules_, step, view_of(state, strand), near, data_of(state.rest_depth, k), surfaces,
                scratch, static_cast<NoMeter*>(nullptr));
            take_explicit_substep(strands);
        }
        return differences_;
    }
    bool implicit() const { return scene_.integrator.is_implicit(); }

  private:
    template <class V>
    static V* data_of(std::vector<V>& values, size_t k = 0) {
        return values.empty() ? nullptr : &values[k];
    }
    template <class N>
    BlockStep<N> step_of(ChainState<N>& state, const Vec3<N>* root, double dt, std::vector<Vec3<N>>& force,
                         std::vector<N>& stiffness, size_t k = 0) const {
        return {.n = state.n,
                .dt = dt,
                .first = first_,
                .x = &state.x[k],
                .x_before = &state.x_before[k],
                .v = &state.v[k],
                .v_before = &state.v_before[k],
                .root = root,
                .gravity = scene_.integrator.gravity,
                .root_turn = cast<N>(p_.head_motion.turn),
                .frame = data_of(state.frame, k),
                .pushed = data_of(state.pushed, k),
                .external = data_of(force, k),
                .external_stiffness = data_of(stiffness, k),
                .share = predictor_share(scene_),
                .max_linearisations = scene_.integrator.max_linearisations,
                .relinearise_angle = scene_.integrator.relinearise_angle};
    }
    template <class N>
    ChainView<N> view_of(const ChainState<N>& state, int block) const {
        ChainView<N> view{};
        view.n = state.n;
        view.set_arrays(state.pointers(block));
        view.set_root(cast<N>(p_.head_motion));
        return view;
    }
    static ShapeView view_of(const Shape& shape) { return wetcurl::view_of(shape); }

    // What the pass-th pass left of `strands` over what the block's left, which then takes its place.
    template <class Strands, class Skips, class... Stage>
    void lay_over(size_t pass, bool more, Strands& strands, Skips skips, Stage... stages) {
        const std::string name = name_of_pass<Stage...>();
        if (pass >= record_.size() || record_[pass].pass != name || record_[pass].more != more) {
            const std::string other = pass < record_.size() ? record_[pass].pass : "nothing";
            differences_.push_back(name + ": pass " + std::to_string(pass) + " is '" + other +
                                   "' of the block, or goes on otherwise");
            return;
        }
        for (const Leaves& leaves : left_by_pass(stages...))
            for (int g = 0; g < packs_.strands; ++g) {
                const auto found = record_[pass].of.find({leaves.quantity, g});
                if (found != record_[pass].of.end() && !skips(g))
                    lay_over(name, leaves, g, found->second, strands);
            }
    }
    template <class Strands>
    void lay_over(const std::string& pass, const Leaves& leaves, int g, const std::vector<Numbers>& wanted,
                  Strands& strands) {
        double largest = leaves.least, farthest = 0;
        int at = -1;
        const Range range = range_of(leaves.quantity, packs_.n);
        for (int i = range.first; i < range.end; ++i) {
            const Numbers found = strands.get(leaves.quantity, g, i);
            for (size_t l = 0; l < found.size(); ++l) {
                const double other = wanted[size_t(i)][l], way = std::abs(found[l] - other);
                largest = std::max(largest, std::abs(other));
                if (!(way <= farthest)) farthest = way, at = i;  // NaN too
            }
            strands.set(leaves.quantity, g, i, wanted[size_t(i)]);
        }
        if (farthest <= leaves.bound * largest) return;
        std::ostringstream text;
        text << pass << ": " << names[int(leaves.quantity)] << " of strand " << g << ", particle " << at
             << ", is off by " << farthest << " of " << largest << "; allowed: " << leaves.bound << " of it";
        differences_.push_back(text.str());
    }

    const Scene& scene_;
    const bool first_;
    const PosedScene<double>& p_;
    ChainState<S> packs_;
    ChainState<double> plain_;
    std::vector<Vec3d> force_;
    std::vector<double> stiffness_;
    std::vector<Vec3<S>> packed_force_;
    std::vector<S> packed_stiffness_;
    const SubstepRules<double> rules_ = substep_rules<double>(scene_);
    Record record_;
    std::vector<std::string> differences_;
};

// --- scenes

// A shipped scene of as many strands as a block has: as it is, dry, or with stretch so soft that the strain
// limit holds.
enum class Variant { shipped, dry, limited };
constexpr const char* names_of_variants[] = {"as shipped", "dry", "limited"};
Scene cut_scene(const std::string& name, Variant variant) {
    SceneOptions options;
    options.set = {"groom.grid=[" + std::to_string(S::lanes / 2) + ", 2]"};
    if (variant == Variant::limited) {
        options.set.push_back("integrator.limiter=0.02");
        const bool fibre = load_scene(shipped_scene(name), options).fibre.has_value();
        options.set.push_back(fibre ? "fibre.strain=1" : "stretch.stiffness=0.05");
    }
    Scene scene = load_scene(shipped_scene(name), options);
    if (variant == Variant::dry) make_dry(scene);
    return scene;
}
// Follows a scene; calls compare(substep, comparison) at some of its substeps.
template <class Compare>
void follow(const Scene& scene, int substeps, Compare compare) {
    ChainStepper<double> stepper(scene);
    Random random(5);
    for (auto& air : stepper.state.air) air = cast<S>(random.vector(1));
    const double dt = 1 / (scene.fps * scene.integrator.substeps);
    const bool given = scene.names_baseline() || (scene.cohesion && scene.cohesion->strength > 0);
    for (int k = 0; k < substeps; ++k) {
        const auto p = posed_scene_at<double>(scene, double(k + 1) * dt, dt);
        if (k < 2 || k % 111 == 0) {
            Comparison comparison(scene, stepper.state, stepper.first, p, given);
            compare(k, comparison);
        }
        stepper.run({p}, {});
    }
}
std::string told(const std::vector<std::string>& differences) {
    std::string all;
    for (size_t k = 0; k < differences.size() && k < 5; ++k) all += differences[k] + '\n';
    return all;
}

class Stages : public ::testing::TestWithParam<std::string> {};

TEST_P(Stages, leave_the_same_of_a_block_as_of_a_team) {
    for (const Variant variant : {Variant::shipped, Variant::dry, Variant::limited}) {
        const Scene scene = cut_scene(GetParam(), variant);
        follow(scene, variant == Variant::shipped ? 1000 : 250, [&](int substep, Comparison& comparison) {
            SCOPED_TRACE(names_of_variants[int(variant)] + std::string(", substep ") +
                         std::to_string(substep));
            comparison.run_block();
            if (!comparison.implicit()) {
                EXPECT_EQ(told(comparison.by_plain_numbers()), "");
                return;
            }
            EXPECT_EQ(told(comparison.by_team(OneAlone())), "");
            // Threads of this machine wait for each other a thousand times as long as those of a GPU.
            if (variant == Variant::dry || (substep != 1 && substep != 444)) return;
            EXPECT_EQ(told(comparison.by_team(ManyThreads())), "");
        });
    }
}

// The comparison fails where it should: in a scene in which each stage acts, each pass is disturbed in turn.
TEST(StageComparison, names_the_stage_that_differs) {
    const Scene scene = cut_scene("adhesion", Variant::limited);
    std::vector<std::string> seen;
    std::map<Quantity, bool> acts;
    follow(scene, 334, [&](int substep, Comparison& comparison) {
        if (substep != 333) return;
        comparison.run_block();
        for (const Recorded& pass : comparison.record()) {
            for (const auto& [of, numbers] : pass.of)
                for (const Numbers& n : numbers) acts[of.first] |= norm(vector_of(n)) > 0;
            if (pass.of.empty() || std::ranges::count(seen, pass.pass)) continue;
            seen.push_back(pass.pass);
            Comparison disturbed = comparison;
            disturbed.run_block(pass.pass);
            const auto differences = disturbed.by_team(OneAlone());
            ASSERT_FALSE(differences.empty()) << pass.pass;
            EXPECT_TRUE(differences.front().starts_with(pass.pass + ":")) << differences.front();
        }
    });
    EXPECT_EQ(seen.size(), 8u);
    EXPECT_EQ(acts.size(), std::size(names));
    for (const auto& [quantity, any] : acts) EXPECT_TRUE(any) << names[int(quantity)];
}

INSTANTIATE_TEST_SUITE_P(Shipped, Stages, ::testing::ValuesIn(shipped_scenes()),
                         [](const auto& about) { return about.param; });

}  // namespace
}  // namespace wetcurl

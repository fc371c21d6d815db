// The hair in the host's memory, and simulations on it.
#include "solver/run/simulation.h"

#include "solver/cohesion/display.h"
#include "solver/run/frame_loop.h"

namespace wetcurl {

namespace {

// The strands in the host's own memory.
template <class T>
class CpuHair : public ChainStepper<T> {
  public:
    using Number = T;
    using typename ChainStepper<T>::S;
    using Air = AirCoupling<CpuHair>;
    using Water = WaterCoupling<CpuHair>;
    using Forces = PairForcesCoupling<S>;
    using StrandContacts = StrandContactCoupling<S>;
    struct Surfaces : DeformingSolids {
        Surfaces(const Scene& scene, const CpuHair&) : DeformingSolids(scene) {}
    };
    static constexpr bool couples = false;

    explicit CpuHair(const Scene& scene) : ChainStepper<T>(scene), scene_(scene) {}

    void begin_display(const std::vector<float>& saturation) { display_.emplace(scene_, saturation); }
    // Volumes as the saturation has them now; dry_mass (strand, particle) [kg].
    void take_up_water(const std::vector<double>& dry_mass) { display_->take_up_water(dry_mass); }
    double neighbours_mean() const { return display_->neighbours_mean(); }

    // The state is always there.
    void fetch() const {}
    void fetch_history() const {}
    void give_state() {}
    void give_velocities() {}
    void take_couplings(Forces*, StrandContacts*) {}
    void take_network(const DenseLayers*) {}
    bool asks_network() const { return false; }
    void ask_from(const PosedScene<T>&) {}
    std::vector<double> answers() const { return {}; }
    void give_answers(const std::vector<double>&) {}

    void run(const std::vector<PosedScene<T>>& path, const GivenToChain<S>& given, bool /*ends_frame*/) {
        const StageTimer timer(seconds.chain);
        ChainStepper<T>::run(path, given);
    }
    void show(double time, const MovingGrid* surfaces) {
        if (!display_) return;
        positions(seen_);
        if (!is_finite(seen_.points)) return;
        display_->apply(seen_, this->head, time, surfaces);
        seconds.lists = display_->list_seconds();
        seconds.cohesion = display_->seconds() - seconds.lists;
    }
    void positions(Strands& out) const {
        out.count = this->state.strands, out.particles = this->state.n;
        this->state.template unpack<float>(this->state.x, out.points);
    }
    // Where the strands are seen: p^w, or where they are.
    const Strands& seen() const {
        if (!display_) positions(seen_);
        return seen_;
    }
    std::vector<Vec3f> velocities() const {
        std::vector<Vec3f> out;
        this->state.template unpack<float>(this->state.v, out);
        return out;
    }
    const Vec3f* positions_on_device() const { return nullptr; }
    // Positions, what is displayed, energy and contact: here all of it is at hand at once.
    void begin_record(RunFrame& frame) {
        positions(frame.positions);
        frame.displayed = display_ ? seen_ : Strands();
        const auto sum = this->energy();
        frame.energy.assign(sum.begin(), sum.end());
        frame.contact = this->state.contacts();
    }
    void finish_record(RunFrame&) const {}
    void list(BufferList& buffers) const {
        ChainStepper<T>::list(buffers);
        if (display_) buffers.push_back({"cohesion lists", display_->bytes(), BufferUse::lists});
        add_buffer(buffers, display_ ? "displayed positions" : "positions of the flow", seen_.points,
                   display_ ? BufferUse::displayed : BufferUse::coupling);
    }
    StageSeconds seconds;

  private:
    const Scene& scene_;
    std::optional<Display> display_;
    mutable Strands seen_;
};
static_assert(Hair<CpuHair<float>> && Hair<CpuHair<double>>);

}  // namespace

std::unique_ptr<Simulation> make_simulation(const Scene& scene, const std::string& precision) {
    if (precision == "double") return std::make_unique<SimulationOf<CpuHair<double>>>(scene);
    return std::make_unique<SimulationOf<CpuHair<float>>>(scene);
}

}  // namespace wetcurl

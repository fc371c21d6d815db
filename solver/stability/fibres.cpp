// S10: hair as a fibre of real diameters, as a film's frame steps it: 24 frames a second of ten substeps.
#include <algorithm>

#include "solver/stability/cases.h"

namespace wetcurl::stability {

namespace {

// Straight hair, waves, curls and tight coils.
StrandSetup hair_of(double diameter, int points) {
    return {.shapes = {straight_points(points, length, {0, -1, 0}), helix_points(points, length, 0.01, 0.1),
                       helix_points(points, length, 0.006, 0.025), helix_points(points, 0.1, 0.0025, 0.004)},
            .dt = 1.0 / 24,
            .fibre = diameter};
}

// The longest edge over its rest length, at any time.
class Stretches {
  public:
    explicit Stretches(const Trial& trial) : rest_(trial.scene().groom.rest) {}
    void look(Trial& trial) {
        const Points x = trial.simulation().state().x;
        for (int s = 0; s < rest_.count; ++s)
            for (int i = 0; i + 1 < rest_.particles; ++i) {
                const size_t k = size_t(s) * size_t(rest_.particles) + size_t(i);
                const double l = norm(cast<double>(rest_.at(s, i + 1) - rest_.at(s, i)));
                most = std::max(most, norm(x[k + 1] - x[k]) / l);
            }
    }
    double most = 0;

  private:
    const Strands& rest_;
};

constexpr double stretch_bound = 1.1;  // hair breaks beyond

// What a case asks beside length and energy.
enum class Also { nothing, falls, rests };

StabilityCase of_fibres(const Battery& b, const std::string& what, const StrandSetup& setup, double angle,
                        double seconds, Also also) {
    StabilityCase c = b.named("S10", what, {{"dt", setup.dt / 10}});
    Trial trial(b.method, scene_of(setup, b.method));
    if (angle > 0) {
        SimulationState s = trial.simulation().state();
        sway(s, trial.scene().groom.rest.particles, angle);
        trial.set(s);
    }
    Stretches stretches(trial);
    const double start = trial.total();
    double low = start, rise = 0;  // [J] the lowest energy so far, and the most that it rose above that
    for (double t = 0; t < seconds && trial.finite; t += setup.dt) {
        trial.advance();
        if (!trial.finite) break;
        stretches.look(trial);
        rise = std::max(rise, trial.total() - low), low = std::min(low, trial.total());
    }
    trial.report(c);
    c.measured.emplace_back("longest_edge_of_rest", stretches.most);
    c.passed = c.finite && c.energy_ratio <= energy_bound && stretches.most <= stretch_bound;
    if (also == Also::falls) {
        c.measured.emplace_back("rise_of_fall", rise / (start - low));
        c.passed = c.passed && rise <= energy_bound * (start - low);
    }
    if (also == Also::rests && trial.finite) {
        const double jitter = jitter_of(trial);
        c.measured.emplace_back("jitter", jitter);
        c.passed = c.passed && jitter <= jitter_bound;
    }
    return c;
}

}  // namespace

Cases fibres(const Battery& b, double diameter) {
    const double seconds = b.options.quick ? 1 : 4;
    // Of hair without damping, which would hide what is gained.
    StrandSetup hair = hair_of(diameter, 100), fine = hair_of(diameter, 400);
    hair.set = fine.set = {"fibre.damping=0"};
    Cases out{of_fibres(b, "fibres that fall", hair, 1.5, seconds, Also::falls),
              of_fibres(b, "fibres of 400 particles that fall", fine, 1.5, seconds, Also::falls)};
    StrandSetup shaken = hair;
    shaken.more = "[motion]\nangle = 40\naxis = [0, 0, 1]\nshift = [0.02, 0.03, 0]\nperiod = 0.5\n";
    out.push_back(of_fibres(b, "fibres, shaken root", shaken, 0, seconds, Also::nothing));
    StrandSetup swept = hair;
    swept.more =
        "[[solid]]\nradius = 0.05\n[[solid.motion.keyframe]]\ntime = 0.1\ntranslation = [0.2, -0.2, 0.01]\n"
        "[[solid.motion.keyframe]]\ntime = 1.1\ntranslation = [-0.2, -0.2, 0.01]\n";
    out.push_back(of_fibres(b, "fibres swept by a ball", swept, 0, seconds, Also::nothing));
    StrandSetup resting = hair_of(diameter, 100);
    resting.drag = 8;
    out.push_back(
        of_fibres(b, "fibres that come to rest", resting, 1.0, b.options.quick ? 4 : 8, Also::rests));
    resting.more = "[wetness]\n[curl]\n";
    out.push_back(
        of_fibres(b, "wet fibres that come to rest", resting, 1.0, b.options.quick ? 4 : 8, Also::rests));
    return out;
}

}  // namespace wetcurl::stability

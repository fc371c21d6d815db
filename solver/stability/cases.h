// Who makes the cases of the battery, and what they share.
#pragma once

#include <string>
#include <vector>

#include "solver/stability/trial.h"

namespace wetcurl::stability {

using Cases = std::vector<StabilityCase>;

constexpr double dt_usual = 1.0 / 240, length = 0.25;  // [s], [m]
constexpr int particles = 50;
constexpr Vec3d down{0, -9.81, 0}, weightless{0, 0, 0};  // [m/s²]

inline const Points straight = straight_points(particles, length, {0, -1, 0});
inline const Points curly = helix_points(particles, length, 0.006, 0.025);

// What all groups of cases know.
struct Battery {
    const StabilityMethod& method;
    StabilityOptions options;

    StabilityCase named(const char* id, const std::string& what, Figures parameters) const {
        StabilityCase c;
        c.id = id, c.what = what, c.method = &method;
        if (method.fibre > 0) {
            std::erase_if(parameters, [](const auto& p) { return p.first == "k_over_m"; });
            c.parameters = {{"diameter", method.fibre}};
        }
        c.parameters.insert(c.parameters.end(), parameters.begin(), parameters.end());
        return c;
    }
    std::vector<double> some(std::vector<double> all, std::vector<double> few) const {
        return options.quick ? few : all;
    }
};

// --- groups of cases: k_over_m as of a StrandSetup, dt [s], limiter an allowed strain or 0

// S1, noise.cpp: noise does not grow.
StabilityCase noise_at_rest(const Battery& b, double k_over_m, double dt);
StabilityCase noise_beside_neighbours(const Battery& b, double k_over_m);
// S2 and S8, energies.cpp: what the energy rises by was given.
Cases energies_of(const Battery& b, double k_over_m);
Cases energies_of_wet(const Battery& b, double k_over_m);
StabilityCase limiter_honesty(const Battery& b, double k_over_m);
// S3, jacobians.cpp: forces are those of an energy, their matrix is symmetric and large enough.
Cases jacobians(const Battery& b, double k_over_m);
// S4, hanging.cpp: a strand let go of hangs in the shape that its springs have.
Cases stiffness_by_step(const Battery& b, double k_over_m);
// S5, ordeals.cpp: what no groom should meet is stood, and hair settles after it.
Cases ordeals(const Battery& b, double k_over_m, double limiter);
Cases wet_ordeals(const Battery& b, double k_over_m);
// S6, orders.cpp: errors shrink with the step and the segment as they should.
StabilityCase order_in_time(const Battery& b, double k_over_m);
StabilityCase order_in_particles(const Battery& b);
// S7, invariances.cpp: place, direction, order of strands and unit do not matter. `of` ends their names.
Cases invariances(const Battery& b, const StrandSetup& plain, const std::string& of);
// S9, everything.cpp: a whole scene; stiffnesses of the strand times `stiffer`.
Cases everything_at_once(const Battery& b, double stiffer);
// The same on hair of a kind that [fibre] names.
StabilityCase everything_on(const Battery& b, const char* hair);

// S10, fibres.cpp: hair of a real diameter [m] keeps its length, gains no energy and comes to rest.
Cases fibres(const Battery& b, double diameter);
// S6 of fibres, resolution.cpp: hair of a kind is the same at any number of particles.
Cases orders_of_fibres(const Battery& b, const char* hair);

// --- shared by several groups

// Wet curls beside each other, one amid six, none turned as another and each in reach of its neighbours only.
StrandSetup wet_lock(const Battery& b, double k_over_m);
// Slowest swing along a strand of masses held by two springs of k each [rad/s]; of fibres, from side to side.
double slowest_swing(const Battery& b, double k_over_m);
// That damps a swing [rad/s] critically, as far as the explicit scheme can take it [1/s].
double critical_drag(double swing);
// Root mean square over the particles [m].
double rms_distance(const Points& a, const Points& b);

}  // namespace wetcurl::stability

// Presence, stiffness and precision of a scene.
#include "solver/plan.h"

#include <algorithm>

#include "solver/rest_state.h"

namespace wetcurl {

Presence presence_of(const Scene& scene) {
    Presence p;
    auto note = [&](bool there, const char* name) { (there ? p.present : p.absent).push_back(name); };
    std::apply(
        [&](const auto&... term) { (note(term.has_value(), std::decay_t<decltype(*term)>::name), ...); },
        scene.chain);
    note(scene.wetness.has_value(), Wetness::name);
    note(scene.flow.has_value(), Flow::name);
    note(scene.curl.has_value(), Curl::name);
    note(scene.cohesion.has_value(), Cohesion::name);
    note(scene.cohesion && scene.cohesion->strength > 0, "cohesion in the solve");
    note(scene.air.has_value(), Air::name);
    note(!scene.solids.empty(), "contact");
    note(scene.strand_contact.has_value(), StrandContact::name);
    note(!scene.adhesion_model.empty(), "adhesion network");
    if (scene.baseline)
        p.present.push_back("baseline " + name_of(*scene.baseline));
    else
        p.absent.push_back("baseline");
    return p;
}

// h / dt of the implicit step.
static double share_of_step(const Scene& scene) {
    return scene.integrator.kind == "backward_euler" ? 1 : 2.0 / 3;
}

// h² k / m of a spring of k [N/m].
static double step_number(const Scene& scene, double k) {
    const double h = share_of_step(scene) / (scene.fps * scene.integrator.substeps);
    return h * h * k / (scene.linear_density * mean_segment(scene.groom));
}

// The largest of a strand's masses over its smallest, in the strand where that is largest.
static double mass_ratio(const Scene& scene) {
    const auto volume = volumes_of(scene);
    double most = 1;
    for (auto v = volume.begin(); v != volume.end(); v += scene.groom.rest.particles) {
        const auto [light, heavy] = std::minmax_element(v, v + scene.groom.rest.particles);
        most = std::max(most, double(*heavy) / double(*light));
    }
    return most;
}

double stiffness_number(const Scene& scene) {
    double k = 0;
    for_each_present(scene.chain, [&](const auto& t) {
        if constexpr (requires { t.spring(); }) k = std::max(k, t.spring());
    });
    const double number = step_number(scene, k);
    const auto& limit = scene.term<StrainLimit>();
    // per_kg h².
    const double share = share_of_step(scene);
    return limit ? std::max(number, 1e4 * share * share * mass_ratio(scene)) : number;
}

double predictor_share(const Scene& scene) {
    const auto& core = scene.term<Core>();
    const auto& bend = scene.term<Bend>();
    const double core_number = core ? step_number(scene, core->k_c) : 0,
                 bend_number = bend ? step_number(scene, bend->k_b) : 0;
    return std::min({1.0, 1e5 / std::max(1.0, core_number), 4e4 / std::max(1.0, bend_number)});
}

std::string trusted_precision(const Scene& scene, const std::string& precision) {
    // Measured on chains: a float factorisation loses its digits above this.
    return scene.integrator.is_implicit() && stiffness_number(scene) > 1e5 ? "double" : precision;
}

}  // namespace wetcurl

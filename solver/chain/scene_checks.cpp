// Presence, stiffness and precision of a scene.
#include "solver/chain/scene_checks.h"

#include <fmt/format.h>

#include <algorithm>

#include "solver/scene/rest_state.h"

namespace wetcurl {

Presence presence_of(const Scene& scene) {
    Presence p;
    auto note = [&](bool there, const char* name) { (there ? p.present : p.absent).emplace_back(name); };
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
    for_each_present(scene.baselines, [&](const auto& method) {
        p.present.push_back(fmt::format("baseline {}", method.name));
    });
    if (!scene.names_baseline()) p.absent.emplace_back("baseline");
    return p;
}

// h / dt of the implicit step.
static double share_of_step(const Scene& scene) {
    return scene.integrator.kind == "backward_euler" ? 1 : 2.0 / 3;
}

// (h² k + h c) / m of a spring of k [N/m] with a dashpot of c [N s/m].
static double step_number(const Scene& scene, double k, double c = 0) {
    const double h = share_of_step(scene) / (scene.fps * scene.integrator.substeps);
    return (h * h * k + h * c) / (scene.linear_density * mean_segment(scene.groom));
}

// The strongest one [N s/m].
static double dashpot_of(const Scene& scene) {
    double c = 0;
    if (const auto& stretch = scene.term<Stretch>()) c = std::max(c, stretch->c_s);
    if (const auto& bend = scene.term<Bend>()) c = std::max(c, bend->c_b);
    if (const auto& core = scene.term<Core>()) c = std::max(c, core->c_c);
    return c;
}

// Of the masses along strands.
struct Masses {
    double ratio = 1;  // the largest of a strand over its smallest, in the strand where that is largest
    double lightest = 1e300;  // [kg] of all that have a segment on either side
};
static Masses masses_of(const Scene& scene) {
    const auto volume = volumes_of(scene);
    Masses all;
    for (auto v = volume.begin(); v != volume.end(); v += scene.groom.rest.particles) {
        const auto end = v + scene.groom.rest.particles;
        const auto [light, heavy] = std::minmax_element(v, end);
        all.ratio = std::max(all.ratio, double(*heavy) / double(*light));
        for (auto inner = v + 1; inner + 1 < end; ++inner)
            all.lightest = std::min(all.lightest, scene.volume_density * double(*inner));
    }
    return all;
}

double stiffness_number(const Scene& scene) {
    double k = 0;
    for_each_present(scene.chain, [&](const auto& t) {
        if constexpr (requires { t.spring(); }) k = std::max(k, t.spring());
    });
    const Masses masses = masses_of(scene);
    // Beside a light particle the same spring is stiffer.
    const double mean = scene.linear_density * mean_segment(scene.groom),
                 number = step_number(scene, k, dashpot_of(scene)) * std::max(1.0, mean / masses.lightest);
    const auto& limit = scene.term<StrainLimit>();
    // per_kg h².
    const double share = share_of_step(scene);
    return limit ? std::max(number, 1e4 * share * share * masses.ratio) : number;
}

double predictor_share(const Scene& scene) {
    const auto& core = scene.term<Core>();
    const auto& bend = scene.term<Bend>();
    const double core_number = core ? step_number(scene, core->k_c) : 0,
                 bend_number = bend && !scene.fibre ? step_number(scene, bend->k_b) : 0;
    return std::min({1.0, 1e5 / std::max(1.0, core_number), 4e4 / std::max(1.0, bend_number)});
}

std::string trusted_precision(const Scene& scene, const std::string& precision) {
    // Measured on chains: a float factorisation loses its digits above this.
    return scene.integrator.is_implicit() && stiffness_number(scene) > 1e5 ? "double" : precision;
}

}  // namespace wetcurl

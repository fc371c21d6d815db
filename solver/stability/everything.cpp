// S9: a whole scene, shaken and let come to rest.
#include <cmath>

#include "solver/stability/cases.h"

namespace wetcurl::stability {

namespace {

const std::string springs = "[stretch]\n[bend]\n[core]\n", everything = R"([groom]
grid = [6, 6]
particles = 50
[integrator]
substeps = 10
[wetness]
jitter = 0.3
[curl]
[motion]
[[motion.keyframe]]
time = 0.1
[[motion.keyframe]]
time = 0.3
rotation = [0, 40, 0]
[[motion.keyframe]]
time = 0.6
rotation = [0, -40, 10]
[[motion.keyframe]]
time = 0.8
[[solid]]
name = "head"
radius = 0.095
attached = "head"
[[solid]]
name = "ball"
radius = 0.06
[[solid.motion.keyframe]]
time = 0.1
translation = [0.3, -0.1, -0.05]
[[solid.motion.keyframe]]
time = 1.0
translation = [0.15, -0.1, -0.05]
)";

const char* const drag = "[stiffness]\nglobal = 6\n";

struct SceneText {
    std::string text, name, folder;
    bool has(const char* table) const {
        return text.find(std::string("[") + table + "]") != std::string::npos;
    }
};

// Hair is at rest once its particles move by no more in a frame, in segments.
constexpr double still_enough = 5e-5;

StabilityCase all_at_once(const Battery& b, const SceneText& of, double stiffer, double pull, double radius,
                          double limiter) {
    StabilityCase c = b.named("S9", "everything at once",
                              {{"stiffness_factor", stiffer},
                               {"adhesion", pull},
                               {"cohesion_radius", radius},
                               {"limiter", limiter}});
    std::vector<std::string> set = b.options.set;
    set.push_back(setting("integrator.limiter", limiter));
    if (of.has(Adhesion::table)) set.push_back(setting("adhesion.strength", pull));
    if (of.has(Cohesion::table)) set.push_back(setting("cohesion.radius", radius));
    Scene scene = scene_of(of.text, of.name, of.folder, set, b.method);
    if (auto& t = scene.term<Stretch>()) t->k_s *= stiffer;
    if (auto& t = scene.term<Bend>()) t->k_b *= stiffer;
    if (auto& t = scene.term<Twist>()) t->k_b *= stiffer;
    if (auto& t = scene.term<Core>()) t->k_c *= stiffer;
    if (auto& f = scene.fibre) {
        for (double* modulus :
             {&f->youngs_modulus, &f->shear_modulus, &f->wet_youngs_modulus, &f->wet_shear_modulus})
            *modulus *= stiffer;
        f->strain /= stiffer;
    }
    Trial trial(b.method, std::move(scene));
    trial.advance_for(6);
    // Soft hair takes long to come to rest.
    const double segment = mean_segment(trial.scene().groom);
    double seconds = 6, moved = unbounded;
    for (; trial.finite && moved > still_enough * segment && seconds < 60; ++seconds) {
        trial.advance_for(1 - 1 / trial.scene().fps);
        const Points before = trial.simulation().state().x;
        trial.advance();
        moved = rms_distance(trial.simulation().state().x, before);
    }
    const double jitter = jitter_of(trial);
    trial.report(c);
    c.kinetic_ratio = trial.finite ? trial.kinetic / trial.weight_length() : unbounded;
    c.measured.emplace_back("jitter_over_segment", jitter);
    c.measured.emplace_back("seconds_to_rest", seconds);
    c.passed = c.finite && c.energy_ratio <= energy_bound && jitter <= jitter_bound;
    return c;
}

}  // namespace

Cases everything_at_once(const Battery& b, double stiffer) {
    const std::string chain =
        b.method.fibre > 0 ? "[fibre]\n" + setting("diameter ", b.method.fibre) + "\n" : springs;
    SceneText of{
        everything + chain + (b.method.takes_drag ? drag : "") + b.method.cohesion + b.method.adhesion,
        "battery", "."};
    if (!b.options.scene.empty()) {
        const Config config = Config::load(b.options.scene);
        of = {config.text(), b.options.scene, config.folder()};
    }
    // Strength of the adhesion [m/s²], radius of the cohesion [m]: over decades, one at a time.
    std::vector<std::pair<double, double>> wet{{60, 0.01}};
    if (!b.options.quick && of.has(Adhesion::table))
        for (double pull : {6.0, 600.0, 6000.0}) wet.push_back({pull, 0.01});
    if (!b.options.quick && of.has(Cohesion::table))
        for (double radius : {0.001, 0.1}) wet.push_back({60, radius});
    Cases out;
    for (double limiter : {0.0, 0.1})
        for (const auto& [pull, radius] : wet)
            out.push_back(all_at_once(b, of, stiffer, pull, radius, limiter));
    return out;
}

}  // namespace wetcurl::stability

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
    bool touches = false, says_lock_width = false;  // which says what the radius does
    bool has(const char* table) const {
        return text.find(std::string("[") + table + "]") != std::string::npos;
    }
};

// Hair is at rest once its particles move by no more in a frame, in segments.
constexpr double still_enough = 5e-5;

// Until hair is at rest, and how still it is then.
void judge_rest(StabilityCase& c, const Battery& b, Scene scene) {
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
    if (trial.scene().cohesion) c.measured.emplace_back("neighbours", trial.simulation().neighbours_mean());
    c.passed = c.finite && c.energy_ratio <= energy_bound && jitter <= jitter_bound;
}

// `changed`: keys of the wet terms, of those that the scene has.
StabilityCase all_at_once(const Battery& b, const SceneText& of, double stiffer, const Figures& changed,
                          double limiter) {
    Figures parameters{{"stiffness_factor", stiffer}};
    parameters.insert(parameters.end(), changed.begin(), changed.end());
    parameters.emplace_back("limiter", limiter);
    StabilityCase c = b.named("S9", "everything at once", parameters);
    std::vector<std::string> set = b.options.set;
    set.push_back(setting("integrator.limiter", limiter));
    for (const auto& [key, value] : changed) set.push_back(setting(key, value));
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
    judge_rest(c, b, std::move(scene));
    return c;
}

// Of the battery's own scene, on a chain of these tables.
std::string wet_scene(const Battery& b, const std::string& chain) {
    return everything + chain + (b.method.takes_drag ? drag : "") + b.method.cohesion + b.method.adhesion;
}

}  // namespace

Cases everything_at_once(const Battery& b, double stiffer) {
    const std::string chain =
        b.method.fibre > 0 ? "[fibre]\n" + setting("diameter ", b.method.fibre) + "\n" : springs;
    SceneText of{wet_scene(b, chain), "battery", "."};
    of.touches = of.has(StrandContact::table);
    if (!b.options.scene.empty()) {
        Config config = Config::load(b.options.scene);
        of = {config.text(), b.options.scene, config.folder()};
        for (const auto& assignment : b.options.set) config.set(assignment);
        of.says_lock_width =
            config.root().has(Cohesion::table) && config.root().table(Cohesion::table).has("lock_width");
    }
    // Of the wet terms that are there, over decades, one at a time.
    struct Key {
        const char *table, *name;
        double usual;
        std::vector<double> others;
    };
    std::vector<Key> keys{{Adhesion::table, "adhesion.strength", 60, {6, 600, 6000}}};
    if (of.touches)  // on all neighbours within the radius, in each substep
        keys.insert(keys.end(), {{Cohesion::table, "cohesion.radius", 0.012, {0.0012}},
                                 {Cohesion::table, "cohesion.strength", 5000, {50, 5e5}},
                                 {StrandContact::table, "strand_contact.strength", 1e4, {1e2, 1e6}}});
    else if (of.says_lock_width)
        keys.push_back({Cohesion::table, "cohesion.lock_width", 0.015, {0.0015, 0.15}});
    else
        keys.push_back({Cohesion::table, "cohesion.radius", 0.01, {0.001, 0.1}});
    std::erase_if(keys, [&](const Key& key) { return !of.has(key.table); });
    std::vector<Figures> wet{{}};
    for (const Key& key : keys) wet[0].emplace_back(key.name, key.usual);
    for (size_t k = 0; k < keys.size() && !b.options.quick; ++k)
        for (const double value : keys[k].others) wet.emplace_back(wet[0])[k].second = value;
    Cases out;
    for (double limiter : {0.0, 0.1})
        for (const Figures& changed : wet) out.push_back(all_at_once(b, of, stiffer, changed, limiter));
    return out;
}

StabilityCase everything_on(const Battery& b, const char* hair) {
    StabilityCase c = b.named("S9", std::string("everything at once on ") + hair, {});
    c.parameters.clear();  // the kind has a diameter of its own
    const std::string chain = std::string("[fibre]\nhair = \"") + hair + "\"\n";
    std::vector<std::string> set{"groom.particles=100", "groom.length=0.15"};
    set.insert(set.end(), b.options.set.begin(), b.options.set.end());
    judge_rest(c, b, scene_of(wet_scene(b, chain), "battery", ".", set, b.method));
    return c;
}

}  // namespace wetcurl::stability

// Reading scenes.
#include "solver/scene/scene.h"

#include <algorithm>
#include <filesystem>

#include "base/log.h"
#include "base/shift_units.h"
#include "solver/grooms/groom.h"
#include "solver/scene/read_compared.h"
#include "solver/scene/rest_state.h"

namespace wetcurl {

namespace {

Vec3d vec3(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }

bool is_printed(Table t, const std::string& fallback = "variational") {
    return t.choice("form", fallback, {"variational", "printed"}) == "printed";
}

// A term, where its table is written (and printed, where it is a printed form's alone).
template <class TermSlot>
void read_term(TermSlot& slot, Table root) {
    using Term = typename TermSlot::value_type;
    if (!root.has(Term::table)) return;
    const Table t = root.table(Term::table);
    if constexpr (requires { Term::printed_only; })
        if (!is_printed(t)) return;
    slot.emplace();
    read_parameters(*slot, Term::parameters, t);
    if constexpr (requires { slot->printed; }) slot->printed = is_printed(t);
}

void read_chain(Scene& scene, Table root) {
    std::apply([&](auto&... slot) { (read_term(slot, root), ...); }, scene.chain);
    if (auto& twist = scene.term<Twist>()) {
        twist->k_b = scene.term<Bend>()->k_b;
        if (!(twist->torsion * twist->k_b > 0)) twist.reset();
    }
    auto& limit = scene.term<StrainLimit>();
    if (!scene.integrator.is_implicit() && !root.table("integrator").has("limiter")) limit = {0.1};
    if (limit && !(limit->most > 0)) limit.reset();
    if (limit) limit->stiffen(1 / (scene.fps * scene.integrator.substeps), spring_sum(scene.chain));
    if (scene.term<Adhesion>()) scene.adhesion_model = root.table("adhesion").path("model");
}

WaterSource read_water_source(Table t) {
    WaterSource source;
    read_parameters(source, WaterSource::parameters, t);
    if (source.until <= source.from)
        t.fail(t.has("until") ? "until" : "from", "a source must end after it begins");
    if (t.choice("shape", "plane", {"plane", "sphere"}) == "sphere")
        source.shape = Sphere{t.number("radius", 0.1, 1e-4, 100)};
    else
        source.shape = Plane{};
    source.center = vec3(t.numbers("center", {0, 0, 0}, -1000, 1000));
    source.motion = Motion(t.table("motion"));
    return source;
}

void read_flow(Scene& scene, Table root) {
    if (!root.has(Wetness::table)) return;
    const Table wetness = root.table(Wetness::table);
    if (!wetness.has("flow")) {
        if (wetness.has("source"))
            wetness.fail("source", "[[wetness.source]] gives water that moves and needs [wetness.flow]");
        return;
    }
    scene.flow.emplace();
    read_parameters(*scene.flow, Flow::parameters, wetness.table("flow"));
    for (const Table& source : wetness.tables("source"))
        scene.flow->sources.push_back(read_water_source(source));
}

void read_wet(Scene& scene, Table root) {
    read_term(scene.wetness, root);
    if (scene.wetness) {
        const Table t = root.table("wetness");
        scene.wetness->pattern = t.choice("pattern", "uniform", wetness_patterns);
        scene.wetness->region_center = vec3(t.numbers("center", {0, 0.1, 0}, -100, 100));
        scene.wetness->file = t.path("file");
        if (scene.wetness->pattern == "file" && scene.wetness->file.empty())
            t.fail("pattern", "'file' needs file = \"RUN.h5\", whose saturation is taken");
    }
    read_flow(scene, root);
    read_term(scene.curl, root);
    if (scene.curl) {
        const Table t = root.table("curl");
        scene.curl->radius = t.optional_number("radius", 0, 1);
        scene.curl->pitch = t.optional_number("pitch", 0, 10);
        if (scene.curl->radius.has_value() != scene.curl->pitch.has_value())
            t.fail(scene.curl->radius ? "radius" : "pitch",
                   "a helix needs both radius and pitch, or neither");
        if (scene.curl->printed && !scene.curl->radius)
            t.fail("form", "'printed' needs the radius and pitch of its helix");
    }
    read_term(scene.cohesion, root);
    if (scene.cohesion) scene.cohesion->passes = int(root.table("cohesion").integer("passes", 10, 1, 1000));
    if (scene.cohesion && scene.cohesion->strength > 0) {
        const Table t = root.table("cohesion");
        if (scene.names_baseline())
            t.fail("strength", "draws strands in place of a [baseline], which this scene names");
        if (!scene.integrator.is_implicit()) t.fail("strength", "needs [integrator] kind = \"implicit\"");
        if (scene.flow) t.fail("strength", "goes by the water at the start; [wetness.flow] moves it");
    }
    if (scene.cohesion && scene.cohesion->spacing > 0 && scene.flow)
        root.table("cohesion")
            .fail("spacing",
                  "found beside [wetness.flow], which goes by the neighbours of each particle; allowed is 0");
    for (const char* wet : {"curl", "cohesion", "adhesion"})
        if (root.has(wet) && !scene.wetness)
            root.fail(wet, std::string("[") + wet + "] acts on wet hair and needs a [wetness] table");
    if (scene.curl && !scene.curl->printed && !scene.term<Bend>())
        root.fail("curl", "[curl] blends the target of [bend], which this scene does not name");
}

double units_of(Table t) {
    const std::string units = t.choice("units", "m", {"m", "cm", "mm"});
    return units == "m" ? 1 : units == "cm" ? 0.01 : 0.001;
}

Shape level_set_of(Table t, double spacing) {
    const Mesh mesh = mesh_of(t, units_of(t));
    try {
        return LevelSet::cached(mesh, spacing);
    } catch (const Error& e) {
        throw Error(t.where("file") + ": " + t.path("file") + ": " + e.what());
    }
}

Solid read_solid(Table t, size_t index) {
    Solid solid;
    solid.name = t.text("name", "solid " + std::to_string(index));
    const std::string shape = t.choice("shape", "sphere", {"sphere", "capsule", "box", "plane", "mesh"});
    if (shape == "sphere") solid.shape = Sphere{t.number("radius", 0.1, 1e-4, 100)};
    if (shape == "capsule")
        solid.shape = Capsule{t.number("half_length", 0.1, 0, 100), t.number("radius", 0.05, 1e-4, 100)};
    if (shape == "box") solid.shape = Box{vec3(t.numbers("half", {0.1, 0.1, 0.1}, 1e-4, 100))};
    if (shape == "plane") solid.shape = Plane{};
    if (shape == "mesh") {
        solid.spacing = t.number("spacing", 0, 0, 1);
        if (t.has("mesh")) {
            if (t.has("file"))
                t.fail("file",
                       "is the mesh of a solid that keeps its shape; [[solid.mesh]] are one's that deforms");
            solid.deformation = std::make_shared<const Deformation>(t, units_of(t));
        } else if (t.has("file")) {
            solid.shape = level_set_of(t, solid.spacing);
        } else {
            t.fail("shape",
                   "'mesh' needs file = \"….obj\" or \"….ply\", or [[solid.mesh]] tables to deform between");
        }
    }
    const std::string attached = t.choice("attached", "none", {"none", "head"});
    solid.attached = attached == "head";
    solid.friction = t.number("friction", 0.3, 0, 100);
    if (solid.attached && t.has("motion"))
        t.fail("motion", "a solid that is attached to the head moves with it");
    if (!solid.attached) solid.motion = Motion(t.table("motion"));
    return solid;
}

void read_solids(Scene& scene, Table root) {
    if (scene.term<Adhesion>() && !root.has("solid"))
        root.fail("adhesion", "[adhesion] needs a [[solid]] to stick to");
    const auto tables = root.tables("solid");
    for (size_t i = 0; i < tables.size(); ++i) scene.solids.push_back(read_solid(tables[i], i));
}

AirSource read_air_source(Table t) {
    AirSource source;
    read_parameters(source, AirSource::parameters, t);
    source.center = vec3(t.numbers("center", {0, 0, 0}, -1000, 1000));
    source.velocity = vec3(t.numbers("velocity", {0, 0, 1}, -1000, 1000));
    return source;
}

void read_air(Scene& scene, Table root) {
    if (!root.has("air")) return;
    const Table t = root.table("air");
    Air& air = scene.air.emplace();
    read_parameters(air, Air::parameters, t);
    const auto grid = t.numbers("grid", {64, 64, 64}, 8, 512);
    for (size_t axis = 0; axis < 3; ++axis) {
        air.grid[axis] = int(grid[axis]);
        if (air.grid[axis] != grid[axis]) t.fail("grid", "found a part of a cell, allowed are whole ones");
    }
    air.center = vec3(t.numbers("center", {0, 0, 0}, -1000, 1000));
    air.wind = vec3(t.numbers("wind", {0, 0, 0}, -1000, 1000));
    air.two_way = t.boolean("two_way", false);
    for (const Table& source : t.tables("source")) air.sources.push_back(read_air_source(source));
}

void read_learned(Scene& scene, Table root) {
    if (!root.has("learned")) return;
    const Table t = root.table("learned");
    if (!t.has("model")) t.fail("model", "needed: the file of a network, trained or yet to be");
    scene.learned = {t.path("model"),
                     t.has("reconstruct") ? t.choice("reconstruct", "core", {"paper", "core"}) : "",
                     t.optional_number("gain", 0, largest_gain),
                     t.has("units") ? t.choice("units", "length", shift_units_names) : ""};
}

Scene read_scene(Config config, const SceneOptions& options) {
    for (const auto& s : options.set) config.set(s);
    if (options.frames) config.set("frames=" + std::to_string(*options.frames), "--frames");
    if (options.seed) config.set("seed=" + std::to_string(*options.seed), "--seed");
    if (!options.groom.empty())
        config.set("groom.file='" + std::filesystem::absolute(options.groom).string() + "'", "--groom");
    Table root = config.root();
    Scene scene;
    scene.title = root.text("title", "");
    scene.frames = int(root.integer("frames", 100, 1, 1'000'000));
    scene.fps = root.number("fps", 24, 1, 10000);
    scene.seed = (unsigned long long)root.integer("seed", 1, 0, largest_seed);
    scene.text = config.text();
    scene.folder = config.folder();

    read_baselines(scene, root);
    Table t = root.table("integrator");
    Integrator& in = scene.integrator;
    in.kind = t.choice("kind", scene.baseline<Iben2013>() ? "explicit" : "implicit",
                       {"implicit", "backward_euler", "explicit"});
    in.substeps = int(t.integer("substeps", 10, 1, 1'000'000));
    in.max_linearisations = int(t.integer("looks", 4, 1, 1000));
    in.relinearise_angle = t.number("turn", 0.002, 0, 10);
    in.settle = t.number("settle", 0, 0, 1000);
    in.gravity = vec3(t.numbers("gravity", {0, -9.81, 0}, -1e5, 1e5));

    Table g = root.table("groom");
    scene.linear_density = g.number("linear_density", 6.5e-6, 1e-12, 1e3);
    scene.volume_density = g.number("density", 1300, 1, 1e5);
    scene.rest = g.choice("rest", "drawn", {"drawn", "sag_free"});
    const Groom full = load_groom(g, scene.seed, "");
    scene.motion = Motion(root.table("motion"));
    read_chain(scene, root);
    // Of the full groom, so that a thinned run is smoothed as its twin.
    if (auto& core = scene.term<Core>()) core->beta = filter_beta(mean_segment(full), core->alpha_c);
    read_term(scene.strand_contact, root);
    read_wet(scene, root);
    read_solids(scene, root);
    read_air(scene, root);
    read_learned(scene, root);
    check_baselines(scene, root);
    if (scene.rest == "sag_free" && !scene.term<Bend>())
        g.fail("rest", "'sag_free' needs [bend] to carry the weight");
    config.require_all_used();
    scene.files = config.files();
    if (!scene.term<Stretch>())
        log_warning(root.where() + "no [stretch]: nothing holds the particles of a strand together");

    std::vector<int> kept;
    if (options.stride > 0)
        scene.stride = options.stride;
    else if (options.strands)
        thinned(full, *options.strands, &scene.stride);
    scene.groom = coarsened(full, scene.stride, &kept);
    if (const int taken = scene.groom.rest.count; options.strands && taken != *options.strands)
        log_info("--strands " + std::to_string(*options.strands) + ": " + nesting_text(full) + "; " +
                 std::to_string(taken) + " are taken");
    if (scene.groom.rest.count == 0) throw Error(scene.title + ": no strand is left in the groom");
    if (scene.wetness) {
        // Patterns are laid on the full groom, so that a thinned run is as wet as its twin.
        const auto sigma = saturation_of(*scene.wetness, full, scene.seed);
        const size_t n = size_t(full.rest.particles);
        for (int s : kept)
            scene.saturation.insert(scene.saturation.end(), sigma.begin() + long(size_t(s) * n),
                                    sigma.begin() + long(size_t(s + 1) * n));
    }
    return scene;
}

}  // namespace

Scene load_scene(const std::string& path, const SceneOptions& options) {
    return read_scene(Config::load(path), options);
}

Scene parse_scene(const std::string& text, const std::string& name, const std::string& folder,
                  const SceneOptions& options) {
    return read_scene(Config::parse(text, name, folder), options);
}

Scene parse_scene(const Config& config, const SceneOptions& options) {
    return read_scene(config.copy(), options);
}

void make_dry(Scene& scene) {
    scene.wetness.reset();
    scene.flow.reset();
    scene.curl.reset();
    scene.cohesion.reset();
    scene.adhesion_model.clear();
    auto leave_out = []<class Method>(Slot<Method>& slot) {
        if constexpr (!std::is_same_v<Method, Iben2013>) slot.reset();
    };
    std::apply([&](auto&... slot) { (leave_out(slot), ...); }, scene.baselines);
    scene.term<Adhesion>().reset();
    scene.term<CurlPush>().reset();
}

void leave_out_display(Scene& scene) {
    if (scene.cohesion && scene.cohesion->strength == 0) scene.cohesion.reset();
}

bool acts_wet(const Scene& scene) { return scene.wetness.has_value(); }

std::string method_of(const Scene& scene) {
    const std::string compared = title_of(scene.baselines);
    return (acts_wet(scene) ? "simulated wet" : "simulated dry") + (compared.empty() ? "" : ", " + compared);
}

}  // namespace wetcurl

// Reading scenes.
#include "solver/scene/scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <numbers>

#include "base/log.h"
#include "solver/grooms/groom.h"
#include "solver/grooms/guides.h"
#include "solver/grooms/procedural.h"
#include "solver/scene/findings.h"
#include "solver/scene/read_compared.h"
#include "solver/scene/read_solids.h"
#include "solver/scene/rest_state.h"
#include "solver/scene/scene_rows.h"

namespace wetcurl {

namespace {

// A term, where its table is written (and what it needs in that table).
template <class TermSlot>
void read_term(TermSlot& slot, const Table& root) {
    using Term = typename TermSlot::value_type;
    if (!root.has(Term::table)) return;
    const Table t = root.table(Term::table);
    if constexpr (requires { Term::when; })
        if (!t.holds(Term::when)) return;
    slot.emplace();
    read_parameters(*slot, Term::parameters, t);
}

// The chain of a fibre. What is one number a scene is the largest spring of each kind.
void make_chain_of_fibre(Scene& scene, const Groom& full) {
    const Fibre& fibre = *scene.fibre;
    Fibre::Springs most{{0}, {0}, {0}};
    for (int s = 0; s < full.rest.count; ++s) {
        const Fibre::Springs own =
            fibre.springs(edge_lengths(points_of(full.rest, s)), scene.thickness_of(s));
        const auto larger = [](double& most, const std::vector<double>& all) {
            for (double k : all) most = std::max(most, k);
        };
        larger(most.stretch[0], own.stretch), larger(most.bend[0], own.bend),
            larger(most.twist[0], own.twist);
    }
    Stretch& stretch = scene.term<Stretch>().emplace();
    stretch.k_s = most.stretch[0], stretch.c_s = fibre.damping * stretch.k_s, stretch.delay = fibre.damping;
    Bend& bend = scene.term<Bend>().emplace();
    bend.k_b = most.bend[0], bend.c_b = fibre.damping * bend.k_b, bend.delay = fibre.damping;
    Twist& twist = scene.term<Twist>().emplace();
    twist.torsion = fibre.torsional_rigidity() / fibre.flexural_rigidity(), twist.k_b = bend.k_b;
}

void read_fibre(Scene& scene, const Table& root) {
    read_term(scene.fibre, root);
    if (!scene.fibre) return;
    for (const char* table : {"stretch", "bend"})
        if (root.has(table))
            root.fail(
                table,
                std::string("found beside [fibre], which says the springs of the hair; allowed is one of "
                            "both: leave out [") +
                    table + "] or [fibre]");
    const Table groom = root.table("groom");
    for (const char* key : {"linear_density", "density"})
        if (groom.has(key))
            groom.fail(key,
                       "found beside [fibre], whose diameter and density say it; allowed is one of both");
    if (scene.baseline<Iben2013>())
        root.fail(
            "fibre",
            "[baseline] chain = \"iben\" has springs of segments: [stretch] and [bend] in place of [fibre]");
    scene.linear_density = scene.fibre->linear_density(), scene.volume_density = scene.fibre->density;
}

void read_chain(Scene& scene, const Table& root, const Groom& full) {
    std::apply([&](auto&... slot) { (read_term(slot, root), ...); }, scene.chain);
    if (scene.fibre) {
        scene.thickness = scene.fibre->thickness(full, scene.seed);
        make_chain_of_fibre(scene, full);
    }
    if (auto& twist = scene.term<Twist>()) {
        if (!scene.fibre) twist->k_b = scene.term<Bend>()->k_b;
        if (!(twist->torsion * twist->k_b > 0)) twist.reset();
    }
    auto& limit = scene.term<StrainLimit>();
    if (!scene.integrator.is_implicit() && !root.table("integrator").has("limiter")) limit = {0.1};
    if (limit && !(limit->most > 0)) limit.reset();
    if (limit) limit->stiffen(1 / (scene.fps * scene.integrator.substeps), spring_sum(scene.chain));
    if (scene.term<Adhesion>())
        read_parameters(scene, Scene::adhesion_parameters, root.table(Adhesion::table));
}

WaterSource read_water_source(const Table& t) {
    WaterSource source;
    read_parameters(source, WaterSource::parameters, t);
    if (source.until <= source.from)
        t.fail(t.has("until") ? "until" : "from", "a source must end after it begins");
    if (source.kind == "sphere")
        source.shape = Sphere{source.radius};
    else
        source.shape = Plane{};
    source.motion = Motion(t.table("motion"));
    return source;
}

void read_flow(Scene& scene, const Table& root) {
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

void read_wet(Scene& scene, const Table& root) {
    read_term(scene.wetness, root);
    if (scene.wetness && scene.wetness->pattern == "file" && scene.wetness->file.empty())
        root.table("wetness").fail("pattern", "'file' needs file = \"RUN.h5\", whose saturation is taken");
    read_flow(scene, root);
    read_term(scene.curl, root);
    if (scene.curl) {
        const Table t = root.table("curl");
        if (scene.curl->radius.has_value() != scene.curl->pitch.has_value())
            t.fail(scene.curl->radius ? "radius" : "pitch",
                   "a helix needs both radius and pitch, or neither");
        if (scene.curl->printed && !scene.curl->radius)
            t.fail("form", "'printed' needs the radius and pitch of its helix");
    }
    read_term(scene.cohesion, root);
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
                  "found beside [wetness.flow], which changes what each particle weighs; allowed is 0");
    if (scene.cohesion) {
        const Table t = root.table("cohesion");
        if (t.has("neighbours") && scene.cohesion->neighbours > 0 &&
            (scene.flow || scene.cohesion->strength > 0))
            t.fail("neighbours", std::string("found beside ") + (scene.flow ? "[wetness.flow]" : "strength") +
                                     ", which needs all strands; allowed is 0");
        scene.cohesion->complete(t, scene.flow.has_value());
    }
    for (const char* wet : {"curl", "cohesion", "adhesion"})
        if (root.has(wet) && !scene.wetness)
            root.fail(wet, std::string("[") + wet + "] acts on wet hair and needs a [wetness] table");
    if (scene.curl && !scene.curl->printed && !scene.term<Bend>())
        root.fail("curl", "[curl] blends the target of [bend], which this scene does not name");
}

AirSource read_air_source(const Table& t) {
    AirSource source;
    read_parameters(source, AirSource::parameters, t);
    return source;
}

void read_air(Scene& scene, const Table& root) {
    read_term(scene.air, root);
    if (!scene.air) return;
    for (const Table& source : root.table("air").tables("source"))
        scene.air->sources.push_back(read_air_source(source));
}

void read_learned(Scene& scene, const Table& root) {
    if (!root.has("learned")) return;
    const Table t = root.table("learned");
    read_parameters(scene.learned.emplace(), Learned::parameters, t);
    if (scene.learned->model.empty()) t.fail("model", "needed: the file of a network, trained or yet to be");
}

void read_integrator(Scene& scene, const Table& t) {
    Integrator& in = scene.integrator;
    read_parameters(in, Integrator::parameters, t);
    read_parameters(in, Gravity::parameters, t);
    if (scene.baseline<Iben2013>() && !t.has("kind")) in.kind = "explicit";
}

const LevelSet* level_set_of(const Solid& solid) {
    const auto* shape = std::get_if<std::shared_ptr<const LevelSet>>(&solid.shape);
    return shape ? shape->get() : nullptr;
}

// Of the solid that `[groom] scalp` names; "" where it names a file or nothing.
std::string name_of_scalp(const Table& groom, const std::vector<std::string>& names) {
    const auto& row = *std::ranges::find(GroomTable::parameters, std::string_view("scalp"),
                                         [](const KeyRow& r) { return std::string_view(r.key); });
    const std::string name = groom.name_in_place_of(row, names);
    if (name.empty() && groom.has("scalp"))
        if (const std::string file = groom.text(row); !std::filesystem::exists(file)) {
            GroomTable others;  // whose faults come first
            read_parameters(others, GroomTable::parameters, groom);
            groom.fail("scalp", fmt::format("found no file '{}' and no [[solid]] of that name{}{}", file,
                                            names.empty() ? "" : "; solids of the scene are ",
                                            fmt::join(names, ", ")));
        }
    if (name.empty()) return "";
    if (std::count(names.begin(), names.end(), name) > 1)
        groom.fail("scalp", "'" + name +
                                "' is the name of several solids; the one that hair grows on needs a name of "
                                "its own");
    for (const char* of_file : {"scalp_units", "scalp_up"})
        if (groom.has(of_file))
            groom.fail(of_file, "belongs to a scalp that is a file; this one is [[solid]] '" + name + "'");
    return name;
}

// That solid, a mesh. A rigid one is the head, so that all strands move with it.
Solid& solid_of_scalp(Scene& scene, const Table& groom, const std::string& name) {
    Solid& solid = *std::ranges::find(scene.solids, name, &Solid::name);
    if (!solid.deformation && !level_set_of(solid))
        groom.fail("scalp", "[[solid]] '" + name + "' is no mesh; roots lie on one with shape = \"mesh\"");
    if (solid.attached) return solid;
    if (scene.motion.moves())
        groom.fail("scalp", "[[solid]] '" + name +
                                "' is not attached to the head, which [motion] moves; hair that grows on the "
                                "solid moves with it: write attached = \"head\", or the motion in "
                                "[solid.motion]");
    // A cut of what hair grows on is one of the shot.
    scene.cuts = scene.cuts.joined(solid.cuts);
    if (!solid.deformation) scene.motion = solid.motion, solid.attached = true;
    return solid;
}

std::shared_ptr<const ScalpMesh> scalp_of(const Solid& solid) {
    return std::make_shared<const ScalpMesh>(solid.deformation ? solid.deformation->rest()
                                                               : level_set_of(solid)->mesh());
}

void read_head(Scene& scene, const Table& t, double last) {
    scene.motion = Motion(t);
    scene.cuts = cuts_of(t, scene.fps, last);
    Preroll preroll;
    read_parameters(preroll, Preroll::parameters, t);
    scene.preroll = preroll.seconds;
}

// A kind of hair has its own values for keys that the scene does not write.
void name_hair(Config& config) {
    const Table root = config.root(), fibre = root.table(Fibre::table), groom = root.table("groom");
    Fibre named;
    read_parameters(named, Fibre::parameters, fibre);
    const HairKind* const kind = hair_named(named.hair);
    if (!kind) return;
    std::vector<std::string> values;
    const auto put = [&](const Table& table, const std::string& name, const char* key, double value) {
        if (!table.has(key)) values.push_back(fmt::format("{}.{}={}", name, key, value));
    };
    for (const HairKind::Value& v : kind->fibre()) put(fibre, Fibre::table, v.key, v.value);
    if (!groom.has("file"))
        for (const HairKind::Value& v : kind->groom()) put(groom, "groom", v.key, v.value);
    for (const std::string& value : values)
        config.set(value, fmt::format("[fibre] hair = \"{}\"", kind->name));
}

Scene read_scene(Config config, const SceneOptions& options) {
    for (const auto& s : options.set) config.set(s);
    if (options.frames) config.set("frames=" + std::to_string(*options.frames), "--frames");
    if (options.seed) config.set("seed=" + std::to_string(*options.seed), "--seed");
    if (!options.groom.empty())
        config.set("groom.file='" + std::filesystem::absolute(options.groom).string() + "'", "--groom");
    config.expect(scene_rows());
    name_hair(config);
    const Table root = config.root();
    Scene scene;
    read_parameters(scene, Scene::parameters, root);
    scene.text = config.text();
    scene.folder = config.folder();

    read_baselines(scene, root);
    read_integrator(scene, root.table("integrator"));
    const Table g = root.table("groom");
    read_parameters(scene, Scene::groom_parameters, g);
    read_fibre(scene, root);
    const double last = options.endless ? std::numeric_limits<double>::infinity()
                                        : options.start + (scene.frames - 1) / scene.fps;
    read_head(scene, root.table("motion"), last);
    const std::vector<std::string> solids = names_of_solids(root);
    static const Brought nothing;
    const Brought& brought = options.brought ? *options.brought : nothing;
    for (const auto& [name, mesh] : brought.meshes)
        if (std::ranges::find(solids, name) == solids.end())
            throw Misuse(root.where() + "found a mesh for [[solid]] '" + name + "', which is not there");
    AroundSolids around{scene.fps, last, name_of_scalp(g, solids), {}, brought.meshes};
    Solid* scalp = nullptr;
    const auto read_all = [&](const std::vector<Vec3d>& roots) {
        around.roots = roots;
        scene.solids = read_solids(root, around);
    };
    // Solids come after the hair, whose roots tell the unit of a head, and before it where it grows on one.
    const Groom full = load_groom(
        g, scene.seed,
        [&](const std::vector<Vec3d>& roots) {
            if (around.scalp.empty()) return std::shared_ptr<const ScalpMesh>();
            read_all(roots);
            scalp = &solid_of_scalp(scene, g, around.scalp);
            return scalp_of(*scalp);
        },
        &scene.groom_findings, brought.strands, &scene.curl_turns);
    if (!scalp) read_all(roots_of(full.rest));
    read_chain(scene, root, full);
    // Of the full groom, so that a thinned run is smoothed as its twin.
    if (auto& core = scene.term<Core>()) core->beta = filter_beta(mean_segment(full), core->alpha_c);
    read_term(scene.strand_contact, root);
    read_wet(scene, root);
    if (scene.term<Adhesion>() && !root.has("solid"))
        root.fail("adhesion", "[adhesion] needs a [[solid]] to stick to");
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
    if (options.guides > 0) {
        scene.guides = options.guides;
        kept = chosen_guides(full, scene.guides);
        scene.groom = part_of(full, kept);
    } else {
        scene.groom = coarsened(full, scene.stride, &kept);
    }
    if (!scene.thickness.empty()) {
        std::vector<double> of_kept;
        for (int s : kept) of_kept.push_back(scene.thickness[size_t(s)]);
        scene.thickness = std::move(of_kept);
    }
    if (!scalp) scalp = guessed_scalp(scene, full);
    if (scalp && scalp->deformation) ride(scene, *scalp, full, kept);
    scene.end = options.start + scene.frames / scene.fps;
    scene.endless = options.endless;
    if (options.endless)
        for (const Solid& solid : scene.solids)
            if (solid.deformation) scene.end = std::max(scene.end, solid.deformation->times().back());
    survey(scene, full);
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
    Scene scene = read_scene(Config::load(path), options);
    if (options.findings_stop) act_on(findings_of(scene), scene, path);
    return scene;
}

Scene parse_scene(const std::string& text, const std::string& name, const std::string& folder,
                  const SceneOptions& options) {
    return read_scene(Config::parse(text, name, folder), options);
}

Scene parse_scene(const Config& config, const SceneOptions& options) {
    return read_scene(config.copy(), options);
}

double Scene::hair_width(int strand, double along) const {
    const double width = std::sqrt(4 * linear_density / (std::numbers::pi * volume_density));
    return fibre ? width * thickness_of(strand) * fibre->profile_at(along) : width;
}

void make_dry(Scene& scene) {
    scene.wetness.reset();
    scene.flow.reset();
    scene.curl.reset();
    scene.cohesion.reset();
    scene.adhesion_model.clear();
    auto leave_out = [](auto& slot) {
        using Method = typename std::decay_t<decltype(slot)>::value_type;
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

// `wetcurl infer`: wet high-resolution hair from a dry low-resolution run, by a network or by interpolation.
#include "app/commands/infer.h"

#include <fmt/format.h>

#include <filesystem>

#include "app/engine/device.h"
#include "app/engine/learned_hair.h"
#include "app/engine/missing_model.h"
#include "app/engine/scene_changes.h"
#include "app/engine/simulate_scene.h"
#include "app/inference/predict_run.h"
#include "app/options/option_list.h"
#include "base/log.h"
#include "learn/codec/stencil.h"

namespace wetcurl {

namespace {

bool is_scene(const std::string& path) { return path.ends_with(".toml"); }

// The file of the scene to predict for.
const std::string& scene_name(const InferOptions& o) { return o.wetness.empty() ? o.input : o.wetness; }

// What Eq 9 and 10 are asked of.
void require_named(const InferOptions& o, const Scene& scene) {
    if (o.cohesion && !scene.cohesion)
        throw Misuse("--cohesion: the scene to predict for has no [cohesion]; --wetness names one that has");
    if (o.wet_shape && !scene.curl)
        throw Misuse("--wet-shape: the scene to predict for has no [curl]; --wetness names one that has");
}

// What the scene's [learned] names, where the command line names nothing. low_strands: of the low-resolution
// run, where that is to be simulated; 0: it is a file.
void take_learned(InferOptions& o, const Scene& scene, int low_strands) {
    if (!o.model.empty() || !o.interpolate.empty() || !o.oracle_colours.empty() || !o.oracle_weights.empty())
        return;
    if (!scene.learned)
        throw Misuse(
            "infer needs --model MODEL.h5, --interpolate nearest|quad|core|rest|skin, or a scene with "
            "[learned] "
            "model");
    o.model = scene.learned->model;
    if (o.reconstruct.empty()) o.reconstruct = scene.learned->reconstruct;
    if (!o.gain) o.gain = scene.learned->gain;
    if (o.units.empty()) o.units = scene.learned->units;
    const std::string where = (low_strands ? o.input : scene_name(o)) + ": [learned] model";
    // A way of reconstruction is for models of images alone.
    if (low_strands && scene.term<Adhesion>() && o.reconstruct.empty())
        return require_model_of_adhesion(o.model, where, o.input, o);
    RunsToLearnFrom runs;
    runs.scene = scene_name(o), runs.codec = o.reconstruct.empty() ? "strand" : "root";
    if (low_strands)
        runs.low_scene = o.input, runs.low_strands = low_strands;
    else
        runs.low = o.input, runs.strands = scene.stride > 1 ? scene.groom.rest.count : 0;
    require_model_of_strands(o.model, where, runs, o);
}

// Throws unless the scene can be predicted for from a low-resolution run of that groom, or of guides of it.
void require_predictable(const InferOptions& o, const Scene& scene, const Groom& low, bool guides) {
    check_files(o, o.output, scene.files);
    require_rigid_scalp(scene, scene_name(o));
    if (scene.flow)
        throw Error(o.input +
                    ": its scene moves the water ([wetness.flow]), allowed is wetness that stays; "
                    "--wetness names a scene of it");
    require_named(o, scene);
    if (low.rest.count >= scene.groom.rest.count)
        throw Error(
            fmt::format("{}: found {} low-resolution strands to predict {} from, allowed are fewer "
                        "(simulate --strands or --guides)",
                        o.input, low.rest.count, scene.groom.rest.count));
    if (o.any_roots) return;
    try {
        // Guides are of the whole groom, of which less may be predicted.
        if (guides && scene.stride > 1)
            require_part(parse_scene(scene.text, scene_name(o), scene.folder).groom, low);
        else
            require_part(scene.groom, low);
    } catch (const Error& e) {
        throw Error(fmt::format("{}, {}: {} (--any-roots takes guides that are none of them)", o.input,
                                o.wetness.empty() ? "its scene" : o.wetness, e.what()));
    }
}

// What is to be predicted for: all strands, or as many as are asked for.
SceneOptions to_predict(const InferOptions& o) {
    SceneOptions options;
    options.set = o.set;
    options.strands = o.strands;
    return options;
}

Scene wetness_scene(const InferOptions& o) {
    SceneOptions options = to_predict(o);
    options.seed = o.seed;
    return load_scene(o.wetness, options);
}

std::string key_of(const std::string& assignment) {
    std::string name = assignment.substr(0, assignment.find('='));
    std::erase(name, ' ');
    return name;
}

// Whether --set names that key, or its whole table.
bool sets(const InferOptions& o, const std::string& table, const std::string& key) {
    return std::ranges::any_of(o.set, [&](const std::string& assignment) {
        const std::string name = key_of(assignment);
        return name == table || name == table + "." + key;
    });
}

// The low-resolution twin of the scene: dry, or wet before Eq 10 if the model learned from wet runs.
Scene low_scene_of(const InferOptions& o, const Method& method, const Scene& scene) {
    if (o.stride && o.guides)
        throw Misuse(
            "--guides: found with --stride, allowed is one of them: strands chosen, or a grid of them");
    Scene low = low_resolution_of(scene, {.each = o.stride.value_or(2), .guides = o.guides.value_or(0)});
    if (method.card() && method.card()->low == "wet" && !method.is_settled())
        leave_out_display(low);
    else
        make_dry(low);
    if (!low.adhesion_model.empty())
        require_model_of_adhesion(low.adhesion_model, o.input + ": [adhesion] model", o.input, o);
    return low;
}

// `again`: the low-resolution run a second time, where --within asks for it.
int predict(const InferOptions& o, const Method& method, Scene scene, LowRun& low, int frames,
            LowRun* again) {
    ResultFile results(o);
    predict_run(method, std::move(scene), scene_name(o), low,
                {.output = o.output,
                 .frames = frames,
                 .device = o.device,
                 .threads = o.threads,
                 .overwrite = o.overwrite,
                 .resume = o.resume,
                 .within = o.within.value_or(0) * 1e-3,
                 .again = again},
                results);
    return 0;
}

// The scene with the network in Eq 11's place.
int simulate_with(const AdhesionNetworkMethod& network, const InferOptions& o, Scene scene) {
    if (!scene.term<Adhesion>())
        throw Misuse(network.model + ": stands in Eq 11's place, and " + o.input + " has no [adhesion]");
    set_adhesion_model(scene, std::filesystem::absolute(network.model).string());
    check_files(o, o.output, scene.files);
    ResultFile results(o);
    simulate_scene(std::move(scene),
                   {.output = o.output,
                    .device = o.device,
                    .precision = "float",
                    .threads = o.threads,
                    .overwrite = o.overwrite,
                    .resume = o.resume},
                   results);
    return 0;
}

// From a scene, whose low-resolution run is simulated.
int infer_scene(InferOptions o) {
    if (o.any_roots)
        throw Misuse("--any-roots: found with the scene " + o.input +
                     ", whose own strands are simulated; allowed with a run");
    SceneOptions options;
    options.set = o.set;
    options.frames = o.frames;
    options.seed = o.seed;
    Scene scene = load_scene(o.input, options);
    if (o.wetness.empty()) require_named(o, scene);
    take_learned(o, scene, coarsened(scene.groom, 2).rest.count);
    const Method method = method_of(o);
    if (method.as<AdhesionNetworkMethod>() && (o.stride || o.guides || o.strands))
        throw Misuse(fmt::format("--{}: found with an adhesion model, which is simulated with all strands",
                                 o.stride   ? "stride"
                                 : o.guides ? "guides"
                                            : "strands"));
    if (const auto* network = method.as<AdhesionNetworkMethod>())
        return simulate_with(*network, o, std::move(scene));
    if (const auto* oracle = method.as<OracleMethod>())
        throw Misuse(std::string(oracle->by_weights ? "--oracle-weights" : "--oracle-colours") +
                     ": found with " + o.input +
                     ", allowed with a low-resolution run; simulate --dry --strands N makes one");
    if (const ModelCard* card = method.card()) require_solids_for(*card, o.locks.has_value(), scene, o.input);
    Scene low = low_scene_of(o, method, scene);
    if (const ModelCard* card = method.card())
        if (card->low_substeps && !sets(o, "integrator", "substeps")) set_substeps(low, card->low_substeps);
    if (!o.wetness.empty())
        scene = wetness_scene(o);
    else if (o.strands)
        options.strands = o.strands, scene = load_scene(o.input, options);
    require_predictable(o, scene, low.groom, low.guides > 0);
    const int frames = low.frames;
    std::optional<LowRun> again;
    if (o.within) again.emplace(o.input, low, o.device, o.threads);
    LowRun run(o.input, std::move(low), o.device, o.threads);
    return predict(o, method, std::move(scene), run, frames, again ? &*again : nullptr);
}

// From a run.
int infer_run(InferOptions o) {
    // Of a run's own scene it may change how far edges may stretch, which is asked of what is predicted.
    CommonOptions others = o;
    std::erase_if(others.set, [](const std::string& s) { return key_of(s) == "integrator.allow_stretch"; });
    if (o.wetness.empty()) refuse_scene_options(others, "infer from a run without --wetness");
    if (o.any_roots && o.wetness.empty())
        throw Misuse(
            "--any-roots: found without --wetness, allowed with the scene whose strands are predicted");
    if (o.stride || o.guides)
        throw Misuse(fmt::format(
            "--{}: found with the run {}, allowed with a scene, of which it says what to simulate",
            o.stride ? "stride" : "guides", o.input));
    LowRun low(o.input);
    const RunHeader& header = low.header();
    if (o.frames && *o.frames > low.frames())
        throw Misuse("--frames: found " + std::to_string(*o.frames) + ", allowed 1 to " +
                     std::to_string(low.frames()) + ", which " + o.input + " has");
    if (header.stride < 2 && header.guides == 0 && !o.any_roots)
        throw Error(o.input +
                    ": the run already holds every strand of its groom; a low-resolution one is needed "
                    "(simulate --strands or --guides)");
    Scene scene = o.wetness.empty() ? parse_scene(header.scene, o.input, header.scene_folder, to_predict(o))
                                    : wetness_scene(o);
    take_learned(o, scene, 0);
    require_predictable(o, scene, header.groom, header.guides > 0);
    std::optional<LowRun> again;
    if (o.within) {
        again.emplace(o.input);
        if (o.wetness.empty())
            log_warning(
                fmt::format("--within: strands are simulated in the {} substeps a frame of {}; --wetness "
                            "names a scene that says others",
                            scene.integrator.substeps, o.input));
    }
    return predict(o, method_of(o), std::move(scene), low, o.frames.value_or(low.frames()),
                   again ? &*again : nullptr);
}

// Within what a scene may name for that key of its [cohesion].
OptionRow within_cohesion(OptionRow option, const std::string& key) {
    for (const auto& row : Cohesion::parameters)
        if (row.key == key) return option.within(row.minimum, row.maximum);
    throw Error("[cohesion] has no " + key);
}

}  // namespace

void add_options(OptionList& options, InferOptions& o) {
    options
        .option(
            "input", o.input,
            "LOW.h5, or a scene whose low-resolution run is simulated as well, dry or as the model learned")
        .input_file()
        .required();
    options.option("--model", o.model, "trained model (HDF5), in place of the scene's [learned] model")
        .input_file();
    options.option("--interpolate", o.interpolate, "without a network: nearest | quad | core | rest | skin")
        .one_of({"nearest", "quad", "core", "rest", "skin"});
    options.option(
        "--oracle-colours", o.oracle_colours,
        "in place of a network of the root codec: the colours of this wet run (Eq 16), which a network "
        "without error predicts");
    options.option(
        "--oracle-weights", o.oracle_weights,
        "in place of any colours: the weights in Eq 18 that bring each strand nearest to this wet run, a "
        "bound for all networks of the root codec");
    options
        .option("--reconstruct", o.reconstruct,
                "for a model of the root codec and for oracles: paper | core (default)")
        .one_of({"paper", "core"});
    options
        .option(
            "--gain", o.gain,
            "kappa of Eq 18, for a model of the root codec and --oracle-colours, in place of the model's; "
            "default 1")
        .within(0.0, largest_gain);
    options
        .option(
            "--units", o.units,
            "how the shift of Eq 18 is read: length (default), times the support radius to the fifth power, "
            "or printed, SI numbers without it")
        .one_of(shift_units_names);
    options
        .option("--colour-units", o.colour_units, std::string("for --oracle-colours: ") + colour_units_help)
        .one_of(shift_units_names);
    options
        .option(
            "--roots", o.roots,
            "that a new strand is made from, for interpolations, oracles and models of the root codec: the "
            "grid's 4 or the nearest 3")
        .within(3, 4)
        .shows_default();
    options.flag(
        "--settled", o.settled,
        "for models of wet runs and --interpolate rest: from a dry run, moved to where wet strands come "
        "to rest, which is simulated first");
    options.flag(
        "--crop", o.crop,
        "for models of whole strands: ask the network only for the rectangle of roots that holds all "
        "wet strands; the others stay where it starts from");
    options
        .option(
            "--locks", o.locks,
            "for models of whole strands, on the CPU: draw their strands into locks by so many passes of Eq "
            "10 on a grid, which is faster than neighbours; about as many as the scene has after models of "
            "strands before Eq 10, half as many after those of displayed ones")
        .within(1, 1000);
    options
        .option(
            "--within", o.within,
            "for models of whole strands: simulate those strands themselves that the model expects to be off "
            "by more than so many millimetres, mean over the frames, as the run's scene or --wetness says")
        .within(0.0, 1e6);
    options.flag("--wet-shape", o.wet_shape,
                 "for --interpolate rest: the strand at rest as its water curls it (Eq 9), not as drawn");
    options.flag("--cohesion", o.cohesion,
                 "for --interpolate and models of displayed strands: then draw wet strands together (Eq 10)");
    options
        .option("--passes", o.passes,
                "of Eq 10, in place of the scene's, of which models of displayed strands take 8 of each 14")
        .within(1, 1000);
    within_cohesion(
        options.option("--spacing", o.spacing,
                       "about how far apart along a strand Eq 10 is asked for [m], in place of the "
                       "scene's; 0: at each particle"),
        "spacing");
    within_cohesion(
        options.option(
            "--relaxation", o.relaxation,
            "about how many passes of Eq 10 an over-relaxed sweep stands for, in place of the scene's"),
        "relaxation");
    options
        .option("--stride", o.stride,
                "for a scene: simulate every so many roots each way of its grid; default 2")
        .within(2, 1000);
    options.option("--guides", o.guides, "for a scene: simulate so many strands, chosen where hair differs")
        .within(1, 100000000);
    options.flag(
        "--any-roots", o.any_roots,
        "take a run whose strands are none of those to predict: guides of a file of their own, of the "
        "scene that --wetness names");
    options
        .option("--strands", o.strands,
                "at most this many strands are predicted, the largest grid that nests in the scene's, in "
                "place of all")
        .within(1, 100000000);
    options
        .option("--frames", o.frames,
                "the first frames of the run alone, so many; of a scene, in place of its own")
        .within(1, 1000000);
    options.option("--wetness", o.wetness, "scene whose wetness and cohesion to predict for").input_file();
    options.option("-o,--output", o.output, "run cache (HDF5)").required();
    options.flag("--resume", o.resume,
                 "go on from OUTPUT.partial, which a run that was stopped or killed left");
}

int infer_command(const InferOptions& o) {
    check_options(o);
    if (o.within && (o.resume || o.crop || o.cohesion || o.locks || o.settled))
        throw Misuse(fmt::format("--within: found with --{}, allowed without: {}",
                                 o.resume     ? "resume"
                                 : o.crop     ? "crop"
                                 : o.cohesion ? "cohesion"
                                 : o.locks    ? "locks"
                                              : "settled",
                                 o.resume ? "it looks at all frames first"
                                          : "expected errors are of what the network alone predicts"));
    if (o.locks && o.cohesion)
        throw Misuse("--locks: found with --cohesion, allowed is one of the two: both are Eq 10");
    if (o.locks && o.device != "cpu")
        throw Misuse("--locks: found with --device " + o.device + ", allowed is the CPU");
    require_device(o.device);
    check_files(o, o.output, {o.input, o.model, o.wetness, o.oracle_colours, o.oracle_weights});
    return is_scene(o.input) ? infer_scene(o) : infer_run(o);
}

}  // namespace wetcurl

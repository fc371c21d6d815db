// The program: reads the command line (the only place that includes CLI11), runs one command, turns errors
// into a message and an exit status: 0 done, 1 failed, 2 misuse, 130 interrupted.
#include <omp.h>

#include <algorithm>
#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>

#include "app/commands/commands.h"
#include "base/error.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "base/progress.h"
#include "base/provenance.h"
#include "base/shift_units.h"
#include "solver/terms/cohesion.h"

using namespace wetcurl;

namespace {

struct Shared {
    bool quiet = false;
    std::string log_level = "info";
    int threads = 0;
};

// What a scene may name for that key of its [cohesion].
CLI::Range cohesion_range(const std::string& key) {
    for (const auto& row : Cohesion::parameters)
        if (row.key == key) return {row.minimum, row.maximum};
    throw Error("[cohesion] has no " + key);
}

// Options that every command takes.
void add_common(CLI::App* command, CommonOptions& o, Shared& shared) {
    command->add_option("--set", o.set, "key.path=value over the scene's or recipe's (repeatable)")
        ->type_name("KEY=VALUE")
        ->expected(1)
        ->take_all();
    command->add_option("--device", o.device, "cpu | cuda[:n]")->capture_default_str();
    command->add_option("--threads", shared.threads, "threads; 0: all")->check(CLI::Range(0, 4096));
    command->add_option("--seed", o.seed, "seed in place of the file's");
    command->add_flag("--overwrite", o.overwrite, "replace an output that is there");
    command->add_flag("--quiet", shared.quiet, "no progress, warnings only");
    command->add_option("--log-level", shared.log_level, "debug | info | warning | error | off")
        ->check(CLI::IsMember({"debug", "info", "warning", "error", "off"}));
}

void apply(const Shared& shared, CommonOptions& o) {
    const std::vector<std::string> names{"debug", "info", "warning", "error", "off"};
    const auto level = std::find(names.begin(), names.end(), shared.log_level) - names.begin();
    set_log_level(shared.quiet && level < 2 ? LogLevel::warning : LogLevel(level));
    Progress::set_quiet(shared.quiet);
    o.threads = shared.threads > 0 ? shared.threads : omp_get_num_procs();
    omp_set_num_threads(o.threads);
    const bool cuda = o.device.rfind("cuda", 0) == 0;
    if (o.device != "cpu" && !cuda)
        throw Misuse("--device: found '" + o.device + "', allowed: cpu, cuda, cuda:n");
}

// The program, its build and the features that it was built with.
std::string version_text() {
    std::string text = "wetcurl";
    for (const auto& [name, fact] : provenance()) {
        if (name == "version") text += " " + fact;
        if (name == "version" || name == "gpu" || name == "date") continue;
        text += "\n" + name + ": " + fact;
    }
    text += "\nfeatures:";
#ifdef WETCURL_HAVE_NETWORKS
    text += " networks";
#endif
#ifdef WETCURL_HAVE_CUDA
    text += " CUDA";
#endif
#ifdef WETCURL_HAVE_OPENCV
    text += " pictures";
#endif
    return text;
}

// `status`, or 1 where not all of standard output has arrived.
int flushed(int status) {
    if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return status;
    std::fprintf(stderr, "wetcurl: standard output: cannot be written (disk full, or a closed pipe)\n");
    return 1;
}

}  // namespace

int main(int argc, char** argv) {
    end_when_interrupted();
    std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is a failed write, and said
    CLI::App app{
        "wetcurl simulates wet curly hair, trains networks on what it simulates, and runs them in its "
        "place."};
    app.require_subcommand(1);
    app.set_version_flag("--version", version_text);
    Shared shared;
    std::function<int()> run;
    auto command = [&](const char* name, const char* help, auto& options, auto* function) {
        CLI::App* sub = app.add_subcommand(name, help);
        add_common(sub, options, shared);
        // A picture is no number.
        using Options = std::decay_t<decltype(options)>;
        if constexpr (!std::is_same_v<Options, RenderOptions> && !std::is_same_v<Options, PlotOptions>)
            sub->add_option("--json", options.json,
                            "write the results as JSON to this file, - for standard output");
        sub->callback(
            [&options, &run, function] { run = [&options, function] { return function(options); }; });
        return sub;
    };

    SimulateOptions simulate;
    auto* c = command("simulate", "run the physics of a scene into a run cache", simulate, simulate_command);
    c->add_option(
         "scene", simulate.scene,
         "scene file (TOML), or a run (HDF5): the scene it was made from, whole and wet unless other options "
         "say so")
        ->required();
    c->add_option("-o,--output", simulate.output, "run cache (HDF5)")->required();
    c->add_option("--frames", simulate.frames, "frames in place of the scene's")
        ->check(CLI::Range(1, 1000000));
    c->add_option("--strands", simulate.strands,
                  "at most this many strands: the largest grid that nests in the scene's")
        ->check(CLI::Range(1, 100000000));
    c->add_option("--groom", simulate.groom, "hair file in place of the scene's groom");
    c->add_option("--precision", simulate.precision, "float | double")
        ->check(CLI::IsMember({"float", "double"}))
        ->capture_default_str();
    c->add_flag("--dry", simulate.dry, "leave out all that acts on wet hair; the wetness is recorded");
    c->add_flag("--before-cohesion", simulate.before_cohesion,
                "leave out Eq 10, which moves what is displayed alone: a low-resolution run to infer from");
    c->add_flag("--reference", simulate.reference,
                "run in double with 160 substeps beside it and report the distance");

    EncodeOptions encode;
    c = command("encode", "make training pairs of dry low-resolution and wet high-resolution runs", encode,
                encode_command);
    c->add_option("runs", encode.inputs, "DRY.h5 WET.h5, repeatable; for adhesion: scenes to run")
        ->required();
    c->add_option("-o,--output", encode.output, "pairs file (HDF5)")->required();
    c->add_option("--codec", encode.codec, "root | strand | adhesion")
        ->check(CLI::IsMember({"root", "strand", "adhesion"}))
        ->capture_default_str();
    const std::string colour_units_help =
        "how the shift of wet roots, which are the colours (Eq 16), is read: length (default), times the "
        "square of "
        "the support radius, or printed, SI numbers without it";
    c->add_option("--colour-units", encode.colour_units, "for the root codec: " + colour_units_help)
        ->check(CLI::IsMember(shift_units_names));

    DatasetOptions dataset;
    c = command("dataset", "simulate many scenes, dry and wet, into training pairs", dataset,
                dataset_command);
    c->add_option("recipe", dataset.recipe, "recipe (TOML): the scenes, picked and drawn")->required();
    c->add_option("-o,--output", dataset.output, "folder")->required();
    c->add_option("--part", dataset.part,
                  "K/N: every N-th scene alone, to share the work; mpirun and srun say it themselves");
    c->add_flag("--resume", dataset.resume, "make what is not there yet");

    TrainOptions train;
    c = command("train", "train a network on pairs", train, train_command);
    c->add_option("kind", train.kind, "sr | adhesion")->required()->check(CLI::IsMember({"sr", "adhesion"}));
    c->add_option("pairs", train.pairs, "pairs files")->required();
    c->add_option("-o,--output", train.output, "model (HDF5)")->required();
    c->add_option("--validation", train.validation,
                  "pairs files to hold out, in place of the last frames of each run");
    c->add_option("--recipe", train.recipe, "recipe file (TOML)");
    c->add_option(
        "--arch", train.architecture,
        "strand_mlp | strand_depthwise | strand_linear | strand_unet_vgg19 | strand_recursive_residual | "
        "unet_vgg19 | recursive_residual | adhesion_mlp");
    c->add_option("--width", train.width, "multiplier of the network's width");
    c->add_option("--from", train.from,
                  "model (HDF5) whose weights are begun with, of its architecture and width, in place of "
                  "random ones");
    c->add_flag("--resume", train.resume, "go on from OUTPUT.checkpoint");
    c->footer(
        "Several processes that mpirun, srun or torchrun starts (or RANK and WORLD_SIZE name) share each "
        "batch; "
        "--device cuda: a GPU for each. They meet at MASTER_ADDR (127.0.0.1), MASTER_PORT (29400), and wait "
        "WETCURL_RENDEZVOUS_SECONDS (300) there. --threads counts for each.");

    InferOptions infer;
    c = command("infer",
                "predict wet high-resolution hair from a low-resolution run, dry or as the model learned",
                infer, infer_command);
    c->add_option("input", infer.input,
                  "LOW.h5, or a scene whose low-resolution run is made first, dry or as the model learned")
        ->required();
    c->add_option("--model", infer.model, "trained model (HDF5), in place of the scene's [learned] model");
    c->add_option("--interpolate", infer.interpolate, "without a network: nearest | quad | core | rest")
        ->check(CLI::IsMember({"nearest", "quad", "core", "rest"}));
    c->add_option(
        "--oracle-colours", infer.oracle_colours,
        "in place of a network of the root codec: the colours of this wet run (Eq 16), which a network "
        "without error predicts");
    c->add_option(
        "--oracle-weights", infer.oracle_weights,
        "in place of any colours: the weights in Eq 18 that bring each strand nearest to this wet run, a "
        "bound for all networks of the root codec");
    c->add_option("--reconstruct", infer.reconstruct,
                  "for a model of the root codec and for oracles: paper | core (default)")
        ->check(CLI::IsMember({"paper", "core"}));
    c->add_option(
         "--gain", infer.gain,
         "kappa of Eq 18, for a model of the root codec and --oracle-colours, in place of the model's; "
         "default 1")
        ->check(CLI::Range(0.0, largest_gain));
    c->add_option(
         "--units", infer.units,
         "how the shift of Eq 18 is read: length (default), times the support radius to the fifth power, "
         "or printed, SI numbers without it")
        ->check(CLI::IsMember(shift_units_names));
    c->add_option("--colour-units", infer.colour_units, "for --oracle-colours: " + colour_units_help)
        ->check(CLI::IsMember(shift_units_names));
    c->add_option(
         "--roots", infer.roots,
         "that a new strand is made from, for quad, core and models of the root codec: the grid's 4 or "
         "the nearest 3")
        ->check(CLI::IsMember({3, 4}))
        ->capture_default_str();
    c->add_flag(
        "--settled", infer.settled,
        "for models of wet runs and --interpolate rest: from a dry run, moved to where wet strands come "
        "to rest, which is simulated first");
    c->add_flag("--crop", infer.crop,
                "for models of whole strands: ask the network only for the rectangle of roots that holds all "
                "wet strands; the others stay where it starts from");
    c->add_flag("--wet-shape", infer.wet_shape,
                "for --interpolate rest: the strand at rest as its water curls it (Eq 9), not as drawn");
    c->add_flag("--cohesion", infer.cohesion,
                "for --interpolate and models of displayed strands: then draw wet strands together (Eq 10)");
    c->add_option("--passes", infer.passes,
                  "of Eq 10, in place of the scene's, of which models of displayed strands take 8 of each 14")
        ->check(CLI::Range(1, 1000));
    c->add_option(
         "--spacing", infer.spacing,
         "about how far apart along a strand Eq 10 is asked for [m], in place of the scene's; 0: at each "
         "particle")
        ->check(cohesion_range("spacing"));
    c->add_option("--relaxation", infer.relaxation,
                  "about how many passes of Eq 10 an over-relaxed sweep stands for, in place of the scene's")
        ->check(cohesion_range("relaxation"));
    c->add_option("--frames", infer.frames,
                  "the first frames of the run alone, so many; of a scene, in place of its own")
        ->check(CLI::Range(1, 1000000));
    c->add_option("--wetness", infer.wetness, "scene whose wetness and cohesion to predict for");
    c->add_option("-o,--output", infer.output, "run cache (HDF5)")->required();

    CompareOptions compare;
    c = command("compare", "error and run time of runs against a reference", compare, compare_command);
    c->add_option("reference", compare.reference, "REFERENCE.h5")->required();
    c->add_option("others", compare.others, "OTHER.h5")->required();
    c->footer(compare_columns());
    c->add_option("--first-frame", compare.first_frame, "leave out the frames before this one")
        ->check(CLI::NonNegativeNumber);

    ReportOptions report;
    c = command("report", "learned beside simulated hair: one HTML file to open", report, report_command);
    c->add_option("runs", report.runs, "REFERENCE.h5 OTHER.h5...");
    c->add_option(
        "--table", report.table,
        "comparisons over many scenes: FOLDER/ROW/SCENE.json, of compare --json; ROW@1, ROW@2: seeds of "
        "one training");
    c->add_option("--stability", report.stability, "what stability --json wrote");
    c->add_option("--training", report.trainings, "log of a training, MODEL.h5.jsonl (repeatable)")
        ->expected(1)
        ->take_all();
    c->add_option("--first-frame", report.first_frame, "leave out the frames before this one")
        ->check(CLI::NonNegativeNumber);
    c->add_option("-o,--output", report.output, "report.html");

    RenderOptions render;
    c = command("render", "draw runs, or geometry images, side by side, without a window", render,
                render_command);
    c->add_option("runs", render.runs,
                  "RUN.h5; with --image: runs, PAIRS.h5 with any models of its codec, or models")
        ->required();
    c->add_option("-o,--output", render.output, "out.png, out.mp4 or out.webm")->required();
    c->add_option("--frame", render.frame, "one frame (default: all for a video, the last for a picture)")
        ->check(CLI::NonNegativeNumber);
    CLI::Option* of_strands[] = {
        c->add_option("--width", render.width, "of one panel, 16 to 8192 [pixels]")->capture_default_str(),
        c->add_option("--height", render.height, "of one panel, 16 to 8192 [pixels]")->capture_default_str(),
        c->add_option("--yaw", render.yaw, "of the camera around the head, -360 to 360 [degrees]")
            ->capture_default_str(),
        c->add_flag("--saturation", render.saturation, "colour by saturation (red wet, blue dry)"),
        c->add_flag_callback(
            "--no-labels", [&] { render.labels = false; }, "no text under the panels")};
    CLI::Option* image = c->add_flag(
        "--image", render.image,
        "geometry images, a strand a square: of a run its roots (Eq 14, wet ones after Eq 16); of pairs "
        "input, target and residual; with models their predictions too; of a model its first layer");
    for (CLI::Option* option : of_strands) image->excludes(option);
    c->add_option("--run", render.run, "with --image: which of the runs in PAIRS.h5")
        ->check(CLI::NonNegativeNumber)
        ->needs(image)
        ->capture_default_str();
    c->add_option("--pixels", render.pixels, "with --image: least side of a panel, 16 to 8192")
        ->needs(image)
        ->capture_default_str();
    c->footer(
        "Geometry images: codec root shows its colours; codec strand the offset of the tip from the root in "
        "the strand's root frame (red x, green y along the scalp's normal, blue z; grey: none). Pixels "
        "without a strand are hatched.");

    PlotOptions plot;
    c = command(
        "plot",
        "draw the energy of runs or the time of their frames, the loss of trainings, an adhesion network, "
        "or charts, side by side",
        plot, plot_command);
    c->add_option(
         "runs", plot.runs,
         "RUN.h5; logs of trainings: MODEL.h5.jsonl, each on its own logarithmic axis; PAIRS.h5 of codec "
         "adhesion; or charts: CHART.json {\"title\", \"x_label\", \"y_label\", \"dx\", \"curves\": "
         "[{\"name\", "
         "\"values\"}]}")
        ->required();
    c->add_flag("--time", plot.time,
                "of runs: the time of each frame by stage, in place of energy (as in Fig. 40)");
    c->add_option("--model", plot.model,
                  "adhesion network to draw on PAIRS.h5: its answers against the targets, over phi/h beside "
                  "Eq 11, and what each input is worth");
    c->add_option("-o,--output", plot.output, "out.png")->required();
    c->add_option("--width", plot.width, "of one panel, 240 to 8192 [pixels]")->capture_default_str();
    c->add_option("--height", plot.height, "of one panel, 240 to 8192 [pixels]")->capture_default_str();

    ImportOptions import;
    c = command("import", "read a hair file, report on it, write it in another format", import,
                import_command);
    c->add_option("input", import.input, ".hair .data .bin .ply .tfx")->required();
    c->add_option("output", import.output, ".hair or .data; none: report only");
    c->add_option("--units", import.units, "of the file")
        ->check(CLI::IsMember({"m", "cm", "mm", "auto"}))
        ->capture_default_str();
    c->add_option("--up", import.up, "axis")->check(CLI::IsMember({"y", "z"}))->capture_default_str();
    c->add_option("--resample", import.resample, "particles a strand; 0: as it is")
        ->check(CLI::Range(0, 100000));
    c->add_option("--scalp", import.scalp,
                  "head mesh in the units of the hair: depth of roots, and the grid laid on it");

    InspectOptions inspect;
    c = command("inspect", "say what a file holds, or what a scene names and leaves out", inspect,
                inspect_command);
    c->add_option("what", inspect.what, "scene | run | pairs | model | terms | device")
        ->required()
        ->check(CLI::IsMember({"scene", "run", "pairs", "model", "terms", "device"}));
    c->add_option("file", inspect.file, "the file");
    c->add_option("-o,--output", inspect.output)->group("");  // once images of pairs: said in the error
    c->footer("`wetcurl render --image PAIRS.h5 -o out.png` draws the geometry images of pairs.");

    StabilityCommandOptions stability;
    c = command("stability", "put ways of stepping through the battery of stability, S1 to S9", stability,
                stability_command);
    c->add_option("scene", stability.scene,
                  "scene (TOML) whose head comes to rest, for S9 in place of the battery's own");
    c->add_option("--method", stability.methods, "by name (repeatable); none: all")->expected(1)->take_all();
    c->add_option("--case", stability.only, "S1 to S9 (repeatable); none: all")
        ->expected(1)
        ->take_all()
        ->check(CLI::IsMember({"S1", "S2", "S3", "S4", "S5", "S6", "S7", "S8", "S9"}));
    c->add_flag("--quick", stability.quick, "fewer values of each parameter: under a minute");

    BenchOptions bench;
    c = command("bench", "measure the parts of the program on this machine", bench, bench_command);
    c->add_option("--filter", bench.filter, "only entries whose name holds this text");
    c->add_option("--model", bench.models, "time learned frames of this model too (repeatable)")
        ->expected(1)
        ->take_all();

    try {
        std::vector<std::string> known;
        for (const CLI::App* sub : app.get_subcommands({})) known.push_back(sub->get_name());
        const std::string name = argc > 1 ? argv[1] : "-";
        if (name[0] != '-' && std::find(known.begin(), known.end(), name) == known.end())
            throw Misuse("found command '" + name + "', allowed: " + CLI::detail::join(known, ", ") +
                         did_you_mean(name, known));
        app.parse(argc, argv);
        for (CommonOptions* o : std::initializer_list<CommonOptions*>{
                 &simulate, &encode, &dataset, &train, &infer, &compare, &report, &render, &plot, &import,
                 &inspect, &stability, &bench})
            apply(shared, *o);
        return flushed(run());
    } catch (const CLI::ParseError& e) {
        const int status = app.exit(e);
        return status == 0 ? flushed(0) : 2;
    } catch (const Interrupted& e) {
        std::fprintf(stderr, "wetcurl: %s\n", e.what());
        return 130;
    } catch (const Misuse& e) {
        std::fprintf(stderr, "wetcurl: %s\n", e.what());
        return 2;
    } catch (const std::bad_alloc&) {
        std::fprintf(stderr, "wetcurl: out of memory\n");
        return 1;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "wetcurl: %s\n", e.what());
        return 1;
    }
}

// `wetcurl infer`: wet high-resolution hair from a dry low-resolution run, by a network or by interpolation.
#include "app/commands/infer.h"

#include <fmt/format.h>
#include <omp.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/commands/missing_model.h"
#include "app/commands/simulate.h"
#include "app/engine/device.h"
#include "app/engine/learned_hair.h"
#include "app/engine/run_of_scene.h"
#include "app/files/results.h"
#include "base/config.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "base/progress.h"
#include "base/shift_units.h"
#include "learn/codec/encode_runs.h"
#include "learn/codec/interpolate.h"
#include "learn/codec/network_module.h"
#include "learn/codec/quad_transform.h"
#include "learn/codec/root_codec.h"
#include "learn/codec/strand_codec.h"
#include "solver/chain/chain_state.h"
#include "solver/scene/rest_state.h"

namespace wetcurl {

namespace {

// One way from low-resolution frames to high-resolution strands.
class Method {
  public:
    virtual ~Method() = default;
    virtual std::string name() const = 0;
    // Whether p is the strand before cohesion, so that Eq 10 follows.
    virtual bool before_cohesion() const { return false; }
    virtual void apply(const RunFrame& low, const HeadWindow& heads, Strands& p) = 0;
    // What `apply` would have given without the network (empty: there is none), for saying what it moved.
    virtual Strands without_network(const RunFrame&) { return {}; }
};

Stencil stencil_of(int roots, const Groom& high, const Groom& low) {
    return roots == 3 ? triangle_stencil(high, low) : quad_stencil(high, low);
}
std::string suffix_of(int roots) { return roots == 3 ? ", 3 roots" : ""; }

class InterpolationMethod final : public Method {
  public:
    // `shape`: how the high strands lie at rest, null: as drawn; `settled`: as of RestCarrier; `cohesion`: Eq
    // 10 follows.
    InterpolationMethod(const std::string& name, int roots, const Groom& high, const Groom& low,
                        const Strands* shape, bool low_is_wet, const Settled* settled, bool cohesion)
        : name_(name + " interpolation" + suffix_of(roots) + (settled ? ", settled" : "") +
                (shape ? ", Eq 9" : "") + (cohesion ? ", Eq 10" : "")),
          interpolator_(interpolation_named(name), stencil_of(roots, high, low), high, low, shape, low_is_wet,
                        settled),
          cohesion_(cohesion) {}
    std::string name() const override { return name_; }
    bool before_cohesion() const override { return cohesion_; }
    void apply(const RunFrame& low, const HeadWindow&, Strands& p) override {
        interpolator_.apply(cohesion_ ? low.positions : low.seen(), low.head, p);
    }

  private:
    std::string name_;
    Interpolator interpolator_;
    bool cohesion_;
};

class StrandMethod final : public Method {
  public:
    StrandMethod(std::unique_ptr<LearnedStrands> learned, const InferOptions& o, int strands, int particles)
        : learned_(std::move(learned)),
          cohesion_(o.cohesion || learned_->card().target != "displayed"),
          name_(learned_->card().architecture + " " + std::filesystem::path(o.model).stem().string() +
                (o.settled ? ", settled" : "") + (o.crop ? ", cropped" : "") + (cohesion_ ? ", Eq 10" : "")),
          out_(strands, particles) {
        if (cohesion_) learned_->lead_edges(most_length_rounds);
    }
    std::string name() const override { return name_; }
    bool before_cohesion() const override { return cohesion_; }
    void apply(const RunFrame& low, const HeadWindow& heads, Strands& p) override {
        if (low_.points.empty()) {
            low_ = low.positions;
            learned_->bind(low_.points.data(), out_.points.data());
        }
        std::copy(low.positions.points.begin(), low.positions.points.end(), low_.points.begin());
        learned_->run(heads);
        p = out_;
    }
    Strands without_network(const RunFrame& low) override { return learned_->base(low.head); }

  private:
    std::unique_ptr<LearnedStrands> learned_;
    bool cohesion_;  // Eq 10 follows
    std::string name_;
    Strands low_, out_;
};

// Of Eq 18.
struct QuadSettings {
    Reconstruction form;
    int roots;
    double gain;
    ShiftUnits units;
    float radius;  // h [m]
};

// By the quad transform.
class QuadMethod : public Method {
  public:
    std::string name() const override { return name_; }
    Strands without_network(const RunFrame& low) override {
        Strands plain;
        transform_.interpolate(low.seen(), low.head, plain);
        return plain;
    }

  protected:
    // `kind`: of the colours.
    QuadMethod(const std::string& kind, const QuadSettings& q, const Groom& high, const RunHeader& low)
        : transform_(q.form, stencil_of(q.roots, high, low.groom), high, low.groom, low.saturation, q.radius,
                     float(q.gain), q.units),
          name_(kind + (q.form == Reconstruction::paper ? ", paper" : ", core and detail") +
                suffix_of(q.roots)) {}
    void name_gain(const QuadSettings& q) {
        name_ += fmt::format(", gain {:g}", q.gain);
        if (q.units == ShiftUnits::printed) name_ += ", Eq 18 as printed";
    }
    QuadTransform transform_;
    std::string name_;
};

// Colours of the wet run itself, as training pairs hold them.
class OracleColours final : public QuadMethod {
  public:
    OracleColours(const RunPair& pair, ShiftUnits colour_units, const QuadSettings& q, const Groom& high)
        : QuadMethod("oracle colours", q, high, pair.dry->header()) {
        name_gain(q);
        if (colour_units == ShiftUnits::printed) name_ += ", Eq 16 as printed";
        ColourBox box;
        colours_ = roots_of(pair, q.radius, colour_units, box).wet;
        for (auto& frame : colours_)
            for (Vec3f& c : frame) c = colour_of(c, box);
    }
    void apply(const RunFrame& low, const HeadWindow&, Strands& p) override {
        transform_.apply(low.seen(), low.head, colours_.at(next_++), p);
    }

  private:
    std::vector<std::vector<Vec3f>> colours_;  // (frame, high strand)
    size_t next_ = 0;
};

// The weights of Eq 18 that bring strands nearest to the wet run's.
class OracleWeights final : public QuadMethod {
  public:
    OracleWeights(RunPair pair, const QuadSettings& q, const Groom& high)
        : QuadMethod("oracle weights", q, high, pair.dry->header()), truth_(std::move(pair.wet)) {}
    void apply(const RunFrame& low, const HeadWindow&, Strands& p) override {
        transform_.apply_nearest(low.seen(), low.head, truth_->frame(next_++).seen(), p);
    }

  private:
    std::unique_ptr<RunReader> truth_;
    int next_ = 0;
};

class RootMethod final : public QuadMethod {
  public:
    RootMethod(std::unique_ptr<Network> network, const std::string& file, const QuadSettings& q,
               const Groom& high, const RunHeader& low)
        : QuadMethod(network->card().architecture, q, high, low),
          network_(std::move(network)),
          high_image_(high.grid, 2),
          low_image_(low.groom.grid),
          radius_(q.radius),
          input_(3 * low_image_.pixels()),
          output_(3 * high_image_.pixels()) {
        name_gain(q);
        const auto& a = network_->card().arrays;
        auto corner = [&](const char* name) {
            const auto at = a.find(name);
            if (at == a.end() || at->second.size() != 3)
                throw Error(file + ": array '" + name + "' is missing, needed are the 3 numbers of Eq 14");
            return Vec3d{at->second[0], at->second[1], at->second[2]};
        };
        box_ = {corner("b_min"), corner("b_max")};
    }
    void apply(const RunFrame& low, const HeadWindow&, Strands& p) override {
        std::vector<Vec3f> colours = shifted_roots(low.positions, {}, radius_);
        for (auto& c : colours) c = colour_of(c, box_);
        low_image_.draw(colours, input_.data());
        network_->run(input_.data(), {1, 3, low_image_.height(), low_image_.width()}, output_.data());
        transform_.apply(low.seen(), low.head, high_image_.read(output_.data()), p);
    }

  private:
    std::unique_ptr<Network> network_;
    RootImage high_image_, low_image_;
    float radius_;
    ColourBox box_;
    std::vector<float> input_, output_;
};

// The saturation that a model was trained on, for runs that say nothing of theirs: the mean profile along the
// strand.
std::vector<float> profile_of(const ModelCard& card, const Groom& groom) {
    const auto mean = card.arrays.find("input_mean");
    if (mean == card.arrays.end() || mean->second.size() < size_t(static_layout.saturation.end()))
        throw Error("neither the run nor --wetness nor the model says how wet the hair is");
    const int n = groom.rest.particles;
    std::vector<float> sigma;
    for (int s = 0; s < groom.rest.count; ++s)
        for (int i = 0; i < n; ++i)
            sigma.push_back(mean->second[size_t(static_layout.saturation.first +
                                                std::min(i * saturation_pieces / n, saturation_pieces - 1))]);
    return sigma;
}

// The scene at the resolution to predict, as wet as it should be.
Scene target_scene(const InferOptions& o, const RunHeader& low) {
    if (low.stride < 2)
        throw Error(o.input +
                    ": the run already holds every strand of its groom; a low-resolution one is needed "
                    "(simulate --strands)");
    SceneOptions options;
    options.stride = low.stride / 2;
    if (o.wetness.empty()) return parse_scene(low.scene, o.input, low.scene_folder, options);
    options.set = o.set;
    options.seed = o.seed;
    return load_scene(o.wetness, options);
}

bool is_scene(const std::string& path) { return path.ends_with(".toml"); }

const std::string& scene_name(const InferOptions& o) { return o.wetness.empty() ? o.input : o.wetness; }

// What strands can be moved to where wet ones come to rest for.
void require_settling(const InferOptions& o, const ModelCard& card) {
    if (o.settled && (card.codec != "strand" || card.low != "wet"))
        throw Misuse("--settled is for models of the strand codec that learned from wet runs; " + o.model +
                     " learned from " + card.low + " ones, on codec " + card.codec);
}

// Whether the wet run's own strands take a network's place.
bool is_oracle(const InferOptions& o) { return !o.oracle_colours.empty() || !o.oracle_weights.empty(); }

// Of Eq 18, from the command line, the model's recipe where it has one, and the defaults.
QuadSettings quad_settings(const InferOptions& o, const Scene& scene, const RunHeader& low,
                           const std::string& recipe) {
    if (low.saturation.empty())
        throw Error(o.input + ": the run records no wetness ([wetness] in its scene); Eq 18 needs it");
    const Table t = Config::parse(recipe, o.model + ": its recipe").root().table("reconstruct");
    const std::string units = o.units.empty() ? t.choice("units", "length", shift_units_names) : o.units;
    return {reconstruction_named(o.reconstruct.empty() ? "core" : o.reconstruct), o.roots,
            o.gain ? *o.gain : t.number("gain", 1, 0, largest_gain), shift_units_named(units),
            float(scene.cohesion ? scene.cohesion->h_c : 0.012)};
}

std::unique_ptr<Method> oracle_of(const InferOptions& o, const Scene& scene, const RunHeader& low) {
    const QuadSettings q = quad_settings(o, scene, low, "");
    RunPair pair(o.input, o.oracle_colours + o.oracle_weights);
    if (!o.oracle_weights.empty()) return std::make_unique<OracleWeights>(std::move(pair), q, scene.groom);
    return std::make_unique<OracleColours>(
        pair, o.colour_units.empty() ? ShiftUnits::length : shift_units_named(o.colour_units), q,
        scene.groom);
}

std::unique_ptr<Method> method_of(const InferOptions& o, Scene& scene, const RunHeader& low) {
    if (is_oracle(o)) return oracle_of(o, scene, low);
    if (o.settled && simulated_wet(low))
        throw Misuse("--settled: " + o.input + " was simulated wet, allowed is a dry run");
    if (o.interpolate.empty()) require_settling(o, network_module().card(o.model));
    Settled settled;
    if (o.settled) settled = settled_of(scene, scene_name(o), substeps_of(low), o.device);
    if (!o.interpolate.empty()) {
        const Strands shape = o.wet_shape ? shape_at_rest(scene) : Strands();
        return std::make_unique<InterpolationMethod>(o.interpolate, o.roots, scene.groom, low.groom,
                                                     o.wet_shape ? &shape : nullptr, simulated_wet(low),
                                                     o.settled ? &settled : nullptr, o.cohesion);
    }
    const ModelCard card = network_module().card(o.model);
    if (card.codec == "adhesion")
        throw Misuse(o.model + ": an adhesion model; it acts in a scene, not on a run: infer SCENE.toml");
    if (const bool wet = simulated_wet(low) || o.settled; wet != (card.low == "wet"))
        log_warning(fmt::format("{}: was simulated {}; {} learned from {} runs", o.input, wet ? "wet" : "dry",
                                o.model, card.low));
    const int found = substeps_of(low);
    if (card.low_substeps && found != card.low_substeps)
        log_warning(
            fmt::format("{}: was simulated with {} substeps a frame; {} learned from runs of {}, and "
                        "errs more on others (simulate --set integrator.substeps={})",
                        o.input, found, o.model, card.low_substeps, card.low_substeps));
    if (card.codec == "strand") {
        if (!o.reconstruct.empty())
            throw Misuse("--reconstruct is for models of the root codec; this one predicts whole strands");
        if (o.gain || !o.units.empty())
            throw Misuse(
                "--gain and --units are for models of the root codec; this one predicts whole strands");
        if (o.roots == 3)
            throw Misuse("--roots 3 is for models of the root codec; this one predicts whole strands");
        if (card.particles != scene.groom.rest.particles)
            log_warning(fmt::format("{}: learned from strands of {} particles, the run has {}", o.model,
                                    card.particles, scene.groom.rest.particles));
        if (scene.saturation.empty()) scene.saturation = profile_of(card, scene.groom);
        if (o.cohesion && card.target == "displayed")
            scene.cohesion->passes = passes_after_displayed(scene.cohesion->passes);
        auto learned = learned_strands_of(o.model, scene, scene_name(o), low.groom, o.device, o.threads,
                                          o.settled ? &settled : nullptr);
        if (o.crop) learned->crop(wet_strands_of(scene));
        return std::make_unique<StrandMethod>(std::move(learned), o, scene.groom.rest.count,
                                              scene.groom.rest.particles);
    }
    if (o.crop) throw Misuse("--crop is for models of the strand codec; this one predicts images");
    if (o.cohesion) throw Misuse("--cohesion is for --interpolate and models of the strand codec");
    const QuadSettings q = quad_settings(o, scene, low, card.recipe);
    return std::make_unique<RootMethod>(network_module().load(o.model, o.device, o.threads), o.model, q,
                                        scene.groom, low);
}

// What the scene's [learned] names, where the command line names nothing. `scene` is that of the
// low-resolution run where `o.input` is a scene, else the one to predict for.
void take_learned(InferOptions& o, const Scene& scene) {
    if (!o.model.empty() || !o.interpolate.empty() || is_oracle(o)) return;
    if (!scene.learned)
        throw Misuse(
            "infer needs --model MODEL.h5, --interpolate nearest|quad|core|rest, or a scene with [learned] "
            "model");
    o.model = scene.learned->model;
    if (o.reconstruct.empty()) o.reconstruct = scene.learned->reconstruct;
    if (!o.gain) o.gain = scene.learned->gain;
    if (o.units.empty()) o.units = scene.learned->units;
    const std::string where = (is_scene(o.input) ? o.input : scene_name(o)) + ": [learned] model";
    // A way of reconstruction is for models of images alone.
    if (is_scene(o.input) && scene.term<Adhesion>() && o.reconstruct.empty())
        return require_model_of_adhesion(o.model, where, o.input, o);
    RunsToLearnFrom runs;
    runs.scene = scene_name(o), runs.codec = o.reconstruct.empty() ? "strand" : "root";
    if (is_scene(o.input))
        runs.low_scene = o.input, runs.low_strands = scene.groom.rest.count;
    else
        runs.low = o.input, runs.strands = scene.stride > 1 ? scene.groom.rest.count : 0;
    require_model_of_strands(o.model, where, runs, o);
}

// What Eq 9 and 10 are asked of.
void require_named(const InferOptions& o, const Scene& scene) {
    if (o.cohesion && !scene.cohesion)
        throw Misuse("--cohesion: the scene to predict for has no [cohesion]; --wetness names one that has");
    if (o.wet_shape && !scene.curl)
        throw Misuse("--wet-shape: the scene to predict for has no [curl]; --wetness names one that has");
}

SimulateOptions simulation_of(const InferOptions& o) {
    SimulateOptions s;
    static_cast<CommonOptions&>(s) = o;
    s.scene = o.input;
    s.output = o.output;
    s.frames = o.frames;
    return s;
}

// The low-resolution run of the scene, which then is the input; substeps 0: its own.
void simulate_low(InferOptions& o, const Scene& low, bool wet, int substeps) {
    SimulateOptions run = simulation_of(o);
    run.json.clear();
    // What --set says goes before.
    if (substeps) run.set.insert(run.set.begin(), fmt::format("integrator.substeps={}", substeps));
    // A program built without the solver's CUDA backend may still have a network there.
    if (run.device != "cpu" && names_of_cuda_devices().empty()) run.device = "cpu";
    run.output = o.output + (wet ? ".wet.h5" : ".dry.h5");
    run.dry = !wet;
    run.before_cohesion = wet && low.cohesion && low.cohesion->strength == 0;
    run.strands = low.groom.rest.count;
    simulate_command(run);
    o.input = run.output;
}

// The scene with the network in Eq 11's place.
int simulate_with(const InferOptions& o, const Scene& scene) {
    if (!scene.term<Adhesion>())
        throw Misuse(o.model + ": stands in Eq 11's place, and " + o.input + " has no [adhesion]");
    if (!o.wetness.empty() || !o.reconstruct.empty() || o.gain || !o.units.empty() || o.roots == 3 || o.crop)
        throw Misuse(o.model +
                     ": an adhesion model takes neither --wetness, --reconstruct, --gain, --units, --roots "
                     "nor --crop");
    SimulateOptions wet = simulation_of(o);
    wet.set.push_back("adhesion.model='" + std::filesystem::absolute(o.model).string() + "'");
    return simulate_command(wet);
}

// Refuses two ways at once, and what the one asked for does not read.
void require_one_way(const InferOptions& o) {
    if (!o.model.empty() + !o.interpolate.empty() + !o.oracle_colours.empty() + !o.oracle_weights.empty() > 1)
        throw Misuse(
            "infer needs one of --model MODEL.h5, --interpolate nearest|quad|core|rest, "
            "--oracle-colours WET.h5 and --oracle-weights WET.h5");
    if (!o.interpolate.empty() && !o.reconstruct.empty())
        throw Misuse("--reconstruct is for models; --interpolate says itself how strands are made");
    if ((!o.interpolate.empty() || !o.oracle_weights.empty()) && (o.gain || !o.units.empty()))
        throw Misuse(
            "--gain and --units are for models of the root codec and --oracle-colours, which have weights to "
            "scale");
    if (o.oracle_colours.empty() && !o.colour_units.empty())
        throw Misuse("--colour-units is for --oracle-colours; a model has the colours that it learned");
    if (!is_oracle(o)) return;
    refuse_device(o, "infer with an oracle");
    if (!o.wetness.empty() || o.settled || o.crop || o.cohesion)
        throw Misuse(
            "an oracle takes neither --wetness, --settled, --crop nor --cohesion: it is of the root codec, "
            "and its run says how wet it is");
}

// What a scene may name for that key of its [cohesion].
CLI::Range cohesion_range(const std::string& key) {
    for (const auto& row : Cohesion::parameters)
        if (row.key == key) return {row.minimum, row.maximum};
    throw Error("[cohesion] has no " + key);
}

}  // namespace

void add_options(CLI::App& app, InferOptions& o) {
    app.add_option("input", o.input,
                   "LOW.h5, or a scene whose low-resolution run is made first, dry or as the model learned")
        ->required();
    app.add_option("--model", o.model, "trained model (HDF5), in place of the scene's [learned] model");
    app.add_option("--interpolate", o.interpolate, "without a network: nearest | quad | core | rest")
        ->check(CLI::IsMember({"nearest", "quad", "core", "rest"}));
    app.add_option(
        "--oracle-colours", o.oracle_colours,
        "in place of a network of the root codec: the colours of this wet run (Eq 16), which a network "
        "without error predicts");
    app.add_option(
        "--oracle-weights", o.oracle_weights,
        "in place of any colours: the weights in Eq 18 that bring each strand nearest to this wet run, a "
        "bound for all networks of the root codec");
    app.add_option("--reconstruct", o.reconstruct,
                   "for a model of the root codec and for oracles: paper | core (default)")
        ->check(CLI::IsMember({"paper", "core"}));
    app.add_option(
           "--gain", o.gain,
           "kappa of Eq 18, for a model of the root codec and --oracle-colours, in place of the model's; "
           "default 1")
        ->check(CLI::Range(0.0, largest_gain));
    app.add_option(
           "--units", o.units,
           "how the shift of Eq 18 is read: length (default), times the support radius to the fifth power, "
           "or printed, SI numbers without it")
        ->check(CLI::IsMember(shift_units_names));
    app.add_option("--colour-units", o.colour_units,
                   std::string("for --oracle-colours: ") + colour_units_help)
        ->check(CLI::IsMember(shift_units_names));
    app.add_option(
           "--roots", o.roots,
           "that a new strand is made from, for quad, core and models of the root codec: the grid's 4 or "
           "the nearest 3")
        ->check(CLI::IsMember({3, 4}))
        ->capture_default_str();
    app.add_flag(
        "--settled", o.settled,
        "for models of wet runs and --interpolate rest: from a dry run, moved to where wet strands come "
        "to rest, which is simulated first");
    app.add_flag(
        "--crop", o.crop,
        "for models of whole strands: ask the network only for the rectangle of roots that holds all "
        "wet strands; the others stay where it starts from");
    app.add_flag("--wet-shape", o.wet_shape,
                 "for --interpolate rest: the strand at rest as its water curls it (Eq 9), not as drawn");
    app.add_flag("--cohesion", o.cohesion,
                 "for --interpolate and models of displayed strands: then draw wet strands together (Eq 10)");
    app.add_option(
           "--passes", o.passes,
           "of Eq 10, in place of the scene's, of which models of displayed strands take 8 of each 14")
        ->check(CLI::Range(1, 1000));
    app.add_option(
           "--spacing", o.spacing,
           "about how far apart along a strand Eq 10 is asked for [m], in place of the scene's; 0: at each "
           "particle")
        ->check(cohesion_range("spacing"));
    app.add_option("--relaxation", o.relaxation,
                   "about how many passes of Eq 10 an over-relaxed sweep stands for, in place of the scene's")
        ->check(cohesion_range("relaxation"));
    app.add_option("--frames", o.frames,
                   "the first frames of the run alone, so many; of a scene, in place of its own")
        ->check(CLI::Range(1, 1000000));
    app.add_option("--wetness", o.wetness, "scene whose wetness and cohesion to predict for");
    app.add_option("-o,--output", o.output, "run cache (HDF5)")->required();
}

int infer_command(const InferOptions& given) {
    InferOptions o = given;
    // A range of the command line lets what is no number pass.
    for (const auto& number : {o.spacing, o.relaxation, o.gain})
        if (number && std::isnan(*number))
            throw Misuse("--spacing, --relaxation and --gain: found nan, a number is needed");
    require_one_way(o);
    if (!o.interpolate.empty() && !o.cohesion && !o.settled)
        refuse_device(o, "interpolation without --cohesion and --settled");
    require_device(o.device);
    if (o.crop && !o.interpolate.empty()) throw Misuse("--crop is for models; --interpolate asks no network");
    if (o.wet_shape && o.interpolate != "rest")
        throw Misuse("--wet-shape is for --interpolate rest, which alone starts from a shape at rest");
    if (o.settled && !o.interpolate.empty() && o.interpolate != "rest")
        throw Misuse("--settled is for --interpolate rest and models that learned from wet runs");
    if (o.interpolate == "nearest" && o.roots == 3)
        throw Misuse("--roots 3 is for quad and core; nearest copies the strand of one root");
    check_files(o, o.output, {o.input, o.model, o.wetness, o.oracle_colours, o.oracle_weights});
    if (is_scene(o.input)) {
        const Scene low = load_scene(
            o.input,
            {.set = o.set, .frames = o.frames, .strands = {}, .seed = o.seed, .groom = "", .stride = 2});
        if (o.wetness.empty()) require_named(o, low);
        take_learned(o, low);
        bool wet = false;
        int substeps = 0;
        if (!o.model.empty()) {
            const ModelCard card = network_module().card(o.model);
            if (card.codec == "adhesion") return simulate_with(o, low);
            require_solids_for(card, low, o.input);
            require_settling(o, card);
            wet = card.low == "wet" && !o.settled, substeps = card.low_substeps;
        }
        simulate_low(o, low, wet, substeps);
    } else if (o.wetness.empty()) {
        refuse_scene_options(o, "infer from a run without --wetness");
    }
    const RunReader run(o.input);
    const RunHeader& low = run.header();
    if (o.frames && *o.frames > run.frames())
        throw Misuse(fmt::format("--frames: found {}, allowed 1 to {}, which {} has", *o.frames, run.frames(),
                                 o.input));
    const int frames = o.frames.value_or(run.frames());
    Scene scene = target_scene(o, low);
    take_learned(o, scene);
    check_files(o, o.output, scene.files);
    if (scene.flow)
        throw Error(o.input +
                    ": its scene moves the water ([wetness.flow]), allowed is wetness that stays; "
                    "--wetness names a scene of it");
    require_named(o, scene);
    try {
        require_nested(scene.groom, low.groom);
    } catch (const Error& e) {
        throw Error(o.input + ", " + (o.wetness.empty() ? "its scene" : o.wetness) + ": " + e.what());
    }
    const double begun = omp_get_wtime();
    const auto method = method_of(o, scene, low);
    std::optional<DisplayOn> display;
    if ((o.passes || o.spacing || o.relaxation) && !(method->before_cohesion() && scene.cohesion))
        throw Misuse(std::string(o.passes    ? "--passes"
                                 : o.spacing ? "--spacing"
                                             : "--relaxation") +
                     ": no Eq 10 follows here, whose this could be; --cohesion adds it");
    if (o.passes) scene.cohesion->passes = *o.passes;
    if (o.spacing) scene.cohesion->spacing = *o.spacing;
    if (o.relaxation) scene.cohesion->relaxation = *o.relaxation;
    if (method->before_cohesion() && scene.cohesion) display.emplace(o.device, scene);

    RunHeader header = low;
    header.method = method->name();
    if (low.device != o.device) header.device = low.device + ", then " + o.device;
    header.groom = scene.groom;
    header.stride = scene.stride;
    header.scene = scene.text;
    header.scene_folder = scene.folder;
    header.saturation = scene.saturation;
    header.energy_kinds.clear();
    header.stages = {"low-resolution run", "reconstruction", "cohesion"};
    header.inputs = {o.input};
    for (const auto& input : {o.model, o.oracle_colours, o.oracle_weights})
        if (!input.empty()) header.inputs.push_back(input);
    const double preparation = omp_get_wtime() - begun;
    InterruptGuard guard;
    ResultFile results(o);
    RunWriter writer(o.output, header, o.overwrite);

    Progress progress("infer", frames, "frame");
    FrameWindow window(run);
    RunFrame out;
    std::vector<double> seconds, own_seconds;
    double moved = 0;
    int done = 0;
    while (done < frames && !guard.asked() && window.advance()) {
        const RunFrame& frame = window.now();
        const double begin = omp_get_wtime();
        method->apply(frame, window.heads(), out.positions);
        if (!is_finite(out.positions.points))
            throw Error(fmt::format(
                "{}: frame {}: {} gives positions that are not finite or beyond 1e6 m; is the run, "
                "or the model, damaged, or the gain of Eq 18 too large?",
                o.input, done, method->name()));
        const double reconstructed = omp_get_wtime();
        if (display) {
            out.displayed = out.positions;
            display->apply(out.displayed, frame.head, done / low.fps);
        }
        const double end = omp_get_wtime();
        if (const Strands plain = method->without_network(frame); plain.count) {
            double sum = 0;
            for (size_t k = 0; k < plain.points.size(); ++k)
                sum += norm(plain.points[k] - out.positions.points[k]);
            moved += 1000 * sum / double(plain.points.size());
        }
        out.head = frame.head;
        out.seconds = frame.seconds + end - begin;
        out.stage_seconds = {float(frame.seconds), float(reconstructed - begin), float(end - reconstructed)};
        writer.append(out);
        // Frame 0 is a state that nothing was computed for, and warms up.
        if (done > 0) seconds.push_back(out.seconds), own_seconds.push_back(end - begin);
        progress.update(++done);
    }
    if (done < frames)
        throw Interrupted(fmt::format("interrupted: {} frames are kept in {}", done, partial_of(o.output)));
    writer.commit();
    Json json{{"frames", done},
              {"strands", scene.groom.rest.count},
              {"particles_per_strand", scene.groom.rest.particles},
              {"preparation_seconds", preparation},
              {"seconds_per_frame", time_statistics(seconds)},
              {"inference_seconds_per_frame", time_statistics(own_seconds)},
              {"device", o.device},
              {"method", method->name()},
              {"cohesion_after", display.has_value()}};
    if (!o.model.empty() || is_oracle(o))
        json[is_oracle(o) ? "moved_by_oracle_mm" : "moved_by_network_mm"] = moved / std::max(1, done);
    results.write_json(json);
    log_info(fmt::format("{}: {}, {} strands, {} a frame of which inference {}{}", o.output, method->name(),
                         scene.groom.rest.count, milliseconds_text(json["seconds_per_frame"]["median"]),
                         milliseconds_text(json["inference_seconds_per_frame"]["median"]),
                         o.model.empty() && !is_oracle(o)
                             ? ""
                             : fmt::format("; the {} moves a particle by {:.2f} mm on average",
                                           is_oracle(o) ? "oracle" : "network", moved / std::max(1, done))));
    return 0;
}

}  // namespace wetcurl

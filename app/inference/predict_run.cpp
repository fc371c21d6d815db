// A whole low-resolution run to predicted strands.
#include "app/inference/predict_run.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/engine/broken_run.h"
#include "app/engine/device.h"
#include "app/engine/learned_hair.h"
#include "app/engine/run_of_scene.h"
#include "app/files/watch_results.h"
#include "app/inference/simulated_strands.h"
#include "base/log.h"
#include "learn/codec/encode_runs.h"
#include "learn/codec/input_ranges.h"
#include "learn/codec/stencil.h"
#include "learn/codec/strand_codec.h"
#include "solver/chain/chain_state.h"

namespace wetcurl {

namespace {

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

// Warns where a model learned from other low-resolution runs than this one.
void compare_with_training(const Method& method, const LowRun& low) {
    const ModelCard& card = *method.card();
    const std::string model = method.inputs().at(0);
    const bool wet = simulated_wet(low.header());
    if ((wet || method.is_settled()) != (card.low == "wet"))
        log_warning(fmt::format("{}: was simulated {}; {} learned from {} runs", low.file(),
                                wet ? "wet" : "dry", model, card.low));
    const int found = substeps_of(low.header());
    if (found < card.low_substeps)
        log_warning(
            fmt::format("{}: was simulated with {} substeps a frame; {} learned from runs of {} or more, and "
                        "errs more on others (simulate --set integrator.substeps={})",
                        low.file(), found, model, card.low_substeps, card.low_substeps));
}

Json json_of(const InputsOutside& outside) {
    Json kinds = Json::array();
    for (const auto& kind : outside.kinds())
        kinds.push_back({{"input", kind.name}, {"share", kind.share}, {"most", kind.most}});
    return {{"share", outside.share()}, {"inputs", kinds}};
}

// Of strands and frames outside of what a model learned from; it is looked for in every fourth frame.
constexpr double share_worth_a_warning = 0.01;
constexpr int looks_apart = 4;

// Names the four kinds of input that most strands are outside by.
std::string warning_of(const InputsOutside& outside, const std::string& output, const std::string& model) {
    std::string named;
    const auto kinds = outside.kinds();
    for (size_t k = 0; k < std::min<size_t>(4, kinds.size()); ++k)
        named += fmt::format("{}{} (in {:.2g} %, by up to {:.2g} of its range)", k ? ", " : "", kinds[k].name,
                             100 * kinds[k].share, kinds[k].most);
    return fmt::format(
        "{}: {:.2g} % of strands, over the frames, lie outside of what {} learned from: {}; expect larger "
        "errors there (inspect model says the ranges; train --from adapts it to hair like this)",
        output, 100 * outside.share(), model, named);
}

// What the method changes in the scene: water that only the model knows, and Eq 10. Returns whether that
// follows.
bool set_up(const Method& method, Scene& scene) {
    if (const auto* network = method.as<StrandNetworkMethod>()) {
        if (scene.saturation.empty()) scene.saturation = profile_of(network->card, scene.groom);
        if (method.clumps && network->is_displayed() && scene.cohesion)
            scene.cohesion->passes = passes_after_displayed(scene.cohesion->passes);
    }
    const ClumpingAfter& given = method.clumping;
    if (!method.clumps || !scene.cohesion) {
        if (!given.given().empty())
            throw Misuse(
                given.given() +
                ": no Eq 10 by neighbours follows here that it could change; it does without --locks, "
                "and with --cohesion");
        return false;
    }
    if (given.passes) scene.cohesion->passes = *given.passes;
    if (given.spacing) scene.cohesion->spacing = *given.spacing;
    if (given.relaxation) scene.cohesion->relaxation = *given.relaxation;
    return true;
}

std::unique_ptr<Predictor> predictor_of(const Method& method, const PredictionInput& input) {
    return std::visit(
        [&]<class Kind>(const Kind& kind) -> std::unique_ptr<Predictor> {
            if constexpr (std::is_same_v<Kind, AdhesionNetworkMethod>)
                throw Misuse(kind.model +
                             ": an adhesion model; it acts in a scene, not on a run: infer SCENE.toml");
            else
                return predictor_of(kind, input);
        },
        method.prediction);
}

RunHeader header_of(const Predictor& predictor, const Method& method, const Scene& scene, const LowRun& low,
                    const std::string& device) {
    RunHeader header = low.header();
    header.method = predictor.name();
    if (header.device != device) header.device += ", then " + device;
    header.groom = scene.groom;
    auto& followed = header.followed.emplace();
    for (const int s : twins_of(scene.groom, low.header().groom))
        if (s >= 0) followed.push_back(s);
    std::sort(followed.begin(), followed.end());
    header.stride = scene.stride, header.guides = scene.guides;
    header.scene = scene.text;
    header.scene_folder = scene.folder;
    header.saturation = scene.saturation;
    header.energy_kinds.clear();
    header.stages = {"low-resolution run", "reconstruction", "cohesion"};
    header.inputs = {low.origin()};
    for (const auto& input : method.inputs()) header.inputs.push_back(input);
    return header;
}

// Mean distance of particles [mm].
double moved_mm(const Strands& from, const Strands& to) {
    double sum = 0;
    for (size_t k = 0; k < from.points.size(); ++k) sum += norm(from.points[k] - to.points[k]);
    return 1000 * sum / double(from.points.size());
}

// Predicts frame after frame, each with its run times.
class FramePredictor {
  public:
    // `outside`: null where no strand network is asked. `display`: null where no Eq 10 follows. `simulated`:
    // null where all strands are predicted; `alone`: Eq 10 for these where it does not follow.
    FramePredictor(Predictor& predictor, InputsOutside* outside, DisplayOn* display, const LowRun& low,
                   SimulatedStrands* simulated, DisplayOn* alone)
        : predictor_(predictor),
          outside_(outside),
          display_(display),
          low_(low),
          simulated_(simulated),
          alone_(alone) {}

    const RunFrame& predict(int index, const RunFrame& low, const HeadWindow& heads) {
        const double begin = omp_get_wtime();
        predictor_.apply(index, low, heads, out_.positions);
        if (!is_finite(out_.positions.points))
            throw Error(fmt::format(
                "{}: frame {}: {} gives positions that are not finite or beyond 1e6 m; is the run, "
                "or the model, damaged, or the gain of Eq 18 too large?",
                low_.file(), index, predictor_.name()));
        const double applied = omp_get_wtime();
        const Strands plain = predictor_.without_network(low);
        if (plain.count) moved_ += moved_mm(plain, out_.positions);
        if (outside_ && index % looks_apart == 0) outside_->add(predictor_.inputs());
        const double asked = omp_get_wtime();
        out_.expected_error = predictor_.expected_error();
        if (simulated_) put_simulated(low, index);
        const double reconstructed = omp_get_wtime();
        if (display_) {
            out_.displayed = out_.positions;
            display_->apply(out_.displayed, low.head, low_.header().time(index));
        }
        const double end = omp_get_wtime(), own = end - begin - (asked - applied);
        ++frames_;
        out_.head = low.head;
        out_.seconds = low.seconds + own;
        out_.stage_seconds = {float(low.seconds), float(own - (end - reconstructed)),
                              float(end - reconstructed)};
        // Frame 0 is a state that nothing was computed for, and warms up.
        if (index > 0) seconds_.push_back(out_.seconds), own_seconds_.push_back(own);
        return out_;
    }
    // Those that are simulated take the place of predicted ones.
    void put_simulated(const RunFrame& low, int index) {
        simulated_->put(low.head, out_.positions);
        const size_t pieces = out_.expected_error.size() / size_t(out_.positions.count);
        for (const int s : simulated_->strands())
            std::fill_n(&out_.expected_error[size_t(s) * pieces], pieces, 0.f);
        if (!alone_) return;
        Strands together = out_.positions;
        alone_->apply(together, low.head, low_.header().time(index));
        for (const int s : simulated_->strands())
            std::copy_n(together.strand(s), together.particles, out_.positions.strand(s));
    }
    // Moves on to the last of `frames` frames that are there already, of which it sees only those that the
    // prediction of the next one needs.
    void go_on(FrameWindow& window, int frames, const InterruptGuard& guard) {
        while (window.index() + 1 < frames && !guard.asked() && window.advance())
            if (window.index() + predictor_.memory() >= frames)
                predictor_.apply(window.index(), window.now(), window.heads(), out_.positions);
    }
    // Run times [s]: of the low-resolution run and the prediction together, and of the prediction alone.
    const std::vector<double>& seconds() const { return seconds_; }
    const std::vector<double>& own_seconds() const { return own_seconds_; }
    // By which the network moves a particle in the mean [mm].
    double moved() const { return moved_ / std::max(1, frames_); }

  private:
    Predictor& predictor_;
    InputsOutside* outside_;
    DisplayOn* display_;
    const LowRun& low_;
    SimulatedStrands* simulated_;
    DisplayOn* alone_;
    RunFrame out_;
    std::vector<double> seconds_, own_seconds_;
    double moved_ = 0;
    int frames_ = 0;
};

}  // namespace

void predict_run(const Method& method, Scene scene, const std::string& scene_file, LowRun& low,
                 const PredictionRequest& request, ResultFile& results) {
    const double begun = omp_get_wtime();
    std::optional<OutputFile> place;
    std::optional<BrokenRun> whole, broken;
    if (request.resume) whole = whole_run_at(request.output, request.overwrite);
    if (request.resume && !whole) {
        place.emplace(request.output, request.overwrite);
        broken = broken_run_at(*place);
    }
    std::optional<Settled> settled;
    if (method.is_settled()) {
        if (simulated_wet(low.header()))
            throw Misuse("--settled: " + low.file() + " was simulated wet, allowed is a dry run");
        settled =
            settled_of(scene, scene_file, low.header().groom, substeps_of(low.header()), request.device);
    }
    if (method.card()) compare_with_training(method, low);
    std::optional<Scene> wet;  // as it is simulated
    if (request.again) wet = scene;
    if (method.as<StrandNetworkMethod>() && scene.fps != low.header().fps)
        throw Error(fmt::format("{}: found {:g} frames a second, allowed {:g}, as {} has it", low.file(),
                                low.header().fps, scene.fps, scene_file));
    const bool clumps = set_up(method, scene);
    const auto predictor =
        predictor_of(method, {scene, scene_file, low.header(), low.file(), clumps, request.device,
                              request.threads, settled ? &*settled : nullptr});
    std::optional<DisplayOn> display;
    if (clumps) display.emplace(request.device, scene);
    InterruptGuard guard;
    std::optional<SimulatedStrands> simulated;
    std::optional<DisplayOn> alone;
    if (request.again) {
        if (low.header().start != 0 || wet->saturation.empty())
            throw Misuse(
                low.header().start != 0
                    ? "--within: found a run that begins within another one, allowed is one from rest"
                    : "--within: found a scene that does not say how wet its hair is");
        const auto probe =
            predictor_of(method, {scene, scene_file, low.header(), low.file(), clumps, request.device,
                                  request.threads, settled ? &*settled : nullptr});
        auto strands = not_trusted(*probe, *request.again, request.frames, request.within, guard);
        if (!strands.empty()) {
            simulated.emplace(*wet, scene_file, std::move(strands), request);
            if (!clumps && wet->cohesion) alone.emplace(request.device, *wet);
        }
    }
    const double preparation = omp_get_wtime() - begun;

    RunHeader header = header_of(*predictor, method, scene, low, request.device);
    if (request.again) header.method += fmt::format(", within {:g} mm", 1e3 * request.within);
    if (whole) return require_whole(*whole, header, request.frames);
    if (broken) log_info(fmt::format("{}: going on at frame {}", request.output, broken->frames));
    if (broken) require_same(*broken, header);
    if (!place) place.emplace(request.output, request.overwrite);
    RunWriter writer =
        broken ? RunWriter(std::move(*place), header, broken->frames) : RunWriter(std::move(*place), header);
    std::optional<InputsOutside> outside;
    if (const auto* network = method.as<StrandNetworkMethod>()) outside.emplace(network->card);
    // Of strands that a crop leaves out nothing is asked.
    if (outside && (!outside->known() || method.as<StrandNetworkMethod>()->crop)) outside.reset();
    FramePredictor frame_predictor(*predictor, outside ? &*outside : nullptr, display ? &*display : nullptr,
                                   low, simulated ? &*simulated : nullptr, alone ? &*alone : nullptr);
    FrameWindow window(low.source(), low.header());
    FrameWatch watch(scene.groom, header.fps);
    if (broken) look_at(*broken, watch);
    FrameDelivery frames({.what = "infer",
                          .frames = request.frames,
                          .earlier = broken ? broken->seconds : std::vector<double>()},
                         guard);
    const auto kept = [&] {
        return fmt::format("{} frames are kept in {}", frames.delivered(), partial_of(request.output));
    };
    try {
        if (broken) frame_predictor.go_on(window, broken->frames, guard);
        frames.run(window, [&](int index, const RunFrame& frame) {
            const RunFrame& predicted = frame_predictor.predict(index, frame, window.heads());
            watch.look(index, predicted);
            if (const FrameExtreme& longest = *watch.stretch();
                longest.value > scene.integrator.allow_stretch)
                throw Error(
                    fmt::format("{}: diverged at frame {}, strand {}, particle {}: found an edge of {:.4g} "
                                "times its rest "
                                "length, allowed are {:g}; '{}' does not fit this hair "
                                "(--set integrator.allow_stretch=N allows more); {}",
                                request.output, longest.frame, longest.strand, longest.particle,
                                longest.value, scene.integrator.allow_stretch, predictor->name(), kept()));
            writer.append(predicted);
        });
    } catch (const Diverged& e) {
        throw Error(fmt::format("{}: its low-resolution run: {}; {}", low.file(), e.what(), kept()));
    }
    if (!frames.is_whole()) throw Interrupted("interrupted: " + kept() + "; --resume goes on");
    writer.commit();

    Json json{{"frames", frames.delivered()},
              {"strands", scene.groom.rest.count},
              {"particles_per_strand", scene.groom.rest.particles},
              {"preparation_seconds", preparation},
              {"seconds_per_frame", time_statistics(frame_predictor.seconds())},
              {"inference_seconds_per_frame", time_statistics(frame_predictor.own_seconds())},
              {"device", request.device},
              {"method", predictor->name()},
              {"cohesion_after", clumps},
              {"extremes", json_of(watch)}};
    if (broken) json["resumed_at"] = broken->frames;
    if (outside) json["outside_of_training"] = json_of(*outside);
    if (request.again) {
        const size_t count = simulated ? simulated->strands().size() : 0;
        json["within_mm"] = 1e3 * request.within, json["simulated_strands"] = count;
        log_info(
            fmt::format("{}: {} of {} strands are expected to be off by more than {:g} mm and were simulated",
                        request.output, count, scene.groom.rest.count, 1e3 * request.within));
    }
    const std::string mover = method.as<InterpolationMethod>() ? ""
                              : method.as<OracleMethod>()      ? "oracle"
                                                               : "network";
    if (!mover.empty()) json["moved_by_" + mover + "_mm"] = frame_predictor.moved();
    results.write_json(json);
    if (outside && outside->share() >= share_worth_a_warning)
        log_warning(warning_of(*outside, request.output, method.inputs().at(0)));
    if (const std::string warning = warning_of(watch); !warning.empty())
        log_warning(request.output + ": " + warning);
    log_info(fmt::format("{}: {}, {} strands, {} a frame of which inference {}{}", request.output,
                         predictor->name(), scene.groom.rest.count,
                         milliseconds_text(json["seconds_per_frame"]["median"]),
                         milliseconds_text(json["inference_seconds_per_frame"]["median"]),
                         mover.empty() ? ""
                                       : fmt::format("; the {} moves a particle by {:.2f} mm on average",
                                                     mover, frame_predictor.moved())));
}

}  // namespace wetcurl

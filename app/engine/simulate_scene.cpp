// A scene's whole simulation into a run file.
#include "app/engine/simulate_scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <omp.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "app/engine/broken_run.h"
#include "app/engine/reference.h"
#include "app/engine/scene_run.h"
#include "app/engine/state_file.h"
#include "app/files/watch_results.h"
#include "base/log.h"
#include "solver/chain/scene_checks.h"

namespace wetcurl {

namespace {

Json json_of(const WaterBalance& water) {
    return {{"held_kg", water.held},
            {"taken_kg", water.taken},
            {"dripped_kg", water.dripped},
            {"dried_kg", water.dried},
            {"balance_kg", water.balance()}};
}

// Of distances from the reference [mm], (frame).
Json json_of_errors(const std::vector<double>& errors) {
    return {{"mean", std::accumulate(errors.begin(), errors.end(), 0.0) / double(errors.size())},
            {"last", errors.back()},
            {"max", *std::max_element(errors.begin(), errors.end())}};
}

// output_seconds: for writing a frame.
Json json_of(SceneRun& run, const FrameDelivery& frames, double output_seconds,
             const SimulationRequest& request) {
    const Scene& scene = run.scene();
    const Simulation& simulation = run.simulation();
    const Presence presence = presence_of(scene);
    const Strands& strands = scene.groom.rest;
    size_t bytes = 0;
    for (const auto& b : simulation.buffers()) bytes += b.bytes;
    return {{"frames", frames.delivered()},
            {"strands", strands.count},
            {"particles_per_strand", strands.particles},
            {"seconds_per_frame", time_statistics(frames.seconds())},
            {"output_seconds_per_frame", output_seconds},
            {"device", request.device},
            {"threads", request.threads},
            {"precision", run.precision()},
            {"terms_present", presence.present},
            {"terms_absent", presence.absent},
            {"substeps", scene.integrator.substeps},
            {"neighbours_mean", simulation.neighbours_mean()},
            {"limited_edges", simulation.limited_edges()},
            {"peak_bytes", bytes},
            {"bytes_per_particle", double(bytes) / (double(strands.count) * strands.particles)}};
}

void log_summary(const Scene& scene, const std::string& output, const Json& json) {
    log_info(
        fmt::format("{}: {} strands x {} particles, {} frames, median {} a frame, {:.0f} bytes a "
                    "particle; present: {}",
                    output, scene.groom.rest.count, scene.groom.rest.particles, scene.frames,
                    milliseconds_text(json["seconds_per_frame"]["median"]),
                    json["bytes_per_particle"].get<double>(), fmt::join(presence_of(scene).present, ", ")));
}

void log_water(const WaterBalance& water) {
    log_info(
        fmt::format("water: {:.3g} kg held, of {:.3g} at the start and {:.3g} taken; {:.3g} dripped, "
                    "{:.3g} dried; balance {:.1e} kg",
                    water.held, water.start, water.taken, water.dripped, water.dried, water.balance()));
}

// The frames of a simulation, whose states are kept beside them.
class KeptFrames final : public FrameSource {
  public:
    KeptFrames(SimulatedFrames& frames, const Simulation& simulation, StateKeeper& keeper)
        : frames_(frames), simulation_(simulation), keeper_(keeper) {}
    bool advance() override { return frames_.advance(); }
    void begin(RunFrame& frame) override {
        frames_.begin(frame);
        keeper_.offer(frames_.index(), simulation_);
    }
    void finish(RunFrame& frame) override { frames_.finish(frame); }

  private:
    SimulatedFrames& frames_;
    const Simulation& simulation_;
    StateKeeper& keeper_;
};

// Whether a state of one of the broken run's frames was kept. One of a later frame lies there where the run's
// file was cut.
bool has_state(const BrokenRun& broken, const std::string& output) {
    const auto frame = frame_of_state(state_file_of(output));
    return frame && *frame < broken.frames;
}

// The frame that the simulation shows once it has the state that was kept of a broken run; -1: there is none,
// it begins anew.
int resumed(SceneRun& run, const BrokenRun& broken, const RunHeader& header, const std::string& output) {
    require_same(broken, header);
    const std::string file = state_file_of(output);
    if (!has_state(broken, output)) {
        log_info(fmt::format("{}: going on at frame {}; without a state in {} all frames are computed again",
                             output, broken.frames, file));
        return -1;
    }
    const StoredState stored = read_state(file, run.simulation().run_state(), true);
    const StateFacts facts = facts_of(header, run.precision());
    const auto require = [&](const char* what, const std::string& found, const std::string& wanted) {
        if (found != wanted)
            throw Error(
                fmt::format("{}: --resume: the state is of {} {}, now it is {}", file, what, found, wanted));
    };
    require("precision", stored.facts.precision, facts.precision);
    require("device", stored.facts.device, facts.device);
    require("a run with hash", stored.facts.run, facts.run);
    run.simulation().resume(stored.state);
    log_info(fmt::format("{}: going on at frame {}, from the state of frame {}", output, broken.frames,
                         stored.frame));
    return stored.frame;
}

}  // namespace

void simulate_scene(Scene given, const SimulationRequest& request, ResultFile& results) {
    if (request.reference && (request.resume || request.from))
        throw Misuse(std::string("--reference: found with ") + (request.resume ? "--resume" : "--from") +
                     ", allowed in a run that begins at rest");
    std::optional<BrokenRun> whole, broken;
    if (request.resume) whole = whole_run_at(request.output, request.overwrite);
    std::optional<OutputFile> place;
    std::optional<RemovedWhenInterrupted> still_empty;
    {
        const InterruptGuard until_it_is_known_what_to_remove;
        if (!whole) place.emplace(request.output, request.overwrite);
        if (request.resume && place) broken = broken_run_at(*place);
        if (place && !broken) still_empty.emplace(place->partial());
    }
    if (InterruptGuard::asked()) throw Interrupted("interrupted");
    const std::optional<RunStart>& start = request.from;
    if (start) take_wetness(given, *start);
    std::optional<Reference> reference;
    if (request.reference) reference.emplace(given);
    const bool from_state = broken && has_state(*broken, request.output);
    SceneRun run(std::move(given), request.device, request.precision, request.threads,
                 !whole && !from_state && !start);
    const Scene& scene = run.scene();
    RunHeader header = run.header();
    if (start) header.start = start->time(), header.inputs = {start->words()};
    if (whole) return require_whole(*whole, header, scene.frames);
    InterruptGuard guard;
    still_empty.reset();
    if (start && !from_state) go_to(run, *start);
    const int at = broken ? resumed(run, *broken, header, request.output) : -1;
    StateKeeper keeper(request.output, facts_of(header, run.precision()), broken.has_value());
    SimulatedFrames simulated(run.simulation(), scene.frames, at, header.start);
    if (broken) look_at(*broken, simulated.watch());
    RunWriter writer =
        broken ? RunWriter(std::move(*place), header, broken->frames) : RunWriter(std::move(*place), header);
    std::vector<double> errors;
    double reference_seconds = 0;
    // Frames that are there already are computed again, and not written again.
    while (broken && simulated.index() + 1 < broken->frames && !guard.asked()) simulated.advance(false);
    FrameDelivery frames({.what = "simulate",
                          .frames = scene.frames,
                          .overlap = request.device != "cpu" && !reference,
                          .earlier = broken ? broken->seconds : std::vector<double>()},
                         guard);
    KeptFrames source(simulated, run.simulation(), keeper);
    std::optional<Diverged> diverged;
    try {
        frames.run(source, [&](int, const RunFrame& frame) {
            writer.append(frame);
            keeper.write();
            if (!reference) return;
            const double begin = omp_get_wtime();
            errors.push_back(distance_mm(frame.seen(), reference->next().seen()));
            reference_seconds += omp_get_wtime() - begin;
        });
    } catch (const Diverged& e) {
        diverged = e;
    }
    if (frames.is_whole()) writer.commit();
    if (frames.is_whole() && !request.keep_state)
        keeper.remove();
    else if (!diverged && simulated.index() >= 0)
        keeper.leave(simulated.index(), run.simulation());

    const int written = frames.delivered() - (broken ? broken->frames : 0);
    Json json =
        json_of(run, frames, (frames.sink_seconds() - reference_seconds) / std::max(1, written), request);
    json["diverged"] = diverged.has_value();
    if (broken) json["resumed_at"] = broken->frames;
    json["extremes"] = json_of(simulated.watch());
    const auto water = run.simulation().water();
    if (water) json["water"] = json_of(*water);
    if (!errors.empty()) json["error_mm"] = json_of_errors(errors);
    results.write_json(json);
    const std::string kept =
        fmt::format("{} frames are kept in {}", frames.delivered(), partial_of(request.output));
    if (diverged)
        throw Error(fmt::format("{}{}; {}", diverged->what(),
                                run.precision() == "float" ? ", or --precision double" : "", kept));
    if (const std::string warning = warning_of(simulated.watch()); !warning.empty())
        log_warning(request.output + ": " + warning);
    if (!frames.is_whole()) throw Interrupted("interrupted: " + kept + "; --resume goes on");
    log_summary(scene, request.output, json);
    if (water) log_water(*water);
}

}  // namespace wetcurl

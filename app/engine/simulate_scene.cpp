// A scene's whole simulation into a run file.
#include "app/engine/simulate_scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <omp.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "app/engine/reference.h"
#include "app/engine/scene_run.h"
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

// output_seconds: for writing, all frames together.
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
            {"output_seconds_per_frame", output_seconds / std::max(1, frames.delivered())},
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

}  // namespace

void simulate_scene(Scene given, const SimulationRequest& request, ResultFile& results) {
    std::optional<Reference> reference;
    if (request.reference) reference.emplace(given);
    SceneRun run(std::move(given), request.device, request.precision, request.threads);
    const Scene& scene = run.scene();
    InterruptGuard guard;
    RunWriter writer(request.output, run.header(), request.overwrite);
    std::vector<double> errors;
    double reference_seconds = 0;
    FrameDelivery frames({"simulate", scene.frames, request.device != "cpu" && !reference}, guard);
    SimulatedFrames source(run.simulation(), scene.frames);
    std::optional<Diverged> diverged;
    try {
        frames.run(source, [&](int, const RunFrame& frame) {
            writer.append(frame);
            if (!reference) return;
            const double begin = omp_get_wtime();
            errors.push_back(distance_mm(frame.seen(), reference->next().seen()));
            reference_seconds += omp_get_wtime() - begin;
        });
    } catch (const Diverged& e) {
        diverged = e;
    }
    if (frames.is_whole()) writer.commit();

    Json json = json_of(run, frames, frames.sink_seconds() - reference_seconds, request);
    json["diverged"] = diverged.has_value();
    const auto water = run.simulation().water();
    if (water) json["water"] = json_of(*water);
    if (!errors.empty()) json["error_mm"] = json_of_errors(errors);
    results.write_json(json);
    const std::string kept =
        fmt::format("{} frames are kept in {}", frames.delivered(), partial_of(request.output));
    if (diverged) throw Error(fmt::format("{}; {}", diverged->what(), kept));
    if (!frames.is_whole()) throw Interrupted("interrupted: " + kept);
    log_summary(scene, request.output, json);
    if (water) log_water(*water);
}

}  // namespace wetcurl

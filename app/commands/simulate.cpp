// `wetcurl simulate`: the physics of a scene into a run cache.
#include "app/commands/simulate.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <omp.h>

#include <CLI/CLI.hpp>
#include <future>
#include <nlohmann/json.hpp>
#include <numeric>

#include "app/commands/input_file.h"
#include "app/commands/missing_model.h"
#include "app/engine/device.h"
#include "app/engine/network_adhesion.h"
#include "app/engine/reference.h"
#include "app/engine/run_of_scene.h"
#include "app/files/results.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "base/progress.h"
#include "solver/chain/scene_checks.h"

namespace wetcurl {

void add_options(CLI::App& app, SimulateOptions& o) {
    input_file(
        app.add_option("scene", o.scene,
                       "scene file (TOML), or a run (HDF5): the scene it was made from, whole and wet unless "
                       "other options "
                       "say so"))
        ->required();
    app.add_option("-o,--output", o.output, "run cache (HDF5)")->required();
    app.add_option("--frames", o.frames, "frames in place of the scene's")->check(CLI::Range(1, 1000000));
    app.add_option("--strands", o.strands,
                   "at most this many strands: the largest grid that nests in the scene's")
        ->check(CLI::Range(1, 100000000));
    app.add_option("--groom", o.groom, "hair file in place of the scene's groom");
    app.add_option("--precision", o.precision, "float | double")
        ->check(CLI::IsMember({"float", "double"}))
        ->capture_default_str();
    app.add_flag("--dry", o.dry, "leave out all that acts on wet hair; the wetness is recorded");
    app.add_flag("--before-cohesion", o.before_cohesion,
                 "leave out Eq 10, which moves what is displayed alone: a low-resolution run to infer from");
    app.add_flag("--reference", o.reference,
                 "run in double with 160 substeps beside it and report the distance");
}

int simulate_command(const SimulateOptions& o) {
    require_device(o.device);
    SceneOptions options;
    options.set = o.set;
    options.frames = o.frames;
    options.strands = o.strands;
    options.seed = o.seed;
    options.groom = o.groom;
    Scene scene = scene_of_file(o.scene, options);
    check_files(o, o.output, scene.files);
    ResultFile results(o);
    if (o.dry) make_dry(scene);
    if (o.before_cohesion) leave_out_display(scene);
    if (o.before_cohesion && scene.cohesion)
        throw Misuse(
            fmt::format("--before-cohesion: found cohesion.strength = {:g}, allowed 0: cohesion that acts "
                        "in the solve cannot be left out of what is displayed",
                        scene.cohesion->strength));
    if (!scene.adhesion_model.empty())
        require_model_of_adhesion(scene.adhesion_model, o.scene + ": [adhesion] model", o.scene, o);
    const std::string precision = trusted_precision(scene, o.precision);
    if (precision != o.precision)
        log_warning(
            fmt::format("h² k / m is {:.2g}, above what single precision can factor (1e5): running in double",
                        stiffness_number(scene)));
    std::optional<Reference> reference;
    if (o.reference) reference.emplace(scene);
    auto simulation = make_simulation_on(o.device, scene, precision);
    auto network = adhesion_predictor_of(scene, o.threads);
    simulation->use_adhesion_predictor(network.get());

    RunHeader header =
        header_of(scene, *simulation, method_of(scene) + (network ? ", adhesion learned" : ""));
    header.device = o.device;
    InterruptGuard guard;
    RunWriter writer(o.output, header, o.overwrite);
    Progress progress("simulate", scene.frames, "frame");
    std::vector<double> seconds, errors;
    // A device computes the next frame while one is fetched and written; a processor has no core to spare for
    // that.
    RunFrame frame;
    std::future<double> writing;
    double output_seconds = 0;
    auto written = [&] {
        if (writing.valid()) output_seconds += writing.get();
    };
    std::optional<Divergence> diverged;
    int done = 0;
    for (; done < scene.frames && !guard.asked(); ++done) {
        // Frame 0 is the state at time 0.
        if (done > 0) simulation->advance();
        if ((diverged = simulation->divergence())) break;
        written();
        simulation->begin_snapshot(frame);
        if (done > 0) seconds.push_back(frame.seconds);
        writing = std::async(std::launch::async, [&] {
            const double begin = omp_get_wtime();
            simulation->finish_snapshot(frame);
            writer.append(frame);
            return omp_get_wtime() - begin;
        });
        if (reference) written(), errors.push_back(distance_mm(frame.seen(), reference->next().seen()));
        if (o.device == "cpu") written();
        progress.update(done + 1);
    }
    written();
    if (done == scene.frames) writer.commit();

    const Presence presence = presence_of(scene);
    size_t bytes = 0;
    for (const auto& b : simulation->buffers()) bytes += b.bytes;
    Json json{
        {"frames", done},
        {"strands", scene.groom.rest.count},
        {"particles_per_strand", scene.groom.rest.particles},
        {"seconds_per_frame", time_statistics(seconds)},
        {"output_seconds_per_frame", output_seconds / std::max(1, done)},
        {"device", o.device},
        {"threads", o.threads},
        {"precision", precision},
        {"terms_present", presence.present},
        {"terms_absent", presence.absent},
        {"substeps", scene.integrator.substeps},
        {"neighbours_mean", simulation->neighbours_mean()},
        {"limited_edges", simulation->limited_edges()},
        {"peak_bytes", bytes},
        {"bytes_per_particle", double(bytes) / (double(scene.groom.rest.count) * scene.groom.rest.particles)},
        {"diverged", diverged.has_value()}};
    const auto water = simulation->water();
    if (water)
        json["water"] = {{"held_kg", water->held},
                         {"taken_kg", water->taken},
                         {"dripped_kg", water->dripped},
                         {"dried_kg", water->dried},
                         {"balance_kg", water->balance()}};
    if (!errors.empty())
        json["error_mm"] = {
            {"mean", std::accumulate(errors.begin(), errors.end(), 0.0) / double(errors.size())},
            {"last", errors.back()},
            {"max", *std::max_element(errors.begin(), errors.end())}};
    results.write_json(json);
    if (diverged) {
        throw Error(fmt::format(
            "the run diverged at frame {}, strand {}, largest term '{}'; {} frames are kept in {} "
            "(more [integrator] substeps, or less stiffness, may help)",
            done, diverged->strand, diverged->largest_term, done, partial_of(o.output)));
    }
    if (done < scene.frames)
        throw Interrupted(fmt::format("interrupted: {} frames are kept in {}", done, partial_of(o.output)));
    log_info(
        fmt::format("{}: {} strands x {} particles, {} frames, median {} a frame, {:.0f} bytes a "
                    "particle; present: {}",
                    o.output, scene.groom.rest.count, scene.groom.rest.particles, done,
                    milliseconds_text(json["seconds_per_frame"]["median"]),
                    json["bytes_per_particle"].get<double>(), fmt::join(presence.present, ", ")));
    if (water)
        log_info(fmt::format(
            "water: {:.3g} kg held, of {:.3g} at the start and {:.3g} taken; {:.3g} dripped, "
            "{:.3g} dried; balance {:.1e} kg",
            water->held, water->start, water->taken, water->dripped, water->dried, water->balance()));
    return 0;
}

}  // namespace wetcurl

// `wetcurl simulate`: the physics of a scene into a run cache.
#include "app/commands/simulate.h"

#include <fmt/format.h>

#include "app/engine/device.h"
#include "app/engine/missing_model.h"
#include "app/engine/run_of_scene.h"
#include "app/engine/simulate_scene.h"
#include "app/options/option_list.h"

namespace wetcurl {

void add_options(OptionList& options, SimulateOptions& o) {
    options
        .option("scene", o.scene,
                "scene file (TOML), or a run (HDF5): the scene it was made from, whole and wet unless "
                "other options "
                "say so")
        .input_file()
        .required();
    options.option("-o,--output", o.output, "run cache (HDF5)").required();
    options.option("--frames", o.frames, "frames in place of the scene's").within(1, 1000000);
    options
        .option("--strands", o.strands,
                "at most this many strands: the largest grid that nests in the scene's")
        .within(1, 100000000);
    options
        .option("--guides", o.guides,
                "so many strands, chosen where hair differs: guides that the others can be inferred from")
        .within(1, 100000000);
    options.option("--groom", o.groom, "hair file in place of the scene's groom");
    options.option("--precision", o.precision, "float | double").one_of({"float", "double"}).shows_default();
    options.flag("--dry", o.dry, "leave out all that acts on wet hair; the wetness is recorded");
    options.flag("--before-cohesion", o.before_cohesion,
                 "leave out Eq 10, which moves what is displayed alone: a low-resolution run to infer from");
    options.flag("--resume", o.resume,
                 "go on from OUTPUT.partial and OUTPUT.state, which a run that was stopped or killed left");
    options.option(
        "--from", o.from,
        "RUN.h5@N: begin at frame N of that run of the same strands, at its time; without @N at its "
        "last frame");
    options.flag("--keep-state", o.keep_state,
                 "leave OUTPUT.state, with which --from begins at the last frame to the bit");
    options.flag("--reference", o.reference,
                 "run in double with 160 substeps beside it and report the distance");
}

int simulate_command(const SimulateOptions& o) {
    require_device(o.device);
    SceneOptions options;
    options.set = o.set;
    options.frames = o.frames;
    if (o.strands && o.guides)
        throw Misuse(
            "--guides: found with --strands, allowed is one of them: strands chosen, or a grid of them");
    options.strands = o.strands;
    options.guides = o.guides.value_or(0);
    options.seed = o.seed;
    options.groom = o.groom;
    std::optional<RunStart> start;
    if (!o.from.empty()) start = run_start(o.from), options.start = start->time();
    Scene scene = scene_of_file(o.scene, options);
    if (start) scene.files.push_back(start->file);
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
    simulate_scene(std::move(scene),
                   {.output = o.output,
                    .device = o.device,
                    .precision = o.precision,
                    .threads = o.threads,
                    .overwrite = o.overwrite,
                    .reference = o.reference,
                    .resume = o.resume,
                    .from = std::move(start),
                    .keep_state = o.keep_state},
                   results);
    return 0;
}

}  // namespace wetcurl

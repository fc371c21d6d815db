// `wetcurl train`: training of a network on pairs files.
#include "app/commands/train.h"

#include <CLI/CLI.hpp>

#include "app/options/input_file.h"

namespace wetcurl {

void add_options(CLI::App& app, TrainOptions& o) {
    app.add_option("kind", o.kind, "sr | adhesion")->required()->check(CLI::IsMember({"sr", "adhesion"}));
    app.add_option("pairs", o.pairs, "pairs files")->required();
    app.add_option("-o,--output", o.output, "model (HDF5)")->required();
    app.add_option("--validation", o.validation,
                   "pairs files to hold out, in place of the last frames of each run");
    input_file(app.add_option("--recipe", o.recipe, "recipe file (TOML)"));
    app.add_option(
        "--arch", o.architecture,
        "strand_mlp | strand_depthwise | strand_linear | strand_unet_vgg19 | strand_recursive_residual | "
        "unet_vgg19 | recursive_residual | adhesion_mlp");
    app.add_option("--width", o.width, "multiplier of the network's width");
    input_file(app.add_option(
        "--from", o.from,
        "model (HDF5) whose weights are begun with, of its architecture and width, in place of "
        "random ones"));
    app.add_flag("--resume", o.resume, "go on from OUTPUT.checkpoint");
    app.footer(
        "Several processes that mpirun, srun or torchrun starts (or RANK and WORLD_SIZE name) share each "
        "batch; "
        "--device cuda: a GPU for each. They meet at MASTER_ADDR (127.0.0.1), MASTER_PORT (29400), and wait "
        "WETCURL_RENDEZVOUS_SECONDS (300) there. --threads counts for each.");
}

int train_command(const TrainOptions& o) {
    train_network(o);
    return 0;
}

}  // namespace wetcurl

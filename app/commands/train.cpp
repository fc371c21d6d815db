// `wetcurl train`: training of a network on pairs files.
#include "app/commands/train.h"

#include "app/options/option_list.h"

namespace wetcurl {

void add_options(OptionList& options, TrainOptions& o) {
    options.option("kind", o.kind, "sr | adhesion").required().one_of({"sr", "adhesion"});
    options.option("pairs", o.pairs, "pairs files").required();
    options.option("-o,--output", o.output, "model (HDF5)").required();
    options.option("--validation", o.validation,
                   "pairs files to hold out, in place of the last frames of each run");
    options.option("--recipe", o.recipe, "recipe file (TOML)").input_file();
    options.option(
        "--arch", o.architecture,
        "strand_mlp | strand_depthwise | strand_linear | strand_unet_vgg19 | strand_recursive_residual | "
        "unet_vgg19 | recursive_residual | adhesion_mlp");
    options.option("--width", o.width, "multiplier of the network's width");
    options
        .option(
            "--from", o.from,
            "model (HDF5) whose weights are begun with in place of random ones; architecture and width are "
            "the model's, not the recipe's; target too, unless the recipe names it")
        .input_file();
    options.flag("--resume", o.resume, "go on from OUTPUT.checkpoint");
    options.footer(
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

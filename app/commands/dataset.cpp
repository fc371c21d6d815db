// `wetcurl dataset`: many scenes, simulated into training pairs.
#include "app/commands/dataset.h"

#include "app/options/option_list.h"

namespace wetcurl {

void add_options(OptionList& options, DatasetOptions& o) {
    options.option("recipe", o.recipe, "recipe (TOML): the scenes, picked and drawn").input_file().required();
    options.option("-o,--output", o.output, "folder").required();
    options.option("--scene", o.scene, "scene that all start from, in place of the recipe's").input_file();
    options.option("--part", o.part,
                   "K/N: every N-th scene alone, to share the work; mpirun and srun say it themselves");
    options.flag("--resume", o.resume, "make what is not there yet");
}

int dataset_command(const DatasetOptions& o) {
    make_dataset(o);
    return 0;
}

}  // namespace wetcurl

// `wetcurl dataset`: many scenes, simulated into training pairs.
#include "app/commands/dataset.h"

#include <CLI/CLI.hpp>

#include "app/options/input_file.h"

namespace wetcurl {

void add_options(CLI::App& app, DatasetOptions& o) {
    input_file(app.add_option("recipe", o.recipe, "recipe (TOML): the scenes, picked and drawn"))->required();
    app.add_option("-o,--output", o.output, "folder")->required();
    app.add_option("--part", o.part,
                   "K/N: every N-th scene alone, to share the work; mpirun and srun say it themselves");
    app.add_flag("--resume", o.resume, "make what is not there yet");
}

int dataset_command(const DatasetOptions& o) {
    make_dataset(o);
    return 0;
}

}  // namespace wetcurl

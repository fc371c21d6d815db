// `wetcurl dataset`: many scenes, simulated into training pairs.
#pragma once

#include "app/options/common_options.h"

namespace CLI {
class App;
}

namespace wetcurl {

struct DatasetOptions : CommonOptions {
    static constexpr const char *command = "dataset",
                                *summary = "simulate many scenes, dry and wet, into training pairs";
    std::string recipe, output, part;  // part: "K/N"
};

void add_options(CLI::App& app, DatasetOptions& o);
int dataset_command(const DatasetOptions& o);

}  // namespace wetcurl

// `wetcurl import`: hair files, read and written.
#pragma once

#include "app/options/common_options.h"
#include "solver/grooms/procedural.h"

namespace wetcurl {

struct ImportOptions : CommonOptions {
    static constexpr const char *command = "import",
                                *summary = "read a hair file, report on it, write it in another format";
    static constexpr bool reads_scene = false, uses_device = false;
    std::string input, output, order = "root_first", scalp;
    int resample = 0;    // 0: as it is
    GroomTable groom{};  // units, axes and place of the strands
};

void add_options(OptionList& options, ImportOptions& o);
int import_command(const ImportOptions& o);

}  // namespace wetcurl

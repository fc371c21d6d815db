// `wetcurl encode`: training pairs of runs.
#include "app/commands/encode.h"

#include <CLI/CLI.hpp>

#include "app/options/input_file.h"
#include "base/shift_units.h"

namespace wetcurl {

void add_options(CLI::App& app, EncodeOptions& o) {
    input_file(app.add_option("runs", o.inputs, "DRY.h5 WET.h5, repeatable; for adhesion: scenes to run"))
        ->required();
    app.add_option("-o,--output", o.output, "pairs file (HDF5)")->required();
    app.add_option("--codec", o.codec, "root | strand | adhesion")
        ->check(CLI::IsMember({"root", "strand", "adhesion"}))
        ->capture_default_str();
    app.add_option("--colour-units", o.colour_units, std::string("for the root codec: ") + colour_units_help)
        ->check(CLI::IsMember(shift_units_names));
}

int encode_command(const EncodeOptions& o) {
    encode_pairs(o);
    return 0;
}

}  // namespace wetcurl

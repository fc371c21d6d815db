// `wetcurl encode`: training pairs of runs.
#include "app/commands/encode.h"

#include "app/options/option_list.h"
#include "base/shift_units.h"

namespace wetcurl {

void add_options(OptionList& options, EncodeOptions& o) {
    options.option("runs", o.inputs, "DRY.h5 WET.h5, repeatable; for adhesion: scenes to run")
        .input_file()
        .required();
    options.option("-o,--output", o.output, "pairs file (HDF5)").required();
    options.option("--codec", o.codec, "root | strand | adhesion")
        .one_of({"root", "strand", "adhesion"})
        .shows_default();
    options.option("--colour-units", o.colour_units, std::string("for the root codec: ") + colour_units_help)
        .one_of(shift_units_names);
}

int encode_command(const EncodeOptions& o) {
    encode_pairs(o);
    return 0;
}

}  // namespace wetcurl

// `wetcurl encode`: training pairs of runs.
#pragma once

#include "app/dataset/encode_pairs.h"

namespace wetcurl {

struct EncodeOptions : PairsRequest {
    static constexpr const char *command = "encode",
                                *summary =
                                    "make training pairs of dry low-resolution and wet high-resolution runs";
    static constexpr bool uses_device = false;
};

void add_options(OptionList& options, EncodeOptions& o);
int encode_command(const EncodeOptions& o);

}  // namespace wetcurl

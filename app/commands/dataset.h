// `wetcurl dataset`: many scenes, simulated into training pairs.
#pragma once

#include "app/dataset/make_dataset.h"

namespace wetcurl {

struct DatasetOptions : DatasetRequest {
    static constexpr const char *command = "dataset",
                                *summary = "simulate many scenes, dry and wet, into training pairs";
};

void add_options(OptionList& options, DatasetOptions& o);
int dataset_command(const DatasetOptions& o);

}  // namespace wetcurl

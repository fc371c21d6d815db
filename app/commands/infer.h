// `wetcurl infer`: wet hair predicted from a low-resolution run.
#pragma once

#include "app/inference/infer_options.h"

namespace wetcurl {

void add_options(OptionList& options, InferOptions& o);
int infer_command(const InferOptions& o);

}  // namespace wetcurl

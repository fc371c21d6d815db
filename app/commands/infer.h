// `wetcurl infer`: wet hair predicted from a low-resolution run.
#pragma once

#include "app/inference/infer_options.h"

namespace CLI {
class App;
}

namespace wetcurl {

void add_options(CLI::App& app, InferOptions& o);
int infer_command(const InferOptions& o);

}  // namespace wetcurl

// Options that name a file to read.
#pragma once

#include <CLI/CLI.hpp>

#include "base/installed.h"

namespace wetcurl {

// Scenes and released networks that are installed with the program have their names from any folder.
inline CLI::Option* input_file(CLI::Option* option) {
    return option->transform([](const std::string& path) { return found_or_installed(path); });
}

}  // namespace wetcurl

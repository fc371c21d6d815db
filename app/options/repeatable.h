// Options that may be given again and again.
#pragma once

#include <CLI/CLI.hpp>

namespace wetcurl {

// One value after each mention; what follows it is no value of it.
inline CLI::Option* repeatable(CLI::Option* option) {
    return option->expected(1)->take_all()->allow_extra_args(false);
}

}  // namespace wetcurl

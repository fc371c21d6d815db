// The options that every command has.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace wetcurl {

struct CommonOptions {
    std::vector<std::string> set;  // key.path=value
    std::string device = "cpu";
    int threads = 0;  // 0: all
    std::optional<long> seed;
    bool overwrite = false;
    bool resume = false;
    std::string json;  // file for the results as JSON, "-" for standard output, "" for none
};

}  // namespace wetcurl

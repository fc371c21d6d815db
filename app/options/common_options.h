// The options that every command has. One that reads no scene (or recipe) refuses --set and --seed, one that
// uses no device --device; their help does not show them.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace wetcurl {

class OptionList;

struct CommonOptions {
    static constexpr bool reads_scene = true, uses_device = true, writes_json = true;
    std::vector<std::string> set;  // key.path=value
    std::string device = "cpu";
    int threads = 0;  // 0: all
    std::optional<long> seed;
    bool overwrite = false;
    bool resume = false;
    std::string json;  // file for the results as JSON, "-" for standard output, "" for none
};

}  // namespace wetcurl

// Results as JSON, interrupts.
#include "app/results.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/error.h"

namespace wetcurl {

void write_json(const Json& json, const std::string& path) {
    if (path.empty()) return;
    const std::string text = json.dump(2) + "\n";
    if (path == "-") {
        std::fputs(text.c_str(), stdout);
        return;
    }
    if (std::filesystem::is_directory(path))
        throw Error(path + ": is a folder, a file name is needed for --json");
    // A device or a pipe is written to, never replaced.
    if (std::filesystem::exists(path) && !std::filesystem::is_regular_file(path)) {
        std::ofstream out(path);
        out << text << std::flush;
        if (!out) throw Error(path + ": cannot be written");
        return;
    }
    const std::string partial = path + ".partial";
    {
        std::ofstream out(partial);
        out << text;
        if (!out) throw Error(path + ": cannot be written");
    }
    std::filesystem::rename(partial, path);
}

Json time_statistics(std::vector<double> t) {
    if (t.empty()) return {{"mean", 0}, {"median", 0}, {"min", 0}, {"max", 0}, {"std", 0}};
    std::sort(t.begin(), t.end());
    const size_t n = t.size();
    const double mean = std::accumulate(t.begin(), t.end(), 0.0) / double(n);
    double square = 0;
    for (double x : t) square += (x - mean) * (x - mean);
    return {{"mean", mean},
            {"median", (t[(n - 1) / 2] + t[n / 2]) / 2},
            {"min", t.front()},
            {"max", t.back()},
            {"std", std::sqrt(square / double(n))}};
}

}  // namespace wetcurl

// Results as JSON, the files of a command.
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

namespace fs = std::filesystem;

// Also by another name, and where neither is there yet.
static bool same_file(const std::string& a, const std::string& b) {
    std::error_code absent;
    return fs::equivalent(a, b, absent) ||
           (!fs::exists(a, absent) && fs::weakly_canonical(a, absent) == fs::weakly_canonical(b, absent));
}

void check_files(const CommonOptions& o, const std::string& output, const std::vector<std::string>& inputs) {
    const std::string json = o.json == "-" ? "" : o.json;
    if (!output.empty() && !json.empty() && same_file(output, json))
        throw Misuse("--json " + json + ": is the output as well; another name is needed");
    for (const std::string* written : {&output, &json}) {
        if (written->empty()) continue;
        for (const auto& input : inputs)
            for (const auto& touched : {*written, *written + ".partial"})
                if (!input.empty() && same_file(touched, input))
                    throw Misuse(*written + ": writing it would destroy the input " + input +
                                 "; another name is needed");
        // A device or a pipe is written to, never replaced; what is resumed is there already.
        if (!o.overwrite && !(o.resume && written == &output) && fs::is_regular_file(*written))
            throw Error(*written + ": is there already; --overwrite replaces it");
    }
    if (fs::is_directory(json)) throw Error(json + ": is a folder, a file name is needed for --json");
    std::error_code error;
    if (const fs::path folder = fs::path(json).parent_path(); !folder.empty())
        fs::create_directories(folder, error);
    if (error) throw Error(json + ": its folder cannot be made: " + error.message());
}

void refuse_scene_options(const CommonOptions& o, const std::string& who) {
    const std::string given = !o.set.empty() ? "--set " + o.set[0] : o.seed ? "--seed" : "";
    if (!given.empty()) throw Misuse(given + ": " + who + " reads no scene and no recipe");
}

void refuse_device(const CommonOptions& o, const std::string& who) {
    if (o.device != "cpu") throw Misuse("--device " + o.device + ": " + who + " runs on the CPU alone");
}

void write_text(const std::string& text, const std::string& path) {
    if (fs::exists(path) && !fs::is_regular_file(path)) {
        std::ofstream out(path);
        out << text << std::flush;
        if (!out) throw Error(path + ": cannot be written");
        return;
    }
    const std::string partial = path + ".partial";
    {
        std::ofstream out(partial);
        out << text << std::flush;
        if (!out) throw Error(path + ": cannot be written");
    }
    fs::rename(partial, path);
}

void write_json(const Json& json, const std::string& path) {
    if (path.empty()) return;
    const std::string text = json.dump(2) + "\n";
    if (path == "-")
        std::fputs(text.c_str(), stdout);
    else
        write_text(text, path);
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

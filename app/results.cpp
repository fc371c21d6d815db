// Results as JSON, the files of a command.
#include "app/results.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
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

// Throws Error where what `write_text` does at the end of the work would fail.
static void require_writable(const std::string& path) {
    std::error_code absent;
    const bool plain = !fs::exists(path, absent) || fs::is_regular_file(path, absent);
    const std::string touched = plain ? path + ".partial" : path;
    const bool there = fs::exists(touched, absent);
    // A pipe is not opened: that waits for who reads it.
    errno = 0;
    if (there ? !fs::is_directory(touched, absent) && access(touched.c_str(), W_OK) == 0
              : std::ofstream(touched).good()) {
        if (!there) fs::remove(touched, absent);
        return;
    }
    throw Error(path + ": cannot be written: " + (errno ? std::strerror(errno) : touched + " is a folder"));
}

// Throws Error where no file can be made there: its folder, or the nearest one above it, takes none.
static void require_folder_for(const std::string& output) {
    std::error_code absent;
    fs::path folder = fs::absolute(output).parent_path();
    while (!fs::exists(folder, absent) && folder.has_relative_path()) folder = folder.parent_path();
    if (!fs::is_directory(folder, absent))
        throw Error(output + ": cannot be written: " + folder.string() + " is no folder");
    if (access(folder.c_str(), W_OK) != 0)
        throw Error(output + ": cannot be written in " + folder.string() + ": " + std::strerror(errno));
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
        std::error_code absent;
        if (!o.overwrite && !(o.resume && written == &output) && fs::is_regular_file(*written, absent))
            throw Error(*written + ": is there already; --overwrite replaces it");
    }
    std::error_code error;
    if (fs::is_directory(json, error)) throw Error(json + ": is a folder, a file name is needed for --json");
    error.clear();
    if (const fs::path folder = fs::path(json).parent_path(); !folder.empty())
        fs::create_directories(folder, error);
    if (error) throw Error(json + ": its folder cannot be made: " + error.message());
    if (!json.empty()) require_writable(json);
    if (!output.empty()) require_folder_for(output);
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

std::string json_text(const Json& json, int indent) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

void write_json(const Json& json, const std::string& path) {
    if (path.empty()) return;
    const std::string text = json_text(json, 2) + "\n";
    if (path == "-")
        std::fputs(text.c_str(), stdout);
    else
        write_text(text, path);
}

Json time_statistics(std::vector<double> t) {
    if (t.empty())
        return {{"mean", nullptr}, {"median", nullptr}, {"min", nullptr}, {"max", nullptr}, {"std", nullptr}};
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

std::string milliseconds_text(const Json& seconds) {
    return seconds.is_null() ? "no time" : fmt::format("{:.1f} ms", 1000 * seconds.get<double>());
}

}  // namespace wetcurl

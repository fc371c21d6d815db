// Results as JSON, the files of a command.
#include "app/files/results.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/error.h"
#include "base/provenance.h"

namespace wetcurl {

namespace fs = std::filesystem;

// Also by another name, and where neither is there yet.
static bool same_file(const std::string& a, const std::string& b) {
    std::error_code absent;
    return fs::equivalent(a, b, absent) ||
           (!fs::exists(a, absent) && fs::weakly_canonical(a, absent) == fs::weakly_canonical(b, absent));
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

Json json_of(const Finding& finding) {
    return {{"level", name_of(finding.level)},
            {"name", finding.name},
            {"text", finding.text},
            {"remedy", finding.remedy}};
}

void check_files(const CommonOptions& o, const std::string& output, const std::vector<std::string>& inputs) {
    const std::string json = o.json == "-" ? "" : o.json;
    auto touched = [](const std::string& path) {
        if (path.empty() || is_stream(path)) return std::vector<std::string>();
        return std::vector<std::string>{path, partial_of(path)};
    };
    for (const auto& a : touched(output))
        for (const auto& b : touched(json))
            if (same_file(a, b))
                throw Misuse("--json " + json + ": is the output as well; another name is needed");
    for (const std::string* written : {&output, &json})
        for (const auto& input : inputs)
            for (const auto& file : touched(*written))
                if (!input.empty() && same_file(file, input))
                    throw Misuse(*written + ": writing it would destroy the input " + input +
                                 "; another name is needed");
    // What is resumed is there already.
    if (!output.empty()) {
        require_place(output, o.overwrite || o.resume);
        require_folder_for(target_of(output));
    }
    if (json.empty() || is_stream(json)) return;
    require_place(json, o.overwrite);
    make_folder_of(json);
}

void refuse_scene_options(const CommonOptions& o, const std::string& who) {
    const std::string given = !o.set.empty() ? "--set " + o.set[0] : o.seed ? "--seed" : "";
    if (!given.empty()) throw Misuse(given + ": " + who + " reads no scene and no recipe");
}

void refuse_device(const CommonOptions& o, const std::string& who) {
    if (o.device != "cpu") throw Misuse("--device " + o.device + ": " + who + " runs on the CPU alone");
}

ResultFile::ResultFile(const std::string& path, bool overwrite, LockedFile::Others others) : path_(path) {
    if (!path.empty() && path != "-" && !is_stream(path)) file_.emplace(path, overwrite, "", others);
}

std::string json_text(const Json& json, int indent) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

void ResultFile::write(const std::string& text) {
    if (file_) {
        file_->write(text);
        file_->commit();
    } else if (path_ == "-") {
        std::fputs(text.c_str(), stdout);
    } else if (!path_.empty()) {
        write_to_stream(path_, text);
    }
}

// With its provenance.
static std::string text_of(Json json) {
    for (const auto& [name, text] : provenance()) json["provenance"][name] = text;
    return json_text(json, 2) + "\n";
}

void ResultFile::write_json(const Json& json) {
    if (!path_.empty()) write(text_of(json));
}

void ResultFile::leave_json(const Json& json) {
    if (!file_) return write_json(json);
    file_->write(text_of(json));
    file_->keep();
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
    return seconds.is_null() ? "- ms" : fmt::format("{:.1f} ms", 1000 * seconds.get<double>());
}

}  // namespace wetcurl

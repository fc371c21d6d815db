// Results as JSON, and the files of a command: what several commands share. Ours.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "app/commands.h"

namespace wetcurl {

using Json = nlohmann::ordered_json;

// To `path`, whole or not at all; a device or a pipe is written to, never replaced. Throws Error where it
// cannot be written.
void write_text(const std::string& text, const std::string& path);
// As text. Names of files need not be UTF-8, which JSON is: what is not becomes U+FFFD.
std::string json_text(const Json& json, int indent = -1);
// To `path`, "-" for standard output, "" for nowhere.
void write_json(const Json& json, const std::string& path);

// Before anything is written: throws Misuse where `output` or --json (or the .partial beside it) is one of
// `inputs` or the two are one file, and Error where one of them is there without --overwrite, or cannot be
// written. "": none.
void check_files(const CommonOptions& o, const std::string& output, const std::vector<std::string>& inputs);

// Throw Misuse, naming `who`, where `o` gives what is read by none: --set and --seed are for a scene or a
// recipe, --device for a network.
void refuse_scene_options(const CommonOptions& o, const std::string& who);
void refuse_device(const CommonOptions& o, const std::string& who);

// {mean, median, min, max, std} of run times [s]; of none, each is null. Frame 0 is no run time: nothing was
// computed for it.
Json time_statistics(std::vector<double> seconds);
// One of those as text: "12.3 ms", or "no time" where it is null.
std::string milliseconds_text(const Json& seconds);

}  // namespace wetcurl

// Results as JSON, and the files of a command: what several commands share.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/options/common_options.h"
#include "base/output_file.h"
#include "solver/grooms/strand_findings.h"

namespace wetcurl {

using Json = nlohmann::ordered_json;

// As text. Names of files need not be UTF-8, which JSON is: what is not becomes U+FFFD.
std::string json_text(const Json& json, int indent = -1);

// A text that a command writes when it is done. No other process can write the file meanwhile: a second
// command is refused when it begins, not when its work is done.
class ResultFile {
  public:
    // `path`: "" for nowhere, "-" for standard output; to a device or a pipe text is written as it comes.
    // Throws as OutputFile does.
    ResultFile(const std::string& path, bool overwrite,
               LockedFile::Others others = LockedFile::Others::refuse);
    // Where --json says.
    explicit ResultFile(const CommonOptions& o) : ResultFile(o.json, o.overwrite) {}

    // Throw Error where it cannot be written.
    void write(const std::string& text);
    void write_json(const Json& json);
    // What an interrupted command has so far: a file of it stays as NAME.partial.
    void leave_json(const Json& json);

  private:
    std::string path_;
    std::optional<OutputFile> file_;
};

// Before anything is written: throws Misuse where `output` or --json (or the .partial beside it) is one of
// `inputs` or the two are one file, and Error where one of them is there without --overwrite, cannot become a
// file, or --json has no place. "": none.
void check_files(const CommonOptions& o, const std::string& output, const std::vector<std::string>& inputs);

// Throw Misuse, naming `who`, where `o` gives what is read by none: --set and --seed are for a scene or a
// recipe, --device for a network.
void refuse_scene_options(const CommonOptions& o, const std::string& who);
void refuse_device(const CommonOptions& o, const std::string& who);

// level, name, text, remedy.
Json json_of(const Finding& finding);

// {mean, median, min, max, std} of run times [s]; of none, each is null. Frame 0 is no run time: nothing was
// computed for it.
Json time_statistics(std::vector<double> seconds);
// One of those as text: "12.3 ms", or "- ms" where it is null.
std::string milliseconds_text(const Json& seconds);

}  // namespace wetcurl

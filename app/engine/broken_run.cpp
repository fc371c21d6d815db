// Runs to go on with.
#include "app/engine/broken_run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <sstream>

#include "base/log.h"

namespace wetcurl {

namespace fs = std::filesystem;

std::optional<BrokenRun> whole_run_at(const std::string& output, bool overwrite) {
    if (overwrite || !fs::exists(output)) return std::nullopt;
    const RunReader run(output);
    return BrokenRun{output, run.header(), run.frames(), {}};
}

void require_whole(const BrokenRun& whole, const RunHeader& header, int frames) {
    require_same(whole, header);
    if (whole.frames != frames)
        throw Error(fmt::format("{}: --resume: is complete with {} frames, now {} are asked for", whole.file,
                                whole.frames, frames));
    log_info(whole.file + ": is complete, nothing to resume");
}

std::optional<BrokenRun> broken_run_at(const OutputFile& place) {
    const auto anew = [&](const std::string& why) {
        log_info(fmt::format("{}: {}; the run begins anew", place.path(), why));
        return std::nullopt;
    };
    std::error_code error;
    if (fs::file_size(place.partial(), error) == 0 || error) return anew("no broken run is there to resume");
    std::optional<RunReader> run;
    try {
        run.emplace(place.partial(), true);
    } catch (const Error& e) {
        // Killed before the first frame.
        return anew(e.what());
    }
    if (run->frames() == 0) return anew(place.partial() + " has no whole frame");
    return BrokenRun{place.partial(), run->header(), run->frames(), run->seconds()};
}

// The first line that differs, of texts that do; of a TOML text the table that it stands in.
static std::string first_difference(const std::string& found, const std::string& wanted) {
    std::istringstream a(found), b(wanted);
    std::string line_a, line_b, table;
    for (bool more_a = true, more_b = true; more_a || more_b;) {
        line_a.clear(), line_b.clear();
        more_a = bool(std::getline(a, line_a)), more_b = bool(std::getline(b, line_b));
        if (line_a != line_b) break;
        if (line_a.starts_with('[')) table = line_a + " ";
    }
    const auto said = [](const std::string& line) { return line.empty() ? "nothing" : "'" + line + "'"; };
    return fmt::format("{}{}, now it is {}", table, said(line_a), said(line_b));
}

void require_same(const BrokenRun& broken, const RunHeader& header) {
    const RunHeader& was = broken.header;
    const auto require = [&](const char* what, const std::string& found, const std::string& wanted) {
        if (found != wanted)
            throw Error(fmt::format("{}: --resume: the run that is there has {} {}", broken.file, what,
                                    first_difference(found, wanted)));
    };
    const auto number = [](auto x) { return fmt::format("{}", x); };
    const auto list = [](const std::vector<std::string>& words) {
        return fmt::format("{}", fmt::join(words, ", "));
    };
    require("scene", was.scene, header.scene);
    require("method", was.method, header.method);
    require("device", was.device, header.device);
    require("frames a second", number(was.fps), number(header.fps));
    require("a start at [s]", number(was.start), number(header.start));
    require("seed", number(was.seed), number(header.seed));
    require("stride", number(was.stride), number(header.stride));
    require("guides", number(was.guides), number(header.guides));
    require("strands of hash", was.groom.hash(), header.groom.hash());
    require("energies", list(was.energy_kinds), list(header.energy_kinds));
    require("stages", list(was.stages), list(header.stages));
    require("inputs", list(was.inputs), list(header.inputs));
    require("terms", was.terms_present, header.terms_present);
}

void look_at(const BrokenRun& broken, FrameWatch& watch) {
    const RunReader run(broken.file, true);
    for (int f = 0; f < broken.frames; ++f) watch.look(f, run.frame(f));
}

}  // namespace wetcurl

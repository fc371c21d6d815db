// `wetcurl compare`: how far runs are from a reference, and what a frame of each costs.
// Ours.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/comparison.h"

namespace wetcurl {

namespace {

// One column of the table: its heading over two lines, and a cell.
struct Column {
    const char *name, *unit;
    std::string (*cell)(const Comparison&);
};

const Column columns[] = {
    {"method", "", [](const Comparison& c) { return c.method; }},
    {"frames", "", [](const Comparison& c) { return fmt::format("{}", c.frames); }},
    {"time", "ms/frame",
     [](const Comparison& c) { return fmt::format("{:.1f}", 1e3 * c.seconds_per_frame); }},
    {"error", "mean mm", [](const Comparison& c) { return fmt::format("{:.3f}", c.position_mm.mean); }},
    {"", "95 % mm", [](const Comparison& c) { return fmt::format("{:.2f}", c.position_mm.p95); }},
    {"", "max mm", [](const Comparison& c) { return fmt::format("{:.1f}", c.position_mm.max); }},
    {"", "% length", [](const Comparison& c) { return fmt::format("{:.2f}", 100 * c.position_rel); }},
    {"shared", "mm", [](const Comparison& c) { return fmt::format("{:.3f}", c.shared_mm.mean); }},
    {"new", "mm", [](const Comparison& c) { return fmt::format("{:.3f}", c.new_mm.mean); }},
    {"strands", "mm",
     [](const Comparison& c) { return c.strands_mm ? fmt::format("{:.3f}", *c.strands_mm) : "-"; }},
    {"static", "mm", [](const Comparison& c) { return fmt::format("{:.3f}", c.static_mm); }},
    {"F1", "2mm 20°", [](const Comparison& c) { return fmt::format("{:.3f}", c.f1[0]); }},
    {"", "3mm 30°", [](const Comparison& c) { return fmt::format("{:.3f}", c.f1[1]); }},
    {"curvat.", "error", [](const Comparison& c) { return fmt::format("{:.3f}", c.curvature_error); }},
    {"curl", "radius", [](const Comparison& c) { return fmt::format("{:.3f}", c.curl_radius_ratio); }},
    {"tips", "spread", [](const Comparison& c) { return fmt::format("{:.3f}", c.tip_spread_ratio); }},
    {"crowd", "of ref.",
     [](const Comparison& c) {
         return c.crowd_reference > 0 ? fmt::format("{:.2f}", c.crowd / c.crowd_reference) : "-";
     }},
    {"stretch", "mean %", [](const Comparison& c) { return fmt::format("{:.2f}", 100 * c.stretch_mean); }},
    {"", "max %", [](const Comparison& c) { return fmt::format("{:.1f}", 100 * c.stretch_max); }},
    {"depth", "max mm", [](const Comparison& c) { return fmt::format("{:.2f}", c.penetration_max_mm); }},
};

// Widths count characters, not bytes: a degree sign is one of them.
size_t characters(const std::string& text) {
    return size_t(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string table_of(const std::vector<Comparison>& others) {
    std::vector<std::string> lines(others.size() + 2);
    for (const Column& column : columns) {
        std::vector<std::string> cells{column.name, column.unit};
        for (const auto& other : others) cells.push_back(column.cell(other));
        size_t width = 0;
        for (const auto& cell : cells) width = std::max(width, characters(cell));
        const bool left = &column == columns;  // names start, numbers end, at the same place
        for (size_t k = 0; k < cells.size(); ++k) {
            const std::string gap(width - characters(cells[k]), ' ');
            lines[k] += (left ? cells[k] + gap : "  " + gap + cells[k]);
        }
    }
    std::string text;
    for (const auto& line : lines) text += line + "\n";
    return text;
}

}  // namespace

int compare_command(const CompareOptions& options) {
    std::vector<std::string> inputs = options.others;
    inputs.push_back(options.reference);
    check_files(options, "", inputs);
    refuse_scene_options(options, "compare");
    refuse_device(options, "compare");
    ResultFile results(options);
    const auto others = compare_runs(options.reference, options.others, options.first_frame);
    Json json{{"reference", options.reference}, {"others", Json::array()}};
    for (const auto& other : others) json["others"].push_back(json_of(other));
    if (options.json != "-") {
        const std::string heading =
            fmt::format("against {} ({})\n", options.reference, RunReader(options.reference).header().method);
        std::fputs((heading + table_of(others)).c_str(), stdout);
    }
    results.write_json(json);
    return 0;
}

}  // namespace wetcurl

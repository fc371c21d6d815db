// `wetcurl compare`: how far runs are from a reference, and what a frame of each costs.
// Ours.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/results.h"
#include "app/run_solids.h"
#include "base/log.h"
#include "learn/metrics.h"

namespace wetcurl {

namespace {

Json json_of(const Spread& s) { return {{"mean", s.mean}, {"p95", s.p95}, {"max", s.max}}; }
Json json_of(const std::optional<double>& x) { return x ? Json(*x) : Json(nullptr); }

Json json_of(const Comparison& c) {
    return {{"file", c.file},
            {"method", c.method},
            {"frames", c.frames},
            {"seconds_per_frame", c.seconds_per_frame},
            {"position_mm", json_of(c.position_mm)},
            {"position_rel", c.position_rel},
            {"position_shared_mm", json_of(c.shared_mm)},
            {"position_new_mm", json_of(c.new_mm)},
            {"position_static_mm", c.static_mm},
            {"position_dynamic_mm", c.dynamic_mm},
            {"f1_2mm_20deg", c.f1[0]},
            {"f1_3mm_30deg", c.f1[1]},
            {"f1_4mm_40deg", c.f1[2]},
            {"curvature_error", c.curvature_error},
            {"curl_radius_ratio", c.curl_radius_ratio},
            {"stretch_max", c.stretch_max},
            {"stretch_max_reference", c.stretch_max_reference},
            {"penetration",
             {{"fraction", c.penetration_fraction},
              {"mean_mm", c.penetration_mean_mm},
              {"max_mm", c.penetration_max_mm}}},
            {"solid_distance_mm", json_of(c.solid_distance_mm)},
            {"tip_spread_mm", c.tip_spread_mm},
            {"tip_spread_reference_mm", c.tip_spread_reference_mm},
            {"tip_spread_ratio", c.tip_spread_ratio},
            {"clumps", c.clumps},
            {"clumps_reference", c.clumps_reference},
            {"jitter_mm", json_of(c.jitter_mm)},
            {"jitter_reference_mm", json_of(c.jitter_reference_mm)},
            {"velocity_error_m_per_s", c.velocity_error}};
}

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
    {"static", "mm", [](const Comparison& c) { return fmt::format("{:.3f}", c.static_mm); }},
    {"F1", "2mm 20°", [](const Comparison& c) { return fmt::format("{:.3f}", c.f1[0]); }},
    {"", "3mm 30°", [](const Comparison& c) { return fmt::format("{:.3f}", c.f1[1]); }},
    {"curvat.", "error", [](const Comparison& c) { return fmt::format("{:.3f}", c.curvature_error); }},
    {"curl", "radius", [](const Comparison& c) { return fmt::format("{:.3f}", c.curl_radius_ratio); }},
    {"tips", "spread", [](const Comparison& c) { return fmt::format("{:.3f}", c.tip_spread_ratio); }},
    {"stretch", "max %", [](const Comparison& c) { return fmt::format("{:.1f}", 100 * c.stretch_max); }},
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
    const RunReader reference(options.reference);
    const auto solid = solid_distance_of(reference.header());
    std::vector<Comparison> others;
    Json json{{"reference", options.reference}, {"others", Json::array()}};
    for (const auto& path : options.others) {
        const RunReader other(path);
        others.push_back(compare(reference, other, options.first_frame, solid));
        if (other.frames() != reference.frames())
            log_warning(fmt::format("{} has {} frames, {} has {}: frames {} to {} are compared", path,
                                    other.frames(), options.reference, reference.frames(),
                                    options.first_frame, options.first_frame + others.back().frames - 1));
        json["others"].push_back(json_of(others.back()));
    }
    if (options.json != "-") {
        const std::string heading =
            fmt::format("against {} ({})\n", options.reference, reference.header().method);
        std::fputs((heading + table_of(others)).c_str(), stdout);
    }
    write_json(json, options.json);
    return 0;
}

}  // namespace wetcurl

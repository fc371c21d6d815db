// `wetcurl compare`: how far runs are from a reference, and what a frame of each costs.
#include "app/commands/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <nlohmann/json.hpp>

#include "app/files/run_file.h"
#include "app/measures/comparison.h"
#include "app/options/option_list.h"

namespace wetcurl {

namespace {

using Cell = std::string (*)(const Comparison&);

// One column of the table: its heading over two lines, a run's cell, the reference's (null: "-"), and what it
// means.
struct Column {
    const char *name, *unit;
    Cell cell, reference;
    const char* meaning;
};

std::string fixed(double x, int digits) { return fmt::format("{:.{}f}", x, digits); }
std::string percent(double x, int digits) { return fixed(100 * x, digits); }
std::string milliseconds(double seconds) { return seconds > 0 ? fixed(1e3 * seconds, 1) : "-"; }

const Column columns[] = {
    {"file", "", [](const Comparison& c) { return c.file; }, nullptr, "the run; the reference comes first"},
    {"method", "", [](const Comparison& c) { return c.method; }, nullptr, "how its strands were made"},
    {"frames", "", [](const Comparison& c) { return fmt::format("{}", c.frames); }, nullptr,
     "how many are compared"},
    {"time", "ms/frame", [](const Comparison& c) { return milliseconds(c.seconds_per_frame); },
     [](const Comparison& c) { return milliseconds(c.seconds_per_frame_reference); },
     "run time of a frame, the mean without frame 0 and without file output"},
    {"speed-up", "of ref.",
     [](const Comparison& c) {
         const auto factor = speed_up(c);
         return factor ? fixed(*factor, 2) : "-";
     },
     nullptr, "the reference's time over the run's, over the same frames"},
    {"error", "mean mm", [](const Comparison& c) { return fixed(c.position_mm.mean, 3); }, nullptr,
     "distance of a particle to the reference's"},
    {"", "95 % mm", [](const Comparison& c) { return fixed(c.position_mm.p95, 2); }, nullptr,
     "the same: 95 of 100 particles are nearer"},
    {"", "max mm", [](const Comparison& c) { return fixed(c.position_mm.max, 1); }, nullptr,
     "the same, of the farthest particle"},
    {"", "% length", [](const Comparison& c) { return percent(c.position_rel, 2); }, nullptr,
     "the same, the mean in percent of the strand's length"},
    {"shared", "mm", [](const Comparison& c) { return fixed(c.shared_mm.mean, 3); }, nullptr,
     "error of strands that the low-resolution run has too"},
    {"new", "mm", [](const Comparison& c) { return fixed(c.new_mm.mean, 3); }, nullptr,
     "error of the other strands"},
    {"strands", "mm", [](const Comparison& c) { return c.strands_mm ? fixed(*c.strands_mm, 3) : "-"; },
     nullptr, "error of the strands before cohesion (Eq 10)"},
    {"static", "mm", [](const Comparison& c) { return fixed(c.static_mm, 3); }, nullptr,
     "the part of the error that stays the same over time"},
    {"F1", "2mm 20°", [](const Comparison& c) { return fixed(c.f1[0], 3); }, nullptr,
     "share of particles with a counterpart so near, of a direction so near; 1 is best"},
    {"", "3mm 30°", [](const Comparison& c) { return fixed(c.f1[1], 3); }, nullptr,
     "the same with wider bounds"},
    {"curvat.", "error", [](const Comparison& c) { return fixed(c.curvature_error, 3); }, nullptr,
     "difference of curvature over the reference's curvature"},
    {"curl", "radius", [](const Comparison& c) { return fixed(c.curl_radius_ratio, 3); }, nullptr,
     "mean radius of the curls over the reference's; 1 is best"},
    {"tips", "spread", [](const Comparison& c) { return fixed(c.tip_spread_ratio, 3); }, nullptr,
     "distance between neighbouring tips over the reference's; 1 is best"},
    {"crowd", "of ref.",
     [](const Comparison& c) { return c.crowd_reference > 0 ? fixed(c.crowd / c.crowd_reference, 2) : "-"; },
     nullptr, "particles of other strands within 4 mm over the reference's; 1 is best"},
    {"stretch", "mean %", [](const Comparison& c) { return percent(c.stretch_mean, 2); },
     [](const Comparison& c) { return percent(c.stretch_mean_reference, 2); },
     "change of an edge's length against rest"},
    {"", "max %", [](const Comparison& c) { return percent(c.stretch_max, 1); },
     [](const Comparison& c) { return percent(c.stretch_max_reference, 1); }, "the same, of the worst edge"},
    {"depth", "max mm", [](const Comparison& c) { return fixed(c.penetration_max_mm, 2); }, nullptr,
     "deepest particle in a solid"},
};

// Cells of the reference, as the first comparison has them.
std::vector<std::string> reference_cells(const RunReader& reference, const Comparison& first) {
    std::vector<std::string> cells;
    for (const Column& column : columns) cells.push_back(column.reference ? column.reference(first) : "-");
    cells[0] = reference.path(), cells[1] = reference.header().method,
    cells[2] = std::to_string(first.frames);
    return cells;
}

// Widths count characters, not bytes: a degree sign is one of them.
size_t characters(const std::string& text) {
    return size_t(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string table_of(const RunReader& reference, const std::vector<Comparison>& others) {
    std::vector<std::string> lines(others.size() + 3);
    const auto first = reference_cells(reference, others.at(0));
    for (size_t at = 0; at < std::size(columns); ++at) {
        const Column& column = columns[at];
        std::vector<std::string> cells{column.name, column.unit, first[at]};
        for (const auto& other : others) cells.push_back(column.cell(other));
        size_t width = 0;
        for (const auto& cell : cells) width = std::max(width, characters(cell));
        const bool text = at < 2;  // texts start, numbers end, at the same place
        for (size_t k = 0; k < cells.size(); ++k) {
            const std::string gap(width - characters(cells[k]), ' ');
            lines[k] += (at ? "  " : "") + (text ? cells[k] + gap : gap + cells[k]);
        }
    }
    std::string out;
    for (const auto& line : lines) out += line + "\n";
    return out;
}

}  // namespace

std::string compare_columns() {
    std::string out = "Columns of the table:\n", name;
    for (const Column& column : columns) {
        if (*column.name) name = column.name;
        out += fmt::format("  {:<9}{:<10}{}\n", name, column.unit, column.meaning);
    }
    return out;
}

void add_options(OptionList& options, CompareOptions& o) {
    options.option("reference", o.reference, "REFERENCE.h5").required();
    options.option("others", o.others, "OTHER.h5").required();
    options.footer(compare_columns());
    options.option("--first-frame", o.first_frame, "leave out the frames before this one").not_negative();
}

int compare_command(const CompareOptions& given) {
    CompareOptions options = given;
    options.reference = run_to_read(options.reference);
    for (auto& path : options.others) path = run_to_read(path);
    std::vector<std::string> inputs = options.others;
    inputs.push_back(options.reference);
    check_files(options, "", inputs);
    ResultFile results(options);
    const auto others = compare_runs(options.reference, options.others, options.first_frame);
    const RunReader reference(options.reference);
    Json json{{"reference", options.reference},
              {"reference_method", reference.header().method},
              {"reference_seconds_per_frame", others.at(0).seconds_per_frame_reference},
              {"others", Json::array()}};
    for (const auto& other : others) {
        Json entry = json_of(other);
        const auto factor = speed_up(other);
        entry["speed_up"] = factor ? Json(*factor) : Json(nullptr);
        json["others"].push_back(entry);
    }
    if (options.json != "-")
        std::fputs((table_of(reference, others) + "`wetcurl compare --help` explains the columns\n").c_str(),
                   stdout);
    results.write_json(json);
    return 0;
}

}  // namespace wetcurl

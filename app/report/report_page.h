// The report as one HTML file that needs nothing else: HTML5, its style and script within, no network.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/report/report_charts.h"
#include "app/report/report_rows.h"

namespace wetcurl {

struct ReportPage {
    std::string title;          // the scene's, or what stands for it
    std::string compared;       // one line
    Rows rows;                  // of headline numbers, chart and table; empty: of trainings alone
    int scenes = 1;             // that most rows have
    std::optional<Rows> shown;  // of the runs in the player, where `rows` are of a table
    std::vector<ErrorCurve> curves;
    double curve_start = 0, curve_step = 1;
    std::string curve_unit;  // "time [s]"
    Json player;             // of report_player.h; null: none
    Json stability;          // what `stability --json` wrote; null: none
    std::vector<TrainingLog> trainings;
    // What it was made from: a heading, and lines of names and values.
    using Facts = std::vector<std::pair<std::string, std::string>>;
    std::vector<std::pair<std::string, Facts>> sources;
    Facts files;         // further ones: name, hash
    double refresh = 0;  // the page loads itself anew every so many seconds; 0: never
};

// All text of the page's data is escaped.
std::string html_of(const ReportPage& page);

}  // namespace wetcurl

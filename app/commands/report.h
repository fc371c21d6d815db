// `wetcurl report`: a page of results.
#pragma once

#include "app/options/common_options.h"

namespace wetcurl {

struct ReportOptions : CommonOptions {
    static constexpr const char *command = "report",
                                *summary = "learned beside simulated hair: one HTML file to open";
    static constexpr bool reads_scene = false, uses_device = false;
    std::vector<std::string> runs;  // the reference, then what is compared with it; none: a table alone
    std::string table, stability, output;  // folder of comparisons, the battery's JSON, the page; "": none
    std::vector<std::string> trainings;    // their logs, MODEL.h5.jsonl
    int first_frame = 0;                   // of the runs, as for compare
    std::optional<double> watch;           // trainings: writes the page anew every so many seconds
};

void add_options(OptionList& options, ReportOptions& o);
int report_command(const ReportOptions& o);

}  // namespace wetcurl

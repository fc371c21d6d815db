// `wetcurl plot`: the energy of runs over time (the paper, Sec. VI.I) or the time of their frames (Fig. 40),
// the loss of trainings, an adhesion network beside Eq 11, or charts of JSON files.
#include "app/commands/plot.h"

#include <algorithm>
#include <filesystem>

#include "app/drawing/chart_file.h"
#include "app/drawing/image_file.h"
#include "app/drawing/plot_charts.h"
#include "app/files/file_kind.h"
#include "app/files/results.h"
#include "app/files/run_file.h"
#include "app/options/option_list.h"
#include "base/log.h"
#include "learn/codec/network_module.h"

namespace wetcurl {

namespace {

void check(const PlotOptions& o) {
    if (std::filesystem::path(o.output).extension() != ".png")
        throw Misuse("plot: " + (o.output.empty() ? "no output" : o.output) + ": allowed is .png");
    for (int size : {o.width, o.height})
        if (size < 240 || size > 8192)
            throw Misuse("plot: a panel of " + std::to_string(o.width) + " x " + std::to_string(o.height) +
                         " pixels; allowed are 240 to 8192 each way");
    if (o.runs.empty()) throw Misuse("plot: no file is named; wetcurl plot RUN.h5... -o out.png");
    auto inputs = o.runs;
    inputs.push_back(o.model);
    check_files(o, o.output, inputs);
}

bool is_chart(const std::string& path) { return path.ends_with(".json"); }

std::vector<Chart> charts_of(const PlotOptions& o) {
    std::vector<Chart> charts;
    for (const auto& path : o.runs)
        if (is_training_log(path) != is_training_log(o.runs[0]) || is_chart(path) != is_chart(o.runs[0]))
            throw Misuse(
                "plot: " + path + " beside " + o.runs[0] +
                "; allowed are runs, logs of trainings (.jsonl) or charts (.json): one kind in a picture");
    if (is_training_log(o.runs[0]) || is_chart(o.runs[0])) {
        if (o.time || !o.model.empty())
            throw Misuse(std::string("plot: ") + (o.time ? "--time is for runs" : "--model is for pairs") +
                         ", found " + o.runs[0]);
        for (const auto& path : o.runs)
            charts.push_back(is_chart(path) ? chart_of_file(path) : training_chart(read_training_log(path)));
        return charts;
    }
    std::vector<std::unique_ptr<RunReader>> runs;
    for (const auto& path : o.runs) {
        const FileKind kind = kind_of_file(path);
        if (kind == FileKind::model)
            throw Misuse("plot: " + path +
                         ": is a model; allowed are runs, logs of trainings, or PAIRS.h5 --model MODEL.h5");
        if (kind == FileKind::pairs) {
            if (o.runs.size() > 1 || o.time)
                throw Misuse("plot: " + path + ": is a pairs file, allowed " +
                             (o.time ? "without --time" : "alone"));
            if (o.model.empty())
                throw Misuse("plot: " + path + ": is a pairs file, which needs --model MODEL.h5 (adhesion)");
            const PairsReader pairs(path);
            return adhesion_charts(pairs, *network_module().load(o.model, "cpu", o.threads), o.model);
        }
        runs.push_back(std::make_unique<RunReader>(path));
    }
    if (!o.model.empty()) throw Misuse("plot: --model is for pairs, found a run: " + o.runs[0]);
    if (o.time) return time_charts(runs);
    for (const auto& run : runs) charts.push_back(energy_chart(*run));
    return charts;
}

}  // namespace

void add_options(OptionList& options, PlotOptions& o) {
    options
        .option(
            "runs", o.runs,
            "RUN.h5; logs of trainings: MODEL.h5.jsonl, each on its own logarithmic axis; PAIRS.h5 of codec "
            "adhesion; or charts: CHART.json {\"title\", \"x_label\", \"y_label\", \"dx\", \"curves\": "
            "[{\"name\", "
            "\"values\"}]}")
        .required();
    options.flag("--time", o.time,
                 "of runs: the time of each frame by stage, in place of energy (as in Fig. 40)");
    options
        .option("--model", o.model,
                "adhesion network to draw on PAIRS.h5: its answers against the targets, over phi/h beside "
                "Eq 11, and what each input is worth")
        .input_file();
    options.option("-o,--output", o.output, "out.png").required();
    options.option("--width", o.width, "of one panel, 240 to 8192 [pixels]").shows_default();
    options.option("--height", o.height, "of one panel, 240 to 8192 [pixels]").shows_default();
}

int plot_command(const PlotOptions& given) {
    PlotOptions o = given;
    for (auto& path : o.runs) path = run_to_read(path);
    check(o);
    write_png(o.output, draw_charts(charts_of(o), o.width, o.height), o.overwrite);
    log_info("wrote " + o.output);
    return 0;
}

}  // namespace wetcurl

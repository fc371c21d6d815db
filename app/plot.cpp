// `wetcurl plot`: the energy of runs over time (the paper, Sec. VI.I), or the loss of trainings, side by side
// on the same axes.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/chart.h"
#include "app/commands.h"
#include "app/image_file.h"
#include "app/results.h"
#include "base/log.h"
#include "base/run_cache.h"

namespace wetcurl {

namespace {

// A kind has the same colour whatever else a run has. Apart for the colour-blind: Okabe and Ito 2008.
Curve curve_of(const std::string& kind) {
    const std::vector<std::pair<std::string, Vec3f>> known{
        {"kinetic", {0.84f, 0.37f, 0.00f}}, {"gravity", {0.00f, 0.45f, 0.70f}},
        {"stretch", {0.00f, 0.62f, 0.45f}}, {"bend", {0.80f, 0.47f, 0.65f}},
        {"twist", {0.34f, 0.71f, 0.91f}},   {"core", {0.90f, 0.62f, 0.00f}},
        {"baseline", {0.45f, 0.30f, 0.75f}}};
    const auto found =
        std::find_if(known.begin(), known.end(), [&](const auto& k) { return k.first == kind; });
    Curve curve;
    curve.name = kind == "baseline" ? "wet forces" : kind;
    curve.color = found == known.end() ? Vec3f{0.55f, 0.55f, 0.55f} : found->second;
    return curve;
}

// (frame) [mJ] of each kind that a run ever has, and their sum. Gravity counts from the first frame: no
// height is nought by itself.
Chart energy_of(const RunReader& run) {
    const RunHeader& h = run.header();
    if (h.energy_kinds.empty() || run.frames() < 2)
        throw Error(run.path() + ": found " + std::to_string(run.frames()) + " frames with " +
                    std::to_string(h.energy_kinds.size()) +
                    " kinds of energy; plot draws a simulated run of two frames or more");
    Chart chart;
    chart.title = std::filesystem::path(run.path()).stem().string();
    chart.x_label = "time [s]", chart.y_label = "energy [mJ]", chart.dx = 1 / h.fps;
    for (const auto& kind : h.energy_kinds) chart.curves.push_back(curve_of(kind));
    Curve total{"total", {0.10f, 0.10f, 0.10f}, std::vector<double>(size_t(run.frames()), 0), 3};
    const auto first = run.frame(0).energy;
    for (int f = 0; f < run.frames(); ++f) {
        const auto energy = run.frame(f).energy;
        for (size_t k = 0; k < energy.size(); ++k) {
            const double from = h.energy_kinds[k] == "gravity" ? double(first[k]) : 0;
            chart.curves[k].values.push_back(1e3 * (double(energy[k]) - from));
            total.values[size_t(f)] += chart.curves[k].values.back();
        }
    }
    std::erase_if(chart.curves, [](const Curve& c) {
        return std::all_of(c.values.begin(), c.values.end(), [](double e) { return e == 0; });
    });
    chart.curves.push_back(total);
    return chart;
}

bool is_log(const std::string& path) { return path.ends_with(".jsonl"); }

// The lines of MODEL.h5.jsonl, one an epoch. What is held out is not looked at in each: the curve keeps what
// was seen last.
Chart losses_of(const std::string& path) {
    Chart chart;
    chart.title = std::filesystem::path(path).stem().string();
    chart.x_label = "epoch", chart.y_label = "loss";
    const std::pair<const char*, Curve> kinds[] = {
        {"loss", {"training", {0.00f, 0.45f, 0.70f}, {}, 2}},
        {"validation_loss", {"held out", {0.84f, 0.37f, 0.00f}, {}, 3}},
        {"base_loss", {"no network", {0.55f, 0.55f, 0.55f}, {}, 2}}};
    for (const auto& kind : kinds) chart.curves.push_back(kind.second);
    std::ifstream file(path);
    if (!file || std::filesystem::is_directory(path))
        throw Error(path + ": cannot be read (no such file, or no permission)");
    std::string line;
    long number = 0;
    for (; std::getline(file, line); ++number) {
        const Json values = Json::parse(line, nullptr, /*allow_exceptions=*/false);
        if (!values.is_object() || !values.contains("loss") || !values["loss"].is_number())
            throw Error(path + ":" + std::to_string(number + 1) +
                        ": found no line of a training's log, allowed is what train leaves beside its model");
        for (size_t k = 0; k < chart.curves.size(); ++k) {
            auto& curve = chart.curves[k].values;
            if (const auto found = values.find(kinds[k].first); found != values.end() && found->is_number())
                curve.resize(size_t(number), curve.empty() ? double(*found) : curve.back()),
                    curve.push_back(double(*found));
        }
    }
    if (number < 2)
        throw Error(path + ": found " + std::to_string(number) + " epochs, plot draws two or more");
    for (auto& curve : chart.curves)
        if (!curve.values.empty()) curve.values.resize(size_t(number), curve.values.back());
    std::erase_if(chart.curves, [](const Curve& c) { return c.values.empty(); });
    return chart;
}

}  // namespace

int plot_command(const PlotOptions& o) {
    if (std::filesystem::path(o.output).extension() != ".png")
        throw Misuse("plot: " + (o.output.empty() ? "no output" : o.output) + ": allowed is .png");
    for (int size : {o.width, o.height})
        if (size < 240 || size > 8192)
            throw Misuse("plot: a panel of " + std::to_string(o.width) + " x " + std::to_string(o.height) +
                         " pixels; allowed are 240 to 8192 each way");
    refuse_scene_options(o, "plot");
    refuse_device(o, "plot");
    check_files(o, o.output, o.runs);
    std::vector<Chart> charts;
    for (const auto& path : o.runs) {
        if (is_log(path) != is_log(o.runs[0]))
            throw Misuse("plot: " + path + " beside " + o.runs[0] +
                         "; allowed are runs or logs of trainings (.jsonl), not both on the same axes");
        charts.push_back(is_log(path) ? losses_of(path) : energy_of(RunReader(path)));
    }
    write_png(o.output, draw_charts(charts, o.width, o.height));
    log_info("wrote " + o.output);
    return 0;
}

}  // namespace wetcurl

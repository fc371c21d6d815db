// `wetcurl report`: learned beside simulated hair, as one HTML file to open and as JSON.
#include "app/commands/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "app/drawing/chart.h"
#include "app/files/run_file.h"
#include "app/files/watch_results.h"
#include "app/measures/comparison.h"
#include "app/options/option_list.h"
#include "app/report/report_page.h"
#include "app/report/report_player.h"
#include "base/config.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "base/output_file.h"
#include "base/run_cache.h"
#include "solver/scene/scene.h"

namespace wetcurl {

namespace fs = std::filesystem;

namespace {

void check(const ReportOptions& o) {
    if (o.output.empty() && o.json.empty())
        throw Misuse("report: nothing to write, -o report.html or --json FILE is needed");
    if (o.runs.empty() && o.table.empty() && o.trainings.empty())
        throw Misuse(
            "report: nothing to report on, REFERENCE.h5 OTHER.h5, --table FOLDER or --training "
            "MODEL.h5.jsonl "
            "is needed");
    if (o.runs.size() == 1)
        throw Misuse("report: found " + o.runs[0] +
                     " alone, a reference and one run or more beside it are needed");
    if (!o.output.empty() && fs::path(o.output).extension() != ".html")
        throw Misuse("report: " + o.output + ": allowed is .html");
    if (o.first_frame > 0 && o.runs.empty())
        throw Misuse("--first-frame: there is no run to leave frames out of");
    if (o.watch && (o.trainings.empty() || o.output.empty() || !o.runs.empty() || !o.table.empty()))
        throw Misuse("--watch: allowed with --training and -o, without runs or --table, which do not change");
    auto inputs = o.runs;
    inputs.push_back(o.stability);
    inputs.insert(inputs.end(), o.trainings.begin(), o.trainings.end());
    check_files(o, o.output, inputs);
}

// What `stability --json` wrote, as far as it is shown.
Json read_stability(const std::string& path) {
    if (path.empty()) return nullptr;
    std::ifstream in(path);
    if (!in) throw Error(path + ": cannot be read");
    const Json json = Json::parse(in, nullptr, false);
    const auto fail = [&](const std::string& found, const std::string& needed) {
        throw Error(path + ": found " + found + ", " + needed +
                    " is needed; `wetcurl stability --json` writes it");
    };
    if (!json.is_object() || !json.contains("cases") || !json["cases"].is_array() || json["cases"].empty())
        fail("no cases", "a list of cases");
    for (size_t k = 0; k < json["cases"].size(); ++k) {
        const Json& c = json["cases"][k];
        for (const char* key : {"id", "method", "integrator"})
            if (!c.is_object() || !c.contains(key) || !c[key].is_string())
                fail(fmt::format("cases[{}] without a text '{}'", k, key), "one");
        if (!c.contains("passed") || !c["passed"].is_boolean())
            fail(fmt::format("cases[{}] without 'passed'", k), "true or false");
    }
    return json;
}

std::string title_of(const RunHeader& header) {
    Scene scene;
    read_parameters(scene, Scene::parameters,
                    Config::parse(header.scene, scene_name(header), header.scene_folder).root());
    return scene.title;
}

FrameWatch watched(const std::string& path) {
    const RunReader run(path);
    FrameWatch watch(run.header().groom, run.header().fps);
    for (int f = 0; f < run.frames(); ++f) watch.look(f, run.frame(f));
    return watch;
}

ReportPage::Facts facts_of(const std::string& path, const FrameWatch& watch) {
    const RunReader run(path);
    const RunHeader& h = run.header();
    return {{"hash", hash_of_file(path)},
            {"method", h.method},
            {"scene", title_of(h)},
            {"frames", fmt::format("{} at {:g} a second", run.frames(), h.fps)},
            {"strands", fmt::format("{} of {} particles", h.groom.rest.count, h.groom.rest.particles)},
            {"groom", h.groom.hash()},
            {"seed", std::to_string(h.seed)},
            {"device", h.device},
            {"build", h.build},
            {"made from", fmt::format("{}", fmt::join(h.inputs, ", "))},
            {"terms", h.terms_present},
            {"largest stretch", stretch_text(watch)}};
}

// What is the same for most rows.
int scenes_of(const Rows& rows) {
    for (const Row& row : rows.all)
        if (row.of_all_scenes()) return int(row.scenes.size());
    return 1;
}

std::vector<ErrorCurve> curves_of(const Rows& rows) {
    std::vector<ErrorCurve> out;
    for (const Row& row : rows.all)
        out.push_back({row.name, row.kind, row.means.at("position_mm_per_frame").get<std::vector<double>>()});
    return out;
}

Json json_of(const TrainingLog& log) {
    Json out{{"file", log.path}, {"quantity", log.quantity}, {"unit", log.unit}, {"epochs", log.epochs}};
    for (const auto& s : log.series)
        out["series"].push_back({{"name", s.name}, {"epoch", s.epoch}, {"value", s.value}});
    return out;
}

void describe_runs(const ReportOptions& o, const std::vector<Comparison>& others, const Rows& rows,
                   const std::vector<FrameWatch>& watches, ReportPage& page) {
    const RunReader reference(o.runs[0]);
    const RunHeader& h = reference.header();
    page.curves = curves_of(rows);
    page.curve_start = h.time(o.first_frame), page.curve_step = 1 / h.fps, page.curve_unit = "time [s]";
    double most = 0;
    std::vector<std::string> names{fs::path(o.runs[0]).stem().string()};
    for (const auto& other : others) {
        most = std::max(most, other.position_mm.p95);
        names.push_back(fs::path(other.file).stem().string());
    }
    page.player = player_of(o.runs, names, o.first_frame, round_above(most));
    for (size_t k = 0; k < o.runs.size(); ++k)
        page.sources.emplace_back(o.runs[k], facts_of(o.runs[k], watches[k]));
    const std::string title = title_of(h);
    page.title = title.empty() ? fs::path(o.runs[0]).stem().string() : title;
    page.compared = fmt::format("{} {} against {} ({}): frames {} to {}, {} strands of {} particles.",
                                others.size(), others.size() == 1 ? "run" : "runs", o.runs[0], h.method,
                                o.first_frame, o.first_frame + page.player["of"]["frames"].get<int>() - 1,
                                h.groom.rest.count, h.groom.rest.particles);
}

}  // namespace

void add_options(OptionList& options, ReportOptions& o) {
    options.option("runs", o.runs, "REFERENCE.h5 OTHER.h5...");
    options.option(
        "--table", o.table,
        "comparisons over many scenes: FOLDER/ROW/SCENE.json, of compare --json; ROW@1, ROW@2: seeds of "
        "one training");
    options.option("--stability", o.stability, "what stability --json wrote");
    options.option("--training", o.trainings, "log of a training, MODEL.h5.jsonl (repeatable)").repeatable();
    options
        .option("--watch", o.watch,
                "while trainings run, rewrite the page every so many seconds; the page reloads itself")
        .within(1.0, 3600.0);
    options.option("--first-frame", o.first_frame, "leave out the frames before this one").not_negative();
    options.option("-o,--output", o.output, "o.html");
}

namespace {

// `refresh` [s]: the page loads itself anew so often; 0: never.
void write_report(const ReportOptions& o, double refresh) {
    ResultFile html(o.output, o.overwrite), results(o);
    ReportPage page;
    page.refresh = refresh;
    page.stability = read_stability(o.stability);
    std::vector<std::string> files;
    std::optional<Rows> of_table, of_runs;
    if (!o.table.empty()) of_table = rows_of(read_table(o.table, &files));
    std::vector<Comparison> others;
    if (!o.runs.empty()) {
        others = compare_runs(o.runs[0], {o.runs.begin() + 1, o.runs.end()}, o.first_frame);
        of_runs = rows_of(entries_of(o.runs[0], others));
    }
    std::vector<FrameWatch> watches;
    for (const auto& path : o.runs) {
        watches.push_back(watched(path));
        if (const std::string warning = warning_of(watches.back()); !warning.empty())
            log_warning(path + ": " + warning);
    }
    for (const auto& path : o.trainings) page.trainings.push_back(read_training_log(path));
    const Rows rows = of_table ? *of_table : of_runs ? *of_runs : Rows();

    Json json{{"reference", o.runs.empty() ? Json() : Json(o.runs[0])}};
    if (of_table) json["table"] = o.table;
    json.update(json_of(rows));
    if (of_table && of_runs) json["shown"] = json_of(*of_runs)["rows"];
    for (size_t k = 0; k < o.runs.size(); ++k)
        json["extremes"].push_back({{"file", o.runs[k]}, {"of", json_of(watches[k])}});
    json["stability"] = page.stability;
    for (const auto& log : page.trainings) json["trainings"].push_back(json_of(log));

    if (!o.output.empty()) {
        page.scenes = scenes_of(rows);
        if (of_runs) describe_runs(o, others, *of_runs, watches, page);
        if (of_table) {
            const std::string many =
                fmt::format("{} rows over {} {}, each scene against its own reference ({}).", rows.all.size(),
                            page.scenes, page.scenes == 1 ? "scene" : "scenes", o.table);
            page.compared = of_runs ? many + " Side by side: " + page.compared : many;
            if (!of_runs) {
                page.title = "Learned beside simulated hair";
                page.curves = curves_of(rows);
                page.curve_unit = "compared frame";
            }
            if (of_runs) page.shown = of_runs;
        }
        if (rows.all.empty()) {
            page.title = "Trainings";
            page.compared = fmt::format("{} {}.", page.trainings.size(),
                                        page.trainings.size() == 1 ? "training" : "trainings");
        }
        if (!o.stability.empty()) files.push_back(o.stability);
        files.insert(files.end(), o.trainings.begin(), o.trainings.end());
        for (const auto& file : files) page.files.emplace_back(file, hash_of_file(file));
        page.rows = rows;
        html.write(html_of(page));
        if (refresh == 0) log_info("wrote " + o.output);
    }
    results.write_json(json);
}

// Writes the page anew while a process writes one of the logs, and once after. Where they have no curve yet,
// it waits for one that does. Throws Interrupted after a signal.
void watch_trainings(ReportOptions o) {
    const InterruptGuard guard;
    const auto ready = [&] {
        return std::all_of(o.trainings.begin(), o.trainings.end(),
                           [](const auto& log) { return has_two_epochs(log); });
    };
    const auto going_on = [&] {
        return std::any_of(o.trainings.begin(), o.trainings.end(),
                           [](const auto& log) { return !writer_of(log).empty(); });
    };
    bool written = false;
    if (!ready()) log_info(o.trainings[0] + ": waits for the second epoch of a training");
    while (going_on() || !ready()) {
        try {
            if (ready()) {
                write_report(o, *o.watch);
                if (!written) log_info(o.output + ": follows the training; open it in a browser");
                o.overwrite = written = true;
            }
        } catch (const Error&) {
            if (ready()) throw;  // else a training that is gone on with has cut its log meanwhile
        }
        if (guard.asked())
            throw Interrupted("interrupted: " + o.output +
                              (written ? " is as the training was just now" : " is not written"));
        for (double slept = 0; slept < *o.watch && !guard.asked(); slept += 0.1)
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    write_report(o, 0);
}

}  // namespace

int report_command(const ReportOptions& given) {
    ReportOptions o = given;
    for (auto& path : o.runs) path = run_to_read(path);
    check(o);
    o.watch ? watch_trainings(o) : write_report(o, 0);
    return 0;
}

}  // namespace wetcurl

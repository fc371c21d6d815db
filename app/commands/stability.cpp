// `wetcurl stability`: the battery S1-S10 on every way of stepping, as a table and as JSON.
#include "app/commands/stability.h"

#include <fmt/format.h>
#include <omp.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "app/engine/scene_run.h"
#include "app/files/results.h"
#include "app/files/watch_results.h"
#include "app/options/option_list.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "base/progress.h"
#include "solver/scene/scene.h"
#include "solver/stability/battery.h"
#include "solver/stability/storm.h"

namespace wetcurl {

namespace {

std::vector<StabilityMethod> chosen(const std::vector<std::string>& names) {
    std::vector<std::string> known;
    for (const auto& m : stability_methods())
        if (std::find(known.begin(), known.end(), m.name) == known.end()) known.push_back(m.name);
    for (const auto& name : names)
        if (std::find(known.begin(), known.end(), name) == known.end())
            throw Misuse(fmt::format("--method: found '{}', allowed: {}{}", name, fmt::join(known, ", "),
                                     did_you_mean(name, known)));
    std::vector<StabilityMethod> out;
    for (const auto& m : stability_methods())
        if (names.empty() || std::find(names.begin(), names.end(), m.name) != names.end()) out.push_back(m);
    return out;
}

// JSON has no infinity and no NaN.
Json number(double a) { return std::isfinite(a) ? Json(a) : Json(nullptr); }
Json figures(const Figures& all) {
    Json json = Json::object();
    for (const auto& [name, value] : all) json[name] = number(value);
    return json;
}
Json json_of(const StabilityCase& c) {
    Json parameters{{"case", c.what}};
    parameters.update(figures(c.parameters));
    return {{"id", c.id},
            {"method", c.method->name},
            {"integrator", c.method->integrator},
            {"parameters", parameters},
            {"finite", c.finite},
            {"gain", number(c.gain)},
            {"energy_ratio", number(c.energy_ratio)},
            {"kinetic_ratio", number(c.kinetic_ratio)},
            {"rest_error", number(c.rest_error)},
            {"measured", figures(c.measured)},
            {"passed", c.passed}};
}

Json json_of(const SweepPoint& p, bool best) {
    return {{"method", p.method->name},   {"parameters", figures(p.at)},
            {"finite", p.finite},         {"effect", number(p.effect)},
            {"jitter", number(p.jitter)}, {"energy_ratio", number(p.energy_ratio)},
            {"holds", p.holds()},         {"best", best}};
}

std::string cell(double a) { return std::isnan(a) ? "-" : fmt::format("{:.2g}", a); }
std::string words(const Figures& all) {
    std::string text;
    for (const auto& [name, value] : all)
        text += fmt::format("{}{} {:.3g}", text.empty() ? "" : ", ", name, value);
    return text;
}
void print_row(const StabilityCase& c) {
    fmt::print("{:4} {:18} {:16} {:6} {:6} {:>8} {:>8} {:>8} {:>8}  {} ({}){}\n", c.id, c.method->name,
               c.method->integrator, c.passed ? "passed" : "FAILED", c.finite ? "finite" : "NaN",
               cell(c.gain), cell(c.energy_ratio), cell(c.kinetic_ratio), cell(c.rest_error), c.what,
               words(c.parameters), c.measured.empty() ? "" : "; " + words(c.measured));
}

// S9 waits for hair to come to rest.
void require_rest(const Scene& scene, const std::string& name) {
    const Vec3d far{0.1, 0.2, 0.3};
    const double longest = 60;  // [s] that it waits
    // Two moments that are a whole period of no usual swing apart.
    const double moved = norm(scene.motion.at(longest)(far) - scene.motion.at(longest + 0.37)(far));
    if (moved > 1e-9)
        throw Misuse(
            fmt::format("{}: its head still moves after {} s; for S9 it must come to rest before, as by "
                        "[[motion.keyframe]]",
                        name, longest));
}

// ---- random scenes

// Largest edge length of a frame over its rest length, without the run's own watch, which is judged by it.
// Infinite where a strand is not finite.
double largest_stretch(const Strands& rest, const Strands& now) {
    constexpr double least = 1e-6;  // [m] at rest
    double most = 0;
    for (int s = 0; s < now.count; ++s)
        for (int i = 0; i + 1 < now.particles; ++i) {
            const double length = norm(cast<double>(now.at(s, i + 1) - now.at(s, i))),
                         at_rest = norm(cast<double>(rest.at(s, i + 1) - rest.at(s, i)));
            most = std::max(most, std::isfinite(length) ? length / std::max(at_rest, least) : INFINITY);
        }
    return most;
}

struct StormScene {
    unsigned long long seed;
    std::string text, ended;     // "whole", "warned", "diverged", "refused" when it was read
    std::string said;            // why
    double stretch = 0;          // largest of all frames, times rest
    bool overstretched = false;  // the run says so
    // Whether an edge was longer than what the run must say, and it did not.
    bool silent() const {
        constexpr double rounding = 1e-3;
        if (ended != "whole" && ended != "warned") return false;
        return (!overstretched && stretch > (1 + rounding) * FrameWatch::warning_stretch) ||
               stretch > (1 + rounding) * Integrator().allow_stretch;
    }
};

// Where meshes of random scenes lie, as long as they are looked at.
class StormFolder {
  public:
    StormFolder()
        : path_(std::filesystem::temp_directory_path() / fmt::format("wetcurl_storm_{}", getpid())) {
        std::filesystem::create_directories(path_);
    }
    ~StormFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    std::string with(const std::map<std::string, std::string>& files) const {
        for (const auto& [name, text] : files) std::ofstream(path_ / name) << text;
        return path_.string();
    }

  private:
    std::filesystem::path path_;
};

StormScene weathered(unsigned long long seed, const StormFolder& folder) {
    const RandomScene scene = storm_scene(seed);
    StormScene out{seed, scene.text, "whole", "", 0, false};
    try {
        SceneRun run(parse_scene(scene.text, fmt::format("scene {}", seed), folder.with(scene.files)), "cpu",
                     "float", 1);
        SimulatedFrames frames(run.simulation(), run.scene().frames);
        RunFrame frame;
        try {
            while (frames.next(frame))
                out.stretch = std::max(out.stretch, largest_stretch(run.scene().groom.rest, frame.positions));
            out.said = warning_of(frames.watch()),
            out.overstretched = frames.watch().overstretched().has_value();
            if (!out.said.empty()) out.ended = "warned";
        } catch (const Diverged& e) {
            out.ended = "diverged", out.said = e.what();
        }
    } catch (const Error& e) {
        out.ended = "refused", out.said = e.what();
    }
    return out;
}

// As a table and as JSON; whether none exploded in silence.
bool weather_storm(const StabilityCommandOptions& o, ResultFile& results) {
    const InterruptGuard guard;
    std::map<std::string, int> ends{{"whole", 0}, {"warned", 0}, {"diverged", 0}, {"refused", 0}};
    Json json = Json::array();
    int silent = 0;
    const StormFolder folder;
    Progress progress("storm", o.storm, "scene");
    for (int k = 0; k < o.storm; ++k) {
        if (guard.asked()) throw Interrupted(fmt::format("interrupted after {} of {} scenes", k, o.storm));
        const StormScene scene =
            weathered((unsigned long long)(o.seed.value_or(1)) + (unsigned long long)(k), folder);
        ++ends[scene.ended];
        silent += scene.silent();
        if ((scene.silent() || scene.ended != "whole") && o.json != "-")
            fmt::print("{:8} {:10} {:8.3g} {}\n", scene.seed, scene.silent() ? "silent" : scene.ended,
                       scene.stretch, scene.said);
        Json one{{"seed", scene.seed},
                 {"ended", scene.ended},
                 {"silent", scene.silent()},
                 {"stretch", number(scene.stretch)}};
        if (!scene.said.empty()) one["said"] = scene.said, one["scene"] = scene.text;
        json.push_back(std::move(one));
        progress.update(k + 1);
    }
    if (o.json != "-")
        fmt::print(
            "{} scenes: {} whole, {} whole with a warning, {} diverged, {} refused when they were read; {} "
            "exploded "
            "in silence\n",
            o.storm, ends["whole"], ends["warned"], ends["diverged"], ends["refused"], silent);
    results.write_json({{"ends", ends}, {"silent", silent}, {"scenes", json}});
    return silent == 0;
}

}  // namespace

void add_options(OptionList& options, StabilityCommandOptions& o) {
    options
        .option("scene", o.scene,
                "scene (TOML) whose head comes to rest, for S9 in place of the battery's own")
        .input_file();
    options.option("--method", o.methods, "by name (repeatable); none: all").repeatable();
    options.option("--case", o.only, "S1 to S10 (repeatable); none: all")
        .repeatable()
        .one_of({"S1", "S2", "S3", "S4", "S5", "S6", "S7", "S8", "S9", "S10"});
    options.flag("--quick", o.quick, "fewer values of each parameter: under a minute");
    options
        .option("--storm", o.storm,
                "random scenes, so many, in place of the battery; --seed: the first one's")
        .within(1, 1'000'000);
}

int stability_command(const StabilityCommandOptions& o) {
    if (o.storm) {
        if (!o.scene.empty() || !o.methods.empty() || !o.only.empty() || o.quick || !o.set.empty())
            throw Misuse("--storm: goes with --seed, --threads and --json alone: its scenes are random");
        check_files(o, "", {});
        ResultFile results(o);
        return weather_storm(o, results) ? 0 : 1;
    }
    if (o.scene.empty()) refuse_scene_options(o, "stability without a scene");
    check_files(o, "", {o.scene});
    const auto as_listed = chosen(o.methods);
    ResultFile results_file(o);
    StabilityOptions options;
    options.quick = o.quick, options.scene = o.scene, options.set = o.set, options.only = o.only;
    if (o.seed) options.set.push_back(fmt::format("seed={}", *o.seed));
    // What is wrong with it is said now, not when S9's turn comes.
    if (!o.scene.empty()) {
        SceneOptions as_asked;
        as_asked.set = options.set;
        require_rest(load_scene(o.scene, as_asked), o.scene);
    }

    InterruptGuard guard;
    const auto go_on = [&] {
        if (guard.asked()) throw Interrupted("interrupted: the battery is judged whole, nothing is kept");
    };
    std::vector<std::vector<SweepPoint>> sweeps;
    auto methods = as_listed;  // compared ones at the best of their sweeps
    for (size_t k = 0; k < as_listed.size(); ++k)
        if (as_listed[k].compared()) {
            log_info(as_listed[k].name + ": a sweep over its own parameters");
            methods[k] = method_at(best_of(sweeps.emplace_back(swept(as_listed[k], options))));
            go_on();
        }
    std::vector<StabilityJob> jobs;
    for (const auto& m : methods)
        for (auto& job : stability_jobs(m, options)) jobs.push_back(job);
    std::vector<std::vector<StabilityCase>> results(jobs.size());
    Progress progress("stability", long(jobs.size()), "group");
    std::exception_ptr error;
    long done = 0;
    // Groups side by side: a strand is too little for two threads.
#pragma omp parallel for schedule(dynamic)
    for (size_t k = 0; k < jobs.size(); ++k) {
        if (guard.asked()) continue;
        std::exception_ptr mine;
        try {
            results[k] = jobs[k].run();
        } catch (...) {
            mine = std::current_exception();
        }
#pragma omp critical
        {
            if (mine) error = mine;
            progress.update(++done);
        }
    }
    if (error) std::rethrow_exception(error);
    go_on();

    Json json{{"cases", Json::array()}, {"summary", Json::object()}, {"sweep", Json::array()}};
    bool ours_passed = true;
    if (o.json != "-")
        fmt::print("{:4} {:18} {:16} {:6} {:6} {:>8} {:>8} {:>8} {:>8}  case\n", "id", "method", "integrator",
                   "", "", "gain", "energy", "kinetic", "rest");
    for (const auto& group : results)
        for (const auto& c : group) {
            json["cases"].push_back(json_of(c));
            Json& sum = json["summary"][c.method->name];
            if (sum.is_null()) sum = {{"passed", 0}, {"failed", 0}};
            Json& count = sum[c.passed ? "passed" : "failed"];
            count = count.get<int>() + 1;
            if (c.method->name.starts_with("ours")) ours_passed = ours_passed && c.passed;
            if (o.json != "-") print_row(c);
        }
    if (o.json != "-")
        for (const auto& [name, sum] : json["summary"].items())
            fmt::print("{}: {} passed, {} failed\n", name, sum["passed"].get<int>(),
                       sum["failed"].get<int>());
    for (const auto& points : sweeps) {
        const SweepPoint& best = best_of(points);
        if (o.json != "-")
            fmt::print("\n{} on a still wet head, best of its own: {}{}\n{:32} {:>8} {:>8} {:>8}\n",
                       best.method->name, words(best.at), best.holds() ? "" : ", though it does not hold", "",
                       "effect", "jitter", "energy");
        for (const auto& p : points) {
            json["sweep"].push_back(json_of(p, &p == &best));
            if (o.json != "-")
                fmt::print("{:32} {:>8} {:>8} {:>8}{}\n", words(p.at), cell(p.effect), cell(p.jitter),
                           cell(p.energy_ratio), p.holds() ? "  holds" : "");
        }
    }
    results_file.write_json(json);
    return ours_passed ? 0 : 1;
}

}  // namespace wetcurl

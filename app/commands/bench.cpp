// `wetcurl bench`: parts of the program and whole frames timed on this machine, as a table and as JSON.
#include "app/bench/bench.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/commands/bench.h"
#include "app/engine/device.h"
#include "app/files/results.h"
#include "app/options/option_list.h"
#include "base/interrupt.h"
#include "base/log.h"

namespace wetcurl {

namespace bench {

Times times_of(std::vector<double> seconds) {
    std::sort(seconds.begin(), seconds.end());
    const size_t n = seconds.size();
    return {0.5 * (seconds[(n - 1) / 2] + seconds[n / 2]), seconds.front(), seconds.back(), n};
}

// Repetitions until they have taken `budget` [s], or one that takes far longer.
constexpr double budget = 0.5;
constexpr size_t fewest = 3, most = 200;

Times repeated(const std::function<std::function<void()>()>& prepare) {
    const auto act = prepare();
    const auto timed = [&] {
        const double begin = omp_get_wtime();
        act();
        return omp_get_wtime() - begin;
    };
    std::vector<double> seconds{timed()};
    double spent = seconds[0];
    // The first one warms up and counts only where it is long.
    if (spent < 2 * budget) seconds.clear();
    while (spent < 4 * budget && seconds.size() < most && (seconds.size() < fewest || spent < budget)) {
        seconds.push_back(timed());
        spent += seconds.back();
    }
    return times_of(seconds);
}

namespace {

// Slope of log time over log size by least squares; of the shortest times, which other programs' load and
// the threads' waiting for one another hardly reach.
double exponent(const std::vector<const Line*>& series) {
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (const Line* line : series) {
        const double x = std::log(line->size), y = std::log(line->seconds.min);
        ++n, sx += x, sy += y, sxx += x * x, sxy += x * y;
    }
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

// Rows of one series each, in the order in which these begin.
std::vector<std::vector<const Line*>> by_series(const std::vector<Line>& lines) {
    std::vector<std::vector<const Line*>> all;
    for (const Line& line : lines) {
        auto of =
            std::find_if(all.begin(), all.end(), [&](const auto& s) { return s[0]->series == line.series; });
        if (of == all.end()) of = all.insert(all.end(), std::vector<const Line*>());
        of->push_back(&line);
    }
    return all;
}

std::string with_unit(double a, const char* unit) {
    const char* prefixes[] = {"", "k", "M", "G", "T"};
    int k = 0;
    for (; a >= 999.5 && k < 4; ++k) a /= 1000;
    return fmt::format("{:.3g} {}{}", a, prefixes[k], unit);
}

double share_of_copy(const Line& line, const Machine& machine) {
    return line.bytes / line.seconds.median / machine.copy_bytes;
}
std::optional<double> share_of_arithmetic(const Line& line, const Machine& machine) {
    if (!line.operations) return std::nullopt;
    return *line.operations / line.seconds.median / machine.operations;
}

Json json_of(const Times& t) {
    return {{"median", 1e3 * t.median}, {"min", 1e3 * t.min}, {"max", 1e3 * t.max}};
}
template <class Value>
Json json_of(const std::optional<Value>& a) {
    return a ? Json(*a) : Json(nullptr);
}
Json json_of(const Line& line, const std::string& device, const Machine& machine) {
    return {{"name", line.name},
            {"device", device},
            {"strands", json_of(line.strands)},
            {"particles_per_strand", json_of(line.particles)},
            {"milliseconds", json_of(line.seconds)},
            {"repetitions", line.seconds.count},
            {"bytes", line.bytes},
            {"operations", json_of(line.operations)},
            {"items", line.items},
            {"items_per_second", line.items / line.seconds.median},
            {"share_of_copy_bandwidth", share_of_copy(line, machine)},
            {"share_of_arithmetic_rate", json_of(share_of_arithmetic(line, machine))},
            {"bytes_per_particle", json_of(line.bytes_a_particle)},
            {"neighbours_mean", json_of(line.neighbours)},
            {"error_mm", json_of(line.error_mm)}};
}
Json json_of(const Point& p) {
    return {{"integrator", p.integrator},
            {"precision", p.precision},
            {"substeps", p.substeps},
            {"milliseconds", p.error_mm ? Json(1e3 * p.seconds.median) : Json(nullptr)},
            {"error_mm", json_of(p.error_mm)}};
}

// A column of the table; blanks where there is nothing.
std::string column(const std::optional<double>& a, int width, const char* unit = "") {
    return fmt::format("{:>{}}", a ? fmt::format("{:.3g}{}", *a, unit) : "", width);
}
std::optional<double> percent(const std::optional<double>& share) {
    return share ? std::optional(100 * *share) : std::nullopt;
}
void print_head(const Machine& m) {
    fmt::print("{}; {} threads; copies {}, multiplies and adds {}\n", m.processor, m.threads,
               with_unit(m.copy_bytes, "B/s"), with_unit(m.operations, "flop/s"));
}
void print_lines_head(size_t width) {
    fmt::print("\n{:{}} {:>9} {:>9} {:>9} {:>18} {:>8} {:>8} {:>7} {:>7} {:>7}\n", "[ms]", width, "median",
               "min", "max", "", "of copy", "of flops", "B/part.", "neighb.", "err. mm");
}
void print(const Line& line, size_t width, const Machine& machine) {
    std::string text =
        fmt::format("{:{}} {:>9.3f} {:>9.3f} {:>9.3f} {:>18} {} {} {} {} {}", line.name, width,
                    1e3 * line.seconds.median, 1e3 * line.seconds.min, 1e3 * line.seconds.max,
                    with_unit(line.items / line.seconds.median, (line.item + "s/s").c_str()),
                    column(100 * share_of_copy(line, machine), 8, " %"),
                    column(percent(share_of_arithmetic(line, machine)), 8, " %"),
                    column(line.bytes_a_particle, 7), column(line.neighbours, 7), column(line.error_mm, 7));
    text.erase(text.find_last_not_of(' ') + 1);
    fmt::print("{}\n", text);
}
void print_points_head() {
    fmt::print("\nerror against run time\n{:16} {:10} {:>8} {:>10} {:>10}\n", "integrator", "precision",
               "substeps", "frame [ms]", "error [mm]");
}
void print(const Point& p) {
    fmt::print("{:16} {:10} {:>8} {:>10} {:>10}\n", p.integrator, p.precision, p.substeps,
               p.error_mm ? fmt::format("{:.2f}", 1e3 * p.seconds.median) : "",
               p.error_mm ? fmt::format("{:.3f}", *p.error_mm) : "diverges");
}

std::vector<Entry> entries(const BenchOptions& o) {
    std::vector<Entry> all = o.device == "cpu" ? part_entries() : std::vector<Entry>();
    for (const auto& more : {frame_entries(o.device), network_entries(o.device, o.threads),
                             learned_entries(o.models, o.device, o.threads)})
        all.insert(all.end(), more.begin(), more.end());
    return all;
}

// The entries of which a name holds the filter.
std::vector<Entry> chosen(const BenchOptions& o) {
    const std::string& filter = o.filter;
    std::vector<Entry> out;
    std::vector<std::string> series;
    for (auto& entry : entries(o)) {
        auto holds = [&](const std::string& name) { return name.find(filter) != std::string::npos; };
        if (std::any_of(entry.names.begin(), entry.names.end(), holds)) out.push_back(entry);
        if (std::find(series.begin(), series.end(), entry.series) == series.end())
            series.push_back(entry.series);
    }
    if (out.empty())
        throw Misuse(fmt::format("--filter: no entry's name holds '{}'; there are {}", filter,
                                 fmt::join(series, ", ")));
    return out;
}

}  // namespace

}  // namespace bench

void add_options(OptionList& options, BenchOptions& o) {
    options.option("--filter", o.filter, "only entries whose name holds this text");
    options.option("--model", o.models, "time learned frames of this model too (repeatable)")
        .input_file()
        .repeatable();
}

int bench_command(const BenchOptions& o) {
    using namespace bench;
    require_device(o.device);
    check_files(o, "", o.models);
    const std::vector<Entry> all = chosen(o);
    ResultFile json_file(o);
    const bool table = o.json != "-";
    const Machine machine = machine_of(o.device);
    if (table) print_head(machine);
    InterruptGuard guard;
    Results results;
    std::string told;
    size_t width = 40, done = 0;
    for (const Entry& entry : all)
        for (const auto& name : entry.names) width = std::max(width, name.size());
    for (const Entry& entry : all) {
        if (guard.asked()) break;
        ++done;
        if (!entry.measure) {
            if (told != entry.absent) log_info(entry.series + ": " + entry.absent);
            told = entry.absent;
            continue;
        }
        Results found;
        entry.measure(found);
        for (const Line& line : found.lines) {
            if (line.name.find(o.filter) == std::string::npos) continue;
            if (table && results.lines.empty()) print_lines_head(width);
            if (table) print(line, width, machine);
            results.lines.push_back(line);
        }
        for (const Point& point : found.points) {
            if (table && results.points.empty()) print_points_head();
            if (table) print(point);
            results.points.push_back(point);
        }
        std::fflush(stdout);
    }
    Json json{{"machine",
               {{"processor", machine.processor},
                {"threads", machine.threads},
                {"lanes", Pack<float>::lanes},
                {"copy_bytes_per_second", machine.copy_bytes},
                {"operations_per_second", machine.operations}}},
              {"entries", Json::array()},
              {"error_against_time", Json::array()},
              {"fits", Json::array()}};
    for (const Line& line : results.lines) json["entries"].push_back(json_of(line, o.device, machine));
    for (const Point& point : results.points) json["error_against_time"].push_back(json_of(point));
    if (table) fmt::print("\n");
    for (const auto& series : by_series(results.lines)) {
        if (series.size() < 3) continue;
        const double slope = exponent(series), at_last = exponent({series.end() - 3, series.end()});
        json["fits"].push_back(
            {{"name", series[0]->series}, {"exponent", slope}, {"exponent_of_last_three", at_last}});
        if (table)
            fmt::print("{:40} time ~ size^{:.2f}, of the last three sizes ^{:.2f}\n", series[0]->series,
                       slope, at_last);
    }
    json["machine"]["peak_bytes"] = peak_bytes();
    if (done == all.size()) {
        json_file.write_json(json);
        return 0;
    }
    json_file.leave_json(json);
    const bool printed = o.json.empty() || o.json == "-" || is_stream(o.json);
    throw Interrupted(fmt::format("interrupted: {} of {} entries are {}", done, all.size(),
                                  printed ? "printed" : "kept in " + partial_of(o.json)));
}

}  // namespace wetcurl

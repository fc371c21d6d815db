// The report's HTML, section after section.
#include "app/report/report_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "app/report/markup.h"
#include "app/report/report_assets.h"

namespace wetcurl {

namespace {

// ---------------------------------------------------------------- numbers

// Three digits that count, never as a power of ten.
std::string digits(double x) {
    const double a = std::abs(x);
    return a >= 99.95    ? fmt::format("{:.0f}", x)
           : a >= 9.995  ? fmt::format("{:.1f}", x)
           : a >= 0.9995 ? fmt::format("{:.2f}", x)
                         : fmt::format("{:.3f}", x);
}

std::optional<double> at(const Json& means, const char* pointer) {
    const Json& value = means.at(Json::json_pointer(pointer));
    return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
}
std::optional<double> ratio(const Json& means, const char* a, const char* b) {
    const auto x = at(means, a), y = at(means, b);
    return x && y && *y > 0 ? std::optional(*x / *y) : std::nullopt;
}

// ---------------------------------------------------------------- the table

enum class Best { least, most, nearest_one };

// A column of numbers: two lines of heading, what it means, which value is the best, and where it is in a
// row's means: a number times `factor`, over another one where `over` names it; or what `own` takes from the
// row.
struct Column {
    const char *name, *unit, *meaning;
    Best best;
    const char* number;
    double factor = 1;
    const char* over = "";
    double (*own)(const Row&) = nullptr;

    std::optional<double> value(const Row& row) const {
        if (own) return own(row);
        const auto x = *over ? ratio(row.means, number, over) : at(row.means, number);
        return x ? std::optional(factor * *x) : std::nullopt;
    }
};

const Column columns[] = {
    {"time", "ms / frame", "run time of a frame, the low-resolution run included", Best::least,
     "/seconds_per_frame", 1e3},
    {"error", "mean mm", "distance of equal particles", Best::least, "/position_mm/mean"},
    {"", "95 % mm", "that 95 % of the distances stay below", Best::least, "/position_mm/p95"},
    {"", "max mm", "largest distance", Best::least, "/position_mm/max"},
    {"", "% length", "mean distance over the strand's length", Best::least, "/position_rel", 100},
    {"worst", "scene mm", "largest of the scenes' mean errors", Best::least, "", 1, "",
     [](const Row& r) { return r.worst_mm; }},
    {"shared", "mm", "error of strands that the low-resolution run has", Best::least,
     "/position_shared_mm/mean"},
    {"new", "mm", "error of strands that it has not", Best::least, "/position_new_mm/mean"},
    {"strands", "mm", "error of the strands before Eq 10 moves what is seen, where a run has both",
     Best::least, "/position_strands_mm"},
    {"static", "mm", "error that stands still in the head's frame", Best::least, "/position_static_mm"},
    {"dynamic", "mm", "root mean square of the error that swings", Best::least, "/position_dynamic_mm"},
    {"F1", "2 mm 20°",
     "points found within that distance and direction: harmonic mean of precision and recall", Best::most,
     "/f1_2mm_20deg"},
    {"", "3 mm 30°", "the same, wider", Best::most, "/f1_3mm_30deg"},
    {"", "4 mm 40°", "the same, wider still", Best::most, "/f1_4mm_40deg"},
    {"curvature", "error", "mean error of 1/R over mean 1/R", Best::least, "/curvature_error"},
    {"curl radius", "kept", "mean curl radius over the reference's", Best::nearest_one, "/curl_radius_ratio"},
    {"tip", "spread", "distance of neighbouring tips over the reference's", Best::nearest_one,
     "/tip_spread_ratio"},
    {"stretch", "mean %", "mean of | edge over its length at rest - 1 |", Best::least, "/stretch_mean", 100},
    {"clumps", "/ reference", "groups of tips over the reference's", Best::nearest_one, "/clumps", 1,
     "/clumps_reference"},
    {"crowd", "/ reference", "particles of other strands within 4 mm of one, over the reference's: locks",
     Best::nearest_one, "/crowd", 1, "/crowd_reference"},
    {"in solids", "%", "share of particles deeper than 0.1 mm in a solid", Best::least,
     "/penetration/fraction", 100},
    {"", "max mm", "deepest particle", Best::least, "/penetration/max_mm"},
    {"jitter", "/ reference",
     "third difference over frames while the head stands still, over the reference's", Best::nearest_one,
     "/jitter_mm", 1, "/jitter_reference_mm"},
};

// How far from the best, the less the better.
double badness(Best best, double x) {
    return best == Best::most ? -x : best == Best::nearest_one ? std::abs(x - 1) : x;
}

std::string heading(const std::string& name, const std::string& unit, const std::string& meaning) {
    return fmt::format(
        "<th scope=\"col\"{} aria-sort=\"none\"><button "
        "type=\"button\">{}<br><small>{}</small></button></th>",
        meaning.empty() ? "" : " title=\"" + escaped(meaning) + "\"", name.empty() ? "&nbsp;" : escaped(name),
        escaped(unit));
}

std::string remarks(const Row& row) {
    std::string out;
    const auto say = [&](const std::string& kind, const std::string& words) {
        out += fmt::format("<span class=\"remark {}\">{}</span>", kind, escaped(words));
    };
    if (row.seeds)
        say("", fmt::format("seeds {}: median ({}) of {} to {} mm", fmt::join(row.seeds->names, ", "),
                            row.seeds->median, digits(row.seeds->least_mm), digits(row.seeds->most_mm)));
    if (!row.lacks.empty()) say("warning", fmt::format("lacks the scenes {}", fmt::join(row.lacks, ", ")));
    if (!row.adds.empty()) say("warning", fmt::format("alone has the scenes {}", fmt::join(row.adds, ", ")));
    if (!row.verdict.empty()) say(row.wins ? (*row.wins ? "wins" : "loses") : "", row.verdict);
    return out;
}

// Rows that are not judged, in words.
std::string apart(const Rows& rows) {
    std::vector<std::string> names;
    for (const Row& row : rows.all)
        if (!row.of_all_scenes()) names.push_back(row.name);
    return names.empty() ? ""
                         : fmt::format(
                               " Of other scenes than most, so their means are not to be set beside the "
                               "others': {}.",
                               escaped(fmt::format("{}", fmt::join(names, ", "))));
}

std::string swatch(const std::string& kind) {
    return fmt::format("<i class=\"swatch {}\"></i>", escaped(kind));
}

std::string metrics_table(const Rows& rows, bool many_scenes) {
    std::string html = "<div class=\"scroll\"><table class=\"metrics sortable\">\n<thead><tr>" +
                       heading("row", "method", "name and method");
    if (many_scenes) html += heading("scenes", "number", "scenes that the means are over");
    std::vector<const Column*> used;
    for (const Column& column : columns)
        if (many_scenes || std::string(column.name) != "worst") used.push_back(&column);
    std::vector<double> best(used.size(), 1e300);
    for (size_t c = 0; c < used.size(); ++c) {
        html += heading(used[c]->name, used[c]->unit, used[c]->meaning);
        for (const Row& row : rows.all)
            if (const auto x = used[c]->value(row); x && row.of_all_scenes())
                best[c] = std::min(best[c], badness(used[c]->best, *x));
    }
    html += "</tr></thead>\n<tbody>\n";
    for (const Row& row : rows.all) {
        html += fmt::format(
            "<tr class=\"{}\"><th scope=\"row\" data-value=\"{}\"><span "
            "class=\"name\">{}<b>{}</b>{}</span><span "
            "class=\"method\">{}</span>{}</th>",
            escaped(row.kind), escaped(row.name), swatch(row.kind), escaped(row.name),
            row.on_front
                ? "<span class=\"badge\" title=\"no other row is both as near and as fast\">front</span>"
                : "",
            escaped(row.method), remarks(row));
        if (many_scenes) html += fmt::format("<td data-value=\"{0}\">{0}</td>", row.scenes.size());
        for (size_t c = 0; c < used.size(); ++c) {
            const auto x = used[c]->value(row);
            if (!x) {
                html += "<td>–</td>";
                continue;
            }
            const bool is_best =
                row.of_all_scenes() && rows.all.size() > 1 && badness(used[c]->best, *x) <= best[c];
            const bool worst = std::string(used[c]->name) == "worst";
            html +=
                fmt::format("<td data-value=\"{:.9g}\"{}>{}{}</td>", *x, is_best ? " class=\"best\"" : "",
                            digits(*x), worst ? "<br><small>" + escaped(row.worst_scene) + "</small>" : "");
        }
        html += "</tr>\n";
    }
    return html + "</tbody></table></div>\n";
}

// ---------------------------------------------------------------- sections

std::string section(const std::string& id, const std::string& title, const std::string& body) {
    return fmt::format("<section id=\"{}\"><h2>{}</h2>\n{}</section>\n", id, title, body);
}

std::string tile(const std::string& number, const std::string& words) {
    return fmt::format("<div class=\"tile\"><strong>{}</strong><p>{}</p></div>\n", number, escaped(words));
}

std::string headline(const Rows& rows) {
    const Row* learned = rows.best(true);
    if (!learned) return "";
    const Row *plain = rows.best(false), *quad = nullptr;
    for (const Row& row : rows.all)
        if (row.method == "quad interpolation" && row.of_all_scenes()) quad = &row;
    const auto times = [](double a, double b) { return digits(a / b) + " ×"; };
    std::string html;
    if (quad && quad->mm() > 0)
        html += tile(times(learned->mm(), quad->mm()),
                     fmt::format("the error of quad interpolation: {} errs by {} mm, {} by {} mm",
                                 learned->name, digits(learned->mm()), quad->name, digits(quad->mm())));
    if (plain && plain->mm() > 0 && plain->seconds() > 0)
        html +=
            tile(times(learned->mm(), plain->mm()),
                 fmt::format("the error of the best row without a network, {} ({} mm), in {} its time",
                             plain->name, digits(plain->mm()), times(learned->seconds(), plain->seconds())));
    if (rows.seconds_reference > 0)
        html += tile(
            times(learned->seconds(), rows.seconds_reference),
            fmt::format("the time of the reference's own simulation: {} takes {} a frame, the reference {}",
                        learned->name, time_text(learned->seconds()), time_text(rows.seconds_reference)));
    return html.empty() ? "" : "<div class=\"tiles\">\n" + html + "</div>\n";
}

std::string legend() {
    std::string html = "<p class=\"legend\">";
    for (const auto& [kind, words] :
         {std::pair{"learned", "learned"}, {"interpolated", "without a network"}, {"simulated", "simulated"}})
        html += fmt::format("<span>{}{}</span> ", swatch(kind), words);
    return html + "<span><i class=\"stair\"></i>Pareto front</span></p>\n";
}

std::string metrics_section(const ReportPage& page) {
    if (page.rows.all.empty()) return "";
    return section("metrics", "All numbers",
                   metrics_table(page.rows, page.scenes > 1) + "<p class=\"note\">" +
                       (page.scenes > 1 ? "Means over the scenes, of the largest values too. " : "") +
                       "The best of a column is bold. A heading sorts; held over, it says what it means." +
                       apart(page.rows) + "</p>\n");
}

std::string cost_section(const ReportPage& page) {
    const Rows& rows = page.rows;
    if (rows.all.empty()) return "";
    return section(
        "cost", "Error against run time",
        legend() + "<figure>" + cost_chart(rows) + "</figure>\n" +
            fmt::format(
                "<p class=\"note\">Hypervolume of the front: <b>{:.3f}</b> decades²; of the front without "
                "learned rows: <b>{:.3f}</b>. It is the area of all points (log<sub>10</sub> seconds a "
                "frame, "
                "log<sub>10</sub> mm) that some row is no dearer than, up to the reference point "
                "({} s a frame, {} mm): ∫∫ d log<sub>10</sub>s d log<sub>10</sub>mm. A row beyond the point "
                "in either counts for nothing; less than {} mm or {} ms counts as that much.{}</p>\n",
                rows.hypervolume, rows.hypervolume_not_learned, worst_cost.seconds, worst_cost.mm,
                best_cost.mm, 1e3 * best_cost.seconds,
                std::all_of(rows.all.begin(), rows.all.end(), [](const Row& r) { return r.of_all_scenes(); })
                    ? ""
                    : " Hollow marks are of other scenes than most rows, and are neither on the front nor "
                      "in the area."));
}

std::string error_section(const ReportPage& page) {
    if (page.curves.empty()) return "";
    return section(
        "growth", "Error over the run",
        "<figure>" + error_chart(page.curves, page.curve_start, page.curve_step, page.curve_unit) +
            "</figure>\n<p class=\"note\">Mean distance of equal particles in each frame" +
            (page.player.is_null() && page.scenes > 1 ? ", mean over the scenes up to the shortest" : "") +
            ". An error that keeps growing is carried from frame to frame.</p>\n");
}

// What was left out of the player, in words.
std::string thinned(const Json& p) {
    const auto part = [&](const char* what) {
        const int kept = p[what].get<int>(), of = p["of"][what].get<int>();
        return kept == of ? fmt::format("all {} {}", of, what) : fmt::format("{} of {} {}", kept, of, what);
    };
    const int step = p["frame_step"].get<int>();
    return fmt::format(
        "Shown are {}, {} and {}{}. Positions are rounded to 1/65535 of the box around them, {} mm. "
        "Numbers and curves above are of all.",
        part("strands"), part("particles") + " of each", part("frames"),
        step > 1 ? fmt::format(" (every {})", step == 2   ? "second"
                                              : step == 3 ? "third"
                                                          : fmt::format("{}th", step))
                 : "",
        digits(
            1e3 / 65535 *
            std::max({p["size"][0].get<double>(), p["size"][1].get<double>(), p["size"][2].get<double>()})));
}

// JSON within a script element: no text in it may end the element.
std::string data_element(const std::string& id, const Json& json) {
    std::string out = fmt::format("<script type=\"application/json\" id=\"{}\">", id);
    for (const char c : json.dump(-1, ' ', false, Json::error_handler_t::replace))
        c == '<' ? out += "\\u003c" : out += c;
    return out + "</script>\n";
}

std::string player_section(const ReportPage& page) {
    if (page.player.is_null()) return "";
    std::string panels;
    for (const auto& run : page.player["runs"])
        panels += fmt::format(
            "<figure><canvas tabindex=\"0\" aria-label=\"strands of {0}\"></canvas>"
            "<figcaption><b>{0}</b> {1}</figcaption></figure>\n",
            escaped(run["name"].get<std::string>()), escaped(run["method"].get<std::string>()));
    const bool expects = std::any_of(page.player["runs"].begin(), page.player["runs"].end(),
                                     [](const Json& run) { return !run["expected"].is_null(); });
    // Up to four stand in one row.
    const size_t runs = page.player["runs"].size();
    const std::string columns =
        runs > 4 ? "" : fmt::format(" style=\"grid-template-columns: repeat({}, minmax(0, 1fr))\"", runs);
    return section(
        "strands", "Side by side",
        (page.shown ? metrics_table(*page.shown, false) : std::string()) +
            "<div id=\"player\">\n<div class=\"controls\"><button type=\"button\" id=\"play\">Play</button>"
            "<input type=\"range\" id=\"frame\" min=\"0\" value=\"0\" aria-label=\"frame\">"
            "<output id=\"when\"></output>"
            "<span class=\"choice\" role=\"group\" aria-label=\"colour by\">"
            "<button type=\"button\" data-mode=\"saturation\" aria-pressed=\"true\">saturation</button>"
            "<button type=\"button\" data-mode=\"error\" aria-pressed=\"false\">error</button>" +
            (expects ? "<button type=\"button\" data-mode=\"expected\" aria-pressed=\"false\">"
                       "expected error</button>"
                     : "") +
            "</span>"
            "<span id=\"scale\"><span></span><canvas width=\"120\" "
            "height=\"8\"></canvas><span></span></span></div>\n"
            "<div class=\"panels\"" +
            columns + ">\n" + panels +
            "</div></div>\n<p class=\"note\">Drag to turn, wheel to zoom, double click to start over. " +
            escaped(thinned(page.player)) + "</p>\n" + data_element("player-data", page.player));
}

std::string trainings_section(const std::vector<TrainingLog>& trainings) {
    if (trainings.empty()) return "";
    std::string html = "<div class=\"trainings\">\n";
    for (const auto& log : trainings) {
        const double best = log.least("held out"), without = log.least("no network");
        const std::string at_best =
            std::isfinite(best)
                ? fmt::format("held out {:.3g} {} at best{}", best, log.unit,
                              std::isfinite(without)
                                  ? fmt::format(", {:.3g} {} without a network", without, log.unit)
                                  : "")
                : "nothing was held out";
        html += fmt::format("<figure>{}<figcaption><b>{}</b> {} epochs, {}</figcaption></figure>\n",
                            training_chart_svg(log), escaped(log.name), log.epochs, escaped(at_best));
    }
    return section("training", "Training",
                   html +
                       "</div>\n<p class=\"note\">Each on its own logarithmic axis. Held out are frames or "
                       "samples that the training does not see; without a network: the error of what the "
                       "network starts from.</p>\n");
}

std::string figure(const Json& value) {
    return value.is_number() ? fmt::format("{:.3g}", value.get<double>()) : "–";
}

constexpr std::pair<const char*, const char*> stability_numbers[] = {
    {"gain", "gain"}, {"energy_ratio", "energy"}, {"kinetic_ratio", "kinetic"}, {"rest_error", "rest"}};

std::string stability_section(const Json& stability) {
    if (stability.is_null()) return "";
    std::vector<std::string> methods;
    std::set<std::string> ids;
    for (const auto& c : stability["cases"]) {
        const auto method = c["method"].get<std::string>();
        if (std::find(methods.begin(), methods.end(), method) == methods.end()) methods.push_back(method);
        ids.insert(c["id"].get<std::string>());
    }
    std::string html =
        "<div class=\"scroll\"><table class=\"battery\"><thead><tr><th scope=\"col\">case</th>";
    for (const auto& method : methods) html += "<th scope=\"col\">" + escaped(method) + "</th>";
    html += "</tr></thead>\n<tbody>\n";
    for (const auto& id : ids) {
        html += "<tr><th scope=\"row\">" + escaped(id) + "</th>";
        for (const auto& method : methods) {
            int passed = 0, all = 0;
            std::map<std::string, double> most;  // of each number, over the cases
            for (const auto& c : stability["cases"]) {
                if (c["id"] != id || c["method"] != method) continue;
                ++all, passed += c["passed"].get<bool>();
                for (const auto& [key, name] : stability_numbers)
                    if (const Json value = c.value(key, Json()); value.is_number()) {
                        double& largest = most.emplace(name, value.get<double>()).first->second;
                        largest = std::max(largest, value.get<double>());
                    }
            }
            std::string numbers;
            for (const auto& [name, value] : most)
                numbers += fmt::format("<br><small>{} ≤ {:.2g}</small>", name, value);
            html += all == 0 ? "<td>–</td>"
                             : fmt::format("<td><span class=\"{}\">{} of {} passed</span>{}</td>",
                                           passed == all ? "passed" : "failed", passed, all, numbers);
        }
        html += "</tr>\n";
    }
    html += "</tbody></table></div>\n<details><summary>All " + std::to_string(stability["cases"].size()) +
            " cases, with their numbers</summary>\n<div class=\"scroll\"><table class=\"cases "
            "sortable\"><thead><tr>";
    for (const auto& [name, unit] : {std::pair{"case", ""},
                                     {"method", "integrator"},
                                     {"", ""},
                                     {"gain", "of noise"},
                                     {"energy", "ratio"},
                                     {"kinetic", "ratio"},
                                     {"rest", "error"},
                                     {"what", "parameters"}})
        html += heading(name, unit, "");
    html += "</tr></thead>\n<tbody>\n";
    for (const auto& c : stability["cases"]) {
        const bool passed = c["passed"].get<bool>();
        std::string what;
        const Json parameters = c.value("parameters", Json::object());  // outlives its items
        for (const auto& [name, value] : parameters.items())
            what += (what.empty() ? "" : ", ") +
                    (value.is_string() ? value.get<std::string>() : name + " " + figure(value));
        html += fmt::format(
            "<tr><th scope=\"row\">{}</th><td class=\"text\">{} <small>{}</small></td><td "
            "class=\"{}\">{}</td>",
            escaped(c["id"].get<std::string>()), escaped(c["method"].get<std::string>()),
            escaped(c.value("integrator", "")), passed ? "passed" : "failed", passed ? "passed" : "failed");
        for (const auto& [key, name] : stability_numbers)
            html += "<td>" + figure(c.value(key, Json())) + "</td>";
        html += "<td class=\"text\">" + escaped(what) + "</td></tr>\n";
    }
    return section("stability", "Stability",
                   html +
                       "</tbody></table></div></details>\n<p class=\"note\">Largest over the cases: gain of "
                       "noise at rest; energy risen over the largest kinetic energy and work; kinetic energy "
                       "over what is "
                       "allowed or over m g L; distance from the shape at rest over the length.</p>\n");
}

std::string sources_section(const ReportPage& page) {
    std::string html;
    for (const auto& [name, facts] : page.sources) {
        html += "<div><h3>" + escaped(name) + "</h3>\n<dl>";
        for (const auto& [what, value] : facts)
            if (!value.empty()) html += "<dt>" + escaped(what) + "</dt><dd>" + escaped(value) + "</dd>";
        html += "</dl></div>\n";
    }
    if (!html.empty()) html = "<div class=\"sources\">\n" + html + "</div>\n";
    if (!page.files.empty()) {
        html += fmt::format(
            "<details><summary>{} files and their hashes</summary>\n<table class=\"files\"><tbody>\n",
            page.files.size());
        for (const auto& [file, hash] : page.files)
            html += fmt::format("<tr><td class=\"text\">{}</td><td><code>{}</code></td></tr>\n",
                                escaped(file), escaped(hash));
        html += "</tbody></table></details>\n";
    }
    return section("sources", "Made from", html);
}

}  // namespace

std::string html_of(const ReportPage& page) {
    return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
           "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
           "<meta name=\"color-scheme\" content=\"light dark\">\n"
           // Nothing is fetched, whatever the page holds.
           "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
           "'unsafe-inline'; "
           "script-src 'unsafe-inline'; img-src data:\">\n" +
           (page.refresh > 0
                ? fmt::format("<meta http-equiv=\"refresh\" content=\"{:.0f}\">\n", std::ceil(page.refresh))
                : "") +
           "<title>" + escaped(page.title) + "</title>\n<style>\n" + report_style +
           "</style>\n</head>\n<body>\n<main>\n<header><h1>" + escaped(page.title) + "</h1>\n<p>" +
           escaped(page.compared) + "</p></header>\n" + headline(page.rows) + cost_section(page) +
           metrics_section(page) + error_section(page) + player_section(page) +
           trainings_section(page.trainings) + stability_section(page.stability) + sources_section(page) +
           "</main>\n<script>\n" + report_script + "</script>\n</body>\n</html>\n";
}

}  // namespace wetcurl

// Rows of a report: read, averaged, judged.
#include "app/report/report_rows.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>

#include "app/measures/comparison.h"
#include "base/error.h"

namespace wetcurl {

namespace fs = std::filesystem;

namespace {

// ---------------------------------------------------------------- reading

std::string found(const Json& parent, const std::string& key) {
    if (!parent.is_object() || !parent.contains(key)) return "nothing";
    std::string text = parent[key].dump(-1, ' ', false, Json::error_handler_t::replace);
    return text.size() > 40 ? text.substr(0, 40) + "…" : text;
}

[[noreturn]] void fail(const std::string& where, const std::string& was, const std::string& needed) {
    throw Error(where + ": found " + was + ", " + needed + " is needed; `wetcurl compare --json` writes it");
}

// The keys of `entry` that compare writes now, `like`'s: each must be there, of the same type; what may be
// null may be a number.
Json taken_like(const Json& like, const Json& entry, const std::string& where) {
    Json out = Json::object();
    for (const auto& [key, model] : like.items()) {
        const std::string at = where + "." + key;
        const Json value = entry.is_object() && entry.contains(key) ? entry[key] : Json();
        const auto need = [&, &key = key](bool holds, const char* what) {
            if (!holds) fail(at, found(entry, key), what);
        };
        if (model.is_object()) {
            need(value.is_object(), "an object");
            out[key] = taken_like(model, value, at);
            continue;
        } else if (model.is_array()) {
            const auto number = [](const Json& x) { return x.is_number(); };
            need(value.is_array() && !value.empty() && std::all_of(value.begin(), value.end(), number),
                 "a list of numbers");
        } else if (model.is_string()) {
            need(value.is_string(), "a text");
        } else if (model.is_null()) {
            need(entry.is_object() && entry.contains(key) && (value.is_null() || value.is_number()),
                 "a number or null");
        } else {
            need(value.is_number(), "a number");
        }
        out[key] = value;
    }
    return out;
}

Json read_entry(const fs::path& file) {
    std::ifstream in(file);
    if (!in) throw Error(file.string() + ": cannot be read");
    const Json json = Json::parse(in, nullptr, false);
    if (json.is_discarded()) fail(file.string(), "what is no JSON", "a comparison");
    if (!json.is_object() || !json.contains("others") || !json["others"].is_array())
        fail(file.string() + ": others", found(json, "others"), "a list of one run");
    const Json& others = json["others"];
    if (others.size() != 1)
        fail(file.string() + ": others", std::to_string(others.size()) + " runs", "a list of one run");
    const std::string where = file.string() + ": others[0]";
    // Of before it was written, all else may be there.
    if (found(others[0], "kind") == "nothing")
        throw Error(where +
                    ".kind: found nothing, needed is simulated, interpolated or learned; this is of an "
                    "older `wetcurl compare`: compare again");
    const Json entry = taken_like(json_of(Comparison()), others[0], where);
    const auto kind = entry["kind"].get<std::string>();
    if (kind != "simulated" && kind != "interpolated" && kind != "learned")
        fail(where + ".kind", "'" + kind + "'", "simulated, interpolated or learned");
    return entry;
}

// ---------------------------------------------------------------- means

// Of values of one shape: numbers, null where there is none, objects and lists of them (as long as the
// shortest). Texts are left out.
Json mean_of(const std::vector<const Json*>& all) {
    const Json& first = *all.front();
    Json out;
    if (first.is_object()) {
        out = Json::object();
        for (const auto& [key, model] : first.items()) {
            if (model.is_string()) continue;
            std::vector<const Json*> values;
            for (const Json* one : all) values.push_back(&one->at(key));
            out[key] = mean_of(values);
        }
    } else if (first.is_array()) {
        size_t shortest = first.size();
        for (const Json* one : all) shortest = std::min(shortest, one->size());
        out = Json::array();
        for (size_t k = 0; k < shortest; ++k) {
            std::vector<const Json*> values;
            for (const Json* one : all) values.push_back(&one->at(k));
            out.push_back(mean_of(values));
        }
    } else {
        double sum = 0;
        int n = 0;
        for (const Json* one : all)
            if (one->is_number()) sum += one->get<double>(), ++n;
        if (n) out = sum / n;
    }
    return out;
}

Row row_of(const std::string& name, const std::map<std::string, Json>& scenes) {
    Row row;
    row.name = name;
    std::vector<const Json*> entries;
    for (const auto& [scene, entry] : scenes) {
        const auto method = entry["method"].get<std::string>(), kind = entry["kind"].get<std::string>();
        if (row.scenes.empty()) row.method = method, row.kind = kind;
        if (method != row.method || kind != row.kind)
            throw Error(
                fmt::format("row {}, scene {}: found {} '{}', needed is {} '{}' as in scene {}: a row "
                            "is one way",
                            name, scene, kind, method, row.kind, row.method, row.scenes.front()));
        const double mm = entry["position_mm"]["mean"].get<double>();
        if (row.scenes.empty() || mm > row.worst_mm) row.worst_scene = scene, row.worst_mm = mm;
        row.scenes.push_back(scene);
        entries.push_back(&entry);
    }
    row.means = mean_of(entries);
    return row;
}

// ---------------------------------------------------------------- seeds and scenes

// NAME and K of "NAME@K"; K is empty where there is no seed.
std::pair<std::string, std::string> split_seed(const std::string& name) {
    const size_t at = name.rfind('@');
    if (at == std::string::npos || at == 0 || at + 1 == name.size() ||
        name.find_first_not_of("0123456789", at + 1) != std::string::npos)
        return {name, ""};
    return {name.substr(0, at), name.substr(at + 1)};
}

// Marks rows whose scenes are not those of most rows (of as many, the larger set).
void mark_other_scenes(std::vector<Row>& rows) {
    std::map<std::vector<std::string>, int> count;
    for (const Row& row : rows) ++count[row.scenes];
    const auto most = std::max_element(count.begin(), count.end(), [](const auto& a, const auto& b) {
        return std::pair(a.second, a.first.size()) < std::pair(b.second, b.first.size());
    });
    if (most == count.end()) return;
    for (Row& row : rows) {
        std::set_difference(most->first.begin(), most->first.end(), row.scenes.begin(), row.scenes.end(),
                            std::back_inserter(row.lacks));
        std::set_difference(row.scenes.begin(), row.scenes.end(), most->first.begin(), most->first.end(),
                            std::back_inserter(row.adds));
    }
}

void unite(std::vector<std::string>& all, const std::vector<std::string>& more) {
    std::set<std::string> names(all.begin(), all.end());
    names.insert(more.begin(), more.end());
    all.assign(names.begin(), names.end());
}

// `rows` of one network's seeds as one.
Row folded(const std::string& name, std::vector<Row> rows) {
    std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.mm() < b.mm(); });
    Row out = rows[rows.size() / 2];
    out.seeds = {.names = {},
                 .median = split_seed(out.name).second,
                 .least_mm = rows.front().mm(),
                 .most_mm = rows.back().mm()};
    out.name = name;
    for (const Row& row : rows) {
        out.seeds->names.push_back(split_seed(row.name).second);
        unite(out.lacks, row.lacks), unite(out.adds, row.adds);
    }
    std::sort(out.seeds->names.begin(), out.seeds->names.end(),
              [](const auto& a, const auto& b) { return std::pair(a.size(), a) < std::pair(b.size(), b); });
    return out;
}

std::vector<Row> with_seeds_folded(std::vector<Row> rows) {
    std::map<std::string, std::vector<Row>> networks;
    std::vector<Row> out;
    for (Row& row : rows) {
        const auto [name, seed] = split_seed(row.name);
        if (seed.empty())
            out.push_back(std::move(row));
        else
            networks[name].push_back(std::move(row));
    }
    for (const auto& [name, seeds] : networks) {
        for (const Row& row : out)
            if (row.name == name)
                throw Error(
                    fmt::format("rows {} and {}: found both, needed is one or the other: {} stands for "
                                "the median of its seeds",
                                name, seeds.front().name, name));
        out.push_back(folded(name, seeds));
    }
    return out;
}

// ---------------------------------------------------------------- judging

Cost cost_of(const Row& row) { return {row.seconds(), row.mm()}; }

void judge(Row& row, const Rows& rows) {
    if (!row.of_all_scenes()) {
        row.verdict = "not judged: its scenes are not those of most rows";
        return;
    }
    if (!row.learned()) return;
    const Row* rival = nullptr;
    for (const Row& other : rows.all)
        if (!other.learned() && other.of_all_scenes() && other.seconds() <= row.seconds() &&
            (!rival || other.mm() < rival->mm()))
            rival = &other;
    if (rival) {
        row.wins = row.mm() < rival->mm();
        row.verdict = fmt::format("{} {}, the best without a network in its time: {:.3g} mm in {}",
                                  *row.wins ? "wins over" : "does not win over", rival->name, rival->mm(),
                                  time_text(rival->seconds()));
    } else {
        row.verdict = "no row without a network takes as little time";
    }
    if (rows.seconds_reference > 0 && rows.seconds_reference <= row.seconds())
        row.verdict += "; no faster than the reference itself";
}

}  // namespace

// ---------------------------------------------------------------- what the header declares

Entries read_table(const std::string& folder, std::vector<std::string>* files) {
    if (!fs::is_directory(folder))
        throw Error(folder + ": found " + (fs::exists(folder) ? "a file" : "nothing") +
                    ", a folder of ROW/SCENE.json is needed");
    Entries out;
    std::set<fs::path> rows;
    for (const auto& entry : fs::directory_iterator(folder)) {
        if (entry.is_directory())
            rows.insert(entry.path());
        else if (entry.path().extension() == ".json")
            throw Error(entry.path().string() + ": found a file in the table's folder itself, " + folder +
                        "/ROW/SCENE.json is needed");
    }
    if (rows.empty()) throw Error(folder + ": found no folder in it, ROW/SCENE.json is needed");
    for (const auto& row : rows) {
        std::set<fs::path> scenes;
        for (const auto& entry : fs::directory_iterator(row))
            if (entry.path().extension() == ".json") scenes.insert(entry.path());
        if (scenes.empty()) throw Error(row.string() + ": found no .json in it, SCENE.json is needed");
        for (const auto& file : scenes) {
            out[row.filename().string()][file.stem().string()] = read_entry(file);
            if (files) files->push_back(file.string());
        }
    }
    return out;
}

Entries entries_of(const std::string& reference, const std::vector<Comparison>& others) {
    std::map<std::string, int> stems;
    const auto stem = [](const std::string& path) { return fs::path(path).stem().string(); };
    for (const auto& other : others) ++stems[stem(other.file)];
    Entries out;
    for (const auto& other : others)
        out[stems[stem(other.file)] > 1 ? other.file : stem(other.file)][stem(reference)] = json_of(other);
    return out;
}

const Row* Rows::best(bool learned) const {
    for (const Row& row : all)
        if (row.learned() == learned && row.of_all_scenes()) return &row;
    return nullptr;
}

Rows rows_of(const Entries& entries) {
    std::vector<Row> read;
    for (const auto& [name, scenes] : entries) read.push_back(row_of(name, scenes));
    mark_other_scenes(read);
    Rows out;
    out.all = with_seeds_folded(std::move(read));
    std::stable_sort(out.all.begin(), out.all.end(),
                     [](const Row& a, const Row& b) { return a.mm() < b.mm(); });

    std::vector<Row*> judged;
    std::vector<Cost> costs, not_learned;
    for (Row& row : out.all) {
        if (!row.of_all_scenes()) continue;
        judged.push_back(&row);
        costs.push_back(cost_of(row));
        if (!row.learned()) not_learned.push_back(cost_of(row));
    }
    for (size_t k : front_of(costs)) {
        judged[k]->on_front = true;
        out.front.push_back(judged[k]->name);
    }
    out.hypervolume = log_hypervolume(costs);
    out.hypervolume_not_learned = log_hypervolume(not_learned);
    if (!judged.empty())
        out.seconds_reference = judged.front()->means.at("seconds_per_frame_reference").get<double>();
    for (Row& row : out.all) judge(row, out);
    return out;
}

Json json_of(const Rows& rows) {
    Json list = Json::array();
    for (const Row& row : rows.all) {
        Json json{{"name", row.name},
                  {"method", row.method},
                  {"kind", row.kind},
                  {"scenes", row.scenes.size()},
                  {"lacks", row.lacks},
                  {"adds", row.adds},
                  {"worst", {{"scene", row.worst_scene}, {"position_mm", row.worst_mm}}},
                  {"seeds", nullptr}};
        if (row.seeds)
            json["seeds"] = {{"names", row.seeds->names},
                             {"median", row.seeds->median},
                             {"position_mm", {{"min", row.seeds->least_mm}, {"max", row.seeds->most_mm}}}};
        json.update(row.means);
        json["on_front"] = row.on_front;
        json["wins"] = row.wins ? Json(*row.wins) : Json(nullptr);
        json["verdict"] = row.verdict;
        list.push_back(json);
    }
    return {{"rows", list},
            {"front", rows.front},
            {"hypervolume",
             {{"all", rows.hypervolume},
              {"without_learned", rows.hypervolume_not_learned},
              {"reference_point", {{"seconds", worst_cost.seconds}, {"mm", worst_cost.mm}}}}}};
}

std::string time_text(double seconds) {
    if (seconds >= 1) return fmt::format("{:.{}f} s", seconds, seconds < 10 ? 1 : 0);
    const double ms = 1e3 * seconds;
    return fmt::format("{} ms", ms >= 100 ? fmt::format("{:.0f}", ms) : fmt::format("{:.2g}", ms));
}

}  // namespace wetcurl

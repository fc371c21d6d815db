// The rows of a report: each a way to make hair, by what it errs and takes over one scene or many, and how it
// stands to the other rows.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/files/results.h"
#include "app/measures/metrics.h"
#include "app/measures/pareto_front.h"

namespace wetcurl {

// Of each row, by its name, and scene: an entry of `others` of `compare --json`.
using Entries = std::map<std::string, std::map<std::string, Json>>;

// FOLDER/ROW/SCENE.json, each written by `compare --json` with one entry; `files`, where given, receives
// them. Throws Error, with file, what was found and what is needed, where there is no row, a row has no
// scene, or a file is malformed, of several entries, or lacks a key (as those of before `kind` do).
Entries read_table(const std::string& folder, std::vector<std::string>* files = nullptr);

// Of runs compared with one reference: rows by the stem of the file, or by its whole path where stems are
// equal; the scene bears the reference's stem.
Entries entries_of(const std::string& reference, const std::vector<Comparison>& others);

struct Row {
    std::string name, method, kind;   // kind: as kind_of says (base/run_cache.h)
    std::vector<std::string> scenes;  // sorted
    // Scenes that most rows have and this one has not, and the other way round (of any of its seeds).
    std::vector<std::string> lacks, adds;
    std::string worst_scene;
    double worst_mm = 0;
    Json means;  // the numbers of compare's entry, means over the scenes; null where no scene has one
    // Trainings of one network, rows NAME@K: the row's numbers are those of the seed whose error is the
    // median, of an even number the worse of the middle two.
    struct Seeds {
        std::vector<std::string> names;  // K, sorted
        std::string median;
        double least_mm = 0, most_mm = 0;
    };
    std::optional<Seeds> seeds;

    bool on_front = false;
    // Of a learned row: whether it errs less than every row without a network that takes no more time. None
    // where there is no such row.
    std::optional<bool> wins;
    std::string verdict;  // the same in words

    bool learned() const { return kind == "learned"; }
    bool of_all_scenes() const { return lacks.empty() && adds.empty(); }
    double mm() const { return means.at("position_mm").at("mean").get<double>(); }
    double seconds() const { return means.at("seconds_per_frame").get<double>(); }
};

// Rows by rising error, and what they leave together. Rows of other scenes than most are in neither front nor
// areas, and are not judged.
struct Rows {
    std::vector<Row> all;
    std::vector<std::string> front;                       // by rising time
    double hypervolume = 0, hypervolume_not_learned = 0;  // [decades²], app/measures/pareto_front.h
    double seconds_reference = 0;                         // a frame, as the references were simulated [s]
    const Row* best(bool learned) const;                  // of least error, null: none
};

// Throws Error where scenes of one row are of several methods, or a row is there with seeds and without.
Rows rows_of(const Entries& entries);

// {front, hypervolume, rows} as report --json has them.
Json json_of(const Rows& rows);

// "34 ms", "0.95 ms", "1.2 s".
std::string time_text(double seconds);

}  // namespace wetcurl

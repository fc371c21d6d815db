// The table [release] of a training's recipe.
#include "learn/codec/release_recipe.h"

#include <algorithm>

namespace wetcurl {

namespace {

constexpr double most = 1'000'000'000;
constexpr KeyRow from_row =
    KeyRow::path("from", "random weights",
                 "What the training begins with: a model (.h5), or the recipe (.toml) of one, which is made "
                 "first.");
constexpr KeyRow dataset_row =
    KeyRow::path("dataset", "the scenes below",
                 "Recipe of the data set, whose splits train and validation the network learns from.");
constexpr KeyRow file_row = KeyRow::path("file", "none", "A scene to simulate and learn from.");
constexpr KeyRow low_strands_row =
    KeyRow::integer("low_strands", 0, 1, most, "Strands of its dry low-resolution run, for the strand codec.")
        .without_default("the adhesion codec");
constexpr KeyRow frames_row = KeyRow::integer("frames", 0, 1, most, "Frames to simulate, with low_strands.")
                                  .without_default("the scene's");

void require_keys(const Table& table, const TableRow& row, const std::vector<std::string>& tables = {}) {
    std::vector<std::string> known = tables;
    for (const KeyRow& key : row.rows) known.push_back(key.key);
    for (const auto& key : table.keys())
        if (std::find(known.begin(), known.end(), key) == known.end())
            table.fail(key, "unknown key" + did_you_mean(key, known));
}

}  // namespace

const std::vector<TableRow>& release_tables() {
    static const std::vector<TableRow> tables = {
        {.name = "release",
         .meaning = "What `wetcurl retrain` makes for the training: a data set or runs, and the network to "
                    "go on from.",
         .rows = {from_row, dataset_row}},
        {.name = "release.scene",
         .meaning = "In place of a data set: scenes that are simulated.",
         .repeats = true,
         .rows = {file_row, low_strands_row, frames_row}}};
    return tables;
}

ReleaseRecipe read_release(const Table& root) {
    const Table table = root.table("release");
    require_keys(table, release_tables()[0], {"scene"});
    ReleaseRecipe recipe;
    recipe.present = table.present();
    recipe.dataset = table.text(dataset_row), recipe.from = table.text(from_row);
    for (const Table& scene : table.tables("scene")) {
        require_keys(scene, release_tables()[1]);
        recipe.scenes.push_back(
            {scene.text(file_row), int(scene.integer(low_strands_row)), int(scene.integer(frames_row))});
        if (recipe.scenes.back().frames && !recipe.scenes.back().low_strands)
            scene.fail("frames", "found without low_strands, which it is for");
        if (recipe.scenes.back().file.empty()) scene.fail("file", "is missing, needed is a scene (TOML)");
        if (!recipe.scenes.front().low_strands != !recipe.scenes.back().low_strands)
            scene.fail("low_strands", "found with some scenes alone, allowed is with all or none");
    }
    if (recipe.present && recipe.dataset.empty() == recipe.scenes.empty())
        root.fail("release", "found " + std::string(recipe.scenes.empty() ? "neither" : "both") +
                                 " of dataset and [[release.scene]], needed is one of them");
    return recipe;
}

}  // namespace wetcurl

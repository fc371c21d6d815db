// The table [release] of a training's recipe: what the network is trained on, and which one it goes on from.
// `wetcurl retrain` makes both; `wetcurl train`, which is given pairs and weights, only checks the table.
//
//   [release]
//   from = "strand_m.toml"    recipe of the network whose weights it begins with, or a model (.h5); absent:
//                             random ones
//   dataset = "dry.toml"      recipe of the data set, whose splits train and validation it learns from;
//                             in its place, scenes that are simulated:
//   [[release.scene]]
//   file = "scene.toml"
//   low_strands = 475         of its dry low-resolution run, codec strand; absent: codec adhesion
//   frames = 48               with low_strands: in place of the scene's
//
// Paths start at the recipe's folder.
#pragma once

#include <string>
#include <vector>

#include "base/config.h"
#include "base/rows.h"

namespace wetcurl {

struct ReleaseScene {
    std::string file;
    int low_strands = 0;  // 0: codec adhesion
    int frames = 0;       // 0: the scene's
};

struct ReleaseRecipe {
    std::string dataset, from;  // "": none
    std::vector<ReleaseScene> scenes;
    bool present = false;  // whether there is a table
};

// The tables and keys of it, for listings.
const std::vector<TableRow>& release_tables();

// Throws Misuse with file and line where the table names neither or both kinds of data, scenes for two
// codecs, or another key.
ReleaseRecipe read_release(const Table& root);

}  // namespace wetcurl

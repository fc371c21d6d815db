// The recipe of a data set: which scenes there are, each a base scene with what was picked and drawn for it.
//
// docs/recipe.md lists its keys; scenes/dataset/curls.toml is an example.
// What is drawn depends on the seed, the scene's name and the key alone.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "app/engine/scene_changes.h"
#include "base/config.h"
#include "learn/codec/root_codec.h"

namespace wetcurl {

struct DatasetMember {
    std::string name, split;                    // "train-0007", "train"
    std::string text;                           // the scene before `set`
    std::vector<std::string> set, set_by;       // what was drawn, and the recipe's line that drew it
    std::map<std::string, std::string> picked;  // the entry's name in each list
    LowResolution low;                          // which of its strands are simulated for the others
    int low_substeps = 0;                       // of them a frame; 0: as many as the scene has

    // The scene with what was picked and drawn; messages name the file and line of each value.
    Config scene() const;
    struct Replacement {
        std::string text, where;
    };
    std::shared_ptr<const Config> base;
    std::vector<Replacement> replacements;  // in the order in which they take the base scene's place
};

struct DatasetRecipe {
    bool strand = true, root = false;  // codecs
    bool low_is_wet = false, displayed = true;
    int first = 0, every = 1, together = 1;
    std::string runs;        // split whose runs are kept
    ColourBox box;           // of codec root, the same for all
    double may_diverge = 0;  // share of a split's scenes
    std::vector<DatasetMember> members;
    std::string folder;              // where the scenes' relative paths start
    std::string text;                // resolved, TOML, and hashes of the base scene and of files named
    std::vector<std::string> files;  // what it was read from
    // "recipe.toml:3: first": where messages about them point.
    std::string scene_line, first_line;

    long members_of(const std::string& split) const;
    // How many scenes of a split may be left out since they diverged.
    long may_leave_out(const std::string& split) const {
        return long(may_diverge * double(members_of(split)) + 1e-9);
    }
};

inline const std::vector<std::string> dataset_splits{"train", "validation", "test"};

// Every table and key of a recipe.
const std::vector<TableRow>& dataset_rows();

// What --set says for a scene, its path as seen from here, in place of the recipe's.
std::string assignment_of_scene(const std::string& file);

// Throws Misuse with file and line.
DatasetRecipe read_dataset_recipe(const std::string& path, const std::vector<std::string>& set);

}  // namespace wetcurl

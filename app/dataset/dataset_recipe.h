// The recipe of a data set: which scenes there are, each a base scene with what was picked and drawn for it.
//
//   scene = "base.toml"            what all scenes share
//   seed = 1
//   codecs = "strand"              strand | root | both
//   low = "dry"                    what the low-resolution run is: dry | wet
//   low_substeps = 4               its substeps a frame; 0: as many as the scene's
//   displayed = true               codec strand: the strands after cohesion as targets too
//   first = 8, every = 3           the frames that are kept as pairs, of each scene's `frames`
//   together = 1                   how many in a row are kept each time; loss.steady learns from 2 or more
//   runs = "test"                  split whose runs are kept whole too, for `infer` and `compare`; "": none
//   [splits]                       scenes of each
//   train = 400
//   validation = 32
//   test = 32
//   [draw]                         a scene's key, uniform between two values; [[low, high], ...] for a vector
//   "groom.length" = [0.15, 0.3]
//   [test_draw]                    in their place in the test split: values that training never saw
//   "groom.length" = [0.3, 0.34]
//   [[pick.motion]]                one entry of each list is picked for a scene
//   name = "turn"
//   only = "test"                  test | train (and validation); "": both
//   weight = 1                     an entry of 2 is picked twice as often
//   text = """[motion]\naxis = [0, 1, 0]"""   its tables take the place of the base scene's, as a [groom]
//   with
//                                  file = "hair.data"; [[tables]] are added to the base scene's
//   [pick.motion.draw]             drawn where the entry is picked
//   "motion.angle" = [10, 40]
//
// What is drawn depends on the seed, the scene's name and the key alone.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/config.h"
#include "learn/codec/root_codec.h"

namespace wetcurl {

struct DatasetMember {
    std::string name, split;                    // "train-0007", "train"
    std::string text;                           // the scene before `set`
    std::vector<std::string> set, set_by;       // what was drawn, and the recipe's line that drew it
    std::map<std::string, std::string> picked;  // the entry's name in each list

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
    int low_substeps = 0;
    int first = 0, every = 1, together = 1;
    std::string runs;  // split whose runs are kept
    ColourBox box;     // of codec root, the same for all
    std::vector<DatasetMember> members;
    std::string folder;              // where the scenes' relative paths start
    std::string text;                // resolved, TOML, and hashes of the base scene and of files named
    std::vector<std::string> files;  // what it was read from
    // "recipe.toml:3: first": where messages about them point.
    std::string scene_line, first_line;
};

inline const std::vector<std::string> dataset_splits{"train", "validation", "test"};

// Throws Misuse with file and line.
DatasetRecipe read_dataset_recipe(const std::string& path, const std::vector<std::string>& set);

}  // namespace wetcurl

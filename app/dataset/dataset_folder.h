// The folder of a data set: which file a scene leaves where.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "app/dataset/dataset_recipe.h"
#include "base/output_file.h"
#include "learn/codec/pairs.h"

namespace wetcurl {

class DatasetFolder {
  public:
    explicit DatasetFolder(std::string path) : path_(std::move(path)) {}
    std::string of(const std::string& name) const { return path_ + "/" + name; }
    // The pairs of a scene.
    std::string shard(const DatasetMember& m, Codec codec) const;
    // Says how a run of the scene diverged; then nothing else of it is there.
    std::string diverged(const DatasetMember& m) const;
    // All pairs of a split.
    std::string whole(const std::string& split, Codec codec) const;
    // A run of a scene, "low" or "wet".
    std::string run(const DatasetMember& m, const std::string& which) const;

  private:
    std::string path_;
};

std::vector<Codec> codecs_of(const DatasetRecipe& recipe);

// What a scene leaves behind when it is done.
std::vector<std::string> outputs_of(const DatasetRecipe& recipe, const DatasetMember& m,
                                    const DatasetFolder& to);
// It left what it leaves, or diverged and is left out.
bool is_done(const DatasetRecipe& recipe, const DatasetMember& m, const DatasetFolder& to);

// Name -> the file that is to be written there, by this process alone.
using Places = std::map<std::string, OutputFile>;
Places secured(const std::vector<std::string>& outputs);

}  // namespace wetcurl

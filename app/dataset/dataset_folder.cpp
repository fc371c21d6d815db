// The folder of a data set.
#include "app/dataset/dataset_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace wetcurl {

std::string DatasetFolder::shard(const DatasetMember& m, Codec codec) const {
    return fmt::format("{}/shards/{}_{}.h5", path_, m.name, name_of(codec));
}
std::string DatasetFolder::diverged(const DatasetMember& m) const {
    return fmt::format("{}/shards/{}_diverged.txt", path_, m.name);
}
std::string DatasetFolder::whole(const std::string& split, Codec codec) const {
    return fmt::format("{}/{}_{}.h5", path_, split, name_of(codec));
}
std::string DatasetFolder::run(const DatasetMember& m, const std::string& which) const {
    return fmt::format("{}/runs/{}_{}.h5", path_, m.name, which);
}

std::vector<Codec> codecs_of(const DatasetRecipe& recipe) {
    std::vector<Codec> out;
    if (recipe.strand) out.push_back(Codec::strand);
    if (recipe.root) out.push_back(Codec::root);
    return out;
}

std::vector<std::string> outputs_of(const DatasetRecipe& recipe, const DatasetMember& m,
                                    const DatasetFolder& to) {
    std::vector<std::string> out;
    for (Codec codec : codecs_of(recipe)) out.push_back(to.shard(m, codec));
    if (recipe.runs == m.split) out.push_back(to.run(m, "low")), out.push_back(to.run(m, "wet"));
    return out;
}

bool is_done(const DatasetRecipe& recipe, const DatasetMember& m, const DatasetFolder& to) {
    const auto outputs = outputs_of(recipe, m, to);
    return std::all_of(outputs.begin(), outputs.end(),
                       [](const auto& file) { return std::filesystem::exists(file); }) ||
           std::filesystem::exists(to.diverged(m));
}

Places secured(const std::vector<std::string>& outputs) {
    Places out;
    for (const auto& path : outputs) out.emplace(path, OutputFile(path, true));
    return out;
}

}  // namespace wetcurl

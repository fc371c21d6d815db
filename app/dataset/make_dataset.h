// A data set: the scenes of its recipe, simulated into training pairs.
#pragma once

#include <string>
#include <vector>

#include "app/options/common_options.h"
#include "base/ranks.h"

namespace wetcurl {

struct DatasetRequest : CommonOptions {
    std::string recipe, output, part;  // file, folder, "K/N"
    // --set, and a scene in place of the recipe's where one is named.
    std::string scene;
    std::vector<std::string> assignments() const;
};

// Which of how many share the work: --part K/N, or "": what a launcher of parallel programs says. Throws
// Misuse for another text.
Ranks part_of(const std::string& text);

// Makes the scenes of its part that are not there yet; who finds all of them there lists them. Throws Misuse
// for a wrong recipe, Error where a scene fails, and Interrupted after a signal.
void make_dataset(const DatasetRequest& request);

// Whether the file, which lies in a data set, says that it was made by the same recipe.
bool is_made_by(const std::string& file, const DatasetRequest& request);
// Whether all of it is there, made by the same recipe.
bool dataset_is_whole(const DatasetRequest& request);

}  // namespace wetcurl

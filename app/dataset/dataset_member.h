// One scene of a data set, simulated at both resolutions, frame by frame, to pairs.
#pragma once

#include "app/dataset/dataset_folder.h"
#include "base/interrupt.h"

namespace wetcurl {

// Reads a scene of each split and of each entry that is picked, before any is simulated: what is wrong with
// a line of the recipe is said at once.
void check_scenes(const DatasetRecipe& recipe);

// Simulates the scene and writes what it leaves behind. False: a signal asked to stop, and nothing is left
// but runs as far as they went (.partial). `device` as of --device. Throws Diverged where a run of it does.
bool make_member(const DatasetRecipe& recipe, const DatasetMember& member, const DatasetFolder& to,
                 Places places, const std::string& device, const InterruptGuard& guard);

}  // namespace wetcurl

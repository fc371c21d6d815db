// A model that a scene names and that is not there yet: the commands that make it.
#pragma once

#include <string>

#include "app/options/common_options.h"
#include "solver/scene/scene.h"

namespace wetcurl {

// The runs that a model of codec strand or root learns from.
struct RunsToLearnFrom {
    std::string scene;      // file of the wet run's scene: TOML, or a run made from it
    int strands = 0;        // of the wet run; 0: all of the scene
    std::string low;        // file of the low-resolution run; "": it is simulated
    std::string low_scene;  // then, the file of its scene
    int low_strands = 0;    // then, how many it has
    std::string codec;      // strand | root
};

// Throws Error where `model`, which `where` names, is no file; the message lists the commands that make it,
// or names the card beside it, NAME.md, that says how it was made. Options of the command line that change
// the scene (--set, --seed) are repeated in them.
void require_model_of_strands(const std::string& model, const std::string& where, const RunsToLearnFrom& runs,
                              const CommonOptions& o);
void require_model_of_adhesion(const std::string& model, const std::string& where,
                               const std::string& scene_file, const CommonOptions& o);

}  // namespace wetcurl

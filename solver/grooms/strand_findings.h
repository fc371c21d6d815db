// What looks wrong about hair when it is read, and the line that would mend each.
#pragma once

#include <string>
#include <vector>

#include "solver/grooms/import.h"
#include "solver/grooms/turns.h"

namespace wetcurl {

struct Finding {
    enum class Level { note, warning, error } level;  // error: the run would be spoilt
    const char* name;                                 // one of `names`, as `allow` takes it
    std::string text;                                 // where, and what was found
    std::string remedy;                               // the line that would mend it; may be empty

    static constexpr const char* names[] = {
        "size",          "up",           "order",          "stray_points", "point_order", "long_segments",
        "short_strands", "long_strands", "roots_off_head", "head_size",    "open_mesh",   "doubled_faces",
        "turned_faces",  "no_area",      "no_inside",      "dry_water",    "wide_radius", "few_particles"};
};
const char* name_of(Finding::Level level);
// "up: groom.data: from roots to tips the hair runs along -z; up = \"z\" in [groom], if ...".
std::string described(const Finding& finding);

// Of strands as a file gave them [m], before they are resampled. `file`: its name in messages.
std::vector<Finding> findings_of_strands(const ImportedStrands& in, const std::string& file);

// Of `particles` a strand against the turns of its curl.
Finding finding_of_turns(const CurlTurns& curl, int particles);

}  // namespace wetcurl

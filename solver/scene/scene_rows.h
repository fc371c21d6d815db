// The one list of what a scene may say: every table, and every key with kind, unit, range, default and
// meaning.
#pragma once

#include "base/rows.h"

namespace wetcurl {

// The tables in the order in which a scene names them, holders before what they hold. Chain terms and
// compared methods follow from their lists (solver/terms/list.h, solver/compared/list.h).
const std::vector<TableRow>& scene_rows();

}  // namespace wetcurl

// Runs that are looked at before they are whole.
#pragma once

#include <string>

namespace wetcurl {

// Where the run of that name can be read: there, or at PATH.partial where only that is there. Of a run that
// is not whole a line says so, and how many frames there are.
std::string run_to_read(const std::string& path);

}  // namespace wetcurl

// How often the program has asked for memory.
#pragma once

namespace wetcurl::testing {

// Calls of operator new so far, of all threads.
long allocations();

}  // namespace wetcurl::testing

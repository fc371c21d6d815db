// How strands are drawn together into locks.
#pragma once

#include <vector>

namespace wetcurl {

// What Eq 10 is asked for.
struct LockTerms {
    float reach = 0;            // h [m]
    float coherence = 0;        // length over which displacements are smoothed [m]
    float stretch = 0;          // largest strain of an edge
    std::vector<float> sweeps;  // lambda of each
    int frames = 1;             // one and those before it, over which displacements are averaged
};

}  // namespace wetcurl

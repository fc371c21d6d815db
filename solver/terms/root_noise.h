// What is random from strand to strand: a function of the seed and the root's place in the parameter square,
// so that nested grids agree.
#pragma once

#include <cmath>

#include "base/strands.h"

namespace wetcurl {

// In [0, 1). Each stream has numbers of its own.
inline double root_noise(unsigned long long seed, unsigned long long stream, double u, double v) {
    const unsigned long long bits[3] = {seed, (unsigned long long)std::llround(u * 4294967296.0),
                                        (unsigned long long)std::llround(v * 4294967296.0)};
    unsigned long long h = 0x9e3779b97f4a7c15ull + stream;
    for (auto b : bits) {  // SplitMix64 (Steele 2014)
        h += b + 0x9e3779b97f4a7c15ull;
        h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ull;
        h = (h ^ (h >> 27)) * 0x94d049bb133111ebull;
        h ^= h >> 31;
    }
    return double(h >> 11) * 0x1p-53;
}

// Calls visit(strand, u, v) for each root.
template <class Visit>
void for_each_root(const Groom& groom, Visit visit) {
    const RootGrid& grid = groom.grid;
    for (int row = 0; row < grid.height; ++row)
        for (int column = 0; column < grid.width; ++column)
            if (const int strand = grid.at(column, row); strand >= 0)
                visit(strand, double(column) / grid.width, double(row) / grid.height);
}

}  // namespace wetcurl

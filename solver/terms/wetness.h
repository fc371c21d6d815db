// Where hair is wet: saturation patterns, and the weight of the water that hair takes up. The paper, Fig 27;
// ours.
#pragma once

#include <string>
#include <vector>

#include "base/parameters.h"
#include "base/strands.h"

namespace wetcurl {

// Of hair that is as heavy when dry [kg], with the share `absorbed` of its own mass when full.
WETCURL_HD inline double wet_mass(double dry, double absorbed, float sigma) {
    return dry * (1 + absorbed * sigma);
}

struct Wetness {
    static constexpr const char *name = "wetness", *table = "wetness";
    double level, absorbed, jitter, edge, region_radius;
    std::string pattern = "uniform";  // uniform | tip | root | region | file
    Vec3d region_center{0, 0, 0};     // head's frame [m]
    std::string file;                 // a run cache whose saturation is taken
    double wet_mass(double dry, float sigma) const { return wetcurl::wet_mass(dry, absorbed, sigma); }
    static constexpr Parameter<Wetness> parameters[] = {
        {"level", &Wetness::level, "1", 1, 0, 1, "saturation sigma where the pattern is full"},
        {"absorbed", &Wetness::absorbed, "1", 0.3, 0, 10, "m_absorbed: m = m_dry (1 + sigma m_absorbed)"},
        {"jitter", &Wetness::jitter, "1", 0, 0, 1,
         "share of the saturation that varies from strand to strand"},
        {"edge", &Wetness::edge, "1", 0.5, 0, 1,
         "where along the strand (0 root, 1 tip) tip and root patterns are half full"},
        {"radius", &Wetness::region_radius, "m", 0.08, 0, 100, "of the ball that a region pattern wets"},
    };
};

inline const std::vector<std::string> wetness_patterns{"uniform", "tip", "root", "region", "file"};

// Saturation (strand, particle) in [0, 1] of the whole groom; jitter is a hash of the seed and the root's
// place in the parameter square, so that nested grids agree.
std::vector<float> saturation_of(const Wetness& wetness, const Groom& full, unsigned long long seed);

}  // namespace wetcurl

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

inline constexpr const char* wetness_patterns[] = {"uniform", "tip", "root", "region", "file"};

struct Wetness {
    static constexpr const char *name = "wetness", *table = "wetness",
                                *about = "Where the hair is wet at the start, and how much water it holds.";
    double level, absorbed, jitter, edge, region_radius;
    std::string pattern = "uniform";  // uniform | tip | root | region | file
    Vec3d region_center{0, 0, 0};     // head's frame [m]
    std::string file;                 // a run cache whose saturation is taken
    double wet_mass(double dry, float sigma) const { return wetcurl::wet_mass(dry, absorbed, sigma); }
    static constexpr Parameter<Wetness> parameters[] = {
        {KeyRow::number("level", "1", 1, 0, 1, "Saturation where the pattern is full.", "sigma"),
         &Wetness::level},
        {KeyRow::number(
             "absorbed", "1", 0.3, 0, 10,
             "Mass of the water in saturated hair by its dry mass: m = m_dry (1 + sigma absorbed).",
             "m_absorbed"),
         &Wetness::absorbed},
        {KeyRow::number("jitter", "1", 0, 0, 1, "Share of the saturation that varies from strand to strand."),
         &Wetness::jitter},
        {KeyRow::number(
             "edge", "1", 0.5, 0, 1,
             "Place along the strand (0 root, 1 tip) where the patterns tip and root are half full."),
         &Wetness::edge},
        {KeyRow::number("radius", "m", 0.08, 0, 100, "Radius of the ball that the pattern region wets."),
         &Wetness::region_radius},
        {KeyRow::numbers("center", "m", {0, 0.1, 0}, -100, 100,
                         "Centre of that ball, in the frame of the head."),
         &Wetness::region_center},
        {KeyRow::one_of(
             "pattern", wetness_patterns, "uniform",
             "Where the hair is wet: everywhere, at the tips, at the roots, in a ball, or as a run "
             "recorded it.",
             "Fig 27"),
         &Wetness::pattern},
        {KeyRow::path("file", "none",
                      "Run whose saturation the pattern file reads; it needs as many strands and "
                      "particles as the full groom."),
         &Wetness::file},
    };
};

// Saturation (strand, particle) in [0, 1] of the whole groom; jitter is a hash of the seed and the root's
// place in the parameter square, so that nested grids agree.
std::vector<float> saturation_of(const Wetness& wetness, const Groom& full, unsigned long long seed);

}  // namespace wetcurl

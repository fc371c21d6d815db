// Runs as the page's player holds them: fewer strands, particles and frames, quantised.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/files/results.h"

namespace wetcurl {

// How much of runs is kept.
struct Kept {
    int strands = 0, particles = 0, frame_step = 1, frames = 0;
    bool operator==(const Kept&) const = default;
};

// Of `runs` runs of that many frames, strands and particles: as much as `bytes` of 6 a position hold and as
// many positions in a frame as a browser draws. Strands above 300 and particles above 48, which curls need,
// are thinned out first; frames where there are more than 72 and where 200 strands of 36 particles would not
// be left.
Kept kept_of(int runs, int frames, int strands, int particles, size_t bytes = 14'000'000);

// Strands to keep, rising: spread over all of them, in no step that a grid of roots has.
std::vector<int> strands_kept(int count, int kept);

// Of the runs at `paths`, the first the reference, that are comparable (app/measures/metrics.h), frames
// `first_frame` to the end of the shortest: {fps, first_frame, frame_step, frames, strands, particles: kept,
// of {frames, strands, particles},
//  low [m], size [m] (of the box that 0..65535 spans), error_mm: what the scale of errors ends at, given,
//  runs [{name, method, positions: (frame, strand, particle, xyz) 16 bit, little endian, base64,
//         saturation: (1 or frame, strand, particle) 8 bit, base64, or null,
//         expected: what a network expects to err by, (frame, strand, particle) 8 bit, 255 error_mm or more,
//         base64, or null}],
//  solids [(frame, point, xyz) as positions]: points of the reference's solids that lie outermost}.
Json player_of(const std::vector<std::string>& paths, const std::vector<std::string>& names, int first_frame,
               double error_mm);

std::string base64(const std::vector<uint8_t>& bytes);

}  // namespace wetcurl

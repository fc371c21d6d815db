// What a model file says of itself. No torch here.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace wetcurl {

inline constexpr const char* model_format = "wetcurl model";
inline constexpr int model_version = 1;

// Of the channel multiplier: below, every layer has its fewest channels; above, no machine here holds it.
inline constexpr double smallest_width = 1e-3, largest_width = 16;

struct ModelCard {
    std::string codec;         // root | strand | adhesion
    std::string architecture;  // a name of models/registry.h
    double width = 1;          // channel multiplier
    int input_channels = 0, output_channels = 0;
    int upscale = 1;          // output pixels per input pixel, each way
    std::string target;       // codec strand: "strands", which Eq 10 follows, or "displayed", after it
    std::string low = "dry";  // what the low-resolution run is, codecs strand and root: "dry" or "wet"
    int low_substeps = 0;     // the fewest a frame of the runs that it learned from; 0: not known
    long parameters = 0;
    std::map<std::string, double> numbers;  // validation error, steps…
    // Codec strand: input_mean, input_std (input_channels), output_scale (output_channels), applied inside
    // the network; the mean of a saturation channel is the profile to fall back on; input_low, input_high
    // (input_channels), the range of what it learned from, and all there is of what it does not look at;
    // models of earlier versions have none. Codec root: b_min, b_max (3) [m].
    std::map<std::string, std::vector<float>> arrays;
    std::string recipe;  // the resolved recipe, TOML
    std::string inputs;  // "file hash" of what it was trained on, one a line
};

}  // namespace wetcurl

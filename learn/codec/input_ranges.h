// How far the inputs of a strand network lie outside the range of those that it learned from.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/network_channels.h"
#include "models/model_card.h"

namespace wetcurl {

// The smallest and the largest number of one kind of input (told_inputs) over all that was learned from.
struct InputRange {
    const char* name;
    float low, high;
};
// From -everything to everything goes what a network does not look at.
inline constexpr float everything = 1e30f;
// Of a card's arrays input_low and input_high; empty where it does not have them.
std::vector<InputRange> input_ranges(const ModelCard& card);

// An input is outside that lies farther beyond its range than this, in widths of it.
inline constexpr float within_reach = 0.02f;

class InputsOutside {
  public:
    explicit InputsOutside(const ModelCard& card);
    // Whether the card says what was learned from; nothing is outside where not.
    bool known() const { return !low_.empty(); }
    // Inputs of a frame: (strand, strand_channels).
    void add(const std::vector<float>& inputs);

    struct Kind {
        const char* name;
        double share;  // of strands and frames
        double most;   // how far beyond the range, in widths of it
    };
    // Kinds of input that were outside, those of the most strands first.
    std::vector<Kind> kinds() const;
    // Share of strands and frames of which any input was.
    double share() const { return rows_ ? double(any_) / double(rows_) : 0; }

  private:
    std::vector<float> low_, high_, per_width_;  // (strand_channels)
    std::vector<long> outside_ = std::vector<long>(told_inputs.size(), 0);
    std::vector<float> most_ = std::vector<float>(told_inputs.size(), 0.f);
    long rows_ = 0, any_ = 0;
};

}  // namespace wetcurl

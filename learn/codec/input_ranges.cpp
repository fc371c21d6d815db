// How far inputs lie outside of what was learned from.
#include "learn/codec/input_ranges.h"

#include <algorithm>
#include <cmath>

namespace wetcurl {

namespace {

// Null where the card has none for these inputs.
const std::vector<float>* array_of(const ModelCard& card, const char* name) {
    const auto found = card.arrays.find(name);
    return found != card.arrays.end() && found->second.size() == size_t(strand_channels) ? &found->second
                                                                                         : nullptr;
}

}  // namespace

std::vector<InputRange> input_ranges(const ModelCard& card) {
    const auto *low = array_of(card, "input_low"), *high = array_of(card, "input_high");
    if (!low || !high) return {};
    std::vector<InputRange> out;
    for (const InputGroup& kind : told_inputs) {
        const size_t first = size_t(kind.channels.first), end = size_t(kind.channels.end());
        out.push_back({kind.name, *std::min_element(&(*low)[first], low->data() + end),
                       *std::max_element(&(*high)[first], high->data() + end)});
    }
    return out;
}

InputsOutside::InputsOutside(const ModelCard& card) {
    const auto *low = array_of(card, "input_low"), *high = array_of(card, "input_high");
    if (!low || !high) return;
    low_ = *low, high_ = *high;
    // An input that was the same throughout is as good as itself within a hundredth, of it or of 1.
    constexpr float least = 0.01f, of_a_constant = 0.01f;
    for (size_t c = 0; c < low_.size(); ++c)
        per_width_.push_back(1 / std::max({high_[c] - low_[c], of_a_constant * std::fabs(high_[c]), least}));
}

void InputsOutside::add(const std::vector<float>& inputs) {
    if (!known()) return;
    for (size_t row = 0; row + strand_channels <= inputs.size(); row += strand_channels) {
        bool any = false;
        for (size_t k = 0; k < told_inputs.size(); ++k) {
            float beyond = 0;
            for (int c = told_inputs[k].channels.first; c < told_inputs[k].channels.end(); ++c) {
                const float x = inputs[row + size_t(c)];
                beyond = std::max(
                    beyond, std::max(low_[size_t(c)] - x, x - high_[size_t(c)]) * per_width_[size_t(c)]);
            }
            if (beyond <= within_reach) continue;
            any = true;
            ++outside_[k];
            most_[k] = std::max(most_[k], beyond);
        }
        ++rows_;
        any_ += any;
    }
}

std::vector<InputsOutside::Kind> InputsOutside::kinds() const {
    std::vector<Kind> out;
    for (size_t k = 0; k < told_inputs.size(); ++k)
        if (outside_[k])
            out.push_back({told_inputs[k].name, double(outside_[k]) / double(rows_), double(most_[k])});
    std::stable_sort(out.begin(), out.end(), [](const Kind& a, const Kind& b) { return a.share > b.share; });
    return out;
}

}  // namespace wetcurl

// The middle one of some numbers.
#pragma once

#include <algorithm>
#include <vector>

namespace wetcurl {

// Of an even count the upper one of the two in the middle; 0 of none.
inline double median(std::vector<double> numbers) {
    if (numbers.empty()) return 0;
    const auto middle = numbers.begin() + long(numbers.size() / 2);
    std::nth_element(numbers.begin(), middle, numbers.end());
    return *middle;
}

}  // namespace wetcurl

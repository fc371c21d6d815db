// Numbers as text, the shortest that reads back to the same bits; and lists of them.
#pragma once

#include <algorithm>
#include <charconv>
#include <string>
#include <vector>

namespace wetcurl {

// Appends a float, double or integer. Of floats only finite ones are numbers to other programs.
template <class T>
void append_number(std::string& text, T value) {
    char digits[32];
    const auto [end, error] = std::to_chars(digits, digits + sizeof digits, value);
    text.append(digits, end);
}
template <class T>
std::string number_text(T value) {
    std::string text;
    append_number(text, value);
    return text;
}

// "3, 7, 9 and 12 more": so many of them at most.
inline std::string listed(const std::vector<size_t>& numbers, size_t most) {
    std::string text;
    for (size_t k = 0; k < std::min(numbers.size(), most); ++k) {
        if (k) text += ", ";
        append_number(text, numbers[k]);
    }
    return text + (numbers.size() > most ? " and " + number_text(numbers.size() - most) + " more" : "");
}

}  // namespace wetcurl

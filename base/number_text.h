// Numbers as text, the shortest that reads back to the same bits.
#pragma once

#include <charconv>
#include <string>

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

}  // namespace wetcurl

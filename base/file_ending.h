// Endings of file names.
#pragma once

#include <cctype>
#include <filesystem>
#include <string>

namespace wetcurl {

// ".abc" of "hair.ABC": in small letters, with its dot; "" where there is none.
inline std::string ending_of(const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().string();
    for (char& c : ending) c = char(std::tolower(static_cast<unsigned char>(c)));
    return ending;
}

}  // namespace wetcurl

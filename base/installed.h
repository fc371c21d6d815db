// Files that are installed with the program: scenes and released networks.
#pragma once

#include <filesystem>
#include <string>

namespace wetcurl {

// The folder of what holds this code: the program, or a library that a program links.
std::filesystem::path own_folder();

// `path` where there is such a file. Else the file of that name in the folder share/wetcurl of the
// installation that the program belongs to: PREFIX/share/wetcurl/scenes/demo.toml for scenes/demo.toml.
// `path` again where neither is there, or where it is absolute.
std::string found_or_installed(const std::string& path);

}  // namespace wetcurl

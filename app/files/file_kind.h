// Which of the program's files a file is.
#pragma once

#include <string>

namespace wetcurl {

enum class FileKind { run, pairs, model };
std::string name_of(FileKind kind);

// Throws Error where the file is missing or none of these.
FileKind kind_of_file(const std::string& path);

}  // namespace wetcurl

// Git LFS pointers: what a clone without git-lfs has in the place of large files.
#pragma once

#include <fstream>
#include <string>
#include <string_view>

#include "base/error.h"

namespace wetcurl {

inline constexpr std::string_view lfs_pointer_start = "version https://git-lfs.github.com/spec/";

// Throws Error, with the way out, where these bytes of the file at `path` are a pointer.
inline void refuse_lfs_pointer(std::string_view bytes, const std::string& path) {
    if (bytes.starts_with(lfs_pointer_start))
        throw Error(path +
                    ": found a Git LFS pointer, which stands for the file; `git lfs pull` in its folder "
                    "fetches the file itself");
}
inline void refuse_lfs_pointer(const std::string& path) {
    std::string start(lfs_pointer_start.size(), '\0');
    std::ifstream(path, std::ios::binary).read(start.data(), std::streamsize(start.size()));
    refuse_lfs_pointer(start, path);
}

}  // namespace wetcurl

// Files of the installation.
#include "base/installed.h"

#include <dlfcn.h>
#include <link.h>

namespace wetcurl {

namespace fs = std::filesystem;

fs::path own_folder() {
    Dl_info info{};
    link_map* map = nullptr;
    // Of the program itself the loader's map names no file.
    if (dladdr1(reinterpret_cast<void*>(&own_folder), &info, reinterpret_cast<void**>(&map),
                RTLD_DL_LINKMAP) &&
        map && map->l_name && *map->l_name)
        return fs::canonical(map->l_name).parent_path();
    return fs::read_symlink("/proc/self/exe").parent_path();
}

std::string found_or_installed(const std::string& path) {
    std::error_code none;
    if (fs::exists(path, none) || fs::path(path).is_absolute()) return path;
    // PREFIX/bin, or deeper: PREFIX/lib/wetcurl/x86-64-v3/bin.
    for (fs::path prefix = own_folder(); prefix.has_relative_path(); prefix = prefix.parent_path())
        if (const fs::path there = prefix / "share/wetcurl" / path; fs::exists(there, none))
            return there.string();
    return path;
}

}  // namespace wetcurl

// Opens the library of the networks.
#include "learn/codec/network_module.h"

#include <dlfcn.h>

#include <filesystem>

#include "base/error.h"
#include "base/installed.h"

namespace wetcurl {
namespace {

namespace fs = std::filesystem;
constexpr const char* library_name = "libwetcurl_networks.so";
constexpr const char* entry_name = "wetcurl_network_module";

std::string library_path() {
    const fs::path folder = own_folder();
    const fs::path beside = folder / library_name,
                   installed = folder.parent_path() / WETCURL_LIBRARY_FOLDER / library_name;
    for (const auto& path : {beside, installed})
        if (fs::exists(path)) return path;
    throw Error(std::string(library_name) + ": not found in " + beside.parent_path().string() + " nor in " +
                installed.parent_path().string() + "; networks need it (build the target wetcurl_networks)");
}

NetworkModule* open_module() {
    const std::string path = library_path();
    void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!library) throw Error(path + ": does not load: " + dlerror());
    auto entry = reinterpret_cast<decltype(&wetcurl_network_module)>(dlsym(library, entry_name));
    if (!entry) throw Error(path + ": is no library of networks: it has no " + entry_name);
    return entry();  // the library stays open: LibTorch does not survive being unloaded
}

}  // namespace

NetworkModule& network_module() {
    static NetworkModule* module = open_module();
    return *module;
}

}  // namespace wetcurl

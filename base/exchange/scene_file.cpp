// Which reader and writer an ending means.
#include "base/exchange/scene_file.h"

#include <cctype>
#include <filesystem>

#include "base/error.h"
#include "base/exchange/usda.h"

namespace wetcurl {

static std::string ending_of(const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().string();
    for (char& c : ending) c = char(std::tolower(static_cast<unsigned char>(c)));
    return ending;
}

std::unique_ptr<SceneReader> open_scene_file(const std::string& path) {
    const std::string ending = ending_of(path);
    if (ending == ".usda" || ending == ".usd" || ending == ".usdc" || ending == ".usdz")
        return open_usda(path);
    throw Misuse(path + ": found the ending '" + ending + "', allowed .usda");
}

std::unique_ptr<SceneWriter> create_scene_file(const std::string& path, bool overwrite,
                                               const SceneFileSettings& settings) {
    if (ending_of(path) == ".usda") return create_usda(path, overwrite, settings);
    throw Misuse(path + ": found the ending '" + ending_of(path) + "', allowed .usda");
}

}  // namespace wetcurl

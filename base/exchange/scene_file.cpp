// Files of other programs, by their ending.
#include "base/exchange/scene_file.h"

#include <algorithm>
#include <filesystem>

#include "base/error.h"
#include "base/exchange/alembic.h"
#include "base/exchange/usda.h"

namespace wetcurl {

namespace {

// In small letters, with its dot.
std::string ending_of(const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    return ending;
}

[[noreturn]] void fail_ending(const std::string& path, const std::string& ending) {
    throw Misuse(path + ": found the ending '" + ending + "', allowed are .abc and .usda");
}

}  // namespace

std::unique_ptr<SceneReader> open_scene_file(const std::string& path) {
    const std::string ending = ending_of(path);
    if (ending == ".abc") return open_abc(path);
    if (ending == ".usda" || ending == ".usd" || ending == ".usdc" || ending == ".usdz")
        return open_usda(path);
    fail_ending(path, ending);
}

std::unique_ptr<SceneWriter> create_scene_file(const std::string& path, bool overwrite,
                                               const SceneFileSettings& settings) {
    const std::string ending = ending_of(path);
    if (ending == ".abc") return create_abc(path, overwrite, settings);
    if (ending == ".usda") return create_usda(path, overwrite, settings);
    if (ending == ".usd" || ending == ".usdc" || ending == ".usdz")
        throw Error(path +
                    ": found an ending of binary USD, allowed are .usda and .abc; `usdcat IN.usda -o " +
                    path + "`, which comes with USD, converts what was written as .usda");
    fail_ending(path, ending);
}

}  // namespace wetcurl

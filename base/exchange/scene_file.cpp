// Files of other programs, by their ending.
#include "base/exchange/scene_file.h"

#include "base/error.h"
#include "base/exchange/alembic.h"
#include "base/exchange/usda.h"
#include "base/file_ending.h"

namespace wetcurl {

namespace {

[[noreturn]] void fail_ending(const std::string& path, const std::string& ending) {
    throw Misuse(path + ": found the ending '" + ending + "', allowed are .abc and .usda");
}

// Binary files of USD are opened for the sake of what is said of them.
bool is_usd(const std::string& ending) {
    return ending == ".usda" || ending == ".usd" || ending == ".usdc" || ending == ".usdz";
}

}  // namespace

bool is_scene_file(const std::string& path) {
    const std::string ending = ending_of(path);
    return ending == ".abc" || is_usd(ending);
}

std::unique_ptr<SceneReader> open_scene_file(const std::string& path) {
    const std::string ending = ending_of(path);
    if (ending == ".abc") return open_abc(path);
    if (is_usd(ending)) return open_usda(path);
    fail_ending(path, ending);
}

std::unique_ptr<SceneWriter> create_scene_file(const std::string& path, bool overwrite,
                                               const SceneFileSettings& settings) {
    const std::string ending = ending_of(path);
    if (ending == ".abc") return create_abc(path, overwrite, settings);
    if (ending == ".usda") return create_usda(path, overwrite, settings);
    if (is_usd(ending))
        throw Error(path +
                    ": found an ending of binary USD, allowed are .usda and .abc; `usdcat IN.usda -o " +
                    path + "`, which comes with USD, converts what was written as .usda");
    fail_ending(path, ending);
}

}  // namespace wetcurl

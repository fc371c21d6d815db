// Files of other programs, by their ending.
#include "base/exchange/scene_file.h"

#include "base/error.h"
#include "base/exchange/alembic.h"
#include "base/exchange/usda.h"
#include "base/file_ending.h"
#include "base/log.h"

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

template <class Object>
std::vector<size_t> chosen_objects(const std::string& path, const std::vector<Object>& objects,
                                   const std::string& object, const std::string& what) {
    std::vector<size_t> shown, hidden;
    std::string listed;
    for (size_t k = 0; k < objects.size(); ++k) {
        const Object& o = objects[k];
        if (!object.empty() && o.path != object && !o.path.starts_with(object + "/")) continue;
        (o.hidden.empty() ? shown : hidden).push_back(k);
        if (constexpr size_t most = 12; !o.hidden.empty() && hidden.size() <= most)
            listed += (listed.empty() ? "" : ", ") +
                      (hidden.size() == most ? "..." : o.path + " (" + o.hidden + ")");
    }
    if (hidden.empty()) return shown;
    const std::string some = path + ": " + std::to_string(hidden.size()) + " " + what;
    if (shown.empty()) {
        // Who names one object knows that it is hidden.
        if (hidden.size() > 1 || object.empty())
            log_warning(some + ": the file shows none and they are read nevertheless: " + listed);
        return hidden;
    }
    log_warning(some + " left out, which the file hides: " + listed);
    return shown;
}
template std::vector<size_t> chosen_objects(const std::string&, const std::vector<CurvesObject>&,
                                            const std::string&, const std::string&);
template std::vector<size_t> chosen_objects(const std::string&, const std::vector<MeshObject>&,
                                            const std::string&, const std::string&);

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

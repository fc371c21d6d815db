// Runs that are looked at before they are whole.
#include "app/files/run_file.h"

#include <fmt/format.h>

#include <filesystem>

#include "base/log.h"
#include "base/run_cache.h"

namespace wetcurl {

std::string run_to_read(const std::string& path) {
    namespace fs = std::filesystem;
    std::error_code error;
    const bool only_partial =
        !path.empty() && !fs::exists(path, error) && fs::exists(partial_of(path), error);
    const std::string file = only_partial ? partial_of(path) : path;
    if (!file.ends_with(".h5.partial")) return file;
    try {
        const RunReader run(file);
        log_info(fmt::format(
            "{}: {}, {} whole frames are read", file,
            run.writer().empty() ? "nobody writes it any more" : "is being written by " + run.writer(),
            run.frames()));
    } catch (const Error&) {
        // Whoever reads it says why.
    }
    return file;
}

}  // namespace wetcurl

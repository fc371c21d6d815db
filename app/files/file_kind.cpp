// Tells files by their format's name.
#include "app/files/file_kind.h"

#include <limits>

#include "base/run_cache.h"
#include "learn/codec/pairs.h"

namespace wetcurl {

std::string name_of(FileKind kind) {
    return kind == FileKind::run ? "run" : kind == FileKind::pairs ? "pairs file" : "model";
}

FileKind kind_of_file(const std::string& path) {
    using Version = std::numeric_limits<int>;
    std::string reason;
    // models/model_file.h, which needs LibTorch, names the last.
    for (const auto& [kind, format] : {std::pair{FileKind::run, run_format},
                                       {FileKind::pairs, pairs_format},
                                       {FileKind::model, "wetcurl model"}})
        try {
            H5Reader(path, format, Version::max(), Version::min());
            return kind;
        } catch (const Error& e) {
            reason = e.what();
        }
    // "PATH: found ..., a '...' file is needed"
    throw Error(reason.substr(0, reason.find(", a 'wetcurl")) +
                "; allowed here are runs, pairs and models of wetcurl (.h5)");
}

}  // namespace wetcurl

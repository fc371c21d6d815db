// What a training reports.
#include "training/metrics_log.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace wetcurl {

MetricsLog::MetricsLog(const std::string& path, long position) : file_(target_of(path), path) {
    file_.cut(std::min(size_t(position), file_.size()));
}

void MetricsLog::line(const std::vector<std::pair<std::string, double>>& values) {
    nlohmann::ordered_json out;
    for (const auto& [name, value] : values)
        if (value == double(long(value)))
            out[name] = long(value);
        else
            out[name] = value;
    file_.append(out.dump() + "\n");
}

}  // namespace wetcurl

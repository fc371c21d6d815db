// What a training reports.
// Ours.
#include "training/metrics_log.h"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/error.h"

namespace wetcurl {

namespace fs = std::filesystem;

MetricsLog::MetricsLog(const std::string& path, long position) {
    std::error_code error;
    if (position > 0 && long(fs::file_size(path, error)) > position)
        fs::resize_file(path, size_t(position), error);
    file_ = std::fopen(path.c_str(), position > 0 ? "a" : "w");
    if (!file_ || error) throw Error(path + ": cannot be written");
    std::fseek(file_, 0, SEEK_END);
}

MetricsLog::~MetricsLog() {
    if (file_) std::fclose(file_);
}

void MetricsLog::line(const std::vector<std::pair<std::string, double>>& values) {
    nlohmann::ordered_json out;
    for (const auto& [name, value] : values)
        if (value == double(long(value)))
            out[name] = long(value);
        else
            out[name] = value;
    std::fputs((out.dump() + "\n").c_str(), file_);
    std::fflush(file_);
}

long MetricsLog::position() const { return std::ftell(file_); }

}  // namespace wetcurl

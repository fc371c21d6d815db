// Log lines on standard error, through spdlog.
#include "base/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>

namespace wetcurl {

static spdlog::logger& logger() {
    static auto instance = [] {
        auto made = spdlog::stderr_color_mt("wetcurl");
        made->set_pattern("%^%l%$: %v");
        return made;
    }();
    return *instance;
}

void set_log_level(LogLevel level) {
    constexpr spdlog::level::level_enum map[] = {spdlog::level::debug, spdlog::level::info,
                                                 spdlog::level::warn, spdlog::level::err, spdlog::level::off};
    logger().set_level(map[int(level)]);
}
QuietLog::QuietLog() : before_(logger().level()) {
    logger().set_level(std::max(logger().level(), spdlog::level::err));
}
QuietLog::~QuietLog() { logger().set_level(spdlog::level::level_enum(before_)); }

void log_debug(const std::string& text) { logger().debug(text); }
void log_info(const std::string& text) { logger().info(text); }
void log_warning(const std::string& text) { logger().warn(text); }

}  // namespace wetcurl

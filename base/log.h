// Log lines on standard error. No logging library's header passes through here: LibTorch carries its own fmt.
#pragma once

#include <string>

namespace wetcurl {

enum class LogLevel { debug, info, warning, error, off };
void set_log_level(LogLevel level);
void log_debug(const std::string& text);
void log_info(const std::string& text);
void log_warning(const std::string& text);

// While alive, nothing is said but errors: of what was said before.
class QuietLog {
  public:
    QuietLog();
    ~QuietLog();
    QuietLog(const QuietLog&) = delete;
    QuietLog& operator=(const QuietLog&) = delete;

  private:
    int before_;
};

}  // namespace wetcurl

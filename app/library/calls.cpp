#include "app/library/calls.h"

#include <wetcurl/api.h>

#include "base/log.h"

namespace wetcurl {

std::string& last_error() {
    thread_local std::string text;
    return text;
}

std::mutex& opening() {
    static std::mutex mutex;
    return mutex;
}

// Standard error is the other program's; what is wrong is said there all the same.
static const bool quiet = (set_log_level(LogLevel::warning), true);

}  // namespace wetcurl

const char* wetcurl_error(void) { return wetcurl::last_error().c_str(); }

// Progress on standard error.
#include "base/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace wetcurl {

static bool quiet_everywhere = false;
void Progress::set_quiet(bool quiet) { quiet_everywhere = quiet; }

Progress::Progress(std::string what, long total, std::string unit)
    : what_(std::move(what)),
      unit_(std::move(unit)),
      total_(total),
      live_(isatty(STDERR_FILENO)),
      start_(Clock::now()),
      last_(start_) {}

Progress::~Progress() {
    if (open_line_) std::fputc('\n', stderr);
}

void Progress::update(long done, const std::string& note) {
    if (quiet_everywhere) return;
    auto now = Clock::now();
    const double since_last = std::chrono::duration<double>(now - last_).count();
    const bool last = done >= total_;
    if (!last && since_last < (live_ ? 0.1 : 10.0)) return;
    last_ = now;
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    const double rate = elapsed > 0 ? done / elapsed : 0;
    const double left = rate > 0 ? (total_ - done) / rate : 0;
    std::string tail =
        fmt::format("{}/{} {}s, {:.3g} {}s/s, {} {:.0f} s{}{}", done, total_, unit_, rate, unit_,
                    last ? "took" : "left", last ? elapsed : left, note.empty() ? "" : ", ", note);
    if (live_) {
        constexpr int width = 24;
        int filled = total_ > 0 ? int(width * done / total_) : width;
        std::string bar = std::string(size_t(filled), '=') + std::string(size_t(width - filled), ' ');
        std::fputs(fmt::format("\r{} [{}] {}\033[K", what_, bar, tail).c_str(), stderr);
        open_line_ = true;
        if (last) {
            std::fputc('\n', stderr);
            open_line_ = false;
        }
    } else {
        std::fputs(fmt::format("{}: {}\n", what_, tail).c_str(), stderr);
    }
    std::fflush(stderr);
}

}  // namespace wetcurl

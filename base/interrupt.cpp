// Ctrl-C and SIGTERM.
#include "base/interrupt.h"

#include <time.h>
#include <unistd.h>

#include <atomic>

#include "base/error.h"

namespace wetcurl {

// Workers read it while another guard begins.
static std::atomic<int> asked_for = 0;
static_assert(std::atomic<int>::is_always_lock_free);  // a signal handler writes it

// Of the last signal that asked [ms]; 0: there was none.
static std::atomic<long> asked_at = 0;
static_assert(std::atomic<long>::is_always_lock_free);  // as a signal handler needs it

static long milliseconds() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return 1 + now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

// timeout(1), and shells and schedulers that end a whole group, send a process the same signal twice: to
// itself and to its group.
static bool is_the_same_again() {
    constexpr long moment = 1000;  // [ms]
    const long before = asked_at;
    return before != 0 && milliseconds() - before < moment;
}

// A path that ends with 0; it is there where `removes` is set.
static char removed_path[4096];
static volatile std::sig_atomic_t removes = 0;

// Only what a signal handler may call.
static void end_now(int) {
    if (is_the_same_again()) return;
    if (removes) unlink(removed_path);
    constexpr char text[] = "\nwetcurl: interrupted\n";
    [[maybe_unused]] const auto written = write(STDERR_FILENO, text, sizeof text - 1);
    _exit(130);
}

static void ask(int) {
    if (asked_for) return end_now(0);
    asked_for = 1;
    asked_at = milliseconds();
}

static void handle(void (*handler)(int), struct sigaction* interrupt_before,
                   struct sigaction* terminate_before) {
    struct sigaction action {};
    action.sa_handler = handler;
    action.sa_flags = SA_RESTART;  // a file being written is not cut short
    // One at a time.
    sigaddset(&action.sa_mask, SIGINT);
    sigaddset(&action.sa_mask, SIGTERM);
    sigaction(SIGINT, &action, interrupt_before);
    sigaction(SIGTERM, &action, terminate_before);
}

InterruptGuard::InterruptGuard() {
    asked_for = 0;
    asked_at = 0;
    handle(ask, &interrupt_before_, &terminate_before_);
}
InterruptGuard::~InterruptGuard() {
    sigaction(SIGINT, &interrupt_before_, nullptr);
    sigaction(SIGTERM, &terminate_before_, nullptr);
}
bool InterruptGuard::asked() { return asked_for; }

RemovedWhenInterrupted::RemovedWhenInterrupted(const std::string& path) {
    if (path.size() >= sizeof removed_path) throw Error(path + ": the path is too long");
    path.copy(removed_path, path.size());
    removed_path[path.size()] = 0;
    removes = 1;
}
RemovedWhenInterrupted::~RemovedWhenInterrupted() { removes = 0; }

void end_when_interrupted() { handle(end_now, nullptr, nullptr); }

}  // namespace wetcurl

// Ctrl-C and SIGTERM.
#include "base/interrupt.h"

#include <unistd.h>

namespace wetcurl {

static volatile std::sig_atomic_t asked_for = 0;

// Only what a signal handler may call.
static void end_now(int) {
    constexpr char text[] = "\nwetcurl: interrupted\n";
    [[maybe_unused]] const auto written = write(STDERR_FILENO, text, sizeof text - 1);
    _exit(130);
}

static void ask(int) {
    if (asked_for) end_now(0);
    asked_for = 1;
}

static void handle(void (*handler)(int), struct sigaction* interrupt_before,
                   struct sigaction* terminate_before) {
    struct sigaction action {};
    action.sa_handler = handler;
    action.sa_flags = SA_RESTART;  // a file being written is not cut short
    sigaction(SIGINT, &action, interrupt_before);
    sigaction(SIGTERM, &action, terminate_before);
}

InterruptGuard::InterruptGuard() {
    asked_for = 0;
    handle(ask, &interrupt_before_, &terminate_before_);
}
InterruptGuard::~InterruptGuard() {
    sigaction(SIGINT, &interrupt_before_, nullptr);
    sigaction(SIGTERM, &terminate_before_, nullptr);
}
bool InterruptGuard::asked() const { return asked_for; }

void end_when_interrupted() { handle(end_now, nullptr, nullptr); }

}  // namespace wetcurl

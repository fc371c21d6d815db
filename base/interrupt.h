// Ctrl-C and SIGTERM: work that has something to keep stops where it can, the rest ends at once.
#pragma once

#include <csignal>
#include <stdexcept>

namespace wetcurl {

// Work was stopped; the text says what is kept. Exit status 130.
class Interrupted : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

// While alive, the first signal asks instead of killing: the frame or step at hand is finished and what is
// there is kept. A second one within a moment (1 s) is the same one again, also just after the guard's end;
// a later one ends the program.
class InterruptGuard {
  public:
    InterruptGuard();
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;
    bool asked() const;

  private:
    struct sigaction interrupt_before_, terminate_before_;
};

// From now on a signal outside of any guard ends the program with a line on standard error and status 130.
void end_when_interrupted();

}  // namespace wetcurl

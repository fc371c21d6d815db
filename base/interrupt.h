// Ctrl-C and SIGTERM: work that has something to keep stops where it can, the rest ends at once.
#pragma once

#include <csignal>
#include <stdexcept>
#include <string>

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
    static bool asked();  // also of the last guard, once it has ended

  private:
    struct sigaction interrupt_before_, terminate_before_;
};

// From now on a signal outside of any guard ends the program with a line on standard error and status 130.
void end_when_interrupted();

// While alive, a signal that ends the program removes a file, one at a time: one that holds nothing yet.
// Throws Error for a path of 4096 bytes or more.
class RemovedWhenInterrupted {
  public:
    explicit RemovedWhenInterrupted(const std::string& path);
    ~RemovedWhenInterrupted();
    RemovedWhenInterrupted(const RemovedWhenInterrupted&) = delete;
    RemovedWhenInterrupted& operator=(const RemovedWhenInterrupted&) = delete;
};

}  // namespace wetcurl

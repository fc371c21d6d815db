// A live bar with rate and time left on a terminal, a plain line now and then elsewhere; on standard error.
#pragma once

#include <chrono>
#include <string>

namespace wetcurl {

class Progress {
  public:
    // `unit` is what is counted ("frame"); `total` how many there will be.
    Progress(std::string what, long total, std::string unit);
    ~Progress();
    // `done` counted units are finished; `note` stands at the end of the bar.
    void update(long done, const std::string& note = "");
    static void set_quiet(bool quiet);

  private:
    using Clock = std::chrono::steady_clock;
    std::string what_, unit_;
    long total_;
    bool live_;
    Clock::time_point start_, last_;
    bool open_line_ = false;
};

}  // namespace wetcurl

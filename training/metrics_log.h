// What a training reports: one JSON object a line, beside the model (MODEL.h5.jsonl).
// Ours. Apart from the loop because the JSON library and LibTorch need not meet.
#pragma once

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace wetcurl {

class MetricsLog {
  public:
    // Goes on behind the first `position` bytes of the file; what lay behind them is dropped. Throws Error
    // where it cannot be written.
    MetricsLog(const std::string& path, long position);
    ~MetricsLog();
    MetricsLog(const MetricsLog&) = delete;
    MetricsLog& operator=(const MetricsLog&) = delete;

    void line(const std::vector<std::pair<std::string, double>>& values);
    long position() const;  // [bytes]

  private:
    std::FILE* file_ = nullptr;
};

}  // namespace wetcurl

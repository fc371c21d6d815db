// What a training reports: one JSON object a line, beside the model (MODEL.h5.jsonl).
// Apart from the loop because the JSON library and LibTorch need not meet.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/output_file.h"

namespace wetcurl {

class MetricsLog {
  public:
    // Goes on behind the first `position` bytes of the file; what lay behind them is dropped. Throws Error
    // where it cannot be written, or where another process writes it.
    MetricsLog(const std::string& path, long position);

    void line(const std::vector<std::pair<std::string, double>>& values);
    long position() const { return long(file_.size()); }  // [bytes]

  private:
    LockedFile file_;
};

}  // namespace wetcurl

// What a run costs: bytes by buffer, seconds by stage.
#pragma once

#include <omp.h>

#include <string>
#include <vector>

namespace wetcurl {

struct BufferSize {
    std::string name;
    size_t bytes;
};
using BufferList = std::vector<BufferSize>;

// Appends a buffer, unless it is empty.
template <class V>
void add_buffer(BufferList& list, const std::string& name, const std::vector<V>& buffer) {
    if (!buffer.empty()) list.push_back({name, buffer.capacity() * sizeof(V)});
}

// Adds the seconds that it lives to those of a stage.
class StageTimer {
  public:
    explicit StageTimer(double& seconds) : seconds_(seconds) {}
    StageTimer(const StageTimer&) = delete;
    ~StageTimer() { seconds_ += omp_get_wtime() - begin_; }

  private:
    double& seconds_;
    const double begin_ = omp_get_wtime();
};

}  // namespace wetcurl

// What a run costs: bytes by buffer, seconds by stage.
#pragma once

#include <omp.h>

#include <string>
#include <vector>

namespace wetcurl {

// What a simulation does with a buffer.
enum class BufferUse {
    read,       // of the strands: each substep reads it
    written,    // of the strands: each substep reads and writes it
    lists,      // of neighbours, which each pass of Eq 10 reads
    displayed,  // displayed positions
    coupling,   // of what a scene names beside the strands
    scratch,    // of a thread, or on its way out
};
struct BufferSize {
    std::string name;
    size_t bytes;
    BufferUse use = BufferUse::coupling;
};
using BufferList = std::vector<BufferSize>;

// Appends a buffer, unless it is empty.
template <class V>
void add_buffer(BufferList& list, const std::string& name, const std::vector<V>& buffer,
                BufferUse use = BufferUse::coupling) {
    if (!buffer.empty()) list.push_back({name, buffer.capacity() * sizeof(V), use});
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

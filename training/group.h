// The processes that share a training, over c10d: NCCL between GPUs, Gloo between CPUs.
// All of them call the same sums in the same order.
#pragma once

#include <functional>
#include <string>

#include "base/ranks.h"
#include "models/layers.h"

namespace wetcurl {

// Where "cuda" lies for one process of several: the GPU of its number on this host. Throws Error where the
// host has fewer.
std::string device_of(const std::string& device, const Ranks& ranks);

// Whether this build can share a training on such a device.
bool can_share(torch::Device device);

class Group {
  public:
    // Meets the others at MASTER_ADDR (127.0.0.1), MASTER_PORT (29400); alone it opens nothing. All must
    // bring the same `work`: Misuse. Throws Error that names the ranks that did not come within
    // WETCURL_RENDEZVOUS_SECONDS (300), or what this build lacks for `device`.
    Group(const Ranks& ranks, torch::Device device, const std::string& work);
    ~Group();
    Group(const Group&) = delete;
    Group& operator=(const Group&) = delete;

    // Over all processes, in place, to the same bits in each; on a GPU in order with what was enqueued there.
    // Throws Error where one of them is gone: at once through Gloo; NCCL notices after minutes and ends the
    // process.
    void sum(const Tensor& values) const;
    // Until all are here.
    void wait() const;

  private:
    Ranks ranks_;
    torch::Device device_;
    std::function<void(const Tensor&)> sum_;
    std::function<void()> close_;
};

}  // namespace wetcurl

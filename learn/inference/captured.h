// Launches that are recorded once and then replayed.
#pragma once

#include <ATen/cuda/CUDAGraph.h>

#include <memory>

namespace wetcurl {

// What is captured must use the same memory whenever it is replayed.
class Captured {
  public:
    // `launch` on the current stream: as it is the first time, which warms libraries up, since that may not
    // happen while launches are captured; captured the second time; from then on replayed.
    template <class Launch>
    void run(Launch launch) {
        if (!warm_) {
            launch();
            warm_ = true;
            return;
        }
        if (!graph_) capture(launch);
        graph_->replay();
    }
    void forget() { graph_.reset(), warm_ = false; }

  private:
    template <class Launch>
    void capture(Launch launch) {
        auto graph = std::make_unique<at::cuda::CUDAGraph>();
        // Other threads may ask for memory meanwhile.
        graph->capture_begin({0, 0}, cudaStreamCaptureModeThreadLocal);
        try {
            launch();
        } catch (...) {
            try {
                graph->capture_end();
            } catch (const std::exception&) {  // what failed first is what is told
            }
            throw;
        }
        graph->capture_end();
        graph_ = std::move(graph);
    }

    std::unique_ptr<at::cuda::CUDAGraph> graph_;
    bool warm_ = false;
};

}  // namespace wetcurl

// Owners of what the driver makes.
#pragma once

#include <vector>

#include "base/device_buffer.h"

namespace wetcurl {

struct Stream {
    cudaStream_t handle = nullptr;
    Stream() { check_cuda(cudaStreamCreateWithFlags(&handle, cudaStreamNonBlocking), "stream"); }
    Stream(const Stream&) = delete;
    ~Stream() { cudaStreamDestroy(handle); }
};

struct Event {
    cudaEvent_t handle = nullptr;
    Event() { check_cuda(cudaEventCreate(&handle), "event"); }
    Event(const Event&) = delete;
    ~Event() { cudaEventDestroy(handle); }
    // Also while launches are captured.
    void record(cudaStream_t stream) const {
        cudaStreamCaptureStatus status;
        check_cuda(cudaStreamIsCapturing(stream, &status), "event");
        const bool captured = status == cudaStreamCaptureStatusActive;
        check_cuda(cudaEventRecordWithFlags(handle, stream,
                                            captured ? cudaEventRecordExternal : cudaEventRecordDefault),
                   "event");
    }
    // [s] both have passed.
    double since(const Event& before) const {
        float milliseconds = 0;
        check_cuda(cudaEventElapsedTime(&milliseconds, before.handle, handle), "time");
        return 1e-3 * milliseconds;
    }
};

// Numbers on a device and in page-locked memory of the host.
template <class V>
struct OnBoth {
    explicit OnBoth(size_t count) : device(count), host(count) {}
    // A graph that holds it reads the host's anew each time it is replayed.
    void send(cudaStream_t stream) {
        if (host.size())
            check_cuda(
                cudaMemcpyAsync(device.data(), host.data(), device.bytes(), cudaMemcpyHostToDevice, stream),
                "copy to the device");
    }
    void fetch(cudaStream_t stream) {
        if (host.size())
            check_cuda(
                cudaMemcpyAsync(host.data(), device.data(), device.bytes(), cudaMemcpyDeviceToHost, stream),
                "copy to the host");
    }
    std::vector<V> fetched() const { return {host.data(), host.data() + host.size()}; }
    DeviceBuffer<V> device;
    PinnedBuffer<V> host;
};

// The way of numbers to the host while others are computed.
class WayOut {
  public:
    // fetch(stream): copies of what is there once `from` has come here; whatever follows on `from` may be
    // done before them.
    template <class Fetch>
    void begin(cudaStream_t from, Fetch fetch) {
        there_.record(from);
        check_cuda(cudaStreamWaitEvent(stream_.handle, there_.handle, 0), "copy to the host");
        fetch(stream_.handle);
        arrived_.record(stream_.handle);
    }
    // On any thread, before the next begin.
    void wait() const { check_cuda(cudaEventSynchronize(arrived_.handle), "copy to the host"); }

  private:
    Stream stream_;
    Event there_, arrived_;
};

template <class V>
void copy_on_device(V* to, const V* from, size_t count, cudaStream_t stream) {
    check_cuda(cudaMemcpyAsync(to, from, count * sizeof(V), cudaMemcpyDeviceToDevice, stream),
               "copy on the device");
}

// Launches that are captured once, and replayed.
class Graph {
  public:
    Graph() = default;
    Graph(const Graph&) = delete;
    ~Graph() { forget(); }
    void forget() {
        if (handle_) cudaGraphExecDestroy(handle_);
        handle_ = nullptr;
    }
    // Where they are not captured yet.
    template <class Launch>
    void prepare(cudaStream_t stream, Launch launch) {
        if (handle_) return;
        cudaGraph_t captured;
        check_cuda(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal), "capture");
        launch();
        check_cuda(cudaStreamEndCapture(stream, &captured), "capture");
        const cudaError_t status = cudaGraphInstantiate(&handle_, captured, 0);
        cudaGraphDestroy(captured);
        check_cuda(status, "graph");
    }
    template <class Launch>
    void replay(cudaStream_t stream, Launch launch) {
        prepare(stream, launch);
        check_cuda(cudaGraphLaunch(handle_, stream), "launch of a graph");
    }

  private:
    cudaGraphExec_t handle_ = nullptr;
};

}  // namespace wetcurl

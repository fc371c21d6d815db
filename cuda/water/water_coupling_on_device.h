// The flow of water in a scene's hair on a device, and what of the strands follows it: as WaterCoupling.
#pragma once

#include "base/buffer_list.h"
#include "base/carried.h"
#include "cuda/device/cuda_owners.h"
#include "cuda/water/flow_kernel.h"
#include "cuda/water/soaking_device.h"
#include "solver/scene/scene.h"

namespace wetcurl {

// Of hair in the same device's memory. A frame's step is queued for its frame.
template <class H>
class WaterCouplingOnDevice {
  public:
    WaterCouplingOnDevice(const Scene& scene, H& hair)
        : flow_(*scene.flow, FlowHair(scene), scene.wetness->absorbed, scene.integrator.gravity,
                cast<float>(hair.head.translation)),
          soaking_(scene, hair.state.rest_length),
          stream_(hair.stream()) {
        flow_.restore({scene.saturation.begin(), scene.saturation.end()}, stream_);
    }

    // Of strands that are all there, by the last frame's report.
    void advance(H& hair, double time, double dt) {
        moved_ = hair.all_there();
        if (!moved_) return;
        flow_.aim(time, dt);
        hair.queue([this, &hair](cudaStream_t stream) {
            begin_.record(stream);
            flow_.launch_step(hair.seen(), stream);
            launch_soaking(hair);
            end_.record(stream);
        });
        hair.take_water();
    }
    void finish() { seconds = moved_ ? end_.since(begin_) : 0; }
    void restore(const std::vector<double>& saturation, H& hair) {
        flow_.restore(saturation, stream_);
        launch_soaking(hair);
        hair.take_water();
    }

    // The saturation is restored before.
    void save(Carried& to) const { to["water counted"] = flow_.counted(stream_); }
    void resume(const Carried& from) { flow_.count_from(from.at("water counted"), stream_); }

    // These wait for the stream.
    std::vector<double> exact() const { return flow_.exact(stream_); }
    std::vector<float> saturation() const { return flow_.shown(stream_); }
    WaterBalance balance() const { return flow_.water(stream_); }
    // This waits for its frame alone, on any thread.
    void begin_record(RunFrame&) { flow_.begin_record(stream_); }
    void finish_record(RunFrame& frame) const { flow_.finish_record(frame); }

    void list(BufferList& buffers) const {
        buffers.push_back({"flow of water", flow_.bytes()});
        buffers.push_back({"rest states dry", soaking_.bytes()});
    }
    double seconds = 0;  // in the frame at hand
    double work = 0;     // [J]: not counted here

  private:
    void launch_soaking(const H& hair) {
        soaking_.launch(flow_.saturation(), flow_.dry_mass(), hair.soaked(), stream_);
    }
    FlowDevice flow_;
    SoakingDevice soaking_;
    const cudaStream_t stream_;
    Event begin_, end_;
    bool moved_ = false;
};

}  // namespace wetcurl

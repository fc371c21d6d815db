// Hair and the air around it, each once a frame where the other is.
#pragma once

#include <vector>

#include "base/buffer_list.h"
#include "base/carried.h"
#include "solver/air/air_field.h"
#include "solver/chain/chain_state.h"

namespace wetcurl {

// Of hair in the host's memory.
template <class H>
class AirCoupling {
  public:
    // For a scene with [air], which must outlive it; the hair feels the air where it is.
    AirCoupling(const Scene& scene, H& hair) : scene_(scene), field_(*scene.air) {
        if (scene.air->two_way) hair_.resize(scene.groom.rest.points.size());
        sample(hair.state);
    }
    // A frame of dt [s] from `time` on. Once a frame: a step of the air costs more than a substep of the
    // strands, it is stable at any length, and a block of strands still goes through all substeps of a frame
    // at once.
    void advance(H& hair, double time, double dt) {
        const StageTimer timer(seconds);
        if (scene_.air->two_way) gather(hair.state);
        field_.step(dt, time + dt, hair_);
        sample(hair.state);
    }
    void finish() {}  // once the frame is shown
    // What the hair feels is sampled anew when a frame begins.
    void save(Carried& to) const {
        for (int axis = 0; axis < 3; ++axis)
            to[air_component_names[axis]] = field_.velocities()[size_t(axis)];
    }
    void resume(const Carried& from) {
        for (int axis = 0; axis < 3; ++axis) field_.blow_as(axis, from.at(air_component_names[axis]));
    }
    void list(BufferList& buffers) const {
        buffers.push_back({"air", field_.bytes()}), add_buffer(buffers, "hair in the air", hair_);
    }
    double seconds = 0;  // in the frame at hand

  private:
    // What the strands feel of the air, where they are now.
    void sample(auto& state) const {
        state.for_each_lane([&](size_t, size_t k, int lane) {
            state.put(state.air[k], lane, field_.at(state.template lane_of<double>(state.x[k], lane)));
        });
    }
    void gather(const auto& state) {
        const double c = scene_.term<AirDrag>()->c;
        const size_t n = size_t(state.n);
        state.for_each_particle([&](size_t id, size_t k, int lane) {
            auto edge_length = [&](size_t edge) {
                return state.template lane_of<double>(state.rest_length[edge], lane);
            };
            const size_t i = id % n;
            const double length = 0.5 * ((i > 0 ? edge_length(k - 1) : 0) + (i + 1 < n ? edge_length(k) : 0));
            hair_[id] = {state.template lane_of<float>(state.x[k], lane),
                         state.template lane_of<float>(state.v[k], lane), float(c * length)};
        });
    }

    const Scene& scene_;
    AirField field_;
    std::vector<DragPoint> hair_;  // (strand, particle), where hair brakes the air
};

}  // namespace wetcurl

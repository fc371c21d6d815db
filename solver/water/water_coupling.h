// The flow of water in a scene's hair, and what of the strands follows it.
#pragma once

#include <omp.h>

#include <vector>

#include "base/carried.h"
#include "solver/chain/chain_state.h"
#include "solver/scene/rest_state.h"
#include "solver/water/flow_pass.h"

namespace wetcurl {

// Of hair in the host's memory.
template <class H>
class WaterCoupling {
  public:
    // For a scene with [wetness.flow], which must outlive it.
    WaterCoupling(const Scene& scene, H&)
        : scene_(scene),
          flow_(*scene.flow, FlowHair(scene), scene.wetness->absorbed, scene.saturation),
          soaking_(size_t(scene.groom.rest.count)) {
#pragma omp parallel for schedule(static)
        for (int s = 0; s < scene.groom.rest.count; ++s) rest_state_of(scene, s, &soaking_[size_t(s)]);
    }

    // A frame of dt [s] from `time` on, of strands that are all there. Once a frame, since a block goes
    // through all substeps of a frame at once, from where strands are seen: wet strands that are drawn
    // together touch, and a surface wets what is seen to cross it. Water that comes takes on the velocity of
    // the hair that it comes to. BDF2 goes on with its history: seen with masses that quadruple within a few
    // frames, no energy comes of it, and a restart each frame loses up to a fifth more.
    void advance(H& hair, double time, double dt) {
        const StageTimer timer(seconds);
        const Strands& p = hair.seen();
        if (!is_finite(p.points)) return;
        hair.count_change(work, [&] {
            flow_.step(p, time, dt, scene_.integrator.gravity);
            soak(hair);
        });
    }
    void finish() {}  // once the frame is shown
    void restore(const std::vector<double>& saturation, H& hair) { flow_.restore(saturation), soak(hair); }

    // The saturation is restored before.
    void save(Carried& to) const { to["water counted"] = flow_.counted(); }
    void resume(const Carried& from) { flow_.count_from(from.at("water counted")); }

    const std::vector<double>& exact() const { return flow_.exact(); }  // (strand, particle)
    const std::vector<float>& saturation() const {
        return flow_.saturation();
    }  // the same, as others read it
    WaterBalance balance() const { return flow_.water(); }
    // What a run keeps of a frame, in two halves as a snapshot.
    void begin_record(RunFrame& frame) const {
        frame.saturation = saturation(), frame.water = balance().columns();
    }
    void finish_record(RunFrame&) const {}

    void list(BufferList& buffers) const {
        size_t bytes = 0;
        for (const auto& s : soaking_) {
            bytes += sizeof(double) * (s.dry_mass.capacity() + s.core.capacity() + s.rest_core.capacity());
            if (s.curl) bytes += s.curl->bytes();
        }
        buffers.push_back({"flow of water", flow_.bytes()});
        buffers.push_back({"rest states dry", bytes});
    }
    double seconds = 0;  // in the frame at hand
    double work = 0;     // [J] while it is counted

  private:
    // All of the strands that follows the saturation.
    void soak(H& hair) {
        auto& state = hair.state;
        const int n = state.n;
        room_.resize(size_t(omp_get_max_threads()));
#pragma omp parallel for schedule(static)
        for (int block = 0; block < state.blocks; ++block)
            for (int lane = 0; lane < state.lanes; ++lane) {
                const int s = state.strand_of(block, lane);
                const float* sigma = flow_.saturation().data() + size_t(s) * size_t(n);
                auto& [rest, points] = room_[size_t(omp_get_thread_num())];
                rest.rest_length.clear();
                for (int i = 0; !state.push.empty() && i + 1 < n; ++i)
                    rest.rest_length.push_back(
                        state.template lane_of<double>(state.rest_length[state.at(block, i)], lane));
                wetcurl::soak(scene_, soaking_[size_t(s)], sigma, rest, points);
                state.put_water(scene_, block, lane, rest, sigma);
            }
        if (scene_.cohesion) hair.take_up_water(flow_.dry_mass());
    }

    const Scene& scene_;
    FlowPass flow_;
    std::vector<Soaking> soaking_;  // (strand)
    struct Room {
        StrandRest rest;
        std::vector<Vec3d> points;
    };
    std::vector<Room> room_;  // (thread)
};

}  // namespace wetcurl

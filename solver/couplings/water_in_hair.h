// The flow of water in a scene's hair, and what of the strands follows it. Ours.
#pragma once

#include <vector>

#include "solver/chain_state.h"
#include "solver/display.h"
#include "solver/passes/flow.h"

namespace wetcurl {

template <class S>
class WaterInHair {
  public:
    // For a scene with [wetness.flow], which must outlive it.
    explicit WaterInHair(const Scene& scene)
        : scene_(scene),
          flow_(*scene.flow, scene.groom.rest, scene.linear_density, scene.wetness->absorbed,
                scene.saturation),
          soaking_(size_t(scene.groom.rest.count)) {
#pragma omp parallel for schedule(static)
        for (int s = 0; s < scene.groom.rest.count; ++s) rest_state_of(scene, s, &soaking_[size_t(s)]);
    }
    const FlowPass& flow() const { return flow_; }

    // A frame from `time` [s] on, strands seen at p. Once a frame, since a block goes through all substeps of
    // a frame at once, from where strands are seen: wet strands that are drawn together touch, and a surface
    // wets what is seen to cross it. Water that comes takes on the velocity of the hair that it comes to.
    // BDF2 goes on with its history: seen with masses that quadruple within a few frames, no energy comes of
    // it, and a restart each frame loses up to a fifth more. `display` lends its neighbours; null: none.
    void step(const Strands& p, double time, const Display* display) {
        flow_.step(p, time, 1 / scene_.fps, scene_.integrator.gravity, display ? &display->grid() : nullptr,
                   display ? &display->list() : nullptr);
    }
    void restore(const std::vector<double>& saturation) { flow_.restore(saturation); }

    // All of the strands that follows the saturation.
    void soak(ChainState<S>& state) const {
        const int n = state.n;
#pragma omp parallel for schedule(static)
        for (int block = 0; block < state.blocks; ++block)
            for (int lane = 0; lane < state.lanes; ++lane) {
                const int s = state.strand_of(block, lane);
                const float* sigma = flow_.saturation().data() + size_t(s) * size_t(n);
                StrandRest rest;
                for (int i = 0; !state.push.empty() && i + 1 < n; ++i)
                    rest.rest_length.push_back(
                        state.template lane_of<double>(state.rest_length[state.at(block, i)], lane));
                wetcurl::soak(scene_, soaking_[size_t(s)], sigma, rest);
                state.put_water(scene_, block, lane, rest, sigma);
            }
    }

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
    const Scene& scene_;
    FlowPass flow_;
    std::vector<Soaking> soaking_;  // (strand)
};

}  // namespace wetcurl

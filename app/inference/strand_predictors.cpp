// Whole strands: by interpolation, or by a strand network.
#include <filesystem>

#include "app/engine/device.h"
#include "app/engine/learned_hair.h"
#include "app/engine/run_of_scene.h"
#include "app/inference/predictor.h"
#include "base/network_channels.h"
#include "learn/codec/encode_runs.h"
#include "solver/scene/rest_state.h"
#ifdef WETCURL_HAVE_CUDA
#include "learn/codec/device_interpolator.h"
#endif

namespace wetcurl {

namespace {

std::string name_of(const InterpolationMethod& method, bool clumps) {
    return method.name + " interpolation" + suffix_of(method.roots) + (method.settled ? ", settled" : "") +
           (method.wet_shape ? ", Eq 9" : "") + (clumps ? ", Eq 10" : "");
}

// Where frames are interpolated: Interpolator on the host, or the same on a CUDA device.
struct OnHost {
    Interpolator interpolator;
    void apply(const Strands& low, const Pose& head, Strands& p) { interpolator.apply(low, head, p); }
};
#ifdef WETCURL_HAVE_CUDA
struct OnDevice {
    DeviceInterpolator interpolator;
    DeviceBuffer<Vec3f> low_there{size_t(interpolator.low_strands()) * interpolator.particles()},
        out_there{size_t(interpolator.high_strands()) * interpolator.particles()};
    void apply(const Strands& low, const Pose& head, Strands& p) {
        require_low_strands(low.count, low.particles, interpolator.low_strands(), interpolator.particles());
        low_there.upload(low.points.data(), low.points.size());
        interpolator.apply(low_there.data(), head, out_there.data(), nullptr);
        if (p.count != interpolator.high_strands() || p.particles != interpolator.particles())
            p = Strands(interpolator.high_strands(), interpolator.particles());
        out_there.download(p.points.data());
    }
};
#endif

template <class Where>
class Interpolated final : public Predictor {
  public:
    Interpolated(const InterpolationMethod& method, const PredictionInput& input, const Strands* shape)
        : name_(name_of(method, input.clumps)),
          where_{{method.kind, stencil_of(method.roots, input.scene.groom, input.low.groom),
                  input.scene.groom, input.low.groom, shape, simulated_wet(input.low), input.settled}},
          clumps_(input.clumps) {}
    std::string name() const override { return name_; }
    void apply(int, const RunFrame& low, const HeadWindow&, Strands& p) override {
        where_.apply(clumps_ ? low.positions : low.seen(), low.head, p);
    }

  private:
    std::string name_;
    Where where_;
    bool clumps_;
};

class NetworkStrands final : public Predictor {
  public:
    NetworkStrands(const StrandNetworkMethod& method, const PredictionInput& input)
        : learned_(learned_strands_of(method.model, input.scene, input.scene_file, input.low.groom,
                                      1 / (input.low.fps * substeps_of(input.low)), input.device,
                                      input.threads, input.settled)),
          name_(method.card.architecture + " " + std::filesystem::path(method.model).stem().string() +
                (method.settled ? ", settled" : "") + (method.crop ? ", cropped" : "") +
                (method.locks > 0 ? ", locks of " + std::to_string(method.locks) + " passes" : "") +
                (input.clumps ? ", Eq 10" : "")),
          tells_(!method.crop),
          low_(input.low.groom.rest),
          high_(input.scene.groom.rest) {
        if (method.crop) learned_->crop(wet_strands_of(input.scene));
        if (method.locks > 0)
            draw_together(*learned_, input.scene, input.scene_file, method.locks, input.low.fps);
        else if (input.clumps)
            learned_->lead_edges(most_length_rounds);
    }
    std::string name() const override { return name_; }
    void apply(int, const RunFrame& low, const HeadWindow& heads, Strands& p) override {
        std::copy(low.positions.points.begin(), low.positions.points.end(), low_.points.begin());
        if (p.count != high_.count || p.particles != high_.particles) p = high_;
        if (p.points.data() != bound_) learned_->bind(low_.points.data(), bound_ = p.points.data());
        learned_->run(heads);
    }
    int memory() const override { return learned_->memory(); }
    std::vector<float> expected_error() override {
        return tells_ ? learned_->expected_errors() : std::vector<float>();
    }
    std::vector<float> inputs() override { return learned_->inputs(); }
    Strands without_network(const RunFrame& low) override { return learned_->base(low.head); }

  private:
    std::unique_ptr<LearnedStrands> learned_;
    std::string name_;
    bool tells_;   // of what is not asked for, no error is known
    Strands low_;  // where the network reads
    const Strands& high_;
    Vec3f* bound_ = nullptr;  // where it writes
};

}  // namespace

std::string suffix_of(int roots) { return roots == 3 ? ", 3 roots" : ""; }
Stencil stencil_of(int roots, const Groom& high, const Groom& low) {
    return roots == 3 ? triangle_stencil(high, low) : surrounding_stencil(high, low);
}

std::unique_ptr<Predictor> predictor_of(const InterpolationMethod& method, const PredictionInput& input) {
    const Strands wet = method.wet_shape ? shape_at_rest(input.scene) : Strands();
    const Strands* const shape = method.wet_shape ? &wet : nullptr;
    if (input.device == "cpu") return std::make_unique<Interpolated<OnHost>>(method, input, shape);
    require_device(input.device);
#ifdef WETCURL_HAVE_CUDA
    enter_device(input.device);
    return std::make_unique<Interpolated<OnDevice>>(method, input, shape);
#else
    return nullptr;  // no such device is there
#endif
}

std::unique_ptr<Predictor> predictor_of(const StrandNetworkMethod& method, const PredictionInput& input) {
    return std::make_unique<NetworkStrands>(method, input);
}

}  // namespace wetcurl

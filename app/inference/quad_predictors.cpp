// Strands by the quad transform: with the colours of a network of the root codec, or of the wet run itself.
#include <fmt/format.h>

#include "app/inference/predictor.h"
#include "base/config.h"
#include "learn/codec/encode_runs.h"
#include "learn/codec/network_module.h"
#include "learn/codec/root_codec.h"

namespace wetcurl {

namespace {

// Of Eq 18.
struct Quad {
    Reconstruction form;
    int roots;
    double gain;
    ShiftUnits units;
    float radius;  // h [m]
};

// `recipe`: of the model `file`, where there is one.
Quad quad_of(const TransformSettings& t, const PredictionInput& input, const std::string& file = "",
             const std::string& recipe = "") {
    if (input.low.saturation.empty())
        throw Error(input.low_file + ": the run records no wetness ([wetness] in its scene); Eq 18 needs it");
    const Table its = Config::parse(recipe, file + ": its recipe").root().table("reconstruct");
    return {t.form, t.roots, t.gain ? *t.gain : its.number(gain_row),
            t.units ? *t.units : shift_units_named(its.text(shift_units_row)),
            float(input.scene.cohesion ? input.scene.cohesion->h_c : 0.012)};
}

Stencil nested_stencil_of(int roots, const PredictionInput& input) {
    try {
        require_nested(input.scene.groom, input.low.groom);
    } catch (const Error& e) {
        throw Error(input.low_file + ", " + input.scene_file + ": " + e.what());
    }
    return stencil_of(roots, input.scene.groom, input.low.groom);
}

class QuadPredictor : public Predictor {
  public:
    std::string name() const override { return name_; }
    Strands without_network(const RunFrame& low) override {
        Strands plain;
        transform_.interpolate(low.seen(), low.head, plain);
        return plain;
    }

  protected:
    // `kind`: of the colours.
    QuadPredictor(const std::string& kind, const Quad& q, const PredictionInput& input)
        : transform_(q.form, nested_stencil_of(q.roots, input), input.scene.groom, input.low.groom,
                     input.low.saturation, q.radius, float(q.gain), q.units),
          name_(kind + (q.form == Reconstruction::paper ? ", paper" : ", core and detail") +
                suffix_of(q.roots)) {}
    void name_gain(const Quad& q) {
        name_ += fmt::format(", gain {:g}", q.gain);
        if (q.units == ShiftUnits::printed) name_ += ", Eq 18 as printed";
    }
    QuadTransform transform_;
    std::string name_;
};

// Colours of the wet run itself, as training pairs hold them.
class OracleColours final : public QuadPredictor {
  public:
    OracleColours(const RunPair& pair, ShiftUnits colour_units, const Quad& q, const PredictionInput& input)
        : QuadPredictor("oracle colours", q, input) {
        name_gain(q);
        if (colour_units == ShiftUnits::printed) name_ += ", Eq 16 as printed";
        ColourBox box;
        colours_ = roots_of(pair, q.radius, colour_units, box).wet;
        for (auto& frame : colours_)
            for (Vec3f& c : frame) c = colour_of(c, box);
    }
    void apply(int frame, const RunFrame& low, const HeadWindow&, Strands& p) override {
        transform_.apply(low.seen(), low.head, colours_.at(size_t(frame)), p);
    }

  private:
    std::vector<std::vector<Vec3f>> colours_;  // (frame, high strand)
};

// The weights of Eq 18 that bring strands nearest to the wet run's.
class OracleWeights final : public QuadPredictor {
  public:
    OracleWeights(RunPair pair, const Quad& q, const PredictionInput& input)
        : QuadPredictor("oracle weights", q, input), truth_(std::move(pair.wet)) {}
    void apply(int frame, const RunFrame& low, const HeadWindow&, Strands& p) override {
        transform_.apply_nearest(low.seen(), low.head, truth_->frame(frame).seen(), p);
    }

  private:
    std::unique_ptr<RunReader> truth_;
};

// Colours of a network.
class NetworkColours final : public QuadPredictor {
  public:
    NetworkColours(const RootNetworkMethod& method, const Quad& q, const PredictionInput& input)
        : QuadPredictor(method.card.architecture, q, input),
          network_(network_module().load(method.model, input.device, input.threads)),
          high_image_(input.scene.groom.grid, 2),
          low_image_(input.low.groom.grid),
          radius_(q.radius),
          input_(3 * low_image_.pixels()),
          output_(3 * high_image_.pixels()) {
        name_gain(q);
        const auto corner = [&](const char* name) {
            const auto at = method.card.arrays.find(name);
            if (at == method.card.arrays.end() || at->second.size() != 3)
                throw Error(method.model + ": array '" + name +
                            "' is missing, needed are the 3 numbers of Eq 14");
            return Vec3d{at->second[0], at->second[1], at->second[2]};
        };
        box_ = {corner("b_min"), corner("b_max")};
    }
    void apply(int, const RunFrame& low, const HeadWindow&, Strands& p) override {
        std::vector<Vec3f> colours = shifted_roots(low.positions, {}, radius_);
        for (auto& c : colours) c = colour_of(c, box_);
        low_image_.draw(colours, input_.data());
        network_->run(input_.data(), {1, 3, low_image_.height(), low_image_.width()}, output_.data());
        transform_.apply(low.seen(), low.head, high_image_.read(output_.data()), p);
    }

  private:
    std::unique_ptr<Network> network_;
    RootImage high_image_, low_image_;
    float radius_;
    ColourBox box_;
    std::vector<float> input_, output_;
};

}  // namespace

std::unique_ptr<Predictor> predictor_of(const RootNetworkMethod& method, const PredictionInput& input) {
    const Quad q = quad_of(method.transform, input, method.model, method.card.recipe);
    return std::make_unique<NetworkColours>(method, q, input);
}

std::unique_ptr<Predictor> predictor_of(const OracleMethod& method, const PredictionInput& input) {
    const Quad q = quad_of(method.transform, input);
    RunPair pair(input.low_file, method.truth);
    pair.require_nested();
    if (method.by_weights) return std::make_unique<OracleWeights>(std::move(pair), q, input);
    return std::make_unique<OracleColours>(pair, method.colour_units, q, input);
}

}  // namespace wetcurl

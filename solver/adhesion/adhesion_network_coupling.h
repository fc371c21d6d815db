// A network in Eq 11's place: its interface, its inputs for all strands, and samples that one is trained on.
#pragma once

#include <algorithm>
#include <vector>

#include "base/dense_layers.h"
#include "base/error.h"
#include "solver/adhesion/adhesion_features.h"
#include "solver/chain/chain_state.h"
#include "solver/solids/posed_scene.h"

namespace wetcurl {

// Predicts the adhesion force in Eq 11's place, F.n / (sigma m a_max), from the inputs that AdhesionFeatures
// makes.
class AdhesionPredictor {
  public:
    virtual ~AdhesionPredictor() = default;
    // inputs (count, 12) -> outputs (count)
    virtual void evaluate(const float* inputs, size_t count, float* outputs) = 0;
    // All that it does, where that is dense layers alone: a device may ask them itself.
    virtual const DenseLayers* layers() const { return nullptr; }
};

// A particle's twelve inputs and Eq 11's answer: what an adhesion network is trained on.
struct AdhesionRecord {
    float inputs[AdhesionFeatures::inputs], target;
    bool contact;
};

// Asks the model, and records, for all strands between two substeps.
template <class S>
class AdhesionNetworkCoupling {
  public:
    AdhesionPredictor* model = nullptr;
    std::vector<AdhesionRecord>* records = nullptr;
    bool asked() const { return model || records; }
    // What a device may ask itself; null: the host asks, as it does where there are records to write.
    const DenseLayers* layers() const;

    // From the state as it is, `near` taken there; the answers hold for the substep that follows.
    void evaluate(const Adhesion& term, const ChainState<S>& state, const NearestSurface<S>& near);
    // F.n / (sigma m a_max) (block, particle); null: Eq 11.
    const S* given() const { return model && !given_.empty() ? given_.data() : nullptr; }
    // Of the substep before (strand, particle), F.n / (sigma m a_max); empty before the first.
    std::vector<double> answers() const { return {answers_.begin(), answers_.end()}; }
    void give_answers(const std::vector<double>& answers) { answers_.assign(answers.begin(), answers.end()); }
    void list(BufferList& buffers) const {
        add_buffer(buffers, "adhesion given", given_), add_buffer(buffers, "adhesion answers", answers_);
        add_buffer(buffers, "adhesion questions", found_), add_buffer(buffers, "adhesion asked", where_);
        add_buffer(buffers, "adhesion inputs", inputs_), add_buffer(buffers, "adhesion outputs", outputs_);
    }

  private:
    std::vector<S> given_;
    std::vector<float> answers_;  // F.n / (sigma m a_max) of the step before (strand, particle)
    // Of one evaluation, kept so that a frame asks for no memory.
    std::vector<AdhesionRecord> found_;
    std::vector<std::pair<int, int>> where_;  // strand, particle
    std::vector<float> inputs_, outputs_;
};

template <class S>
const DenseLayers* AdhesionNetworkCoupling<S>::layers() const {
    const DenseLayers* const layers = model && !records ? model->layers() : nullptr;
    if (layers && layers->inputs() != AdhesionFeatures::inputs)
        throw Error("a network in Eq 11's place: found " + std::to_string(layers->inputs()) +
                    " inputs, needed " + std::to_string(AdhesionFeatures::inputs));
    return layers;
}

template <class S>
void AdhesionNetworkCoupling<S>::evaluate(const Adhesion& term, const ChainState<S>& state,
                                          const NearestSurface<S>& near) {
    using T = Plain<S>;
    const int n = state.n, lanes = state.lanes;
    auto number = [](const S& a, int lane) { return ChainState<S>::template lane_of<T>(a, lane); };
    auto vector = [](const Vec3<S>& a, int lane) { return ChainState<S>::template lane_of<T>(a, lane); };
    if (answers_.empty()) answers_.assign(size_t(state.strands) * size_t(n), 0.f);
    if (model && given_.empty()) given_.assign(state.mass.size(), S(0));
    found_.clear(), where_.clear();
    const AdhesionFeatures features(term);
    auto answer = [&](int s, int i) -> float& { return answers_[size_t(s) * size_t(n) + size_t(i)]; };
    for (int s = 0; s < state.strands; ++s)
        for (int i = 1; i < n; ++i) {
            const int block = s / lanes, lane = s % lanes;
            const size_t k = state.at(block, i);
            const T phi = number(near.phi[k], lane);
            if (!features.concerns(number(state.saturation[k], lane), phi)) continue;
            AdhesionRecord r;
            features.ask(
                i, n, vector(near.normal[k], lane), vector(near.velocity[k], lane),
                [&](int j) {
                    const size_t m = state.at(block, j);
                    return AdhesionParticle<T>{number(state.touching[m], lane), number(near.phi[m], lane),
                                               vector(state.v[m], lane), answer(s, j)};
                },
                r.inputs);
            float value, slope;
            Adhesion::shape(float(phi / T(term.h_a)), value, slope);
            r.contact = features.in_contact(number(state.touching[k], lane));
            r.target = r.contact ? -value : 0;
            found_.push_back(r);
            where_.push_back({s, i});
        }
    if (model) {
        inputs_.clear(), outputs_.resize(found_.size());
        for (const auto& r : found_)
            inputs_.insert(inputs_.end(), r.inputs, r.inputs + AdhesionFeatures::inputs);
        if (!found_.empty()) model->evaluate(inputs_.data(), found_.size(), outputs_.data());
        std::fill(given_.begin(), given_.end(), S(0));
    }
    std::fill(answers_.begin(), answers_.end(), 0.f);
    for (size_t k = 0; k < found_.size(); ++k) {
        const int s = where_[k].first, i = where_[k].second;
        const float f = model ? (found_[k].contact ? outputs_[k] : 0.f) : found_[k].target;
        answer(s, i) = f;
        if (!model) continue;
        state.for_each_lane_of(s, [&](int lane) { state.put(given_[state.at(s / lanes, i)], lane, f); });
    }
    if (records) records->insert(records->end(), found_.begin(), found_.end());
}

}  // namespace wetcurl

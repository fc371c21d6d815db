// Adhesion by who answers in Eq 11's place (a network), and what one is trained on. Ours.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "solver/chain_state.h"
#include "solver/placement.h"

namespace wetcurl {

// Who gives the adhesion force in Eq 11's place (a network): F.n / (sigma m a_max) from twelve inputs,
// {contact, v.n / sqrt(a_max h), phi / h, F.n / (sigma m a_max)} of particles i-1, i, i+1.
class AdhesionModel {
  public:
    virtual ~AdhesionModel() = default;
    // inputs (count, 12) -> outputs (count)
    virtual void evaluate(const float* inputs, size_t count, float* outputs) = 0;
};

// A particle's twelve inputs and Eq 11's answer: what an adhesion network is trained on.
struct AdhesionRecord {
    float inputs[12], target;
    bool contact;
};

// Asks the model, and records, for all strands between two substeps.
template <class S>
class AdhesionNetwork {
  public:
    AdhesionModel* model = nullptr;
    std::vector<AdhesionRecord>* records = nullptr;
    bool asked() const { return model || records; }

    // From the state as it is, `near` taken there; the answers hold for the substep that follows.
    void evaluate(const Adhesion& term, const ChainState<S>& state, const NearestSurface<S>& near);
    // F.n / (sigma m a_max) (block, particle); null: Eq 11.
    const S* given() const { return model && !given_.empty() ? given_.data() : nullptr; }
    void list(BufferList& buffers) const {
        add_buffer(buffers, "adhesion given", given_), add_buffer(buffers, "adhesion answers", answers_);
    }

  private:
    std::vector<S> given_;
    std::vector<float> answers_;  // F.n / (sigma m a_max) of the step before (strand, particle)
};

template <class S>
void AdhesionNetwork<S>::evaluate(const Adhesion& term, const ChainState<S>& state,
                                  const NearestSurface<S>& near) {
    using T = Plain<S>;
    const int n = state.n, lanes = state.lanes;
    auto number = [](const S& a, int lane) { return ChainState<S>::template lane_of<T>(a, lane); };
    if (answers_.empty()) answers_.assign(size_t(state.strands) * size_t(n), 0.f);
    if (model && given_.empty()) given_.assign(state.mass.size(), S(0));
    std::vector<AdhesionRecord> found;
    std::vector<std::pair<int, int>> where;  // strand, particle
    const double speed = 1 / std::sqrt(term.a_max * term.h_a);
    auto answer = [&](int s, int i) -> float& { return answers_[size_t(s) * size_t(n) + size_t(i)]; };
    for (int s = 0; s < state.strands; ++s)
        for (int i = 1; i < n; ++i) {
            const int lane = s % lanes;
            const size_t k = state.at(s / lanes, i);
            if (!(number(state.saturation[k], lane) > 0) || number(near.phi[k], lane) > 2 * term.h_a)
                continue;
            AdhesionRecord r;
            const Vec3<T> normal = state.template lane_of<T>(near.normal[k], lane);
            for (int side = -1; side <= 1; ++side) {
                const int j = i + side < n ? i + side : i;
                const size_t m = state.at(s / lanes, j);
                const Vec3<T> slide = state.template lane_of<T>(state.v[m] - near.velocity[k], lane);
                float* in = r.inputs + 4 * (side + 1);
                in[0] = float(number(state.touching[m], lane));
                in[1] = float(dot(slide, normal) * speed);
                in[2] = float(std::min(number(near.phi[m], lane) / T(term.h_a), T(4)));
                in[3] = answer(s, j);
            }
            float value, slope;
            Adhesion::shape(float(number(near.phi[k], lane) / T(term.h_a)), value, slope);
            r.contact = number(state.touching[k], lane) > 0;
            r.target = r.contact ? -value : 0;
            found.push_back(r);
            where.push_back({s, i});
        }
    std::vector<float> out(found.size());
    if (model) {
        std::vector<float> inputs;
        for (const auto& r : found) inputs.insert(inputs.end(), r.inputs, r.inputs + 12);
        if (!found.empty()) model->evaluate(inputs.data(), found.size(), out.data());
        std::fill(given_.begin(), given_.end(), S(0));
    }
    std::fill(answers_.begin(), answers_.end(), 0.f);
    for (size_t k = 0; k < found.size(); ++k) {
        const auto [s, i] = where[k];
        const float f = model ? (found[k].contact ? out[k] : 0.f) : found[k].target;
        answer(s, i) = f;
        if (model) state.put(given_[state.at(s / lanes, i)], s % lanes, f);
    }
    if (records) records->insert(records->end(), found.begin(), found.end());
}

}  // namespace wetcurl

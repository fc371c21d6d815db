// A stepper for one strand in double precision, and terms for it: what the tests of the solver share.
#pragma once

#include <gtest/gtest.h>

#include "solver/chain/one_strand.h"
#include "solver/chain/substep.h"
#include "tests/base/scratch.h"

namespace wetcurl::testing {

template <class Term>
Assembled assembled(const Term& term, const ChainView<double>& c, double h) {
    return assembled_by([&](const auto& view, const auto& system) { assemble(term, view, system); }, c, h);
}
template <class Term>
Eigen::VectorXd force_of(const Term& term, const ChainView<double>& c) {
    return force_by([&](const auto& view, const auto& system) { assemble(term, view, system); }, c);
}

// The strand's own step, as the simulation does it for a block of strands.
class Stepper {
  public:
    Stepper(const ChainTerms& terms, OneStrand& strand, double dt, const Vec3d& gravity)
        : terms_(terms),
          s_(strand),
          dt_(dt),
          gravity_(gravity),
          x_before_(strand.x),
          v_before_(strand.v),
          scratch_(strand.n, terms, true, false) {
        root_[0] = s_.x[0];
        root_[1] = s_.x[1];
    }
    void step(const Quatd& root_turn = Quatd::identity()) {
        for (auto& p : root_) p = rotate(root_turn, p);
        const auto& bend = std::get<std::optional<Bend>>(terms_);
        BlockStep<double> b{s_.n,
                            dt_,
                            first_,
                            s_.x.data(),
                            x_before_.data(),
                            s_.v.data(),
                            v_before_.data(),
                            root_,
                            gravity_,
                            root_turn,
                            bend ? s_.frame.data() : nullptr,
                            nullptr};
        const SubstepRules<double> rules{terms_, std::nullopt, true, spring_sum(terms_), false};
        using Solids = std::vector<PosedSolid<double>>;
        const Solids none;
        const double* no_depth = nullptr;
        take_substep(rules, b, s_.view(), {}, no_depth, SolidsInALoop<double, Solids>{none}, scratch_,
                     static_cast<NoMeter*>(nullptr));
        std::swap(s_.x, x_before_);
        std::swap(s_.v, v_before_);
        first_ = false;
    }
    double energy() {
        const auto c = s_.view();
        double e = 0;
        for (int i = 0; i < s_.n; ++i)
            e += 0.5 * c.mass[i] * dot(c.v[i], c.v[i]) - c.mass[i] * dot(gravity_, c.x[i]);
        for_each_present(terms_, [&](const auto& term) { e += term.energy(c); });
        return e;
    }

  private:
    ChainTerms terms_;
    OneStrand& s_;
    double dt_;
    Vec3d gravity_;
    Points x_before_, v_before_;
    Vec3d root_[2];
    OwnScratch<double> scratch_;
    bool first_ = true;
};

inline Stretch stretch_of(double stiffness, double damping = 0) { return {stiffness, damping}; }
inline Bend bend_of(double stiffness, double damping = 0) { return {stiffness, damping}; }
inline Twist twist_of(double bend_stiffness, double torsion = 0.75) { return {torsion, bend_stiffness}; }
inline Core core_of(double stiffness, double segment, double smoothing = 0.02, double damping = 0) {
    return {stiffness, damping, smoothing, filter_beta(segment, smoothing)};
}

}  // namespace wetcurl::testing

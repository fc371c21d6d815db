// S3: forces differenced at rest, and the matrix that the implicit step takes for them.
#include <algorithm>
#include <Eigen/Eigenvalues>
#include <random>

#include "solver/stability/cases.h"

namespace wetcurl::stability {

namespace {

// What all terms add to one strand of a scene, at positions to which its frames are carried.
class AllTerms {
  public:
    AllTerms(const StabilityMethod& method, const ChainTerms& terms, OneStrand& strand)
        : method_(method), terms_(terms), strand_(strand) {}
    Eigen::VectorXd force(const Points& at) const {
        const auto frames = strand_.frames_at(at);
        return force_by(*this, strand_.view_at(at, frames));
    }
    Eigen::MatrixXd matrix(const Points& at, double h) const {
        const auto frames = strand_.frames_at(at);
        return assembled_by(*this, strand_.view_at(at, frames), h).matrix;
    }
    void operator()(const ChainView<double>& view, const ChainSystem<double>& system) const;

  private:
    const StabilityMethod& method_;
    const ChainTerms& terms_;
    OneStrand& strand_;
};
// Not inlined: one body with and without a matrix.
void AllTerms::operator()(const ChainView<double>& view, const ChainSystem<double>& system) const {
    if (method_.assemble)
        method_.assemble(terms_, view, system);
    else
        for_each_present(terms_, [&](const auto& term) { assemble(term, view, system); });
}

// Central differences of the forces: those of springs at rest bend over a segment.
Eigen::MatrixXd differenced(const AllTerms& all, const OneStrand& s) {
    const long size = 3 * s.n;
    const double step = 1e-5 * s.segment();
    Eigen::MatrixXd k(size, size);
    for (long column = 0; column < size; ++column) {
        Eigen::VectorXd at = stacked(s.x);
        Eigen::VectorXd difference = Eigen::VectorXd::Zero(size);
        for (double side : {1.0, -1.0}) {
            at[column] += side * step;
            difference += side * all.force(unstacked(at));
            at[column] -= side * step;
        }
        k.col(column) = -difference / (2 * step);
    }
    return k;
}

Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& symmetric) {
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}

struct Jacobian {
    double asymmetry, lowest;  // over the largest entry, the largest eigenvalue
};
Jacobian looked_at(const Eigen::MatrixXd& m) {
    const Eigen::VectorXd e = eigenvalues(0.5 * (m + m.transpose()));
    return {(m - m.transpose()).cwiseAbs().maxCoeff() / m.cwiseAbs().maxCoeff(),
            e.minCoeff() / e.cwiseAbs().maxCoeff()};
}
void judge(StabilityCase& c, const Jacobian& j) {
    c.measured = {{"asymmetry", j.asymmetry}, {"lowest_eigenvalue", j.lowest}};
    c.passed = c.finite && j.asymmetry <= 1e-6 && j.lowest >= -1e-6;
}

// Symmetric by the way it is kept, upper half alone; positive it need not be.
void judge_assembled(StabilityCase& c, const AllTerms& all, const OneStrand& s) {
    std::mt19937 random(7);
    Jacobian worst{0, 1};
    for (int state = 0; state < 5; ++state) {
        Points at = s.x;
        for (size_t i = 2; i < at.size(); ++i)
            for (double* x : {&at[i].x, &at[i].y, &at[i].z})
                *x += s.segment() * (2.0 * random() / 4294967295.0 - 1);
        const Eigen::MatrixXd matrix = all.matrix(at, dt_usual);
        const Jacobian j = looked_at(matrix);
        c.finite = c.finite && matrix.allFinite();
        worst = {std::max(worst.asymmetry, j.asymmetry), std::min(worst.lowest, j.lowest)};
    }
    judge(c, worst);
}

// An underestimated Hessian lets a strand swing up; at rest it must be the forces' own, or above. `k` is
// theirs.
void judge_above(StabilityCase& c, const AllTerms& all, const OneStrand& s, const Eigen::MatrixXd& k) {
    const double h = 1;
    const Eigen::MatrixXd own = all.matrix(s.x, h);
    const Eigen::MatrixXd above = own - 0.5 * (k + k.transpose());
    const long free = above.rows() - 6;  // the root's two particles are led
    const double lowest =
        eigenvalues(above.bottomRightCorner(free, free)).minCoeff() / own.cwiseAbs().maxCoeff();
    c.finite = above.allFinite();
    c.measured = {{"lowest_eigenvalue", lowest}};
    c.passed = c.finite && lowest >= -1e-6;
}

}  // namespace

Cases jacobians(const Battery& b, double k_over_m) {
    Cases out;
    for (bool curl : {false, true}) {
        const Points& shape = curl ? curly : straight;
        const std::string of = curl ? ", curly" : ", straight";
        const auto next = [&](const char* what) -> StabilityCase& {
            return out.emplace_back(b.named("S3", what + of, {{"k_over_m", k_over_m}}));
        };
        const StrandSetup setup{.shapes = {shape}, .k_over_m = k_over_m, .gravity = weightless};
        const Scene scene = scene_of(setup, b.method);
        OneStrand strand(shape, scene.linear_density);
        if (const auto& core = scene.term<Core>()) strand.rest_on(*core);
        if (scene.fibre) {
            Fibre::Springs own = scene.fibre->springs(strand.rest_length);
            strand.mass = scene.fibre->masses(strand.rest_length);
            strand.stretch_spring = std::move(own.stretch), strand.bend_spring = std::move(own.bend);
            strand.twist_spring = std::move(own.twist);
        }
        const AllTerms all(b.method, scene.chain, strand);

        const Eigen::MatrixXd k = differenced(all, strand);
        StabilityCase& at_rest = next("force differenced at rest");
        at_rest.finite = k.allFinite();
        judge(at_rest, looked_at(k));
        if (scene.integrator.kind != "implicit") continue;
        judge_assembled(next("assembled matrix"), all, strand);
        judge_above(next("matrix above the force's"), all, strand, k);
    }
    return out;
}

}  // namespace wetcurl::stability

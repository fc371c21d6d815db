// One strand in double precision with all that the terms along it read, and its forces and matrix as Eigen
// takes them: what the battery of stability and the tests look into a strand with.
#pragma once

#include <cmath>
#include <Eigen/Dense>
#include <numbers>
#include <vector>

#include "base/geometry/filter.h"
#include "solver/chain/chain_step.h"
#include "solver/scene/rest_state.h"
#include "solver/terms/curl.h"

namespace wetcurl {

using Points = std::vector<Vec3d>;

inline Points straight_points(int n, double length, const Vec3d& direction) {
    Points p;
    for (int i = 0; i < n; ++i) p.push_back((length * i / (n - 1)) * direction);
    return p;
}

// A helix about y, `length` along the curve [m], from the origin down.
inline Points helix_points(int n, double length, double radius, double pitch) {
    const double rise = pitch / (2 * std::numbers::pi), total = length / std::hypot(radius, rise);
    Points p;
    for (int i = 0; i < n; ++i) {
        const double t = total * i / (n - 1);
        p.push_back({radius * (std::cos(t) - 1), -rise * t, radius * std::sin(t)});
    }
    return p;
}

inline double mean_length(const std::vector<double>& lengths) {
    double sum = 0;
    for (double l : lengths) sum += l;
    return sum / double(lengths.size());
}

// At rest in the shape it is made from: every array that a term may read is there.
struct OneStrand : StrandArrays<double, HostArray> {
    int n;
    Points normal, surface_velocity, core_pull;
    std::vector<double> phi;
    Vec3d root_spin{0, 0, 0}, root_center{0, 0, 0}, root_velocity{0, 0, 0};

    OneStrand(const Points& shape, double linear_density = 6.5e-6)
        : n(int(shape.size())),
          normal(shape.size(), Vec3d{0, 1, 0}),
          surface_velocity(shape.size(), Vec3d{0, 0, 0}),
          core_pull(shape.size()),
          phi(shape.size(), 1.0) {
        x = shape, target = intrinsic_shape(shape), frame = frames_along(shape);
        for (Points* at_rest : {&v, &push}) at_rest->assign(shape.size(), Vec3d{0, 0, 0});
        mass = dry_masses(shape, linear_density);
        saturation.assign(shape.size(), 0.0), touching.assign(shape.size(), 0.0);
        for (size_t i = 0; i + 1 < x.size(); ++i) rest_length.push_back(norm(x[i + 1] - x[i]));
    }
    double segment() const { return mean_length(rest_length); }

    // A core of this filter keeps the smoothed lengths of the present positions.
    void rest_on(const Core& core) { rest_core = core_lengths(x, core.beta); }

    ChainView<double> view() { return view_at(x, frame); }
    ChainView<double> view_at(const Points& at, const std::vector<Quatd>& frames) {
        ChainView<double> c{};
        c.n = n;
        for_each_strand_array([](auto, auto& to, auto& array) { to = array.data(); }, c, *this);
        c.x = at.data(), c.frame = frames.data();
        c.phi = phi.data();
        c.normal = normal.data();
        c.surface_velocity = surface_velocity.data();
        c.root_spin = root_spin;
        c.root_center = root_center;
        c.root_velocity = root_velocity;
        c.chord = at.back() - at.front();
        c.core_pull = core_pull.data();
        return c;
    }
    // Frames of this strand carried on to other positions.
    std::vector<Quatd> frames_at(const Points& at) const {
        std::vector<Quatd> to(frame.size());
        transport_frames(n, frame.data(), Quatd::identity(), at.data(), to.data());
        return to;
    }
};

// What terms add: force (3n) and K = h C + h² H (3n x 3n).
struct Assembled {
    Eigen::VectorXd force;
    Eigen::MatrixXd matrix;
};

inline Eigen::VectorXd stacked(const Points& p) {
    Eigen::VectorXd out(3 * long(p.size()));
    for (size_t i = 0; i < p.size(); ++i) out.segment<3>(3 * long(i)) << p[i].x, p[i].y, p[i].z;
    return out;
}
inline Points unstacked(const Eigen::VectorXd& a) {
    Points out;
    for (long i = 0; i < a.size(); i += 3) out.push_back({a[i], a[i + 1], a[i + 2]});
    return out;
}
inline Eigen::Matrix3d eigen(const Mat3<double>& m) {
    Eigen::Matrix3d out;
    out << m.r0.x, m.r0.y, m.r0.z, m.r1.x, m.r1.y, m.r1.z, m.r2.x, m.r2.y, m.r2.z;
    return out;
}

// The upper half of a block-banded symmetric matrix, whole.
inline Eigen::MatrixXd whole(const std::vector<Sym3<double>>& diagonal,
                             const std::vector<Mat3<double>>& upper1,
                             const std::vector<Mat3<double>>& upper2) {
    const long n = long(diagonal.size());
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    auto put = [&](long i, long j, const Mat3<double>& m) {
        out.block<3, 3>(3 * i, 3 * j) = eigen(m);
        if (i != j) out.block<3, 3>(3 * j, 3 * i) = eigen(m).transpose();
    };
    for (long i = 0; i < n; ++i) {
        put(i, i, to_mat3(diagonal[size_t(i)]));
        if (i + 1 < n) put(i, i + 1, upper1[size_t(i)]);
        if (i + 2 < n) put(i, i + 2, upper2[size_t(i)]);
    }
    return out;
}

inline Points whole_forces(const ChainSystem<double>& system, int n) {
    Points out;
    for (int i = 0; i < n; ++i) out.push_back(system.whole_force(i, n));
    return out;
}
// The forces that add(c, system) adds over a step of h [s], without a matrix, which no term then makes.
template <class Add>
Points forces_by(Add add, const ChainView<double>& c, double h) {
    Points force(size_t(c.n), Vec3d{0, 0, 0}), pull = force;
    const ChainSystem<double> system{h, system.whole, force.data(), pull.data(), nullptr, nullptr, nullptr};
    add(c, system);
    return whole_forces(system, c.n);
}
// The same with the matrix.
template <class Add>
Assembled assembled_by(Add add, const ChainView<double>& c, double h) {
    const size_t n = size_t(c.n);
    const Vec3d zero{0, 0, 0};
    Points force(n, zero), pull(n, zero);
    std::vector<Sym3<double>> diagonal(n, identity_times(0.0)), edge = diagonal, whole_diagonal = diagonal;
    std::vector<Mat3<double>> joint(n, {zero, zero, zero}), upper1 = joint, upper2 = joint;
    const ChainSystem<double> system{h,           system.whole, force.data(), pull.data(), diagonal.data(),
                                     edge.data(), joint.data()};
    add(c, system);
    for (size_t i = 0; i < n; ++i) system.whole_row(int(i), c.n, whole_diagonal[i], &upper1[i], &upper2[i]);
    return {stacked(whole_forces(system, c.n)), whole(whole_diagonal, upper1, upper2)};
}
template <class Add>
Eigen::VectorXd force_by(Add add, const ChainView<double>& c) {
    return stacked(forces_by(add, c, 0));
}

}  // namespace wetcurl

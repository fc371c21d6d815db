// A step of the air.
#include "solver/air/air.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wetcurl {

namespace {

// Divergence that a projection leaves, of what it finds.
constexpr double projection_tolerance = 1e-5;
constexpr int most_cycles = 30;

double cell_of(const Air& air) { return air.size / std::max({air.grid[0], air.grid[1], air.grid[2]}); }
Vec3d corner_of(const Air& air) {
    const Vec3d cells{double(air.grid[0]), double(air.grid[1]), double(air.grid[2])};
    return air.center - (cell_of(air) / 2) * cells;
}
double along(const Vec3d& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

}  // namespace

double AirSource::share(const Vec3d& x, double time) const {
    const Vec3d d = (1 / radius) * (x - center);
    const double inside = std::max(0.0, 1 - dot(d, d));
    const double gust = period > 0 ? (1 - std::cos(2 * std::numbers::pi * time / period)) / 2 : 1;
    return gust * inside * (2 - inside);
}

AirField::AirField(const Air& air)
    : air_(air), cell_(cell_of(air)), corner_(corner_of(air)), pressure_(air.grid, cell_) {
    for (int axis = 0; axis < 3; ++axis) {
        auto n = air.grid;
        ++n[size_t(axis)];
        const size_t count = size_t(n[0]) * size_t(n[1]) * size_t(n[2]);
        u_[axis] = {n, std::vector<double>(count, along(air.wind, axis))};
        next_[axis] = {n, std::vector<double>(count, 0.0)};
        if (air.two_way) braked_[axis].resize(count);
    }
    factor_.resize(size_t(std::max({air.grid[0], air.grid[1], air.grid[2]})) + 1);
}

Vec3d AirField::place(int axis, int i, int j, int k) const {
    auto half = [&](int a) { return a == axis ? 0 : 0.5; };
    return corner_ + cell_ * Vec3d{i + half(0), j + half(1), k + half(2)};
}

// Written so that NaN is outside.
bool AirField::inside(const Vec3d& c) const {
    return c.x >= 0 && c.x <= air_.grid[0] && c.y >= 0 && c.y <= air_.grid[1] && c.z >= 0 &&
           c.z <= air_.grid[2];
}

// Of a place inside the box; within half a cell of its surface the last face's value holds.
AirField::Stencil AirField::stencil(int axis, const Vec3d& cells) const {
    const auto& n = u_[axis].n;
    Stencil s{0, {1, size_t(n[0]), size_t(n[0]) * size_t(n[1])}, {}};
    for (int a = 0; a < 3; ++a) {
        const double g = std::clamp(along(cells, a) - (a == axis ? 0 : 0.5), 0.0, double(n[size_t(a)] - 1));
        const int i = std::min(int(g), n[size_t(a)] - 2);
        s.corner += size_t(i) * s.step[a];
        s.t[a] = g - i;
    }
    return s;
}

double AirField::sample(int axis, const Vec3d& cells) const {
    const Stencil s = stencil(axis, cells);
    const double* v = &u_[axis].v[s.corner];
    auto mix = [](double a, double b, double t) { return a + t * (b - a); };
    auto line = [&](const double* w) { return mix(w[0], w[1], s.t[0]); };
    auto plane = [&](const double* w) { return mix(line(w), line(w + s.step[1]), s.t[1]); };
    return mix(plane(v), plane(v + s.step[2]), s.t[2]);
}

Vec3d AirField::velocity(const Vec3d& cells) const {
    if (!inside(cells)) return air_.wind;
    return {sample(0, cells), sample(1, cells), sample(2, cells)};
}

Vec3d AirField::at(const Vec3d& x) const { return velocity(in_cells(x)); }

// Semi-Lagrangian: each face takes the value from where its air was, found by the midpoint rule.
void AirField::advect(double dt) {
    const double step = dt / cell_;
    for (int axis = 0; axis < 3; ++axis) {
        Component& to = next_[axis];
#pragma omp parallel for schedule(static)
        for (int k = 0; k < to.n[2]; ++k)
            for (int j = 0; j < to.n[1]; ++j)
                for (int i = 0; i < to.n[0]; ++i) {
                    const Vec3d x = in_cells(place(axis, i, j, k));
                    const Vec3d middle = x - (step / 2) * velocity(x);
                    const Vec3d from = x - step * velocity(middle);
                    to.at(i, j, k) = inside(from) ? sample(axis, from) : along(air_.wind, axis);
                }
    }
    for (int axis = 0; axis < 3; ++axis) std::swap(u_[axis].v, next_[axis].v);
}

// Backward Euler along one axis after another, each row of faces a tridiagonal solve; no flux at the surface.
void AirField::diffuse(double dt) {
    const double a = air_.viscosity * dt / (cell_ * cell_);
    if (!(a > 0)) return;
    for (auto& u : u_)
        for (int axis = 0; axis < 3; ++axis) diffuse_lines(u, axis, a);
}

// (1 + 2a) w_i - a w_{i-1} - a w_{i+1} = u_i, with 1 + a at the ends.
void AirField::diffuse_lines(Component& u, int axis, double a) {
    const int n = u.n[size_t(axis)];
    // The pivot's inverse; a times it is what a row takes from the next.
    for (int i = 0; i < n; ++i) {
        const double diagonal = 1 + (i == 0 || i == n - 1 ? a : 2 * a);
        factor_[size_t(i)] = 1 / (diagonal - (i == 0 ? 0 : a * a * factor_[size_t(i) - 1]));
    }
    // Lines of two axes side by side; along x a line is a row of memory.
    const size_t step = axis == 0 ? 1 : axis == 1 ? size_t(u.n[0]) : size_t(u.n[0]) * size_t(u.n[1]);
    const int rows = axis == 2 ? u.n[1] : u.n[2];  // planes that hold whole lines
    const int wide = axis == 0 ? u.n[1] : u.n[0];
    const size_t row_step = axis == 2 ? size_t(u.n[0]) : size_t(u.n[0]) * size_t(u.n[1]);
    const size_t wide_step = axis == 0 ? size_t(u.n[0]) : 1;
#pragma omp parallel for schedule(static)
    for (int row = 0; row < rows; ++row) {
        double* w = u.v.data() + size_t(row) * row_step;
        for (int i = 0; i < n; ++i)
            for (int k = 0; k < wide; ++k) {
                double& here = w[size_t(i) * step + size_t(k) * wide_step];
                const double before = i == 0 ? 0 : (&here)[-std::ptrdiff_t(step)];
                here = (here + a * before) * factor_[size_t(i)];
            }
        for (int i = n - 2; i >= 0; --i)
            for (int k = 0; k < wide; ++k) {
                double& here = w[size_t(i) * step + size_t(k) * wide_step];
                here += a * factor_[size_t(i)] * (&here)[step];
            }
    }
}

void AirField::blow(double time) {
    for (const auto& source : air_.sources)
        for (int axis = 0; axis < 3; ++axis) {
            Component& u = u_[axis];
#pragma omp parallel for schedule(static)
            for (int k = 0; k < u.n[2]; ++k)
                for (int j = 0; j < u.n[1]; ++j)
                    for (int i = 0; i < u.n[0]; ++i) {
                        const double share = source.share(place(axis, i, j, k), time);
                        u.at(i, j, k) += share * (along(source.velocity, axis) - u.at(i, j, k));
                    }
        }
}

// Implicit, so that hair never takes the air beyond its own velocity: (u + k v) / (1 + k) at each face, k =
// dt drag / (density volume) of the hair around it and v its velocity. A component's faces are one thread's,
// so that the sums have one order.
void AirField::brake(const std::vector<DragPoint>& hair, double dt) {
    const double each = dt / (air_.density * cell_ * cell_ * cell_);
#pragma omp parallel for schedule(static, 1)
    for (int axis = 0; axis < 3; ++axis) {
        Component& u = u_[axis];
        auto &k = next_[axis].v, &kv = braked_[axis];
        std::fill(k.begin(), k.end(), 0.0);
        std::fill(kv.begin(), kv.end(), 0.0);
        for (const auto& h : hair) {
            const Vec3d cells = in_cells(cast<double>(h.x));
            if (!inside(cells)) continue;
            const Stencil s = stencil(axis, cells);
            const double v = along(cast<double>(h.v), axis);
            for (int c = 0; c < 8; ++c) {
                size_t at = s.corner;
                double weight = each * double(h.drag);
                for (int a = 0; a < 3; ++a) {
                    const bool upper = (c >> a) & 1;
                    at += upper ? s.step[a] : 0;
                    weight *= upper ? s.t[a] : 1 - s.t[a];
                }
                k[at] += weight, kv[at] += weight * v;
            }
        }
        for (size_t f = 0; f < u.v.size(); ++f) u.v[f] = (u.v[f] + kv[f]) / (1 + k[f]);
    }
}

double AirField::divergence(int i, int j, int k) const {
    return (u_[0].at(i + 1, j, k) - u_[0].at(i, j, k) + u_[1].at(i, j + 1, k) - u_[1].at(i, j, k) +
            u_[2].at(i, j, k + 1) - u_[2].at(i, j, k)) /
           cell_;
}

double AirField::divergence() const {
    double most = 0;
#pragma omp parallel for schedule(static) reduction(max : most)
    for (int k = 0; k < air_.grid[2]; ++k)
        for (int j = 0; j < air_.grid[1]; ++j)
            for (int i = 0; i < air_.grid[0]; ++i) most = std::max(most, std::abs(divergence(i, j, k)));
    return most;
}

// u - grad p with lap p = div u, and p = 0 on the surface, through which air comes and goes freely.
void AirField::project() {
#pragma omp parallel for schedule(static)
    for (int k = 0; k < air_.grid[2]; ++k)
        for (int j = 0; j < air_.grid[1]; ++j)
            for (int i = 0; i < air_.grid[0]; ++i) pressure_.b(i, j, k) = -divergence(i, j, k);
    divergence_before_ = pressure_.right_side();
    cycles_ = pressure_.solve(projection_tolerance, most_cycles);
    for (int axis = 0; axis < 3; ++axis) {
        Component& u = u_[axis];
        const int e[3] = {axis == 0, axis == 1, axis == 2};
        const int last = u.n[size_t(axis)] - 1;
        const auto& p = pressure_;
#pragma omp parallel for schedule(static)
        for (int k = 0; k < u.n[2]; ++k)
            for (int j = 0; j < u.n[1]; ++j)
                for (int i = 0; i < u.n[0]; ++i) {
                    // Outside lies a layer of zeros; the surface is only half a cell away.
                    const int at = axis == 0 ? i : axis == 1 ? j : k;
                    const double inverse = (at == 0 || at == last ? 2 : 1) / cell_;
                    u.at(i, j, k) -= inverse * (p.p(i, j, k) - p.p(i - e[0], j - e[1], k - e[2]));
                }
    }
}

void AirField::step(double dt, double time, const std::vector<DragPoint>& hair) {
    advect(dt);
    diffuse(dt);
    blow(time);
    if (!hair.empty()) brake(hair, dt);
    project();  // last, so that what is sampled and what advects has no divergence
}

// Faces on the surface have half a cell of air.
double AirField::energy() const {
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const Component& u = u_[axis];
        const int last = u.n[size_t(axis)] - 1;
        for (int k = 0; k < u.n[2]; ++k)
            for (int j = 0; j < u.n[1]; ++j)
                for (int i = 0; i < u.n[0]; ++i) {
                    const int at = axis == 0 ? i : axis == 1 ? j : k;
                    sum += (at == 0 || at == last ? 0.5 : 1) * u.at(i, j, k) * u.at(i, j, k);
                }
    }
    return 0.5 * air_.density * cell_ * cell_ * cell_ * sum;
}

size_t AirField::bytes() const {
    size_t sum = pressure_.bytes();
    for (int axis = 0; axis < 3; ++axis)
        sum += (u_[axis].v.capacity() + next_[axis].v.capacity() + braked_[axis].capacity()) * sizeof(double);
    return sum;
}

}  // namespace wetcurl

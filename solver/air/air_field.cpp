// A step of the air.
#include "solver/air/air_field.h"

#include <algorithm>
#include <cmath>

namespace wetcurl {

double cell_of(const Air& air) { return air.size / std::max({air.grid[0], air.grid[1], air.grid[2]}); }
Vec3d corner_of(const Air& air) {
    const Vec3d cells{double(air.grid[0]), double(air.grid[1]), double(air.grid[2])};
    return air.center - (cell_of(air) / 2) * cells;
}

AirField::AirField(const Air& air) : air_(air), cell_(cell_of(air)), poisson_(air.grid, cell_) {
    for (int axis = 0; axis < 3; ++axis) {
        const size_t count = size_t(view().faces(axis));
        u_[size_t(axis)].assign(count, along(air.wind, axis));
        next_[size_t(axis)].assign(count, 0.0);
        if (air.two_way) braked_[size_t(axis)].resize(count);
    }
    factor_.resize(size_t(std::max({air.grid[0], air.grid[1], air.grid[2]})) + 1);
    pressure_.resize(size_t(air.grid[0]) * size_t(air.grid[1]) * size_t(air.grid[2]));
}

StaggeredGrid AirField::view() const {
    auto* self = const_cast<AirField*>(this);
    return {{air_.grid[0], air_.grid[1], air_.grid[2]},
            cell_,
            1 / cell_,
            corner_of(air_),
            air_.wind,
            {self->u_[0].data(), self->u_[1].data(), self->u_[2].data()},
            self->pressure_.data()};
}

// f(face, i, j, k), planes shared out among the threads.
template <class F>
void AirField::for_each_face(int axis, F f) const {
    const auto n = faces(axis);
#pragma omp parallel for schedule(static)
    for (int k = 0; k < n[2]; ++k) {
        size_t face = size_t(view().index(axis, 0, 0, k));
        for (int j = 0; j < n[1]; ++j)
            for (int i = 0; i < n[0]; ++i) f(face++, i, j, k);
    }
}

// Semi-Lagrangian.
void AirField::advect(double dt) {
    const StaggeredGrid grid = view();
    for (int axis = 0; axis < 3; ++axis)
        for_each_face(axis, [&](size_t face, int i, int j, int k) {
            next_[size_t(axis)][face] = grid.advected(axis, i, j, k, dt / cell_);
        });
    std::swap(u_, next_);
}

// Backward Euler along one axis after another.
void AirField::diffuse(double dt) {
    const double a = air_.viscosity * dt / (cell_ * cell_);
    if (!(a > 0)) return;
    for (int component = 0; component < 3; ++component)
        for (int axis = 0; axis < 3; ++axis) diffuse_along(component, axis, a);
}

void AirField::diffuse_along(int component, int axis, double a) {
    const auto faces_along = faces(component);
    const int n = faces_along[size_t(axis)];
    diffusion_factors(n, a, factor_.data());
    // Lines of two axes side by side; along x a line is a row of memory.
    const size_t row = size_t(faces_along[0]), layer = row * size_t(faces_along[1]);
    const size_t step = axis == 0 ? 1 : axis == 1 ? row : layer;
    const int planes = axis == 2 ? faces_along[1] : faces_along[2];  // that hold whole lines
    const int wide = axis == 0 ? faces_along[1] : faces_along[0];
    const size_t plane_step = axis == 2 ? row : layer, wide_step = axis == 0 ? row : 1;
#pragma omp parallel for schedule(static)
    for (int plane = 0; plane < planes; ++plane) {
        double* w = u_[size_t(component)].data() + size_t(plane) * plane_step;
        for (int i = 0; i < n; ++i)
            for (int k = 0; k < wide; ++k) {
                double& here = w[size_t(i) * step + size_t(k) * wide_step];
                const double before = i == 0 ? 0 : (&here)[-std::ptrdiff_t(step)];
                here = eliminated(here, before, a, factor_[size_t(i)]);
            }
        for (int i = n - 2; i >= 0; --i)
            for (int k = 0; k < wide; ++k) {
                double& here = w[size_t(i) * step + size_t(k) * wide_step];
                here = substituted(here, (&here)[step], a, factor_[size_t(i)]);
            }
    }
}

void AirField::blow(double time) {
    const StaggeredGrid grid = view();
    for (const auto& source : air_.sources) {
        const double gust = source.gust(time);
        for (int axis = 0; axis < 3; ++axis)
            for_each_face(axis, [&](size_t face, int i, int j, int k) {
                double& u = grid.u[axis][face];
                u = blown(u, gust, share_of_ball(source.center, source.radius, grid.place(axis, i, j, k)),
                          along(source.velocity, axis));
            });
    }
}

// A component's faces are one thread's, so that the sums have one order.
void AirField::brake(const std::vector<DragPoint>& hair, double dt) {
    const StaggeredGrid grid = view();
    const double each = dt / (air_.density * cell_ * cell_ * cell_);
#pragma omp parallel for schedule(static, 1)
    for (int axis = 0; axis < 3; ++axis) {
        auto &u = u_[size_t(axis)], &k = next_[size_t(axis)], &kv = braked_[size_t(axis)];
        std::fill(k.begin(), k.end(), 0.0);
        std::fill(kv.begin(), kv.end(), 0.0);
        for (const auto& h : hair) {
            const Vec3d place = grid.in_cells(cast<double>(h.x));
            if (!grid.inside(place)) continue;
            const double v = along(cast<double>(h.v), axis);
            grid.stencil(axis, place).for_each([&](int at, double weight) {
                weight *= each * double(h.drag);
                const size_t face = size_t(at);
                k[face] += weight, kv[face] += weight * v;
            });
        }
        for (size_t f = 0; f < u.size(); ++f) u[f] = braked(u[f], k[f], kv[f]);
    }
}

double AirField::divergence() const {
    const StaggeredGrid grid = view();
    double most = 0;
#pragma omp parallel for schedule(static) reduction(max : most)
    for (int k = 0; k < air_.grid[2]; ++k)
        for (int j = 0; j < air_.grid[1]; ++j)
            for (int i = 0; i < air_.grid[0]; ++i) most = std::max(most, std::abs(grid.divergence(i, j, k)));
    return most;
}

// u - grad p with lap p = div u, and p = 0 on the surface, through which air comes and goes freely.
void AirField::project() {
    const StaggeredGrid grid = view();
    double most = 0;
#pragma omp parallel for schedule(static) reduction(max : most)
    for (int k = 0; k < air_.grid[2]; ++k) {
        double* b = &pressure_[size_t(k) * size_t(air_.grid[1]) * size_t(air_.grid[0])];
        for (int j = 0; j < air_.grid[1]; ++j)
            for (int i = 0; i < air_.grid[0]; ++i) {
                *b = -grid.divergence(i, j, k);
                most = std::max(most, std::abs(*b++));
            }
    }
    divergence_before_ = most;
    if (!(most > 0)) return;
    poisson_.solve(pressure_);
    for (int axis = 0; axis < 3; ++axis)
        for_each_face(axis, [&](size_t face, int i, int j, int k) {
            grid.u[axis][face] -= grid.pressure_gradient(axis, i, j, k);
        });
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
        const auto n = faces(axis);
        const double* u = u_[size_t(axis)].data();
        for (int k = 0; k < n[2]; ++k)
            for (int j = 0; j < n[1]; ++j)
                for (int i = 0; i < n[0]; ++i, ++u) {
                    const int at = axis == 0 ? i : axis == 1 ? j : k;
                    sum += (at == 0 || at == n[size_t(axis)] - 1 ? 0.5 : 1) * *u * *u;
                }
    }
    return 0.5 * air_.density * cell_ * cell_ * cell_ * sum;
}

size_t AirField::bytes() const {
    size_t sum = pressure_.capacity() * sizeof(double) + poisson_.bytes();
    for (size_t axis = 0; axis < 3; ++axis)
        sum += (u_[axis].capacity() + next_[axis].capacity() + braked_[axis].capacity()) * sizeof(double);
    return sum;
}

}  // namespace wetcurl

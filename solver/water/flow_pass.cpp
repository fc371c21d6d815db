// The flow of water on the CPU.
#include "solver/water/flow_pass.h"

#include <omp.h>

#include <algorithm>
#include <cmath>

#include "solver/scene/rest_state.h"

namespace wetcurl {

FlowHair::FlowHair(const Strands& rest, double of_all)
    : strands(rest.count), particles(rest.particles), density(of_all) {
    for (int s = 0; s < strands; ++s) add(dry_masses(points_of(rest, s), density), points_of(rest, s));
}
FlowHair::FlowHair(const Scene& scene)
    : strands(scene.groom.rest.count), particles(scene.groom.rest.particles), density(scene.linear_density) {
    for (int s = 0; s < strands; ++s) add(dry_masses(scene, s), points_of(scene.groom.rest, s));
}
// Where segments have no length there is next to no hair, but no division by nothing.
void FlowHair::add(const std::vector<double>& masses, const std::vector<Vec3d>& p) {
    for (double m : masses) mass.push_back(std::max(m, 1e-30));
    for (double l : edge_lengths(p)) length.push_back(std::max(l, 1e-9));
    length.push_back(0);
}

WaterBalance water_balance(double absorbed, double start, double held,
                           const std::vector<FlowLedger>& ledger) {
    WaterBalance out{absorbed * start, absorbed * held, 0, 0, 0};
    for (const auto& l : ledger)
        out.taken += absorbed * l.taken, out.dripped += absorbed * l.dripped, out.dried += absorbed * l.dried;
    return out;
}

std::vector<double> carried_of(double start, const std::vector<FlowLedger>& ledger) {
    std::vector<double> out{start};
    for (const auto& l : ledger) out.insert(out.end(), {l.taken, l.dripped, l.dried});
    return out;
}
double take_carried(const std::vector<double>& carried, std::vector<FlowLedger>& ledger) {
    for (size_t s = 0; s < ledger.size(); ++s)
        ledger[s] = {carried[1 + 3 * s], carried[2 + 3 * s], carried[3 + 3 * s]};
    return carried[0];
}

FlowPass::FlowPass(const Flow& flow, FlowHair hair, double absorbed, const std::vector<float>& saturation)
    : flow_(flow),
      hair_(std::move(hair)),
      absorbed_(absorbed),
      next_(hair_.mass.size()),
      limit_(hair_.mass.size()),
      shown_(hair_.mass.size()) {
    restore({saturation.begin(), saturation.end()});
}

FlowKernelBody FlowPass::bodies() {
    return {flow_,         hair_.density, hair_.particles, hair_.mass.data(), hair_.length.data(),
            sigma_.data(), next_.data(),  limit_.data(),   ledger_.data()};
}

void FlowPass::restore(const std::vector<double>& saturation) {
    sigma_ = saturation;
    ledger_.assign(size_t(hair_.strands), FlowLedger{});
    start_ = held();
    show();
}

void FlowPass::show() { std::copy(sigma_.begin(), sigma_.end(), shown_.begin()); }

double FlowPass::held() const { return water_held(hair_.mass.data(), sigma_.data(), sigma_.size()); }

WaterBalance FlowPass::water() const { return water_balance(absorbed_, start_, held(), ledger_); }

void FlowPass::wet(const Strands& p, double time, double dt) {
    const FlowKernelBody b = bodies();
    for (const auto& source : flow_.sources) {
        const FlowingSource now = source.over(time, dt);
        if (now.taken == 0) continue;
#pragma omp parallel for schedule(static)
        for (int s = 0; s < hair_.strands; ++s) b.wet(s, now, p.points.data());
    }
}

void FlowPass::run_along(const Strands& p, double dt, const Vec3d& gravity) {
    const FlowKernelBody b = bodies();
    const Vec3d down = flow_.down(gravity);
    rows_.resize(size_t(omp_get_max_threads()));
#pragma omp parallel
    {
        auto& rows = rows_[size_t(omp_get_thread_num())];
        rows.assign(size_t(hair_.particles), FlowRow{});
#pragma omp for schedule(static)
        for (int s = 0; s < hair_.strands; ++s) b.run_along(s, p.points.data(), dt, down, rows.data());
    }
}

void FlowPass::search(const Strands& p) {
    const size_t count = p.points.size(), padded = count + NeighborList::padding;
    grid_.build(p.points.data(), count, float(flow_.reach));
    any_source_.assign(padded, 1.f);
    for (size_t k = 0; k < count; ++k)
        grid_.points().set_group(k, grid_.order()[k] / uint32_t(hair_.particles));
    list_.build(grid_, any_source_, float(flow_.reach));
}

void FlowPass::exchange(const Strands& p, double dt) {
    search(p);
    const FlowKernelBody b = bodies();
    const auto& id = grid_.order();
    const PointQuads& x = grid_.points();
    auto for_each_contact = [&](size_t k, auto visit) {
        const Vec3f own = x.at(k);
        list_.visit_neighbours(k, [&](size_t j) {
            const Vec3f d = x.at(j) - own;
            visit(size_t(id[j]), std::sqrt(double(dot(d, d))));
        });
    };
    const long count = long(grid_.size());
#pragma omp parallel for schedule(static)
    for (long k = 0; k < count; ++k)
        b.find_limit(id[size_t(k)], dt, [&](auto visit) { for_each_contact(size_t(k), visit); });
#pragma omp parallel for schedule(static)
    for (long k = 0; k < count; ++k)
        b.pass_on(id[size_t(k)], dt, [&](auto visit) { for_each_contact(size_t(k), visit); });
#pragma omp parallel for schedule(static)
    for (int s = 0; s < hair_.strands; ++s) b.shed_excess(s, b.next);
}

void FlowPass::dry(double dt) {
    const FlowKernelBody b = bodies();
    const double share = flow_.dried(dt);
#pragma omp parallel for schedule(static)
    for (int s = 0; s < hair_.strands; ++s) b.dry(s, share);
}

void FlowPass::step(const Strands& p, double time, double dt, const Vec3d& gravity) {
    wet(p, time, dt);
    run_along(p, dt, gravity);
    exchange(p, dt);
    dry(dt);
    show();
}

size_t FlowPass::bytes() const {
    const size_t doubles = sigma_.capacity() + next_.capacity() + hair_.mass.capacity() +
                           hair_.length.capacity() + limit_.capacity() + 3 * ledger_.capacity();
    return doubles * sizeof(double) + (shown_.capacity() + any_source_.capacity()) * sizeof(float) +
           grid_.bytes() + list_.bytes();
}

}  // namespace wetcurl

// Contact between strands on the CPU: a vector of neighbours at a time.
#include "solver/passes/strand_contact.h"

#include <algorithm>

namespace wetcurl {

// Of the radius: wider lists hold longer and cost more in every substep.
static constexpr float margin = 0.5f;

StrandContactPass::StrandContactPass(const StrandContact& term, const Strands& rest)
    : inverse_mass(rest.points.size()),
      x(rest.count, rest.particles),
      v(rest.count, rest.particles),
      term_(term),
      rest_(rest) {
    const size_t count = rest.points.size(), padded = count + size_t(S::lanes);
    for (auto* points : {&searched_, &velocity_, &drawn_}) points->resize(count);
    for (auto* numbers : {&weight_, &contacts_}) numbers->assign(padded, 0.f);
    any_.assign(padded, 1.f), strand_.resize(padded);
}

void StrandContactPass::build_lists() {
    const float radius = (1 + margin) * float(term_.radius);
    grid_.build(x.points.data(), x.points.size(), radius);
    const long count = long(grid_.size());
#pragma omp parallel for schedule(static)
    for (long k = 0; k < count; ++k) {
        const size_t at = size_t(k), id = grid_.order()[at];
        searched_.set(at, x.points[id]), drawn_.set(at, rest_.points[id]);
        strand_[at] = uint32_t(id) / uint32_t(x.particles);
    }
    list_.build(grid_, strand_, any_, radius);
    ++lists_built_;
}

// The substep's state in the lists' order. Returns whether these still hold every pair that may touch.
bool StrandContactPass::refresh() {
    const long count = long(grid_.size());
    float farthest = 0;
#pragma omp parallel for schedule(static) reduction(max : farthest)
    for (long k = 0; k < count; ++k) {
        const size_t at = size_t(k), id = grid_.order()[at];
        const Vec3f moved = x.points[id] - searched_.at(at);
        farthest = std::max(farthest, dot(moved, moved));
        grid_.points().set(at, x.points[id]), velocity_.set(at, v.points[id]);
        weight_[at] = inverse_mass[id];
    }
    const float allowed = 0.5f * margin * float(term_.radius);
    return count > 0 && farthest <= allowed * allowed;
}

template <class Visit>
void StrandContactPass::for_each_run(size_t k, Visit visit) const {
    const Vec3<S> own = cast<S>(grid_.sorted(k)), own_rest = cast<S>(drawn_.at(k));
    list_.visit_runs(k, [&](uint32_t first, uint32_t bits) {
        visit(first, mask_of(bits), own - grid_.points().load(first),
              term_.square_distance(own_rest - drawn_.load(first)));
    });
}

float StrandContactPass::contacts_of(size_t k) const {
    S found(0);
    for_each_run(k, [&](uint32_t, const S::Mask& neighbour, const Vec3<S>& d, const S& square) {
        found += select(neighbour & (dot(d, d) < square), S(1), S(0));
    });
    return sum(found);
}

Vec3f StrandContactPass::impulse_on(size_t k, const StrandContact::Step& step) const {
    const Vec3<S> own_v = cast<S>(velocity_.at(k));
    const S own_weight(weight_[k]), own_contacts(contacts_[k]);
    Vec3<S> all = cast<S>(Vec3f{0, 0, 0});
    for_each_run(k, [&](uint32_t first, const S::Mask& neighbour, const Vec3<S>& d, const S& square) {
        // Two that are held have no mass to move.
        const S both = own_weight + S::load(&weight_[first]);
        const S mu = select(neighbour & (both > S(0)), S(1) / maximum(both, S(1e-30f)), S(0));
        const S most = maximum(own_contacts, S::load(&contacts_[first]));
        all += StrandContact::impulse(step, d, own_v - velocity_.load(first), square, mu,
                                      S(1) / maximum(most, S(1)));
    });
    return {sum(all.x), sum(all.y), sum(all.z)};
}

void StrandContactPass::resolve(double dt) {
    if (!refresh()) build_lists(), refresh();
    const StrandContact::Step step(term_, dt);
    const long count = long(grid_.size());
#pragma omp parallel
    {
#pragma omp for schedule(dynamic, 1024)
        for (long k = 0; k < count; ++k) contacts_[size_t(k)] = contacts_of(size_t(k));
#pragma omp for schedule(dynamic, 1024)
        for (long k = 0; k < count; ++k) {
            const size_t at = size_t(k), id = grid_.order()[at];
            const bool moved = contacts_[at] > 0 && weight_[at] > 0;
            v.points[id] = moved ? weight_[at] * impulse_on(at, step) : Vec3f{0, 0, 0};
        }
    }
}

size_t StrandContactPass::bytes() const {
    const size_t floats =
        inverse_mass.capacity() + weight_.capacity() + contacts_.capacity() + any_.capacity();
    return floats * sizeof(float) + (x.points.capacity() + v.points.capacity()) * sizeof(Vec3f) +
           strand_.capacity() * sizeof(uint32_t) + searched_.bytes() + velocity_.bytes() + drawn_.bytes() +
           grid_.bytes() + list_.bytes();
}

}  // namespace wetcurl

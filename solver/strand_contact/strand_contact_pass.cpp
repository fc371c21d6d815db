// Contact between strands on the CPU: a cluster of particles and four neighbours at a time.
#include "solver/strand_contact/strand_contact_pass.h"

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
    const size_t count = rest.points.size(), padded = count + NeighborList::padding;
    for (auto* points : {&searched_, &velocity_, &drawn_}) points->resize(count);
    for (auto* numbers : {&weight_, &contacts_}) numbers->assign(padded, 0.f);
    any_.assign(padded, 1.f);
}

void StrandContactPass::build_lists() {
    const float radius = (1 + margin) * float(term_.radius);
    grid_.build(x.points.data(), x.points.size(), radius);
    const long count = long(grid_.size());
#pragma omp parallel for schedule(static)
    for (long k = 0; k < count; ++k) {
        const size_t at = size_t(k), id = grid_.order()[at];
        searched_.set(at, x.points[id]), drawn_.set(at, rest_.points[id]);
        grid_.points().set_group(at, uint32_t(id) / uint32_t(x.particles));
    }
    list_.build(grid_, any_, radius);
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

std::vector<double> StrandContactPass::built_at() const {
    std::vector<double> out(1 + 3 * x.points.size(), 0.0);
    out[0] = double(lists_built_);
    for (size_t at = 0; at < grid_.size(); ++at) {
        const Vec3f p = searched_.at(at);
        double* const to = &out[1 + 3 * size_t(grid_.order()[at])];
        to[0] = double(p.x), to[1] = double(p.y), to[2] = double(p.z);
    }
    return out;
}

void StrandContactPass::build_at(const std::vector<double>& built) {
    if (built[0] == 0) return;
    for (size_t id = 0; id < x.points.size(); ++id) {
        const double* const from = &built[1 + 3 * id];
        x.points[id] = {float(from[0]), float(from[1]), float(from[2])};
    }
    build_lists();
    lists_built_ = long(built[0]);
}

template <class Visit>
void StrandContactPass::for_each_run(size_t c, Visit visit) const {
    const size_t first = c * NeighborList::cluster;
    const Vec3<S> own = grid_.points().a_quad_each(first), own_rest = drawn_.a_quad_each(first);
    list_.visit_runs(c, [&](size_t four, uint32_t bits) {
        visit(four, mask_of(bits), own - grid_.points().in_each_quad(four),
              term_.square_distance(own_rest - drawn_.in_each_quad(four)));
    });
}

StrandContactPass::S StrandContactPass::contacts_of(size_t c) const {
    S found(0);
    for_each_run(c, [&](size_t, const S::Mask& neighbour, const Vec3<S>& d, const S& square) {
        found += select(neighbour & (dot(d, d) < square), S(1), S(0));
    });
    return sums_of_quads(found, found, found, found);
}

StrandContactPass::S StrandContactPass::impulses_on(size_t c, const StrandContact::Step& step) const {
    const size_t first = c * NeighborList::cluster;
    const Vec3<S> own_v = velocity_.a_quad_each(first);
    const S own_weight = a_quad_each(&weight_[first]), own_contacts = a_quad_each(&contacts_[first]);
    Vec3<S> all = cast<S>(Vec3f{0, 0, 0});
    for_each_run(c, [&](size_t four, const S::Mask& neighbour, const Vec3<S>& d, const S& square) {
        // Two that are held have no mass to move.
        const S both = own_weight + in_each_quad(&weight_[4 * four]);
        const S mu = select(neighbour & (both > S(0)), S(1) / maximum(both, S(1e-30f)), S(0));
        const S most = maximum(own_contacts, in_each_quad(&contacts_[4 * four]));
        all += StrandContact::impulse(step, d, own_v - velocity_.in_each_quad(four), square, mu,
                                      S(1) / maximum(most, S(1)));
    });
    return sums_of_quads(all.x, all.y, all.z, all.z);
}

void StrandContactPass::resolve(double dt) {
    if (!refresh()) build_lists(), refresh();
    const StrandContact::Step step(term_, dt);
    const long clusters = long(list_.clusters());
#pragma omp parallel
    {
#pragma omp for schedule(dynamic, 256)
        for (long c = 0; c < clusters; ++c) {
            const S found = contacts_of(size_t(c));
            for_each_point(size_t(c), [&](int i, size_t k) { contacts_[k] = found[4 * i]; });
        }
#pragma omp for schedule(dynamic, 256)
        for (long c = 0; c < clusters; ++c) {
            float most = 0;
            for_each_point(size_t(c), [&](int, size_t k) { most = std::max(most, contacts_[k]); });
            const S given = most > 0 ? impulses_on(size_t(c), step) : S(0);
            for_each_point(size_t(c), [&](int i, size_t k) {
                v.points[grid_.order()[k]] =
                    weight_[k] * Vec3f{given[4 * i], given[4 * i + 1], given[4 * i + 2]};
            });
        }
    }
}

size_t StrandContactPass::bytes() const {
    const size_t floats =
        inverse_mass.capacity() + weight_.capacity() + contacts_.capacity() + any_.capacity();
    return floats * sizeof(float) + (x.points.capacity() + v.points.capacity()) * sizeof(Vec3f) +
           searched_.bytes() + velocity_.bytes() + drawn_.bytes() + grid_.bytes() + list_.bytes();
}

}  // namespace wetcurl

// Links between strands: found once a frame, computed in every substep.
#include "solver/strand_contact/strand_links.h"

#include <algorithm>

namespace wetcurl {

StrandLinks::StrandLinks(const StrandContact& term, const Strands& drawn, double longest_edge)
    : x(drawn.points),
      v(drawn.points.size(), {0, 0, 0}),
      mass(drawn.points.size(), 0.f),
      saturation(drawn.points.size(), 0.f),
      term_(term),
      drawn_(drawn),
      places_{uint32_t(drawn.particles), term.places(longest_edge)},
      reach_(float(term.reach(longest_edge))),
      any_(drawn.points.size() + NeighborList::padding, 1.f),
      links_(drawn.points.size() * places_.each * most_links),
      made_(links_.size()),
      count_of_(drawn.points.size() * places_.each, 0),
      begin_(size_t(drawn.count) + 1, 0),
      first_(size_t(drawn.count), 0),
      force_(drawn.points.size(), {0, 0, 0}),
      stiffness_(drawn.points.size(), 0.f),
      diagonal_(drawn.points.size(), 0.f) {}

void StrandLinks::find() {
    grid_.build(x.data(), x.size(), reach_);
    const long count = long(x.size());
#pragma omp parallel for schedule(static)
    for (long k = 0; k < count; ++k)
        grid_.points().set_group(size_t(k), grid_.order()[size_t(k)] / places_.n);
    near_.build(grid_, any_, reach_);
    const LinkSearch search{x.data(), drawn_.points.data(), places_, float(term_.radius), reach_};
#pragma omp parallel for schedule(dynamic, 256)
    for (long k = 0; k < count; ++k) {
        const uint32_t id = grid_.order()[size_t(k)];
        for (uint32_t p = 0; p < places_.each; ++p) {
            const PlaceOnStrand place = places_.at(id, p);
            const Vec3f at = place.of(x.data());
            LinkSearch::Candidates found;
            if (id % places_.n > 1)
                near_.visit_neighbours(size_t(k), [&](size_t other) {
                    const uint32_t near = grid_.order()[other];
                    search.offer(id, at, near, x[near], found);
                });
            const size_t which = size_t(id) * places_.each + p;
            count_of_[which] =
                uint8_t(search.link(place, found, &links_[which * most_links], &made_[which * most_links]));
        }
    }
    links_.swap(made_);
    list_by_other();
}

// A counting sort: of a strand's links one follows the other, so that nothing depends on threads.
void StrandLinks::list_by_other() {
    std::fill(begin_.begin(), begin_.end(), 0);
    auto for_each_link = [&](auto visit) {
        for (size_t which = 0; which < count_of_.size(); ++which)
            for (size_t k = 0; k < count_of_[which]; ++k)
                visit(links_[which * most_links + k].other / places_.n);
    };
    for_each_link([&](uint32_t other) { ++begin_[other + 1]; });
    for (size_t s = 1; s < begin_.size(); ++s) begin_[s] += begin_[s - 1];
    count_ = begin_.back();
    slot_.clear(), on_other_.resize(count_);
    next_.assign(begin_.begin(), begin_.end() - 1);
    for_each_link([&](uint32_t other) { slot_.push_back(next_[other]++); });
    const size_t of_strand = size_t(places_.n) * places_.each;
    uint32_t links = 0;
    for (size_t which = 0; which < count_of_.size(); ++which) {
        if (which % of_strand == 0) first_[which / of_strand] = links;
        links += count_of_[which];
    }
}

void StrandLinks::add(const PlaceOnStrand& place, const Vec3f& force, float stiffness) {
    const uint32_t a = place.edge, b = a + 1;
    const float there = place.along, here = 1 - there;
    force_[a] += here * force, force_[b] += there * force;
    stiffness_[a] += here * stiffness, stiffness_[b] += there * stiffness;
}

// Calls visit(own place, own link, its slot in on_other_) for each link of a strand.
template <class Visit>
void StrandLinks::for_each_link(uint32_t strand, Visit visit) {
    const uint32_t begin = strand * places_.n * places_.each, end = begin + places_.n * places_.each;
    const uint32_t* slot = slot_.data() + first_[strand];
    for (uint32_t which = begin; which < end; ++which)
        for (size_t k = 0; k < count_of_[which]; ++k)
            visit(places_.at(which / places_.each, which % places_.each), links_[which * most_links + k],
                  on_other_[*slot++]);
}

void StrandLinks::act_on_own(uint32_t strand, const StrandContact::Step& step) {
    const LinkedStrands strands{places_, x.data(), v.data(), mass.data(), saturation.data()};
    for_each_link(strand, [&](const PlaceOnStrand& own, StrandLink& link, LinkedStrands::Acting& on) {
        on = strands.act(step, own, link);
        if (on.acts.stiffness() > 0) add(own, on.acts.force, on.acts.stiffness());
    });
}

void StrandLinks::act_on_other(uint32_t strand, bool with_stiffness) {
    for (uint32_t k = begin_[strand]; k < begin_[strand + 1]; ++k)
        if (const auto& [place, acts] = on_other_[k]; acts.stiffness() > 0)
            add(place, -acts.force, with_stiffness ? acts.stiffness() : 0);
}

// One sweep of Jacobi's for (M + h^2 K) y = M v, K of the links, from v on: y - v.
void StrandLinks::correct(double dt) {
    const StrandContact::Step step(term_, dt);
    const long strands = drawn_.count;
#pragma omp parallel
    {
#pragma omp for schedule(dynamic, 8)
        for (long s = 0; s < strands; ++s) {
            std::fill_n(&force_[size_t(s) * places_.n], places_.n, Vec3f{0, 0, 0});
            for_each_link(uint32_t(s), [&](const PlaceOnStrand& own, StrandLink&, LinkedStrands::Acting& on) {
                if (!(on.acts.stiffness() > 0)) return;
                on.acts.force = -on.acts.against(own.of(v.data()) - on.other.of(v.data()));
                add(own, on.acts.force, 0);
            });
        }
#pragma omp for schedule(dynamic, 8)
        for (long s = 0; s < strands; ++s) {
            act_on_other(uint32_t(s), false);
            for (uint32_t id = uint32_t(s) * places_.n; id < uint32_t(s + 1) * places_.n; ++id)
                v[id] = StrandContact::correction(step, mass[id], stiffness_[id], force_[id]);
        }
    }
}

void StrandLinks::evaluate(double dt) {
    const StrandContact::Step step(term_, dt);
    const long strands = drawn_.count;
    float stiffest = 0;
#pragma omp parallel
    {
#pragma omp for schedule(dynamic, 8)
        for (long s = 0; s < strands; ++s) {
            std::fill_n(&force_[size_t(s) * places_.n], places_.n, Vec3f{0, 0, 0});
            std::fill_n(&stiffness_[size_t(s) * places_.n], places_.n, 0.f);
            act_on_own(uint32_t(s), step);
        }
#pragma omp for schedule(dynamic, 8) reduction(max : stiffest)
        for (long s = 0; s < strands; ++s) {
            act_on_other(uint32_t(s), true);
            for (uint32_t id = uint32_t(s) * places_.n; id < uint32_t(s + 1) * places_.n; ++id) {
                diagonal_[id] = StrandContact::on_diagonal(step, stiffness_[id], mass[id]);
                stiffest = std::max(stiffest, StrandContact::stiffest(step, stiffness_[id], mass[id]));
            }
        }
    }
    stiffest_ = stiffest;
}

double StrandLinks::potential(const std::vector<Vec3d>& at) const {
    double sum = 0;
    for (uint32_t which = 0; which < count_of_.size(); ++which)
        for (size_t l = 0; l < count_of_[which]; ++l)
            sum += places_.energy(term_, places_.at(which / places_.each, which % places_.each),
                                  links_[which * most_links + l], at.data(), mass.data(), saturation.data());
    return sum;
}

// Of each link in a row.
static constexpr size_t numbers = 6;

std::vector<double> numbers_of(const std::vector<StrandLink>& links) {
    std::vector<double> out(links.size() * numbers);
    for (size_t k = 0; k < links.size(); ++k) {
        const StrandLink& link = links[k];
        const double row[numbers] = {double(link.other),  double(link.kept),   double(link.drawn),
                                     double(link.slip.x), double(link.slip.y), double(link.slip.z)};
        std::copy_n(row, numbers, &out[k * numbers]);
    }
    return out;
}
std::vector<StrandLink> links_of(const std::vector<double>& from) {
    std::vector<StrandLink> out(from.size() / numbers);
    for (size_t k = 0; k < out.size(); ++k) {
        const double* row = &from[k * numbers];
        out[k] = {
            uint32_t(row[0]), float(row[1]), float(row[2]), {float(row[3]), float(row[4]), float(row[5])}};
    }
    return out;
}
std::vector<uint8_t> links_in_places(const std::vector<StrandLink>& links) {
    std::vector<uint8_t> out(links.size() / most_links);
    for (size_t which = 0; which < out.size(); ++which)
        out[which] =
            uint8_t(std::count_if(&links[which * most_links], &links[which * most_links] + most_links,
                                  [](const StrandLink& l) { return l.other != StrandLink::none; }));
    return out;
}

void StrandLinks::save(Carried& to) const { to[carried_links] = numbers_of(links_); }
void StrandLinks::resume(const Carried& from) {
    links_ = links_of(from.at(carried_links)), count_of_ = links_in_places(links_);
    list_by_other();
}

size_t StrandLinks::bytes() const {
    auto of = [](const auto&... buffers) { return ((buffers.capacity() * sizeof(buffers[0])) + ...); };
    return of(x, v, mass, saturation, any_, links_, made_, count_of_, begin_, slot_, first_, next_, on_other_,
              force_, stiffness_, diagonal_) +
           grid_.bytes() + near_.bytes();
}

}  // namespace wetcurl

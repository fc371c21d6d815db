// Links between strands: found once a frame, computed in every substep.
#include "solver/strand_contact/strand_links.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace wetcurl {

// How far lists of neighbours go: where the nearest few of most particles lie, if that is much less than
// `reach`.
static float reach_in_lists(const Strands& drawn, float reach) {
    const float few = 2.5f * float(cell_side(drawn, double(reach)));
    return few < 0.8f * reach ? few : reach;
}

StrandLinks::StrandLinks(const StrandContact& term, const Strands& drawn, double longest_edge)
    : particles(drawn.points.size()),
      term_(term),
      drawn_(drawn),
      places_{uint32_t(drawn.particles), term.places(longest_edge, drawn.particles)},
      reach_(float(term.reach(longest_edge))),
      listed_(reach_in_lists(drawn, reach_)),
      x_(drawn.points),
      any_(drawn.points.size() + NeighborList::padding, 1.f),
      links_(size_t(drawn.count) * places_.count * most_links),
      made_(links_.size()),
      count_of_(links_.size() / most_links, 0),
      begin_(size_t(drawn.count) + 1, 0),
      first_(size_t(drawn.count), 0),
      sum_(drawn.points.size(), FourFloats{0, 0, 0, 0}),
      force_(drawn.points.size(), {0, 0, 0}),
      diagonal_(drawn.points.size(), 0.f) {
    for (uint32_t which = 0; which < count_of_.size(); ++which) place_.push_back(places_.at(which));
    there_.resize(place_.size());
    // As many links as there may be: no frame asks for memory.
    begin_.reserve(begin_.size() + 1);
    next_.reserve(links_.size()), slot_.reserve(links_.size());
    on_other_.reserve(links_.size());
}

void StrandLinks::find() {
    for (size_t id = 0; id < x_.size(); ++id) x_[id] = particles[id].x;
    grid_.build(x_.data(), x_.size(), listed_);
    if (listed_ < reach_) wide_grid_.build(x_.data(), x_.size(), reach_);
    const long count = long(x_.size());
#pragma omp parallel for schedule(static)
    for (long k = 0; k < count; ++k)
        grid_.points().set_group(size_t(k), grid_.order()[size_t(k)] / places_.n);
    near_.build(grid_, any_, listed_);
    const LinkSearch search{particles.data(), drawn_.points.data(), places_, float(term_.radius), reach_};
    const long clusters = long(near_.clusters());
#pragma omp parallel for schedule(dynamic, 32)
    for (long c = 0; c < clusters; ++c) link_cluster(search, size_t(c));
    links_.swap(made_);
    list_by_other();
}

// The places next to the points that a list's cluster has, the first of each, then the second. A quad of
// lanes holds one of them and four others.
void StrandLinks::link_cluster(const LinkSearch& search, size_t cluster) {
    using P = Pack<float>;
    constexpr size_t points = NeighborList::cluster;
    const size_t first = cluster * points, count = std::min(points, x_.size() - first);
    uint32_t id[points], strand[points], which[points], end[points];
    for (size_t i = 0; i < count; ++i) {
        id[i] = grid_.order()[first + i], strand[i] = id[i] / places_.n;
        const uint32_t of_strand = id[i] - strand[i] * places_.n, begin = strand[i] * places_.count;
        which[i] = begin + places_.first_of(of_strand), end[i] = begin + places_.first_of(of_strand + 1);
    }
    struct alignas(64) Numbers {
        float of[P::lanes] = {};
    };
    auto some = [&] {
        for (size_t i = 0; i < count; ++i)
            if (which[i] < end[i]) return true;
        return false;
    };
    while (some()) {
        LinkSearch::Candidates found[points];
        Vec3f at[points] = {};
        Numbers x, y, z, own, worst;
        std::fill_n(worst.of, P::lanes, -1.f);
        for (size_t i = 0; i < count; ++i) {
            if (which[i] < end[i]) {
                at[i] = place_[which[i]].position(particles.data());
                found[i] = search.begin(strand[i], at[i], &links_[which[i] * most_links]);
            }
            const float most = which[i] < end[i] ? search.farthest(found[i]) : -1;
            for (size_t lane = 4 * i; lane < 4 * i + 4; ++lane) {
                x.of[lane] = at[i].x, y.of[lane] = at[i].y, z.of[lane] = at[i].z;
                own.of[lane] = std::bit_cast<float>(strand[i]), worst.of[lane] = most;
            }
        }
        const Vec3<P> from{P::load(x.of), P::load(y.of), P::load(z.of)};
        const auto own_strand = std::bit_cast<P::Mask>(P::load(own.of).v);
        near_.visit_runs(cluster, [&](size_t four, uint32_t bits) {
            const Vec3<P> d = grid_.points().in_each_quad(four) - from;
            const auto other = std::bit_cast<P::Mask>(grid_.points().numbers_in_each_quad(four).v);
            const auto odd = -((own_strand ^ other) & 1);
            bits &= bits_of(dot(d, d) <= P::load(worst.of)) & bits_of(~((own_strand < other) ^ odd));
            for (; bits; bits &= bits - 1) {
                const size_t lane = size_t(std::countr_zero(bits)), i = lane / 4, k = 4 * four + lane % 4;
                const uint32_t there = grid_.order()[k];
                search.offer(strand[i], at[i], there, std::bit_cast<uint32_t>(grid_.points().number(k)),
                             x_[there], found[i]);
                std::fill_n(&worst.of[4 * i], 4, search.farthest(found[i]));
            }
        });
        for (size_t i = 0; i < count; ++i) {
            if (which[i] >= end[i]) continue;
            const float far = std::sqrt(search.farthest(found[i])) + norm(at[i] - x_[id[i]]);
            if (std::min(far, reach_) > listed_)
                wide_grid_.around(x_[id[i]], [&](size_t other) {
                    const uint32_t there = wide_grid_.order()[other], group = there / places_.n;
                    const Vec3f d = x_[there] - x_[id[i]];
                    if (group != strand[i] && dot(d, d) < reach_ * reach_)
                        search.offer(strand[i], at[i], there, group, x_[there], found[i]);
                });
            const size_t l = size_t(which[i]) * most_links;
            count_of_[which[i]] = uint8_t(search.link(place_[which[i]], found[i], &links_[l], &made_[l]));
            ++which[i];
        }
    }
}

// A counting sort: of a strand's links one follows the other, so that nothing depends on threads.
void StrandLinks::list_by_other() {
    std::fill(begin_.begin(), begin_.end(), 0);
    next_.clear();
    const size_t of_strand = places_.count;
    for (size_t which = 0; which < count_of_.size(); ++which) {
        if (which % of_strand == 0) first_[which / of_strand] = uint32_t(next_.size());
        for (size_t k = 0; k < count_of_[which]; ++k) {
            const uint32_t other = links_[which * most_links + k].other / places_.n;
            next_.push_back(other), ++begin_[other + 1];
        }
    }
    for (size_t s = 1; s < begin_.size(); ++s) begin_[s] += begin_[s - 1];
    on_other_.resize(next_.size()), slot_.resize(next_.size());
    for (size_t k = 0; k < next_.size(); ++k) slot_[k] = begin_[next_[k]]++;
    // Each begin has moved on to its end, which is the next one's begin.
    begin_.insert(begin_.begin(), 0), begin_.pop_back();
}

void StrandLinks::add(const PlaceOnStrand& place, FourFloats acts) {
    place.share([&](uint32_t id, float share) { sum_[id] += share * acts; });
}

// What links of one place after the other do to it.
struct StrandLinks::AtPlace {
    static constexpr uint32_t none = ~0u;
    StrandLinks& links;
    uint32_t place = none;
    FourFloats sum = {0, 0, 0, 0};
    void add(uint32_t of, FourFloats acts) {
        if (of != place) hand_over(), place = of;
        sum += acts;
    }
    void hand_over() {
        if (place != none) links.add(links.place_[place], sum);
        sum = FourFloats{0, 0, 0, 0};
    }
    ~AtPlace() { hand_over(); }
};

// Links of a strand that a vector's lanes hold.
struct StrandLinks::Lanes {
    using P = Pack<float>;
    static constexpr int lanes = P::lanes;
    const LinkedParticle *own[lanes], *other[lanes];  // the place itself; where the other edge begins
    uint32_t place[lanes];
    StrandLink* link[lanes];
    int count = 0;

    void take(const LinkedParticle* there, uint32_t which, StrandLink& of) {
        own[count] = there, place[count] = which, link[count++] = &of;
    }
    // The rest is like the first.
    void fill_up() {
        for (int lane = count; lane < lanes; ++lane)
            own[lane] = own[0], place[lane] = place[0], link[lane] = link[0];
    }
    static Vec3<P> first_three(const FourColumns& of) { return {of[0], of[1], of[2]}; }
    // Places and masses, then speeds and saturations.
    static const float* first_half(const LinkedParticle* of) { return &of->x.x; }
    static const float* second_half(const LinkedParticle* of) { return &of->v.x; }
};

void StrandLinks::act_on_own(uint32_t strand, const StrandContact::Step& step) {
    using P = Pack<float>;
    uint32_t at = first_[strand];
    AtPlace at_place{*this};
    Lanes of;
    auto act = [&] {
        if (of.count == 0) return;
        of.fill_up();
        constexpr int lanes = Lanes::lanes;
        for (int l = 0; l < lanes; ++l) of.other[l] = &particles[of.link[l]->other];
        const auto own = FourColumns::of([&](int l) { return of.first_half(of.own[l]); }),
                   own_v = FourColumns::of([&](int l) { return of.second_half(of.own[l]); });
        const Vec3<P> p = of.first_three(own);
        const auto a = FourColumns::of([&](int l) { return of.first_half(of.other[l]); }),
                   b = FourColumns::of([&](int l) { return of.first_half(of.other[l] + 1); });
        const P t = nearest_on(p, of.first_three(a), of.first_three(b));
        const auto a_v = FourColumns::of([&](int l) { return of.second_half(of.other[l]); }),
                   b_v = FourColumns::of([&](int l) { return of.second_half(of.other[l] + 1); });
        auto between = [&](const FourColumns& from, const FourColumns& to, int c) {
            return from[c] + t * (to[c] - from[c]);
        };
        const Vec3<P> d = p - Vec3<P>{between(a, b, 0), between(a, b, 1), between(a, b, 2)};
        const Vec3<P> v =
            of.first_three(own_v) - Vec3<P>{between(a_v, b_v, 0), between(a_v, b_v, 1), between(a_v, b_v, 2)};
        const auto kept = FourColumns::of([&](int l) { return &of.link[l]->touch.kept; }),
                   slip = FourColumns::of([&](int l) { return &of.link[l]->touch.drawn; });
        Touch<P> touch{kept[0], kept[1], {slip[1], slip[2], slip[3]}};
        const auto f =
            StrandContact::act<P>(step, d, v, own_v[3] * between(a_v, b_v, 3),
                                  P(places_.part()) * StrandContact::weight(own[3], between(a, b, 3)), touch);

        // Lanes beyond those that there are write nothing.
        FourColumns{touch.kept, touch.drawn, touch.slip.x, touch.slip.y}.rows([&](int l, FourFloats row) {
            if (l < of.count) put_four(row, &of.link[l]->touch.kept);
        });
        FourColumns{f.force.x, f.force.y, f.force.z, f.stiffness}.rows([&](int l, FourFloats row) {
            if (l >= of.count) return;
            const PlaceOnStrand other{of.link[l]->other, t[l]};
            of.link[l]->other = places_.next(other.edge, other.along);
            of.link[l]->touch.slip.z = touch.slip.z[l];
            on_other_[slot_[at + uint32_t(l)]] = {other, row * FourFloats{-1, -1, -1, 1}};
            at_place.add(of.place[l], row);
        });
        at += uint32_t(of.count), of.count = 0;
    };
    uint32_t at_slot = at;
    const uint32_t begin = strand * places_.count, end = begin + places_.count;
    for (uint32_t which = begin; which < end; ++which) {
        if (count_of_[which] > 0) there_[which] = place_[which].of(particles.data());
        for (size_t k = 0; k < count_of_[which]; ++k) {
            StrandLink& link = links_[which * most_links + k];
            const LinkedParticle* other = &particles[link.other];
            __builtin_prefetch(other), __builtin_prefetch(other + 1);
            __builtin_prefetch(&on_other_[slot_[at_slot++]], 1);
            of.take(&there_[which], which, link);
            if (of.count == Lanes::lanes) act();
        }
    }
    act();
}

void StrandLinks::act_on_other(uint32_t strand) {
    for (uint32_t k = begin_[strand]; k < begin_[strand + 1]; ++k) add(on_other_[k].place, on_other_[k].acts);
}

void StrandLinks::evaluate(double dt) {
    const StrandContact::Step step(term_, dt);
    const long strands = drawn_.count;
#pragma omp parallel
    {
#pragma omp for schedule(dynamic, 8)
        for (long s = 0; s < strands; ++s) {
            std::fill_n(&sum_[size_t(s) * places_.n], places_.n, FourFloats{0, 0, 0, 0});
            act_on_own(uint32_t(s), step);
        }
#pragma omp for schedule(dynamic, 8)
        for (long s = 0; s < strands; ++s) {
            act_on_other(uint32_t(s));
            for (size_t id = size_t(s) * places_.n; id < size_t(s + 1) * places_.n; ++id) {
                const FourFloats sum = sum_[id];
                force_[id] = {sum[0], sum[1], sum[2]};
                diagonal_[id] = StrandContact::on_diagonal(step, sum[3], particles[id].mass);
            }
        }
    }
}

double StrandLinks::potential(const std::vector<Vec3d>& at) const {
    double sum = 0;
    for (uint32_t which = 0; which < count_of_.size(); ++which)
        for (size_t l = 0; l < count_of_[which]; ++l)
            sum += places_.energy(term_, place_[which], links_[which * most_links + l], at.data(),
                                  particles.data());
    return sum;
}

double cell_side(const Strands& drawn, double reach) {
    constexpr size_t others = 8, samples = 509;
    constexpr double cells = 6;
    NeighborGrid grid;
    grid.build(drawn.points.data(), drawn.points.size(), float(reach));
    const size_t n = size_t(drawn.particles);
    std::vector<float> far, near;
    for (size_t s = 0; s < samples; ++s) {
        const size_t id = s * drawn.points.size() / samples;
        near.assign(others, float(reach * reach));
        grid.around(drawn.points[id], [&](size_t k) {
            if (const Vec3f d = drawn.points[grid.order()[k]] - drawn.points[id];
                grid.order()[k] / n != id / n)
                near.push_back(dot(d, d));
        });
        std::nth_element(near.begin(), near.begin() + others - 1, near.end());
        far.push_back(std::sqrt(near[others - 1]));
    }
    std::nth_element(far.begin(), far.begin() + samples / 2, far.end());
    return std::clamp(double(far[samples / 2]), reach / cells, reach);
}

// Of each link in a row.
static constexpr size_t numbers = 6;

std::vector<double> numbers_of(const std::vector<StrandLink>& links) {
    std::vector<double> out(links.size() * numbers);
    for (size_t k = 0; k < links.size(); ++k) {
        const StrandLink& link = links[k];
        const auto& [kept, drawn, slip] = link.touch;
        const double row[numbers] = {double(link.other), double(kept),   double(drawn),
                                     double(slip.x),     double(slip.y), double(slip.z)};
        std::copy_n(row, numbers, &out[k * numbers]);
    }
    return out;
}
std::vector<StrandLink> links_of(const std::vector<double>& from) {
    std::vector<StrandLink> out(from.size() / numbers);
    for (size_t k = 0; k < out.size(); ++k) {
        const double* row = &from[k * numbers];
        out[k] = {uint32_t(row[0]),
                  {float(row[1]), float(row[2]), {float(row[3]), float(row[4]), float(row[5])}}};
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
    return of(particles, place_, there_, x_, any_, links_, made_, count_of_, on_other_, begin_, slot_, first_,
              next_, sum_, force_, diagonal_) +
           grid_.bytes() + wide_grid_.bytes() + near_.bytes();
}

}  // namespace wetcurl

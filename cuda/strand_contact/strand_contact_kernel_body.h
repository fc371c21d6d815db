// Contact between strands on a device, link by link. The formulas are those of
// solver/terms/strand_contact.h; the reference is solver/strand_contact/strand_links.h. Differs: what links
// do to particles is added up in whole numbers, whose sums have no order.
#pragma once

#include "cuda/chain/strand_memory.h"
#include "cuda/device/cell_search.h"
#include "solver/strand_contact/link_search.h"

namespace wetcurl {

// A sum of forces [N] and stiffnesses [N/m] on a particle.
struct ContactSum {
    using Whole = unsigned long long;
    Whole x, y, z, stiffness;
    // 1e-16 N, up to 900 N; 1e-12 N/m, up to 9e6.
    static constexpr double of_force = 1e16, of_stiffness = 1e12;
    WETCURL_HD static Whole whole(float a, double unit) {
        const double most = 9.2e18, scaled = double(a) * unit;
        if (!(scaled == scaled)) return 0;
        return Whole((long long)(scaled > most ? most : scaled < -most ? -most : scaled));
    }
    WETCURL_HD static ContactSum of(const Vec3f& force, float stiffness) {
        return {whole(force.x, of_force), whole(force.y, of_force), whole(force.z, of_force),
                whole(stiffness, of_stiffness)};
    }
    WETCURL_HD Vec3f force() const {
        auto of = [](Whole a) { return float(double((long long)a) / of_force); };
        return {of(x), of(y), of(z)};
    }
    WETCURL_HD float slope() const { return float(double((long long)stiffness) / of_stiffness); }
};

// What a link does to the place that has it; the opposite to the other strand.
struct alignas(16) LinkForce {
    Vec3f force;
    float stiffness;
};

// First all particles are seen. Where neighbours are found, all are linked by the order of their cells, links
// are counted by the strands that they lead to, and listed. All links act, those of each strand and those
// that lead to it are added up, and particles are given the sums.
template <class T>
struct StrandContactKernelBody {
    StrandContact term;
    StrandContact::Step step;
    StrandPlaces places;
    float reach;
    CellSearch search;   // of x, in cells that need not be as wide as `reach`
    const Vec3f* drawn;  // (strand, particle) in the groom as drawn
    // (strand, particle): from where the first is expected.
    LinkedParticle* particles;
    Vec3f* x;                   // (strand, particle) where neighbours are found
    StrandLink *links, *found;  // (strand, place, link) those there are, and those found anew
    PlaceOnStrand* other;       // (strand, place, link) where it acts on the other strand
    LinkForce* force;           // (strand, place, link)
    // Links by the strands that they lead to.
    uint32_t* rank;     // (strand, place, link): how many were counted before
    uint32_t* begin;    // (strands + 1) in `leading`
    uint32_t* leading;  // (link that there is) its number

    WETCURL_HD uint32_t particle_count() const { return search.count; }
    WETCURL_HD uint32_t strand_count() const { return search.count / places.n; }
    WETCURL_HD uint32_t place_count() const { return strand_count() * places.count; }
    WETCURL_HD uint32_t link_count() const { return place_count() * uint32_t(most_links); }

    WETCURL_HD void see(uint32_t id, const StrandMemory<T>& m, const Bdf2<T>& scheme, bool finds) const {
        auto expected = [&](uint32_t k) { return scheme.predicted(m.x[k], m.x_before[k], m.v[k]); };
        const Vec3f at = cast<float>(expected(id) - expected(0));
        particles[id] = {at, float(m.mass[id]), cast<float>(m.v[id]),
                         m.saturation ? float(m.saturation[id]) : 0};
        if (finds) x[id] = at;
        if (finds && id % places.n == 0) begin[id / places.n] = 0;
        if (finds && id == 0) begin[strand_count()] = 0;
    }
    // Of sorted particle k. Returns how many.
    WETCURL_HD uint32_t link(uint32_t k) const {
        const uint32_t id = search.sorted[k].id, strand = id / places.n, of_strand = id - strand * places.n;
        const Vec3f from = search.sorted[k].position();
        const LinkSearch near{particles, drawn, places, float(term.radius), reach};
        uint32_t all = 0;
        for (uint32_t which = strand * places.count + places.first_of(of_strand),
                      end = strand * places.count + places.first_of(of_strand + 1);
             which < end; ++which) {
            const PlaceOnStrand place = places.at(which);
            const Vec3f at = place.position(particles);
            const size_t first = size_t(which) * most_links;
            LinkSearch::Candidates candidates = near.begin(strand, at, &links[first]);
            // Those who are nearer to the place are fewer than those who are that near to the particle.
            const float far = std::sqrt(near.farthest(candidates)), off = norm(at - from);
            const bool known = far + off < reach;
            search.within(
                id, known ? at : from, known ? far : reach, [&](uint32_t, const SortedPoint& other) {
                    near.offer(strand, at, other.id, other.id / places.n, other.position(), candidates);
                });
            all += uint32_t(near.link(place, candidates, &links[first], &found[first]));
        }
        return all;
    }
    // add(shared, 1) tells what `shared` was before.
    template <class Add>
    WETCURL_HD void count_link(uint32_t l, Add add) const {
        links[l] = found[l];
        if (links[l].other != StrandLink::none) rank[l] = add(begin[links[l].other / places.n], 1u);
    }
    // Once `begin` sums up the counts of those before.
    WETCURL_HD void list_link(uint32_t l) const {
        if (links[l].other != StrandLink::none) leading[begin[links[l].other / places.n] + rank[l]] = l;
    }
    WETCURL_HD void act(uint32_t l) const {
        StrandLink link = links[l];
        if (link.other == StrandLink::none) {
            force[l] = {{0, 0, 0}, 0};
            return;
        }
        const auto seen = places.see(particles, place_of(l).of(particles), link.other);
        const auto acts = StrandContact::act(step, seen.d, seen.v, seen.wet, seen.weight, link.touch);
        link.other = places.next(seen.other.edge, seen.other.along);
        links[l] = link;
        other[l] = seen.other;
        force[l] = {acts.force, acts.stiffness};
    }
    // What links do to a strand: its places, each with all of its links, and the links that lead to it.
    WETCURL_HD uint32_t acts_on(uint32_t strand) const {
        return places.count + begin[strand + 1] - begin[strand];
    }
    // Calls add(particle of the strand, sum) for the ends of the k-th of them.
    template <class Add>
    WETCURL_HD void add_up(uint32_t strand, uint32_t k, Add add) const {
        const bool leads_here = k >= places.count;
        LinkForce f{{0, 0, 0}, 0};
        PlaceOnStrand place;
        if (leads_here) {
            const uint32_t l = leading[begin[strand] + k - places.count];
            f = force[l], place = other[l];
        } else {
            const uint32_t which = strand * places.count + k, first = which * uint32_t(most_links);
            place = places.at(which);
            for (uint32_t l = first; l < first + uint32_t(most_links); ++l)
                f.force += force[l].force, f.stiffness += force[l].stiffness;
        }
        place.share([&](uint32_t id, float share) {
            add(id - strand * places.n,
                ContactSum::of((leads_here ? -share : share) * f.force, share * f.stiffness));
        });
    }
    // Adds to `force` and `stiffness` where these are another's already.
    WETCURL_HD void give(uint32_t id, const ContactSum& sum, bool adds, Vec3<T>* to_force,
                         T* to_stiffness) const {
        const Vec3<T> f = cast<T>(sum.force());
        const T k = T(StrandContact::on_diagonal(step, sum.slope(), particles[id].mass));
        to_force[id] = adds ? to_force[id] + f : f;
        to_stiffness[id] = adds ? to_stiffness[id] + k : k;
    }
    // [J]
    WETCURL_HD double energy(uint32_t l, const StrandMemory<T>& m) const {
        if (links[l].other == StrandLink::none) return 0;
        return places.energy(term, place_of(l), links[l], m.x, particles);
    }

  private:
    WETCURL_HD PlaceOnStrand place_of(uint32_t l) const { return places.at(l / uint32_t(most_links)); }
};

}  // namespace wetcurl

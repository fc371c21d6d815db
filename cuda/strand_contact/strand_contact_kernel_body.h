// Contact between strands on a device, place by place. The formulas are those of
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
    WETCURL_HD Vec3f force() const {
        auto of = [](Whole a) { return float(double((long long)a) / of_force); };
        return {of(x), of(y), of(z)};
    }
    WETCURL_HD float slope() const { return float(double((long long)stiffness) / of_stiffness); }
};

// Of a link in the substep at hand.
struct ActingLink {
    PlaceOnStrand other;
    Vec3f normal;
    float along, across;
};

// First all particles are seen; where neighbours are found, all are linked by the order of their cells; all
// places act, and all particles are given what acts on them. At the end of the substep all are seen to have
// changed, all places hold back, and all particles are corrected.
template <class T>
struct StrandContactKernelBody {
    StrandContact term;
    StrandContact::Step step;
    StrandPlaces places;
    float reach;
    CellSearch search;   // of x, within `reach`
    const Vec3f* drawn;  // (strand, particle) in the groom as drawn
    // (strand, particle): from where the first is expected [m], speed or its change [m/s], mass [kg], sigma.
    Vec3f *x, *v;
    float *mass, *saturation;
    StrandLink *links, *found;  // (strand, particle, place, link) those there are, and those found anew
    uint8_t* count;             // (strand, particle, place) of links
    ActingLink* acting;         // (strand, particle, place, link)
    ContactSum* sum;            // (strand, particle)
    uint32_t* stiffest;         // the bits of a number that is not negative

    WETCURL_HD void see(uint32_t id, const StrandMemory<T>& m, const Bdf2<T>& scheme) const {
        auto expected = [&](uint32_t k) { return scheme.predicted(m.x[k], m.x_before[k], m.v[k]); };
        x[id] = cast<float>(expected(id) - expected(0)), v[id] = cast<float>(m.v[id]);
        mass[id] = float(m.mass[id]), saturation[id] = m.saturation ? float(m.saturation[id]) : 0;
        sum[id] = {};
        if (id == 0) *stiffest = 0;
    }
    // Of sorted particle k. Returns how many.
    WETCURL_HD uint32_t link(uint32_t k) const {
        const uint32_t id = search.sorted[k].id;
        const LinkSearch links_near{x, drawn, places, float(term.radius), reach};
        uint32_t all = 0;
        for (uint32_t p = 0; p < places.each; ++p) {
            const PlaceOnStrand place = places.at(id, p);
            const Vec3f at = place.of(x);
            LinkSearch::Candidates near;
            if (id % places.n > 1)
                search.neighbours(id, search.sorted[k].position(), [&](uint32_t, const SortedPoint& other) {
                    links_near.offer(id, at, other.id, other.position(), near);
                });
            const size_t which = size_t(id) * places.each + p;
            count[which] =
                uint8_t(links_near.link(place, near, &links[which * most_links], &found[which * most_links]));
            all += count[which];
        }
        return all;
    }
    // Calls add(particle, force, stiffness) for all ends of the links of a place.
    template <class Add>
    WETCURL_HD void act(uint32_t which, Add add) const {
        if (count[which] == 0) return;
        const PlaceOnStrand own = places.at(which / places.each, which % places.each);
        const LinkedStrands strands{places, x, v, mass, saturation};
        for (size_t l = size_t(which) * most_links, end = l + count[which]; l < end; ++l) {
            StrandLink link = links[l];
            const auto [other, acts] = strands.act(step, own, link);
            links[l] = link;
            acting[l] = {other, acts.normal, acts.along, acts.across};
            if (!(acts.stiffness() > 0)) continue;
            add_at(own, acts.force, acts.stiffness(), add), add_at(other, -acts.force, acts.stiffness(), add);
        }
    }
    // Adds to `force` and `stiffness` where these are another's already. max(shared, bits) keeps the larger.
    template <class Max>
    WETCURL_HD void give(uint32_t id, bool adds, Vec3<T>* force, T* stiffness, Max max) const {
        const Vec3<T> f = cast<T>(sum[id].force());
        const T k = T(StrandContact::on_diagonal(step, sum[id].slope(), mass[id]));
        force[id] = adds ? force[id] + f : f;
        stiffness[id] = adds ? stiffness[id] + k : k;
        const float most = StrandContact::stiffest(step, sum[id].slope(), mass[id]);
        if (most > StrandContact::least_stiff) max(*stiffest, bits_of(most));
    }
    WETCURL_HD bool corrects() const { return *stiffest != 0; }
    WETCURL_HD void see_change(uint32_t id, const StrandMemory<T>& m, const Bdf2<T>& scheme) const {
        v[id] = cast<float>(m.v[id] - scheme.expected_velocity(m.v_before[id]));
        sum[id].x = sum[id].y = sum[id].z = 0;
    }
    template <class Add>
    WETCURL_HD void hold_back(uint32_t which, Add add) const {
        if (count[which] == 0) return;
        const PlaceOnStrand own = places.at(which / places.each, which % places.each);
        const Vec3f change = own.of(v);
        for (size_t l = size_t(which) * most_links, end = l + count[which]; l < end; ++l) {
            const ActingLink& link = acting[l];
            const StrandContact::Force acts{{0, 0, 0}, link.normal, link.along, link.across};
            if (!(acts.stiffness() > 0)) continue;
            const Vec3f held = acts.against(change - link.other.of(v));
            add_at(own, -held, 0, add), add_at(link.other, held, 0, add);
        }
    }
    WETCURL_HD void correct(uint32_t id, const StrandMemory<T>& m, const Bdf2<T>& scheme) const {
        if (id % places.n < 2) return;
        const Vec3<T> dv =
            cast<T>(StrandContact::correction(step, mass[id], sum[id].slope(), sum[id].force()));
        m.v[id] += dv, m.x[id] += scheme.h * dv;
    }
    // [J] of the links of a particle.
    WETCURL_HD double energy(uint32_t id, const StrandMemory<T>& m) const {
        double all = 0;
        for (uint32_t p = 0; p < places.each; ++p) {
            const size_t which = size_t(id) * places.each + p;
            for (size_t l = which * most_links, end = l + count[which]; l < end; ++l)
                all += places.energy(term, places.at(id, p), links[l], m.x, mass, saturation);
        }
        return all;
    }

  private:
    WETCURL_HD static uint32_t bits_of(float a) {
        union {
            float number;
            uint32_t bits;
        } both{a};
        return both.bits;
    }
    template <class Add>
    WETCURL_HD static void add_at(const PlaceOnStrand& place, const Vec3f& force, float stiffness, Add add) {
        const float there = place.along, here = 1 - there;
        add(place.edge, here * force, here * stiffness),
            add(place.edge + 1, there * force, there * stiffness);
    }
};

}  // namespace wetcurl

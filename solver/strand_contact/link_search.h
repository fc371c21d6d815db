// Which places of other strands those of a strand are linked to: found once a frame, on the host and on a
// device.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "base/strands.h"
#include "solver/terms/strand_contact.h"

namespace wetcurl {

// The links of a place: to so many strands, the nearest ones, at most.
inline constexpr int most_links = 3;

// Of two strands, whose places are linked to the other's edges. Each has about half of its neighbours.
WETCURL_HD inline bool owns_link(uint32_t strand, uint32_t other) {
    return (strand < other) == (((strand ^ other) & 1) == 1);
}

// Of a place on a strand with the nearest of another.
struct StrandLink {
    static constexpr uint32_t none = ~0u;
    uint32_t other = none;  // (strand, particle) where the edge of the other strand begins that it acts on
    Touch<float> touch{0, 0, {0, 0, 0}};
};

// What links see of a particle: where it is expected [m], mass [kg], speed [m/s] and saturation.
struct alignas(32) LinkedParticle {
    Vec3f x{0, 0, 0};
    float mass = 0;
    Vec3f v{0, 0, 0};
    float saturation = 0;
};
WETCURL_HD inline const Vec3f& position_of(const Vec3f& x) { return x; }
WETCURL_HD inline const Vec3f& position_of(const LinkedParticle& p) { return p.x; }

// A place on a strand: how far along which edge.
struct PlaceOnStrand {
    uint32_t edge;  // (strand, particle) where it begins
    float along;    // within [0, 1]
    WETCURL_HD LinkedParticle of(const LinkedParticle* particles) const {
        return between(particles[edge], particles[edge + 1], along);
    }
    WETCURL_HD static LinkedParticle between(const LinkedParticle& a, const LinkedParticle& b, float t) {
        return {a.x + t * (b.x - a.x), a.mass + t * (b.mass - a.mass), a.v + t * (b.v - a.v),
                a.saturation + t * (b.saturation - a.saturation)};
    }
    template <class Points>
    WETCURL_HD Vec3f position(const Points* points) const {
        const Vec3f &a = position_of(points[edge]), &b = position_of(points[edge + 1]);
        return a + along * (b - a);
    }
    // Calls add(particle, share) for both ends of the edge; not for one that has no share.
    template <class Add>
    WETCURL_HD void share(Add add) const {
        if (along < 1) add(edge, 1 - along);
        if (along > 0) add(edge + 1, along);
    }
};

// Places of strands of n particles, `count` of each, evenly along the edges that the head does not move
// whole: place j lies u = 1 + (j + 1/2) (n - 2) / count edges from the root. In whole numbers: all devices
// agree.
struct StrandPlaces {
    uint32_t n, count;
    // Place j of strand s is number s count + j.
    WETCURL_HD PlaceOnStrand at(uint32_t number) const {
        const uint32_t strand = number / count, halves = halves_of(number - strand * count);
        const uint32_t edge = halves / (2 * count);
        if (edge == n - 1) return {strand * n + edge - 1, 1};  // of strands that the head moves whole
        return {strand * n + edge, float(halves % (2 * count)) / float(2 * count)};
    }
    // Of a strand's particle i: the first of the places that it is next to, which end where those of i + 1
    // begin.
    WETCURL_HD uint32_t first_of(uint32_t i) const {
        const int past = (2 * int(i) - 3) * int(count) - int(n - 2), per = 2 * int(n - 2);
        return past <= 0 ? 0 : i >= n ? count : uint32_t(minimum((past + per - 1) / per, int(count)));
    }
    // Of a particle's mass, so much is a place's.
    WETCURL_HD float part() const { return float(n - 2) / float(count); }
    // The edge of a link in the next substep, if the nearest place of its edge now lies at t, within [0, 1]:
    // at an end the edge beyond, where there is one.
    WETCURL_HD uint32_t next(uint32_t edge, float t) const {
        if (t >= 1 && (edge + 2) % n != 0) return edge + 1;
        if (t <= 0 && edge % n != 0) return edge - 1;
        return edge;
    }
    // What the law is told of a link of a place, `own` what is seen there.
    struct Seen {
        PlaceOnStrand other;
        Vec3f d, v;
        float wet, weight;
    };
    WETCURL_HD Seen see(const LinkedParticle* particles, const LinkedParticle& own, uint32_t edge) const {
        const LinkedParticle a = particles[edge], b = particles[edge + 1];
        const float t = nearest_on(own.x, a.x, b.x);
        const PlaceOnStrand other{edge, t};
        const LinkedParticle there = PlaceOnStrand::between(a, b, t);
        return {other, own.x - there.x, own.v - there.v, own.saturation * there.saturation,
                part() * StrandContact::weight(own.mass, there.mass)};
    }
    // [J] of a link of a place, particles at x.
    template <class T>
    WETCURL_HD double energy(const StrandContact& term, const PlaceOnStrand& own, const StrandLink& link,
                             const Vec3<T>* x, const LinkedParticle* particles) const {
        const double along = double(own.along);
        auto between = [](double a, double b, double t) { return a + t * (b - a); };
        auto position = [&](uint32_t id) { return cast<double>(x[id] - x[0]); };
        const uint32_t a = own.edge, b = link.other;
        const Vec3d p = position(a) + along * (position(a + 1) - position(a)), from = position(b),
                    e = position(b + 1) - from;
        const double t =
            minimum(maximum(dot(p - from, e) / maximum(dot(e, e), double(tiny_length<double>)), 0.0), 1.0);
        auto of_both = [&](float LinkedParticle::*of, auto join) {
            return join(between(double(particles[a].*of), double(particles[a + 1].*of), along),
                        between(double(particles[b].*of), double(particles[b + 1].*of), t));
        };
        const double wet = of_both(&LinkedParticle::saturation, [](double s, double r) { return s * r; });
        const double weight =
            of_both(&LinkedParticle::mass, [](double m, double w) { return StrandContact::weight(m, w); });
        return term.potential(norm(p - from - t * e), wet, double(part()) * weight, link.touch);
    }

  private:
    // 2 count u of place j.
    WETCURL_HD uint32_t halves_of(uint32_t j) const { return 2 * count + (2 * j + 1) * (n - 2); }
};

// [m] of the longest edge of the groom as drawn.
inline double longest_edge(const Strands& drawn) {
    double longest = 0;
    for (int s = 0; s < drawn.count; ++s)
        for (int i = 0; i + 1 < drawn.particles; ++i)
            longest = std::max(longest, double(norm(drawn.at(s, i + 1) - drawn.at(s, i))));
    return longest;
}

// What a run carries of links (strand, place, link), under this name; and how many each place has.
inline constexpr const char* carried_links = "strand links";
std::vector<double> numbers_of(const std::vector<StrandLink>& links);
std::vector<StrandLink> links_of(const std::vector<double>& numbers);
std::vector<uint8_t> links_in_places(const std::vector<StrandLink>& links);

// Of a search's cells, in which a few particles lie [m]: from most particles of the groom as drawn the
// nearest few of other strands are no farther. At most `reach`, and not much less.
double cell_side(const Strands& drawn, double reach);

struct LinkSearch {
    // What a place is linked to already counts as so much nearer: links that come and go keep hair from rest.
    static constexpr float stays = 0.75f;

    const LinkedParticle* particles;  // (strand, particle)
    const Vec3f* drawn;               // the same in the groom as drawn [m]
    StrandPlaces places;
    float radius, reach;  // [m] that strands keep; within which particles are offered

    // The nearest particles of the nearest strands so far, nearest first. What counts as farther than `worst`
    // [m^2] is none of them.
    struct Candidates {
        float square[most_links] = {}, worst = std::numeric_limits<float>::infinity();
        uint32_t particle[most_links] = {}, strand[most_links] = {}, before[most_links] = {};
        int count = 0;
    };
    // Of a square distance: at least what it comes to elsewhere, in another order of operations.
    WETCURL_HD static float rounded_up(float square) { return 1.00001f * square; }
    // Of a place of a strand at p, with the links that it had: their strands stand first.
    WETCURL_HD Candidates begin(uint32_t strand, const Vec3f& p, const StrandLink* before) const {
        Candidates to;
        for (int k = 0; k < most_links; ++k)
            to.before[k] =
                before[k].other == StrandLink::none ? StrandLink::none : before[k].other / places.n;
        for (int k = 0; k < most_links; ++k) {
            if (to.before[k] == StrandLink::none) continue;
            const uint32_t edge = before[k].other;
            const Vec3f a = p - particles[edge].x, b = p - particles[edge + 1].x;
            const uint32_t nearer = dot(b, b) < dot(a, a) ? edge + 1 : edge;
            offer(strand, p, nearer, to.before[k], particles[nearer].x, to);
        }
        return to;
    }
    // To a place of a strand at p: a particle near by, of a strand that is another, where that is.
    WETCURL_HD static void offer(uint32_t strand, const Vec3f& p, uint32_t particle, uint32_t other,
                                 const Vec3f& where, Candidates& to) {
        const Vec3f d = p - where;
        float square = dot(d, d);
        if (stays * square > to.worst || !owns_link(strand, other)) return;
        for (int k = 0; k < most_links; ++k)
            if (to.before[k] == other) square = stays * dot(d, d);
        if (square > to.worst) return;
        int at = 0;  // where that strand stands, or else the end
        while (at < to.count && to.strand[at] != other) ++at;
        if (at == to.count) {
            if (to.count < most_links)
                ++to.count;
            else if (!nearer(square, particle, to, at = most_links - 1))
                return;
        } else if (!nearer(square, particle, to, at)) {
            return;
        }
        for (; at > 0 && nearer(square, particle, to, at - 1); --at)
            to.square[at] = to.square[at - 1], to.particle[at] = to.particle[at - 1],
            to.strand[at] = to.strand[at - 1];
        to.square[at] = square, to.particle[at] = particle, to.strand[at] = other;
        if (to.count == most_links) to.worst = to.square[most_links - 1];
    }
    // Particles that are farther from a place than this [m^2] need no offer.
    WETCURL_HD static float farthest(const Candidates& of) { return rounded_up(of.worst / stays); }
    // The links of a place from now on; `before`: those that it had. Returns how many.
    WETCURL_HD int link(const PlaceOnStrand& place, const Candidates& found, const StrandLink* before,
                        StrandLink* links) const {
        const Vec3f p = place.position(particles), p_drawn = place.position(drawn);
        int count = 0;
        for (int k = 0; k < found.count; ++k) {
            const StrandLink* had = nullptr;
            for (int old = 0; old < most_links; ++old)
                if (found.before[old] == found.strand[k]) had = &before[old];
            StrandLink made = had ? *had : StrandLink();
            float r = had ? distance(particles, p, had->other) : 0;
            const uint32_t nearest = nearest_edge(particles, p, found.particle[k], found.strand[k]);
            const float there = distance(particles, p, nearest);
            // Inside a bend two edges may be the nearest in turn. What has become nearer by a jump is not
            // pressed yet: else each jump would bring energy.
            if (!had || there < stays * r) {
                if (had && had->other != nearest)
                    made.touch.kept = minimum(had->touch.kept, there), made.touch.slip = {0, 0, 0};
                made.other = nearest, r = there;
            }
            if (!(r < 2 * radius)) continue;  // beyond that nothing acts
            if (!had) {
                const uint32_t there = nearest_edge(drawn, p_drawn, found.particle[k], found.strand[k]);
                made.touch.drawn = minimum(radius, distance(drawn, p_drawn, there));
                made.touch.kept = minimum(made.touch.drawn, r);
            }
            links[count++] = made;
        }
        for (int k = count; k < most_links; ++k) links[k] = StrandLink();
        return count;
    }

  private:
    WETCURL_HD static bool nearer(float square, uint32_t particle, const Candidates& than, int at) {
        return square < than.square[at] || (square == than.square[at] && particle < than.particle[at]);
    }
    template <class Points>
    WETCURL_HD static float distance(const Points* points, const Vec3f& p, uint32_t edge) {
        const PlaceOnStrand there{edge,
                                  nearest_on(p, position_of(points[edge]), position_of(points[edge + 1]))};
        return norm(p - there.position(points));
    }
    // The edge next to a particle, or on from there as long as edges come nearer to p.
    template <class Points>
    WETCURL_HD uint32_t nearest_edge(const Points* points, const Vec3f& p, uint32_t particle,
                                     uint32_t strand) const {
        const uint32_t begin = strand * places.n, last = begin + places.n - 2;
        uint32_t at = particle < last ? particle : last;
        float least = distance(points, p, at);
        for (uint32_t next = at; next < last;) {
            const float r = distance(points, p, ++next);
            if (!(r < least)) break;
            least = r, at = next;
        }
        for (uint32_t next = at; next > begin;) {
            const float r = distance(points, p, --next);
            if (!(r < least)) break;
            least = r, at = next;
        }
        return at;
    }
};

}  // namespace wetcurl

// Which places of other strands those of a strand are linked to: found once a frame, on the host and on a
// device.
#pragma once

#include <algorithm>
#include <vector>

#include "base/strands.h"
#include "solver/terms/strand_contact.h"

namespace wetcurl {

// The links of a place: to so many strands, the nearest ones, at most.
inline constexpr int most_links = 4;

// Of two strands, whose places are linked to the other's edges. Each has about half of its neighbours.
WETCURL_HD inline bool owns_link(uint32_t strand, uint32_t other) {
    return (strand < other) == (((strand ^ other) & 1) == 1);
}

// A place on a strand: how far along which edge.
struct PlaceOnStrand {
    uint32_t edge;  // (strand, particle) where it begins
    float along;    // within [0, 1]
    WETCURL_HD Vec3f of(const Vec3f* points) const {
        return points[edge] + along * (points[edge + 1] - points[edge]);
    }
    WETCURL_HD float of(const float* numbers) const {
        return numbers[edge] + along * (numbers[edge + 1] - numbers[edge]);
    }
};

// Places at even distances along strands of n particles, so many to a particle, around it.
struct StrandPlaces {
    uint32_t n, each;
    // The k-th of particle id, not on an edge that the head moves whole.
    WETCURL_HD PlaceOnStrand at(uint32_t id, uint32_t k) const {
        const float from = (float(k) - 0.5f * float(each - 1)) / float(each);
        const uint32_t i = id % n;
        if (from < 0 && i > 1) return {id - 1, 1 + from};
        if (i == n - 1) return {id - 1, 1};
        return {id, from > 0 ? from : 0};
    }
    // [J] of a link of a place, particles at x.
    template <class T>
    WETCURL_HD double energy(const StrandContact& term, const PlaceOnStrand& own, const StrandLink& link,
                             const Vec3<T>* x, const float* mass, const float* saturation) const {
        const double along = double(own.along), part = 1 / double(each);
        auto between = [](double a, double b, double t) { return a + t * (b - a); };
        auto position = [&](uint32_t id) { return cast<double>(x[id] - x[0]); };
        const uint32_t a = own.edge, b = link.other;
        const Vec3d p = position(a) + along * (position(a + 1) - position(a)), from = position(b),
                    e = position(b + 1) - from;
        const double t =
            minimum(maximum(dot(p - from, e) / maximum(dot(e, e), double(tiny_length<double>)), 0.0), 1.0);
        auto of_both = [&](const float* of, double t_own, double t_other, auto join) {
            return join(between(double(of[a]), double(of[a + 1]), t_own),
                        between(double(of[b]), double(of[b + 1]), t_other));
        };
        const double wet = of_both(saturation, along, t, [](double s, double r) { return s * r; });
        const double weight = of_both(
            mass, along, t, [&](double m, double w) { return StrandContact::weight(part * m, part * w); });
        return term.potential(norm(p - from - t * e), wet, weight, link);
    }
    // The same edge or one of those next to it, on which the nearest place to p lies, if that is a place of
    // the edge or one beside it.
    WETCURL_HD PlaceOnStrand nearest(const Vec3f* points, const Vec3f& p, uint32_t edge) const {
        const uint32_t begin = edge - edge % n, last = begin + n - 2;
        const float t = nearest_on(p, points[edge], points[edge + 1]);
        const uint32_t next = t >= 1 && edge < last ? edge + 1 : t <= 0 && edge > begin ? edge - 1 : edge;
        return {next, next == edge ? t : nearest_on(p, points[next], points[next + 1])};
    }
};

// What links see of the strands, (strand, particle): where they are expected [m], speed [m/s], mass [kg] and
// saturation.
struct LinkedStrands {
    StrandPlaces places;
    const Vec3f *x, *v;
    const float *mass, *saturation;

    struct Acting {
        PlaceOnStrand other;
        StrandContact::Force acts;
    };
    // A link of a place, which follows to the nearest place of the other strand.
    WETCURL_HD Acting act(const StrandContact::Step& step, const PlaceOnStrand& own, StrandLink& link) const {
        const Vec3f p = own.of(x);
        const PlaceOnStrand other = places.nearest(x, p, link.other);
        link.other = other.edge;
        const float part = 1 / float(places.each);
        return {other,
                StrandContact::act(step, p - other.of(x), own.of(v) - other.of(v),
                                   own.of(saturation) * other.of(saturation),
                                   StrandContact::weight(part * own.of(mass), part * other.of(mass)), link)};
    }
};

// [m] of the longest edge of the groom as drawn.
inline double longest_edge(const Strands& drawn) {
    double longest = 0;
    for (int s = 0; s < drawn.count; ++s)
        for (int i = 0; i + 1 < drawn.particles; ++i)
            longest = std::max(longest, double(norm(drawn.at(s, i + 1) - drawn.at(s, i))));
    return longest;
}

// What a run carries of links (strand, particle, place, link), under this name; and how many each place has.
inline constexpr const char* carried_links = "strand links";
std::vector<double> numbers_of(const std::vector<StrandLink>& links);
std::vector<StrandLink> links_of(const std::vector<double>& numbers);
std::vector<uint8_t> links_in_places(const std::vector<StrandLink>& links);

struct LinkSearch {
    const Vec3f *x, *drawn;  // (strand, particle) [m]
    StrandPlaces places;
    float radius, reach;  // [m] that strands keep; within which links are made

    // The nearest particles of the nearest strands so far, nearest first.
    struct Candidates {
        float square[most_links] = {};
        uint32_t particle[most_links] = {};
        int count = 0;
    };
    // A place of particle `id` at p, and a particle near by, where that is.
    WETCURL_HD void offer(uint32_t id, const Vec3f& p, uint32_t other, const Vec3f& where,
                          Candidates& to) const {
        if (!owns_link(id / places.n, other / places.n)) return;
        const Vec3f d = p - where;
        const float square = dot(d, d);
        int at = 0;  // where that strand stands, or else the end
        while (at < to.count && to.particle[at] / places.n != other / places.n) ++at;
        if (at == to.count) {
            if (to.count < most_links)
                ++to.count;
            else if (!nearer(square, other, to, at = most_links - 1))
                return;
        } else if (!nearer(square, other, to, at)) {
            return;
        }
        for (; at > 0 && nearer(square, other, to, at - 1); --at)
            to.square[at] = to.square[at - 1], to.particle[at] = to.particle[at - 1];
        to.square[at] = square, to.particle[at] = other;
    }
    // The links of a place from now on; `before`: those that it had. Returns how many.
    WETCURL_HD int link(const PlaceOnStrand& place, const Candidates& found, const StrandLink* before,
                        StrandLink* links) const {
        const Vec3f p = place.of(x), p_drawn = place.of(drawn);
        int count = 0;
        for (int k = 0; k < found.count; ++k) {
            const uint32_t strand = found.particle[k] / places.n;
            StrandLink made;
            made.other = nearest_edge(x, p, found.particle[k]);
            const float r = distance(x, p, made.other);
            if (!(r < reach)) continue;
            const StrandLink* had = nullptr;
            for (int old = 0; old < most_links; ++old)
                if (before[old].other != StrandLink::none && before[old].other / places.n == strand)
                    had = &before[old];
            if (had) {
                made.kept = had->kept, made.drawn = had->drawn, made.slip = had->slip;
            } else {
                made.drawn = minimum(
                    radius, distance(drawn, p_drawn, nearest_edge(drawn, p_drawn, found.particle[k])));
                made.kept = minimum(made.drawn, r);
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
    WETCURL_HD static float distance(const Vec3f* points, const Vec3f& p, uint32_t edge) {
        return norm(p - PlaceOnStrand{edge, nearest_on(p, points[edge], points[edge + 1])}.of(points));
    }
    // The edge next to a particle, or on from there as long as edges come nearer to p.
    WETCURL_HD uint32_t nearest_edge(const Vec3f* points, const Vec3f& p, uint32_t particle) const {
        const uint32_t begin = particle - particle % places.n, last = begin + places.n - 2;
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

// Cohesion of wet strands: displayed positions drawn toward wet neighbours on other strands.
// The paper, Eq 10. Differs: print lacks m/rho below and scales about the world's origin; the self term in
// the denominator keeps two lone strands from swapping places and makes the displacement continuous at r = h.
// It holds the particle's own strand, taken as straight: the particle alone is too little where segments are
// short beside h. The displacement is then smoothed along the strand over `coherence`, since a few passes of
// Eq 10 alone draw curls into knots of particles: strands come together whole and keep their curl. 0 leaves
// Eq 10 as it is. Such a displacement may be asked for at some particles of a strand alone (`spacing`),
// fewer, over-relaxed passes may stand for all (`relaxation`), and in dense hair some strands for all
// (`neighbours`). A lock then gathers hair of a width that goes with h, whatever is drawn of it
// (`lock_width`).
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/geometry/kernels.h"
#include "base/geometry/shapes.h"
#include "base/parameters.h"

namespace wetcurl {

struct Cohesion {
    static constexpr const char *name = "cohesion", *table = "cohesion",
                                *about = "Clumping of wet strands; needs [wetness].";
    double h_c, lambda, coherence, stretch, strength, spacing = 0, relaxation = 1, lock_width = 0;
    int passes = 10, neighbours = 0;
    // Measured: width of the hair that a lock gathers, in h; and how far apart particles may be asked, in h.
    static constexpr double width_of_radius = 1.5, spacing_of_radius = 0.6;
    static constexpr double most_relaxation = 3.4;  // [passes] of a sweep; more would let strands swap places
    static constexpr Parameter<Cohesion> parameters[] = {
        {KeyRow::number(
             "lock_width", "m", 0.012, 1e-6, 1,
             "Width of the hair that one lock gathers, however many strands are drawn of it; in the "
             "place of radius.",
             "ours"),
         &Cohesion::lock_width},
        {KeyRow::number("radius", "m", 0, 1e-6, 1, "Distance within which wet strands attract.",
                        "Eq 10, h: support of W")
             .without_default("lock_width / 1.5"),
         &Cohesion::h_c},
        {KeyRow::number("tightness", "1", 0.97, 0, 0.999,
                        "Share of the way to the mean of its neighbours that a particle moves in a pass.",
                        "Eq 10, lambda"),
         &Cohesion::lambda},
        {KeyRow::number("coherence", "m", 0.01, 0, 1,
                        "Length along the strand over which the displacement is smoothed.", "ours"),
         &Cohesion::coherence},
        {KeyRow::number(
             "stretch", "1", 0.05, 0, 1000,
             "Largest strain of a displayed edge against the simulated one; around a solid 1 or more.",
             "ours"),
         &Cohesion::stretch},
        {KeyRow::number("strength", "1/s^2", 0, 0, 1e12,
                        "Strength of forces in every substep, beside what is displayed; 0: none.",
                        "ours, after Sec. VI.A.2"),
         &Cohesion::strength},
        {KeyRow::number(
             "spacing", "m", 0, 0, 1,
             "Approximate distance along a strand between particles at which Eq 10 is computed; those "
             "between are interpolated; 0: at each particle.",
             "ours")
             .without_default("0.6 times the radius; 0 beside [wetness.flow] and strength"),
         &Cohesion::spacing},
        {KeyRow::number(
             "relaxation", "1", most_relaxation, 1, most_relaxation,
             "Approximate number of passes that one over-relaxed sweep replaces; 1: no such sweeps.", "ours"),
         &Cohesion::relaxation},
        {KeyRow::integer("passes", 10, 1, 1000, "Passes of Eq 10 in a frame.", "Eq 10"), &Cohesion::passes},
        {KeyRow::integer(
             "neighbours", 100, 0, 1e6,
             "Neighbours that Eq 10 sees of a particle in the mean, at most: where the drawn hair "
             "has more, some strands stand for all; 0: all. Beside [wetness.flow] and strength all "
             "are seen.",
             "ours"),
         &Cohesion::neighbours},
    };

    // What the table does not write and follows from what it does. Throws Misuse where it writes both of two
    // keys that say the same.
    void complete(const Table& written, bool flows) {
        if (written.has("radius") && written.has("lock_width"))
            written.fail("lock_width",
                         "found beside radius; allowed is one of the two: radius = lock_width / 1.5");
        if (!written.has("radius")) h_c = lock_width / width_of_radius;
        const bool all = flows || strength > 0;  // whose forces go by the same neighbours
        if (all) neighbours = 0;
        if (!all && !written.has("spacing")) spacing = spacing_of_radius * h_c;
    }
    // Sweeps that stand for the passes.
    int sweeps() const { return std::min(passes, std::max(2, int(std::ceil(passes / relaxation)))); }
    // By how much more than a pass the k-th of them moves: they come in threes, the last with what is left.
    // A pass takes modes of what is linear to 1 - x of themselves, 0 <= x <= lambda < 1, and d sweeps that
    // stand for n passes to a polynomial P(x) of degree d with P(0) = 1, P'(0) = -n and the least |P|
    // elsewhere (Young 1954, Chebyshev's): below 1 up to n = 2 d^2, where strands would begin to swap places.
    // The shortest comes first, so that the longest, next, finds little that it would overshoot.
    double relaxed(int k) const {
        const int all = sweeps(), last = 3 * std::max(0, all / 3 - 1), d = k < last ? 3 : all - last;
        if (all == passes) return 1;
        const double n = double(d) * passes / all;
        double u = 0, beyond = 64;  // n = d tanh(d u) / tanh(u / 2), which falls with u
        for (int halved = 0; halved < 60; ++halved) {
            const double middle = (u + beyond) / 2;
            (d * std::tanh(d * middle) > n * std::tanh(middle / 2) ? u : beyond) = middle;
        }
        const int root = ((k < last ? k % 3 : k - last) + d - 1) % d;
        const double w = std::cosh(u);
        return (w + 1) / (w - std::cos((root + 0.5) * std::numbers::pi / d));
    }
    // Eq 10 as the k-th takes it.
    Cohesion of_sweep(int k) const {
        Cohesion term = *this;
        term.lambda *= relaxed(k);
        return term;
    }

    // The sums of Eq 10 over neighbours j, each with its volume V_j = m_j / rho and sigma_j V_j. All weights
    // are in units of W(0), which Eq 10 cancels.
    template <class S>
    struct Sums {
        Vec3<S> pull;  // sum sigma_j V_j W_ij / W(0) (p_j - p_i)
        S weight;      // sum V_j W_ij / W(0)
        WETCURL_HD void add(const Vec3<S>& p_ij, const S& h, const S& volume, const S& wet_volume) {
            const S w = kernel_shape(norm(p_ij), h);
            pull += wet_volume * w * p_ij;
            weight += volume * w;
        }
    };
    // The spring [N/m] of two that touch, both drenched; of two that are r [m] apart, `wet` = sigma_i
    // sigma_j, and their energy [J].
    WETCURL_HD double touching_spring(double m_i, double m_j) const {
        return strength * 2 * m_i * m_j / (m_i + m_j);
    }
    WETCURL_HD double pair_spring(double r, double m_i, double m_j, double wet) const {
        return wet * touching_spring(m_i, m_j) * kernel_shape(r, h_c);
    }
    WETCURL_HD double pair_energy(double r, double m_i, double m_j, double wet) const {
        return -(wet * touching_spring(m_i, m_j)) * kernel_shape_moment(r, h_c);
    }
    // The potential is concave in the squared distance: springs of today's stiffness bound it, and twice the
    // sum at each end bounds those.
    static constexpr double outweighed = 2;
    // sum V_k W_ik / W(0) over the particle's own strand, for each unit of its volume: segments of `length`
    // on a line.
    WETCURL_HD double own_weight(double length) const {
        double sum = 1;
        for (int k = 1; length > 0 && k * length < h_c; ++k) sum += 2 * kernel_shape(k * length, h_c);
        return sum;
    }
    // How long an edge of that simulated length may show where a solid tears it (base/geometry/shapes.h).
    WETCURL_HD float torn_beyond(float length) const {
        return maximum(torn_lengths, float(1 + stretch)) * length;
    }
    // The displayed end of an edge from x to `end`, whose simulated length is given: hair that is drawn to
    // two clumps at once must not show as a stretched line.
    template <class S>
    WETCURL_HD Vec3<S> within_length(const Vec3<S>& x, const Vec3<S>& end, const S& length) const {
        const Vec3<S> e = end - x;
        const S most = S(1 + stretch) * length, now = dot(e, e), least(tiny_length<S> * tiny_length<S>);
        return select(now > most * most, x + (most / sqrt(maximum(now, least))) * e, end);
    }
    // p_i^w - p_i, `own` the particle's volume times its strand's own_weight.
    template <class S>
    WETCURL_HD Vec3<S> displacement(const Sums<S>& s, const S& own) const {
        return (S(lambda) / (own + s.weight)) * s.pull;
    }
};

}  // namespace wetcurl

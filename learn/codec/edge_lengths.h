// Edges of learned strands, led back toward their lengths at rest. What a network cannot know it answers with
// the mean of, and means of curls are shorter than these. Distances as of position-based dynamics (Müller et
// al. 2007), all edges of a strand at once, a few rounds: what is large along a strand stays.
#pragma once

#include "base/pack.h"
#include "base/vec3.h"

namespace wetcurl {

inline constexpr int most_length_rounds = 4;

// Half of what an edge lacks of its length, along it.
template <class S>
WETCURL_HD Vec3<S> half_lacking(const Vec3<S>& edge, const S& length) {
    const S square = dot(edge, edge), least(tiny_length<S> * tiny_length<S>);
    const S inverse = S(1) / sqrt(maximum(square, least));  // one instruction on a device
    return (S(0.5f) * length * inverse - S(0.5f)) * edge;
}

// So many rounds of one strand x (n), or of a strand a lane; length[i]: of the edge to particle i. The root
// stays.
template <class S>
void lead_to_lengths(int n, const S* length, int rounds, Vec3<S>* x) {
    for (int round = 0; round < rounds; ++round) {
        Vec3<S> lacks{S(0), S(0), S(0)};  // the edge to particle i, before the round
        for (int i = 0; i + 1 < n; ++i) {
            const Vec3<S> next = half_lacking(x[i + 1] - x[i], length[i + 1]);
            if (i > 0) x[i] += lacks - next;
            lacks = next;
        }
        if (n > 1) x[n - 1] += lacks;
    }
}

}  // namespace wetcurl

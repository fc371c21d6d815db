// Edges of learned strands, led back toward their lengths at rest. What a network cannot know it answers with
// the mean of, and means of curls are shorter than these. Distances as of position-based dynamics (Müller et
// al. 2007), all edges of a strand at once, a few rounds: what is large along a strand stays.
#pragma once

#include "base/pack.h"
#include "base/vec3.h"

namespace wetcurl {

inline constexpr int most_length_rounds = 4;

// Half of what an edge lacks of its length, along it.
WETCURL_HD inline Vec3f half_lacking(const Vec3f& edge, float length) {
    const float square = dot(edge, edge), least = tiny_length<float> * tiny_length<float>;
    const float inverse = 1 / std::sqrt(maximum(square, least));  // one instruction on a device
    return (0.5f * length * inverse - 0.5f) * edge;
}

// So many rounds of one strand x (n); length[i]: of the edge to particle i. The root stays. `room`: (6 n), an
// axis after the other, where many edges go at once.
void lead_to_lengths(int n, const float* length, int rounds, Vec3f* x, float* room);

}  // namespace wetcurl

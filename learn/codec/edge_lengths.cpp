// Edges led on the CPU.
#include "learn/codec/edge_lengths.h"

namespace wetcurl {

void lead_to_lengths(int n, const float* length, int rounds, Vec3f* x, float* room) {
    float *const at[] = {room, room + n, room + 2 * n}, *const lacks[] = {room + 3 * n, room + 4 * n,
                                                                          room + 5 * n};
    for (int i = 0; i < n; ++i) at[0][i] = x[i].x, at[1][i] = x[i].y, at[2][i] = x[i].z;
    for (int round = 0; round < rounds; ++round) {
#pragma omp simd
        for (int i = 1; i < n; ++i) {
            const Vec3f lacking = half_lacking(
                {at[0][i] - at[0][i - 1], at[1][i] - at[1][i - 1], at[2][i] - at[2][i - 1]}, length[i]);
            lacks[0][i] = lacking.x, lacks[1][i] = lacking.y, lacks[2][i] = lacking.z;
        }
        for (int axis = 0; axis < 3; ++axis) {
#pragma omp simd
            for (int i = 1; i < n - 1; ++i) at[axis][i] += lacks[axis][i] - lacks[axis][i + 1];
            if (n > 1) at[axis][n - 1] += lacks[axis][n - 1];
        }
    }
    for (int i = 0; i < n; ++i) x[i] = {at[0][i], at[1][i], at[2][i]};
}

}  // namespace wetcurl

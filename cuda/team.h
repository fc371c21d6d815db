// Who steps a few strands together: on a device the threads of a block; elsewhere one thread. Ours.
#pragma once

#include "base/host_device.h"

namespace wetcurl {

struct Team {
    int thread = 0, threads = 1;

    WETCURL_HD void wait() const {
#ifdef __CUDA_ARCH__
        __syncthreads();
#endif
    }
    // Waits. Whether it holds for any thread.
    WETCURL_HD bool any(bool mine) const {
#ifdef __CUDA_ARCH__
        return __syncthreads_or(mine);
#else
        return mine;
#endif
    }
    // Sets bits of a number that the team shares.
    WETCURL_HD static void raise(unsigned& shared, unsigned bits) {
#ifdef __CUDA_ARCH__
        atomicOr(&shared, bits);
#else
        shared |= bits;
#endif
    }
    // f(k) for 0 <= k < count, shared out among the threads.
    template <class F>
    WETCURL_HD void each(int count, F f) const {
        for (int k = thread; k < count; k += threads) f(k);
    }
    // f(k, l) for 0 <= k < count, 0 <= l < span likewise. Waits for all.
    template <class F>
    WETCURL_HD void share(int count, int span, F f) const {
        // The quotient of whole numbers below 2^20; their division takes a device far longer.
        const float inverse = 1.0f / float(span);
        for (int job = thread; job < count * span; job += threads) {
            const int k = int((float(job) + 0.5f) * inverse);
            f(k, job - k * span);
        }
        wait();
    }

    // A part of the team, which goes through the steps of one job together: on a device eight of its threads.
#ifdef __CUDA_ARCH__
    static constexpr int of_a_part = 8;
#else
    static constexpr int of_a_part = 1;
#endif
    // So many of a step's pieces of work fall to one of them.
    static constexpr int share_of(int pieces) { return (pieces + of_a_part - 1) / of_a_part; }
    WETCURL_HD static void part_waits() {
#ifdef __CUDA_ARCH__
        __syncwarp();
#endif
    }
    // f(job, member) for 0 <= job < count and the members of its part. f must wait as often for any job.
    // Waits for all.
    template <class F>
    WETCURL_HD void by_parts(int count, F f) const {
        // Whole warps, so that their parts wait together.
        const int whole = (count * of_a_part + 31) / 32 * 32;
        for (int k = thread; k < (of_a_part > 1 ? whole : count); k += threads)
            f(k / of_a_part, k % of_a_part);
        wait();
    }
};

}  // namespace wetcurl

// A thread team: the threads of one CUDA block, or one host thread in tests, and how they wait for each
// other.
#pragma once

#include "base/host_device.h"

namespace wetcurl {

// One thread.
struct Alone {
    // So many of its threads make a part of a team.
    static constexpr int of_a_part = 1;
    WETCURL_HD void wait() const {}
    WETCURL_HD bool any(bool mine) const { return mine; }
    WETCURL_HD void part_waits() const {}
    WETCURL_HD static void raise(unsigned& shared, unsigned bits) { shared |= bits; }
    WETCURL_HD static unsigned add(unsigned& shared, unsigned count) { return (shared += count) - count; }
    WETCURL_HD static void at_least(unsigned& shared, unsigned bound) {
        if (shared < bound) shared = bound;
    }
};
#ifdef __CUDACC__
// The threads of a block. A part waits with its warp.
struct Block {
    static constexpr int of_a_part = 8;
    __device__ void wait() const { __syncthreads(); }
    __device__ bool any(bool mine) const { return __syncthreads_or(mine); }
    __device__ void part_waits() const { __syncwarp(); }
    __device__ static void raise(unsigned& shared, unsigned bits) { atomicOr(&shared, bits); }
    __device__ static unsigned add(unsigned& shared, unsigned count) { return atomicAdd(&shared, count); }
    __device__ static void at_least(unsigned& shared, unsigned bound) { atomicMax(&shared, bound); }
};
#endif

// One of `threads`, each of which goes through the same. Barrier: wait() for all; any(mine), which waits too,
// tells whether it holds for any; part_waits() for those of the same part. Of a number that all share raise()
// sets bits, at_least() a lower bound, and add() tells what it was before.
template <class Barrier>
struct ThreadTeam : Barrier {
    static constexpr int warp = 32;
    int thread, threads;
    WETCURL_HD ThreadTeam(const Barrier& meeting, int thread, int threads)
        : Barrier(meeting), thread(thread), threads(threads) {}

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
        this->wait();
    }

    // So many of the pieces of each step of a part's job fall to one of it.
    static constexpr int share_of(int pieces) {
        return (pieces + Barrier::of_a_part - 1) / Barrier::of_a_part;
    }
    // f(job, member) for 0 <= job < count and the members of a part each, which take its steps together.
    // Whole warps do, so that their parts wait together: some have a job beyond the count, and f waits as
    // often for any. Waits for all.
    template <class F>
    WETCURL_HD void by_parts(int count, F f) const {
        constexpr int part = Barrier::of_a_part;
        const int all = part > 1 ? (count * part + warp - 1) / warp * warp : count;
        for (int k = thread; k < all; k += threads) f(k / part, k % part);
        this->wait();
    }
};

}  // namespace wetcurl

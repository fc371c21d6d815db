// Who steps a block of strands together: on a device the warps of a thread block, a lane a strand; elsewhere
// one thread, lane by lane. Ours.
#pragma once

#include "base/host_device.h"

namespace wetcurl {

struct Team {
    int lane = 0, member = 0, members = 1;
    unsigned (*flags)[32] = nullptr;  // (3) for each lane, zero at first, in memory that the team shares
    int used = 0;

    WETCURL_HD void wait() const {
#ifdef __CUDA_ARCH__
        __syncthreads();
#endif
    }
    // Waits. Whether it holds for any lane of any member.
    WETCURL_HD bool any(bool mine) const {
#ifdef __CUDA_ARCH__
        return __syncthreads_or(mine);
#else
        return mine;
#endif
    }
    // Waits. The bits that any member has set for this lane.
    WETCURL_HD unsigned together(unsigned mine) {
#ifdef __CUDA_ARCH__
        unsigned* now = &flags[used][lane];
        used = used == 2 ? 0 : used + 1;
        if (member == 0) flags[used][lane] = 0;  // read last two waits ago
        if (mine) atomicOr(now, mine);
        __syncthreads();
        return *now;
#else
        return mine;
#endif
    }
    // f(i) for first <= i < end of an active lane, shared out among the members. Waits for all.
    template <class F>
    WETCURL_HD void share(bool active, int first, int end, F f) const {
        for (int i = first + member; active && i < end; i += members) f(i);
        wait();
    }
    // The same as f(i, load(i)): what the next one needs is on its way while one is worked on.
    template <class Load, class F>
    WETCURL_HD void share(bool active, int first, int end, Load load, F f) const {
        int i = first + member;
        if (active && i < end) {
            auto next = load(i);
            for (; i < end; i += members) {
                const auto now = next;
                if (i + members < end) next = load(i + members);
                f(i, now);
            }
        }
        wait();
    }
};

}  // namespace wetcurl

// Teams on the host: one thread, or some of this machine's in the place of a block's.
#pragma once

#include <atomic>
#include <barrier>
#include <deque>
#include <thread>
#include <vector>

#include "cuda/device/thread_team.h"

namespace wetcurl::testing {

// Threads of this machine in the place of a block's.
class Threads {
  public:
    static constexpr int of_a_part = 8, warp = 32;
    struct Place {
        std::barrier<> all;
        std::deque<std::barrier<>> warps;
        std::atomic<int> found{0};
        explicit Place(int threads) : all(threads) {
            for (int t = 0; t < threads; t += warp) warps.emplace_back(warp);
        }
    };
    Threads(Place& place, int thread) : place_(&place), warp_(&place.warps[size_t(thread / warp)]) {}
    void wait() const { place_->all.arrive_and_wait(); }
    void part_waits() const { warp_->arrive_and_wait(); }
    bool any(bool mine) const {
        place_->found += mine;
        wait();
        const bool found = place_->found > 0;
        wait();
        place_->found -= mine;
        return found;
    }
    static void raise(unsigned& shared, unsigned bits) { std::atomic_ref<unsigned>(shared) |= bits; }
    static unsigned add(unsigned& shared, unsigned count) {
        return std::atomic_ref<unsigned>(shared).fetch_add(count);
    }
    static void at_least(unsigned& shared, unsigned bound) {
        std::atomic_ref<unsigned> now(shared);
        for (unsigned seen = now; seen < bound && !now.compare_exchange_weak(seen, bound);) {
        }
    }

  private:
    Place* place_;
    std::barrier<>* warp_;
};
struct OneAlone {};
struct ManyThreads {};
inline void as_a_team(OneAlone, auto f) { f(ThreadTeam<Alone>(Alone(), 0, 1)); }
inline void as_a_team(ManyThreads, auto f) {
    constexpr int count = 2 * Threads::warp;
    Threads::Place place(count);
    std::vector<std::jthread> threads;
    for (int t = 0; t < count; ++t)
        threads.emplace_back([&, t] { f(ThreadTeam<Threads>(Threads(place, t), t, count)); });
}

}  // namespace wetcurl::testing

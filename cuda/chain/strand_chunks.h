// What goes along a strand by chunks of its edges, a thread each: within a chunk edge by edge, then between
// chunks in rounds that reach ever farther. The tridiagonal system of twists, and the filter of Eq 2.
#pragma once

#include "solver/terms/twist.h"

namespace wetcurl {

// What the filter of Eq 2 but for its factor beta², 1 / (1 - q z)² with q = 1 - beta, makes of edges, and
// on its way there.
template <class T>
struct Smoothed {
    using V = Vec3<T>;
    V once{T(0), T(0), T(0)}, twice{T(0), T(0), T(0)};
    WETCURL_HD void next(const V& e, T q) {
        once = e + q * once;
        twice = once + q * twice;
    }
    // What came so many edges before. `weight`: q to the power of these.
    WETCURL_HD void add(const Smoothed& before, T edges, T weight) {
        twice += weight * (before.twice + edges * before.once);
        once += weight * before.once;
    }
};
// Edges begin .. end - 1, the number-th such chunk.
struct Chunk {
    int number, begin, end;
};

class Chunks {
    static constexpr int most = 64;

  public:
    // Edges of each but the one at the tip, which may be shorter. Odd, so that threads' numbers lie in
    // different banks.
    const int length;
    const int count;
    WETCURL_HD explicit Chunks(int edges)
        : length(maximum(3, (edges + most - 1) / most) | 1),
          count((edges + length - 1) / length),
          edges_(edges) {}
    WETCURL_HD Chunk chunk(int c) const { return {c, c * length, c + 1 < count ? (c + 1) * length : edges_}; }

    // f(other, reach, weight) in rounds, each of which reaches twice as many chunks far as the one before and
    // reads what that has left, in turns here or (`other`) there; `weight`: q to the power of the edges
    // between. Returns where the last one leaves it.
    template <class T, class F>
    WETCURL_HD bool in_rounds(bool other, T q, F f) const {
        T weight(1);
        for (int i = 0; i < length; ++i) weight *= q;
        for (int reach = 1; reach < count; reach *= 2, other = !other, weight *= weight)
            f(other, reach, weight);
        return other;
    }
    // Of chunk c; nothing of one that is not there.
    template <class T>
    WETCURL_HD Smoothed<T> at(const Smoothed<T>* chunks, int c) const {
        return c >= 0 && c < count ? chunks[c] : Smoothed<T>();
    }
    // Chunk c's with that of the one `reach` (towards the root: < 0) away.
    template <class T>
    WETCURL_HD Smoothed<T> carried(const Smoothed<T>* chunks, int c, int reach, T weight) const {
        Smoothed<T> sum = chunks[c];
        if (c + reach >= 0 && c + reach < count)
            sum.add(chunks[c + reach], T((reach < 0 ? -reach : reach) * length), weight);
        return sum;
    }
    // Hockney and Jesshope 1981, parallel cyclic reduction: rows of chunks `reach` before and after are taken
    // off row c.
    template <class T>
    WETCURL_HD TwistRow<T> reduced(const TwistRow<T>* rows, int c, int reach) const {
        TwistRow<T> row = rows[c];
        if (c - reach >= 0) row.take_before(rows[c - reach]);
        if (c + reach < count) row.take_after(rows[c + reach]);
        return row;
    }

  private:
    const int edges_;
};

}  // namespace wetcurl

// What runs along a strand, shared out in pieces of it: the filter of Eq 2, and the system of the turns of
// edges about themselves. Each piece is swept as if it were alone; what comes from the others is added.
#pragma once

#include "base/vec3.h"

namespace wetcurl {

// The filter of Eq 2 but for its factor beta², 1 / (1 - q z)² with q = 1 - beta, from zero. Its adjoint is
// the same from the tip.
template <class T>
struct FilterState {
    Vec3<T> once{T(0), T(0), T(0)}, twice{T(0), T(0), T(0)};
    WETCURL_HD void take(T q, const Vec3<T>& value) {
        once = q * once + value;
        twice = q * twice + once;
    }
    // Over `count` values of nothing, `decay` = q^count; then what a piece of as many gave.
    WETCURL_HD void pass(T decay, T count, const FilterState& piece) {
        twice = decay * (twice + count * once) + piece.twice;
        once = decay * once + piece.once;
    }
};

// How `count` values are cut: 32 pieces at most, so that whoever comes later need not pass many.
struct FilterPieces {
    int count, length, pieces;
    WETCURL_HD explicit FilterPieces(int values) : count(values), length((values + 31) / 32) {
        if (length < 4) length = 4;
        pieces = (count + length - 1) / length;
    }
    WETCURL_HD int begin(int piece) const { return piece * length; }
    WETCURL_HD int end(int piece) const {
        return (piece + 1) * length < count ? (piece + 1) * length : count;
    }
    // The state where `piece` begins, from the first value or (`back`) from the last.
    template <class T>
    WETCURL_HD FilterState<T> before(int piece, bool back, T q, const FilterState<T>* of) const {
        T decay(1);
        for (int k = 0; k < length; ++k) decay *= q;
        FilterState<T> state;
        // Nothing comes before the first of them, so that its own length does not matter.
        if (back)
            for (int k = pieces - 1; k > piece; --k) state.pass(decay, T(length), of[k]);
        else
            for (int k = 0; k < piece; ++k) state.pass(decay, T(length), of[k]);
        return state;
    }
};

// An edge's row of the system of the turns of edges about themselves: what couples it to an edge before and
// to one after, what its diagonal has beyond these (nothing cancels in sums of such), its right side.
template <class T>
struct alignas(4 * sizeof(T)) TwistRow {
    T before, after, excess, right;
};
// A turn by those of the nearest edges that no piece holds: left T_left + right T_right + own, and
// rest = 1 - left - right.
template <class T>
struct alignas(4 * sizeof(T)) TwistShare {
    T left, right, own, rest;
};

// The system of rows 1 .. count. Every `length`-th row is held back, the pieces between them are eliminated
// each for itself (Wang 1981), then the rows held back are solved for.
template <class T>
class TwistPieces {
  public:
    // `rows`, `shares` (count + 1).
    WETCURL_HD TwistPieces(const TwistRow<T>* rows, TwistShare<T>* shares, int count)
        : rows_(rows), shares_(shares), count_(count), length_(2) {
        while (length_ * length_ < count) ++length_;
    }
    WETCURL_HD int pieces() const { return count_ / length_ + 1; }

    WETCURL_HD void eliminate(int piece) const {
        const int begin = piece * length_ + 1, end = last_of(piece) + 1;
        TwistShare<T> before{T(1), T(0), T(0), T(0)};  // of the row held back before them: itself
        for (int i = begin; i < end; ++i) {
            const TwistRow<T> row = rows_[i];
            const T left = row.before * before.left, rest = row.excess + row.before * before.rest;
            const T inverse = T(1) / maximum(row.after + left + rest, T(1e-30));
            before = {left * inverse, row.after * inverse, (row.right + row.before * before.own) * inverse,
                      rest * inverse};
            shares_[i] = before;
        }
        for (int i = end - 2; i >= begin; --i) {
            const TwistShare<T> after = shares_[i + 1];
            const TwistShare<T> own = shares_[i];
            shares_[i] = {own.left + own.right * after.left, own.right * after.right,
                          own.own + own.right * after.own, own.rest + own.right * after.rest};
        }
    }
    // Of the rows held back; one thread.
    WETCURL_HD void solve() const {
        const int held = count_ / length_;
        TwistShare<T> before{T(0), T(0), T(0), T(0)};
        for (int c = 1; c <= held; ++c) {
            const int i = c * length_;
            const TwistRow<T> row = rows_[i];
            const TwistShare<T> left = shares_[i - 1];
            T excess = row.excess + row.before * left.rest, right = row.right + row.before * left.own,
              after(0);
            const T coupling = row.before * left.left;
            if (i < count_) {
                const TwistShare<T> next = shares_[i + 1];
                excess += row.after * next.rest, right += row.after * next.own;
                after = row.after * next.right;
            }
            // As in `eliminate`; nothing is left of the root.
            excess += coupling * before.rest, right += coupling * before.own;
            const T inverse = T(1) / maximum(after + excess, T(1e-30));
            before = {T(0), after * inverse, right * inverse, excess * inverse};
            shares_[i] = before;
        }
        T turn(0);
        for (int c = held; c > 0; --c) {
            TwistShare<T>& share = shares_[c * length_];
            turn = share.own + share.right * turn;
            share = {T(0), T(0), turn, T(0)};
        }
    }
    // Of edge i.
    WETCURL_HD T turn(int i) const {
        const TwistShare<T> share = shares_[i];
        const int left = i / length_ * length_, right = left + length_;
        T turn = share.own;
        if (i != left) {
            if (left > 0) turn += share.left * shares_[left].own;
            if (right <= count_) turn += share.right * shares_[right].own;
        }
        return turn;
    }

  private:
    WETCURL_HD int last_of(int piece) const {
        const int held = (piece + 1) * length_;
        return held <= count_ ? held - 1 : count_;
    }
    const TwistRow<T>* rows_;
    TwistShare<T>* shares_;
    int count_, length_;
};

}  // namespace wetcurl

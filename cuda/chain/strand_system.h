// The linear systems of a few strands, solved by a team: each is eliminated from its root and from its tip
// at once, towards two rows in its middle.
// Golub and Van Loan, 4.3.6 (block-banded LDL^T), as an order of elimination of it, so that it is as stable;
// from both ends after Babuška 1972.
#pragma once

#include "cuda/chain/strand_parts.h"
#include "cuda/device/thread_team.h"
#include "solver/chain/block_solve.h"

namespace wetcurl {

// Systems of strands of n particles each; rows 0 and 1 of each are known.
template <class T>
class StrandSystem {
    using V = Vec3<T>;
    using M = Mat3<T>;
    // Numbers of a row, matrices by columns: its coupling to the row towards the middle, its right side, then
    // the solution; its coupling to the one after that; its diagonal, lower triangle. In the end couplings
    // are those of the substitution.
    static constexpr int next_at = 0, right_at = 9, after_at = 12, diagonal_at = 21;
    // Columns of a row: those of both couplings, and its right side. What is read of it but its diagonal.
    static constexpr int columns = 7, own_column = 6, without_diagonal = 24;
    // Rows for the parts of a warp that have no job: one that they read, and one of each that it writes.
    static constexpr int spare = 4;

  public:
    // Whole quadruples, which are read at once; an odd number of them, so that those of eight rows lie in
    // different banks.
    static constexpr int row_size = 28;
    struct alignas(4 * sizeof(T)) Four {
        T v[4];
    };
    // The middle's two rows twice: for what comes from the root, and from the tip. One beyond the tip.
    WETCURL_HD static int rows_of(int n) { return (n < 4 ? 4 : n) + 3; }
    WETCURL_HD static int numbers_of(int n, int strands) { return (strands * rows_of(n) + spare) * row_size; }

    StrandSystem() = default;
    // `numbers`: as many as numbers_of tells, aligned to four.
    WETCURL_HD StrandSystem(int n, T* numbers)
        : n_(n), middle_(n < 4 ? 2 : n / 2), rows_(rows_of(n)), numbers_(numbers) {}

    // Of one strand, all its rows'.
    WETCURL_HD T* numbers(int strand) const { return numbers_ + (spare + strand * rows_) * row_size; }
    // The right side of row i, then its solution.
    WETCURL_HD V& right(int strand, int i) const { return right(row(strand, i)); }

    // --- rows, by those that assemble them

    // Jobs for the elements of a strand, and the particle at which that of job k ends, from the middle
    // outwards; n or more: none.
    WETCURL_HD int jobs() const { return 2 * middle_; }
    WETCURL_HD int element_of(int k) const { return k < middle_ ? middle_ + 1 - k : k + 2; }
    // Before the first element, job k of four: rows that more than one element reaches at a time.
    WETCURL_HD void clear(int strand, int k) const {
        auto zero = [](T* row) {
            for (int l = 0; l < row_size; ++l) row[l] = T(0);
        };
        zero(place(strand, middle_ + k));
        if (k == 2) zero(place(strand, rows_ - 1));
        if (strand == 0 && k < spare) zero(numbers_ + k * row_size);
        if (n_ > 3) return;
        if (k == 0) zero(place(strand, 1));
        // There is no such particle.
        if (k == 1) put_diagonal<false>(place(strand, middle_ + k), identity_times(T(1)));
    }
    // The part of the element that ends at particle j, in each of three turns. In each, elements reach
    // different rows.
    WETCURL_HD void add(int strand, int j, int turn, const Element<T>& e) const {
        if (j < middle_ + 2)
            add<false>(place(strand, j - 2 + turn), turn, e);
        else
            add<true>(place(strand, j + 2 - turn), turn, e);
    }
    // What all elements have left on the right of row i; from the tip's side nothing comes after it.
    WETCURL_HD V gathered(int strand, int i) const {
        V sum = right(strand, i);
        if (i != middle_ && i != middle_ + 1) return sum;
        V& from_tip = right(place(strand, i + 2));
        sum += from_tip;
        from_tip = {T(0), T(0), T(0)};
        return sum;
    }
    WETCURL_HD void add_diagonal(int strand, int i, const Sym3<T>& diagonal) const {
        put_diagonal<true>(row(strand, i), diagonal);
    }
    // What rows 0 and 1, known to be x0 and x1, leave of row 2 or 3.
    WETCURL_HD V known_part(int strand, int i, const V& x0, const V& x1) const {
        const V near = transposed_times(matrix(row(strand, 1) + (i == 2 ? next_at : after_at)), x1);
        return i == 2 ? near + transposed_times(matrix(row(strand, 0) + after_at), x0) : near;
    }

    // --- the solution

    // Of the strands s < `strands` for which chosen(s) holds.
    template <class Barrier, class Chosen>
    WETCURL_HD void solve(const ThreadTeam<Barrier>& team, int strands, Chosen chosen) const {
        team.by_parts(2 * strands, [&](int job, int member) {
            const bool there = job < 2 * strands, works = there && chosen(job / 2);
            // Those without a job go through the same where nobody looks.
            Side side = there ? side_of(job) : Side{numbers_, (2 * strands - 1 - job) * row_size, 0};
            constexpr std::make_index_sequence<ThreadTeam<Barrier>::share_of(columns)> share;
            // Of an odd number the tip has one more.
            if (n_ % 2 && n_ > 3) {
                eliminate(team, side, 1, works && job % 2, member, share);
                if (there && job % 2) side.row += side.next, --side.rows;
            }
            eliminate(team, side, middle_ - 2, works, member, share);
        });
        team.share(strands, 1, [&](int strand, int) {
            if (chosen(strand)) solve_middle(strand);
        });
        team.share(2 * strands, 1, [&](int job, int) {
            if (chosen(job / 2)) substitute(side_of(job));
        });
    }

  private:
    WETCURL_HD T* place(int strand, int k) const { return numbers(strand) + k * row_size; }
    WETCURL_HD T* row(int strand, int i) const { return place(strand, i < middle_ + 2 ? i : i + 2); }
    WETCURL_HD static V& right(T* row) { return *reinterpret_cast<V*>(row + right_at); }
    WETCURL_HD static const V& right(const T* row) { return *reinterpret_cast<const V*>(row + right_at); }
    WETCURL_HD static M matrix(const T* c) {
        return {{c[0], c[3], c[6]}, {c[1], c[4], c[7]}, {c[2], c[5], c[8]}};
    }
    WETCURL_HD static Sym3<T> diagonal_of(const T* row) {
        const T* d = row + diagonal_at;
        return {d[0], d[1], d[2], d[3], d[4], d[5]};
    }

    template <int count>
    struct Numbers {
        T v[count];
        WETCURL_HD explicit Numbers(const T* from) {
            for (int k = 0; k < count; k += 4) {
                const Four four = *reinterpret_cast<const Four*>(from + k);
                for (int l = 0; l < 4; ++l) v[k + l] = four.v[l];
            }
        }
        WETCURL_HD void put(T* to) const {
            for (int k = 0; k < count; k += 4)
                *reinterpret_cast<Four*>(to + k) = Four{v[k], v[k + 1], v[k + 2], v[k + 3]};
        }
    };
    template <bool adds>
    WETCURL_HD static void put(T& to, T a) {
        to = adds ? to + a : a;
    }
    // `to`: a matrix's place.
    template <bool adds, bool transposes>
    WETCURL_HD static void put_matrix(T* to, const M& a) {
        auto each = [&](int k, const V& row) {
            put<adds>(to[transposes ? 3 * k : k], row.x);
            put<adds>(to[transposes ? 3 * k + 1 : k + 3], row.y);
            put<adds>(to[transposes ? 3 * k + 2 : k + 6], row.z);
        };
        each(0, a.r0), each(1, a.r1), each(2, a.r2);
    }
    template <bool adds>
    WETCURL_HD static void put_diagonal(T* row, const Sym3<T>& d) {
        T* to = row + diagonal_at;
        put<adds>(to[0], d.xx), put<adds>(to[1], d.xy), put<adds>(to[2], d.xz);
        put<adds>(to[3], d.yy), put<adds>(to[4], d.yz), put<adds>(to[5], d.zz);
    }
    template <bool adds>
    WETCURL_HD static void put_right(T* row, const V& a) {
        put<adds>(row[right_at], a.x), put<adds>(row[right_at + 1], a.y), put<adds>(row[right_at + 2], a.z);
    }
    // Towards the tip's side rows are coupled the other way round.
    template <bool from_tip>
    WETCURL_HD static void add(T* row, int turn, const Element<T>& e) {
        constexpr int outer = from_tip ? 2 : 0, inner = 2 - outer;
        if (turn == 0) {
            Numbers<row_size> n(row);
            put_matrix<false, from_tip>(n.v + next_at, e.upper1[from_tip ? 1 : 0]);
            put_matrix<false, from_tip>(n.v + after_at, e.upper2[0]);
            put_diagonal<false>(n.v, e.diagonal[outer]), put_right<false>(n.v, e.force[outer]);
            n.v[row_size - 1] = T(0);
            n.put(row);
        } else if (turn == 1) {
            Numbers<row_size> n(row);
            put_matrix<true, from_tip>(n.v + next_at, e.upper1[from_tip ? 0 : 1]);
            put_diagonal<true>(n.v, e.diagonal[1]), put_right<true>(n.v, e.force[1]);
            n.put(row);
        } else {
            Numbers<row_size> n(row);
            put_diagonal<true>(n.v, e.diagonal[inner]), put_right<true>(n.v, e.force[inner]);
            n.put(row);
        }
    }

    // The rows of a strand between one of its ends and the middle.
    struct Side {
        T* row;          // the outermost one's
        int next, rows;  // numbers from a row to the next
    };
    WETCURL_HD Side side_of(int job) const {
        const bool from_tip = job % 2;
        return {place(job / 2, from_tip ? n_ + 1 : 2), from_tip ? -row_size : row_size,
                (from_tip ? n_ - middle_ : middle_) - 2};
    }
    // What one of a part does with a row's column c: where it lies, there and in the row before; what it
    // changes in the row after and in the one after that, below the diagonal alone. One beyond the columns
    // works for nobody.
    struct Column {
        T *own, *before, *next[3], *after[3];
        V solved;  // what the row before is to hold
        WETCURL_HD Column(int c, const Side& side, bool works) {
            const bool near = c < 3, right = c >= own_column;
            const int k = near ? c : c - 3, triangle = diagonal_at + (k > 0 ? k + 1 : 0);
            own = side.row + (near ? next_at + 3 * k : right ? right_at : after_at + 3 * k);
            before = (c < columns ? own : side.row + diagonal_at) - side.next;
            solved = {before[0], before[1], before[2]};
            // What nobody asked for goes where `solved` follows.
            for (int l = 0; l < 3; ++l) {
                next[l] = side.row + side.next + (near ? triangle : right ? right_at : next_at + 3 * k) + l;
                after[l] = side.row + 2 * side.next + (right ? right_at : triangle) + l;
                if (!works || c >= columns || (near && l < k)) next[l] = before;
                if (!works || c >= columns || near || (!right && l < k)) after[l] = before;
            }
        }
        // Of a row with this factor and these couplings. What others read of it stays: it is the solution of
        // the row before that takes its place now.
        WETCURL_HD void step(const Factor3<T>& factor, const M& u1, const M& u2, int to_next, bool works) {
            const V now = factor.solve(V{own[0], own[1], own[2]});
            const V one = V{*next[0], *next[1], *next[2]} - transposed_times(u1, now),
                    two = V{*after[0], *after[1], *after[2]} - transposed_times(u2, now);
            *next[0] = one.x, *next[1] = one.y, *next[2] = one.z;
            *after[0] = two.x, *after[1] = two.y, *after[2] = two.z;
            put();
            if (works) solved = now;
            for (int l = 0; l < 3; ++l) next[l] += to_next, after[l] += to_next;
            own += to_next, before += to_next;
        }
        WETCURL_HD void put() const { before[0] = solved.x, before[1] = solved.y, before[2] = solved.z; }
    };
    // The outermost rows of a side, so many in any side; not of it where it does not work.
    template <class Barrier, size_t... k>
    WETCURL_HD static void eliminate(const ThreadTeam<Barrier>& team, const Side& side, int rows, bool works,
                                     int member, std::index_sequence<k...>) {
        Column mine[] = {Column(member + int(k) * Barrier::of_a_part, side, works)...};
        const int to_next = works ? side.next : 0;
        const T* row = side.row;
        for (int i = 0; i < rows; ++i, row += to_next) {
            const Numbers<row_size> all(row);
            const Factor3<T> factor(diagonal_of(all.v));
            const M u1 = matrix(all.v + next_at), u2 = matrix(all.v + after_at);
            (mine[k].step(factor, u1, u2, to_next, works), ...);
            team.part_waits();
        }
        (mine[k].put(), ...);
        team.part_waits();
    }
    WETCURL_HD void solve_middle(int strand) const {
        if (n_ < 3) return;
        T *one = place(strand, middle_), *other = one + row_size, *one_from_tip = other + row_size,
          *other_from_tip = one_from_tip + row_size;
        Sym3<T> d = diagonal_of(one), d_other = diagonal_of(other);
        d += diagonal_of(one_from_tip), d_other += diagonal_of(other_from_tip);
        M u = matrix(one + next_at);
        u += transposed(matrix(other_from_tip + next_at));
        V x = right(one) + right(one_from_tip), x_other = right(other) + right(other_from_tip);
        wetcurl::eliminate<T>({d, &u, nullptr, x}, &d_other, &x_other, nullptr, nullptr, nullptr);
        wetcurl::eliminate<T>({d_other, nullptr, nullptr, x_other}, nullptr, nullptr, nullptr, nullptr,
                              nullptr);
        x -= u * x_other;
        right(one) = right(one_from_tip) = x;
        right(other) = right(other_from_tip) = x_other;
    }
    WETCURL_HD void substitute(const Side& side) const {
        if (side.rows < 1) return;
        T* row = side.row + (side.rows - 1) * side.next;
        V x1 = right(row + side.next), x2 = right(row + 2 * side.next);
        // What is read next is on its way already.
        Numbers<without_diagonal> here(row), ahead = here;
        for (int i = side.rows - 1; i >= 0; --i, row -= side.next) {
            here = ahead;
            if (i > 0) ahead = Numbers<without_diagonal>(row - side.next);
            const V known = right(here.v) - matrix(here.v + after_at) * x2;
            x2 = x1, x1 = known - matrix(here.v + next_at) * x1;
            right(row) = x1;
        }
    }

    int n_ = 0, middle_ = 0, rows_ = 0;
    T* numbers_ = nullptr;
};

}  // namespace wetcurl

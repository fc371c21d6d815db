// The linear systems of a few strands, solved by a team: cyclic reduction over pairs of particles, each round
// of which eliminates every other pair of those left.
// Golub and Van Loan, 4.5.4 (block cyclic reduction), as an order of elimination of LDL^T, so that it is as
// stable as that.
#pragma once

#include "cuda/team.h"
#include "solver/passes/block_solve.h"

namespace wetcurl {

// LDL^T of a symmetric positive definite 6x6 matrix, in the place of its lower triangle, rows one after the
// other, with the inverses of the pivots on the diagonal.
template <class T>
struct Factor6 {
    T l[21];
    WETCURL_HD static constexpr int at(int row, int column) { return row * (row + 1) / 2 + column; }

    // Of the matrix in `l`.
    WETCURL_HD void factorise() {
        for (int j = 0; j < 6; ++j) {
            T pivot = l[at(j, j)];
            for (int k = 0; k < j; ++k) {
                const T times_pivot = l[at(j, k)];
                l[at(j, k)] = times_pivot * l[at(k, k)];
                pivot -= times_pivot * l[at(j, k)];
            }
            for (int i = j + 1; i < 6; ++i)
                for (int k = 0; k < j; ++k) l[at(i, j)] -= l[at(i, k)] * l[at(j, k)];
            l[at(j, j)] = T(1) / pivot;
        }
    }
    WETCURL_HD void solve(T (&b)[6]) const {
        for (int i = 1; i < 6; ++i)
            for (int k = 0; k < i; ++k) b[i] -= l[at(i, k)] * b[k];
        for (int i = 0; i < 6; ++i) b[i] *= l[at(i, i)];
        for (int i = 4; i >= 0; --i)
            for (int k = i + 1; k < 6; ++k) b[i] -= l[at(k, i)] * b[k];
    }
};

// Systems of strands of n particles each; rows 0 and 1 of each, its first pair, are known.
template <class T>
class StrandSystem {
    using V = Vec3<T>;
    using M = Mat3<T>;
    // Numbers of a pair: its diagonal block, lower triangle, then its factor; the right side, then the
    // solution; the coupling to the next pair, by rows; and the one that comes of eliminating this pair,
    // between its neighbours. Each part begins at a multiple of four numbers, which are read at once.
    static constexpr int own_size = 28, right_at = 21, block_size = 36, next_at = own_size,
                         across_at = next_at + block_size;

  public:
    static constexpr int pair_size = across_at + block_size;
    struct alignas(4 * sizeof(T)) Four {
        T v[4];
    };
    WETCURL_HD static int pairs_of(int n) { return (n + 1) / 2; }

    StrandSystem() = default;
    // `numbers`: pair_size for each pair of each strand, aligned to four.
    WETCURL_HD StrandSystem(int n, T* numbers) : n_(n), pairs_(pairs_of(n)), numbers_(numbers) {}

    // Of one strand, all its pairs'.
    WETCURL_HD T* numbers(int strand) const { return pair(strand, 0); }

    // --- rows, by those that assemble them

    // Row i: with its couplings to the next one and the one after.
    WETCURL_HD void set_row(int strand, int i, const Sym3<T>& diagonal, const V& r, const M& u1,
                            const M& u2) const {
        put_diagonal<false>(strand, i, diagonal);
        right(strand, i) = r;
        put_next<false>(strand, i, u1);
        T* across = pair(strand, i / 2) + next_at;
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column) {
                if (i % 2)
                    across[(3 + row) * 6 + 3 + column] = number(u2, row, column);
                else
                    across[row * 6 + column] = number(u2, row, column), across[row * 6 + 3 + column] = T(0);
            }
    }
    // Row i of nothing, as it must be beyond the tip too where n is odd.
    WETCURL_HD void clear_row(int strand, int i) const {
        const V zero{T(0), T(0), T(0)};
        const M none{zero, zero, zero};
        set_row(strand, i, identity_times(T(i < n_ ? 0 : 1)), zero, none, none);
    }
    WETCURL_HD void add_diagonal(int strand, int i, const Sym3<T>& diagonal) const {
        put_diagonal<true>(strand, i, diagonal);
    }
    WETCURL_HD void add_coupling(int strand, int i, const M& u1) const { put_next<true>(strand, i, u1); }
    // The right side of row i, then its solution.
    WETCURL_HD V& right(int strand, int i) const {
        return reinterpret_cast<V*>(pair(strand, i / 2) + right_at)[i % 2];
    }
    // What rows 0 and 1, known to be x0 and x1, leave of row 2 or 3.
    WETCURL_HD V known_part(int strand, int i, const V& x0, const V& x1) const {
        const T* c = pair(strand, 0) + next_at + (i - 2) * 3;
        V sum{T(0), T(0), T(0)};
        for (int row = 0; row < 3; ++row) {
            sum += number(x0, row) * V{c[row * 6], c[row * 6 + 1], c[row * 6 + 2]};
            sum += number(x1, row) * V{c[(3 + row) * 6], c[(3 + row) * 6 + 1], c[(3 + row) * 6 + 2]};
        }
        return sum;
    }

    // --- the solution

    // Of the strands s < `strands` for which chosen(s) holds.
    template <class Chosen>
    WETCURL_HD void solve(const Team& team, int strands, Chosen chosen) const {
        int stride = 1;
        for (; left(stride) > 0; stride *= 2) {
            const int out = (left(stride) + 1) / 2, updates = left(stride) / 2 * 6;
            team.share(strands, out, [&](int strand, int k) {
                if (chosen(strand)) factorise(pair(strand, place(2 * k, stride)));
            });
            team.share(strands, updates, [&](int strand, int k) {
                if (chosen(strand)) update(strand, k / 6 * 2 + 1, k % 6, stride);
            });
        }
        while ((stride /= 2) > 0) {
            const int out = (left(stride) + 1) / 2;
            team.share(strands, out, [&](int strand, int k) {
                if (chosen(strand)) substitute(strand, 2 * k, stride);
            });
        }
    }

  private:
    using Factor = Factor6<T>;

    WETCURL_HD T* pair(int strand, int p) const { return numbers_ + (strand * pairs_ + p) * pair_size; }
    // The pairs left before a round, every stride-th: how many, and which the a-th of them is. Even ones go.
    WETCURL_HD int left(int stride) const { return (pairs_ - 1) / stride; }
    WETCURL_HD static int place(int a, int stride) { return (a + 1) * stride; }
    // By rows, between the a-th of them and the one after it.
    WETCURL_HD const T* coupling(int strand, int a, int stride) const {
        const int p = place(a, stride);
        return stride == 1 ? pair(strand, p) + next_at : pair(strand, p + stride / 2) + across_at;
    }

    WETCURL_HD static T number(const V& a, int k) { return k == 0 ? a.x : k == 1 ? a.y : a.z; }
    WETCURL_HD static T number(const M& a, int row, int column) {
        return number(row == 0 ? a.r0 : row == 1 ? a.r1 : a.r2, column);
    }
    template <bool adds>
    WETCURL_HD static void put(T& to, T a) {
        to = adds ? to + a : a;
    }
    template <bool adds>
    WETCURL_HD void put_diagonal(int strand, int i, const Sym3<T>& d) const {
        T* p = pair(strand, i / 2);
        const int first = i % 2 * 3;
        put<adds>(p[Factor::at(first, first)], d.xx);
        put<adds>(p[Factor::at(first + 1, first)], d.xy);
        put<adds>(p[Factor::at(first + 1, first + 1)], d.yy);
        put<adds>(p[Factor::at(first + 2, first)], d.xz);
        put<adds>(p[Factor::at(first + 2, first + 1)], d.yz);
        put<adds>(p[Factor::at(first + 2, first + 2)], d.zz);
    }
    // The coupling to the next row, which is of this pair or of the next.
    template <bool adds>
    WETCURL_HD void put_next(int strand, int i, const M& u1) const {
        T* p = pair(strand, i / 2);
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column)
                put<adds>(p[i % 2 ? next_at + (3 + row) * 6 + column : Factor::at(3 + column, row)],
                          number(u1, row, column));
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
    };
    // A pair's factor and right side.
    struct Own : Numbers<own_size> {
        using Numbers<own_size>::Numbers;
        WETCURL_HD void solve(T (&b)[6]) const {
            Factor f;
            for (int k = 0; k < 21; ++k) f.l[k] = this->v[k];
            f.solve(b);
        }
    };
    using Block = Numbers<block_size>;

    WETCURL_HD static void factorise(T* p) {
        const Numbers<24> own(p);
        Factor f;
        for (int k = 0; k < 21; ++k) f.l[k] = own.v[k];
        f.factorise();
        for (int k = 0; k < 21; ++k) p[k] = f.l[k];
    }
    // Takes the a-th pair's neighbours, which go, off row c of its block, and couples it to the pair after
    // them.
    WETCURL_HD void update(int strand, int a, int c, int stride) const {
        T* p = pair(strand, place(a, stride));
        T row[6], b[6], r = p[right_at + c];
        for (int k = 0; k < 6; ++k) row[k] = k <= c ? p[Factor::at(c, k)] : T(0);
        // `coupling`: row c from `first` by `step`; row k of it from k * next.
        auto take = [&](const T* gone, const T* coupling, int first, int step, int next) {
            const Own own(gone);
            const Block block(coupling);
            for (int k = 0; k < 6; ++k) b[k] = coupling[first + k * step];
            own.solve(b);
            for (int k = 0; k < 6; ++k)
                for (int l = 0; l < 6; ++l) row[k] -= block.v[k * next + l * step] * b[l];
            for (int l = 0; l < 6; ++l) r -= own.v[right_at + l] * b[l];
        };
        take(pair(strand, place(a - 1, stride)), coupling(strand, a - 1, stride), c, 6, 1);
        if (a + 1 < left(stride)) {
            T* after = pair(strand, place(a + 1, stride));
            take(after, coupling(strand, a, stride), c * 6, 1, 6);
            if (a + 2 < left(stride)) {
                const Block beyond(coupling(strand, a + 1, stride));
                for (int k = 0; k < 6; ++k) {
                    T sum(0);
                    for (int l = 0; l < 6; ++l) sum -= b[l] * beyond.v[l * 6 + k];
                    after[across_at + c * 6 + k] = sum;
                }
            }
        }
        for (int k = 0; k < 6; ++k)
            if (k <= c) p[Factor::at(c, k)] = row[k];
        p[right_at + c] = r;
    }
    // The a-th pair, by the solution of its neighbours.
    WETCURL_HD void substitute(int strand, int a, int stride) const {
        T* p = pair(strand, place(a, stride));
        const Own own(p);
        T b[6];
        for (int k = 0; k < 6; ++k) b[k] = own.v[right_at + k];
        auto take = [&](int neighbour, const T* coupling, int next, int step) {
            const T* x = pair(strand, place(neighbour, stride)) + right_at;
            const Block block(coupling);
            for (int l = 0; l < 6; ++l)
                for (int k = 0; k < 6; ++k) b[k] -= block.v[k * next + l * step] * x[l];
        };
        if (a > 0) take(a - 1, coupling(strand, a - 1, stride), 1, 6);
        if (a + 1 < left(stride)) take(a + 1, coupling(strand, a, stride), 6, 1);
        own.solve(b);
        for (int k = 0; k < 6; ++k) p[right_at + k] = b[k];
    }

    int n_ = 0, pairs_ = 0;
    T* numbers_ = nullptr;
};

}  // namespace wetcurl

// The linear system of a strand in a device's memory, solved from both ends at once.
// Golub and Van Loan, 4.3 (banded), on 3x3 blocks; from both ends after Babuska 1972.
#pragma once

#include "cuda/lanes.h"
#include "cuda/present.h"
#include "cuda/team.h"
#include "solver/passes/block_solve.h"

namespace wetcurl {

// A row of the system: with the couplings to the next particle, and to the one after where a term couples two
// edges. The substitution needs the last three of it.
template <class T>
struct SystemRow {
    Sym3<T> diagonal;
    Vec3<T> r;
    Mat3<T> u1, u2;
};
inline int row_size(const ChainTerms& terms) { return couples_two_edges(terms) ? 27 : 18; }

template <class T>
struct StrandSystem {
    using V = Vec3<T>;
    using M = Mat3<T>;
    // Rows of lanes that two members meet in.
    static constexpr int middle_size = 30;

    // Of this lane's strand.
    int n;
    size_t first;  // row of them all
    T *rows, *middle;
    LaneArray<V, T> solution;

    template <class Set>
    WETCURL_HD void put(const Set& set, int i, const SystemRow<T>& row) const {
        T* p = row_at(set, i);
        LaneArray<Sym3<T>, T>{p}.set(0, row.diagonal);
        store_couplings(set, p, row);
    }
    // Two members eliminate from the ends, meet at rows m and m+1, and go back. Rows become those of the
    // substitution. `known(i)`: the solution of rows 0 and 1.
    template <class Set, class Known>
    WETCURL_HD void solve(const Set& set, const Team& team, bool again, Known known) const {
        const bool meets = n >= 8;
        const int m = meets ? 2 + (n - 4) / 2 : n;
        const bool from_root = again && team.member == 0,
                   from_tip = meets && again && team.member == (team.members > 1);
        SystemRow<T> row, row1;
        if (from_root) eliminate_from_root(set, known, m, row, row1);
        if (from_tip) eliminate_from_tip(set, m + 2);
        team.wait();
        const V zero{T(0), T(0), T(0)};
        if (from_root && meets) {
            const SystemRow<T> left = LaneArray<SystemRow<T>, T>{middle}[0];
            const V r = LaneArray<V, T>{middle + 27 * Lanes<T>::lanes}[0];
            const M& d = left.u2;
            row1.diagonal += left.diagonal, row1.r += left.r;
            row.u1 += transposed(left.u1);
            row.diagonal += Sym3<T>{d.r0.x, d.r0.y, d.r0.z, d.r1.y, d.r1.z, d.r2.z}, row.r += r;
            eliminate(Row<T>{row.diagonal, &row.u1, nullptr, row.r}, &row1.diagonal, &row1.r,
                      static_cast<M*>(nullptr), static_cast<Sym3<T>*>(nullptr), static_cast<V*>(nullptr));
            const V d1 = Factor3<T>(row1.diagonal).solve(row1.r);
            solution.set(m + 1, d1), solution.set(m, row.r - row.u1 * d1);
        }
        team.wait();
        if (from_root) {
            V d1 = meets ? V(solution[m]) : zero, d2 = meets ? V(solution[m + 1]) : zero;
            substitute(set, m - 1, 1, -1, d1, d2);
        }
        if (from_tip) {
            V d1 = solution[m + 1], d2 = solution[m];
            substitute(set, m + 2, n, 1, d1, d2);
        }
    }

  private:
    template <class Set>
    WETCURL_HD static bool penta(const Set& set) {
        return has<Bend>(set) || has<Twist>(set);
    }
    template <class Set>
    WETCURL_HD T* row_at(const Set& set, int i) const {
        return rows + (first + size_t(i)) * size_t(penta(set) ? 27 : 18) * Lanes<T>::lanes;
    }
    template <class Set>
    WETCURL_HD SystemRow<T> loaded_row(const Set& set, int i) const {
        const T* p = row_at(set, i);
        SystemRow<T> row{};
        row.diagonal = LaneArray<Sym3<T>, const T>{p}[0];
        load_couplings(set, p, row);
        return row;
    }
    template <class Set>
    WETCURL_HD static void load_couplings(const Set& set, const T* p, SystemRow<T>& row) {
        row.r = LaneArray<V, const T>{p + 6 * Lanes<T>::lanes}[0];
        row.u1 = LaneArray<M, const T>{p + 9 * Lanes<T>::lanes}[0];
        if (penta(set)) row.u2 = LaneArray<M, const T>{p + 18 * Lanes<T>::lanes}[0];
    }
    template <class Set>
    WETCURL_HD static void store_couplings(const Set& set, T* p, const SystemRow<T>& row) {
        LaneArray<V, T>{p + 6 * Lanes<T>::lanes}.set(0, row.r);
        LaneArray<M, T>{p + 9 * Lanes<T>::lanes}.set(0, row.u1);
        if (penta(set)) LaneArray<M, T>{p + 18 * Lanes<T>::lanes}.set(0, row.u2);
    }

    // Eliminates rows 2 .. end-1 from the root; they become those of the substitution. The two after them as
    // they are left.
    template <class Set, class Known>
    WETCURL_HD void eliminate_from_root(const Set& set, Known known_at, int end, SystemRow<T>& row,
                                        SystemRow<T>& row1) const {
        SystemRow<T> beyond{};
        beyond.diagonal = identity_times(T(1));
        auto row_or_none = [&](int i) { return i < n ? loaded_row(set, i) : beyond; };
        row = row_or_none(2), row1 = row_or_none(3);
        SystemRow<T> row2 = row_or_none(4);
        V known[2];
        for (int i = 0; i < 2; ++i) {
            known[i] = known_at(i);
            solution.set(i, known[i]);
        }
        SystemRow<T> root{};
        load_couplings(set, row_at(set, 1), root);
        row.r -= transposed_times(root.u1, known[1]);
        if (penta(set)) row1.r -= transposed_times(root.u2, known[1]);
        load_couplings(set, row_at(set, 0), root);
        if (penta(set)) row.r -= transposed_times(root.u2, known[0]);
        for (int i = 2; i < end; ++i) {
            const SystemRow<T> next = row_or_none(i + 3);  // on its way while this row is worked on
            eliminate(Row<T>{row.diagonal, &row.u1, penta(set) ? &row.u2 : nullptr, row.r}, &row1.diagonal,
                      &row1.r, &row1.u1, &row2.diagonal, &row2.r);
            store_couplings(set, row_at(set, i), row);
            row = row1, row1 = row2, row2 = next;
        }
    }
    // Rows n-1 .. end from the tip. Leaves what they add to the two before them, whose own numbers are the
    // other side's.
    template <class Set>
    WETCURL_HD void eliminate_from_tip(const Set& set, int end) const {
        // Row i with its couplings to rows i-1 and i-2.
        auto turned_round = [&](int i) {
            const T *p = row_at(set, i), *p1 = row_at(set, i - 1), *p2 = row_at(set, i - 2);
            SystemRow<T> row{};
            if (i >= end) {
                row.diagonal = LaneArray<Sym3<T>, const T>{p}[0];
                row.r = LaneArray<V, const T>{p + 6 * Lanes<T>::lanes}[0];
            }
            if (i > end - 1) {
                row.u1 = transposed(LaneArray<M, const T>{p1 + 9 * Lanes<T>::lanes}[0]);
                if (penta(set)) row.u2 = transposed(LaneArray<M, const T>{p2 + 18 * Lanes<T>::lanes}[0]);
            }
            return row;
        };
        SystemRow<T> row = turned_round(n - 1), row1 = turned_round(n - 2), row2 = turned_round(n - 3);
        for (int i = n - 1; i >= end; --i) {
            const SystemRow<T> next = i - 3 >= end - 2 ? turned_round(i - 3) : SystemRow<T>{};
            eliminate(Row<T>{row.diagonal, &row.u1, penta(set) ? &row.u2 : nullptr, row.r}, &row1.diagonal,
                      &row1.r, &row1.u1, &row2.diagonal, &row2.r);
            store_couplings(set, row_at(set, i), row);
            row = row1, row1 = row2, row2 = next;
        }
        const LaneArray<SystemRow<T>, T> left{middle};
        left.set(0, {row.diagonal, row.r, row.u1, to_mat3(row1.diagonal)});
        LaneArray<V, T>{middle + 27 * Lanes<T>::lanes}.set(0, row1.r);
    }
    // Rows from begin to before end, by the solution d1, d2 of the two before.
    template <class Set>
    WETCURL_HD void substitute(const Set& set, int begin, int end, int step, V d1, V d2) const {
        SystemRow<T> next{};
        if (begin != end) load_couplings(set, row_at(set, begin), next);
        for (int i = begin; i != end; i += step) {
            const SystemRow<T> now = next;
            if (i + step != end) load_couplings(set, row_at(set, i + step), next);
            V d = now.r - now.u1 * d1;
            if (penta(set)) d -= now.u2 * d2;
            solution.set(i, d);
            d2 = d1, d1 = d;
        }
    }
};

}  // namespace wetcurl

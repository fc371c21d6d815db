// Neighbours within a radius: points sorted by the row of a regular grid, then along it (counting sorts).
// Cells along a row too would be many times the points: hair fills little of its box.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/quads.h"

namespace wetcurl {

// Points by fours, a number more of each; a four is a line of a cache. `k` counts points, `four` fours.
class PointQuads {
  public:
    // numbers_a_quad_each reads beyond its four: one more follows the last.
    void resize(size_t count) { quads_.resize((count + 3) / 4 + 1); }
    Vec3f at(size_t k) const {
        const Quad& q = quads_[k / 4];
        return {q.x[k % 4], q.y[k % 4], q.z[k % 4]};
    }
    void set(size_t k, const Vec3f& p) {
        Quad& q = quads_[k / 4];
        q.x[k % 4] = p.x, q.y[k % 4] = p.y, q.z[k % 4] = p.z;
    }
    float& number(size_t k) { return quads_[k / 4].number[k % 4]; }
    float number(size_t k) const { return quads_[k / 4].number[k % 4]; }
    // In the number's place, while neighbours are searched for.
    void set_group(size_t k, uint32_t group) { number(k) = std::bit_cast<float>(group); }
    // Points 4 four .. 4 four + 3 in each quad of lanes, and their numbers where a lane's bit is set, else 0.
    Vec3<Pack<float>> in_each_quad(size_t four) const {
        const Quad& q = quads_[four];
        return {wetcurl::in_each_quad(q.x), wetcurl::in_each_quad(q.y), wetcurl::in_each_quad(q.z)};
    }
    Pack<float> numbers_in_each_quad(size_t four) const { return wetcurl::in_each_quad(quads_[four].number); }
    Pack<float> numbers_in_each_quad(size_t four, uint32_t bits) const {
        return wetcurl::in_each_quad(quads_[four].number, bits);
    }
    // The points of k's four from k on, each in a quad of lanes; k: a multiple of `quads`.
    Vec3<Pack<float>> a_quad_each(size_t k) const {
        const float* x = reinterpret_cast<const float*>(&quads_[k / 4]) + k % 4;
        return {wetcurl::a_quad_each(x), wetcurl::a_quad_each(x + 4), wetcurl::a_quad_each(x + 8)};
    }
    Pack<float> numbers_a_quad_each(size_t k) const {
        return wetcurl::a_quad_each(quads_[k / 4].number + k % 4);
    }
    size_t bytes() const { return quads_.capacity() * sizeof(Quad); }

  private:
    struct alignas(64) Quad {
        float x[4], y[4], z[4], number[4];
    };
    std::vector<Quad> quads_;
};

// Points in the order of their rows; `order[k]` is the index of sorted point k in the input. A row is a
// square of the grid across x and z; within it points go by y, along which hair hangs, so that those of a
// lock follow each other, but for less than a column's width. Buffers keep their memory from one build to the
// next.
class NeighborGrid {
  public:
    // `positions` (count) [m]; a row is `radius` [m] wide at least. Numbers are left to the caller. `weight`
    // (count): who has none is in the order, and nobody's neighbour; null: all have some.
    void build(const Vec3f* positions, size_t count, float radius,
               const std::vector<float>* weight = nullptr);
    size_t size() const { return order_.size(); }
    const std::vector<uint32_t>& order() const { return order_; }
    Vec3f sorted(size_t k) const { return points_.at(k); }
    // The sorted points. Who has searched may move them, and searches no more.
    PointQuads& points() { return points_; }
    const PointQuads& points() const { return points_; }
    size_t bytes() const;

    // Calls visit(begin, end) for each row around x: at most nine ranges of sorted points that hold all
    // within the radius (the caller tests the distance). x may lie anywhere.
    template <class Visit>
    void rows(const Vec3f& x, Visit visit) const {
        const int c = column(x.y);
        for_each_row(x, [&](uint32_t begin, uint32_t end) {
            begin = first_at(begin, end, c - reach_);
            end = first_at(begin, end, c + reach_ + 1);
            if (begin < end) visit(begin, end);
        });
    }
    // Calls visit(k) for each sorted point k of those rows.
    template <class Visit>
    void around(const Vec3f& x, Visit visit) const {
        rows(x, [&](uint32_t begin, uint32_t end) {
            for (uint32_t k = begin; k < end; ++k) visit(k);
        });
    }

    // `rows` of sorted points a few at a time, one after the other, whose ranges move on with them.
    class Sweep {
      public:
        explicit Sweep(const NeighborGrid& grid) : grid_(grid) {}
        // To points first .. e - 1: those before `stop` that lie in a row with `first` and no farther from it
        // along the row than the radius reaches. Returns e. `first`: beyond the call before's.
        size_t move_to(size_t first, size_t stop) {
            if (first >= row_end_) start(first);
            const int low = grid_.column_[first];
            size_t end = stop < row_end_ ? stop : row_end_;
            while (grid_.column_[end - 1] - low > grid_.reach_) --end;
            const int high = grid_.column_[end - 1];
            for (int r = 0; r < count_; ++r) {
                Range& row = range_[r];
                while (row.begin < row.stop && grid_.column_[row.begin] < low - grid_.reach_) ++row.begin;
                while (row.end < row.stop && grid_.column_[row.end] <= high + grid_.reach_) ++row.end;
            }
            return end;
        }
        // The rows around any of those points.
        template <class Visit>
        void rows(Visit visit) const {
            for (int r = 0; r < count_; ++r)
                if (range_[r].begin < range_[r].end) visit(range_[r].begin, range_[r].end);
        }

      private:
        struct Range {
            uint32_t begin, end, stop;
        };
        void start(size_t first_of_row) {
            const Vec3f x = grid_.sorted(first_of_row);
            count_ = 0;
            const int first = grid_.column(x.y) - grid_.reach_;
            grid_.for_each_row(x, [&](uint32_t begin, uint32_t end) {
                const uint32_t from = grid_.first_at(begin, end, first);
                range_[count_++] = {from, from, end};
            });
            const size_t row = grid_.first_part(grid_.row_of(x));
            row_end_ = grid_.start_[row + 1];
            if (first_of_row >= row_end_) row_end_ = grid_.start_[row + 2];
        }
        const NeighborGrid& grid_;
        Range range_[9];
        int count_ = 0;
        size_t row_end_ = 0;
    };

  private:
    static int whole(float cell, int most) {
        return !(cell >= -2) ? -2 : cell > float(most) ? most : int(cell);
    }
    int cell(float x, float origin) const { return whole(std::floor((x - origin) * inverse_), 1 << 20); }
    int column(float y) const { return whole(std::floor((y - origin_.y) * per_column_), most_columns); }
    size_t row_of(const Vec3f& p) const {
        return size_t(cell(p.z, origin_.z)) * size_t(nx_) + size_t(cell(p.x, origin_.x));
    }
    // Of a row: those with weight; where some are without, these follow.
    size_t first_part(size_t row) const { return parts_ * row; }
    // The first of sorted points begin .. end - 1, of one row, that lies in `column` or beyond.
    uint32_t first_at(uint32_t begin, uint32_t end, int column) const {
        while (begin < end) {
            const uint32_t middle = begin + (end - begin) / 2;
            if (column_[middle] < column)
                begin = middle + 1;
            else
                end = middle;
        }
        return begin;
    }
    template <class Visit>
    void for_each_row(const Vec3f& x, Visit visit) const {
        const int cx = cell(x.x, origin_.x), cz = cell(x.z, origin_.z);
        for (int z = cz > 0 ? cz - 1 : 0; z <= cz + 1 && z < nz_; ++z)
            for (int across = cx > 0 ? cx - 1 : 0; across <= cx + 1 && across < nx_; ++across) {
                const size_t row = first_part(size_t(z) * size_t(nx_) + size_t(across));
                if (start_[row] < start_[row + 1]) visit(start_[row], start_[row + 1]);
            }
    }

    static constexpr int most_columns = 1 << 16;
    Vec3f origin_{0, 0, 0};
    float inverse_ = 1, per_column_ = 1;
    int reach_ = 0, nx_ = 0, nz_ = 0;      // reach: columns that hold the radius
    size_t parts_ = 1;                     // of a row
    std::vector<uint32_t> start_, order_;  // start: (row, part, and one)
    std::vector<uint32_t> next_;           // of a sort: (thread, bin)
    std::vector<uint16_t> column_;         // of sorted points
    PointQuads points_;
};

}  // namespace wetcurl

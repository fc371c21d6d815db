// Eq 10 by cloud in cell: particles deposit at corners, find what is there, and move.
#include "learn/codec/lock_grid.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/error.h"
#include "base/geometry/filter.h"

namespace wetcurl {

using S = LockGrid::S;

namespace {

constexpr int together = 64;  // numbers that a thread takes at a time
constexpr size_t no_corner = std::numeric_limits<size_t>::max();

// A particle's cell and the weights of its corners.
struct InCell {
    int x, y, z;
    float fx, fy, fz;
    InCell(const Vec3f& at, const int (&low)[3])
        : InCell({at.x - float(low[0]), at.y - float(low[1]), at.z - float(low[2])}) {}
    explicit InCell(const Vec3f& at)
        : x(int(at.x)),
          y(int(at.y)),
          z(int(at.z)),
          fx(at.x - float(x)),
          fy(at.y - float(y)),
          fz(at.z - float(z)) {}
    // f(x, y, z, weight) of corners in one of the two planes.
    template <class F>
    void corners(int plane, F f) const {
        const float a = plane ? fx : 1 - fx, b = a * fy, c = a - b;
        f(x + plane, y, z, c - c * fz), f(x + plane, y, z + 1, c * fz);
        f(x + plane, y + 1, z, b - b * fz), f(x + plane, y + 1, z + 1, b * fz);
    }
};

Vec3f lane_of(const Vec3<S>& x, int lane) { return {x.x[lane], x.y[lane], x.z[lane]}; }

// Of numbers from 0 on, without what is behind the point.
S whole(const S& a) {
    typedef int Ints __attribute__((vector_size(sizeof(S::Register))));
    return __builtin_convertvector(__builtin_convertvector(a.v, Ints), S::Register);
}

S size_of(const S& a) { return maximum(a, -a); }

}  // namespace

LockGrid::LockGrid(LockTerms terms, const RootLanes& lanes, int particles, const std::vector<float>& edges,
                   const std::vector<float>& saturation)
    : terms_(std::move(terms)),
      lanes_(lanes),
      particles_(size_t(particles)),
      // The variance of the cubic spline of support h along an axis is 3/40 h^2, that of the weights a third
      // of a cell's square.
      cell_(std::sqrt(0.225f) * terms_.reach) {
    const size_t all = size_t(lanes.count()) * particles_;
    if (edges.size() != all || saturation.size() != all)
        throw Error("locks: found " + std::to_string(edges.size()) + " edges and " +
                    std::to_string(saturation.size()) + " saturations, allowed is one each a particle, " +
                    std::to_string(all));
    if (!(terms_.reach > 0) || terms_.sweeps.empty() || terms_.frames < 1)
        throw Error("locks: found a reach of Eq 10 of " + std::to_string(terms_.reach) + " m, " +
                    std::to_string(terms_.sweeps.size()) + " sweeps and " + std::to_string(terms_.frames) +
                    " frames, allowed is what is above 0");
    std::vector<double> length(size_t(lanes.count()), 0);
    double reach = 0, sum = 0;
    for (size_t s = 0; s < length.size(); ++s) {
        for (size_t i = 0; i < particles_; ++i) length[s] += edges[s * particles_ + i];
        sum += length[s];
        const int place = lanes.place_of(int(s));
        reach = std::max(reach,
                         length[s] + double(norm(lane_of(lanes.root(place / S::lanes), place % S::lanes))));
    }
    // Strands are longer than at rest by a little, and strays by more.
    constexpr double most_corners = 1 << 28;
    most_cells_ = float(1.1 * reach / cell_);
    if (std::pow(2 * most_cells_, 3) > most_corners)
        throw Error("locks: found a reach of Eq 10 of " + std::to_string(terms_.reach) +
                    " m in hair that reaches " + std::to_string(reach) + " m far, allowed are " +
                    std::to_string(2 * double(most_cells_) / std::cbrt(most_corners) * terms_.reach) +
                    " m or more");

    constexpr double asked_of_reach = 0.6;  // how far apart particles are asked
    const double edge = sum / (double(lanes.count()) * (particles - 1));
    every_ = edge > 0
                 ? int(std::clamp(std::round(asked_of_reach * terms_.reach / edge), 1.0, particles - 1.0))
                 : 1;
    count_ = (particles - 2) / every_ + 2;
    at_.resize(size_t(every_) * count_);
    before_.resize(size_t(every_) * particles_), after_.resize(before_.size());
    for (int turn = 0; turn < every_; ++turn) {
        int* const at = &at_[size_t(turn) * count_];
        for (int j = 1; j < count_; ++j) at[j] = j < count_ - 1 ? j * every_ - turn : particles - 1;
        for (int i = 0, j = 0; i < particles; ++i) {
            while (j < count_ - 2 && i >= at[j + 1]) ++j;
            const size_t k = size_t(turn) * particles_ + size_t(i);
            before_[k] = j, after_[k] = float(i - at[j]) / float(at[j + 1] - at[j]);
        }
    }
    const size_t blocks = size_t(lanes.blocks());
    volume_.assign(blocks * count_, S(0)), wet_ = volume_, beta_.assign(blocks, S(1));
    for (int s = 0; s < lanes.count(); ++s) {
        const int block = lanes.place_of(s) / S::lanes, lane = lanes.place_of(s) % S::lanes,
                  turn = turn_of(block);
        for (size_t i = 0; i < particles_; ++i) {
            const size_t of = size_t(s) * particles_ + i, k = size_t(turn) * particles_ + i;
            const float volume = 0.5f * (edges[of] + (i + 1 < particles_ ? edges[of + 1] : 0));
            for (int side = 0; side < 2; ++side) {
                const size_t to = size_t(block) * count_ + before_[k] + side;
                const float share = volume * (side ? after_[k] : 1 - after_[k]);
                volume_[to].set(lane, volume_[to][lane] + share);
                wet_[to].set(lane, wet_[to][lane] + share * saturation[of]);
            }
        }
        if (terms_.coherence > 0)
            beta_[size_t(block)].set(lane,
                                     float(filter_beta(length[size_t(s)] / (count_ - 1), terms_.coherence)));
    }
    placed_.assign(blocks * particles_, Vec3<S>{S(0), S(0), S(0)});
    from_.assign(blocks * count_, Vec3<S>{S(0), S(0), S(0)}), now_ = from_, by_ = from_;
    drawn_.resize(size_t(terms_.frames) * from_.size());
    extent_.resize(blocks);
}

void LockGrid::take(int block, const Pose& head) {
    const Quat<S> back = cast<S>(conjugate(cast<float>(head.rotation)));
    const Vec3<S> middle = cast<S>(cast<float>(head.translation));
    const Vec3<S>* const x = strands(block);
    const int* const at = &at_[size_t(turn_of(block)) * count_];
    Vec3<S>* const now = asked(now_, block);
    // Whatever a damaged network answers stays within what the box may be.
    const S far(most_cells_);
    const auto within = [&](const S& a) { return minimum(maximum(a, -far), far); };
    for (int j = 0; j < count_; ++j) {
        const Vec3<S> local = S(1 / cell_) * rotate(back, x[at[j]] - middle);
        now[j] = {within(local.x), within(local.y), within(local.z)};
    }
    std::copy_n(now, count_, asked(from_, block));
    measure(block);
}

void LockGrid::measure(int block) {
    const Vec3<S>* const now = asked(now_, block);
    Extent& extent = extent_[size_t(block)];
    extent = {{1e30f, 1e30f, 1e30f}, {-1e30f, -1e30f, -1e30f}};
    Vec3<S> low = cast<S>(extent.low), high = cast<S>(extent.high);
    for (int j = 0; j < count_; ++j) {
        low = {minimum(low.x, now[j].x), minimum(low.y, now[j].y), minimum(low.z, now[j].z)};
        high = {maximum(high.x, now[j].x), maximum(high.y, now[j].y), maximum(high.z, now[j].z)};
    }
    for (int lane = 0; lane < S::lanes; ++lane) {
        if (lanes_.strand(block, lane) < 0) continue;
        const Vec3f l = lane_of(low, lane), h = lane_of(high, lane);
        extent.low = {std::min(extent.low.x, l.x), std::min(extent.low.y, l.y), std::min(extent.low.z, l.z)};
        extent.high = {std::max(extent.high.x, h.x), std::max(extent.high.y, h.y),
                       std::max(extent.high.z, h.z)};
    }
}

// The box around all that is asked, and which of its planes each thread fills: about as many particles lie in
// each one's.
void LockGrid::lay_out() {
    Extent all = extent_[0];
    for (const Extent& e : extent_) {
        all.low = {std::min(all.low.x, e.low.x), std::min(all.low.y, e.low.y), std::min(all.low.z, e.low.z)};
        all.high = {std::max(all.high.x, e.high.x), std::max(all.high.y, e.high.y),
                    std::max(all.high.z, e.high.z)};
    }
    const float low[] = {all.low.x, all.low.y, all.low.z}, high[] = {all.high.x, all.high.y, all.high.z};
    for (int axis = 0; axis < 3; ++axis) {
        box_.low[axis] = int(std::floor(low[axis]));
        // By the same difference as cells are, which may round up.
        box_.size[axis] = int(high[axis] - float(box_.low[axis])) + 2;
    }
    const size_t corners = size_t(box_.size[0]) * box_.size[1] * box_.size[2];
    if (corner_at_.size() < corners) corner_at_.resize(corners + corners / 4);
    numbered_ = 1;

    const int threads = omp_get_num_threads();
    const size_t most =
        1 + std::min(corners, 8 * size_t(lanes_.count()) * count_) + size_t(together) * size_t(threads);
    if (corners_.size() < most) corners_.resize(most), place_.resize(most);
    slab_.assign(size_t(threads) + 1, box_.size[0]);
    slab_[0] = 0;
    if (threads == 1) return;
    std::vector<long> in_plane(size_t(box_.size[0]), 0);
    long count = 0;
    for (int block = 0; block < lanes_.blocks(); ++block)
        for (int j = 0; j < count_; ++j)
            for (int lane = 0; lane < S::lanes; ++lane)
                if (lanes_.strand(block, lane) >= 0)
                    ++in_plane[size_t(int(asked(now_, block)[j].x[lane] - float(box_.low[0])))], ++count;
    long before = 0;
    for (int plane = 0, t = 1; plane < box_.size[0] && t < threads; ++plane) {
        before += in_plane[size_t(plane)];
        while (t < threads && before * threads >= count * t) slab_[size_t(t++)] = plane + 1;
    }
}

// Adds up the corners of this thread's planes, particle by particle: each in one order, whatever the number
// of threads.
void LockGrid::deposit() {
    const size_t t = size_t(omp_get_thread_num());
    const int first = slab_[t], end = slab_[t + 1];
    int next = 0, last = 0;  // numbers that are this thread's to give
    if (first < end)
        for (int block = 0; block < lanes_.blocks(); ++block) {
            const Vec3<S>* const now = asked(now_, block);
            const S holds = lanes_.holds(block) - S(0.5f);
            for (int j = 0; j < count_; ++j) {
                const S x = now[j].x - S(float(box_.low[0]));
                uint32_t mine = bits_of((x > S(float(first - 1))) & (x < S(float(end))) & (holds > S(0)));
                for (int lane = 0; mine; ++lane, mine >>= 1) {
                    if (!(mine & 1)) continue;
                    const size_t k = size_t(block) * count_ + j;
                    const Vec3f at = lane_of(now[j], lane);
                    const float volume = volume_[k][lane], wet = wet_[k][lane];
                    const Sums left = {volume, wet, wet * at.x, wet * at.y, wet * at.z, 0, 0, 0};
                    const InCell in(at, box_.low);
                    for (int plane = 0; plane < 2; ++plane) {
                        if (in.x + plane < first || in.x + plane >= end) continue;
                        in.corners(plane, [&](int cx, int cy, int cz, float weight) {
                            const size_t place = box_.at(cx, cy, cz);
                            int& number = corner_at_[place];
                            if (!number) {
                                if (next == last) {
#pragma omp atomic capture
                                    {
                                        next = numbered_;
                                        numbered_ += together;
                                    }
                                    last = next + together;
                                    std::fill_n(place_.begin() + next, together, no_corner);
                                }
                                number = next++;
                                place_[size_t(number)] = place;
                                corners_[size_t(number)] = Sums{};
                            }
                            corners_[size_t(number)] += weight * left;
                        });
                    }
                }
            }
        }
}

// What a block's particles find of the rest of their own strands: pairs (j, k) that leave something at the
// same corners.
void LockGrid::pull_of_own(int block, Vec3<S>* pull) const {
    const Vec3<S>* const now = &now_[size_t(block) * count_];
    const S* const wet = &wet_[size_t(block) * count_];
    std::fill_n(pull, count_, Vec3<S>{S(0), S(0), S(0)});
    const auto from_low = [&](const Vec3<S>& x) {
        return x - Vec3<S>{S(float(box_.low[0])), S(float(box_.low[1])), S(float(box_.low[2]))};
    };
    // The sum over corners of the product of both weights, along an axis; a: in cell `c`, the part `f` of it.
    const auto both = [](const S& c, const S& f, const S& b) {
        const S zero(0), one(1);
        return (one - f) * maximum(zero, one - size_of(b - c)) +
               f * maximum(zero, one - size_of(b - c - one));
    };
    for (int j = 0; j < count_; ++j) {
        const Vec3<S> a = from_low(now[j]), c{whole(a.x), whole(a.y), whole(a.z)}, f = a - c;
        for (int k = j + 1; k < count_; ++k) {
            const Vec3<S> apart = now[k] - now[j];
            const S farthest = maximum(maximum(size_of(apart.x), size_of(apart.y)), size_of(apart.z));
            if (!any_positive(S(2) - farthest)) continue;
            const Vec3<S> b = from_low(now[k]);
            const S weight = both(c.x, f.x, b.x) * both(c.y, f.y, b.y) * both(c.z, f.z, b.z);
            pull[j] += (weight * wet[k]) * apart;
            pull[k] -= (weight * wet[j]) * apart;
        }
    }
}

void LockGrid::find(int block, float lambda) {
    Vec3<S>*const now = asked(now_, block), *const by = asked(by_, block);
    pull_of_own(block, by);
    by[0] = {S(0), S(0), S(0)};
    for (int j = 1; j < count_; ++j) {
        S volume(1), wet(0);
        Vec3<S> place{S(0), S(0), S(0)};
        for (int lane = 0; lane < S::lanes; ++lane) {
            if (lanes_.strand(block, lane) < 0) continue;
            Sums sum = {};
            const InCell in(lane_of(now[j], lane), box_.low);
            for (int plane = 0; plane < 2; ++plane)
                in.corners(plane, [&](int cx, int cy, int cz, float weight) {
                    sum += weight * corners_[size_t(corner_at_[box_.at(cx, cy, cz)])];
                });
            volume.set(lane, sum[0]), wet.set(lane, sum[1]);
            place.x.set(lane, sum[2]), place.y.set(lane, sum[3]), place.z.set(lane, sum[4]);
        }
        by[j] = (S(lambda) / maximum(volume, S(1e-20f))) * (place - wet * now[j] - by[j]);
    }
    smooth_along(count_, beta_[size_t(block)], [&](int j) -> Vec3<S>& { return by[j]; });
    for (int j = 1; j < count_; ++j) now[j] += by[j];
    measure(block);
}

void LockGrid::draw() {
    for (const float lambda : terms_.sweeps) {
#pragma omp single
        lay_out();
        deposit();
#pragma omp barrier
#pragma omp for schedule(static)
        for (int block = 0; block < lanes_.blocks(); ++block) find(block, lambda);
#pragma omp for schedule(static)
        for (int number = 1; number < numbered_; ++number)
            if (place_[size_t(number)] != no_corner) corner_at_[place_[size_t(number)]] = 0;
    }
}

void LockGrid::show(int block, const Pose& head) {
    Vec3<S>* const x = strands(block);
    Vec3<S>*const from = asked(from_, block), *const now = asked(now_, block);
    const Quat<S> turned = cast<S>(cast<float>(head.rotation));
    const size_t all = from_.size();
    for (int j = 0; j < count_; ++j) {
        Vec3<S>* const drawn = &drawn_[size_t(block) * count_ + size_t(j)];
        const Vec3<S> by = now[j] - from[j];
        for (int slot = 0; slot < terms_.frames; ++slot)
            if (first_ || slot == slot_) drawn[size_t(slot) * all] = by;
        Vec3<S> sum = by;  // the oldest last, wherever in the ring it lies
        for (int back = 1; back < terms_.frames; ++back)
            sum += drawn[size_t((slot_ + terms_.frames - back) % terms_.frames) * all];
        now[j] = S(cell_ / float(terms_.frames)) * rotate(turned, sum);
    }
    const int* const before = &before_[size_t(turn_of(block)) * particles_];
    const float* const after = &after_[size_t(turn_of(block)) * particles_];
    const S most(1 + terms_.stretch), least(tiny_length<S> * tiny_length<S>);
    Vec3<S> last = x[0];
    for (size_t i = 1; i < particles_; ++i) {
        const Vec3<S>*const near = now + before[i], edge = x[i] - last;
        last = x[i];
        const Vec3<S> drawn = x[i] + S(1 - after[i]) * near[0] + S(after[i]) * near[1] - x[i - 1];
        const S allowed = most * most * dot(edge, edge), found = dot(drawn, drawn);
        x[i] = x[i - 1] + select(found > allowed, sqrt(allowed / maximum(found, least)) * drawn, drawn);
    }
}

}  // namespace wetcurl

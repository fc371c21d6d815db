// The search, a vector of candidates at a time.
#include "base/geometry/neighbor_list.h"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <utility>

#include "base/error.h"

namespace wetcurl {

// Runs of one point, the sweep's next. Returns its neighbours.
uint32_t NeighborList::search(const NeighborGrid& grid, NeighborGrid::Sweep& sweep,
                              const std::vector<uint32_t>& group, const std::vector<float>& source,
                              float radius, size_t k, Found& found) {
    using S = Pack<float>;
    const PointArrays& points = grid.points();
    const Vec3f x = points.at(k);
    const Vec3<S> own = cast<S>(x);
    const S reach(radius * radius);
    const S::Mask mine = S::Mask{} + int(group[k]);
    const size_t before = found.count;
    uint32_t neighbours = 0, with_source = 0;
    sweep.rows(k, [&](uint32_t begin, uint32_t end) {
        const auto neighbours_from = [&](uint32_t at) {
            const Vec3<S> d = points.load(at) - own;
            S::Mask groups;
            std::memcpy(&groups, &group[at], sizeof groups);
            const uint32_t bits = bits_of((dot(d, d) < reach) & (groups != mine));
            return end - at < NeighborList::lanes ? bits & ((1u << (end - at)) - 1) : bits;
        };
        found.make_room((end - begin) / NeighborList::lanes + 1);
        for (uint32_t at = begin; at < end; at += NeighborList::lanes) {
            uint32_t bits = neighbours_from(at);
            // A run that is not the last begins with a neighbour: fewer hold them all.
            if (bits && end - at > NeighborList::lanes) {
                at += uint32_t(std::countr_zero(bits));
                bits = neighbours_from(at);
            }
            // Written in any case, kept where there is one: half of the branches would be mispredicted.
            found.first[found.count] = at;
            found.bits[found.count] = uint16_t(bits);
            found.count += bits != 0;
            neighbours += uint32_t(std::popcount(bits));
            with_source |= bits & bits_of(S::load(&source[at]) > S(0));
        }
    });
    if (with_source) return neighbours;
    found.count = before;
    return 0;
}

void NeighborList::build(const NeighborGrid& grid, const std::vector<uint32_t>& group,
                         const std::vector<float>& source, float radius) {
    const size_t count = grid.size(), chunks = (count + chunk - 1) / chunk;
    begin_.resize(count + chunks);
    // As much room for each thread as any has needed: which chunks it meets is chance.
    found_.resize(size_t(omp_get_max_threads()));
    size_t room = 0;
    for (const auto& f : found_) room = std::max(room, f.first.size());
    for (auto& f : found_) f.first.resize(room), f.bits.resize(room);
    std::atomic<size_t> used;
    std::atomic<uint64_t> neighbours;
    for (;;) {
        used = 0, neighbours = 0;
#pragma omp parallel
        {
            // On the thread's own stack: side by side they would take each other's cache lines.
            Found found = std::move(found_[size_t(omp_get_thread_num())]);
#pragma omp for schedule(dynamic)
            for (size_t c = 0; c < chunks; ++c) {
                const size_t low = c * chunk, high = std::min(low + chunk, count);
                uint32_t* begin = &begin_[low + c];
                uint64_t sum = 0;
                found.count = 0;
                NeighborGrid::Sweep sweep(grid);
                for (size_t k = low; k < high; ++k) {
                    begin[k - low] = uint32_t(found.count);
                    sum += search(grid, sweep, group, source, radius, k, found);
                }
                begin[high - low] = uint32_t(found.count);
                neighbours += sum;
                const size_t place = used.fetch_add(found.count);
                if (place + found.count > first_.size()) continue;
                for (size_t k = 0; k <= high - low; ++k) begin[k] += uint32_t(place);
                std::copy_n(found.first.begin(), found.count, first_.begin() + long(place));
                std::copy_n(found.bits.begin(), found.count, bits_.begin() + long(place));
            }
            found_[size_t(omp_get_thread_num())] = std::move(found);
        }
        if (used <= first_.size()) break;
        // A tenth of slack: growing by doubling would double the largest buffer of all.
        const size_t more = used + used / 10;
        if (more > UINT32_MAX) throw Error("neighbour lists: more than 2^32 runs; make the radius smaller");
        first_ = {}, bits_ = {};
        first_.resize(more), bits_.resize(more);
    }
    mean_ = count ? double(neighbours) / double(count) : 0;
}

size_t NeighborList::bytes() const {
    size_t runs = bits_.capacity(), firsts = first_.capacity();
    for (const auto& f : found_) runs += f.bits.capacity(), firsts += f.first.capacity();
    return (firsts + begin_.capacity()) * sizeof(uint32_t) + runs * sizeof(uint16_t);
}

}  // namespace wetcurl

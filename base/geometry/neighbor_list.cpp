// The search, a cluster of points and four candidates at a time.
#include "base/geometry/neighbor_list.h"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <utility>

#include "base/error.h"

namespace wetcurl {

namespace {

constexpr uint32_t all_lanes = (1u << lanes_of<float>)-1, first_lanes = 0x1111u & all_lanes;  // of each quad

// All lanes of quads that have a bit.
uint32_t whole_quads(uint32_t bits) {
    bits |= bits >> 2, bits |= bits >> 1;
    return (bits & first_lanes) * 15;
}

}  // namespace

// Returns its pairs of neighbours.
uint32_t NeighborList::Search::operator()(NeighborGrid::Sweep& sweep, size_t c, Found& found) const {
    using S = Pack<float>;
    // Numbers that are compared alone.
    const auto ids = [](S from) { return std::bit_cast<S::Mask>(from.v); };
    const PointQuads& points = grid.points();
    const size_t first = c * cluster, stop = std::min(first + cluster, grid.size());
    const Vec3<S> own = points.a_quad_each(first);
    const S reach(radius * radius);
    const S::Mask own_group = ids(points.numbers_a_quad_each(first));
    const size_t before = found.count;
    uint32_t pairs = 0, with_source = 0;
    for (size_t k = first, end; k < stop; k = end) {
        end = sweep.move_to(k, stop);
        bool some = false;
        sweep.rows([&](uint32_t low, uint32_t high) {
            for (size_t block = low / sources; !some && block <= (high - 1) / sources; ++block)
                some = some_source[block];
        });
        if (!some) continue;
        // Lanes of those points.
        const uint32_t asked = (1u << 4 * (end - first)) - (1u << 4 * (k - first));
        sweep.rows([&](uint32_t low, uint32_t high) {
            found.make_room((high - low) / 4 + 2);
            for (uint32_t at = low & ~3u; at < high; at += 4) {
                const Vec3<S> d = points.in_each_quad(at / 4) - own;
                uint32_t bits =
                    bits_of((dot(d, d) < reach) & (ids(points.numbers_in_each_quad(at / 4)) != own_group)) &
                    asked;
                if (at < low) bits &= (15u << (low - at) & 15) * first_lanes;
                if (high - at < 4) bits &= ((1u << (high - at)) - 1) * first_lanes;
                // Written in any case, kept where there is one: half of the branches would be mispredicted.
                found.four[found.count] = at / 4;
                found.bits[found.count] = uint16_t(bits);
                found.count += bits != 0;
                pairs += uint32_t(std::popcount(bits));
                with_source |= bits & bits_of(in_each_quad(&source[at]) > S(0));
            }
        });
    }
    // Those of points without a source go.
    const uint32_t kept = whole_quads(with_source);
    size_t count = before;
    if (kept == all_lanes) return pairs;
    for (size_t r = before; r < found.count; ++r) {
        const uint32_t bits = found.bits[r] & kept;
        pairs -= uint32_t(std::popcount(found.bits[r] ^ bits));
        found.four[count] = found.four[r], found.bits[count] = uint16_t(bits);
        count += bits != 0;
    }
    found.count = count;
    return pairs;
}

void NeighborList::build(const NeighborGrid& grid, const std::vector<float>& source, float radius) {
    const size_t count = grid.size();
    clusters_ = (count + cluster - 1) / cluster;
    const size_t chunks = (clusters_ + chunk - 1) / chunk;
    some_source_.resize((count + sources - 1) / sources);
#pragma omp parallel for schedule(static)
    for (size_t block = 0; block < some_source_.size(); ++block) {
        const auto first = source.begin() + long(block * sources),
                   end = source.begin() + long(std::min(count, (block + 1) * sources));
        some_source_[block] = std::any_of(first, end, [](float s) { return s > 0; });
    }
    const Search search{grid, source, some_source_, radius};
    begin_.resize(clusters_ + chunks);
    // As much room for each thread as any has needed: which chunks it meets is chance.
    found_.resize(size_t(omp_get_max_threads()));
    size_t room = 0;
    for (const auto& f : found_) room = std::max(room, f.four.size());
    for (auto& f : found_) f.four.resize(room), f.bits.resize(room);
    std::atomic<size_t> used;
    std::atomic<uint64_t> neighbours;
    std::atomic<bool> beyond;
    for (;;) {
        used = 0, neighbours = 0, beyond = false;
#pragma omp parallel
        {
            // On the thread's own stack: side by side they would take each other's cache lines.
            Found found = std::move(found_[size_t(omp_get_thread_num())]);
#pragma omp for schedule(dynamic)
            for (size_t c = 0; c < chunks; ++c) {
                const size_t low = c * chunk, high = std::min(low + chunk, clusters_);
                uint32_t* begin = &begin_[low + c];
                uint64_t sum = 0;
                found.count = 0;
                NeighborGrid::Sweep sweep(grid);
                for (size_t k = low; k < high; ++k) {
                    begin[k - low] = uint32_t(found.count);
                    sum += search(sweep, k, found);
                }
                begin[high - low] = uint32_t(found.count);
                neighbours += sum;
                const size_t place = used.fetch_add(found.count);
                if (place + found.count > bits_.size()) continue;
                std::copy_n(found.bits.begin(), found.count, bits_.begin() + long(place));
                if (far_.empty()) {
                    bool fits = true;
                    for (size_t k = low; k < high; ++k)
                        for (size_t r = begin[k - low]; r < begin[k - low + 1]; ++r) {
                            const long offset = long(found.four[r]) - long(own_four(k));
                            offset_[place + r] = int16_t(offset);
                            fits = fits && offset == offset_[place + r];
                        }
                    if (!fits) beyond = true;
                } else {
                    std::copy_n(found.four.begin(), found.count, far_.begin() + long(place));
                }
                for (size_t k = 0; k <= high - low; ++k) begin[k] += uint32_t(place);
            }
            found_[size_t(omp_get_thread_num())] = std::move(found);
        }
        if (used <= bits_.size() && !beyond) break;
        // A twentieth of slack, more for few: growing by doubling would double the largest buffer of all.
        const size_t runs = used <= bits_.size() ? bits_.size() : used + used / 20 + 1024;
        if (runs > UINT32_MAX) throw Error("neighbour lists: more than 2^32 runs; make the radius smaller");
        const bool far = beyond || !far_.empty();
        offset_ = {}, far_ = {}, bits_ = {};
        far ? far_.resize(runs) : offset_.resize(runs);
        bits_.resize(runs);
    }
    mean_ = count ? double(neighbours) / double(count) : 0;
}

size_t NeighborList::bytes() const {
    size_t shorts = bits_.capacity() + offset_.capacity(), longs = far_.capacity() + begin_.capacity();
    for (const auto& f : found_) shorts += f.bits.capacity(), longs += f.four.capacity();
    return longs * sizeof(uint32_t) + shorts * sizeof(uint16_t) + some_source_.capacity();
}

}  // namespace wetcurl

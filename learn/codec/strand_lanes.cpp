// Strands in lanes.
#include "learn/codec/strand_lanes.h"

#include <utility>

#include "base/pack_tile.h"
#include "learn/codec/root_grid.h"

namespace wetcurl {

StrandLanes::StrandLanes(std::vector<int> strand, int count)
    : strand_(std::move(strand)), place_of_(size_t(count)) {
    const size_t blocks = (strand_.size() + lanes - 1) / lanes;
    strand_.resize(blocks * lanes, -1);
    holds_.assign(blocks, S(0));
    for (size_t place = 0; place < strand_.size(); ++place) {
        if (strand_[place] < 0) continue;
        place_of_[size_t(strand_[place])] = int(place);
        holds_[place / lanes].set(int(place % lanes), 1);
    }
}

StrandLanes StrandLanes::in_order(int count) {
    std::vector<int> strand(static_cast<size_t>(count));
    for (int s = 0; s < count; ++s) strand[size_t(s)] = s;
    return StrandLanes(std::move(strand), count);
}

StrandLanes StrandLanes::on_grid(const RootGrid& grid, int count) {
    const size_t row_places = size_t(grid.width + lanes - 1) / lanes * lanes;
    std::vector<int> strand(row_places * size_t(grid.height), -1);
    const std::vector<int> pixel_of = pixels_of_strands(grid, count);
    for (int s = 0; s < count; ++s) {
        const size_t pixel = size_t(pixel_of[size_t(s)]), width = size_t(grid.width);
        strand[pixel / width * row_places + pixel % width] = s;
    }
    return StrandLanes(std::move(strand), count);
}

void StrandLanes::load(int block, int count, const float* rows, S* columns) const {
    const float* row[lanes];
    float weight[lanes];
    for (int lane = 0; lane < lanes; ++lane) {
        const int s = strand(block, lane);
        row[lane] = rows + size_t(s < 0 ? 0 : s) * count;
        weight[lane] = s < 0 ? 0 : 1;
    }
    weighted_columns(count, 1, row, weight, columns);
    // Where a lane has no strand, whatever strand 0 has.
    const auto mine = holds(block) > S(0);
    if (bits_of(mine) + 1 != 1u << lanes)
        for (int j = 0; j < count; ++j) columns[j] = select(mine, columns[j], S(0));
}

void StrandLanes::store(int block, int count, const S* columns, float* rows) const {
    float* row[lanes];
    for (int lane = 0; lane < lanes; ++lane) {
        const int s = strand(block, lane);
        row[lane] = s < 0 ? nullptr : rows + size_t(s) * count;
    }
    rows_of(count, columns, row);
}

using S = StrandLanes::S;

RootLanes::RootLanes(StrandLanes strands, const RootFrames& frames)
    : StrandLanes(std::move(strands)),
      rotation_(size_t(blocks()), Quat<S>::identity()),
      root_(size_t(blocks()), Vec3<S>{S(0), S(0), S(0)}) {
    for (int s = 0; s < count(); ++s) {
        const size_t block = size_t(place_of(s) / lanes);
        const int lane = place_of(s) % lanes;
        const Quatf& q = frames.rotation[size_t(s)];
        const Vec3f& x = frames.root[size_t(s)];
        Quat<S>& rotation = rotation_[block];
        rotation.w.set(lane, q.w), rotation.x.set(lane, q.x);
        rotation.y.set(lane, q.y), rotation.z.set(lane, q.z);
        root_[block].x.set(lane, x.x), root_[block].y.set(lane, x.y), root_[block].z.set(lane, x.z);
    }
}

const Quat<S>& RootLanes::rotation(int block) const { return rotation_[size_t(block)]; }
const Vec3<S>& RootLanes::root(int block) const { return root_[size_t(block)]; }

Quat<S> RootLanes::rotation_at(int block, const Pose& head) const {
    return cast<S>(head.rotation) * rotation(block);
}

Vec3<S> RootLanes::root_at(int block, const Pose& head) const {
    return rotate(cast<S>(head.rotation), root(block)) + cast<S>(head.translation);
}

}  // namespace wetcurl

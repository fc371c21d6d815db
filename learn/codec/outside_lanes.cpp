// Strands pushed out in lanes.
#include "learn/codec/outside_lanes.h"

#include <cmath>
#include <limits>
#include <utility>

namespace wetcurl {

using S = OutsideLanes::S;

OutsideLanes::OutsideLanes(HeadShapes head, const StrandLanes& lanes, int particles,
                           const std::vector<float>& edges)
    : head_(std::move(head)), particles_(particles) {
    require_each(head_, edges.size());
    for (const Shape& shape : head_.shapes) views_.push_back(view_of(shape));
    depth_.resize(size_t(lanes.blocks()) * particles), torn_.resize(depth_.size());
    for (int block = 0; block < lanes.blocks(); ++block) {
        const size_t first = size_t(block) * particles;
        lanes.load(block, particles, head_.depth.data(), &depth_[first]);
        lanes.load(block, particles, edges.data(), &torn_[first]);
        const S never = S(1e30f) * (lanes.holds(block) - S(1));  // where a lane has no strand
        for (size_t k = first; k < first + size_t(particles); ++k) {
            depth_[k] += never;
            torn_[k] = S(torn_lengths * torn_lengths) * torn_[k] * torn_[k] - never;
        }
    }
}

static Vec3f lane_of(const Vec3<S>& x, int lane) { return {x.x[lane], x.y[lane], x.z[lane]}; }
static void set_lane(Vec3<S>& x, int lane, const Vec3f& to) {
    x.x.set(lane, to.x), x.y.set(lane, to.y), x.z.set(lane, to.z);
}

void OutsideLanes::push(int block, const Pose& head, Vec3<S>* x) const {
    if (views_.empty()) return;
    const S *depth = &depth_[size_t(block) * particles_], *torn = &torn_[size_t(block) * particles_];
    const Quatf turn = cast<float>(head.rotation), back = conjugate(turn);
    const Vec3f place = cast<float>(head.translation);
    const auto out_of_shapes = [&](const Vec3f& world, float deepest) {
        const Vec3f from = rotate(back, world - place);
        Vec3f to = from;
        for (const ShapeView& shape : views_) to = pushed_out(shape, to, deepest);
        return norm(to - from) > 0 ? place + rotate(turn, to) : world;
    };
    const Quat<S> backs = cast<S>(back);
    const Vec3<S> places = cast<S>(place);
    // How far a particle is from every shape at least: whatever of it is left after an edge, is what the next
    // one has at least. Sampled distances change by up to sqrt(3) times the way.
    constexpr float steepest = 1.7321f;
    S clear(-1);
    for (int i = 1; i < particles_; ++i) {
        const S edge = norm(x[i] - x[i - 1]);
        clear -= S(steepest) * edge;
        if (!bits_of(clear <= S(0))) continue;
        const Vec3<S> from = rotate(backs, x[i] - places);
        uint32_t inside = 0;
        S least(std::numeric_limits<float>::max());
        for (const ShapeView& shape : views_) {
            const S phi = distance(shape, from).phi;
            inside |= bits_of(phi < depth[i]);
            least = minimum(least, phi);
        }
        clear = least;
        for (int lane = 0; inside; ++lane, inside >>= 1)
            if (inside & 1) set_lane(x[i], lane, out_of_shapes(lane_of(x[i], lane), depth[i][lane]));
    }
    for (int i = 1; i < particles_; ++i) {
        const Vec3<S> edge = x[i] - x[i - 1];
        uint32_t too_long = bits_of(dot(edge, edge) > torn[i]);
        for (int lane = 0; too_long; ++lane, too_long >>= 1)
            if (too_long & 1)
                set_lane(x[i], lane,
                         led_around(lane_of(x[i - 1], lane), lane_of(x[i], lane), std::sqrt(torn[i][lane]),
                                    [&](const Vec3f& at) { return out_of_shapes(at, depth[i][lane]); }));
    }
}

}  // namespace wetcurl

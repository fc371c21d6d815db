// Rest shapes carried by the strands around them.
#include "learn/codec/carried_rest.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"

namespace wetcurl {

static Strands cores_of(const Strands& strands) {
    Strands cores(strands.count, strands.particles);
    take_cores(strands, cores);
    return cores;
}

// Edge i of a strand [m].
static Vec3f edge_of(const Strands& strands, int strand, int i) {
    return strands.at(strand, i + 1) - strands.at(strand, i);
}

// Mean square of how far two strands lie apart, seen from their roots [m^2].
static float square_apart(const Vec3f* a, const Vec3f* b, int n) {
    float sum = 0;
    for (int i = 0; i < n; ++i) {
        const Vec3f d = (a[i] - a[0]) - (b[i] - b[0]);
        sum += dot(d, d) / float(n);
    }
    return sum;
}

// Of the strands around one those that are drawn as it is count most; a hundredth of its length apart is as
// good as not.
void RestCarrier::weigh(const Strands& drawn_cores) {
    constexpr float alike = 0.01f;
    const int n = particles_, width = around_.width;
#pragma omp parallel for schedule(static)
    for (int s = 0; s < drawn_cores.count; ++s) {
        float* weight = around_.weight.data() + size_t(s) * width;
        const int* from = around_.from.data() + size_t(s) * width;
        const Vec3f* core = drawn_cores.strand(s);
        const float least = alike * float(arc_length(core, n));
        float sum = 0;
        for (int k = 0; k < width; ++k) {
            const float apart = square_apart(core, low_rest_cores_.strand(from[k]), n);
            weight[k] /= std::max(least * least + apart, tiny_length<float>);
            sum += weight[k];
        }
        for (int k = 0; k < width; ++k) weight[k] /= sum;
    }
}

// What each low-resolution strand's core has and those beside it have not, and by how much all of it a
// high-resolution strand measures what is lost.
void RestCarrier::find_own(const Groom& low, const Strands& drawn_cores) {
    beside_.assign(size_t(low.rest.count), {});
    own_ = Strands(low.rest.count, particles_);
    for (int row = 0; row < low.grid.height; ++row)
        for (int column = 0; column < low.grid.width; ++column) {
            const int s = low.grid.at(column, row);
            if (s < 0) continue;
            int* beside = beside_[size_t(s)].strand;
            int count = 0;
            for (auto [c, r] :
                 {std::pair{column - 1, row}, {column + 1, row}, {column, row - 1}, {column, row + 1}})
                if (c >= 0 && r >= 0 && c < low.grid.width && r < low.grid.height && low.grid.at(c, r) >= 0)
                    beside[count++] = low.grid.at(c, r);
            for (int i = 0; count > 1 && i + 1 < particles_; ++i) {  // one beside it says nothing of a mean
                Vec3f& own = own_.at(s, i) = edge_of(low_rest_cores_, s, i);
                for (int k = 0; k < count; ++k)
                    own -= (1.f / float(count)) * edge_of(low_rest_cores_, beside[k], i);
            }
        }
    constexpr float least_turn = 0.03f;  // of edges from those around [rad]; less says nothing
    const int n = particles_, width = around_.width;
    lost_weight_.resize(around_.weight.size());
#pragma omp parallel for schedule(static)
    for (int s = 0; s < drawn_cores.count; ++s) {
        const int* from = around_.from.data() + size_t(s) * width;
        const float* weight = around_.weight.data() + size_t(s) * width;
        const float least = least_turn * float(arc_length(drawn_cores.strand(s), n));
        float all = std::max(least * least / float(n - 1), tiny_length<float>);
        for (int k = 0; k < width; ++k)
            for (int i = 0; i + 1 < n; ++i) all += weight[k] * dot(own_.at(from[k], i), own_.at(from[k], i));
        for (int k = 0; k < width; ++k) lost_weight_[size_t(s) * width + k] = weight[k] / all;
    }
}

Settled settled_between(const Strands& dry, const Strands& wet) {
    constexpr float whole = 0.05f, none = 0.2f;  // how far apart, of a strand's length
    const int n = wet.particles;
    Settled out{std::vector<float>(size_t(wet.count)), wet};
    for (int s = 0; s < wet.count; ++s) {
        const float far = std::sqrt(square_apart(wet.strand(s), dry.strand(s), n)) /
                          std::max(float(arc_length(wet.strand(s), n)), tiny_length<float>);
        out.share[size_t(s)] = std::clamp((none - far) / (none - whole), 0.f, 1.f);
        for (int i = 0; i < n; ++i) out.more.at(s, i) -= out.share[size_t(s)] * dry.at(s, i);
    }
    return out;
}

// Cores are linear in the strand: that of a strand moved is the sum of both.
void RestCarrier::start_from(const Settled& settled) {
    settled_ = settled;
    const Strands cores = cores_of(settled.more);
    for (size_t k = 0; k < cores.points.size(); ++k) low_rest_cores_.points[k] -= cores.points[k];
}

RestCarrier::RestCarrier(Stencil stencil, const Groom& high, const Groom& low, const Strands* shape,
                         bool low_is_wet, const Settled* settled)
    : particles_(high.rest.particles),
      low_is_wet_(low_is_wet || settled),
      around_(std::move(stencil)),
      low_rest_cores_(cores_of(low.rest)),
      moved_(low.rest.count, low.rest.particles),
      lost_(size_t(low.rest.count)) {
    auto size = [](const Strands& s) {
        return std::to_string(s.count) + " strands of " + std::to_string(s.particles) + " particles";
    };
    const Strands& curled = shape ? *shape : high.rest;
    if (size(curled) != size(high.rest))
        throw Error("interpolation: found a shape at rest of " + size(curled) + ", allowed that of all " +
                    size(high.rest));
    if (around_.count() != high.rest.count)
        throw Error("interpolation: found a stencil for " + std::to_string(around_.count()) +
                    " strands, allowed one for all " + std::to_string(high.rest.count));
    if (settled && size(settled->more) != size(low.rest))
        throw Error("interpolation: found " + size(settled->more) +
                    " that have settled, allowed all low-resolution " + size(low.rest));
    const Strands drawn_cores = cores_of(high.rest), curled_cores = cores_of(curled);
    weigh(drawn_cores);
    find_own(low, drawn_cores);
    const RootFrames roots = root_frames(high);
    const int n = particles_, width = around_.width, blocks = (high.rest.count + S::lanes - 1) / S::lanes;
    constexpr float longest = 4;  // edges, of the drawn ones
    const Vec3<S> none{S(0), S(0), S(0)};
    rest_.assign(size_t(blocks) * n, {none, S(1), none, none, none});
    to_root_.assign(size_t(blocks), Quat<S>::identity());
    auto set = [](Vec3<S>& to, int lane, const Vec3f& x) {
        to.x.set(lane, x.x), to.y.set(lane, x.y), to.z.set(lane, x.z);
    };
#pragma omp parallel for schedule(static)
    for (int block = 0; block < blocks; ++block)
        for (int s = block * S::lanes; s < std::min(high.rest.count, (block + 1) * S::lanes); ++s) {
            const int lane = s % S::lanes;
            const Quatf to_root = conjugate(roots.rotation[size_t(s)]);
            Quat<S>& q = to_root_[size_t(block)];
            q.w.set(lane, to_root.w), q.x.set(lane, to_root.x);
            q.y.set(lane, to_root.y), q.z.set(lane, to_root.z);
            const Vec3f *core = curled_cores.strand(s), *p = curled.strand(s);
            const int* from = around_.from.data() + size_t(s) * width;
            const float* weight = around_.weight.data() + size_t(s) * width;
            for (int i = 0; i < n; ++i) {
                RestParticle<S>& out = rest_[size_t(block) * n + i];
                set(out.detail, lane, rotate(to_root, p[i] - core[i]));
                if (i + 1 == n) continue;
                const Vec3f edge = edge_of(drawn_cores, s, i), along = core[i + 1] - core[i];
                Vec3f own = edge;
                for (int k = 0; k < width; ++k) own -= weight[k] * edge_of(low_rest_cores_, from[k], i);
                // Wet strands come as short as they are. An edge that is drawn as good as nowhere tells
                // nothing.
                const float length =
                    low_is_wet_ ? 1
                                : std::min(norm(along) / std::max(norm(edge), tiny_length<float>), longest);
                out.length.set(lane, length);
                set(out.edge, lane, rotate(to_root, length * edge));
                set(out.own, lane, rotate(to_root, length * own));
                set(out.curled, lane, rotate(to_root, along));
            }
        }
    if (settled) start_from(*settled);
}

RestParticle<float> RestCarrier::rest(int strand, int particle) const {
    const RestParticle<S>& p = rest_[size_t(strand / S::lanes) * particles_ + particle];
    const int lane = strand % S::lanes;
    auto of = [&](const Vec3<S>& v) { return Vec3f{v.x[lane], v.y[lane], v.z[lane]}; };
    return {of(p.edge), p.length[lane], of(p.curled), of(p.detail), of(p.own)};
}

void RestCarrier::apply(const Strands& low, const Pose& head, Strands& out) {
    const int n = low.particles, width = around_.width;
    if (low.count != moved_.count || n != moved_.particles)
        throw Error("interpolation: found " + std::to_string(low.count) + " low-resolution strands of " +
                    std::to_string(n) + " particles, allowed " + std::to_string(moved_.count) + " of " +
                    std::to_string(moved_.particles));
    if (out.count != around_.count() || out.particles != n) out = Strands(around_.count(), n);
    const Quatf to_head = cast<float>(conjugate(head.rotation));
    take_cores(low, moved_);
#pragma omp parallel for schedule(static)
    for (int s = 0; s < low.count; ++s) {
        Vec3f* moved = moved_.strand(s);
        const Vec3f* rest = low_rest_cores_.strand(s);
        const float share = settled_.share.empty() ? 1 : settled_.share[size_t(s)];
        for (int i = n - 1; i >= 0; --i)
            moved[i] = share * rotate(to_head, moved[i] - moved[0]) - (rest[i] - rest[0]);
    }
#pragma omp parallel for schedule(static)
    for (int s = 0; s < low.count; ++s) {
        const Beside& beside = beside_[size_t(s)];
        float sum = 0;
        for (int i = 0; i + 1 < n; ++i)
            sum += lost_of_edge(own_.at(s, i), s, beside, [&](int k) { return edge_of(moved_, k, i); });
        lost_[size_t(s)] = sum;
    }
#pragma omp parallel for schedule(static)
    for (int block = 0; block < int(to_root_.size()); ++block) {
        const int first = block * S::lanes, lanes = std::min(S::lanes, out.count - first);
        const int* from = around_.from.data() + size_t(first) * width;
        const float *weight = around_.weight.data() + size_t(first) * width,
                    *lost_weight = lost_weight_.data() + size_t(first) * width;
        S lost(0);
        for (int lane = 0; lane < lanes; ++lane) {
            float sum = 0;
            for (int k = lane * width; k < (lane + 1) * width; ++k)
                sum += lost_weight[k] * lost_[size_t(from[k])];
            lost.set(lane, std::clamp(sum, 0.f, 1.f));
        }
        carry_rest<S>(
            n, lost, [&](int i) { return rest_[size_t(block) * n + i]; },
            [&](int i) {
                Vec3<S> sum{S(0), S(0), S(0)};
                for (int lane = 0; lane < lanes; ++lane) {
                    Vec3f x{0, 0, 0};
                    for (int k = lane * width; k < (lane + 1) * width; ++k)
                        if (weight[k] != 0) x += weight[k] * moved_.at(from[k], i);
                    sum.x.set(lane, x.x), sum.y.set(lane, x.y), sum.z.set(lane, x.z);
                }
                return rotate(to_root_[size_t(block)], sum);
            },
            [&](int i, const Vec3<S>& x) {
                for (int lane = 0; lane < lanes; ++lane)
                    out.at(first + lane, i) = {x.x[lane], x.y[lane], x.z[lane]};
            });
    }
    if (!low_is_wet_) return;
#pragma omp parallel for schedule(static)
    for (int s = 0; s < low.count; ++s) {
        const int twin = around_.twin[size_t(s)], lane = twin % S::lanes;
        const Quat<S>& q = to_root_[size_t(twin / S::lanes)];
        const Quatf to_root{q.w[lane], q.x[lane], q.y[lane], q.z[lane]};
        for (int i = 0; i < n; ++i) {
            Vec3f x = rotate(to_head, low.at(s, i) - low.at(s, 0));
            if (!settled_.share.empty()) x = settled_.share[size_t(s)] * x + settled_.more.at(s, i);
            out.at(twin, i) = rotate(to_root, x);
        }
    }
}

void place_in_world(const RootFrames& roots, const Strands& offsets, const Pose& head, Strands& world) {
    if (world.count != offsets.count || world.particles != offsets.particles)
        world = Strands(offsets.count, offsets.particles);
#pragma omp parallel for schedule(static)
    for (int s = 0; s < offsets.count; ++s) {
        const Vec3f root = roots.root_at(s, head);
        const Quatf to_world = roots.rotation_at(s, head);
        const Vec3f* p = offsets.strand(s);
        Vec3f* out = world.strand(s);
        for (int i = 0; i < offsets.particles; ++i) out[i] = root + rotate(to_world, p[i]);
    }
}

}  // namespace wetcurl

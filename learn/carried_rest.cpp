// Rest shapes carried by the strands around them.
// Ours.
#include "learn/carried_rest.h"

#include <algorithm>
#include <string>

#include "base/error.h"

namespace wetcurl {

static Strands cores_of(const Strands& strands) {
    Strands cores(strands.count, strands.particles);
    const float beta = core_beta(strands.particles);
#pragma omp parallel for schedule(static)
    for (int s = 0; s < strands.count; ++s)
        core_of(strands.strand(s), strands.particles, beta, cores.strand(s));
    return cores;
}

RestCarrier::RestCarrier(const Stencil& stencil, const Groom& high, const Groom& low, const Strands* shape,
                         bool low_is_wet)
    : particles_(high.rest.particles),
      low_is_wet_(low_is_wet),
      low_rest_cores_(cores_of(low.rest)),
      moved_(low.rest.count, low.rest.particles) {
    auto size = [](const Strands& s) {
        return std::to_string(s.count) + " strands of " + std::to_string(s.particles) + " particles";
    };
    const Strands& curled = shape ? *shape : high.rest;
    if (size(curled) != size(high.rest))
        throw Error("interpolation: found a shape at rest of " + size(curled) + ", allowed that of all " +
                    size(high.rest));
    if (stencil.count() != high.rest.count)
        throw Error("interpolation: found a stencil for " + std::to_string(stencil.count()) +
                    " strands, allowed one for all " + std::to_string(high.rest.count));
    const Strands drawn_cores = cores_of(high.rest), curled_cores = cores_of(curled);
    const RootFrames roots = root_frames(high);
    const int n = particles_, blocks = (high.rest.count + S::lanes - 1) / S::lanes;
    const Vec3<S> none{S(0), S(0), S(0)};
    rest_.assign(size_t(blocks) * n, {none, S(1), none, none});
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
            const Vec3f *drawn = drawn_cores.strand(s), *core = curled_cores.strand(s), *p = curled.strand(s);
            for (int i = 0; i < n; ++i) {
                RestParticle<S>& out = rest_[size_t(block) * n + i];
                set(out.detail, lane, rotate(to_root, p[i] - core[i]));
                if (i + 1 == n) continue;
                const Vec3f edge = drawn[i + 1] - drawn[i], along = core[i + 1] - core[i];
                // Wet strands come as short as they are.
                const float length = low_is_wet ? 1 : norm(along) / std::max(norm(edge), tiny_length<float>);
                out.length.set(lane, length);
                set(out.edge, lane, rotate(to_root, length * edge));
                set(out.curled, lane, rotate(to_root, along));
            }
        }
}

RestParticle<float> RestCarrier::rest(int strand, int particle) const {
    const RestParticle<S>& p = rest_[size_t(strand / S::lanes) * particles_ + particle];
    const int lane = strand % S::lanes;
    auto of = [&](const Vec3<S>& v) { return Vec3f{v.x[lane], v.y[lane], v.z[lane]}; };
    return {of(p.edge), p.length[lane], of(p.curled), of(p.detail)};
}

void RestCarrier::apply(const Stencil& stencil, const Strands& low, const Pose& head, Strands& out) {
    const int n = low.particles, width = stencil.width;
    if (low.count != moved_.count || n != moved_.particles)
        throw Error("interpolation: found " + std::to_string(low.count) + " low-resolution strands of " +
                    std::to_string(n) + " particles, allowed " + std::to_string(moved_.count) + " of " +
                    std::to_string(moved_.particles));
    if (out.count != stencil.count() || out.particles != n) out = Strands(stencil.count(), n);
    const float beta = core_beta(n);
    const Quatf to_head = cast<float>(conjugate(head.rotation));
#pragma omp parallel for schedule(static)
    for (int s = 0; s < low.count; ++s) {
        Vec3f* moved = moved_.strand(s);
        const Vec3f* rest = low_rest_cores_.strand(s);
        core_of(low.strand(s), n, beta, moved);
        for (int i = n - 1; i >= 0; --i)
            moved[i] = rotate(to_head, moved[i] - moved[0]) - (rest[i] - rest[0]);
    }
#pragma omp parallel for schedule(static)
    for (int block = 0; block < int(to_root_.size()); ++block) {
        const int first = block * S::lanes, lanes = std::min(S::lanes, out.count - first);
        const int* from = stencil.from.data() + size_t(first) * width;
        const float* weight = stencil.weight.data() + size_t(first) * width;
        carry_rest<S>(
            n, [&](int i) { return rest_[size_t(block) * n + i]; },
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
        const int twin = stencil.twin[size_t(s)], lane = twin % S::lanes;
        const Quat<S>& q = to_root_[size_t(twin / S::lanes)];
        const Quatf to_root = Quatf{q.w[lane], q.x[lane], q.y[lane], q.z[lane]} * to_head;
        for (int i = 0; i < n; ++i) out.at(twin, i) = rotate(to_root, low.at(s, i) - low.at(s, 0));
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

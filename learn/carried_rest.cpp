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

RestCarrier::RestCarrier(const Stencil& stencil, const Groom& high, const Groom& low, const Strands* shape)
    : rest_(high.rest.points.size()),
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
    const int n = high.rest.particles;
#pragma omp parallel for schedule(static)
    for (int s = 0; s < high.rest.count; ++s) {
        const Quatf to_root = conjugate(roots.rotation[size_t(s)]);
        const Vec3f *drawn = drawn_cores.strand(s), *core = curled_cores.strand(s), *p = curled.strand(s);
        for (int i = 0; i < n; ++i) {
            RestParticle& out = rest_[size_t(s) * n + i];
            out = {{0, 0, 0}, 1, {0, 0, 0}, rotate(to_root, p[i] - core[i])};
            if (i + 1 == n) continue;
            const Vec3f edge = drawn[i + 1] - drawn[i], along = core[i + 1] - core[i];
            out.length = norm(along) / std::max(norm(edge), tiny_length<float>);
            out.edge = rotate(to_root, out.length * edge);
            out.curled = rotate(to_root, along);
        }
    }
}

void RestCarrier::apply(const Stencil& stencil, const RootFrames& roots, const Strands& low, const Pose& head,
                        Strands& out) {
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
    for (int s = 0; s < out.count; ++s) {
        const int* from = stencil.from.data() + size_t(s) * width;
        const float* weight = stencil.weight.data() + size_t(s) * width;
        const Quatf to_root = conjugate(roots.rotation[size_t(s)]);
        const RestParticle* rest = rest_.data() + size_t(s) * n;
        Vec3f* p = out.strand(s);
        carry_rest(
            n, [&](int i) { return rest[i]; },
            [&](int i) {
                Vec3f sum{0, 0, 0};
                for (int k = 0; k < width; ++k)
                    if (weight[k] != 0) sum += weight[k] * moved_.at(from[k], i);
                return rotate(to_root, sum);
            },
            [&](int i, const Vec3f& x) { p[i] = x; });
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

// Steps by the pass that the CPU takes: a thread a strand.
#include "base/device_buffer.h"
#include "cuda/chain/chain_kernel.h"

namespace wetcurl {

namespace {

constexpr int threads = 64;

// Numbers of a strand's workspace: the pass's own, then the nearest surfaces.
template <class T>
WETCURL_HD size_t workspace_of(int n, const SubstepRules<T>& rules, bool contact, T* workspace,
                               ChainScratch<T>& scratch, NearestView<T>& near) {
    const size_t taken = scratch.lay(n, rules.terms, rules.implicit, contact, workspace);
    if (!std::get<Slot<Adhesion>>(rules.terms)) return taken;
    if (workspace) {
        T* rest = workspace + taken;
        near.normal = reinterpret_cast<Vec3<T>*>(rest), near.velocity = near.normal + n;
        near.phi = rest + 6 * n;
    }
    return taken + 7 * size_t(n);
}

template <class V>
__device__ V* from(V* values, size_t first) {
    return values ? values + first : nullptr;
}

template <class T>
__global__ void __launch_bounds__(threads)
    run_substeps(const __grid_constant__ ChainLaunch<T> launch, size_t workspace_of_strand) {
    const int strand = int(blockIdx.x) * threads + int(threadIdx.x);
    const StrandMemory<T>& m = launch.memory;
    if (strand >= m.strands) return;
    const ChainConstants<T>& k = launch.constants;
    const int n = m.n;
    const size_t first = size_t(strand) * size_t(n);
    ChainScratch<T> scratch;
    NearestView<T> near{};
    workspace_of(n, k.rules, m.pushed != nullptr, launch.workspace + size_t(strand) * workspace_of_strand,
                 scratch, near);
    near.touching = from(m.touching, first);
    ChainView<T> view{};
    view.n = n;
    view.set_arrays(arrays_of(m, size_t(strand), m.n));
    view.given_adhesion = from(m.given_adhesion, first);
    if (m.given_adhesion)
        for (int i = 0; i < n; ++i) {
            const size_t at = first + size_t(i);
            near.phi[i] = m.given_phi[at], near.normal[i] = m.given_normal[at],
            near.velocity[i] = m.given_surface_velocity[at];
        }
    Vec3<T>*x = m.x + first, *x_before = m.x_before + first, *v = m.v + first, *v_before = m.v_before + first;
    int limited = 0;
    for (int substep = 0; substep < launch.substeps; ++substep) {
        const SubstepMotion<T>& motion = launch.motion[substep];
        const RootMotion<T>& of_root = launch.riding() ? motion.roots[strand] : motion.head;
        const Vec3<T>* in_frame = m.root + size_t(strand) * 2;
        const Vec3<T> root[2] = {of_root(in_frame[0]), of_root(in_frame[1])};
        view.set_root(of_root);
        BlockStep<T> step{.n = n,
                          .dt = k.dt,
                          .first = launch.is_first(substep),
                          .x = x,
                          .x_before = x_before,
                          .v = v,
                          .v_before = v_before,
                          .root = root,
                          .gravity = k.gravity,
                          .root_turn = of_root.turn,
                          .frame = from(m.frame, first),
                          .pushed = from(m.pushed, first),
                          .external = from(m.given_force, first),
                          .external_stiffness = from(m.given_stiffness, first),
                          .share = k.share,
                          .max_linearisations = k.max_linearisations,
                          .relinearise_angle = k.relinearise_angle};
        limited +=
            take_substep(k.rules, step, view, near, from(m.rest_depth, first),
                         SolidsInALoop<T, SubstepMotion<T>>{motion}, scratch, static_cast<NoMeter*>(nullptr));
        Vec3<T>*newer = x_before, *newer_v = v_before;
        x_before = x, v_before = v, x = newer, v = newer_v;
    }
    for (int i = 0; launch.substeps % 2 && i < n; ++i) {
        const Vec3<T> at = x[i], rate = v[i];
        x[i] = x_before[i], v[i] = v_before[i];
        x_before[i] = at, v_before[i] = rate;
    }
    if (limited) atomicAdd(launch.limited, static_cast<unsigned long long>(limited));
}

}  // namespace

template <class T>
size_t reference_workspace(int n, const SubstepRules<T>& rules, bool contact) {
    ChainScratch<T> scratch;
    NearestView<T> near;
    return workspace_of<T>(n, rules, contact, nullptr, scratch, near);
}

template <class T>
void launch_reference(const ChainLaunch<T>& launch, cudaStream_t stream) {
    const StrandMemory<T>& m = launch.memory;
    const size_t workspace = reference_workspace(m.n, launch.constants.rules, m.pushed != nullptr);
    run_substeps<<<unsigned((m.strands + threads - 1) / threads), threads, 0, stream>>>(launch, workspace);
    check_cuda(cudaGetLastError(), "launch of the substeps");
}

template size_t reference_workspace(int, const SubstepRules<float>&, bool);
template size_t reference_workspace(int, const SubstepRules<double>&, bool);
template void launch_reference(const ChainLaunch<float>&, cudaStream_t);
template void launch_reference(const ChainLaunch<double>&, cudaStream_t);

}  // namespace wetcurl

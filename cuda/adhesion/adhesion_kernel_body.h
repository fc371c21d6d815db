// A network of dense layers in Eq 11's place, particle by particle. Its inputs are
// those of solver/adhesion/adhesion_features.h; the reference is AdhesionNetworkCoupling.
#pragma once

#include "base/dense_layers.h"
#include "cuda/chain/strand_memory.h"
#include "solver/adhesion/adhesion_features.h"

namespace wetcurl {

// First all particles `see`, then all `ask`.
template <class T>
struct AdhesionKernelBody {
    AdhesionFeatures features;
    DenseView network;
    NearestView<T> near;  // (strand, particle), when the substep begins
    T* answer;            // F.n / (sigma m a_max)
    float* before;        // of the substep before

    // The surface nearest to particle k where all is at `motion`, of dry ones too: contact lets go of them.
    WETCURL_HD void see(uint32_t k, const StrandMemory<T>& m, const SubstepMotion<T>& motion) const {
        before[k] = float(answer[k]);
        T phi;
        Vec3<T> normal{T(0), T(1), T(0)}, velocity{T(0), T(0), T(0)};
        sample_nearest(motion, m.x[k], phi, normal, velocity);
        near.phi[k] = phi, near.normal[k] = normal, near.velocity[k] = velocity;
    }
    WETCURL_HD void ask(uint32_t k, const StrandMemory<T>& m) const {
        const int i = int(k % uint32_t(m.n));
        const bool counts = i > 0 && features.concerns(m.saturation[k], near.phi[k]);
        answer[k] = counts && features.in_contact(near.touching[k]) ? T(asked(k, i, m)) : T(0);
    }

  private:
    WETCURL_HD float asked(uint32_t k, int i, const StrandMemory<T>& m) const {
        const uint32_t root = k - uint32_t(i);
        float inputs[AdhesionFeatures::inputs];
        features.ask(
            i, m.n, near.normal[k], near.velocity[k],
            [&](int j) {
                const uint32_t at = root + uint32_t(j);
                return AdhesionParticle<T>{near.touching[at], near.phi[at], m.v[at], before[at]};
            },
            inputs);
        return network.evaluate(inputs);
    }
};

}  // namespace wetcurl

// Saturation patterns.
#include "solver/terms/wetness.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/run_cache.h"
#include "solver/terms/root_noise.h"

namespace wetcurl {

static double smooth_step(double a, double b, double x) {
    const double t = std::clamp((x - a) / (b - a), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

std::vector<float> saturation_of(const Wetness& w, const Groom& full, unsigned long long seed) {
    const Strands& rest = full.rest;
    std::vector<float> sigma(size_t(rest.count) * rest.particles);
    if (w.pattern == "file") {
        const RunReader run(w.file);
        if (run.header().saturation.size() != sigma.size())
            throw Error(w.file + ": its saturation is for " + std::to_string(run.header().saturation.size()) +
                        " particles, the groom has " + std::to_string(sigma.size()));
        return run.header().saturation;
    }
    constexpr double blend = 0.15;  // half the width of a pattern's edge, in strand lengths
    std::vector<double> strand_level(size_t(rest.count), w.level);
    if (w.jitter > 0)
        for_each_root(full, [&](int strand, double u, double v) {
            strand_level[size_t(strand)] *= 1 - w.jitter * root_noise(seed, 0, u, v);
        });
    for (int s = 0; s < rest.count; ++s)
        for (int i = 0; i < rest.particles; ++i) {
            const double along = double(i) / (rest.particles - 1);
            double full_at = 1;
            if (w.pattern == "tip") full_at = smooth_step(w.edge - blend, w.edge + blend, along);
            if (w.pattern == "root") full_at = 1 - smooth_step(w.edge - blend, w.edge + blend, along);
            if (w.pattern == "region") {
                const double d = norm(cast<double>(rest.at(s, i)) - w.region_center);
                full_at = 1 - smooth_step(0.8 * w.region_radius, w.region_radius, d);
            }
            sigma[size_t(s) * rest.particles + i] = float(strand_level[size_t(s)] * full_at);
        }
    return sigma;
}

}  // namespace wetcurl

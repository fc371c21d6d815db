// Cores of many strands, and the curl radius from core and detail.
#include "learn/codec/core_detail.h"

namespace wetcurl {

Strands cores_of(const Strands& strands) {
    Strands cores(strands.count, strands.particles);
    const float beta = core_beta(strands.particles);
#pragma omp parallel for schedule(static)
    for (int s = 0; s < strands.count; ++s)
        core_of(strands.strand(s), strands.particles, beta, cores.strand(s));
    return cores;
}

float square_apart(const Vec3f* a, const Vec3f* b, int n) {
    float sum = 0;
    for (int i = 0; i < n; ++i) {
        const Vec3f d = (a[i] - a[0]) - (b[i] - b[0]);
        sum += dot(d, d) / float(n);
    }
    return sum;
}

float curl_radius(const Vec3f* p, int n, float beta, Vec3f* core) {
    core_of(p, n, beta, core);
    Vec3d mean{0, 0, 0};
    double square = 0;
    for (int i = 0; i < n; ++i) {
        const Vec3d detail = cast<double>(p[i] - core[i]);
        mean += detail;
        square += dot(detail, detail);
    }
    mean = (1.0 / n) * mean;
    return float(std::sqrt(std::max(0.0, square / n - dot(mean, mean))));
}

std::vector<float> curl_radii(const Strands& strands) {
    const int n = strands.particles;
    const float beta = core_beta(n);
    std::vector<float> out(size_t(strands.count), 0);
#pragma omp parallel
    {
        std::vector<Vec3f> core(static_cast<size_t>(n));
#pragma omp for
        for (int s = 0; s < strands.count; ++s)
            out[size_t(s)] = curl_radius(strands.strand(s), n, beta, core.data());
    }
    return out;
}

}  // namespace wetcurl

// Wet strands that clump as a liquid does: SPH surface tension between particles of different strands.
// Kim 2016, on Akinci 2013, Eq 1-5: cohesion C and area minimisation.
// Differs: the normal n points out of the wet hair, so that area shrinks (the gradient of W as printed points
// inward, which with Eq 4's minus drives a pair apart); the area force takes the pair's harmonic mean mass,
// so that unequal particles too push each other alike; Eq 5's K_ij is left out, since strands have no rest
// density to compare with. Weighted by both saturations.
#pragma once

#include <memory>

#include "base/parameters.h"
#include "solver/compared/akinci2013.h"

namespace wetcurl {

struct Scene;
class PairForces;

struct Kim2016 {
    static constexpr const char *name = "kim", *part = "cohesion", *title = "Kim 2016", *table = "baseline";
    double gamma, gamma_area, h;
    static constexpr Parameter<Kim2016> parameters[] = {
        {"strength", &Kim2016::gamma, "N m^3/kg^2", 100, 0, 1e12,
         "kim: Akinci 2013, Eq 1, gamma: cohesion for each kg² of the pair"},
        {"area", &Kim2016::gamma_area, "m/s^2", 0.1, 0, 1e6,
         "kim: Akinci 2013, Eq 4, gamma: acceleration for each difference of normals"},
        {"radius", &Kim2016::h, "m", 0.012, 1e-4, 1, "kim: Akinci 2013, Eq 2, h: support of C and W"},
    };

    // What i itself and what j add to rho_i [kg/m^3].
    WETCURL_HD double own_density(double m) const { return m * kernel_at_zero(h); }
    WETCURL_HD double density_part(const Vec3d& d, double m) const { return m * kernel(norm(d), h); }
    // What j adds to the normal n_i [1], volume m_j / rho_j [m^3]. Eq 3 with its sign turned.
    WETCURL_HD Vec3d normal_part(const Vec3d& d, double volume) const {
        return (-h * volume) * kernel_gradient(d, h);
    }
    // On i by j: d = x_i - x_j [m], n = n_i - n_j, masses [kg], `wet` = sigma_i sigma_j.
    WETCURL_HD Vec3d pair_force(const Vec3d& d, const Vec3d& n, double m_i, double m_j, double wet) const {
        const Vec3d cohesion =
            (-gamma * m_i * m_j * akinci2013::cohesion_kernel(norm(d), h)) * akinci2013::direction(d);
        return wet * (cohesion - (gamma_area * 2 * m_i * m_j / (m_i + m_j)) * n);
    }
    std::unique_ptr<PairForces> forces(const Scene& scene) const;
};

}  // namespace wetcurl

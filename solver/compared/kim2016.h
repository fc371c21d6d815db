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
    static constexpr When named{"cohesion|method", "kim"};
    double gamma, gamma_area, h;
    static constexpr Parameter<Kim2016> parameters[] = {
        {KeyRow::number("strength", "N m^3/kg^2", 100, 0, 1e12, "Cohesion for each kg^2 of a pair.",
                        "Akinci 2013, Eq 1, gamma", named),
         &Kim2016::gamma},
        {KeyRow::number("area", "m/s^2", 0.1, 0, 1e6, "Acceleration for each difference of normals.",
                        "Akinci 2013, Eq 4, gamma", named),
         &Kim2016::gamma_area},
        {KeyRow::number("radius", "m", 0.012, 1e-4, 1, "Support of the kernels C and W.",
                        "Akinci 2013, Eq 2, h", named),
         &Kim2016::h},
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

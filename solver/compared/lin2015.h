// Wet strands that stick to each other as boundary particles of SPH do.
// Lin 2015 (and 2014): adhesion of Akinci 2013, Eq 6, between particles of different strands, each the
// other's boundary. Differs: a particle stands for its own mass, water included, where Akinci takes the
// volume that it leaves free in the fluid: there is no fluid here, and the forces of a pair then sum to zero.
// Weighted by both saturations, so that dry hair takes no part.
#pragma once

#include <memory>

#include "base/parameters.h"
#include "solver/compared/akinci2013.h"

namespace wetcurl {

struct Scene;
class PairForces;

struct Lin2015 {
    static constexpr const char *name = "lin", *part = "cohesion", *title = "Lin 2015", *table = "baseline";
    static constexpr When named{"cohesion|method", "lin"};
    double beta, h;
    static constexpr Parameter<Lin2015> parameters[] = {
        {KeyRow::number("strength", "N m^3/kg^2", 3e3, 0, 1e12, "Force for each kg^2 of a pair.",
                        "Akinci 2013, Eq 6, beta", named),
         &Lin2015::beta},
        {KeyRow::number("radius", "m", 0.012, 1e-4, 1, "Support of the kernel A.", "Akinci 2013, Eq 7, h",
                        named),
         &Lin2015::h},
    };

    // On i by j: d = x_i - x_j [m], masses [kg], `wet` = sigma_i sigma_j.
    WETCURL_HD Vec3d pair_force(const Vec3d& d, double m_i, double m_j, double wet) const {
        return -beta * wet * m_i * m_j * akinci2013::adhesion_kernel(norm(d), h) * akinci2013::direction(d);
    }
    std::unique_ptr<PairForces> forces(const Scene& scene) const;
};

}  // namespace wetcurl

// Adhesion to solids that are sampled with boundary particles, in the level set's place.
// Akinci 2013, Eq 6; volumes of boundary particles: Akinci 2012, Eq 4. The paper, Sec. VI.C and Fig 41.
// Contact stays with the solid's shape: the particles bring adhesion alone. Differs: no contact flag, as in
// SPH: all wet hair within the shell h/2 < r <= h of a boundary particle is drawn to it.
#pragma once

#include <memory>

#include "base/geometry/shapes.h"
#include "base/parameters.h"
#include "solver/compared/akinci2013.h"

namespace wetcurl {

struct Scene;
class PairForces;

struct BoundaryParticles2013 {
    static constexpr const char *name = "boundary_particles", *part = "boundary",
                                *title = "boundary particles of Akinci 2013", *table = "baseline";
    static constexpr When named{"boundary|method", "particles|boundary_particles"};
    static constexpr double water_density = 1000;  // rho_0 [kg/m^3]
    double beta, h, spacing;
    static constexpr Parameter<BoundaryParticles2013> parameters[] = {
        {KeyRow::number("boundary_strength", "N m^3/kg^2", 10, 0, 1e12,
                        "Force for each kg of hair and kg of boundary.", "Akinci 2013, Eq 6, beta", named),
         &BoundaryParticles2013::beta},
        {KeyRow::number("boundary_range", "m", 0.01, 1e-4, 1, "Support of the kernel A.",
                        "Akinci 2013, Eq 7, h", named),
         &BoundaryParticles2013::h},
        {KeyRow::number("boundary_spacing", "m", 0.004, 1e-4, 1,
                        "Distance between neighbouring particles on the surface.", "ours", named),
         &BoundaryParticles2013::spacing},
    };

    // On a particle of mass m [kg] by a boundary particle of volume V [m^3], d away from it [m].
    WETCURL_HD Vec3d pair_force(const Vec3d& d, double m, double volume) const {
        return -strength(m, volume) * akinci2013::adhesion_kernel(norm(d), h) * akinci2013::direction(d);
    }
    // Whether a boundary particle d away is in reach [m].
    WETCURL_HD bool reaches(const Vec3d& d) const { return dot(d, d) < h * h; }
    // Of the pair [N m^3].
    WETCURL_HD double strength(double m, double volume) const { return beta * m * water_density * volume; }
    std::unique_ptr<PairForces> forces(const Scene& scene) const;
};

// Points on a surface, none nearer to another than 0.7 `spacing` [m], in body coordinates. A plane is sampled
// as the metre of it that is drawn. Throws Error where they would be more than ten million.
std::vector<Vec3f> sampled_surface(const Shape& shape, double spacing);

// V_k = 1 / sum_l W_kl [m^3]: what each of `points` stands for, l = k included.
std::vector<double> boundary_volumes(const std::vector<Vec3f>& points, double h);

}  // namespace wetcurl

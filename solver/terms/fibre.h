// A hair as an elastic fibre: what the springs and masses of a strand are, at any number of particles.
// Rods: EA / l, EI / l³, GJ / l of a segment (Bergou 2008). Hair: Robbins, Chemical and Physical Behavior of
// Human Hair (5th ed.), ch. 8 and 9: E 3.89 GPa, G 0.89 GPa, 1320 kg/m³, swelling in water 14 % across. The
// paper gives springs to segments instead, so that more particles make its hair softer.
#pragma once

#include <vector>

#include "base/parameters.h"
#include "base/vec3.h"

namespace wetcurl {

struct Fibre {
    static constexpr const char *name = "fibre", *table = "fibre",
                                *about =
                                    "Hair as a fibre of a diameter and a substance: the springs, dampers and "
                                    "masses of segments follow, whatever their number.";
    double diameter = 70e-6, ellipticity = 1.4, youngs_modulus = 3.89e9, shear_modulus = 0.89e9,
           density = 1320, damping = 1e-4, strain = 0.002, wet_youngs_modulus = 1.6e9,
           wet_shear_modulus = 0.2e9, swelling = 0.14;
    static constexpr Parameter<Fibre> parameters[] = {
        {KeyRow::number("diameter", "m", 70e-6, 1e-6, 0.01, "Of the circle that has the fibre's area."),
         &Fibre::diameter},
        {KeyRow::number("ellipticity", "1", 1.4, 1, 10, "Major by minor axis of its section."),
         &Fibre::ellipticity},
        {KeyRow::number("youngs_modulus", "Pa", 3.89e9, 1e3, 1e13, "Of dry hair: stretch and bend.",
                        "Robbins"),
         &Fibre::youngs_modulus},
        {KeyRow::number("shear_modulus", "Pa", 0.89e9, 0, 1e13, "Of dry hair: twist.", "Robbins"),
         &Fibre::shear_modulus},
        {KeyRow::number("density", "kg/m^3", 1320, 1, 1e5, "Of dry hair.", "Robbins"), &Fibre::density},
        {KeyRow::number("damping", "s", 1e-4, 0, 10,
                        "Time for which a spring's rate of strain resists as its strain does."),
         &Fibre::damping},
        {KeyRow::number("strain", "1", 0.002, 0, 1,
                        "Stretch under ten times a strand's weight down to which its spring is softened, for "
                        "the sake of single precision; 0: not softened."),
         &Fibre::strain},
        {KeyRow::number("wet_youngs_modulus", "Pa", 1.6e9, 1e3, 1e13,
                        "At saturation 1; the default is an estimate, 0.4 of the dry one."),
         &Fibre::wet_youngs_modulus},
        {KeyRow::number(
             "wet_shear_modulus", "Pa", 0.2e9, 0, 1e13,
             "At saturation 1; the default is an estimate: water softens twist more than stretch."),
         &Fibre::wet_shear_modulus},
        {KeyRow::number("swelling", "1", 0.14, 0, 2, "By how much saturation 1 widens the diameter.",
                        "Robbins"),
         &Fibre::swelling},
    };

    double area() const;                // [m²]
    double linear_density() const;      // [kg/m]
    double flexural_rigidity() const;   // EI [N m²], of bends all round: the harmonic mean of both axes'
    double torsional_rigidity() const;  // GJ [N m²]

    // Springs of a strand's edges (n-1), and of the joints before them, from edge 1 on.
    struct Springs {
        std::vector<double> stretch, bend;  // [N/m]
        std::vector<double> twist;          // [N m]
        bool empty() const { return stretch.empty(); }
    };
    // Of a dry strand, by the rest lengths of its edges [m]. Its root is clamped at particle 0: what edge 0
    // would bend and twist counts at its joint with edge 1.
    Springs springs(const std::vector<double>& rest_length) const;

    // By how much a saturation changes each kind of spring.
    struct WetShares {
        double stretch, bend, twist;
    };
    WETCURL_HD WetShares wet_shares(double saturation) const {
        const auto mixed = [&](double dry, double wet) {
            return dry > 0 ? 1 + saturation * (wet / dry - 1) : 1.0;
        };
        const double across = 1 + saturation * swelling, area = across * across,
                     e = mixed(youngs_modulus, wet_youngs_modulus),
                     g = mixed(shear_modulus, wet_shear_modulus);
        return {e * area, e * area * area, g * area * area};
    }
    // The same strand's at the saturation (n) of its particles; null: dry.
    Springs soaked(const Springs& dry, const float* saturation) const;
};

// A spring of element i: the strand's own, or `all` where it has none.
template <class S>
WETCURL_HD S spring_of(const S* own, int i, double all) {
    return own ? own[i] : S(all);
}
template <class S>
WETCURL_HD const S* own_of(const S* own, int i) {
    return own ? own + i : nullptr;
}

}  // namespace wetcurl

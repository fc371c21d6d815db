// A hair as an elastic fibre: what the springs and masses of a strand are, at any number of particles.
// Rods: EA / l, EI / l³, GJ / l of a segment (Bergou 2008). Hair: Robbins, Chemical and Physical Behavior of
// Human Hair (5th ed. 2012), Table 9.5, in a room's air: E 3.89 GPa, G 0.89 GPa; 1320 kg/m³. The paper gives
// springs to segments instead, so that more particles make its hair softer.
#pragma once

#include <string>
#include <vector>

#include "base/parameters.h"
#include "base/strands.h"
#include "base/vec3.h"
#include "solver/terms/hair_kinds.h"

namespace wetcurl {

// By how much saturation 1 changes the moduli and the diameter of a fibre, as shares of them.
struct WetSprings {
    double youngs_modulus, shear_modulus, diameter;
    // By how much a saturation multiplies each kind of spring.
    struct Factors {
        double stretch, bend, twist;
    };
    WETCURL_HD Factors at(double saturation) const {
        const double across = 1 + saturation * diameter, area = across * across,
                     e = 1 + saturation * youngs_modulus, g = 1 + saturation * shear_modulus;
        return {e * area, e * area * area, g * area * area};
    }
};

struct Fibre {
    static constexpr const char *name = "fibre", *table = "fibre",
                                *about =
                                    "Hair as a fibre of a diameter and a substance: the springs, dampers and "
                                    "masses of segments follow, whatever their number.";
    double diameter = 70e-6, ellipticity = 1.4, youngs_modulus = dry_youngs_modulus,
           shear_modulus = dry_shear_modulus, density = 1320, damping = 1e-4, strain = 0.002,
           wet_youngs_modulus = 1.5e9, wet_shear_modulus = 0.2e9, swelling = 0.065, spread = 0;
    std::vector<double> profile;
    std::string hair;  // one of hair_names, or ""
    static constexpr Parameter<Fibre> parameters[] = {
        {KeyRow::number("diameter", "m", 70e-6, 1e-6, 0.01, "Of the circle that has the fibre's area."),
         &Fibre::diameter},
        {KeyRow::number("ellipticity", "1", 1.4, 1, 10, "Major by minor axis of its section."),
         &Fibre::ellipticity},
        {KeyRow::number("youngs_modulus", "Pa", dry_youngs_modulus, 1e3, 1e13,
                        "Of dry hair: stretch and bend.", "Robbins"),
         &Fibre::youngs_modulus},
        {KeyRow::number("shear_modulus", "Pa", dry_shear_modulus, 0, 1e13, "Of dry hair: twist.", "Robbins"),
         &Fibre::shear_modulus},
        {KeyRow::number("density", "kg/m^3", 1320, 1, 1e5, "Of dry hair.", "Robbins"), &Fibre::density},
        {KeyRow::number("damping", "s", 1e-4, 0, 10,
                        "Time for which a spring's rate of strain resists as its strain does."),
         &Fibre::damping},
        {KeyRow::number("strain", "1", 0.002, 0, 1,
                        "Stretch under ten times a strand's weight down to which its spring is softened, for "
                        "the sake of single precision; 0: not softened."),
         &Fibre::strain},
        {KeyRow::number("wet_youngs_modulus", "Pa", 1.5e9, 1e3, 1e13, "At saturation 1.",
                        "dry over wet 2 to 3, Evans 2021; 2.75, Menkart 1966"),
         &Fibre::wet_youngs_modulus},
        {KeyRow::number("wet_shear_modulus", "Pa", 0.2e9, 0, 1e13,
                        "At saturation 1; the default is an estimate: water softens twist more than stretch, "
                        "as it softens "
                        "the matrix between cylinders that it leaves alone (Feughelman 1959)."),
         &Fibre::wet_shear_modulus},
        {KeyRow::number("swelling", "1", 0.065, 0, 2,
                        "By how much saturation 1 widens the diameter, from that in a room's air.",
                        "from 60 % humidity on, Stam 1952; 14 % from bone dry on"),
         &Fibre::swelling},
        {KeyRow::number("spread", "1", 0, 0, 0.3,
                        "Standard deviation of the diameter from strand to strand, as a share of it."),
         &Fibre::spread},
        {KeyRow::list_of_numbers(
             "profile", "1", 0.05, 20,
             "Diameter at equal distances from root to tip, as a share of the strand's own; "
             "straight lines between them."),
         &Fibre::profile},
        {KeyRow::one_of(
             "hair", hair_names, "",
             "Kind of hair, whose numbers hold for the keys of [fibre] and for [groom] curl_radius and "
             "pitch that the scene does not write; `wetcurl inspect hair` lists them.")
             .without_default("none"),
         &Fibre::hair},
    };

    // Of the diameter as it is written.
    double area() const;                // [m²]
    double linear_density() const;      // [kg/m]
    double flexural_rigidity() const;   // EI [N m²], of bends all round: the harmonic mean of both axes'
    double torsional_rigidity() const;  // GJ [N m²]

    // The diameter of each strand of a groom as a share of that: by the seed and the place of the root. Empty
    // where all are 1.
    std::vector<double> thickness(const Groom& full, unsigned long long seed) const;

    // Springs of a strand's edges (n-1), and of the joints before them, from edge 1 on.
    struct Springs {
        std::vector<double> stretch, bend;  // [N/m]
        std::vector<double> twist;          // [N m]
        bool empty() const { return stretch.empty(); }
    };
    // Of a dry strand of a thickness, by the rest lengths of its edges [m]. Its root is clamped at particle
    // 0: what edge 0 would bend and twist counts at its joint with edge 1.
    Springs springs(const std::vector<double>& rest_length, double thickness = 1) const;
    // [kg] of its particles (n): half of each edge to either end.
    std::vector<double> masses(const std::vector<double>& rest_length, double thickness = 1) const;

    WetSprings wet_springs() const {
        const auto change = [](double dry, double wet) { return dry > 0 ? wet / dry - 1 : 0; };
        return {change(youngs_modulus, wet_youngs_modulus), change(shear_modulus, wet_shear_modulus),
                swelling};
    }
    // The same strand's at the saturation (n) of its particles; null: dry.
    Springs soaked(const Springs& dry, const float* saturation) const;

    // Of the diameter, by the profile, at a share of the length from the root.
    double profile_at(double along) const;
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

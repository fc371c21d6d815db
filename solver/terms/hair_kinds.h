// Kinds of hair by name: the numbers of [fibre], and the curl of the built-in groom, that a scene gets by
// `[fibre] hair`. Diameters are measured. Curls of the types 1 to 4c are chosen: those types were never
// measured; people tell them by the thing that fits a curl, and Nagase 2008 measured how strongly hair is
// curved.
#pragma once

#include <string_view>
#include <vector>

namespace wetcurl {

struct HairKind {
    const char *name, *about;
    double diameter, ellipticity, youngs_modulus, shear_modulus;  // [m], [1], [Pa], [Pa]
    double curl_radius, pitch;                                    // [m]; radius 0: straight
    const char *of_fibre, *of_curl;                               // where they come from

    struct Value {
        const char* key;
        double value;
    };
    std::vector<Value> fibre() const {
        return {{"diameter", diameter},
                {"ellipticity", ellipticity},
                {"youngs_modulus", youngs_modulus},
                {"shear_modulus", shear_modulus}};
    }
    std::vector<Value> groom() const { return {{"curl_radius", curl_radius}, {"pitch", pitch}}; }
};

namespace hair_sources {
// Table 3 of ch. 6: areas of the section 5063, 4079 and 4210 µm².
inline constexpr const char* east_asian = "Evans and Wickett 2012, ch. 6: East Asian hair";
inline constexpr const char* european = "Evans and Wickett 2012, ch. 6: European hair";
inline constexpr const char* african = "Evans and Wickett 2012, ch. 6: African American hair";
inline constexpr const char* curved = "chosen, curvature within Nagase 2008";
inline constexpr const char* scale = "chosen, by the common scale of things that fit a curl";
inline constexpr const char* coils = "chosen; coils of wigs have radii of 5 mm and less, Shi 2023";
}  // namespace hair_sources

inline constexpr double dry_youngs_modulus = 3.89e9, dry_shear_modulus = 0.89e9;  // Robbins 2012, Table 9.5

inline constexpr HairKind hair_kinds[] = {
    {"type1", "straight", 80e-6, 1.29, dry_youngs_modulus, dry_shear_modulus, 0, 0.1,
     hair_sources::east_asian, "straight"},
    {"type2a", "loose waves", 72e-6, 1.41, dry_youngs_modulus, dry_shear_modulus, 0.0046, 0.08,
     hair_sources::european, hair_sources::curved},
    {"type2b", "waves", 72e-6, 1.41, dry_youngs_modulus, dry_shear_modulus, 0.0044, 0.06,
     hair_sources::european, hair_sources::curved},
    {"type2c", "strong waves", 72e-6, 1.41, dry_youngs_modulus, dry_shear_modulus, 0.0053, 0.045,
     hair_sources::european, hair_sources::curved},
    {"type3a", "loose curls, as round as sidewalk chalk", 72e-6, 1.41, dry_youngs_modulus, dry_shear_modulus,
     0.011, 0.035, hair_sources::european, hair_sources::scale},
    {"type3b", "curls, as round as a marker", 72e-6, 1.41, dry_youngs_modulus, dry_shear_modulus, 0.0065,
     0.022, hair_sources::european, hair_sources::scale},
    {"type3c", "tight curls, as round as a pencil", 73e-6, 1.66, dry_youngs_modulus, dry_shear_modulus,
     0.0036, 0.014, hair_sources::african, hair_sources::scale},
    {"type4a", "coils", 73e-6, 1.66, dry_youngs_modulus, dry_shear_modulus, 0.0025, 0.009,
     hair_sources::african, hair_sources::coils},
    {"type4b", "tight coils", 73e-6, 1.66, dry_youngs_modulus, dry_shear_modulus, 0.002, 0.006,
     hair_sources::african, hair_sources::coils},
    {"type4c", "the tightest coils", 73e-6, 1.66, dry_youngs_modulus, dry_shear_modulus, 0.0015, 0.004,
     hair_sources::african, hair_sources::coils},
    {"child", "of a child of five years: fine, nearly round", 60e-6, 1.2, dry_youngs_modulus,
     dry_shear_modulus, 0.0046, 0.08, "Flagler 2012, Table 3; moduli as of adults, Bogaty 1969",
     hair_sources::curved},
    {"horse", "of a tail", 180e-6, 1.1, 3.8e9, dry_shear_modulus, 0, 0.1,
     "80 to 280 um across, 2.6 to 4.9 GPa; the middle of both", "straight"},
};

inline constexpr const char* hair_names[] = {"type1",  "type2a", "type2b", "type2c", "type3a", "type3b",
                                             "type3c", "type4a", "type4b", "type4c", "child",  "horse"};
static_assert(std::size(hair_names) == std::size(hair_kinds));

// Null where `name` is none of them.
constexpr const HairKind* hair_named(std::string_view name) {
    for (const HairKind& kind : hair_kinds)
        if (name == kind.name) return &kind;
    return nullptr;
}
static_assert([] {
    for (const char* name : hair_names)
        if (!hair_named(name)) return false;
    return true;
}());

}  // namespace wetcurl

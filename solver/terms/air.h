// [air]: the box of air around the head, its wind and its sources. What they do is in solver/air/air_field.h.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/parameters.h"
#include "base/vec3.h"

namespace wetcurl {

// A ball in which the air is blown at a velocity.
struct AirSource {
    static constexpr const char* table = "air.source";
    double radius, period;
    Vec3d center{0, 0, 0}, velocity{0, 0, 1};  // [m], [m/s]
    static constexpr Parameter<AirSource> parameters[] = {
        {"radius", &AirSource::radius, "m", 0.08, 1e-4, 100,
         "of the ball; it blows less towards its surface"},
        {"period", &AirSource::period, "s", 0, 0, 1e4, "of gusts from none to full and back; 0: steady"},
    };
    // Share of `velocity` with which it blows at `time` [s], in [0, 1].
    double gust(double time) const {
        return period > 0 ? (1 - std::cos(2 * std::numbers::pi * time / period)) / 2 : 1;
    }
};

// What a scene says of its air. Outside the box it moves as `wind`.
struct Air {
    static constexpr const char *name = "air", *table = "air";
    double size, viscosity, density;
    std::array<int, 3> grid{64, 64, 64};   // cells, cubes, each way
    Vec3d center{0, 0, 0}, wind{0, 0, 0};  // [m], [m/s]
    bool two_way = false;                  // hair brakes the air
    std::vector<AirSource> sources;
    static constexpr Parameter<Air> parameters[] = {
        {"size", &Air::size, "m", 0.8, 1e-3, 1000, "the longest side of the box"},
        {"viscosity", &Air::viscosity, "m^2/s", 1.5e-5, 0, 10, "kinematic, nu of Stam 1999 (air at 20 C)"},
        {"density", &Air::density, "kg/m^3", 1.2, 1e-3, 1e4, "of the air that two_way brakes"},
    };
};

}  // namespace wetcurl

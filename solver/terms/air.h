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
    static constexpr const char *table = "air.source", *about = "A ball in which the air is blown.";
    double radius, period;
    Vec3d center{0, 0, 0}, velocity{0, 0, 1};  // [m], [m/s]
    static constexpr Parameter<AirSource> parameters[] = {
        {KeyRow::number("radius", "m", 0.08, 1e-4, 100,
                        "Radius of the ball; the wind is weaker toward its surface."),
         &AirSource::radius},
        {KeyRow::number("period", "s", 0, 0, 1e4, "Period of gusts from none to full and back; 0: steady."),
         &AirSource::period},
        {KeyRow::numbers("center", "m", {0, 0, 0}, -1000, 1000, "Centre of the ball."), &AirSource::center},
        {KeyRow::numbers("velocity", "m/s", {0, 0, 1}, -1000, 1000, "Velocity of the air that it blows."),
         &AirSource::velocity},
    };
    // Share of `velocity` with which it blows at `time` [s], in [0, 1].
    double gust(double time) const {
        return period > 0 ? (1 - std::cos(2 * std::numbers::pi * time / period)) / 2 : 1;
    }
};

// What a scene says of its air. Outside the box it moves as `wind`.
struct Air {
    static constexpr const char *name = "air", *table = "air",
                                *about = "A box of moving air, and its drag on the hair.";
    double size, viscosity, density;
    std::array<int, 3> grid{64, 64, 64};   // cells, cubes, each way
    Vec3d center{0, 0, 0}, wind{0, 0, 0};  // [m], [m/s]
    bool two_way = false;                  // hair brakes the air
    std::vector<AirSource> sources;
    static constexpr Parameter<Air> parameters[] = {
        {KeyRow::number("size", "m", 0.8, 1e-3, 1000, "Longest side of the box."), &Air::size},
        {KeyRow::number("viscosity", "m^2/s", 1.5e-5, 0, 10,
                        "Kinematic viscosity; the default is air at 20 C.", "Stam 1999, nu"),
         &Air::viscosity},
        {KeyRow::number("density", "kg/m^3", 1.2, 1e-3, 1e4, "Density of the air that two_way brakes."),
         &Air::density},
        {KeyRow::integers("grid", {64, 64, 64}, 8, 512, "Cells of the box each way; they are cubes."),
         &Air::grid},
        {KeyRow::numbers("center", "m", {0, 0, 0}, -1000, 1000, "Centre of the box."), &Air::center},
        {KeyRow::numbers("wind", "m/s", {0, 0, 0}, -1000, 1000,
                         "Velocity of the air at the start and outside the box."),
         &Air::wind},
        {KeyRow::boolean("two_way", false, "Hair brakes the air."), &Air::two_way},
    };
};

}  // namespace wetcurl

// Water that lives: it runs along the strand, passes to strands in contact, drips, dries, and is taken up
// from sources. The paper's title speaks of porous flow and prints no equation; this one is ours: unsaturated
// flow (Richards 1931) along a line, with the cubic mobility of films (Nusselt 1916) and of Irmay 1954. That
// wet hair hands on water, drips and dries is after Rungjiratananon 2012.
//
// A strand holds the water mu m_absorbed sigma on each length, mu its dry mass a length. Along it runs
//   Q = mu m_absorbed K sigma³ (t.g / |g_0| - H d sigma / ds)    [kg/s], toward the tip,
// K the conductivity, H the suction, t the tangent, g_0 = 9.81 m/s². At rest sigma rises downward by 1/H.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "base/geometry/kernels.h"
#include "base/geometry/shapes.h"
#include "base/parameters.h"
#include "solver/motion/motion.h"

namespace wetcurl {

// A body of water over a step of time, as any device asks it.
struct FlowingSource {
    ShapeView shape;
    Pose pose;  // of its motion
    Vec3d center;
    double taken;  // share of what hair still has room for; 0: it does not flow
    // x [m] in the world.
    WETCURL_HD bool holds(const Vec3d& x) const { return distance(shape, pose.inverse(x) - center).phi < 0; }
    WETCURL_HD double wetted(double sigma) const { return minimum(1.0, sigma + taken * (1 - sigma)); }
};

// A body of water, or a ball of spray: hair inside its surface takes up water, sigma' = rate (1 - sigma).
struct WaterSource {
    static constexpr const char *table = "wetness.source",
                                *about = "A body of water, or a ball of spray, which wets the hair in it.";
    static constexpr const char* shapes[] = {"plane", "sphere"};
    double rate, from, until;
    std::string kind = "plane";  // one of the shapes
    double radius = 0.1;         // of the sphere [m]
    Shape shape;                 // of that kind and radius; a plane wets what lies below it
    Vec3d center{0, 0, 0};       // of the shape where its motion begins [m]
    Motion motion;
    static constexpr Parameter<WaterSource> parameters[] = {
        {KeyRow::number("rate", "1/s", 5, 0, 1e6, "Rate at which dry hair inside takes up water.", "ours"),
         &WaterSource::rate},
        {KeyRow::number("from", "s", 0, 0, 1e6, "Time at which it begins to wet."), &WaterSource::from},
        {KeyRow::number("until", "s", 1e6, 0, 1e6, "Time at which it ends; later than from."),
         &WaterSource::until},
        {KeyRow::one_of("shape", shapes, "plane", "A plane, which wets what lies below it, or a sphere."),
         &WaterSource::kind},
        {KeyRow::number("radius", "m", 0.1, 1e-4, 100, "Radius of the sphere.", "", {"shape", "sphere"}),
         &WaterSource::radius},
        {KeyRow::numbers("center", "m", {0, 0, 0}, -1000, 1000,
                         "Centre of the sphere or a point of the plane, before the motion."),
         &WaterSource::center},
    };
    // For dt [s] from `time` on; a level set is the host's.
    FlowingSource over(double time, double dt) const {
        const bool flows = time >= from && time < until;
        return {view_of(shape), motion.at(time), center, flows ? -std::expm1(-rate * dt) : 0};
    }
};

// The rules of it, on any device. Masses of water here are those of dry hair that holds as much when full:
// the water's own is m_absorbed times it.
struct FlowRules {
    double K, H, dripping, drying, exchange, reach;

    // g / |g_0|.
    static Vec3d down(const Vec3d& gravity) { return (1 / 9.81) * gravity; }
    // What runs over an edge [kg/s] for each unit of saturation at its upper end, and back for each at its
    // lower end, with the mobilities of the saturations `a` and `b` at those ends: linear, and never
    // negative.
    struct Rates {
        double down, up;
    };
    // `fall`: t.g / |g_0| of the edge; `length` of it [m]; `density`: mu [kg/m].
    WETCURL_HD Rates edge_rates(double a, double b, double fall, double length, double density) const {
        const bool rises = fall < 0;
        const double upper = rises ? b : a, lower = rises ? a : b, drop = rises ? -fall : fall;
        const double spread = H / length * 0.5 * (upper * upper * upper + lower * lower * lower);
        // The falling part takes the mean of both ends where suction is strong enough to keep `up` positive,
        // so that the profile at rest is met exactly, and the upper end elsewhere.
        const double half = 0.5 * drop * lower * lower;
        const double central = spread > half ? 1 : half > 0 ? spread / half : 0;
        const double scale = density * K;
        const double onward = scale * (spread + drop * upper * upper * (1 - 0.5 * central)),
                     against = scale * (spread - half * central);
        return rises ? Rates{against, onward} : Rates{onward, against};
    }
    // From the tip [kg/s] for each unit of its saturation, taken as `a`.
    WETCURL_HD double tip_rate(double a, double fall, double density) const {
        return fall > 0 ? dripping * density * K * fall * a * a : 0;
    }
    // Substeps of dt [s] in which a front passes no more than half of the shortest cell [m], so that lagged
    // mobilities overfill nothing. More than `most` would only sharpen fronts: the solve is stable at any.
    WETCURL_HD int substeps(double dt, double shortest) const {
        constexpr double most = 64;
        const double cells = 2 * K * dt * (1 + H / shortest) / shortest;
        return cells < most ? maximum(1, int(std::ceil(cells))) : int(most);
    }
    // Water that passes between two particles r [m] apart within dt for each unit that their saturations
    // differ by, exact for the two alone; m: their dry masses [kg].
    WETCURL_HD double passed(double m_a, double m_b, double r, double dt) const {
        const double shared = m_a * m_b / (m_a + m_b);
        return -std::expm1(-exchange * dt * kernel_shape(r, reach)) * shared;
    }
    // Share of the water that dries away within dt.
    WETCURL_HD double dried(double dt) const { return -std::expm1(-drying * dt); }
};

struct Flow : FlowRules {
    static constexpr const char *name = "flow", *table = "wetness.flow",
                                *about =
                                    "Water which runs along strands, passes between them, drips and dries.";
    std::vector<WaterSource> sources;
    static constexpr Parameter<FlowRules> parameters[] = {
        {KeyRow::number(
             "conductivity", "m/s", 3e-3, 0, 1,
             "Speed at which a saturated strand drains: rho g d^2 / (3 mu) of a film of d = 30 um.",
             "K, Nusselt 1916"),
         &FlowRules::K},
        {KeyRow::number(
             "suction", "m", 0.05, 0, 10,
             "Height that dry hair draws water to: 2 gamma / (rho g r) with r = 0.3 mm between hairs.",
             "H, Jurin 1718"),
         &FlowRules::H},
        {KeyRow::number("dripping", "1", 1, 0, 1,
                        "Share of the water which reaches the tip that falls off it; 1: free drainage."),
         &FlowRules::dripping},
        {KeyRow::number("drying", "1/s", 2e-3, 0, 1e3, "Rate at which saturation dries away.", "ours"),
         &FlowRules::drying},
        {KeyRow::number("exchange", "1/s", 2, 0, 1e4,
                        "Rate at which the saturations of two particles that touch become equal.",
                        "ours, after Rungjiratananon 2012"),
         &FlowRules::exchange},
        {KeyRow::number("reach", "m", 0.002, 1e-5, 1, "Distance at which strands no longer touch."),
         &FlowRules::reach},
    };
};

}  // namespace wetcurl

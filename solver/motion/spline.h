// Monotone cubic Hermite splines between keyframes: C1, and no overshoot beyond the keys.
// Fritsch and Carlson 1980; the slope is Fritsch and Butland's harmonic mean.
#pragma once

namespace wetcurl {

// At a key between intervals of lengths h0 and h1 along which the value rises by d0 and d1 a unit.
inline double monotone_slope(double h0, double d0, double h1, double d1) {
    return d0 * d1 > 0 ? 3 * (h0 + h1) / ((2 * h1 + h0) / d0 + (h1 + 2 * h0) / d1) : 0;
}

// Weights of the values and slopes at both ends of an interval of length h, at the share s of it.
struct HermiteWeights {
    double from, from_slope, to, to_slope;
};
inline HermiteWeights hermite_weights(double s, double h) {
    return {(1 + 2 * s) * (1 - s) * (1 - s), s * (1 - s) * (1 - s) * h, s * s * (3 - 2 * s),
            s * s * (s - 1) * h};
}

}  // namespace wetcurl

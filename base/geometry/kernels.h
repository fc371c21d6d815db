// The cubic spline kernel W in three dimensions, its gradient and its value at zero.
// Monaghan 1992, normalised to one over the ball of the support radius h [m].
#pragma once

#include "base/vec3.h"

namespace wetcurl {

// W(0) [1/m^3].
template <class S>
WETCURL_HD S kernel_at_zero(const S& h) {
    return S(2.5464790894703255) / (h * h * h);  // 8 / pi
}

// W(r) / W(0): the spline as a difference of truncated cubes, 2 (1 - q)^3 - (1 - 2 q)^3, q = r / h.
template <class S>
WETCURL_HD S kernel_shape(const S& r, const S& h) {
    const S root2(1.2599210498948732), inverse = S(1) / h;  // cube root of 2
    const S outer = maximum(root2 - (root2 * inverse) * r, S(0));
    const S inner = maximum(S(1) - (S(2) * inverse) * r, S(0));
    return outer * outer * outer - inner * inner * inner;
}

// The integral of s W(s) / W(0) ds from r to h [m²].
template <class S>
WETCURL_HD S kernel_shape_moment(const S& r, const S& h) {
    const S u = maximum(S(1) - r / h, S(0)), v = maximum(S(1) - S(2) * r / h, S(0));
    const S u4 = u * u * u * u, v4 = v * v * v * v;
    return h * h * (u4 * (S(0.5) - S(0.4) * u) - v4 * (S(0.0625) - S(0.05) * v));
}

// W(r) [1/m^3], 0 beyond h.
template <class S>
WETCURL_HD S kernel(const S& r, const S& h) {
    return kernel_at_zero(h) * kernel_shape(r, h);
}

// dW/dr [1/m^4], never positive.
template <class S>
WETCURL_HD S kernel_slope(const S& r, const S& h) {
    const S q = minimum(r / h, S(1)), u = S(1) - q;
    return kernel_at_zero(h) / h * select(q < S(0.5), S(6) * q * (S(3) * q - S(2)), S(-6) * u * u);
}

// grad_x W(|x|) [1/m^4]; zero at x = 0, where the kernel is flat.
template <class S>
WETCURL_HD Vec3<S> kernel_gradient(const Vec3<S>& x, const S& h) {
    const S r = norm(x);
    return (kernel_slope(r, h) / maximum(r, S(tiny_length<S>))) * x;
}

}  // namespace wetcurl

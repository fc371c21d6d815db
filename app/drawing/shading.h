// Light on hair and on solids, in linear colour.
// Hair: Kajiya and Kay 1989 (diffuse) and the lobes of Marschner 2003 in the closed form of Karis 2016.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/vec3.h"

namespace wetcurl {

inline float linear_of_srgb(float c) {
    return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}
inline float srgb_of_linear(float c) {
    c = std::clamp(c, 0.f, 1.f);
    return c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
}
inline Vec3f linear_of_srgb(const Vec3f& c) {
    return {linear_of_srgb(c.x), linear_of_srgb(c.y), linear_of_srgb(c.z)};
}
inline Vec3f times(const Vec3f& a, const Vec3f& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline Vec3f power(const Vec3f& c, float e) { return {std::pow(c.x, e), std::pow(c.y, e), std::pow(c.z, e)}; }

// What a point of a strand is made of.
struct HairMaterial {
    Vec3f color;  // linear
    float wet;    // 0..1
};

// Share of the light from `light` that hair with tangent `t` (root to tip) sends towards `view`; all unit.
inline Vec3f hair_reflection(const HairMaterial& m, const Vec3f& t, const Vec3f& light, const Vec3f& view) {
    const float sin_l = std::clamp(dot(t, light), -1.f, 1.f), sin_v = std::clamp(dot(t, view), -1.f, 1.f);
    const Vec3f across_l = light - sin_l * t, across_v = view - sin_v * t;
    const float cos_phi = std::clamp(
        dot(across_l, across_v) / std::sqrt(dot(across_l, across_l) * dot(across_v, across_v) + 1e-6f), -1.f,
        1.f);
    const float cos_half_phi = std::sqrt(0.5f + 0.5f * cos_phi);
    const float cos_d = std::cos(0.5f * (std::asin(sin_v) - std::asin(sin_l)));
    // Water fills the scales: the lobe narrows, its shift towards the root nearly goes, more is mirrored.
    const float width = 0.22f - 0.10f * m.wet, shift = 0.07f - 0.05f * m.wet, mirror = 1 + 2.2f * m.wet;
    auto lobe = [&](float b, float a) {
        float x = (sin_l + sin_v - a) / b;
        return std::exp(-0.5f * x * x) / (b * 2.5066f);
    };
    const float fresnel = 0.0465f + 0.9535f * std::pow(1 - std::clamp(cos_half_phi * cos_d, 0.f, 1.f), 5.f);
    const float r = mirror * 0.25f * cos_half_phi * fresnel * lobe(width, -2 * shift);
    const float tt = std::exp(-3.65f * cos_phi - 3.98f) * lobe(0.5f * width, shift);
    const float trt = 0.5f * std::exp(17 * cos_phi - 16.78f) * lobe(1.8f * width, 4 * shift);
    const float diffuse = 0.50f * std::sqrt(std::max(0.f, 1 - sin_l * sin_l)) * (0.6f + 0.4f * cos_phi);
    const Vec3f white{1, 1, 1};
    return diffuse * m.color + 1.6f * r * white + tt * power(m.color, 0.6f / std::max(cos_d, 0.2f)) +
           trt * power(m.color, 0.8f / std::max(cos_d, 0.2f));
}

// Share that a matt solid with normal `n` and a faint sheen sends towards `view`.
inline Vec3f solid_reflection(const Vec3f& color, const Vec3f& n, const Vec3f& light, const Vec3f& view) {
    const float cosine = std::max(0.f, dot(n, light));
    const Vec3f half = normalized(light + view, n);
    const float sheen = cosine > 0 ? 0.06f * std::pow(std::max(0.f, dot(n, half)), 24.f) : 0.f;
    return (0.318f * cosine) * color + sheen * Vec3f{1, 1, 1};
}

}  // namespace wetcurl

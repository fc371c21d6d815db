// S7: the same scene elsewhere, turned, in another order of strands, in another unit of length.
#include <algorithm>
#include <cmath>

#include "solver/stability/cases.h"

namespace wetcurl::stability {

namespace {

// Plain strands and changed ones, once these are brought back.
StabilityCase invariant(const Battery& b, const std::string& what, const StrandSetup& plain,
                        const StrandSetup& changed, double bound,
                        const std::function<void(Points&)>& bring_back) {
    StabilityCase c = b.named("S7", what, {{"k_over_m", changed.k_over_m}});
    auto run = [&](const StrandSetup& setup, Points* drawn) {
        Trial trial(b.method, scene_of(setup, b.method));
        if (drawn) *drawn = trial.simulation().state().x;
        for (int k = 0; k < 100; ++k) trial.advance();
        return trial.simulation().state().x;
    };
    Points drawn;
    const Points x = run(plain, &drawn);
    Points y = run(changed, nullptr);
    bring_back(y);
    const double moved = farthest(x, drawn) / length;
    c.rest_error = farthest(x, y) / length;
    c.finite = std::isfinite(c.rest_error);
    c.measured = {{"bound", bound}, {"moved", moved}};
    c.passed = c.finite && c.rest_error <= bound && moved > 0.01;
    return c;
}

}  // namespace

Cases invariances(const Battery& b, const StrandSetup& plain, const std::string& of) {
    const bool single = b.method.precision == "float";
    auto each = [](auto change) {
        return [change](Points& points) {
            for (auto& p : points) p = change(p);
        };
    };
    Cases out;
    StrandSetup s = plain;
    const Vec3d far{1000, -500, 300};
    s.more += "[motion]\n[[motion.keyframe]]\ntranslation = [1000, -500, 300]\n";
    // An ulp at 1000 m is 1e-13 m in double. In single it is 6e-5 m, a hundredth of a segment.
    out.push_back(invariant(b, "translation by 1 km" + of, plain, s, single ? 0.1 : 1e-6,
                            each([=](const Vec3d& p) { return p - far; })));
    s = plain;
    const Quatd q = rotation_about(normalized(Vec3d{1, 2, 3}, Vec3d{1, 0, 0}), 1.1);
    for (auto& shape : s.shapes)
        for (auto& p : shape) p = rotate(q, p);
    s.gravity = rotate(q, down);
    // Grooms are kept in single: 1e-8 m of each particle, 4e-6 of a segment, and turns of edges add up.
    out.push_back(invariant(b, "rotation" + of, plain, s, 1e-3,
                            each([=](const Vec3d& p) { return rotate(conjugate(q), p); })));
    s = plain;
    std::rotate(s.shapes.begin(), s.shapes.begin() + 1, s.shapes.end());
    // Sums over neighbours are rounded in another order: forces in single by some 1e-7 in each step.
    const double rounding = single && !b.method.dry ? 1e-5 : 1e-6;
    out.push_back(invariant(b, "strand permutation" + of, plain, s, of.empty() ? 0 : rounding,
                            [](Points& p) { std::rotate(p.begin(), p.end() - particles, p.end()); }));
    if (!of.empty() || b.method.compared() || b.method.fibre > 0)
        return out;  // these have lengths of their own
    s = plain;
    // By a power of two, so that no digit of the groom is lost; k / m has no length in it.
    const double unit = 32;
    for (auto& shape : s.shapes)
        for (auto& p : shape) p = unit * p;
    s.gravity = unit * down;
    s.set = {setting("core.smoothing", 0.02 * unit)};
    out.push_back(invariant(b, "unit of length", plain, s, single ? 1e-3 : 1e-9,
                            each([=](const Vec3d& p) { return (1 / unit) * p; })));
    return out;
}

}  // namespace wetcurl::stability

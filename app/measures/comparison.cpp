// Comparisons as JSON.
#include "app/measures/comparison.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/engine/run_solids.h"
#include "base/log.h"

namespace wetcurl {

static Json json_of(const Spread& s) {
    return {{"mean", s.mean}, {"median", s.median}, {"p95", s.p95}, {"max", s.max}};
}
static Json json_of(const std::optional<double>& x) { return x ? Json(*x) : Json(nullptr); }

Json json_of(const Comparison& c) {
    return {{"file", c.file},
            {"method", c.method},
            {"kind", c.kind},
            {"frames", c.frames},
            {"seconds_per_frame", c.seconds_per_frame},
            {"seconds_per_frame_reference", c.seconds_per_frame_reference},
            {"position_mm", json_of(c.position_mm)},
            {"position_mm_per_frame", c.mm_per_frame},
            {"position_rel", c.position_rel},
            {"position_shared_mm", json_of(c.shared_mm)},
            {"position_new_mm", json_of(c.new_mm)},
            {"position_strands_mm", json_of(c.strands_mm)},
            {"position_static_mm", c.static_mm},
            {"position_dynamic_mm", c.dynamic_mm},
            {"f1_2mm_20deg", c.f1[0]},
            {"f1_3mm_30deg", c.f1[1]},
            {"f1_4mm_40deg", c.f1[2]},
            {"curvature_error", c.curvature_error},
            {"curl_radius_ratio", c.curl_radius_ratio},
            {"stretch_max", c.stretch_max},
            {"stretch_max_reference", c.stretch_max_reference},
            {"stretch_mean", c.stretch_mean},
            {"stretch_mean_reference", c.stretch_mean_reference},
            {"penetration",
             {{"fraction", c.penetration_fraction},
              {"mean_mm", c.penetration_mean_mm},
              {"max_mm", c.penetration_max_mm}}},
            {"solid_distance_mm", json_of(c.solid_distance_mm)},
            {"tip_spread_mm", c.tip_spread_mm},
            {"tip_spread_reference_mm", c.tip_spread_reference_mm},
            {"tip_spread_ratio", c.tip_spread_ratio},
            {"clumps", c.clumps},
            {"clumps_reference", c.clumps_reference},
            {"crowd", c.crowd},
            {"crowd_reference", c.crowd_reference},
            {"jitter_mm", json_of(c.jitter_mm)},
            {"jitter_reference_mm", json_of(c.jitter_reference_mm)},
            {"expected_mm", json_of(c.expected_mm)},
            {"expected_rank", json_of(c.expected_rank)},
            {"velocity_error_m_per_s", c.velocity_error}};
}

std::optional<double> speed_up(const Comparison& c) {
    if (!(c.seconds_per_frame > 0 && c.seconds_per_frame_reference > 0)) return std::nullopt;
    return c.seconds_per_frame_reference / c.seconds_per_frame;
}

std::vector<Comparison> compare_runs(const std::string& reference, const std::vector<std::string>& others,
                                     int first_frame) {
    const RunReader against(reference);
    const auto solid = solid_distance_of(against.header());
    std::vector<Comparison> out;
    for (const auto& path : others) {
        const RunReader other(path);
        out.push_back(compare(against, other, first_frame, solid));
        if (other.frames() != against.frames())
            log_warning(fmt::format("{} has {} frames, {} has {}: frames {} to {} are compared", path,
                                    other.frames(), reference, against.frames(), first_frame,
                                    first_frame + out.back().frames - 1));
    }
    return out;
}

}  // namespace wetcurl

// What a FrameWatch has seen, as results.
#include "app/files/watch_results.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace wetcurl {

namespace {

std::string place_of(const FrameExtreme& e) {
    return fmt::format("frame {}, strand {}, particle {}", e.frame, e.strand, e.particle);
}

Json json_of(const std::optional<FrameExtreme>& e) {
    if (!e) return nullptr;
    return {{"value", e->value}, {"frame", e->frame}, {"strand", e->strand}, {"particle", e->particle}};
}

}  // namespace

Json json_of(const FrameWatch& watch) {
    const auto& growth = watch.energy_growth();
    return {{"stretch", json_of(watch.stretch())},
            {"overstretched", json_of(watch.overstretched())},
            {"speed_m_per_s", json_of(watch.speed())},
            {"overspeed", json_of(watch.overspeed())},
            {"energy_growth_joule",
             growth ? Json{{"value", growth->value}, {"frame", growth->frame}} : Json(nullptr)}};
}

std::string stretch_text(const FrameWatch& watch) {
    if (!watch.stretch()) return "-";
    return fmt::format("{:.3g} times rest ({})", watch.stretch()->value, place_of(*watch.stretch()));
}

std::string warning_of(const FrameWatch& watch) {
    std::string text;
    if (const auto& first = watch.overstretched())
        text = fmt::format("an edge is {:.3g} times as long as at rest ({}); beyond {:g} times first at {}",
                           watch.stretch()->value, place_of(*watch.stretch()), FrameWatch::warning_stretch,
                           place_of(*first));
    if (const auto& first = watch.overspeed())
        text += fmt::format("{}hair goes at {:.3g} m/s ({}); beyond {:g} m/s first at {}",
                            text.empty() ? "" : "; and ", watch.speed()->value, place_of(*watch.speed()),
                            FrameWatch::warning_speed, place_of(*first));
    return text;
}

}  // namespace wetcurl

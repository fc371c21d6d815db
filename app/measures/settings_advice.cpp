// What settings cost and gain, looked up in measured tables.
#include "app/measures/settings_advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "app/files/results.h"
#include "app/measures/settings_table.h"

namespace wetcurl {

namespace {

struct Cost {
    double error, time;  // [%], [s]
};

// Rows of one hair and kind.
class MeasuredHair {
  public:
    explicit MeasuredHair(const Json& hair) : hair_(hair) {}

    // By powers of the substeps between those that were measured; beyond, times go straight on, and the error
    // stays what it was measured to be.
    Cost at(double substeps, const std::string& precision) const {
        std::vector<std::pair<double, Cost>> measured;
        for (const Json& row : hair_.at("rows"))
            if (row.at("precision") == precision && !row.contains("cohesion"))
                measured.emplace_back(row.at("substeps"), cost_of(row));
        std::sort(measured.begin(), measured.end(), [](auto& a, auto& b) { return a.first < b.first; });
        size_t k = 1;
        while (k + 1 < measured.size() && measured[k].first < substeps) ++k;
        const auto& [n, below] = measured[k - 1];
        const auto& [m, above] = measured[k];
        if (substeps < n || substeps > m) {
            const Cost& end = substeps < n ? below : above;
            const double a_substep = std::max(0.0, (above.time - below.time) / (m - n));
            return {end.error, end.time + a_substep * (substeps - (substeps < n ? n : m))};
        }
        const double share = std::log(substeps / n) / std::log(m / n);
        const auto between = [&](double a, double b) { return a * std::pow(b / a, share); };
        return {between(below.error, above.error), between(below.time, above.time)};
    }

    // With that key of [cohesion] as the paper prints it, over the same without: what the error rises by, and
    // the ratio of times. Nothing where it was not measured.
    std::optional<Cost> as_printed(const char* key) const {
        for (const Json& row : hair_.at("rows")) {
            if (!row.contains("cohesion") || !row.at("cohesion").contains(key)) continue;
            const Cost usual = at(row.at("substeps"), row.at("precision")), printed = cost_of(row);
            return Cost{printed.error - usual.error, printed.time / usual.time};
        }
        return std::nullopt;
    }

  private:
    static Cost cost_of(const Json& row) { return {row.at("median_percent"), row.at("frame_seconds")}; }
    const Json& hair_;
};

// Curvature of a curl [1/m] of whose wire a turn takes so much [m]; of straight hair 0.
double curvature_of(double radius, double turn) {
    constexpr double two_pi = 2 * std::numbers::pi;
    return radius > 0 ? two_pi * two_pi * radius / (turn * turn) : 0;
}
double curvature_of(const HairKind& kind) {
    return curvature_of(kind.curl_radius, std::hypot(2 * std::numbers::pi * kind.curl_radius, kind.pitch));
}
double curvature_of(const Scene& scene) {
    const Strands& rest = scene.groom.rest;
    const CurlTurns& curl = scene.curl_turns;
    if (!(curl.turns > 0) || rest.count == 0) return 0;
    double length = 0;
    for (int s = 0; s < rest.count; ++s) length += arc_length(rest.strand(s), rest.particles) / rest.count;
    return curvature_of(curl.radius, length / curl.turns);
}

// Null where no hair of that kind was measured.
const Json* most_like(const Json& table, const Scene& scene, const std::string& kind) {
    const Json* best = nullptr;
    double least = 0;
    const double curvature = curvature_of(scene);
    for (const Json& hair : table.at("hair")) {
        const std::string name = hair.at("hair");
        if (hair.at("kind") != kind || (name == "springs") != !scene.fibre) continue;
        const HairKind* measured = hair_named(name);
        const double unlike = measured ? std::abs(curvature_of(*measured) - curvature) : 0;
        if (!best || unlike < least) best = &hair, least = unlike;
    }
    return best;
}

struct PrintedKey {
    const char *name, *value;
    bool is_printed;  // in the scene
};

}  // namespace

std::optional<SettingsAdvice> advice_on(const Scene& scene) {
    if (!scene.integrator.is_implicit() || !title_of(scene.baselines).empty()) return std::nullopt;
    static const Json table = Json::parse(settings_table);
    const bool wet = scene.wetness.has_value();
    if (wet != scene.cohesion.has_value() || (wet && scene.cohesion->strength > 0) ||
        (scene.strand_contact && !wet))
        return std::nullopt;
    const Json* hair = most_like(table, scene, scene.strand_contact ? "touching" : wet ? "wet" : "dry");
    if (!hair) return std::nullopt;
    const MeasuredHair measured(*hair);
    SettingsAdvice out;
    out.hair = hair->at("hair"), out.kind = hair->at("kind");
    out.machine = table.at("provenance").at("processor");

    std::vector<PrintedKey> keys;
    if (wet && !scene.strand_contact)
        keys = {{"spacing", "0", scene.cohesion->spacing == 0},
                {"relaxation", "1", scene.cohesion->relaxation == 1}};
    // With every setting of Eq 10 as in the scene, but for `turned`.
    const auto cost = [&](double substeps, const char* precision, const char* turned = "") {
        Cost sum = measured.at(substeps, precision);
        for (const PrintedKey& key : keys)
            if (key.is_printed != (key.name == std::string_view(turned)))
                if (const auto printed = measured.as_printed(key.name))
                    sum.error = std::max(0.0, sum.error + printed->error), sum.time *= printed->time;
        return sum;
    };
    constexpr int fewest = 5, most = 40;  // that were measured
    const int substeps = scene.integrator.substeps;
    const Cost own = cost(substeps, "float");
    const auto add = [&](std::string setting, const Cost& c) {
        out.rows.push_back({std::move(setting), c.error, c.time / own.time});
    };
    add("as it is", own);
    for (const int other : {substeps / 2, 2 * substeps})
        if (other >= fewest && other <= most)
            add(fmt::format("integrator.substeps = {}", other), cost(other, "float"));
    add("--precision double", cost(substeps, "double"));
    for (const PrintedKey& key : keys)
        add(key.is_printed ? fmt::format("without cohesion.{} = {}", key.name, key.value)
                           : fmt::format("cohesion.{} = {}", key.name, key.value),
            cost(substeps, "float", key.name));

    // An error that is larger by less than this nobody sees; a time that differs by less is noise.
    constexpr double seen = 0.05, noise = 0.1;  // [%], [1]
    for (size_t k = 1; k < out.rows.size(); ++k) {
        const auto& row = out.rows[k];
        const bool cheaper = row.time < 1 - noise && row.error < own.error + seen;
        const bool better = own.error > 1 && row.error < own.error / 1.5;
        if (cheaper || better)
            out.advice.push_back(
                fmt::format("{}: errs by {:.2g} % of the length in place of {:.2g}, in {:.2g} times the time",
                            row.setting, row.error, own.error, row.time));
    }
    return out;
}

}  // namespace wetcurl

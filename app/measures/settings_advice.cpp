// What settings cost and gain, looked up in measured tables.
#include "app/measures/settings_advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/files/results.h"
#include "app/measures/settings_table.h"
#include "solver/grooms/neighbourhood.h"

namespace wetcurl {

namespace {

struct Cost {
    double error, time;  // [%], [s]
};

// Rows of one hair and kind.
class MeasuredHair {
  public:
    explicit MeasuredHair(const Json& hair) : hair_(hair) {}

    // Between what was measured, error and time go by a power of the substeps; beyond, a time with their
    // number and an error against it.
    Cost at(double substeps, const std::string& precision) const {
        std::vector<std::pair<double, Cost>> measured;
        for (const Json& row : hair_.at("rows"))
            if (row.at("precision") == precision && !row.contains("cohesion"))
                measured.emplace_back(row.at("substeps"), cost_of(row));
        std::sort(measured.begin(), measured.end(), [](auto& a, auto& b) { return a.first < b.first; });
        const auto& [fewest, first] = measured.front();
        const auto& [most, last] = measured.back();
        if (substeps <= fewest) return {first.error * fewest / substeps, first.time * substeps / fewest};
        if (substeps >= most) return {last.error * most / substeps, last.time * substeps / most};
        size_t k = 1;
        while (measured[k].first < substeps) ++k;
        const auto& [n, below] = measured[k - 1];
        const auto& [m, above] = measured[k];
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

// How much a curl bends [1/m]; straight hair, of radius 0, does not.
double bend_of(double radius) { return radius > 0 ? 1 / radius : 0; }

// Null where no hair of that kind was measured.
const Json* most_like(const Json& table, const Scene& scene, const std::string& kind) {
    const Json* best = nullptr;
    double least = 0;
    for (const Json& hair : table.at("hair")) {
        const std::string name = hair.at("hair");
        if (hair.at("kind") != kind || (name == "springs") != !scene.fibre) continue;
        const HairKind* measured = hair_named(name);
        const double unlike =
            measured ? std::abs(bend_of(scene.curl_turns.radius) - bend_of(measured->curl_radius)) : 0;
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
    const bool wet = scene.wetness && scene.cohesion,
               touching = scene.strand_contact || (wet && scene.cohesion->strength > 0);
    const Json* hair = most_like(table, scene, touching ? "touching" : wet ? "wet" : "dry");
    if (!hair) return std::nullopt;
    const MeasuredHair measured(*hair);
    SettingsAdvice out;
    out.hair = hair->at("hair"), out.kind = hair->at("kind");
    out.machine = table.at("provenance").at("processor");

    std::vector<PrintedKey> keys;
    if (wet && !touching)
        keys = {{"spacing", "0", scene.cohesion->spacing == 0},
                {"neighbours", "0", scene.cohesion->neighbours == 0},
                {"relaxation", "1", scene.cohesion->relaxation == 1}};
    // What all neighbours cost was measured where there are few.
    constexpr double few = 100;
    if (wet && Neighbourhood(scene.groom.rest).within(scene.cohesion->h_c) > few)
        std::erase_if(keys, [](const PrintedKey& key) { return key.name == std::string_view("neighbours"); });
    // With every setting of Eq 10 as in the scene, but for `turned`.
    const auto cost = [&](double substeps, const char* precision, const char* turned = "") {
        Cost sum = measured.at(substeps, precision);
        for (const PrintedKey& key : keys)
            if (key.is_printed != (key.name == std::string_view(turned)))
                if (const auto printed = measured.as_printed(key.name))
                    sum.error = std::max(0.0, sum.error + printed->error), sum.time *= printed->time;
        return sum;
    };
    const int substeps = scene.integrator.substeps;
    const Cost own = cost(substeps, "float");
    const auto add = [&](std::string setting, const Cost& c) {
        out.rows.push_back({std::move(setting), c.error, c.time / own.time});
    };
    add("as it is", own);
    if (substeps > 1) add(fmt::format("integrator.substeps = {}", substeps / 2), cost(substeps / 2, "float"));
    add(fmt::format("integrator.substeps = {}", 2 * substeps), cost(2 * substeps, "float"));
    add("--precision double", cost(substeps, "double"));
    for (const PrintedKey& key : keys)
        add(key.is_printed ? fmt::format("without cohesion.{} = {}", key.name, key.value)
                           : fmt::format("cohesion.{} = {}", key.name, key.value),
            cost(substeps, "float", key.name));

    // An error that is larger by less than this nobody sees; a time that differs by less is noise.
    constexpr double seen = 0.05, noise = 0.1;  // [%], [1]
    for (size_t k = 1; k < out.rows.size(); ++k) {
        const auto& row = out.rows[k];
        const bool cheaper = row.time < 1 - noise && row.error<own.error + seen, better = own.error> 1 &&
                             row.error < own.error / 1.5;
        if (cheaper || better)
            out.advice.push_back(
                fmt::format("{}: errs by {:.2g} % of the length in place of {:.2g}, in {:.2g} times the time",
                            row.setting, row.error, own.error, row.time));
    }
    return out;
}

}  // namespace wetcurl

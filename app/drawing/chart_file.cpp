// Charts from a JSON file.
#include "app/drawing/chart_file.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "app/files/results.h"
#include "base/error.h"

namespace wetcurl {

namespace {

// In order, by number; apart for the colour-blind: Okabe and Ito 2008.
const Vec3f colors[] = {{0.10f, 0.10f, 0.10f}, {0.00f, 0.45f, 0.70f}, {0.84f, 0.37f, 0.00f},
                        {0.00f, 0.62f, 0.45f}, {0.80f, 0.47f, 0.65f}, {0.34f, 0.71f, 0.91f},
                        {0.90f, 0.62f, 0.00f}};

Curve curve_of(const Json& json, size_t number) {
    Curve curve{json.at("name"), colors[number % std::size(colors)], {}, 2};
    for (const Json& value : json.at("values"))
        curve.values.push_back(value.is_null() ? std::numeric_limits<double>::quiet_NaN()
                                               : value.get<double>());
    return curve;
}

}  // namespace

Chart chart_of_file(const std::string& path) {
    std::ifstream file(path);
    const Json json = Json::parse(file, nullptr, /*allow_exceptions=*/false);
    Chart chart;
    size_t longest = 0;
    try {
        chart.title = json.at("title"), chart.x_label = json.at("x_label"),
        chart.y_label = json.at("y_label");
        chart.dx = json.at("dx");
        for (const Json& curve : json.at("curves")) {
            chart.curves.push_back(curve_of(curve, chart.curves.size()));
            longest = std::max(longest, chart.curves.back().values.size());
        }
    } catch (const Json::exception& e) {
        throw Error(path + ": is no chart (" + e.what() +
                    "); allowed is {\"title\", \"x_label\", \"y_label\", \"dx\", \"curves\": [{\"name\", "
                    "\"values\"}]}");
    }
    if (!(chart.dx > 0) || !std::isfinite(chart.dx)) throw Error(path + ": dx must be more than 0");
    if (longest < 2) throw Error(path + ": holds no curve of two values or more, which plot needs");
    return chart;
}

}  // namespace wetcurl

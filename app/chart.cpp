// Draws curves: anti-aliased lines of our own, letters by image_file.
#include "app/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/image_file.h"

namespace wetcurl {

namespace {

const Vec3f ink{0.13f, 0.13f, 0.13f}, grid_color{0.88f, 0.88f, 0.89f};

struct Point {
    float column, row;
};

// Ink as deep as a pixel's centre lies within the line; once for all pieces, so that no joint is darker.
void draw_line(Image& image, const std::vector<Point>& points, const Vec3f& color, float width) {
    std::vector<float> depth(image.rgb.size() / 3, 0.f);
    const float reach = width / 2 + 1;
    for (size_t k = 0; k + 1 < points.size(); ++k) {
        const Point a = points[k], b = points[k + 1];
        const float dx = b.column - a.column, dy = b.row - a.row;
        const float square = std::max(dx * dx + dy * dy, 1e-12f);
        auto first = [&](float p, float q) { return std::max(0, int(std::floor(std::min(p, q) - reach))); };
        auto last = [&](float p, float q, int size) {
            return std::min(size - 1, int(std::ceil(std::max(p, q) + reach)));
        };
        for (int r = first(a.row, b.row); r <= last(a.row, b.row, image.height); ++r)
            for (int c = first(a.column, b.column); c <= last(a.column, b.column, image.width); ++c) {
                const float x = float(c) + 0.5f - a.column, y = float(r) + 0.5f - a.row;
                const float t = std::clamp((x * dx + y * dy) / square, 0.f, 1.f);
                float& d = depth[size_t(r) * size_t(image.width) + size_t(c)];
                d = std::max(d, std::clamp(width / 2 + 0.5f - std::hypot(x - t * dx, y - t * dy), 0.f, 1.f));
            }
    }
    const float channel[3]{color.x, color.y, color.z};
    for (size_t k = 0; k < depth.size(); ++k)
        for (size_t c = 0; c < 3 && depth[k] > 0; ++c)
            image.rgb[3 * k + c] += depth[k] * (channel[c] - image.rgb[3 * k + c]);
}

struct Range {
    double low = 0, high = 0;  // 0 is always in it
    void add(double x) {
        if (std::isfinite(x)) low = std::min(low, x), high = std::max(high, x);
    }
    double share(double x) const { return (x - low) / std::max(high - low, 1e-300); }
};

constexpr float letters_of_legend = 10;

Image draw_chart(const Chart& chart, const Range& x, const Range& y, int width, int height,
                 const std::vector<Curve>& legend) {
    const float letter = 0.030f * float(height), margin = 1.6f * letter, right = float(width) - margin;
    Image image(width + (legend.empty() ? 0 : int(letters_of_legend * letter)), height);
    std::fill(image.rgb.begin(), image.rgb.end(), 1.f);
    const float left = 5.5f * letter, top = 3.4f * letter, bottom = float(height) - 3.6f * letter;
    auto at = [&](double px, double py) {
        return Point{left + float(x.share(px)) * (right - left),
                     bottom - float(y.share(py)) * (bottom - top)};
    };
    for (double tick : ticks_between(y.low, y.high, 6)) {
        const Point p = at(x.low, tick);
        draw_line(image, {p, at(x.high, tick)}, tick == 0 ? 0.6f * grid_color : grid_color, 1);
        draw_text(image, fmt::format("{:.4g}", tick), int(left - 0.6f * letter), int(p.row + 0.4f * letter),
                  letter, 1);
    }
    for (double tick : ticks_between(x.low, x.high, 6)) {
        const Point p = at(tick, y.low);
        draw_line(image, {p, {p.column, p.row + 0.35f * letter}}, ink, 1);
        draw_text(image, fmt::format("{:.4g}", tick), int(p.column), int(bottom + 1.5f * letter), letter,
                  0.5);
    }
    draw_line(image, {{left, top}, {left, bottom}, {right, bottom}}, ink, 1);
    for (const auto& curve : chart.curves) {
        std::vector<Point> points;
        for (size_t k = 0; k < curve.values.size() && std::isfinite(curve.values[k]); ++k)
            points.push_back(at(double(k) * chart.dx, curve.values[k]));
        draw_line(image, points, curve.color, curve.width);
    }
    draw_text(image, chart.title, int(0.5f * (left + right)), int(1.5f * letter), 1.2 * letter, 0.5);
    draw_text(image, chart.y_label, int(0.4f * letter), int(2.6f * letter), letter, 0);
    draw_text(image, chart.x_label, int(0.5f * (left + right)), int(float(height) - 0.7f * letter), letter,
              0.5);
    for (size_t k = 0; k < legend.size(); ++k) {
        const float row = top + (0.8f + 1.5f * float(k)) * letter, column = right + 2.9f * letter;
        const Curve& curve = legend[k];
        draw_line(image, {{column - 2 * letter, row}, {column - 0.4f * letter, row}}, curve.color,
                  curve.width);
        draw_text(image, curve.name, int(column), int(row + 0.4f * letter), letter, 0);
    }
    return image;
}

}  // namespace

std::vector<double> ticks_between(double low, double high, int count) {
    std::vector<double> ticks;
    if (!(high > low)) return ticks;
    const double least = (high - low) / count, ten = std::pow(10, std::floor(std::log10(least)));
    double step = 10 * ten;
    for (double one : {5.0, 2.0, 1.0})
        if (one * ten >= least) step = one * ten;
    for (double k = std::ceil(low / step); k * step <= high * (1 + 1e-12); ++k) ticks.push_back(k * step);
    return ticks;
}

Image draw_charts(const std::vector<Chart>& charts, int width, int height) {
    Range x, y;
    for (const auto& chart : charts)
        for (const auto& curve : chart.curves) {
            x.add(chart.dx * double(std::max<size_t>(curve.values.size(), 1) - 1));
            for (double value : curve.values) y.add(value);
        }
    y.high += 0.04 * (y.high - y.low);  // air above the highest
    std::vector<Curve> legend;          // a name once, the last chart's after those that it lacks
    for (auto chart = charts.rbegin(); chart != charts.rend(); ++chart)
        for (auto curve = chart->curves.rbegin(); curve != chart->curves.rend(); ++curve)
            if (std::none_of(legend.begin(), legend.end(),
                             [&](const Curve& known) { return known.name == curve->name; }))
                legend.insert(legend.begin(), {curve->name, curve->color, {}, curve->width});
    std::vector<Image> images;
    for (const auto& chart : charts)
        images.push_back(
            draw_chart(chart, x, y, width, height, &chart == &charts.back() ? legend : std::vector<Curve>{}));
    return side_by_side(images);
}

}  // namespace wetcurl

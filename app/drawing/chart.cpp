// Draws charts: anti-aliased lines, letters by image_file.
#include "app/drawing/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "app/drawing/image_file.h"

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

void fill(Image& image, Point a, Point b, const Vec3f& color) {
    for (int row = int(std::lround(a.row)); row < int(std::lround(b.row)); ++row)
        for (int column = int(std::lround(a.column)); column < int(std::lround(b.column)); ++column) {
            float* p = image.pixel(column, row);
            p[0] = color.x, p[1] = color.y, p[2] = color.z;
        }
}

// The pieces of a line that dashes leave of it.
std::vector<std::vector<Point>> dashes_of(const std::vector<Point>& points, float on, float off) {
    std::vector<std::vector<Point>> out;
    float at = 0;  // within a dash and the gap after it
    for (size_t k = 0; k + 1 < points.size(); ++k) {
        const Point a = points[k], b = points[k + 1];
        const float length = std::hypot(b.column - a.column, b.row - a.row);
        auto between = [&](float s) {
            const float t = length > 0 ? s / length : 0;
            return Point{a.column + t * (b.column - a.column), a.row + t * (b.row - a.row)};
        };
        for (float s = 0; s < length;) {
            const float rest = at < on ? on - at : on + off - at, step = std::min(rest, length - s);
            if (at < on) {
                if (at == 0 || out.empty()) out.push_back({between(s)});
                out.back().push_back(between(s + step));
            }
            s += step;
            at = step < rest ? at + step : at < on ? on : 0;
        }
    }
    if (out.empty()) out.push_back(points);  // a dot
    return out;
}

// From which value to which an axis goes; of a linear one 0 is always in it.
struct Axis {
    bool logarithmic = false;
    double low = 0, high = 0;
    bool empty = true;

    bool holds(double x) const { return std::isfinite(x) && (!logarithmic || x > 0); }
    void add(double x) {
        if (!holds(x)) return;
        if (empty) low = logarithmic ? x : std::min(0.0, x), high = logarithmic ? x : std::max(0.0, x);
        empty = false;
        low = std::min(low, x), high = std::max(high, x);
    }
    // Air above the highest, and on a logarithmic axis below the lowest too, of a decade at the least.
    void widen() {
        if (!logarithmic) {
            high += 0.04 * (high - low);
            return;
        }
        if (empty) low = 0.1, high = 10;
        low = std::max(low, 1e-9 * high);
        const double missing = std::max(0.0, 1 - std::log10(high / low)) / 2;
        const double air = std::pow(10, std::max(missing, 0.04 * std::log10(high / low)));
        low /= air, high *= air;
    }
    double share(double x) const {
        if (logarithmic) return (std::log10(std::max(x, low)) - std::log10(low)) / std::log10(high / low);
        return (x - low) / std::max(high - low, 1e-300);
    }
    std::vector<double> ticks() const {
        return logarithmic ? log_ticks_between(low, high) : ticks_between(low, high, 6);
    }
};

struct Axes {
    Axis x, y;
    void add(const Chart& chart) {
        for (const auto& curve : chart.curves) {
            for (size_t k = 0; k < curve.values.size(); ++k) x.add(x_of(chart, curve, k));
            for (double value : curve.values) y.add(value);
        }
        for (const auto& scatter : chart.scatters) {
            for (double value : scatter.x) x.add(value);
            for (double value : scatter.y) y.add(value);
        }
        for (const auto& bar : chart.bars) x.add(bar.value);
    }
    static double x_of(const Chart& chart, const Curve& curve, size_t k) {
        return curve.x.empty() ? double(k) * chart.dx : curve.x[k];
    }
};

// The runs of values that can be drawn.
std::vector<std::vector<Point>> pieces_of(const Chart& chart, const Curve& curve, const Axes& axes,
                                          const std::function<Point(double, double)>& at) {
    std::vector<std::vector<Point>> out;
    bool broken = true;
    for (size_t k = 0; k < curve.values.size(); ++k) {
        const double x = Axes::x_of(chart, curve, k);
        const bool drawn = axes.x.holds(x) && axes.y.holds(curve.values[k]);
        if (drawn && broken) out.emplace_back();
        if (drawn) out.back().push_back(at(x, curve.values[k]));
        broken = !drawn;
    }
    for (auto& piece : out)  // one alone is a dot
        if (piece.size() == 1) piece.push_back(piece[0]);
    return out;
}

// Squares of three pixels, as deep as many points lie in them.
void draw_scatter(Image& image, const Scatter& scatter, const Axes& axes,
                  const std::function<Point(double, double)>& at) {
    constexpr int cell = 3;
    const int columns = image.width / cell + 1;
    std::vector<int> count(size_t(columns) * size_t(image.height / cell + 1), 0);
    int most = 1;
    for (size_t k = 0; k < scatter.x.size(); ++k) {
        if (!axes.x.holds(scatter.x[k]) || !axes.y.holds(scatter.y[k])) continue;
        const Point p = at(scatter.x[k], scatter.y[k]);
        int& n = count[size_t(int(p.row) / cell * columns + int(p.column) / cell)];
        most = std::max(most, ++n);
    }
    const float channel[3]{scatter.color.x, scatter.color.y, scatter.color.z};
    for (int row = 0; row < image.height; ++row)
        for (int column = 0; column < image.width; ++column)
            if (const int n = count[size_t(row / cell * columns + column / cell)]) {
                const float depth =
                    most == 1 ? 1.f : 0.25f + 0.75f * std::log(float(n)) / std::log(float(most));
                float* p = image.pixel(column, row);
                for (int c = 0; c < 3; ++c) p[c] += depth * (channel[c] - p[c]);
            }
}

struct Key {
    std::string name;
    Vec3f color;
    float width;
    bool dashed, square;
};

void add_keys(const Chart& chart, std::vector<Key>& keys) {
    std::vector<Key> all;
    for (const auto& s : chart.scatters) all.push_back({s.name, s.color, 8, false, true});
    for (const auto& c : chart.curves) all.push_back({c.name, c.color, c.width, c.dashed, false});
    for (auto key = all.rbegin(); key != all.rend(); ++key)
        if (!key->name.empty() &&
            std::none_of(keys.begin(), keys.end(), [&](const Key& known) { return known.name == key->name; }))
            keys.insert(keys.begin(), *key);
}

constexpr float letters_of_legend = 10;

Image draw_chart(const Chart& chart, const Axes& axes, int width, int height,
                 const std::vector<Key>& legend) {
    const Axis &x = axes.x, &y = axes.y;
    const float letter = 0.030f * float(height), margin = 1.6f * letter, right = float(width) - margin;
    float legend_width = letters_of_legend * letter;
    for (const Key& key : legend)
        legend_width = std::max(legend_width, float(text_width(key.name, letter)) + 3.2f * letter);
    Image image(width + (legend.empty() ? 0 : int(legend_width)), height);
    std::fill(image.rgb.begin(), image.rgb.end(), 1.f);
    float left = 5.5f * letter;
    for (const Bar& bar : chart.bars)
        left = std::max(left, std::min(0.45f * float(width), float(text_width(bar.name, letter)) + margin));
    const float top = 4.2f * letter, bottom = float(height) - 3.6f * letter;
    const std::function<Point(double, double)> at = [&](double px, double py) {
        return Point{left + float(x.share(px)) * (right - left),
                     bottom - float(y.share(py)) * (bottom - top)};
    };
    if (chart.bars.empty())
        for (double tick : y.ticks()) {
            const Point p = at(x.low, tick);
            draw_line(image, {p, at(x.high, tick)},
                      tick == 0 && !y.logarithmic ? 0.6f * grid_color : grid_color, 1);
            draw_text(image, fmt::format("{:.4g}", tick), int(left - 0.6f * letter),
                      int(p.row + 0.4f * letter), letter, 1);
        }
    for (double tick : x.ticks()) {
        const float column = at(tick, y.low).column;
        draw_line(image, {{column, bottom}, {column, bottom + 0.35f * letter}}, ink, 1);
        draw_text(image, fmt::format("{:.4g}", tick), int(column), int(bottom + 1.5f * letter), letter, 0.5);
    }
    draw_line(image, {{left, top}, {left, bottom}, {right, bottom}}, ink, 1);
    for (const auto& scatter : chart.scatters) draw_scatter(image, scatter, axes, at);
    for (size_t k = 0; k < chart.bars.size(); ++k) {
        const Bar& bar = chart.bars[k];
        const float pitch = (bottom - top) / float(chart.bars.size()), row = top + (float(k) + 0.5f) * pitch;
        fill(image, {at(0, 0).column, row - 0.3f * pitch}, {at(bar.value, 0).column, row + 0.3f * pitch},
             bar.color);
        draw_text(image, bar.name, int(left - 0.6f * letter), int(row + 0.4f * letter), letter, 1);
    }
    for (const auto& curve : chart.curves)
        for (const auto& piece : pieces_of(chart, curve, axes, at))
            if (curve.dashed)
                for (const auto& dash : dashes_of(piece, 7, 5))
                    draw_line(image, dash, curve.color, curve.width);
            else
                draw_line(image, piece, curve.color, curve.width);
    // About the middle of the axis, smaller where it does not fit.
    auto draw_across = [&](const std::string& text, int row, double size) {
        const double smallest = 0.7 * size;
        while (size > smallest && text_width(text, size) > width) size *= 0.97;
        draw_text(image, text, int(0.5f * (left + right)), row, size, 0.5);
    };
    draw_across(chart.title, int(1.5f * letter), 1.2 * letter);
    draw_across(chart.x_label, int(float(height) - 0.7f * letter), letter);
    draw_text(image, chart.y_label, int(0.4f * letter), int(3.2f * letter), letter, 0);
    for (size_t k = 0; k < legend.size(); ++k) {
        const float row = top + (0.8f + 1.5f * float(k)) * letter, column = right + 2.9f * letter;
        const Key& key = legend[k];
        const std::vector<Point> sample{{column - (key.square ? 1.4f : 2) * letter, row},
                                        {column - (key.square ? 0.9f : 0.4f) * letter, row}};
        if (key.dashed)
            for (const auto& dash : dashes_of(sample, 7, 5)) draw_line(image, dash, key.color, key.width);
        else
            draw_line(image, sample, key.color, key.width);
        draw_text(image, key.name, int(column), int(row + 0.4f * letter), letter, 0);
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
    for (double k = std::ceil(low / step); k * step <= high * (1 + 1e-12); ++k)
        ticks.push_back(k * step + 0.0);  // never -0
    return ticks;
}

std::vector<double> log_ticks_between(double low, double high) {
    const bool fine = std::log10(high / low) < 3;
    std::vector<double> ticks;
    for (int e = int(std::floor(std::log10(low))); e <= int(std::ceil(std::log10(high))); ++e)
        for (double one : {1.0, 2.0, 5.0})
            if (const double v = one * std::pow(10, e); v >= low && v <= high && (one == 1 || fine))
                ticks.push_back(v);
    return ticks;
}

double round_above(double x) {
    const double ten = std::pow(10, std::floor(std::log10(std::max(x, 1e-3))));
    for (double one : {1.0, 2.0, 5.0})
        if (one * ten >= x) return one * ten;
    return 10 * ten;
}

Image draw_charts(const std::vector<Chart>& charts, int width, int height) {
    auto own = [](const Chart& chart) { return chart.own_axes || !chart.bars.empty(); };
    Axes shared;
    for (const auto& chart : charts)
        if (!own(chart) && chart.logarithmic) shared.y.logarithmic = true;
    for (const auto& chart : charts)
        if (!own(chart)) shared.add(chart);
    shared.y.widen();
    std::vector<Key> keys;  // a name once, the last chart's after those that it lacks
    for (auto chart = charts.rbegin(); chart != charts.rend(); ++chart)
        if (!chart->own_legend) add_keys(*chart, keys);
    std::vector<Image> images;
    for (const auto& chart : charts) {
        Axes axes = shared;
        if (own(chart)) {
            axes = Axes();
            axes.y.logarithmic = chart.logarithmic;
            axes.add(chart);
            axes.y.widen();
            if (!chart.bars.empty()) axes.x.widen();
        }
        std::vector<Key> legend;
        if (chart.own_legend)
            add_keys(chart, legend);
        else if (&chart == &charts.back())
            legend = keys;
        images.push_back(draw_chart(chart, axes, width, height, legend));
    }
    return side_by_side(images);
}

}  // namespace wetcurl

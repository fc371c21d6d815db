// Inline SVG: axes, marks, labels that keep out of each other's way.
#include "app/report/report_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "app/drawing/chart.h"
#include "app/report/markup.h"

namespace wetcurl {

namespace {

constexpr double width = 960, height = 470, left = 62, right = 24, top = 18, bottom = 50;
constexpr double letter_width = 7.2, letter_height = 13;  // of a label of 12 pixels

struct Rectangle {
    double x0, y0, x1, y1;
    bool meets(const Rectangle& o) const { return x0 < o.x1 && o.x0 < x1 && y0 < o.y1 && o.y0 < y1; }
};

// Characters, not bytes.
size_t letters_of(const std::string& text) {
    return size_t(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string begin_svg(const std::string& title) {
    return fmt::format("<svg class=\"chart\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n", width,
                       height, escaped(title));
}
std::string line(const char* kind, double x0, double y0, double x1, double y1) {
    return fmt::format("<line class=\"{}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>\n", kind,
                       x0, y0, x1, y1);
}
std::string text(const char* kind, double x, double y, const char* anchor, const std::string& words) {
    return fmt::format("<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", kind, x,
                       y, anchor, escaped(words));
}

// Of the axis at the left.
std::string vertical_label(const std::string& words) {
    return fmt::format(
        "<text class=\"axis\" transform=\"translate(15 {:.1f}) rotate(-90)\" "
        "text-anchor=\"middle\">{}</text>\n",
        (top + height - bottom) / 2, escaped(words));
}

// A circle, square or diamond: kinds differ without their colours.
std::string mark(const std::string& kind, double x, double y, bool hollow) {
    const std::string classes = escaped(kind) + (hollow ? " hollow" : "");
    if (kind == "learned")
        return fmt::format("<circle class=\"mark {}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5.5\"/>", classes, x,
                           y);
    const double r = 4.8;
    const bool turned = kind == "simulated";
    return fmt::format("<rect class=\"mark {}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{}\" height=\"{}\"{}/>",
                       classes, x - r, y - r, 2 * r, 2 * r,
                       turned ? fmt::format(" transform=\"rotate(45 {:.1f} {:.1f})\"", x, y) : "");
}

// An axis of logarithms over pixels.
struct LogAxis {
    double low, high, from, to;  // log10; pixels
    double at(double value) const { return from + (std::log10(value) - low) / (high - low) * (to - from); }
};

// A little more than what is shown, a decade at the least.
LogAxis log_axis(const std::vector<double>& values, double from, double to) {
    double low = 1e9, high = -1e9;
    for (double v : values) low = std::min(low, std::log10(v)), high = std::max(high, std::log10(v));
    const double more = std::max(0.12, 0.08 * (high - low)), missing = std::max(0.0, 1 - (high - low)) / 2;
    return {low - std::max(more, missing), high + std::max(more, missing), from, to};
}

std::vector<double> log_ticks(const LogAxis& axis) {
    return log_ticks_between(std::pow(10, axis.low), std::pow(10, axis.high));
}

// Labels beside marks: each takes the first of the places around its mark that is free.
class Labels {
  public:
    explicit Labels(std::vector<Rectangle> taken) : taken_(std::move(taken)) {}
    std::string put(const std::string& words, double x, double y) {
        const double w = letter_width * double(letters_of(words)), h = letter_height;
        for (double away : {0.0, 12.0, 26.0, 42.0, 60.0})
            for (const auto& [dx, dy] :
                 {std::pair{1, -1}, {-1, 1}, {1, 1}, {-1, -1}, {1, 0}, {-1, 0}, {0, -1}, {0, 1}}) {
                if (away > 0 && dy == 0) continue;
                const double centre_y = y + dy * (h / 2 + 5 + away), start = dx > 0   ? x + (dy ? 5 : 10)
                                                                             : dx < 0 ? x - w - (dy ? 5 : 10)
                                                                                      : x - w / 2;
                const Rectangle box{start, centre_y - h / 2, start + w, centre_y + h / 2};
                if (box.x0 < left + 2 || box.x1 > width - 2 || box.y0 < top || box.y1 > height - bottom - 2 ||
                    std::any_of(taken_.begin(), taken_.end(), [&](const auto& t) { return t.meets(box); }))
                    continue;
                taken_.push_back(box);
                // One that had to go far off is led back.
                const std::string lead = away > 0 ? line("lead", x + dx * 4, y + dy * 5,
                                                         dx > 0   ? start
                                                         : dx < 0 ? start + w
                                                                  : x,
                                                         centre_y - dy * h / 2)
                                                  : "";
                return lead + text("label", start, centre_y + 4, "start", words);
            }
        return text("label", std::min(x + 10, width - w), y + 4, "start", words);
    }

  private:
    std::vector<Rectangle> taken_;
};

}  // namespace

std::string cost_chart(const Rows& rows) {
    std::vector<double> times, errors;
    const auto shown = [](double mm) { return std::max(mm, best_cost.mm); };
    const auto took = [](double s) { return std::max(s, best_cost.seconds); };
    for (const Row& row : rows.all) times.push_back(took(row.seconds())), errors.push_back(shown(row.mm()));
    if (rows.seconds_reference > 0) times.push_back(took(rows.seconds_reference));
    const LogAxis x = log_axis(times, left, width - right), y = log_axis(errors, height - bottom, top);
    std::string svg = begin_svg("Error against run time");

    for (double v : log_ticks(x)) {
        svg += line("grid", x.at(v), top, x.at(v), height - bottom);
        svg += text("tick", x.at(v), height - bottom + 18, "middle", fmt::format("{:.4g}", 1e3 * v));
    }
    for (double v : log_ticks(y)) {
        svg += line("grid", left, y.at(v), width - right, y.at(v));
        svg += text("tick", left - 8, y.at(v) + 4, "end", fmt::format("{:.4g}", v));
    }
    svg += text("axis", (left + width - right) / 2, height - 8, "middle", "time a frame [ms]");
    svg += vertical_label("mean error [mm]");

    std::vector<Rectangle> taken;  // where no label goes
    // From the first of the front straight up, along the steps, and out to the right.
    std::vector<std::pair<double, double>> corners;
    for (const auto& name : rows.front)
        for (const Row& row : rows.all)
            if (row.name == name) {
                const double px = x.at(took(row.seconds())), py = y.at(shown(row.mm()));
                corners.emplace_back(px, corners.empty() ? top : corners.back().second);
                corners.emplace_back(px, py);
            }
    if (!corners.empty()) {
        corners.emplace_back(width - right, corners.back().second);
        for (size_t k = 1; k < corners.size(); ++k) {
            const auto [x0, x1] = std::minmax(corners[k - 1].first, corners[k].first);
            const auto [y0, y1] = std::minmax(corners[k - 1].second, corners[k].second);
            taken.push_back({x0 - 1, y0 - 1, x1 + 1, y1 + 1});
        }
        std::string points;
        for (const auto& [px, py] : corners) points += fmt::format("{:.1f},{:.1f} ", px, py);
        svg += fmt::format("<polygon class=\"bettered\" points=\"{}{:.1f},{:.1f}\"/>\n", points,
                           width - right, top);
        svg += fmt::format("<polyline class=\"front\" points=\"{}\"/>\n", points);
    }
    if (rows.seconds_reference > 0) {
        const double at = x.at(took(rows.seconds_reference));
        svg += line("reference", at, top, at, height - bottom);
        const std::string words = "the reference's own time";
        const bool turn = at + 8 + letter_width * double(words.size()) > width - right;
        svg +=
            text("label quiet", turn ? at - 6 : at + 6, height - bottom - 8, turn ? "end" : "start", words);
        const double w = letter_width * double(words.size());
        taken.push_back(
            {turn ? at - 6 - w : at, height - bottom - 20, turn ? at : at + 6 + w, height - bottom - 4});
    }
    for (const Row& row : rows.all) {
        const double px = x.at(took(row.seconds())), py = y.at(shown(row.mm()));
        taken.push_back({px - 6, py - 6, px + 6, py + 6});
    }
    Labels labels(taken);
    std::string marks;
    for (const Row& row : rows.all) {
        const double px = x.at(took(row.seconds())), py = y.at(shown(row.mm()));
        if (row.seeds)
            marks += line("seeds", px, y.at(shown(row.seeds->most_mm)), px, y.at(shown(row.seeds->least_mm)));
        marks += fmt::format("<g><title>{}: {:.3g} mm, {}{}</title>", escaped(row.name), row.mm(),
                             time_text(row.seconds()), row.of_all_scenes() ? "" : ", of other scenes") +
                 mark(row.kind, px, py, !row.of_all_scenes()) + "</g>\n";
        svg += labels.put(row.name, px, py);
    }
    return svg + marks + "</svg>\n";
}

std::string error_chart(const std::vector<ErrorCurve>& curves, double start, double step,
                        const std::string& x_label) {
    size_t frames = 1, letters = 4;
    double most = 1e-6;
    for (const auto& curve : curves) {
        frames = std::max(frames, curve.mm.size());
        letters = std::max(letters, letters_of(curve.name));
        for (double mm : curve.mm) most = std::max(most, mm);
    }
    const double end = width - std::min(300.0, 14 + letter_width * double(letters));
    const double first = start, last = start + double(std::max<size_t>(frames, 2) - 1) * step;
    const auto px = [&](double v) { return left + (v - first) / (last - first) * (end - left); };
    const auto py = [&](double mm) { return height - bottom - mm / (1.05 * most) * (height - bottom - top); };
    std::string svg = begin_svg("Error over time");
    for (double v : ticks_between(0, 1.05 * most, 6)) {
        svg += line(v == 0 ? "zero" : "grid", left, py(v), end, py(v));
        svg += text("tick", left - 8, py(v) + 4, "end", fmt::format("{:.4g}", v));
    }
    for (double v : ticks_between(first, last, 8)) {
        svg += line("grid", px(v), height - bottom, px(v), height - bottom + 5);
        svg += text("tick", px(v), height - bottom + 18, "middle", fmt::format("{:.4g}", v));
    }
    svg += text("axis", (left + end) / 2, height - 8, "middle", x_label);
    svg += vertical_label("mean error [mm]");
    std::vector<double> ends;
    std::map<std::string, int> of_kind;  // those of one kind differ by their dashes
    for (const auto& curve : curves) {
        std::string points;
        for (size_t k = 0; k < curve.mm.size(); ++k)
            points += fmt::format("{:.1f},{:.1f} ", px(start + double(k) * step), py(curve.mm[k]));
        svg += fmt::format("<g><title>{}</title><polyline class=\"curve {} dash{}\" points=\"{}\"/></g>\n",
                           escaped(curve.name), escaped(curve.kind), of_kind[curve.kind]++ % 4, points);
        ends.push_back(curve.mm.empty() ? py(0) : py(curve.mm.back()));
    }
    const auto places = spread_apart(ends, letter_height + 1, top, height - bottom);
    for (size_t k = 0; k < curves.size(); ++k) {
        const double x = curves[k].mm.empty() ? left : px(start + double(curves[k].mm.size() - 1) * step);
        svg += line("lead", x + 2, ends[k], end + 10, places[k]);
        svg += text(("label ink-" + escaped(curves[k].kind)).c_str(), end + 13, places[k] + 4, "start",
                    curves[k].name);
    }
    return svg + "</svg>\n";
}

std::string training_chart_svg(const TrainingLog& log) {
    const std::map<std::string, const char*> classes{
        {"training", "training"}, {"held out", "learned"}, {"no network", "quiet-curve dash1"}};
    std::vector<double> values;
    double first = 1e300, last = 0;
    size_t letters = 4;
    for (const auto& s : log.series) {
        for (double v : s.value)
            if (v > 0) values.push_back(v);
        first = std::min(first, s.epoch.front()), last = std::max(last, s.epoch.back());
        letters = std::max(letters, letters_of(s.name) + 10);
    }
    if (values.empty()) values = {1};
    if (!(last > first)) last = first + 1;
    const double end = width - 14 - letter_width * double(letters);
    const LogAxis y = log_axis(values, height - bottom, top);
    const auto px = [&](double epoch) { return left + (epoch - first) / (last - first) * (end - left); };
    const auto py = [&](double v) { return y.at(std::max(v, std::pow(10, y.low))); };
    std::string svg = begin_svg("Training of " + log.name);
    for (double v : log_ticks(y)) {
        svg += line("grid", left, y.at(v), end, y.at(v));
        svg += text("tick", left - 8, y.at(v) + 4, "end", fmt::format("{:.4g}", v));
    }
    for (double v : ticks_between(first, last, 8)) {
        svg += line("grid", px(v), height - bottom, px(v), height - bottom + 5);
        svg += text("tick", px(v), height - bottom + 18, "middle", fmt::format("{:.4g}", v));
    }
    svg += text("axis", (left + end) / 2, height - 8, "middle", "epoch");
    svg += vertical_label(log.label());
    std::vector<double> ends;
    for (const auto& s : log.series) {
        std::string points;
        for (size_t k = 0; k < s.value.size(); ++k)
            points += fmt::format("{:.1f},{:.1f} ", px(s.epoch[k]), py(s.value[k]));
        svg += fmt::format("<g><title>{}</title><polyline class=\"curve {}\" points=\"{}\"/></g>\n",
                           escaped(s.name), classes.at(s.name), points);
        ends.push_back(py(s.value.back()));
    }
    const auto places = spread_apart(ends, letter_height + 1, top, height - bottom);
    for (size_t k = 0; k < log.series.size(); ++k) {
        const auto& s = log.series[k];
        svg += line("lead", px(s.epoch.back()) + 2, ends[k], end + 10, places[k]);
        svg +=
            text("label", end + 13, places[k] + 4, "start", fmt::format("{} {:.3g}", s.name, s.value.back()));
    }
    return svg + "</svg>\n";
}

std::vector<double> spread_apart(const std::vector<double>& places, double gap, double low, double high) {
    std::vector<size_t> order(places.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return places[a] < places[b]; });
    std::vector<double> out = places;
    // Down from the lowest that is allowed, then up from the highest.
    double least = low;
    for (size_t k : order) out[k] = std::max(out[k], least), least = out[k] + gap;
    double most = high;
    for (auto k = order.rbegin(); k != order.rend(); ++k)
        out[*k] = std::min(out[*k], most), most = out[*k] - gap;
    return out;
}

}  // namespace wetcurl

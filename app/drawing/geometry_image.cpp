// Draws geometry images.
#include "app/drawing/geometry_image.h"

#include <algorithm>

#include "app/drawing/image_file.h"

namespace wetcurl {

float GeometryPanel::colour(int channel, size_t pixel) const {
    return std::clamp(middle + gain * values[size_t(channel) * pixels() + pixel], 0.f, 1.f);
}

int enlargement(int height, int width, int least) {
    constexpr int most = 8192;
    const int wanted = (least + std::min(height, width) - 1) / std::min(height, width);
    return std::max(1, std::min(wanted, most / std::max(height, width)));
}

float neutral_grey(int column, int row) { return (column + row) / 6 % 2 ? 0.90f : 0.82f; }

Image enlarged(const GeometryPanel& panel, int times) {
    Image image(times * panel.width, times * panel.height);
    for (int row = 0; row < image.height; ++row)
        for (int column = 0; column < image.width; ++column) {
            const size_t pixel = size_t(row / times) * size_t(panel.width) + size_t(column / times);
            for (int c = 0; c < 3; ++c)
                image.pixel(column, row)[c] =
                    panel.mask[pixel] ? panel.colour(c, pixel) : neutral_grey(column, row);
        }
    return image;
}

GeometryPanel without_padding(const GeometryPanel& panel) {
    GeometryPanel out = panel;
    out.height = out.width = 0;
    for (int row = 0; row < panel.height; ++row)
        for (int column = 0; column < panel.width; ++column)
            if (panel.mask[size_t(row) * size_t(panel.width) + size_t(column)])
                out.height = std::max(out.height, row + 1), out.width = std::max(out.width, column + 1);
    if (out.height == 0) return panel;
    out.height = std::min(out.height + 1, panel.height), out.width = std::min(out.width + 1, panel.width);
    out.mask.clear(), out.values.clear();
    const auto cut = [&](auto& to, const auto& from, int channel) {
        for (int row = 0; row < out.height; ++row) {
            const auto begin = from.begin() + (long(channel) * panel.height + row) * panel.width;
            to.insert(to.end(), begin, begin + out.width);
        }
    };
    cut(out.mask, panel.mask, 0);
    for (int channel = 0; channel < 3; ++channel) cut(out.values, panel.values, channel);
    return out;
}

namespace {

void paste(Image& onto, const Image& image, int left, int top) {
    for (int row = 0; row < image.height; ++row)
        std::copy_n(image.pixel(0, row), 3 * size_t(image.width), onto.pixel(left, top + row));
}

// Drawn at `letter` where it fits into `room` pixels; smaller, or without its middle, where not.
void draw_caption(Image& image, const std::string& text, int left, int row, int room, double letter) {
    const double smallest = 0.8 * letter;
    while (letter > smallest && text_width(text, letter) > room) letter *= 0.97;
    std::string shown = text;
    for (size_t kept = text.size(); kept > 8 && text_width(shown, letter) > room; --kept)
        shown = text.substr(0, kept / 2) + ".." + text.substr(text.size() - (kept - kept / 2));
    draw_text(image, shown, left, row, letter, 0);
}

}  // namespace

Image draw_geometry(const std::vector<GeometryPanel>& given, int least) {
    std::vector<GeometryPanel> panels;
    for (const GeometryPanel& panel : given) panels.push_back(without_padding(panel));
    int side = least;  // the smaller side of the largest
    for (const auto& p : panels)
        side = std::max(side, enlargement(p.height, p.width, least) * std::min(p.height, p.width));
    std::vector<Image> pictures;
    int height = 0, width = 0;
    size_t lines = 0;
    const int gap = std::max(12, side / 24);
    for (const auto& p : panels) {
        // As near to the largest as whole pixels allow.
        const int times = std::max(
            enlargement(p.height, p.width, least),
            std::min(side / std::min(p.height, p.width), std::max(1, 8192 / std::max(p.height, p.width))));
        pictures.push_back(enlarged(p, times));
        height = std::max(height, pictures.back().height);
        width += pictures.back().width + gap;
        lines = std::max(lines, p.caption.size());
    }
    const double letter = std::max(11.0, side / 37.0);
    Image out(width + gap, gap + height + int((1.55 * double(lines) + 1.2) * letter));
    std::fill(out.rgb.begin(), out.rgb.end(), 1.f);
    int left = gap;
    for (size_t k = 0; k < panels.size(); ++k) {
        paste(out, pictures[k], left, gap);
        for (size_t line = 0; line < panels[k].caption.size(); ++line)
            draw_caption(out, panels[k].caption[line], left - 4,
                         gap + height + int((1.55 * double(line) + 1.6) * letter),
                         pictures[k].width + gap - 6, line == 0 ? 1.08 * letter : letter);
        left += pictures[k].width + gap;
    }
    return out;
}

}  // namespace wetcurl

// Writing strand files.
#include "solver/grooms/writers.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "base/error.h"
#include "base/log.h"
#include "base/number_text.h"
#include "base/strands.h"

namespace wetcurl {
namespace {

void put_points(ByteWriter& out, const std::vector<Vec3d>& strand) {
    for (const auto& x : strand) out.put(cast<float>(x));
}

// Whole numbers of 32 bits count points in most formats.
uint32_t total_points(const StrandsOut& in) {
    size_t sum = 0;
    for (const auto& strand : in.strands) sum += strand.size();
    constexpr size_t most = 0x7fffffff;
    if (sum > most || in.strands.size() > most)
        throw Error(in.path + ": found " + std::to_string(sum) +
                    " points, allowed at most 2147483647 in a file");
    return uint32_t(sum);
}

void append_point(std::string& text, const Vec3d& x) {
    append_number(text, float(x.x));
    for (double c : {x.y, x.z}) {
        text += ' ';
        append_number(text, float(c));
    }
}

}  // namespace

void write_data(ByteWriter& out, const StrandsOut& in) {
    out.put(int32_t(in.strands.size()));
    for (const auto& strand : in.strands) {
        out.put(int32_t(strand.size()));
        put_points(out, strand);
    }
}

void write_hair(ByteWriter& out, const StrandsOut& in) {
    constexpr uint32_t segments_and_points = 3, thickness = 4;
    for (size_t s = 0; s < in.strands.size(); ++s)
        if (in.strands[s].size() > 65536)
            throw Error("strand " + std::to_string(s) + ": found " + std::to_string(in.strands[s].size()) +
                        " points, allowed at most 65536 in a .hair file");
    for (char c : {'H', 'A', 'I', 'R'}) out.put(c);
    for (uint32_t value : {uint32_t(in.strands.size()), total_points(in),
                           segments_and_points + (in.widths.empty() ? 0 : thickness), 0u})
        out.put(value);
    for (float value : {usual_width, 0.0f, 0.4f, 0.3f, 0.2f}) out.put(value);
    char text[88] = {};
    ("wetcurl: " + in.unit + ", Y up").copy(text, sizeof text - 1);
    out.put(text);
    for (const auto& strand : in.strands) out.put(uint16_t(strand.size() - 1));
    for (const auto& strand : in.strands) put_points(out, strand);
    for (const auto& strand : in.widths)
        for (float width : strand) out.put(width);
}

void write_ply(ByteWriter& out, const StrandsOut& in) {
    const uint32_t points = total_points(in);
    out.text("ply\nformat binary_little_endian 1.0\ncomment wetcurl: strands, " + in.unit +
             ", Y up, root first\n");
    out.text("element vertex " + std::to_string(points) +
             "\nproperty float x\nproperty float y\nproperty float z\nproperty float width\n");
    out.text("element edge " + std::to_string(points - uint32_t(in.strands.size())) +
             "\nproperty int vertex1\nproperty int vertex2\nend_header\n");
    for (size_t s = 0; s < in.strands.size(); ++s)
        for (size_t i = 0; i < in.strands[s].size(); ++i) {
            out.put(cast<float>(in.strands[s][i]));
            out.put(in.width(s, i));
        }
    int32_t vertex = 0;
    for (const auto& strand : in.strands) {
        for (size_t i = 1; i < strand.size(); ++i, ++vertex) {
            out.put(vertex);
            out.put(vertex + 1);
        }
        ++vertex;
    }
}

void write_obj(ByteWriter& out, const StrandsOut& in) {
    total_points(in);
    out.text("# wetcurl: strands, " + in.unit + ", Y up, root first\n");
    std::string text;
    for (const auto& strand : in.strands)
        for (const auto& x : strand) {
            text.clear();
            text += "v ";
            append_point(text, x);
            out.text(text += '\n');
        }
    size_t vertex = 1;
    for (const auto& strand : in.strands) {
        text.clear();
        text += 'l';
        for (size_t i = 0; i < strand.size(); ++i) {
            text += ' ';
            append_number(text, vertex++);
        }
        out.text(text += '\n');
    }
}

void write_tfx(ByteWriter& out, const StrandsOut& in) {
    constexpr size_t fewest = 4, most = 64;
    size_t longest = 0, shortest = most;
    for (const auto& strand : in.strands)
        longest = std::max(longest, strand.size()), shortest = std::min(shortest, strand.size());
    const size_t each = std::clamp(std::bit_ceil(longest), fewest, most);
    const bool resample = longest != each || shortest != each;
    if (resample)
        log_info(in.path + ": strands of " + std::to_string(shortest) + " to " + std::to_string(longest) +
                 " points are resampled to " + std::to_string(each) +
                 ": TressFX asks for 4, 8, 16, 32 or 64 points, as many in each strand");
    constexpr uint32_t header = 160;
    const size_t count = in.strands.size(), bytes = count * each * 4 * sizeof(float);
    if (header + bytes > 0xffffffff)
        throw Error(in.path + ": found " + std::to_string(count) +
                    " strands, allowed are as many as fit into 4 GiB of a .tfx file");
    out.put(4.0f);
    // Strands, their points, and the offsets of: positions, uv of strands and of vertices (none), thickness,
    // colours (none).
    for (uint32_t value : {uint32_t(count), uint32_t(each), header, 0u, 0u, uint32_t(header + bytes), 0u})
        out.put(value);
    const char reserved[128] = {};
    out.put(reserved);
    for (size_t s = 0; s < count; ++s) {
        const std::vector<Vec3d> strand = resample ? resampled(in.strands[s], int(each)) : in.strands[s];
        for (size_t i = 0; i < each; ++i) {
            out.put(cast<float>(strand[i]));
            out.put(i < 2 ? 0.0f : 1.0f);  // inverse mass: the first two are held
        }
    }
    for (size_t s = 0; s < count; ++s)
        out.put(in.widths.empty() ? usual_width
                                  : *std::max_element(in.widths[s].begin(), in.widths[s].end()));
}

// Pieces between points, with the tangents of a uniform Catmull-Rom spline.
void write_pbrt(ByteWriter& out, const StrandsOut& in) {
    out.text("# wetcurl: strands, " + in.unit + ", Y up, root first; widths are diameters\n");
    std::string text;
    for (size_t s = 0; s < in.strands.size(); ++s) {
        const auto& p = in.strands[s];
        const size_t last = p.size() - 1;
        auto third = [&](size_t i) {
            return (1 / (i == 0 || i == last ? 3.0 : 6.0)) *
                   (p[std::min(i + 1, last)] - p[i == 0 ? 0 : i - 1]);
        };
        text = "Shape \"curve\" \"string type\" \"cylinder\" \"string basis\" \"bezier\" \"point3 P\" [";
        append_point(text, p[0]);
        for (size_t i = 0; i < last; ++i)
            for (const Vec3d& x : {p[i] + third(i), p[i + 1] - third(i + 1), p[i + 1]}) {
                text += "  ";
                append_point(text, x);
            }
        text += "] \"float width0\" ";
        append_number(text, in.width(s, 0));
        text += " \"float width1\" ";
        append_number(text, in.width(s, last));
        out.text(text += '\n');
    }
}

}  // namespace wetcurl

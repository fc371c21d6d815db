// Readers of strand files, binary ones: .hair, .data, .bin, .tfx. Little-endian throughout.
#include "solver/grooms/readers.h"

#include <bit>
#include <cstdint>

#include "solver/grooms/byte_reader.h"

namespace wetcurl {

static_assert(std::endian::native == std::endian::little, "strand files are little-endian");

// i32 strands; per strand i32 points, then `floats` f32 a point, of which the first three are x, y, z.
static StrandFile read_counted(const std::string& path, size_t floats) {
    ByteReader in(path);
    StrandFile out;
    StrandPoints& strands = out.points;
    strands.resize(in.fitting(in.take<int32_t>("the number of strands"), sizeof(int32_t), "strands"));
    for (size_t s = 0; s < strands.size(); ++s) {
        strands[s].resize(in.fitting(in.take<int32_t>("the number of points of a strand"),
                                     floats * sizeof(float), "points in a strand"));
        for (size_t i = 0; i < strands[s].size(); ++i) {
            strands[s][i] = in.point(s, i);
            in.skip((floats - 3) * sizeof(float), "a point");
        }
    }
    in.finish();
    return out;
}

StrandFile read_data(const std::string& path) { return read_counted(path, 3); }
StrandFile read_bin(const std::string& path) { return read_counted(path, 7); }

StrandFile read_hair(const std::string& path) {
    constexpr size_t header = 128;
    constexpr uint32_t has_segments = 1, has_points = 2, has_thickness = 4, has_transparency = 8,
                       has_colours = 16;
    ByteReader in(path);
    char magic[5] = {};
    for (int i = 0; i < 4; ++i) magic[i] = in.take<char>("the signature");
    if (std::string text = magic; text != "HAIR" && text != "hair")
        in.fail_at("byte 0", "another signature", "\"HAIR\": this is no .hair file");
    const auto strands = in.take<uint32_t>("the number of strands"),
               points = in.take<uint32_t>("the number of points"),
               arrays = in.take<uint32_t>("the list of arrays"),
               default_segments = in.take<uint32_t>("default segments");
    if (!(arrays & has_points) || arrays > 31)
        in.fail_at("byte 12", "arrays " + std::to_string(arrays),
                   "a sum of 1, 2, 4, 8, 16 with 2 (points) in it");
    in.seek(header, "the arrays");
    in.fitting(points, 3 * sizeof(float), "points");

    std::vector<size_t> sizes;
    if (arrays & has_segments) {
        sizes.resize(in.fitting(strands, sizeof(uint16_t), "strands"));
        for (auto& size : sizes) size = in.take<uint16_t>("the segments of a strand") + size_t(1);
    } else if (const size_t each = default_segments + size_t(1); each * strands == points) {
        sizes.assign(strands, each);
    }
    size_t sum = 0;
    for (size_t size : sizes) sum += size;
    if (sum != points)
        in.fail_at("byte 8", std::to_string(points) + " points", "the sum of segments + 1 over the strands");

    StrandFile out;
    out.points.resize(sizes.size());
    for (size_t s = 0; s < sizes.size(); ++s)
        for (size_t i = 0; i < sizes[s]; ++i) out.points[s].push_back(in.point(s, i));
    if (arrays & has_thickness) {
        out.widths.resize(sizes.size());
        for (size_t s = 0; s < sizes.size(); ++s)
            for (size_t i = 0; i < sizes[s]; ++i) out.widths[s].push_back(in.take<float>("thickness"));
    }
    const size_t others = bool(arrays & has_transparency) + 3 * bool(arrays & has_colours);
    in.skip(others * sizeof(float) * points, "transparency and colours");
    in.finish();
    return out;
}

StrandFile read_tfx(const std::string& path) {
    ByteReader in(path);
    if (const float version = in.take<float>("the version"); version != 4.0f)
        in.fail_at("byte 0", "version " + std::to_string(version), "4.0: this is no TressFX 4 file");
    const auto strands = in.take<uint32_t>("the number of strands"),
               each = in.take<uint32_t>("vertices of a strand");
    if (each < 4 || each > 64 || !std::has_single_bit(each))
        in.fail_at("byte 8", std::to_string(each) + " vertices a strand", "4, 8, 16, 32, 64");
    const auto offset = in.take<uint32_t>("the offset of positions"),
               offset_uv = in.take<uint32_t>("the offset of uv of strands");
    in.skip(sizeof(uint32_t), "the offset of uv of vertices");
    const auto offset_thickness = in.take<uint32_t>("the offset of thickness");
    constexpr size_t header = 160;
    if (offset < header)
        in.fail_at("byte 12", "offset of positions " + std::to_string(offset), "160 or more");
    in.seek(offset, "positions");
    StrandFile out;
    out.points.resize(in.fitting(strands, each * 4 * sizeof(float), "strands"));
    for (size_t s = 0; s < strands; ++s)
        for (size_t i = 0; i < each; ++i) {
            out.points[s].push_back(in.point(s, i));
            in.skip(sizeof(float), "a vertex's weight");
        }
    // An offset of 0: not in the file.
    if (offset_uv != 0) {
        in.seek(offset_uv, "uv of strands");
        out.root_uv.resize(in.fitting(strands, 2 * sizeof(float), "uv of strands"));
        for (auto& [u, v] : out.root_uv) u = in.take<float>("uv"), v = in.take<float>("uv");
    }
    if (offset_thickness != 0) {
        in.seek(offset_thickness, "thickness of strands");
        in.fitting(strands, sizeof(float), "thicknesses of strands");
        for (size_t s = 0; s < strands; ++s) out.widths.emplace_back(each, in.take<float>("thickness"));
    }
    return out;
}

}  // namespace wetcurl

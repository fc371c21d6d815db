// Small strand files of every format, whole or broken on purpose, for the tests of their readers.
#pragma once

#include <cstdint>
#include <cstring>

#include "solver/grooms/readers.h"
#include "tests/base/scratch.h"

namespace wetcurl::testing {

class Bytes {
  public:
    template <class T>
    Bytes& put(T value) {
        text_.append(reinterpret_cast<const char*>(&value), sizeof value);
        return *this;
    }
    Bytes& text(const std::string& more) {
        text_ += more;
        return *this;
    }
    Bytes& point(const Vec3d& x) { return put(float(x.x)).put(float(x.y)).put(float(x.z)); }
    const std::string& str() const { return text_; }

  private:
    std::string text_;
};

template <class T>
std::string patched(std::string bytes, size_t offset, T value) {
    std::memcpy(bytes.data() + offset, &value, sizeof value);
    return bytes;
}

// Strands of `points` points each, coordinates exact in single precision and in ascii.
inline StrandPoints sample_strands(size_t count = 3, size_t points = 4) {
    StrandPoints out(count);
    for (size_t s = 0; s < count; ++s)
        for (size_t i = 0; i < points; ++i)
            out[s].push_back({0.125 * double(s), 0.5 - 0.0625 * double(i), 0.25 * double(i % 2)});
    return out;
}

inline std::string data_file(const StrandPoints& strands, size_t floats = 3) {
    Bytes b;
    b.put(int32_t(strands.size()));
    for (const auto& strand : strands) {
        b.put(int32_t(strand.size()));
        for (const auto& x : strand) {
            b.point(x);
            for (size_t k = 3; k < floats; ++k) b.put(float(k));
        }
    }
    return b.str();
}
inline std::string bin_file(const StrandPoints& strands) { return data_file(strands, 7); }

inline uint32_t total(const StrandPoints& strands) {
    uint32_t sum = 0;
    for (const auto& strand : strands) sum += uint32_t(strand.size());
    return sum;
}

// `arrays` as in the header: 1 segments, 2 points, 4 thickness, 8 transparency, 16 colours.
inline std::string hair_file(const StrandPoints& strands, uint32_t arrays = 3,
                             const std::string& magic = "HAIR") {
    const uint32_t each = strands.empty() ? 0 : uint32_t(strands[0].size()) - 1;
    Bytes b;
    b.text(magic)
        .put(uint32_t(strands.size()))
        .put(total(strands))
        .put(arrays)
        .put(each)
        .text(std::string(108, '\0'));
    if (arrays & 1)
        for (const auto& strand : strands) b.put(uint16_t(strand.size() - 1));
    for (const auto& strand : strands)
        for (const auto& x : strand) b.point(x);
    const uint32_t others = ((arrays >> 2) & 1) + ((arrays >> 3) & 1) + 3 * ((arrays >> 4) & 1);
    for (uint32_t k = 0; k < others * total(strands); ++k) b.put(0.5f);
    return b.str();
}

inline std::string tfx_file(const StrandPoints& strands) {
    Bytes b;
    b.put(4.0f)
        .put(uint32_t(strands.size()))
        .put(strands.empty() ? 4u : uint32_t(strands[0].size()))
        .put(160u);
    b.text(std::string(144, '\0'));
    for (const auto& strand : strands)
        for (const auto& x : strand) b.point(x).put(1.0f);
    return b.str();
}

inline std::string ply_header(const std::string& format, uint32_t vertices, uint32_t strands) {
    return "ply\nformat " + format + " 1.0\ncomment made for a test\nelement vertex " +
           std::to_string(vertices) +
           "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nelement strand " +
           std::to_string(strands) + "\nproperty ushort nsegs\nend_header\n";
}
inline std::string ply_binary_file(const StrandPoints& strands) {
    Bytes b;
    b.text(ply_header("binary_little_endian", total(strands), uint32_t(strands.size())));
    for (const auto& strand : strands)
        for (const auto& x : strand) b.point(x).put(uint8_t(7));
    for (const auto& strand : strands) b.put(uint16_t(strand.size() - 1));
    return b.str();
}
inline std::string ply_ascii_file(const StrandPoints& strands) {
    std::ostringstream out;
    out << ply_header("ascii", total(strands), uint32_t(strands.size()));
    for (const auto& strand : strands)
        for (const auto& x : strand) out << x.x << ' ' << x.y << ' ' << x.z << " 7\n";
    for (const auto& strand : strands) out << strand.size() - 1 << '\n';
    return out.str();
}

// One row a format: what the laws of reading are tested over.
struct StrandFormat {
    const char *name, *ending;
    std::string (*make)(const StrandPoints&);
    StrandFile (*read)(const std::string&);
    size_t count_at;         // byte of the number of strands; 0: in text
    bool ends_with_strands;  // bytes after the last strand are an error
};
inline void PrintTo(const StrandFormat& format, std::ostream* out) { *out << format.name; }
inline constexpr StrandFormat strand_formats[] = {
    {"data", ".data", [](const StrandPoints& s) { return data_file(s); }, read_data, 0, true},
    {"bin", ".bin", bin_file, read_bin, 0, true},
    {"hair", ".hair", [](const StrandPoints& s) { return hair_file(s); }, read_hair, 4, true},
    {"tfx", ".tfx", tfx_file, read_tfx, 4, false},
    {"ply_binary", ".ply", ply_binary_file, read_ply, std::string::npos, true},
    {"ply_ascii", ".ply", ply_ascii_file, read_ply, std::string::npos, true}};

inline bool same(const StrandPoints& a, const StrandPoints& b) {
    if (a.size() != b.size()) return false;
    for (size_t s = 0; s < a.size(); ++s) {
        if (a[s].size() != b[s].size()) return false;
        for (size_t i = 0; i < a[s].size(); ++i)
            if (norm(a[s][i] - b[s][i]) != 0) return false;
    }
    return true;
}

}  // namespace wetcurl::testing

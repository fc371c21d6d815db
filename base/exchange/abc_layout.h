// How Alembic lays out headers of properties: what its writer and its reader share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace wetcurl {

// Types of numbers, as files number them.
enum class Pod : uint32_t {
    boolean,
    uint8,
    int8,
    uint16,
    int16,
    uint32,
    int32,
    uint64,
    int64,
    float16,
    float32,
    float64,
    string,
    wide_string
};
inline constexpr uint32_t pods = 14;
// [bytes] of one; 0 for texts.
inline constexpr size_t bytes_of_pod[pods] = {1, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8, 0, 0};
inline constexpr std::string_view name_of_pod[pods] = {
    "bool_t",   "uint8_t", "int8_t",    "uint16_t",  "int16_t",   "uint32_t", "int32_t",
    "uint64_t", "int64_t", "float16_t", "float32_t", "float64_t", "string",   "wstring"};

// The four bytes that a property's header begins with. Bits 2 and 3: whether the numbers after them have 1, 2
// or 4 bytes (0, 1, 2).
namespace property_bits {
inline constexpr uint32_t kind = 0x3;  // 0 compound, 1 scalar, 2 array, 3 array of one element in each sample
inline constexpr int width_shift = 2, pod_shift = 4, extent_shift = 12, metadata_shift = 20;
inline constexpr uint32_t has_sampling = 0x100;  // not time sampling 0
inline constexpr uint32_t has_changes = 0x200;   // the first and the last change follow
inline constexpr uint32_t same_size = 0x400;     // all samples have as many elements
inline constexpr uint32_t constant = 0x800;
}  // namespace property_bits

// Metadata that is not in the file's table of texts, but in the header itself.
inline constexpr uint32_t metadata_in_header = 255;

// An array of samples at times of its own, not at regular ones, has this time per cycle or more [s].
inline constexpr double acyclic_seconds = 1e300;

// Kinds of curves and their bases, of the property curveBasisAndType: type, wrap, basis, basis (a byte each).
enum class AbcCurveType : uint8_t { cubic, linear, variable_order };
enum class AbcBasis : uint8_t { none, bezier, b_spline, catmull_rom, hermite, power };

// Operations of a transform: the upper four bits of its byte in .ops.
enum class AbcXformOp : uint8_t { scale, translate, rotate, matrix, rotate_x, rotate_y, rotate_z };
inline constexpr size_t xform_ops = 7;
inline constexpr size_t channels_of_xform_op[xform_ops] = {3, 3, 4, 16, 1, 1, 1};

}  // namespace wetcurl

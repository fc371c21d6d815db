// Strand .ply, ascii or binary: a header that describes every element, then their values (Turk 1994).
// Which vertices make a strand is told by `element strand {nsegs}`, as in files of strands; or by `element
// edge {vertex1, vertex2}`, as in line sets of Open3D and curves of Blender; else each 100 vertices are one.
#include <charconv>
#include <cstdint>
#include <sstream>

#include "solver/grooms/byte_reader.h"
#include "solver/grooms/chains.h"
#include "solver/grooms/readers.h"

namespace wetcurl {
namespace {

constexpr size_t implied_points = 100;

enum class Scalar { i8, u8, i16, u16, i32, u32, f32, f64 };

struct ScalarName {
    const char *name, *alias;
    Scalar type;
    size_t bytes;
};
constexpr ScalarName scalar_names[] = {
    {"char", "int8", Scalar::i8, 1},      {"uchar", "uint8", Scalar::u8, 1},
    {"short", "int16", Scalar::i16, 2},   {"ushort", "uint16", Scalar::u16, 2},
    {"int", "int32", Scalar::i32, 4},     {"uint", "uint32", Scalar::u32, 4},
    {"float", "float32", Scalar::f32, 4}, {"double", "float64", Scalar::f64, 8}};

struct Property {
    std::string name;
    ScalarName value;
    bool is_list = false;
    ScalarName length = scalar_names[0];  // of a list
};

struct Element {
    std::string name;
    long long count = 0;
    std::vector<Property> properties;

    int find(const std::string& property) const {
        for (size_t i = 0; i < properties.size(); ++i)
            if (properties[i].name == property && !properties[i].is_list) return int(i);
        return -1;
    }
};

struct Header {
    bool ascii = true;
    std::vector<Element> elements;
};

ScalarName scalar_named(const ByteReader& in, const std::string& name) {
    for (const auto& row : scalar_names)
        if (name == row.name || name == row.alias) return row;
    in.fail("the type '" + name + "'", "char uchar short ushort int uint float double");
}

Property read_property(const ByteReader& in, std::istringstream& words) {
    std::string first, length, value, name;
    words >> first;
    if (first == "list") {
        words >> length >> value >> name;
        return {name, scalar_named(in, value), true, scalar_named(in, length)};
    }
    words >> name;
    return {name, scalar_named(in, first)};
}

Header read_header(ByteReader& in) {
    std::string_view first = in.line("the header");
    if (first.starts_with("\xef\xbb\xbf")) first.remove_prefix(3);  // some programs mark UTF-8 so
    if (first != "ply") in.fail_at("byte 0", "another first line", "\"ply\": this is no .ply file");
    Header header;
    bool format_seen = false;
    while (true) {
        const std::string line(in.line("the header"));
        std::istringstream words(line);
        std::string word, name;
        words >> word;
        if (word == "end_header") break;
        if (word == "comment" || word == "obj_info" || word.empty()) continue;
        if (word == "format") {
            words >> name;
            if (name != "ascii" && name != "binary_little_endian")
                in.fail("the format '" + name + "'", "ascii, binary_little_endian");
            header.ascii = name == "ascii";
            format_seen = true;
        } else if (word == "element") {
            Element element;
            if (!(words >> element.name >> element.count)) in.fail("'" + line + "'", "element NAME COUNT");
            header.elements.push_back(element);
        } else if (word == "property" && !header.elements.empty()) {
            header.elements.back().properties.push_back(read_property(in, words));
        } else {
            in.fail("'" + line.substr(0, 40) + "'",
                    "a header's line: format, element, property, comment, end_header");
        }
    }
    if (!format_seen) in.fail("no format line", "format ascii 1.0, format binary_little_endian 1.0");
    return header;
}

double binary_value(ByteReader& in, Scalar type) {
    constexpr const char* what = "a value";
    switch (type) {
        case Scalar::i8:
            return in.take<int8_t>(what);
        case Scalar::u8:
            return in.take<uint8_t>(what);
        case Scalar::i16:
            return in.take<int16_t>(what);
        case Scalar::u16:
            return in.take<uint16_t>(what);
        case Scalar::i32:
            return in.take<int32_t>(what);
        case Scalar::u32:
            return in.take<uint32_t>(what);
        case Scalar::f32:
            return in.take<float>(what);
        case Scalar::f64:
            return in.take<double>(what);
    }
    return 0;
}

double ascii_value(ByteReader& in) {
    const std::string_view text = in.token("a value");
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
        in.fail("'" + std::string(text.substr(0, 40)) + "'", "a number");
    return value;
}

// Fewest bytes that one of `element` takes: what an honest count is measured against.
size_t least_bytes(const Element& element, bool ascii) {
    size_t bytes = 0;
    for (const auto& p : element.properties) bytes += ascii ? 2 : (p.is_list ? p.length : p.value).bytes;
    return bytes;
}

// Calls row(k, values) for each of the element's `count` rows; a list counts as one value, its length.
template <class Row>
void walk(ByteReader& in, const Element& element, bool ascii, Row row) {
    const size_t least = least_bytes(element, ascii);
    if (least == 0) in.fail("no property of the element '" + element.name + "'", "one or more");
    // The last number of an ascii file may end with the file, without white space.
    const long long spare = ascii ? 1 : 0;
    in.fitting(std::max(element.count < 0 ? element.count : 0ll, element.count - spare), least,
               ("of the element '" + element.name + "'").c_str());
    auto next = [&](const ScalarName& type) { return ascii ? ascii_value(in) : binary_value(in, type.type); };
    std::vector<double> values(element.properties.size());
    for (long long k = 0; k < element.count; ++k) {
        for (size_t p = 0; p < values.size(); ++p) {
            const Property& property = element.properties[p];
            values[p] = next(property.is_list ? property.length : property.value);
            if (property.is_list)
                for (size_t n = in.fitting((long long)values[p], ascii ? 1 : property.value.bytes,
                                           "entries of a list");
                     n--;)
                    next(property.value);
        }
        row(size_t(k), values);
    }
}

size_t column_of(const ByteReader& in, const Element& element, const char* property) {
    const int found = element.find(property);
    if (found < 0)
        in.fail("no property '" + std::string(property) + "' of the element '" + element.name + "'", "one");
    return size_t(found);
}

}  // namespace

StrandFile read_ply(const std::string& path) {
    ByteReader in(path);
    const Header header = read_header(in);
    std::vector<Vec3d> vertices;
    std::vector<float> widths;  // (vertex), or none
    std::vector<size_t> sizes;  // points a strand
    std::vector<std::array<size_t, 2>> edges;
    bool strands_told = false, edges_told = false;
    long long faces = 0;
    for (const auto& element : header.elements) {
        if (element.name == "vertex") {
            const size_t x = column_of(in, element, "x"), y = column_of(in, element, "y"),
                         z = column_of(in, element, "z");
            const int width = element.find("width");
            walk(in, element, header.ascii, [&](size_t, const std::vector<double>& v) {
                vertices.push_back({v[x], v[y], v[z]});
                if (width >= 0) widths.push_back(float(v[size_t(width)]));
            });
        } else if (element.name == "strand") {
            const size_t segments = column_of(in, element, "nsegs");
            strands_told = true;
            walk(in, element, header.ascii, [&](size_t k, const std::vector<double>& v) {
                if (!(v[segments] >= 0 && v[segments] < 1e9))
                    in.fail_at("strand " + std::to_string(k), std::to_string(v[segments]) + " segments",
                               "0 or more");
                sizes.push_back(size_t(v[segments]) + 1);
            });
        } else if (element.name == "edge") {
            const size_t from = column_of(in, element, "vertex1"), to = column_of(in, element, "vertex2");
            edges_told = element.count > 0;
            walk(in, element, header.ascii, [&](size_t k, const std::vector<double>& v) {
                for (double end : {v[from], v[to]})
                    if (!(end >= 0 && end < 1e15))
                        in.fail_at("edge " + std::to_string(k), "the vertex " + std::to_string(end),
                                   "numbers of vertices");
                edges.push_back({size_t(v[from]), size_t(v[to])});
            });
        } else {
            if (element.name == "face") faces = element.count;
            walk(in, element, header.ascii, [](size_t, const std::vector<double>&) {});
        }
    }
    in.finish();
    std::vector<size_t> order(vertices.size());  // vertices, strand after strand
    for (size_t k = 0; k < order.size(); ++k) order[k] = k;
    if (!strands_told && edges_told) {
        order.clear();
        for (const auto& chain : chains_of(edges, vertices.size(), path)) {
            sizes.push_back(chain.size());
            order.insert(order.end(), chain.begin(), chain.end());
        }
    } else if (!strands_told) {
        if (faces > 0)
            in.fail(std::to_string(faces) + " faces, neither strands nor edges: a mesh",
                    "vertices with an element 'strand' or 'edge'");
        if (vertices.size() % implied_points)
            in.fail(std::to_string(vertices.size()) + " vertices and no element 'strand' or 'edge'",
                    "a multiple of 100 (each 100 are a strand)");
        sizes.assign(vertices.size() / implied_points, implied_points);
    }
    size_t sum = 0;
    for (size_t size : sizes) sum += size;
    if (sum != vertices.size())
        in.fail(std::to_string(vertices.size()) + " vertices",
                std::to_string(sum) + ", the sum of nsegs + 1");
    StrandFile out;
    out.points.resize(sizes.size());
    out.widths.resize(widths.empty() ? 0 : sizes.size());
    auto next = order.begin();
    for (size_t s = 0; s < sizes.size(); ++s)
        for (size_t i = 0; i < sizes[s]; ++i, ++next) {
            require_sane(in, vertices[*next], s, i);
            out.points[s].push_back(vertices[*next]);
            if (!widths.empty()) out.widths[s].push_back(widths[*next]);
        }
    return out;
}

}  // namespace wetcurl

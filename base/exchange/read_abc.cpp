// Alembic files, read: objects and headers at once, samples when they are asked for.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "base/exchange/abc_layout.h"
#include "base/exchange/alembic.h"
#include "base/exchange/ogawa.h"
#include "base/exchange/row_matrix.h"
#include "base/log.h"

namespace wetcurl {

namespace {

// Most samples of all objects together, and most objects above one another, that are taken for sound.
constexpr size_t most_samples = 10'000'000, most_depth = 1000;

struct Property {
    std::string name, where;  // for messages: object and property
    bool is_compound = false, is_array = false;
    Pod pod = Pod::int8;
    uint32_t extent = 1;
    uint32_t samples = 0, first_change = 0, last_change = 0, sampling = 0;
    OgawaChild group;
    bool changes() const { return last_change > 0; }
    // Where a sample stands among those that are stored.
    uint64_t stored(uint32_t sample) const {
        if (!changes() || sample < first_change) return 0;
        return uint64_t(std::min(sample, last_change)) - first_change + 1;
    }
};
using Properties = std::map<std::string, Property>;

struct ObjectHeader {
    std::string name, metadata;
    OgawaChild group;
};

// Times of samples: `times` of a cycle, again after `cycle` seconds; or `times` alone.
struct Sampling {
    double cycle;
    std::vector<double> times;
    bool is_cyclic() const { return cycle < acyclic_seconds; }
    double time(size_t sample) const {
        if (!is_cyclic()) return times[std::min(sample, times.size() - 1)];
        return times[sample % times.size()] + cycle * double(sample / times.size());
    }
};

RowMatrix rotation(const Vec3d& axis, double degrees) {
    constexpr double degree = 3.14159265358979323846 / 180;
    const double length = norm(axis);
    return length > 0 ? row_matrix_of(rotation_about((1 / length) * axis, degrees * degree)) : RowMatrix{};
}

RowMatrix matrix_of(AbcXformOp op, const double* channels) {
    RowMatrix out;
    switch (op) {
        case AbcXformOp::scale:
            for (int i = 0; i < 3; ++i) out.m[i][i] = channels[i];
            break;
        case AbcXformOp::translate:
            for (int i = 0; i < 3; ++i) out.m[3][i] = channels[i];
            break;
        case AbcXformOp::rotate:
            return rotation({channels[0], channels[1], channels[2]}, channels[3]);
        case AbcXformOp::matrix:
            for (int i = 0; i < 16; ++i) out.m[i / 4][i % 4] = channels[i];
            break;
        case AbcXformOp::rotate_x:
            return rotation({1, 0, 0}, channels[0]);
        case AbcXformOp::rotate_y:
            return rotation({0, 1, 0}, channels[0]);
        case AbcXformOp::rotate_z:
            return rotation({0, 0, 1}, channels[0]);
    }
    return out;
}

// The numbers that a value of a strand consists of.
template <class T>
struct NumbersOf {
    using Number = T;
    static constexpr size_t extent = 1;
};
template <class T, size_t n>
struct NumbersOf<std::array<T, n>> {
    using Number = T;
    static constexpr size_t extent = n;
};

double half(uint16_t bits) {
    const int exponent = bits >> 10 & 31, fraction = bits & 1023;
    const double size = exponent == 31  ? (fraction ? std::numeric_limits<double>::quiet_NaN()
                                                    : std::numeric_limits<double>::infinity())
                        : exponent == 0 ? std::ldexp(fraction, -24)
                                        : std::ldexp(1024 + fraction, exponent - 25);
    return bits >> 15 ? -size : size;
}

// Takes bytes of headers from their start.
class Bytes {
  public:
    Bytes(const OgawaReader& file, std::string where, std::string bytes)
        : file_(file), where_(std::move(where)), bytes_(std::move(bytes)) {}
    bool more() const { return at_ < bytes_.size(); }
    std::string text(size_t length) {
        if (length > bytes_.size() - at_)
            file_.fail(where_, std::to_string(bytes_.size() - at_) + " bytes left",
                       std::to_string(length) + " or more");
        at_ += length;
        return bytes_.substr(at_ - length, length);
    }
    template <class T>
    T number(size_t width = sizeof(T)) {
        T value{};
        std::memcpy(&value, text(width).data(), width);
        return value;
    }

  private:
    const OgawaReader& file_;
    std::string where_, bytes_;
    size_t at_ = 0;
};

// The value of a key in metadata "key=value;key=value", or "".
std::string value_of(const std::string& metadata, const std::string& key) {
    for (size_t start = 0; start < metadata.size();) {
        const size_t end = std::min(metadata.find(';', start), metadata.size());
        if (metadata.compare(start, key.size() + 1, key + "=") == 0)
            return metadata.substr(start + key.size() + 1, end - start - key.size() - 1);
        start = end + 1;
    }
    return "";
}

// Objects, properties and samples of a file.
class Archive {
  public:
    explicit Archive(const std::string& path) : file_(path) {
        const OgawaReader::Group root = file_.root();
        const auto block = [&](uint64_t child, const char* what) {
            return file_.bytes(file_.child(root, child, what), what);
        };
        int32_t layout = 0;
        file_.read(file_.child(root, 0, "version"), 0, &layout, sizeof layout, "version");
        if (layout != 0) file_.fail("version", "layout " + std::to_string(layout), "layout 0");
        top_ = file_.child(root, 2, "root group");
        metadata_ = block(3, "metadata of the file");
        Bytes samplings(file_, "time samplings", block(4, "time samplings"));
        while (samplings.more()) {
            samplings.number<uint32_t>();
            Sampling sampling{samplings.number<double>(), {}};
            const uint32_t times = samplings.number<uint32_t>();
            const std::string bytes = samplings.text(size_t(times) * sizeof(double));
            sampling.times.resize(times);
            if (times > 0) std::memcpy(sampling.times.data(), bytes.data(), bytes.size());
            constexpr double longest = 1e9;  // [s]
            bool sound =
                times > 0 && sampling.cycle >= 0 && (sampling.cycle < longest || !sampling.is_cyclic());
            for (double t : sampling.times) sound &= std::abs(t) < longest;
            if (!sound || !std::is_sorted(sampling.times.begin(), sampling.times.end()))
                file_.fail("time sampling " + std::to_string(samplings_.size()),
                           "no times, or such that go back or away", "times that grow");
            samplings_.push_back(std::move(sampling));
        }
        Bytes texts(file_, "table of metadata", block(5, "table of metadata"));
        while (texts.more()) texts_.push_back(texts.text(texts.number<uint8_t>()));
    }

    const OgawaReader& file() const { return file_; }
    OgawaChild top() const { return top_; }
    const std::string& metadata() const { return metadata_; }
    const Sampling& sampling(const Property& p) const { return samplings_[p.sampling]; }

    std::vector<ObjectHeader> children(OgawaChild object, const std::string& where) const {
        std::vector<ObjectHeader> out;
        constexpr size_t digests = 32;  // bytes at the end
        const OgawaReader::Group group = file_.group(object, where);
        if (group.children == 0) return out;
        const OgawaChild last = file_.child(group, group.children - 1, where);
        if (!last.is_block()) return out;
        std::string bytes = file_.bytes(last, where);
        if (bytes.size() <= digests) return out;
        bytes.resize(bytes.size() - digests);
        Bytes headers(file_, where + ", headers of its children", std::move(bytes));
        while (headers.more()) {
            ObjectHeader header;
            header.name = headers.text(headers.number<uint32_t>());
            const uint32_t metadata = headers.number<uint8_t>();
            header.metadata = metadata == metadata_in_header ? headers.text(headers.number<uint32_t>())
                                                             : text(metadata, where);
            header.group = file_.child(group, out.size() + 1, where);
            out.push_back(std::move(header));
        }
        return out;
    }

    Properties properties_of_object(OgawaChild object, const std::string& where) const {
        const OgawaReader::Group group = file_.group(object, where);
        if (group.children == 0) return {};
        const OgawaChild first = file_.child(group, 0, where);
        return first.is_block() ? Properties{} : properties(first, where);
    }
    // Of the compound of this name, or none.
    Properties compound(const Properties& parent, const std::string& name) const {
        const auto at = parent.find(name);
        if (at == parent.end() || !at->second.is_compound) return {};
        return properties(at->second.group, at->second.where);
    }

    // Numbers of a sample: (element, extent).
    template <class T>
    std::vector<T> numbers(const Property& p, uint32_t sample) const {
        const std::string where = p.where + ", sample " + std::to_string(sample);
        if (p.is_compound) file_.fail(where, "a compound", "an array or a value");
        if (p.samples == 0) file_.fail(p.where, "no sample", "1 or more");
        const size_t each = bytes_of_pod[size_t(p.pod)];
        if (each == 0) file_.fail(where, "texts", "numbers");
        const OgawaReader::Group group = file_.group(p.group, where);
        const OgawaChild block = file_.child(group, p.stored(sample) * (p.is_array ? 2 : 1), where);
        constexpr uint64_t key = 16;
        const uint64_t size = file_.size(block, where);
        if (size == 0) return {};
        if (size < key || (size - key) % (each * p.extent) != 0)
            file_.fail(where, std::to_string(size) + " bytes",
                       std::to_string(key) + " and " + std::to_string(each * p.extent) + " an element");
        std::vector<T> out((size - key) / each);
        const auto convert = [&](auto kind) {
            using From = decltype(kind);
            if constexpr (std::is_same_v<From, T>) {
                file_.read(block, key, out.data(), size - key, where);
            } else {
                std::vector<From> found(out.size());
                file_.read(block, key, found.data(), size - key, where);
                for (size_t i = 0; i < out.size(); ++i) {
                    if constexpr (std::is_integral_v<T>)
                        if (!std::in_range<T>(found[i]))
                            file_.fail(where, "the number " + std::to_string(found[i]),
                                       "up to " + std::to_string(std::numeric_limits<T>::max()));
                    out[i] = T(found[i]);
                }
            }
        };
        switch (p.pod) {
            case Pod::boolean:
            case Pod::uint8:
                convert(uint8_t());
                break;
            case Pod::int8:
                convert(int8_t());
                break;
            case Pod::uint16:
                convert(uint16_t());
                break;
            case Pod::int16:
                convert(int16_t());
                break;
            case Pod::uint32:
                convert(uint32_t());
                break;
            case Pod::int32:
                convert(int32_t());
                break;
            case Pod::uint64:
                convert(uint64_t());
                break;
            case Pod::int64:
                convert(int64_t());
                break;
            default:
                if constexpr (std::is_integral_v<T>) {
                    file_.fail(where, std::string(name_of_pod[size_t(p.pod)]), "whole numbers");
                } else if (p.pod == Pod::float32) {
                    convert(float());
                } else if (p.pod == Pod::float64) {
                    convert(double());
                } else {
                    std::vector<uint16_t> found(out.size());
                    file_.read(block, key, found.data(), size - key, where);
                    std::transform(found.begin(), found.end(), out.begin(),
                                   [](uint16_t h) { return T(half(h)); });
                }
        }
        return out;
    }

    // The samples around a time, and how far it is from the lower to the higher (0 to 1).
    struct Between {
        uint32_t low, high;
        double part;
    };
    Between between(const Property& p, double time) const {
        if (!p.changes()) return {0, 0, 0};
        const Sampling& times = sampling(p);
        uint32_t low = 0, high = p.samples - 1;
        if (time <= times.time(low)) return {low, low, 0};
        if (time >= times.time(high)) return {high, high, 0};
        while (high - low > 1) {
            const uint32_t middle = low + (high - low) / 2;
            (times.time(middle) <= time ? low : high) = middle;
        }
        const double start = times.time(low), part = (time - start) / (times.time(high) - start);
        constexpr double close = 1e-6;  // rounding of times
        if (!(part > close)) return {low, low, 0};
        if (part > 1 - close) return {high, high, 0};
        return {low, high, part};
    }
    template <class T>
    std::vector<T> numbers_at(const Property& p, double time) const {
        const auto [low, high, part] = between(p, time);
        std::vector<T> out = numbers<T>(p, low);
        if (high == low) return out;
        const std::vector<T> next = numbers<T>(p, high);
        if (next.size() != out.size())
            file_.fail(p.where + ", sample " + std::to_string(high), std::to_string(next.size()) + " numbers",
                       std::to_string(out.size()) + ", as the sample before");
        for (size_t i = 0; i < out.size(); ++i) out[i] = T(out[i] + part * (double(next[i]) - out[i]));
        return out;
    }

  private:
    const std::string& text(uint32_t metadata, const std::string& where) const {
        static const std::string none;
        if (metadata == 0) return none;
        if (metadata > texts_.size())
            file_.fail(where, "metadata " + std::to_string(metadata),
                       "up to " + std::to_string(texts_.size()) + ", which the file's table has");
        return texts_[metadata - 1];
    }

    Properties properties(OgawaChild compound, const std::string& where) const {
        namespace bits = property_bits;
        Properties out;
        const OgawaReader::Group group = file_.group(compound, where);
        if (group.children == 0) return out;
        const OgawaChild last = file_.child(group, group.children - 1, where);
        if (!last.is_block()) return out;
        Bytes headers(file_, where + ", headers of its properties", file_.bytes(last, where));
        for (uint64_t child = 0; headers.more(); ++child) {
            const uint32_t info = headers.number<uint32_t>();
            const uint32_t width = 1u << (info >> bits::width_shift & 3);
            if (width > 4) file_.fail(where, "a width of 8 bytes in a header", "1, 2 or 4");
            const auto number = [&] { return headers.number<uint32_t>(width); };
            Property p;
            const uint32_t kind = info & bits::kind;
            p.is_compound = kind == 0, p.is_array = kind >= 2;
            if (!p.is_compound) {
                const uint32_t pod = info >> bits::pod_shift & 15;
                if (pod >= pods) file_.fail(where, "numbers of type " + std::to_string(pod), "0 to 13");
                p.pod = Pod(pod);
                p.extent = std::max(1u, info >> bits::extent_shift & 255);
                p.samples = number();
                if (info & bits::has_changes) {
                    p.first_change = number(), p.last_change = number();
                } else if (!(info & bits::constant) && p.samples > 1) {
                    p.first_change = 1, p.last_change = p.samples - 1;
                }
                if (info & bits::has_sampling) p.sampling = number();
            }
            p.name = headers.text(number());
            p.where = where + ", " + p.name;
            if (const uint32_t metadata = info >> bits::metadata_shift & 255; metadata == metadata_in_header)
                headers.text(number());
            const bool sound = p.last_change < std::max(1u, p.samples) && p.first_change <= p.last_change &&
                               (p.first_change > 0 || p.last_change == 0);
            if (!sound || p.samples > most_samples)
                file_.fail(p.where,
                           std::to_string(p.samples) + " samples, which change from " +
                               std::to_string(p.first_change) + " to " + std::to_string(p.last_change),
                           "changes within the samples, and at most " + std::to_string(most_samples));
            if (!p.is_compound && p.sampling >= samplings_.size())
                file_.fail(p.where, "time sampling " + std::to_string(p.sampling),
                           "0 to " + std::to_string(int64_t(samplings_.size()) - 1));
            if (!p.is_compound && p.changes() && !sampling(p).is_cyclic() &&
                p.samples > sampling(p).times.size())
                file_.fail(p.where, std::to_string(p.samples) + " samples",
                           std::to_string(sampling(p).times.size()) + ", as its times");
            p.group = file_.child(group, child, p.where);
            out.emplace(p.name, std::move(p));
        }
        return out;
    }

    OgawaReader file_;
    OgawaChild top_;
    std::string metadata_;
    std::vector<Sampling> samplings_;
    std::vector<std::string> texts_;
};

class AbcReader : public SceneReader {
  public:
    explicit AbcReader(const std::string& path) : archive_(path) {
        const std::string& metadata = archive_.metadata();
        if (const std::string metres = value_of(metadata, "wetcurl_metres_per_unit"); !metres.empty())
            if (double value = 0;
                std::from_chars(metres.data(), metres.data() + metres.size(), value).ec == std::errc() &&
                value > 0 && std::isfinite(value))
                axes_.metres_per_unit = value;
        if (const std::string up = value_of(metadata, "wetcurl_up"); up == "x" || up == "y" || up == "z")
            axes_.up = up[0];
        swaps_y_and_z_ = value_of(metadata, "wetcurl_swaps") == "yz";
        walk(archive_.top(), "", -1, false, 0);
    }

    const FileAxes& axes() const override { return axes_; }
    const std::vector<CurvesObject>& curves() const override { return curves_; }
    const std::vector<MeshObject>& meshes() const override { return meshes_; }
    std::vector<Vec3f> points_of_curves(size_t object, size_t sample) const override {
        const Source& source = curve_sources_.at(object);
        const double time = curves_[object].times.at(sample);
        require_same(source.topology[0], curves_[object].counts, time);
        return points_at(source, time);
    }
    std::vector<Vec3f> points_of_mesh(size_t object, size_t sample) const override {
        const Source& source = mesh_sources_.at(object);
        const double time = meshes_[object].times.at(sample);
        for (size_t k = 0; k < 2; ++k) require_same(source.topology[k], source.stored[k], time);
        return points_at(source, time);
    }

  private:
    // Where the points of an object come from.
    struct Source {
        int transform;  // index, -1: none
        size_t points;
        Property positions;
        std::vector<Property> topology;        // of curves the counts; of a mesh counts and corners
        std::vector<std::vector<int>> stored;  // of a mesh: the topology as it is in the file
    };
    struct Transform {
        int above;  // index, -1: none
        std::string where;
        std::vector<AbcXformOp> ops;
        std::optional<Property> channels, inherits;
    };

    const OgawaReader& file() const { return archive_.file(); }

    // Takes an object's children, which lie below the transform `above`; `is_hidden`: where they do not say
    // it.
    void walk(OgawaChild object, const std::string& path, int above, bool is_hidden, size_t depth) {
        if (depth > most_depth)
            file().fail(path, "objects below one another", "at most " + std::to_string(most_depth));
        if (object.place() != 0 && !seen_.insert(object.place()).second)
            file().fail(path.empty() ? "/" : path, "the group of another object",
                        "one of its own: groups lead in a circle");
        for (const ObjectHeader& child : archive_.children(object, path.empty() ? "/" : path)) {
            const std::string below = path + "/" + child.name;
            const std::string schema = value_of(child.metadata, "schema");
            const bool hidden = is_hidden_here(child, below, is_hidden);
            int transform = above;
            if (schema.starts_with("AbcGeom_Xform")) transform = take_transform(child, below, above);
            if (schema.starts_with("AbcGeom_Curve")) take_curves(child, below, above, hidden);
            if (schema.starts_with("AbcGeom_PolyMesh") || schema.starts_with("AbcGeom_SubD"))
                take_mesh(child, below, above, hidden);
            if (value_of(child.metadata, "isInstance") == "1")
                warn(below, "an instance of another object is left out");
            walk(child.group, below, transform, hidden, depth + 1);
        }
    }

    // Whether an object is hidden at all times. It says 0 for hidden, 1 for shown, -1 for "as what is above".
    bool is_hidden_here(const ObjectHeader& header, const std::string& path, bool above) const {
        const Properties properties = archive_.properties_of_object(header.group, path);
        const auto said = properties.find("visible");
        if (said == properties.end() || said->second.is_compound || said->second.samples == 0) return above;
        const Property& p = said->second;
        for (uint32_t sample = 0; sample < p.samples; ++sample) {
            const auto value = archive_.numbers<int>(p, sample);
            const bool hidden = value.empty() || value[0] < 0 ? above : value[0] == 0;
            if (!hidden) return false;
            if (!p.changes()) break;
        }
        return true;
    }

    void warn(const std::string& path, const std::string& what) const {
        log_warning(file().path() + ": " + path + ": " + what);
    }

    int take_transform(const ObjectHeader& header, const std::string& path, int above) {
        const Properties schema =
            archive_.compound(archive_.properties_of_object(header.group, path), ".xform");
        Transform transform{above, path, {}, {}, {}};
        if (const auto at = schema.find(".inherits"); at != schema.end() && at->second.samples > 0)
            transform.inherits = at->second;
        const auto ops = schema.find(".ops"), channels = schema.find(".vals");
        if (ops != schema.end() && channels != schema.end() && channels->second.samples > 0) {
            size_t needed = 0;
            for (uint8_t op : archive_.numbers<uint8_t>(ops->second, 0)) {
                if (op >> 4 >= int(xform_ops))
                    file().fail(ops->second.where, "the operation " + std::to_string(op >> 4), "0 to 6");
                transform.ops.push_back(AbcXformOp(op >> 4));
                needed += channels_of_xform_op[op >> 4];
            }
            if (const size_t found = archive_.numbers<double>(channels->second, 0).size(); found != needed)
                file().fail(channels->second.where, std::to_string(found) + " numbers",
                            std::to_string(needed) + ", which its operations have");
            transform.channels = channels->second;
        }
        transforms_.push_back(std::move(transform));
        return int(transforms_.size()) - 1;
    }

    // The positions of an object, or none where it has no sample.
    std::optional<Source> source_of(const Properties& schema, const std::string& path, int above) const {
        const auto at = schema.find("P");
        if (at == schema.end() || at->second.samples == 0) {
            warn(path, "an object without points is left out");
            return std::nullopt;
        }
        if (at->second.extent != 3 || !at->second.is_array)
            file().fail(at->second.where, std::to_string(at->second.extent) + " numbers a point", "3");
        return Source{above, archive_.numbers<float>(at->second, 0).size() / 3, at->second, {}, {}};
    }
    const Property& required(const Properties& schema, const std::string& path, const char* name) const {
        const auto at = schema.find(name);
        if (at == schema.end()) file().fail(path, "no property " + std::string(name), "one");
        return at->second;
    }

    void take_curves(const ObjectHeader& header, const std::string& path, int above, bool is_hidden) {
        const Properties schema =
            archive_.compound(archive_.properties_of_object(header.group, path), ".geom");
        auto source = source_of(schema, path, above);
        if (!source) return;
        CurvesObject object;
        object.path = path;
        object.hidden = is_hidden ? "invisible" : "";
        const auto kind = archive_.numbers<uint8_t>(required(schema, path, "curveBasisAndType"), 0);
        if (kind.size() < 3) file().fail(path + ", curveBasisAndType", "other values", "4 bytes");
        if (const auto basis = basis_of(AbcCurveType(kind[0]), AbcBasis(kind[2])); basis && kind[1] == 0) {
            object.basis = *basis;
        } else {
            warn(path, kind[1] != 0
                           ? "closed curves are left out"
                           : "curves of variable order, or of a basis other than Bezier, B-spline and "
                             "Catmull-Rom, are left out");
            return;
        }
        source->topology = {required(schema, path, "nVertices")};
        object.counts = archive_.numbers<int>(source->topology[0], 0);
        size_t points = 0;
        for (size_t s = 0; s < object.counts.size(); ++s) {
            if (object.counts[s] < 0)
                file().fail(source->topology[0].where,
                            std::to_string(object.counts[s]) + " points of strand " + std::to_string(s),
                            "0 and more");
            points += size_t(object.counts[s]);
        }
        if (points != source->points)
            file().fail(source->positions.where, std::to_string(source->points) + " points",
                        std::to_string(points) + ", which its curves have");

        object.widths = of_points(parameter<float>(schema, "width", 1), object.counts, points, path);
        const Properties more = archive_.compound(schema, ".arbGeomParams");
        const size_t strands = object.counts.size();
        const auto of_strands = [&](const char* name, auto& to) {
            using Element = typename std::decay_t<decltype(to)>::value_type;
            constexpr size_t extent = NumbersOf<Element>::extent;
            const auto values = parameter<typename NumbersOf<Element>::Number>(more, name, extent);
            if (values.empty()) return;
            if (values.size() != extent && values.size() != strands * extent)
                return warn(path, std::string(name) + ", which is not one value a strand, is left out");
            const size_t step = values.size() == extent ? 0 : extent;
            to.resize(strands);
            for (size_t s = 0; s < strands; ++s) std::memcpy(&to[s], &values[s * step], sizeof(Element));
        };
        of_strands("groom_id", object.ids);
        if (object.ids.empty()) of_strands("id", object.ids);  // Houdini's name
        of_strands("groom_group_id", object.groups);
        of_strands("groom_root_uv", object.root_uv);
        of_strands("groom_guide", object.is_guide);
        of_strands("groom_closest_guides", object.guides);
        of_strands("groom_guide_weights", object.weights);
        object.times = times_of(*source);
        curves_.push_back(std::move(object));
        curve_sources_.push_back(std::move(*source));
    }

    void take_mesh(const ObjectHeader& header, const std::string& path, int above, bool is_hidden) {
        const Properties schema =
            archive_.compound(archive_.properties_of_object(header.group, path), ".geom");
        auto source = source_of(schema, path, above);
        if (!source) return;
        MeshObject object;
        object.path = path;
        object.hidden = is_hidden ? "invisible" : "";
        object.points = source->points;
        source->topology = {required(schema, path, ".faceCounts"), required(schema, path, ".faceIndices")};
        for (const Property& p : source->topology) source->stored.push_back(archive_.numbers<int>(p, 0));
        object.counts = source->stored[0], object.corners = source->stored[1];
        object.times = times_of(*source);
        for (int corner : object.corners)
            if (corner < 0 || size_t(corner) >= object.points)
                file().fail(source->topology[1].where, "the point " + std::to_string(corner),
                            "points of its " + std::to_string(object.points));
        const bool turn = placement(above, object.times[0]).determinant() >= 0;
        size_t first = 0;
        for (int count : object.counts) {
            if (count < 0 || size_t(count) > object.corners.size() - first)
                file().fail(source->topology[0].where, "a face of " + std::to_string(count) + " corners",
                            "faces that add up to the " + std::to_string(object.corners.size()) + " corners");
            const auto start = object.corners.begin() + ptrdiff_t(first);
            if (turn) std::reverse(start, start + count);
            first += size_t(count);
        }
        if (first != object.corners.size())
            file().fail(source->topology[0].where, std::to_string(first) + " corners in all",
                        std::to_string(object.corners.size()));
        meshes_.push_back(std::move(object));
        mesh_sources_.push_back(std::move(*source));
    }

    static std::optional<CurveBasis> basis_of(AbcCurveType type, AbcBasis basis) {
        if (type == AbcCurveType::linear) return CurveBasis::linear;
        if (type != AbcCurveType::cubic) return std::nullopt;
        switch (basis) {
            case AbcBasis::none:
                return CurveBasis::linear;
            case AbcBasis::bezier:
                return CurveBasis::bezier;
            case AbcBasis::b_spline:
                return CurveBasis::b_spline;
            case AbcBasis::catmull_rom:
                // Such a curve goes through its points, and those of Blender from the first one to the last.
                // Alembic has no word for that.
                return CurveBasis::linear;
            default:
                return std::nullopt;
        }
    }

    // The first sample of a geometry parameter of this extent, with its indices followed; empty where there
    // is none.
    template <class T>
    std::vector<T> parameter(const Properties& parent, const std::string& name, size_t extent) const {
        const auto at = parent.find(name);
        if (at == parent.end()) return {};
        Properties inner = archive_.compound(parent, name);
        const Property& values = at->second.is_compound ? inner[".vals"] : at->second;
        if (values.samples == 0 || bytes_of_pod[size_t(values.pod)] == 0) return {};
        if constexpr (std::is_integral_v<T>)
            if (values.pod >= Pod::float16) return {};
        std::vector<T> out = archive_.numbers<T>(values, 0);
        if (out.size() % extent != 0) return {};
        if (!at->second.is_compound) return out;
        const auto indices = inner.find(".indices");
        if (indices == inner.end() || indices->second.samples == 0) return out;
        std::vector<T> followed;
        for (uint32_t i : archive_.numbers<uint32_t>(indices->second, 0)) {
            if (i >= out.size() / extent)
                file().fail(indices->second.where, "the index " + std::to_string(i),
                            "below " + std::to_string(out.size() / extent));
            followed.insert(followed.end(), out.begin() + ptrdiff_t(i * extent),
                            out.begin() + ptrdiff_t((i + 1) * extent));
        }
        return followed;
    }

    // One value for each point, from one for all, for each strand, or for each point.
    std::vector<float> of_points(std::vector<float> values, const std::vector<int>& counts, size_t points,
                                 const std::string& path) const {
        if (values.empty() || values.size() == points) return values;
        if (values.size() != 1 && values.size() != counts.size()) {
            warn(path, "widths that are neither of points nor of strands are left out");
            return {};
        }
        std::vector<float> out;
        out.reserve(points);
        for (size_t s = 0; s < counts.size(); ++s)
            out.insert(out.end(), size_t(counts[s]), values[values.size() == 1 ? 0 : s]);
        return out;
    }

    // When an object moves [s]: its own samples, and those of the transforms above it.
    std::vector<double> times_of(const Source& source) {
        std::vector<double> times;
        const auto add = [&](const Property& p) {
            if (!p.changes()) return;
            samples_ += p.samples;
            if (samples_ > most_samples)
                file().fail(p.where, "more than " + std::to_string(most_samples) + " samples up to here",
                            "so many in all objects");
            for (uint32_t k = 0; k < p.samples; ++k) times.push_back(archive_.sampling(p).time(k));
        };
        add(source.positions);
        for (const Property& p : source.topology) add(p);
        for (int t = source.transform; t >= 0; t = transforms_[size_t(t)].above) {
            if (transforms_[size_t(t)].channels) add(*transforms_[size_t(t)].channels);
            if (transforms_[size_t(t)].inherits) add(*transforms_[size_t(t)].inherits);
        }
        if (times.empty()) return {archive_.sampling(source.positions).time(0)};
        std::sort(times.begin(), times.end());
        constexpr double close = 1e-6;  // [s], far below a shutter's
        times.erase(std::unique(times.begin(), times.end(), [](double a, double b) { return b - a < close; }),
                    times.end());
        return times;
    }

    // All transforms above an object at a time.
    RowMatrix placement(int transform, double time) const {
        RowMatrix out;
        for (int t = transform; t >= 0; t = transforms_[size_t(t)].above) {
            const Transform& from = transforms_[size_t(t)];
            if (from.channels) {
                const std::vector<double> channels = archive_.numbers_at<double>(*from.channels, time);
                RowMatrix own;
                size_t at = 0;
                for (AbcXformOp op : from.ops) {
                    if (channels.size() < at + channels_of_xform_op[size_t(op)])
                        file().fail(from.channels->where, std::to_string(channels.size()) + " numbers",
                                    "as many in each sample");
                    own = matrix_of(op, channels.data() + at) * own;
                    at += channels_of_xform_op[size_t(op)];
                }
                out = out * own;
            }
            if (from.inherits) {
                const auto inherits =
                    archive_.numbers<uint8_t>(*from.inherits, archive_.between(*from.inherits, time).low);
                if (!inherits.empty() && inherits[0] == 0) break;
            }
        }
        return out;
    }

    void require_same(const Property& topology, const std::vector<int>& first, double time) const {
        if (!topology.changes()) return;
        const uint32_t sample = archive_.between(topology, time).low;
        if (archive_.numbers<int>(topology, sample) != first)
            file().fail(topology.where + ", sample " + std::to_string(sample), "another topology",
                        "that of the first sample: strands and faces must stay the same over time");
    }

    std::vector<Vec3f> points_at(const Source& source, double time) const {
        const std::vector<float> numbers = archive_.numbers_at<float>(source.positions, time);
        const std::string& where = source.positions.where;
        if (numbers.size() != 3 * source.points)
            file().fail(where + ", " + std::to_string(time) + " s",
                        std::to_string(numbers.size() / 3) + " points",
                        std::to_string(source.points) + ", as in the first sample");
        const RowMatrix place = placement(source.transform, time);
        const bool moves = place != RowMatrix{};
        std::vector<Vec3f> points(source.points);
        for (size_t i = 0; i < points.size(); ++i) {
            Vec3f& x = points[i];
            x = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
            if (moves) x = cast<float>(place(cast<double>(x)));
            if (swaps_y_and_z_) std::swap(x.y, x.z);
            if (!std::isfinite(x.x) || !std::isfinite(x.y) || !std::isfinite(x.z))
                file().fail(where + ", " + std::to_string(time) + " s",
                            "the point " + std::to_string(i) + ", which is not finite", "finite numbers");
        }
        return points;
    }

    Archive archive_;
    FileAxes axes_;
    bool swaps_y_and_z_ = false;  // of our own files for Unreal: as if they were not swapped
    std::vector<Transform> transforms_;
    std::vector<CurvesObject> curves_;
    std::vector<MeshObject> meshes_;
    std::vector<Source> curve_sources_, mesh_sources_;
    std::set<uint64_t> seen_;  // places of objects' groups
    size_t samples_ = 0;       // of all objects
};

}  // namespace

std::unique_ptr<SceneReader> open_abc(const std::string& path) { return std::make_unique<AbcReader>(path); }

}  // namespace wetcurl

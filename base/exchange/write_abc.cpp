// Alembic files, written front to end.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <list>

#include "base/exchange/abc_layout.h"
#include "base/exchange/alembic.h"
#include "base/exchange/ogawa.h"
#include "base/log.h"
#include "base/provenance.h"

namespace wetcurl {

namespace {

template <class T>
std::string_view bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}
template <class T>
std::string_view bytes_of(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    return {reinterpret_cast<const char*>(&value), sizeof value};
}
std::string_view bytes_of(const std::string&) = delete;

void put(std::string& bytes, uint32_t number, int width) {
    bytes.append(reinterpret_cast<const char*>(&number), size_t(width));
}

// Texts of metadata, which headers name by their number: 0 is the empty one, 1 the first that was needed.
class MetadataTable {
  public:
    uint32_t number(const std::string& text) {
        if (text.empty()) return 0;
        const auto at = std::find(texts_.begin(), texts_.end(), text);
        if (at == texts_.end()) {
            if (text.size() > 255 || texts_.size() + 1 == metadata_in_header) return metadata_in_header;
            texts_.push_back(text);
            return uint32_t(texts_.size());
        }
        return uint32_t(at - texts_.begin()) + 1;
    }
    std::string bytes() const {
        std::string all;
        for (const auto& text : texts_) put(all, uint32_t(text.size()), 1), all += text;
        return all;
    }

  private:
    std::vector<std::string> texts_;
};

enum class Kind : uint32_t { compound, scalar, array };

// A property, with the places of its samples, which are in the file already.
struct Property {
    std::string name;
    Kind kind = Kind::compound;
    Pod pod = Pod::int8;
    uint32_t extent = 1;    // numbers of an element
    uint32_t sampling = 0;  // number of its time sampling
    std::string metadata;
    std::list<Property> children = {};  // of a compound

    // Sample 0, then those from `first_change` to `last_change`: a block each, and of an array another for
    // its dimensions, which is empty where there is one. Samples between 0 and the first change are as 0,
    // those after the last change as that.
    std::vector<OgawaChild> stored = {};
    uint32_t samples = 0, first_change = 0, last_change = 0;
    size_t elements = 0;  // of the last sample
    bool one_element = true, same_size = true;
    OgawaChild block{};  // of the last sample
    OgawaKey key{};      // of the last sample
    OgawaKey digest{};   // of all samples

    Property& add(Property child) { return children.emplace_back(std::move(child)); }
    Property& at(std::string_view child) {
        return *std::find_if(children.begin(), children.end(),
                             [&](const Property& p) { return p.name == child; });
    }

    void append(OgawaWriter& file, std::string_view bytes, size_t count) {
        const OgawaKey found = ogawa_key(bytes);
        if (samples == 0 || found != key || count != elements) {
            if (first_change != 0)  // what stayed the same since the last change
                for (uint32_t k = last_change + 1; k < samples; ++k) store(block);
            block = file.keyed(found, bytes);
            store(block);
            if (first_change == 0) first_change = samples;
            last_change = samples;
            one_element &= count == 1;
            same_size &= samples == 0 || count == elements;
            elements = count;
            key = found;
        }
        repeat();
    }
    // One more sample, as the last one.
    void repeat() {
        digest = ogawa_key(bytes_of(std::array{digest, key}));
        ++samples;
    }
    void store(OgawaChild sample) {
        stored.push_back(sample);
        if (kind == Kind::array) stored.push_back(OgawaChild::empty_block());
    }
    template <class T>
    void append(OgawaWriter& file, const std::vector<T>& values) {
        append(file, bytes_of(values), values.size() * sizeof(T) / (bytes_of_pod[size_t(pod)] * extent));
    }
};

Property compound(const std::string& name, const std::string& metadata = "") {
    return {name, Kind::compound, Pod::int8, 1, 0, metadata};
}
Property scalar(const std::string& name, Pod pod, uint32_t extent, uint32_t sampling,
                const std::string& metadata = "") {
    return {name, Kind::scalar, pod, extent, sampling, metadata};
}
Property array(const std::string& name, Pod pod, uint32_t extent, uint32_t sampling,
               const std::string& metadata = "") {
    return {name, Kind::array, pod, extent, sampling, metadata};
}
// An array that belongs to points (scope "vtx") or strands ("uni").
Property geometry_parameter(const std::string& name, Pod pod, uint32_t extent, uint32_t sampling,
                            const std::string& scope) {
    return array(name, pod, extent, sampling,
                 "arrayExtent=1;geoScope=" + scope + (extent > 1 ? ";interpretation=vector" : "") +
                     ";isGeomParam=true;podExtent=" + std::to_string(extent) +
                     ";podName=" + std::string(name_of_pod[size_t(pod)]));
}

// An object of the hierarchy: a transform, curves or a mesh.
struct Node {
    std::string name, metadata;
    Property properties;  // a compound, which holds the schema's compound alone
    std::list<Node> children;
    Property& schema() { return properties.children.front(); }
    bool is_transform() const { return properties.children.front().name == ".xform"; }
};

Node node(const std::string& name, const std::string& schema, const std::string& base) {
    const std::string schema_name = base.empty() ? ".xform" : ".geom";
    const std::string kind = "schema=" + schema + base;
    Node out{name, kind + ";schemaObjTitle=" + schema + ":" + schema_name, {}, {}};
    out.properties.add(compound(schema_name, kind));
    return out;
}
constexpr const char* geometry_base = ";schemaBaseType=AbcGeom_GeomBase_v1";

struct Box {
    double low[3], high[3];
};

class AbcWriter : public SceneWriter {
  public:
    AbcWriter(const std::string& path, bool overwrite, const SceneFileSettings& settings)
        : settings_(settings), file_(checked(path, settings), overwrite) {
        top_.name = "ABC";
    }

    size_t add_curves(const CurvesObject& object) override {
        const size_t strands = object.counts.size(), points = object.points();
        for (size_t s = 0; s < strands; ++s)
            if (object.counts[s] < 2)
                fail(object.path, "strand " + std::to_string(s), std::to_string(object.counts[s]) + " points",
                     "2 or more");
        if (settings_.for_unreal && strands > 0 &&
            *std::max_element(object.counts.begin(), object.counts.end()) > 255)
            log_warning(file_.path() + ": " + object.path +
                        ": strands have more than 255 points, which Unreal may not import");
        require_length(object.path, "widths", object.widths.size(), points);
        require_length(object.path, "ids", object.ids.size(), strands);
        require_length(object.path, "groups", object.groups.size(), strands);
        require_length(object.path, "root_uv", object.root_uv.size(), strands);
        require_length(object.path, "is_guide", object.is_guide.size(), strands);
        require_length(object.path, "guides", object.guides.size(), strands);
        require_length(object.path, "weights", object.weights.size(), strands);

        Node& made = add_object(object.path, node("", "AbcGeom_Curve_v2", geometry_base));
        Property& schema = made.schema();
        const bool linear = object.basis == CurveBasis::linear;
        const uint8_t basis = linear ? 0 : uint8_t(object.basis);
        const std::array<uint8_t, 4> basis_and_type = {
            uint8_t(linear ? AbcCurveType::linear : AbcCurveType::cubic), 0, basis, basis};
        add_points(schema);
        schema.add(array("nVertices", Pod::int32, 1, frames)).append(file_, object.counts);
        schema.add(scalar("curveBasisAndType", Pod::uint8, 4, frames))
            .append(file_, bytes_of(basis_and_type), 1);
        if (!object.widths.empty())
            schema.add(geometry_parameter("width", Pod::float32, 1, frames, "vtx"))
                .append(file_, object.widths);
        Property parameters = compound(".arbGeomParams");
        const auto add = [&](const char* name, Pod pod, uint32_t extent, const auto& values) {
            if (!values.empty())
                parameters.add(geometry_parameter(name, pod, extent, still, "uni")).append(file_, values);
        };
        add("groom_id", Pod::int32, 1, object.ids);
        add("groom_group_id", Pod::int32, 1, object.groups);
        add("groom_root_uv", Pod::float32, 2, object.root_uv);
        add("groom_guide", Pod::int32, 1,
            std::vector<int32_t>(object.is_guide.begin(), object.is_guide.end()));
        add("groom_closest_guides", Pod::int32, 3, object.guides);
        add("groom_guide_weights", Pod::float32, 3, object.weights);
        if (!parameters.children.empty()) schema.add(std::move(parameters));
        objects_.push_back({&made, object.path, points});
        return objects_.size() - 1;
    }

    size_t add_mesh(const MeshObject& object) override {
        if (settings_.for_unreal)
            fail(object.path, "file", "a mesh", "strands alone, which Unreal's import of grooms reads");
        if (object.points == 0) fail(object.path, "mesh", "no points", "1 or more");
        std::vector<int> reversed;  // corners, clockwise
        size_t first = 0;
        for (size_t f = 0; f < object.counts.size(); ++f) {
            const int count = object.counts[f];
            if (count < 3 || size_t(count) > object.corners.size() - first)
                fail(object.path, "face " + std::to_string(f), std::to_string(count) + " corners",
                     "3 or more, which add up to the " + std::to_string(object.corners.size()) + " corners");
            reversed.insert(reversed.end(), object.corners.rend() - ptrdiff_t(first + size_t(count)),
                            object.corners.rend() - ptrdiff_t(first));
            first += size_t(count);
        }
        if (first != object.corners.size())
            fail(object.path, "faces", std::to_string(first) + " corners in all",
                 std::to_string(object.corners.size()));
        for (int corner : object.corners)
            if (corner < 0 || size_t(corner) >= object.points)
                fail(object.path, "corners", "the point " + std::to_string(corner),
                     "0 to " + std::to_string(object.points - 1));

        Node& made = add_object(object.path, node("", "AbcGeom_PolyMesh_v1", geometry_base));
        Property& schema = made.schema();
        add_points(schema);
        schema.add(array(".faceIndices", Pod::int32, 1, frames)).append(file_, reversed);
        schema.add(array(".faceCounts", Pod::int32, 1, frames)).append(file_, object.counts);
        objects_.push_back({&made, object.path, object.points});
        return objects_.size() - 1;
    }

    void append_curves(size_t object, const CurvesFrame& frame) override {
        Object& o = objects_.at(object);
        if (o.is_mesh()) fail(o.path, "object", "a mesh", "curves");
        Property& schema = o.node->schema();
        const uint32_t sample = schema.at("P").samples;
        if (sample == 0) begin_curves(o, frame);
        const std::string where = "frame " + std::to_string(sample);
        if (frame.points.size() != o.points)
            fail(o.path, where, std::to_string(frame.points.size()) + " points", std::to_string(o.points));
        if (frame.velocities.size() != (o.has_velocities ? o.points : 0))
            fail(o.path, where, std::to_string(frame.velocities.size()) + " velocities",
                 o.has_velocities ? std::to_string(o.points) : "none, as in the first frame");
        if (frame.wetness.size() != (o.has_wetness ? o.points : 0))
            fail(o.path, where, std::to_string(frame.wetness.size()) + " values of wetness",
                 o.has_wetness ? std::to_string(o.points) : "none, as in the first frame");
        require_finite(o, frame.velocities, where, "velocity");
        require_finite(o, frame.wetness, where, "wetness");
        append_points(o, frame.points, where);
        if (o.has_velocities) schema.at(".velocities").append(file_, frame.velocities);
        if (o.has_wetness) schema.at(".arbGeomParams").at("wetness").append(file_, frame.wetness);
        repeat_others(schema);
    }

    void append_mesh(size_t object, const std::vector<Vec3f>& points) override {
        Object& o = objects_.at(object);
        if (!o.is_mesh()) fail(o.path, "object", "curves", "a mesh");
        Property& schema = o.node->schema();
        const std::string where = "frame " + std::to_string(schema.at("P").samples);
        if (points.size() != o.points)
            fail(o.path, where, std::to_string(points.size()) + " points", std::to_string(o.points));
        append_points(o, points, where);
        repeat_others(schema);
    }

    void finish() override {
        uint32_t most = 0;
        for (Object& o : objects_) most = std::max(most, o.node->schema().at("P").samples);
        for (Object& o : objects_)
            if (const uint32_t samples = o.node->schema().at("P").samples; samples != most || most == 0)
                fail(o.path, "object", std::to_string(samples) + " frames",
                     most == 0 ? "1 or more" : std::to_string(most) + ", as another object has");
        const int32_t layout = 0, library = 10800;  // Alembic 1.8.0
        std::vector<OgawaChild> root;
        root.push_back(file_.block(bytes_of(layout)));
        root.push_back(file_.block(bytes_of(library)));
        root.push_back(write_node(top_).first);
        root.push_back(file_.block(archive_metadata()));
        root.push_back(file_.block(time_samplings(most)));
        root.push_back(file_.block(table_.bytes()));
        file_.finish(file_.group(root));
    }

  private:
    // Numbers of the time samplings: one sample for all times, and one a frame.
    static constexpr uint32_t still = 0, frames = 1;

    struct Object {
        Node* node;
        std::string path;
        size_t points;
        bool has_velocities = false, has_wetness = false;
        bool is_mesh() const { return node->metadata.starts_with("schema=AbcGeom_PolyMesh"); }
    };

    static const std::string& checked(const std::string& path, const SceneFileSettings& settings) {
        if (!(settings.fps > 0) || !std::isfinite(settings.fps))
            throw Misuse(path + ": frames a second: found " + std::to_string(settings.fps) +
                         ", allowed is a positive number");
        if (settings.first_frame < 0)
            throw Misuse(path + ": first frame: found " + std::to_string(settings.first_frame) +
                         ", allowed are 0 and more");
        return path;
    }

    [[noreturn]] void fail(const std::string& object, const std::string& where, const std::string& found,
                           const std::string& allowed) const {
        throw Error(file_.path() + ": " + object + ": " + where + ": found " + found + ", allowed " +
                    allowed);
    }
    void require_length(const std::string& object, const char* what, size_t found, size_t allowed) const {
        if (found != 0 && found != allowed)
            fail(object, what, std::to_string(found) + " values", std::to_string(allowed) + ", or none");
    }

    // Puts an object at its path, under transforms at rest that are made where they are missing.
    Node& add_object(const std::string& path, Node made) {
        if (path.size() < 2 || path[0] != '/' || path.back() == '/' || path.find("//") != std::string::npos)
            fail("'" + path + "'", "path", "no names between slashes", "such as /hair/strands");
        Node* at = &top_;
        for (size_t start = 1; start < path.size();) {
            const size_t end = std::min(path.find('/', start), path.size());
            const std::string name = path.substr(start, end - start);
            const auto there = std::find_if(at->children.begin(), at->children.end(),
                                            [&](const Node& n) { return n.name == name; });
            if (there != at->children.end() && (end == path.size() || !there->is_transform()))
                fail(path, "path", "another object at " + path.substr(0, end), "a free path");
            if (there == at->children.end()) {
                at = &at->children.emplace_back(end == path.size() ? std::move(made)
                                                                   : node(name, "AbcGeom_Xform_v3", ""));
                at->name = name;
                if (at->is_transform())
                    at->schema().add(scalar(".inherits", Pod::boolean, 1, still)).append(file_, "\1", 1);
                if (settings_.for_unreal && top_.children.size() == 1 && at == &top_.children.front())
                    add_groom_version(at->schema());
            } else {
                at = &*there;
            }
            start = end + 1;
        }
        return *at;
    }

    void add_groom_version(Property& schema) {
        Property& properties = schema.add(compound(".userProperties"));
        const int16_t major = 1, minor = 5;
        properties.add(scalar("groom_version_major", Pod::int16, 1, still)).append(file_, bytes_of(major), 1);
        properties.add(scalar("groom_version_minor", Pod::int16, 1, still)).append(file_, bytes_of(minor), 1);
        const std::string tool = program();
        properties.add(scalar("groom_tool", Pod::string, 1, still))
            .append(file_, {tool.c_str(), tool.size() + 1}, 1);
    }

    static void add_points(Property& schema) {
        schema.add(scalar(".selfBnds", Pod::float64, 6, frames, "interpretation=box"));
        schema.add(array("P", Pod::float32, 3, frames, "geoScope=vtx;interpretation=point"));
    }

    // What the first frame says about all frames.
    void begin_curves(Object& o, const CurvesFrame& frame) {
        Property& schema = o.node->schema();
        o.has_velocities = !frame.velocities.empty();
        o.has_wetness = !frame.wetness.empty();
        if (o.has_velocities)
            schema.add(array(".velocities", Pod::float32, 3, frames, "interpretation=vector"));
        if (o.has_wetness) {
            if (!has(schema, ".arbGeomParams")) schema.add(compound(".arbGeomParams"));
            schema.at(".arbGeomParams").add(geometry_parameter("wetness", Pod::float32, 1, frames, "vtx"));
        }
    }
    static bool has(const Property& schema, std::string_view child) {
        return std::any_of(schema.children.begin(), schema.children.end(),
                           [&](const Property& p) { return p.name == child; });
    }

    // What a frame does not say stays as it was: topology and widths.
    static void repeat_others(Property& schema) {
        const uint32_t samples = schema.at("P").samples;
        for (Property& p : schema.children)
            if (p.kind != Kind::compound && p.samples < samples) p.repeat();
    }

    template <class T>
    void require_finite(const Object& o, const std::vector<T>& values, const std::string& where,
                        const char* what) const {
        const std::string_view bytes = bytes_of(values);
        const auto is_finite = [&](size_t k) {
            constexpr uint32_t exponent = 0x7f800000;
            uint32_t bits;
            std::memcpy(&bits, bytes.data() + k * sizeof bits, sizeof bits);
            return (bits & exponent) != exponent;
        };
        const size_t numbers = bytes.size() / sizeof(float);
        bool all = true;
        for (size_t k = 0; k < numbers; ++k) all &= is_finite(k);
        for (size_t k = 0; !all && k < numbers; ++k)
            if (!is_finite(k))
                fail(o.path, where,
                     std::string("a number that is not finite in ") + what + " " +
                         std::to_string(k * sizeof(float) / sizeof(T)),
                     "finite numbers");
    }

    void append_points(Object& o, const std::vector<Vec3f>& points, const std::string& where) {
        require_finite(o, points, where, "point");
        constexpr float far = std::numeric_limits<float>::infinity();
        Vec3f low{far, far, far}, high{-far, -far, -far};
        for (const Vec3f& x : points) low = lower(low, x), high = upper(high, x);
        if (points.empty()) low = high = {0, 0, 0};
        const Box box{{low.x, low.y, low.z}, {high.x, high.y, high.z}};
        Property& schema = o.node->schema();
        schema.at(".selfBnds").append(file_, bytes_of(box), 1);
        schema.at("P").append(file_, points);
    }

    // The group of a property; its header is appended to `headers`, and its digest to `digests`.
    OgawaChild write_property(const Property& p, std::string& headers, std::string& digests) {
        namespace bits = property_bits;
        const size_t longest = std::max<size_t>({p.metadata.size(), p.name.size(), p.samples, p.sampling});
        const uint32_t width_code = longest > 65535 ? 2 : longest > 255 ? 1 : 0;
        const int width = 1 << width_code;
        const uint32_t metadata = table_.number(p.metadata);
        uint32_t info = uint32_t(p.kind) | width_code << bits::width_shift | metadata << bits::metadata_shift;
        const bool constant = p.last_change == 0;
        const bool all_change = !constant && p.first_change == 1 && p.last_change + 1 == p.samples;
        if (p.kind != Kind::compound) {
            info |= uint32_t(p.pod) << bits::pod_shift | p.extent << bits::extent_shift;
            if (p.kind == Kind::array && p.one_element) info |= 1;
            if (p.sampling != 0) info |= bits::has_sampling;
            if (constant) info |= bits::constant;
            if (!constant && !all_change) info |= bits::has_changes;
            if (p.same_size) info |= bits::same_size;
        }
        put(headers, info, 4);
        if (p.kind != Kind::compound) {
            put(headers, p.samples, width);
            if (info & bits::has_changes)
                put(headers, p.first_change, width), put(headers, p.last_change, width);
            if (p.sampling != 0) put(headers, p.sampling, width);
        }
        put(headers, uint32_t(p.name.size()), width), headers += p.name;
        if (metadata == metadata_in_header)
            put(headers, uint32_t(p.metadata.size()), width), headers += p.metadata;

        const auto [group, digest] =
            p.kind == Kind::compound ? write_compound(p) : std::pair(file_.group(p.stored), p.digest);
        std::string said = p.name + p.metadata;
        put(said, info & ~(3u << bits::width_shift | 255u << bits::metadata_shift), 4);
        said += bytes_of(digest);
        digests += bytes_of(ogawa_key(said));
        return group;
    }
    std::pair<OgawaChild, OgawaKey> write_compound(const Property& p) {
        std::vector<OgawaChild> children;
        std::string headers, digests;
        for (const Property& child : p.children) children.push_back(write_property(child, headers, digests));
        if (!headers.empty()) children.push_back(file_.block(headers));
        return {file_.group(children), ogawa_key(digests)};
    }

    // The group of an object, and the digest of it. Its last block ends with the digests of its properties
    // and of its children. Differs: Alembic's library computes these two by SpookyHash; readers compare them
    // with each other only.
    std::pair<OgawaChild, OgawaKey> write_node(const Node& n) {
        const auto [properties, properties_digest] = write_compound(n.properties);
        std::vector<OgawaChild> children{properties};
        std::string headers, digests;
        for (const Node& child : n.children) {
            const auto [group, digest] = write_node(child);
            children.push_back(group);
            put(headers, uint32_t(child.name.size()), 4), headers += child.name;
            const uint32_t metadata = table_.number(child.metadata);
            put(headers, metadata, 1);
            if (metadata == metadata_in_header)
                put(headers, uint32_t(child.metadata.size()), 4), headers += child.metadata;
            digests += child.name + child.metadata;
            digests += bytes_of(digest);
        }
        const OgawaKey children_digest = n.children.empty() ? OgawaKey{} : ogawa_key(digests);
        headers += bytes_of(properties_digest);
        headers += bytes_of(children_digest);
        children.push_back(file_.block(headers));
        return {file_.group(children), ogawa_key(bytes_of(std::array{properties_digest, children_digest}))};
    }

    static std::string fact(const std::string& name) {
        for (const auto& [n, text] : provenance())
            if (n == name) return text;
        return "";
    }
    static std::string program() { return "wetcurl " + fact("version"); }

    // The keys that begin with _ai_ are Alembic's own.
    std::string archive_metadata() const {
        std::vector<std::pair<std::string, std::string>> facts = {
            {"_ai_AlembicVersion", "Alembic 1.8.0 (its layout, written by " + program() + ")"},
            {"_ai_Application", program()},
            {"_ai_DCC_FPS", number(settings_.fps)},
            {"_ai_DateWritten", fact("date")},
            {"_ai_Description", "revision " + fact("revision")},
            {"wetcurl_metres_per_unit", number(settings_.metres_per_unit)},
            {"wetcurl_up", std::string(1, settings_.up)}};
        if (settings_.swaps_y_and_z) facts.emplace_back("wetcurl_swaps", "yz");
        std::string all;
        for (auto& [key, value] : facts) {
            std::replace_if(
                value.begin(), value.end(), [](char c) { return c == ';' || c == '='; }, ' ');
            all += (all.empty() ? "" : ";") + key + "=" + value;
        }
        return all;
    }
    static std::string number(double value) {
        char text[32];
        return {text, std::to_chars(text, text + sizeof text, value).ptr};
    }

    // A time sampling: the number of its samples, seconds a cycle, times of the samples in a cycle.
    std::string time_samplings(uint32_t samples) const {
        std::string all;
        const auto add = [&](uint32_t most, double cycle, double first) {
            put(all, most, 4), all += bytes_of(cycle), put(all, 1, 4), all += bytes_of(first);
        };
        add(1, 1, 0);
        add(samples, settings_.every / settings_.fps, settings_.first_frame / settings_.fps);
        return all;
    }

    SceneFileSettings settings_;
    OgawaWriter file_;
    Node top_;
    std::vector<Object> objects_;
    MetadataTable table_;
};

}  // namespace

std::unique_ptr<SceneWriter> create_abc(const std::string& path, bool overwrite,
                                        const SceneFileSettings& settings) {
    return std::make_unique<AbcWriter>(path, overwrite, settings);
}

}  // namespace wetcurl

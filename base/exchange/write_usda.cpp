// Writing USD text.
#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <map>
#include <span>
#include <utility>

#include "base/error.h"
#include "base/exchange/usda.h"
#include "base/number_text.h"
#include "base/output_file.h"
#include "base/provenance.h"

namespace wetcurl {
namespace {

// Bytes put aside in a file without a name, in the folder of the output: it goes with the process.
class Spool {
  public:
    // `beside` is a file of that folder; `named` begins messages.
    Spool(const std::string& beside, const std::string& named) : named_(named) {
        std::string name = beside + ".XXXXXX";
        descriptor_ = mkostemp(name.data(), O_CLOEXEC);
        if (descriptor_ < 0) fail();
        unlink(name.c_str());
    }
    ~Spool() { close(descriptor_); }
    Spool(const Spool&) = delete;
    Spool& operator=(const Spool&) = delete;

    // Returns where they lie.
    size_t append(std::span<const float> values) {
        const size_t offset = size_;
        const char* bytes = reinterpret_cast<const char*>(values.data());
        for (size_t left = values.size_bytes(); left > 0;) {
            const ssize_t written = pwrite(descriptor_, bytes, left, off_t(size_));
            if (written < 0 && errno == EINTR) continue;
            if (written < 0) fail();
            bytes += written, left -= size_t(written), size_ += size_t(written);
        }
        return offset;
    }
    void read(size_t offset, std::span<float> values) const {
        char* bytes = reinterpret_cast<char*>(values.data());
        for (size_t left = values.size_bytes(); left > 0;) {
            const ssize_t taken = pread(descriptor_, bytes, left, off_t(offset));
            if (taken < 0 && errno == EINTR) continue;
            if (taken <= 0) fail();
            bytes += taken, left -= size_t(taken), offset += size_t(taken);
        }
    }

  private:
    [[noreturn]] void fail() const {
        throw Error(named_ + ": frames cannot be put aside beside it: " + std::strerror(errno));
    }
    std::string named_;
    int descriptor_ = -1;
    size_t size_ = 0;
};

// One attribute over the frames. One that never changes lies in the spool once.
class Track {
  public:
    size_t frames() const { return frames_; }
    bool constant() const { return constant_; }
    size_t size() const { return size_; }
    // Where a frame lies in the spool.
    size_t at(size_t frame) const { return constant_ ? at_[0] : at_[frame]; }

    void add(Spool& spool, std::span<const float> values) {
        if (frames_ == 0) {
            size_ = values.size();
            first_.assign(values.begin(), values.end());
            at_ = {spool.append(values)};
        } else if (!constant_ || std::memcmp(first_.data(), values.data(), values.size_bytes()) != 0) {
            if (std::exchange(constant_, false)) {
                at_.assign(frames_, at_[0]);
                first_ = {};
            }
            at_.push_back(spool.append(values));
        }
        ++frames_;
    }

  private:
    size_t frames_ = 0, size_ = 0;
    bool constant_ = true;
    std::vector<float> first_;  // of the first frame, as long as all others equal it
    std::vector<size_t> at_;    // (frame), or one
};

std::span<const float> floats_of(const std::vector<Vec3f>& vectors) {
    static_assert(sizeof(Vec3f) == 3 * sizeof(float));
    return {reinterpret_cast<const float*>(vectors.data()), 3 * vectors.size()};
}

// Names in USD hold letters, digits and '_', and begin with no digit.
std::string usd_name(const std::string& name) {
    std::string out;
    for (char c : name) {
        const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
        const bool digit = c >= '0' && c <= '9';
        if (digit && out.empty()) out += '_';
        out += letter || digit ? c : '_';
    }
    return out.empty() ? "_" : out;
}

const char* basis_name(CurveBasis basis) {
    switch (basis) {
        case CurveBasis::linear:
            break;
        case CurveBasis::bezier:
            return "bezier";
        case CurveBasis::b_spline:
            return "bspline";
        case CurveBasis::catmull_rom:
            return "catmullRom";
    }
    return nullptr;
}

class UsdaWriter : public SceneWriter {
  public:
    UsdaWriter(const std::string& path, bool overwrite, const SceneFileSettings& settings)
        : settings_(settings), file_(path, overwrite), spool_(file_.partial(), path) {
        if (!(settings.fps > 0) || !std::isfinite(settings.fps))
            throw Misuse(path + ": found " + number_text(settings.fps) + " frames a second, allowed above 0");
        if (!(settings.metres_per_unit > 0) || !std::isfinite(settings.metres_per_unit))
            throw Misuse(path + ": found " + number_text(settings.metres_per_unit) +
                         " metres a unit, allowed above 0");
        if (settings.up != 'y' && settings.up != 'z')
            throw Misuse(path + ": found the up axis '" + std::string(1, settings.up) +
                         "', allowed in a .usda file are y, z");
    }

    size_t add_curves(const CurvesObject& curves) override {
        const size_t strands = curves.counts.size(), points = curves.points();
        const std::string where = file_.path() + ": " + curves.path;
        for (size_t s = 0; s < strands; ++s)
            if (curves.counts[s] < 2)
                throw Error(where + ": strand " + std::to_string(s) + ": found " +
                            std::to_string(curves.counts[s]) + " points, allowed 2 or more");
        auto require = [&](const char* what, size_t found, size_t allowed) {
            if (found != 0 && found != allowed)
                throw Error(where + ": found " + std::to_string(found) + " " + what + ", allowed 0 or " +
                            std::to_string(allowed));
        };
        require("widths", curves.widths.size(), points);
        require("ids", curves.ids.size(), strands);
        require("groups", curves.groups.size(), strands);
        require("uv of roots", curves.root_uv.size(), strands);
        require("marks of guides", curves.is_guide.size(), strands);
        require("guides", curves.guides.size(), strands);
        require("weights of guides", curves.weights.size(), strands);
        Object object;
        object.curves = curves;
        object.points = points;
        for (float width : curves.widths) {
            if (!std::isfinite(width) || width < 0)
                throw Error(where + ": found the width " + number_text(width) + ", allowed 0 or more");
            object.half_width = std::max(object.half_width, width / 2);
        }
        return place(curves.path, std::move(object));
    }

    size_t add_mesh(const MeshObject& mesh) override {
        const std::string where = file_.path() + ": " + mesh.path;
        size_t corners = 0;
        for (int count : mesh.counts) corners += size_t(std::max(count, 0));
        if (corners != mesh.corners.size())
            throw Error(where + ": found " + std::to_string(mesh.corners.size()) + " corners, allowed " +
                        std::to_string(corners) + ", the sum over its faces");
        for (int corner : mesh.corners)
            if (corner < 0 || size_t(corner) >= mesh.points)
                throw Error(where + ": found a corner at point " + std::to_string(corner) +
                            ", allowed 0 up to " + std::to_string(mesh.points) + ", not included");
        Object object;
        object.is_mesh = true;
        object.mesh = mesh;
        object.points = mesh.points;
        return place(mesh.path, std::move(object));
    }

    void append_curves(size_t number, const CurvesFrame& frame) override {
        Object& object = objects_.at(number);
        add_points(object, frame.points);
        add_optional(object, object.velocities, "velocities", floats_of(frame.velocities), 3);
        add_optional(object, object.wetness, "numbers of wetness", frame.wetness, 1);
    }
    void append_mesh(size_t number, const std::vector<Vec3f>& points) override {
        add_points(objects_.at(number), points);
    }

    void finish() override;

  private:
    struct Object {
        bool is_mesh = false;
        CurvesObject curves;
        MeshObject mesh;
        size_t points = 0;
        float half_width = 0;  // the largest
        Track positions, extent, velocities, wetness;
        const std::string& path() const { return is_mesh ? mesh.path : curves.path; }
    };
    struct Node {
        std::string name;
        std::map<std::string, size_t> by_name;
        std::vector<size_t> children;
        int object = -1;
    };

    size_t place(const std::string& path, Object object) {
        if (!objects_.empty() && objects_[0].positions.frames() > 0)
            throw Error(file_.path() + ": " + path +
                        ": found an object after the first frame, allowed before");
        size_t node = 0;
        std::string name;
        auto descend = [&] {
            if (!name.empty()) node = child(node, usd_name(name));
            name.clear();
        };
        for (char c : path)
            if (c == '/')
                descend();
            else
                name += c;
        if (name.empty()) name = object.is_mesh ? "mesh" : "strands";
        name = usd_name(name);
        std::string free = name;
        for (int k = 1; nodes_[node].by_name.contains(free); ++k) free = name + "_" + std::to_string(k);
        node = child(node, free);
        nodes_[node].object = int(objects_.size());
        objects_.push_back(std::move(object));
        return objects_.size() - 1;
    }
    size_t child(size_t parent, const std::string& name) {
        const auto [found, is_new] = nodes_[parent].by_name.try_emplace(name, nodes_.size());
        if (!is_new) return found->second;
        const size_t number = nodes_.size();
        nodes_[parent].children.push_back(number);
        nodes_.emplace_back().name = name;
        return number;
    }
    bool holds_curves(size_t node) const {
        const Node& n = nodes_[node];
        return (n.object >= 0 && !objects_[size_t(n.object)].is_mesh) ||
               std::any_of(n.children.begin(), n.children.end(), [&](size_t c) { return holds_curves(c); });
    }

    // Of a frame that counts from 0.
    long long number_of(size_t frame) const {
        return settings_.first_frame + settings_.every * (long long)(frame);
    }
    [[noreturn]] void fail(const Object& object, size_t frame, const std::string& text) const {
        throw Error(file_.path() + ": " + object.path() + ", frame " + std::to_string(number_of(frame)) +
                    ": " + text);
    }
    void require_finite(const Object& object, size_t frame, const char* what,
                        std::span<const float> values) const {
        for (float value : values)
            if (!std::isfinite(value))
                fail(object, frame,
                     std::string("found ") + what + " that are not finite, allowed are numbers");
    }
    void add_points(Object& object, const std::vector<Vec3f>& points) {
        const size_t frame = object.positions.frames();
        if (points.size() != object.points)
            fail(object, frame,
                 "found " + std::to_string(points.size()) + " points, allowed " +
                     std::to_string(object.points));
        require_finite(object, frame, "points", floats_of(points));
        object.positions.add(spool_, floats_of(points));
        Vec3f low{0, 0, 0}, high{0, 0, 0};
        if (!points.empty()) low = high = points[0];
        for (const auto& x : points) low = lower(low, x), high = upper(high, x);
        const Vec3f by{object.half_width, object.half_width, object.half_width};
        object.extent.add(spool_, floats_of({low - by, high + by}));
    }
    // Of the frame whose points were added last.
    void add_optional(Object& object, Track& track, const char* what, std::span<const float> values,
                      size_t each) {
        const size_t frame = object.positions.frames() - 1;
        if (values.empty() && track.frames() == 0) return;
        if (values.size() != each * object.points || track.frames() != frame)
            fail(object, frame,
                 "found " + std::to_string(values.size() / each) + " " + what + ", and some in " +
                     std::to_string(track.frames()) + " of " + std::to_string(frame) +
                     " frames before; allowed is one a point in all frames, or none in any");
        require_finite(object, frame, what, values);
        track.add(spool_, values);
    }

    // ---- text

    void flush(size_t above = 0) {
        if (text_.size() <= above) return;
        file_.write(text_);
        text_.clear();
    }
    void line(int depth, const std::string& text) {
        text_.append(size_t(4 * depth), ' ').append(text).append("\n");
    }
    // "[(x,y,z),...]" of tuples of `each` numbers, or "[x,...]" of single ones.
    template <class T>
    void array(std::span<const T> values, size_t each);
    template <class T>
    void attribute(int depth, const char* name, std::span<const T> values, size_t each,
                   const char* interpolation = nullptr);
    void track(int depth, const char* name, const Track& track, size_t each,
               const char* interpolation = nullptr);
    void write_prim(int depth, size_t node);
    void write_curves(int depth, const Object& object);
    void write_mesh(int depth, const Object& object);

    SceneFileSettings settings_;
    OutputFile file_;
    Spool spool_;
    std::vector<Object> objects_;
    std::vector<Node> nodes_{1};  // the first is the root
    std::string text_;
};

template <class T>
void append_array_part(std::string& text, std::span<const T> values, size_t each, bool first) {
    for (size_t k = 0; k < values.size(); k += each) {
        if (!std::exchange(first, false)) text += ',';
        if (each > 1) text += '(';
        for (size_t c = 0; c < each; ++c) {
            if (c) text += ',';
            append_number(text, values[k + c]);
        }
        if (each > 1) text += ')';
    }
}

template <class T>
void UsdaWriter::array(std::span<const T> values, size_t each) {
    constexpr size_t block = 12 * 4096, at_once = 16;  // numbers of a thread's piece; pieces in memory
    text_ += '[';
    const size_t blocks = (values.size() + block - 1) / block;
    for (size_t begin = 0; begin < blocks; begin += at_once) {
        std::vector<std::string> parts(std::min(at_once, blocks - begin));
#pragma omp parallel for schedule(dynamic, 1) if (parts.size() > 1)
        for (size_t k = 0; k < parts.size(); ++k) {
            const size_t from = (begin + k) * block;
            append_array_part(parts[k], values.subspan(from, std::min(block, values.size() - from)), each,
                              from == 0);
        }
        for (const auto& part : parts) {
            text_ += part;
            flush(size_t(1) << 20);
        }
    }
    text_ += ']';
}

std::string suffix(const char* interpolation) {
    return interpolation ? std::string(" (\n        interpolation = \"") + interpolation + "\"\n    )" : "";
}

template <class T>
void UsdaWriter::attribute(int depth, const char* name, std::span<const T> values, size_t each,
                           const char* interpolation) {
    if (values.empty()) return;
    text_.append(size_t(4 * depth), ' ').append(name).append(" = ");
    array(values, each);
    line(0, suffix(interpolation));
}

// A value that never changes is written once, without a time; one of a single frame has its time.
void UsdaWriter::track(int depth, const char* name, const Track& track, size_t each,
                       const char* interpolation) {
    if (track.frames() == 0) return;
    std::vector<float> values(track.size());
    auto samples = [&](size_t frame) {
        spool_.read(track.at(frame), values);
        array(std::span<const float>(values), each);
    };
    if (track.constant() && track.frames() > 1) {
        text_.append(size_t(4 * depth), ' ').append(name).append(" = ");
        samples(0);
        return line(0, suffix(interpolation));
    }
    // Metadata stand at a declaration of their own, before the samples, as Pixar's library writes them.
    if (interpolation) line(depth, name + suffix(interpolation));
    line(depth, std::string(name) + ".timeSamples = {");
    for (size_t frame = 0; frame < track.frames(); ++frame) {
        text_.append(size_t(4 * depth + 4), ' ');
        append_number(text_, number_of(frame));
        text_ += ": ";
        samples(frame);
        text_ += ",\n";
    }
    line(depth, "}");
}

void UsdaWriter::write_curves(int depth, const Object& object) {
    const CurvesObject& curves = object.curves;
    if (const char* basis = basis_name(curves.basis)) {
        line(depth, "uniform token type = \"cubic\"");
        line(depth, std::string("uniform token basis = \"") + basis + "\"");
    } else {
        line(depth, "uniform token type = \"linear\"");
    }
    line(depth, "uniform token wrap = \"nonperiodic\"");
    attribute(depth, "int[] curveVertexCounts", std::span(curves.counts), 1);
    attribute(depth, "float[] widths", std::span(curves.widths), 1, "vertex");
    attribute(depth, "int[] primvars:groom_id", std::span(curves.ids), 1, "uniform");
    attribute(depth, "int[] primvars:groom_group_id", std::span(curves.groups), 1, "uniform");
    const std::vector<int> is_guide(curves.is_guide.begin(), curves.is_guide.end());
    attribute(depth, "int[] primvars:groom_guide", std::span(is_guide), 1, "uniform");
    auto flat = [](const auto& rows) {
        std::vector<std::decay_t<decltype(rows[0][0])>> all;
        for (const auto& row : rows) all.insert(all.end(), row.begin(), row.end());
        return all;
    };
    const auto root_uv = flat(curves.root_uv), weights = flat(curves.weights);
    const auto guides = flat(curves.guides);
    attribute(depth, "float2[] primvars:groom_root_uv", std::span(root_uv), 2, "uniform");
    attribute(depth, "int3[] primvars:groom_closest_guides", std::span(guides), 3, "uniform");
    attribute(depth, "float3[] primvars:groom_guide_weights", std::span(weights), 3, "uniform");
    track(depth, "float3[] extent", object.extent, 3);
    track(depth, "point3f[] points", object.positions, 3);
    track(depth, "vector3f[] velocities", object.velocities, 3);
    track(depth, "float[] primvars:wetness", object.wetness, 1, "vertex");
}

void UsdaWriter::write_mesh(int depth, const Object& object) {
    line(depth, "uniform token subdivisionScheme = \"none\"");
    attribute(depth, "int[] faceVertexCounts", std::span(object.mesh.counts), 1);
    attribute(depth, "int[] faceVertexIndices", std::span(object.mesh.corners), 1);
    track(depth, "float3[] extent", object.extent, 3);
    track(depth, "point3f[] points", object.positions, 3);
}

void UsdaWriter::write_prim(int depth, size_t number) {
    const Node& node = nodes_[number];
    const Object* object = node.object < 0 ? nullptr : &objects_[size_t(node.object)];
    const char* type = !object ? "Xform" : object->is_mesh ? "Mesh" : "BasisCurves";
    line(depth, std::string("def ") + type + " \"" + node.name + "\"");
    if (depth == 0 && !object && holds_curves(number)) {
        line(depth, "(");
        line(depth + 1, "prepend apiSchemas = [\"GroomAPI\"]");
        line(depth, ")");
    }
    line(depth, "{");
    if (object) object->is_mesh ? write_mesh(depth + 1, *object) : write_curves(depth + 1, *object);
    for (size_t child : node.children) write_prim(depth + 1, child);
    line(depth, "}");
    flush();
}

void UsdaWriter::finish() {
    if (objects_.empty()) throw Error(file_.path() + ": found no object to write, allowed 1 or more");
    const size_t frames = objects_[0].positions.frames();
    for (const auto& object : objects_)
        if (object.positions.frames() == 0 || object.positions.frames() != frames)
            throw Error(file_.path() + ": " + object.path() + ": found " +
                        std::to_string(object.positions.frames()) +
                        " frames, allowed 1 or more, as many as " + objects_[0].path() + ", which has " +
                        std::to_string(frames));
    std::string doc = "wetcurl";
    for (const auto& [fact, value] : provenance())
        if (fact == "version" || fact == "revision") doc += " " + value;
    line(0, "#usda 1.0");
    line(0, "(");
    line(1, "defaultPrim = \"" + nodes_[nodes_[0].children[0]].name + "\"");
    line(1, "doc = \"" + doc + "\"");
    line(1, "endTimeCode = " + number_text(number_of(frames - 1)));
    line(1, "framesPerSecond = " + number_text(settings_.fps));
    line(1, "metersPerUnit = " + number_text(settings_.metres_per_unit));
    line(1, "startTimeCode = " + number_text(settings_.first_frame));
    line(1, "timeCodesPerSecond = " + number_text(settings_.fps));
    line(1, std::string("upAxis = \"") + (settings_.up == 'y' ? "Y" : "Z") + "\"");
    line(0, ")");
    for (size_t top : nodes_[0].children) {
        line(0, "");
        write_prim(0, top);
    }
    flush();
    file_.commit();
}

}  // namespace

std::unique_ptr<SceneWriter> create_usda(const std::string& path, bool overwrite,
                                         const SceneFileSettings& settings) {
    return std::make_unique<UsdaWriter>(path, overwrite, settings);
}

}  // namespace wetcurl

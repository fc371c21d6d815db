// Reading USD text: the tree of prims, of which curves and meshes with their transforms are kept. Points are
// read when they are asked for. Semantics of transforms: UsdGeomXformable, of curves: UsdGeomBasisCurves.
#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/exchange/row_matrix.h"
#include "base/exchange/usda.h"
#include "base/exchange/usda_text.h"
#include "base/file_ending.h"
#include "base/lfs_pointer.h"
#include "base/log.h"
#include "base/number_text.h"

namespace wetcurl {
namespace {

// ---- transforms

double& component(Vec3d& x, int axis) { return axis == 0 ? x.x : axis == 1 ? x.y : x.z; }

// Degrees.
RowMatrix rotation_about_axis(int axis, double angle) {
    Vec3d direction{0, 0, 0};
    component(direction, axis) = 1;
    return row_matrix_of(rotation_about(direction, angle * std::acos(-1.0) / 180));
}

// One of an object's transforms over time.
struct XformOp {
    // translate and scale along `axes`, rotate about them one after another; orient by a quaternion.
    enum class Kind { translate, scale, rotate, orient, matrix } kind = Kind::matrix;
    std::vector<int> axes;
    bool inverse = false;
    std::vector<double> times;  // [time code]; empty: one value for all times
    std::vector<std::vector<double>> values;

    RowMatrix at(double time) const;
    RowMatrix of(const std::vector<double>& v) const;
};

RowMatrix XformOp::of(const std::vector<double>& v) const {
    RowMatrix out;
    switch (kind) {
        case Kind::translate:
            for (size_t k = 0; k < axes.size(); ++k) out.m[3][axes[k]] = v[k];
            break;
        case Kind::scale:
            for (size_t k = 0; k < axes.size(); ++k) out.m[axes[k]][axes[k]] = v[k];
            break;
        case Kind::rotate:
            // "(x, y, z)" stay in this order whatever the order of turning.
            for (int axis : axes)
                out = out * rotation_about_axis(axis, v[axes.size() == 1 ? 0 : size_t(axis)]);
            break;
        case Kind::orient:
            out = row_matrix_of(normalized(Quatd{v[0], v[1], v[2], v[3]}));
            break;
        case Kind::matrix:
            for (size_t k = 0; k < 16; ++k) out.m[k / 4][k % 4] = v[k];
    }
    return inverse ? out.inverse() : out;
}

// The samples on both sides of a time, and how far it lies from the first to the second; one where it is a
// sample's own or lies outside.
struct Between {
    size_t a, b;
    double t;
};
template <class TimeOf>
Between between(size_t count, TimeOf time_of, double time) {
    size_t after = 0, end = count;
    while (after < end)
        if (const size_t middle = (after + end) / 2; time_of(middle) <= time)
            after = middle + 1;
        else
            end = middle;
    if (after == 0) return {0, 0, 0};
    const size_t before = after - 1;
    if (after == count || time_of(before) == time) return {before, before, 0};
    return {before, after, (time - time_of(before)) / (time_of(after) - time_of(before))};
}

RowMatrix XformOp::at(double time) const {
    if (times.empty()) return of(values[0]);
    const Between at = between(
        times.size(), [&](size_t k) { return times[k]; }, time);
    if (at.a == at.b) return of(values[at.a]);
    const auto &from = values[at.a], &to = values[at.b];
    double along = 1 - at.t, beyond = at.t;
    if (kind == Kind::orient) {
        // On the arc between the two quaternions, the shorter way.
        double cosine = 0, a = 0, b = 0;
        for (size_t k = 0; k < 4; ++k) cosine += from[k] * to[k], a += from[k] * from[k], b += to[k] * to[k];
        cosine /= std::sqrt(a * b);
        const double sign = cosine < 0 ? -1 : 1;
        const double angle = std::acos(std::min(1.0, std::abs(cosine)));
        if (angle > 1e-6) along = std::sin((1 - at.t) * angle), beyond = std::sin(at.t * angle);
        beyond *= sign;
    }
    std::vector<double> mixed(from.size());
    for (size_t k = 0; k < mixed.size(); ++k) mixed[k] = along * from[k] + beyond * to[k];
    return of(mixed);
}

// A prim, for what stands below it.
struct Node {
    int parent = -1;
    std::string path;
    bool resets = false;            // the transforms above it do not count
    std::vector<XformOp> ops = {};  // the first is the outermost
    bool is_invisible = false;      // at all times
    std::string purpose = {};       // empty: that of the prim above
};

// ---- attributes

struct Sample {
    double time;
    TextSpan value;
};
struct Attribute {
    std::optional<TextSpan> value;  // without a time
    std::vector<Sample> samples;    // times rise; before `value`
    std::string interpolation;

    bool empty() const { return !value && samples.empty(); }
    const TextSpan& first() const { return samples.empty() ? *value : samples[0].value; }
    // The sample that holds at a time, where nothing is interpolated.
    const TextSpan& held(double time) const {
        if (samples.empty()) return *value;
        return samples[between(
                           samples.size(), [&](size_t k) { return samples[k].time; }, time)
                           .a]
            .value;
    }
};
using Attributes = std::map<std::string, Attribute, std::less<>>;

constexpr std::string_view kept_names[] = {"points",
                                           "curveVertexCounts",
                                           "type",
                                           "basis",
                                           "wrap",
                                           "widths",
                                           "faceVertexCounts",
                                           "faceVertexIndices",
                                           "orientation",
                                           "visibility",
                                           "purpose",
                                           "xformOpOrder",
                                           "primvars:widths",
                                           "primvars:groom_id",
                                           "primvars:id",
                                           "primvars:groom_group_id",
                                           "primvars:groom_guide",
                                           "primvars:groom_closest_guides",
                                           "primvars:groom_guide_weights",
                                           "primvars:groom_root_uv",
                                           "primvars:st",
                                           "primvars:st:indices",
                                           "primvars:surface_uv_coordinate"};
bool is_kept(std::string_view name) {
    return name.starts_with("xformOp:") ||
           std::find(std::begin(kept_names), std::end(kept_names), name) != std::end(kept_names);
}

enum class Wrap { open, pinned };

// What reading the points of an object needs.
struct Source {
    size_t node;
    Attribute points, counts, corners;
    std::vector<double> codes;  // (sample) time codes
    Wrap wrap = Wrap::open;
    size_t stored = 0;  // points in the file
};

// ---- the reader

class UsdaReader : public SceneReader {
  public:
    explicit UsdaReader(const std::string& path) : file_(path), in_(file_) {
        refuse_other_kinds();
        read_layer();
        finish();
    }

    const FileAxes& axes() const override { return axes_; }
    const std::vector<CurvesObject>& curves() const override { return curves_; }
    const std::vector<MeshObject>& meshes() const override { return meshes_; }
    std::vector<Vec3f> points_of_curves(size_t object, size_t sample) const override;
    std::vector<Vec3f> points_of_mesh(size_t object, size_t sample) const override;

  private:
    void refuse_other_kinds();
    void read_layer();
    template <class Handle>
    void read_metadata(Handle handle);
    void read_prim(bool is_real, int parent, int depth);
    void read_property(bool is_kept_prim, Attributes& attributes, bool& is_skinned, std::string word,
                       size_t line);
    void read_samples(Attribute& attribute);
    void note(const char* what) { notes_.try_emplace(what, in_.line()); }
    void finish_prim(size_t node, const std::string& type, const Attributes& attributes);
    std::vector<XformOp> read_ops(const Attributes& attributes, bool& resets) const;
    void add_curves(size_t node, const Attributes& attributes);
    void add_mesh(size_t node, const Attributes& attributes);
    std::vector<float> read_widths(const Attributes& attributes, const CurvesObject& curves,
                                   const std::vector<int>& counts, Wrap wrap) const;
    std::vector<double> codes_of(const Source& source) const;
    void finish();

    UsdaValues values(const TextSpan& span) const { return UsdaValues(file_, span); }
    // A word of an attribute, or `otherwise`.
    std::string token(const Attributes& attributes, const char* name, const char* otherwise) const {
        const auto found = attributes.find(name);
        return found == attributes.end() || found->second.empty() ? otherwise
                                                                  : values(found->second.first()).string();
    }
    // The first of these attributes that is there.
    const Attribute* find(const Attributes& attributes, std::initializer_list<const char*> names) const {
        for (const char* name : names)
            if (const auto found = attributes.find(name); found != attributes.end() && !found->second.empty())
                return &found->second;
        return nullptr;
    }
    std::string where(const std::string& object) const { return file_.path() + ": " + object; }
    std::string where(const std::string& object, const Attribute& attribute) const {
        return file_.path() + ":" + std::to_string(attribute.first().line) + ": " + object;
    }
    // Values one a strand, where the file has as many; else a warning.
    template <class Values>
    Values one_a_strand(Values values, size_t strands, const std::string& object, const char* what) const {
        if (values.size() == strands) return values;
        log_warning(where(object) + ": found " + std::to_string(values.size()) + " " + what + " for " +
                    std::to_string(strands) + " strands; left out");
        return {};
    }
    std::vector<std::array<float, 3>> stored_points(const Source& source, double time) const;
    std::vector<Vec3f> points_of(const Source& source, const std::string& object, size_t sample) const;
    RowMatrix world_of(size_t node, double time) const;
    bool is_invisible(const Attributes& attributes) const;
    std::string hidden(size_t node) const;

    TextFile file_;
    UsdaScanner in_;
    FileAxes axes_;
    std::optional<double> codes_a_second_, frames_a_second_, start_code_;
    std::vector<Node> nodes_;
    std::vector<CurvesObject> curves_;
    std::vector<MeshObject> meshes_;
    std::vector<Source> of_curves_, of_meshes_;
    std::vector<bool> left_handed_;        // (mesh)
    std::map<std::string, size_t> notes_;  // what is not followed, and its first line
};

void UsdaReader::refuse_other_kinds() {
    std::string start(64, '\0');
    start.resize(file_.read(0, start.data(), start.size()));
    refuse_lfs_pointer(start, file_.path());
    // Not onto itself.
    const std::string text = ending_of(file_.path()) == ".usda" ? "_text.usda" : ".usda";
    const std::string convert = "`usdcat " + file_.path() + " -o " +
                                file_.path().substr(0, file_.path().find_last_of('.')) + text +
                                "` turns it into text, which is read";
    if (start.starts_with("PXR-USDC")) throw Error(file_.path() + ": found binary USD; " + convert);
    if (start.starts_with("PK\x03\x04")) throw Error(file_.path() + ": found a package (.usdz); " + convert);
    std::string first = in_.line_text();
    if (first.starts_with("\xef\xbb\xbf")) first.erase(0, 3);
    if (!first.starts_with("#usda ") && !first.starts_with("#sdf "))
        throw Error(file_.path() + ":1: found another first line than \"#usda 1.0\": this is no USD text");
}

// "(", then texts and `key = value`, ")". handle(key) takes the value and returns true, or returns false.
template <class Handle>
void UsdaReader::read_metadata(Handle handle) {
    in_.expect('(', "that begins metadata");
    while (!in_.take_if(')')) {
        if (in_.take_if(';') || in_.take_if(',')) continue;
        if (in_.next_is_quote()) {
            in_.skip_value();
            continue;
        }
        std::string key = in_.word("metadata or ')'");
        if (in_.next_is_word()) key = in_.word("metadata");  // after add, append, prepend, delete, reorder
        in_.expect('=', "after the name of metadata");
        if (!handle(key)) in_.skip_value();
        // Of references: a path and an offset in time.
        while (in_.next_is('<') || in_.next_is('(')) in_.skip_value();
    }
}

void UsdaReader::read_layer() {
    auto number = [&](const char* what, bool above_0 = true) {
        const size_t line = in_.line();
        const std::string text = in_.scalar(what);
        double value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value) ||
            (above_0 && !(value > 0)))
            file_.fail(line, "'" + text + "'", std::string(what) + (above_0 ? " above 0" : ""));
        return value;
    };
    if (in_.next_is('('))
        read_metadata([&](const std::string& key) {
            if (key == "metersPerUnit") {
                axes_.metres_per_unit = number("metersPerUnit");
            } else if (key == "timeCodesPerSecond") {
                codes_a_second_ = number("timeCodesPerSecond");
            } else if (key == "startTimeCode") {
                start_code_ = number("startTimeCode", false);
            } else if (key == "framesPerSecond") {
                frames_a_second_ = number("framesPerSecond");
            } else if (key == "upAxis") {
                const std::string axis = in_.scalar("an axis");
                if (axis != "X" && axis != "Y" && axis != "Z")
                    file_.fail(in_.line(), "the up axis '" + axis + "'", "\"Y\" or \"Z\"");
                axes_.up = char(axis[0] - 'A' + 'a');
            } else {
                if (key == "subLayers") note("sublayers");
                return false;
            }
            return true;
        });
    while (!in_.at_end()) {
        if (in_.take_if(';')) continue;
        const std::string word = in_.word("def, over or class");
        if (word == "def" || word == "over" || word == "class") {
            read_prim(word == "def", -1, 0);
        } else if (word == "reorder") {
            in_.word("rootPrims");
            in_.expect('=', "after rootPrims");
            in_.skip_value();
        } else {
            file_.fail(in_.line(), "'" + word + "'", "def, over or class");
        }
    }
}

// Behind `def`, `over` or `class`. `is_real`: it and all above it are defined and active.
void UsdaReader::read_prim(bool is_real, int parent, int depth) {
    constexpr int deepest = 200;
    if (depth > deepest) in_.fail("at most 200 prims inside each other");
    std::string type;
    if (in_.next_is_word()) type = in_.word("the type of a prim");
    const std::string name = in_.quoted("the name of a prim");
    const size_t number = nodes_.size();
    nodes_.push_back({parent, (parent < 0 ? "" : nodes_[size_t(parent)].path) + "/" + name});
    if (in_.next_is('('))
        read_metadata([&](const std::string& key) {
            for (const char* arc : {"references", "payload", "inherits", "specializes", "clips"})
                if (key == arc) note(arc);
            if (key != "active") return false;
            const std::string active = in_.scalar("true or false");
            is_real = is_real && active != "false" && active != "0";
            return true;
        });
    in_.expect('{', "that begins a prim");
    Attributes attributes;
    bool is_skinned = false;
    while (!in_.take_if('}')) {
        if (in_.take_if(';')) continue;
        if (!in_.next_is_word()) in_.fail("a property, a prim or '}'");
        const size_t line = in_.line();
        const std::string word = in_.word("a property");
        if (word == "def" || word == "over" || word == "class") {
            read_prim(is_real && word == "def", int(number), depth + 1);
        } else if (word == "variantSet") {
            note("variants");
            in_.quoted("the name of a variant set");
            in_.expect('=', "after the name of a variant set");
            in_.skip_value();
        } else {
            read_property(is_real, attributes, is_skinned, word, line);
        }
    }
    if (!is_real) return;
    if (is_skinned && (type == "Mesh" || type == "BasisCurves"))
        log_warning(
            where(nodes_[number].path) +
            ": moves by a skeleton (UsdSkel), which is not evaluated: it is read in its rest shape; export "
            "it with its deformation baked into points");
    finish_prim(number, type, attributes);
}

void UsdaReader::read_samples(Attribute& attribute) {
    attribute.samples.clear();
    in_.expect('{', "that begins time samples");
    while (!in_.take_if('}')) {
        if (in_.take_if(',')) continue;
        const size_t line = in_.line();
        const std::string text = in_.scalar("a time code or '}'");
        double time = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), time);
        if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(time))
            file_.fail(line, "'" + text + "'", "a time code");
        in_.expect(':', "after a time code");
        const bool blocked = in_.next_is('N');  // None
        const TextSpan value = in_.value();
        if (!blocked) attribute.samples.push_back({time, value});
    }
    auto& samples = attribute.samples;
    std::stable_sort(samples.begin(), samples.end(),
                     [](const Sample& a, const Sample& b) { return a.time < b.time; });
    // Of two at one time the later holds.
    size_t kept = 0;
    for (size_t k = 0; k < samples.size(); ++k) {
        if (kept > 0 && samples[kept - 1].time == samples[k].time) --kept;
        samples[kept++] = samples[k];
    }
    samples.resize(kept);
}

// [custom] [uniform] TYPE NAME[.timeSamples] [= VALUE] [(METADATA)], or a relationship, whose type is "rel".
void UsdaReader::read_property(bool is_kept_prim, Attributes& attributes, bool& is_skinned, std::string word,
                               size_t line) {
    auto is_one_of = [](const std::string& text, std::initializer_list<const char*> words) {
        return std::find(words.begin(), words.end(), text) != words.end();
    };
    bool reorders = false;
    while (is_one_of(
        word, {"custom", "uniform", "varying", "config", "add", "delete", "prepend", "append", "reorder"})) {
        reorders = word == "reorder";
        word = in_.word("the type of a property");
    }
    if (reorders && is_one_of(word, {"nameChildren", "properties"})) {
        in_.expect('=', "after what is put in order");
        return in_.skip_value();
    }
    if (in_.take_if('[')) in_.expect(']', "of an array's type");
    const std::string name = in_.word("the name of a property");
    std::string suffix;
    if (in_.take_if('.')) suffix = in_.word("timeSamples, connect or spline");
    is_skinned = is_skinned || is_one_of(name, {"skel:skeleton", "primvars:skel:jointIndices"});
    const bool is_kept_one = is_kept_prim && word != "rel" && is_kept(name);
    Attribute* attribute = is_kept_one ? &attributes[name] : nullptr;
    if (in_.take_if('=')) {
        if (attribute && suffix == "timeSamples") {
            read_samples(*attribute);
        } else if (attribute && suffix.empty()) {
            const bool blocked = in_.next_is('N');
            const TextSpan value = in_.value();
            attribute->value = blocked ? std::nullopt : std::optional(value);
        } else {
            in_.skip_value();
        }
    } else if (!suffix.empty()) {
        file_.fail(line, "'" + name + "." + suffix + "' without a value", "'='");
    }
    if (in_.next_is('('))
        read_metadata([&](const std::string& key) {
            if (!attribute || key != "interpolation") return false;
            attribute->interpolation = in_.scalar("an interpolation");
            return true;
        });
}

// ---- objects

// `ops` of a prim: xformOp:TYPE[:NAME], each perhaps inverted.
std::vector<XformOp> UsdaReader::read_ops(const Attributes& attributes, bool& resets) const {
    std::vector<XformOp> ops;
    const Attribute* order = find(attributes, {"xformOpOrder"});
    if (!order) return ops;
    for (std::string name : values(order->first()).strings()) {
        if (name == "!resetXformStack!") {
            resets = true;
            ops.clear();
            continue;
        }
        XformOp op;
        constexpr std::string_view inverted = "!invert!";
        if (name.starts_with(inverted)) {
            op.inverse = true;
            name.erase(0, inverted.size());
        }
        const Attribute* attribute = find(attributes, {name.c_str()});
        if (!attribute) continue;  // nothing to apply, as in USD
        std::string type = name.substr(name.find(':') + 1);
        type = type.substr(0, type.find(':'));
        const size_t line = attribute->first().line;
        auto fail = [&](const std::string& found, const std::string& expected) {
            file_.fail(line, found, expected);
        };

        size_t numbers = 0;
        using Kind = XformOp::Kind;
        for (const auto& [start, kind] :
             {std::pair{"translate", Kind::translate}, {"scale", Kind::scale}, {"rotate", Kind::rotate}})
            if (type.starts_with(start)) {
                op.kind = kind;
                for (char c : type.substr(std::string_view(start).size()))
                    op.axes.push_back(c >= 'X' && c <= 'Z' ? c - 'X' : 3);
                if (op.axes.empty() && kind != Kind::rotate) op.axes = {0, 1, 2};
                numbers = op.axes.size();
            }
        std::vector<int> sorted = op.axes;
        std::sort(sorted.begin(), sorted.end());
        bool known = sorted.size() == 1 ? sorted[0] < 3 : sorted == std::vector{0, 1, 2};
        if (type == "orient") op.kind = Kind::orient, numbers = 4, known = true;
        if (type == "transform") op.kind = Kind::matrix, numbers = 16, known = true;
        if (!known)
            fail("the transform '" + name + "'",
                 "translate, scale, rotateX, rotateXYZ and the like, orient or transform");
        auto take = [&](const TextSpan& span) {
            std::vector<double> v = values(span).flat();
            if (v.size() != numbers)
                file_.fail(span.line, std::to_string(v.size()) + " numbers of '" + name + "'",
                           std::to_string(numbers));
            if (op.kind == Kind::matrix && (v[3] != 0 || v[7] != 0 || v[11] != 0 || v[15] != 1))
                file_.fail(span.line, "a matrix whose last column is not (0, 0, 0, 1)",
                           "an affine transform");
            if (op.kind == Kind::orient && v[0] == 0 && v[1] == 0 && v[2] == 0 && v[3] == 0)
                file_.fail(span.line, "a quaternion of length 0", "a rotation");
            if (op.inverse) {
                XformOp forward = op;
                forward.inverse = false;
                if (forward.of(v).determinant() == 0)
                    file_.fail(span.line, "'" + name + "' without an inverse", "one, for it is inverted");
            }
            op.values.push_back(std::move(v));
        };
        if (attribute->samples.empty()) take(*attribute->value);
        for (const auto& sample : attribute->samples) {
            take(sample.value);
            op.times.push_back(sample.time);
        }
        ops.push_back(std::move(op));
    }
    return ops;
}

void UsdaReader::finish_prim(size_t number, const std::string& type, const Attributes& attributes) {
    bool resets = false;
    auto ops = read_ops(attributes, resets);
    nodes_[number].ops = std::move(ops);
    nodes_[number].resets = resets;
    nodes_[number].is_invisible = is_invisible(attributes);
    nodes_[number].purpose = token(attributes, "purpose", "");
    if (type == "BasisCurves") add_curves(number, attributes);
    if (type == "Mesh") add_mesh(number, attributes);
    if (type == "NurbsCurves" || type == "HermiteCurves")
        log_warning(where(nodes_[number].path) + ": found " + type +
                    ", which are not read; export them as BasisCurves");
}

// ---- curves

CurveBasis basis_of(const std::string& type, const std::string& basis) {
    if (type == "linear") return CurveBasis::linear;
    if (basis == "bspline") return CurveBasis::b_spline;
    if (basis == "catmullRom") return CurveBasis::catmull_rom;
    return CurveBasis::bezier;
}

// Values that USD calls varying, of an open or pinned curve of `points` control points.
size_t varying_values(CurveBasis basis, Wrap wrap, int points) {
    if (basis == CurveBasis::linear || wrap == Wrap::pinned) return size_t(points);
    if (basis == CurveBasis::bezier) return size_t(std::max(0, (points - 1) / 3 + 1));
    return size_t(std::max(0, points - 2));
}

// Widths as they stand in the file to one a control point: one for all, one a strand, one a control point, or
// one a knot.
std::vector<float> UsdaReader::read_widths(const Attributes& attributes, const CurvesObject& curves,
                                           const std::vector<int>& counts, Wrap wrap) const {
    const Attribute* attribute = find(attributes, {"primvars:widths", "widths"});
    if (!attribute) return {};
    const auto given = values(attribute->first()).numbers<float>();
    size_t points = 0, knots = 0;
    for (int count : counts) points += size_t(count), knots += varying_values(curves.basis, wrap, count);
    const std::string& said = attribute->interpolation;
    enum { constant, uniform, vertex, varying } kind;
    if (given.size() == 1 && (said == "constant" || (points != 1 && counts.size() != 1)))
        kind = constant;
    else if (given.size() == counts.size() && (said == "uniform" || given.size() != points))
        kind = uniform;
    else if (given.size() == points && (said != "varying" || points == knots))
        kind = vertex;
    else if (given.size() == knots)
        kind = varying;
    else {
        if (!given.empty())
            log_warning(where(curves.path) + ": found " + std::to_string(given.size()) +
                        " widths, expected 1, " + std::to_string(counts.size()) + " (strands), " +
                        std::to_string(points) + " (control points) or " + std::to_string(knots) +
                        " (knots); left out");
        return {};
    }
    for (float width : given)
        if (width < 0) {
            log_warning(where(curves.path) + ": found the width " + number_text(width) +
                        ", expected 0 or more; widths are left out");
            return {};
        }
    std::vector<float> out;
    out.reserve(points);
    auto next = given.begin();
    for (size_t s = 0; s < counts.size(); ++s) {
        const int count = counts[s], values = int(varying_values(curves.basis, wrap, count));
        const size_t begin = out.size();
        for (int i = 0; i < count; ++i) {
            if (kind == constant) {
                out.push_back(given[0]);
            } else if (kind == uniform) {
                out.push_back(given[s]);
            } else if (kind == vertex) {
                out.push_back(*next++);
            } else if (values == 0) {
                out.push_back(given[0]);
            } else if (curves.basis == CurveBasis::bezier) {
                // A knot at each third control point.
                const int a = std::min(i / 3, values - 1), b = std::min(a + 1, values - 1);
                const float t = float(i % 3) / 3;
                out.push_back((1 - t) * next[a] + t * next[b]);
            } else {
                out.push_back(next[std::clamp(i - 1, 0, values - 1)]);
            }
        }
        if (kind == varying) next += values;
        if (wrap == Wrap::pinned && count > 0) {
            out.insert(out.begin() + long(begin), out[begin]);
            out.push_back(out.back());
        }
    }
    return out;
}

void UsdaReader::add_curves(size_t node, const Attributes& attributes) {
    CurvesObject curves;
    curves.path = nodes_[node].path;
    Source source{node, {}, {}, {}, {}, Wrap::open, 0};
    const Attribute *points = find(attributes, {"points"}), *counts = find(attributes, {"curveVertexCounts"});
    if (!points || !counts) {
        log_warning(where(curves.path) + ": curves without " + (points ? "curveVertexCounts" : "points") +
                    " in this file; left out");
        return;
    }
    source.points = *points, source.counts = *counts;
    const std::string type = token(attributes, "type", "cubic"), basis = token(attributes, "basis", "bezier"),
                      wrap = token(attributes, "wrap", "nonperiodic");
    if (wrap == "periodic") {
        log_warning(where(curves.path) + ": found closed curves, which are no strands; left out");
        return;
    }
    curves.basis = basis_of(type, basis);
    if (type != "linear" && type != "cubic")
        throw Error(where(curves.path) + ": found curves of type '" + type + "', expected linear or cubic");
    if (curves.basis == CurveBasis::bezier && basis != "bezier")
        throw Error(where(curves.path) + ": found curves of basis '" + basis +
                    "', expected bezier, bspline or catmullRom");
    // Of Bezier curves and linear ones the word changes nothing.
    if (wrap == "pinned" && (curves.basis == CurveBasis::b_spline || curves.basis == CurveBasis::catmull_rom))
        source.wrap = Wrap::pinned;

    const auto in_file = values(counts->first()).numbers<int>();
    for (size_t s = 0; s < in_file.size(); ++s) {
        if (in_file[s] < 0)
            throw Error(where(curves.path, *counts) + ": strand " + std::to_string(s) + ": found " +
                        std::to_string(in_file[s]) + " points, expected 0 or more");
        source.stored += size_t(in_file[s]);
        curves.counts.push_back(in_file[s]);
    }
    if (in_file.empty()) return;
    // The first sample is judged here: whatever is made to match the counts can then be no larger than the
    // file.
    if (const size_t found = values(points->first()).tuples<float, 3>().size(); found != source.stored)
        throw Error(where(curves.path, *points) + ": found " + std::to_string(found) + " points, expected " +
                    std::to_string(source.stored) + ", the sum of curveVertexCounts");
    if (source.wrap == Wrap::pinned)
        for (int& count : curves.counts)
            if (count > 0) count += 2;
    const size_t strands = in_file.size();
    curves.widths = read_widths(attributes, curves, in_file, source.wrap);
    if (const Attribute* ids = find(attributes, {"primvars:groom_id", "primvars:id"}))
        curves.ids = one_a_strand(values(ids->first()).numbers<int>(), strands, curves.path, "ids");
    if (const Attribute* groups = find(attributes, {"primvars:groom_group_id"}))
        curves.groups = one_a_strand(values(groups->first()).numbers<int>(), strands, curves.path, "groups");
    if (const Attribute* marks = find(attributes, {"primvars:groom_guide"})) {
        const auto found =
            one_a_strand(values(marks->first()).numbers<int>(), strands, curves.path, "marks of guides");
        for (int mark : found) curves.is_guide.push_back(mark != 0);
    }
    if (const Attribute* guides = find(attributes, {"primvars:groom_closest_guides"}))
        curves.guides =
            one_a_strand(values(guides->first()).tuples<int, 3>(), strands, curves.path, "guides");
    if (const Attribute* weights = find(attributes, {"primvars:groom_guide_weights"}))
        curves.weights = one_a_strand(values(weights->first()).tuples<float, 3>(), strands, curves.path,
                                      "weights of guides");
    if (const Attribute* uv = find(attributes, {"primvars:groom_root_uv", "primvars:surface_uv_coordinate"}))
        curves.root_uv =
            one_a_strand(values(uv->first()).tuples<float, 2>(), strands, curves.path, "uv of roots");
    else if (const Attribute* st = find(attributes, {"primvars:st"}); st && st->interpolation == "uniform") {
        auto uv_of_st = values(st->first()).tuples<float, 2>();
        if (const Attribute* indices = find(attributes, {"primvars:st:indices"})) {
            std::vector<std::array<float, 2>> looked_up;
            for (int index : values(indices->first()).numbers<int>())
                if (index >= 0 && size_t(index) < uv_of_st.size())
                    looked_up.push_back(uv_of_st[size_t(index)]);
            uv_of_st = std::move(looked_up);
        }
        curves.root_uv = one_a_strand(std::move(uv_of_st), strands, curves.path, "uv of roots");
    }
    curves_.push_back(std::move(curves));
    of_curves_.push_back(std::move(source));
}

// ---- meshes

void UsdaReader::add_mesh(size_t node, const Attributes& attributes) {
    MeshObject mesh;
    mesh.path = nodes_[node].path;
    Source source{node, {}, {}, {}, {}, Wrap::open, 0};
    const Attribute *points = find(attributes, {"points"}), *counts = find(attributes, {"faceVertexCounts"}),
                    *corners = find(attributes, {"faceVertexIndices"});
    if (!points || !counts || !corners) {
        log_warning(where(mesh.path) + ": a mesh without " +
                    (!points   ? "points"
                     : !counts ? "faceVertexCounts"
                               : "faceVertexIndices") +
                    " in this file; left out");
        return;
    }
    source.points = *points, source.counts = *counts, source.corners = *corners;
    mesh.counts = values(counts->first()).numbers<int>();
    mesh.corners = values(corners->first()).numbers<int>();
    mesh.points = source.stored = values(points->first()).tuples<float, 3>().size();
    size_t sum = 0;
    for (size_t f = 0; f < mesh.counts.size(); ++f) {
        if (mesh.counts[f] < 0)
            throw Error(where(mesh.path, *counts) + ": face " + std::to_string(f) + ": found " +
                        std::to_string(mesh.counts[f]) + " corners, expected 0 or more");
        sum += size_t(mesh.counts[f]);
    }
    if (sum != mesh.corners.size())
        throw Error(where(mesh.path, *corners) + ": found " + std::to_string(mesh.corners.size()) +
                    " faceVertexIndices, expected " + std::to_string(sum) + ", the sum of faceVertexCounts");
    for (size_t k = 0; k < mesh.corners.size(); ++k)
        if (mesh.corners[k] < 0 || size_t(mesh.corners[k]) >= mesh.points)
            throw Error(where(mesh.path, *corners) + ": corner " + std::to_string(k) + ": found point " +
                        std::to_string(mesh.corners[k]) + ", expected 0 up to " +
                        std::to_string(mesh.points) + ", not included");
    left_handed_.push_back(token(attributes, "orientation", "rightHanded") == "leftHanded");
    meshes_.push_back(std::move(mesh));
    of_meshes_.push_back(std::move(source));
}

// ---- once all is known

RowMatrix UsdaReader::world_of(size_t node, double time) const {
    RowMatrix world;
    for (int at = int(node); at >= 0; at = nodes_[size_t(at)].parent) {
        const Node& n = nodes_[size_t(at)];
        for (auto op = n.ops.rbegin(); op != n.ops.rend(); ++op) world = world * op->at(time);
        if (n.resets) break;
    }
    return world;
}

// At all times.
bool UsdaReader::is_invisible(const Attributes& attributes) const {
    const Attribute* found = find(attributes, {"visibility"});
    if (!found) return false;
    const auto invisible = [&](const TextSpan& span) { return values(span).string() == "invisible"; };
    if (found->samples.empty()) return invisible(*found->value);
    return std::all_of(found->samples.begin(), found->samples.end(),
                       [&](const Sample& sample) { return invisible(sample.value); });
}

// How an object is hidden, as MeshObject says it.
std::string UsdaReader::hidden(size_t node) const {
    std::string purpose;
    for (int at = int(node); at >= 0; at = nodes_[size_t(at)].parent) {
        if (nodes_[size_t(at)].is_invisible) return "invisible";
        if (purpose.empty()) purpose = nodes_[size_t(at)].purpose;
    }
    return purpose == "guide" || purpose == "proxy" ? "for " + purpose : "";
}

// The times at which the object's points or a transform above them have a sample; 0 where none has.
std::vector<double> UsdaReader::codes_of(const Source& source) const {
    std::vector<double> codes;
    for (const auto& sample : source.points.samples) codes.push_back(sample.time);
    for (int at = int(source.node); at >= 0; at = nodes_[size_t(at)].parent) {
        for (const auto& op : nodes_[size_t(at)].ops)
            codes.insert(codes.end(), op.times.begin(), op.times.end());
        if (nodes_[size_t(at)].resets) break;
    }
    std::sort(codes.begin(), codes.end());
    codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
    if (codes.empty()) codes.push_back(0);
    return codes;
}

void UsdaReader::finish() {
    const double a_second = codes_a_second_.value_or(frames_a_second_.value_or(24));
    axes_.rate = a_second;
    if (start_code_) axes_.start = *start_code_ / a_second;
    auto times_of = [&](Source& source) {
        source.codes = codes_of(source);
        std::vector<double> times;
        for (double code : source.codes) times.push_back(code / a_second);
        return times;
    };
    for (size_t k = 0; k < curves_.size(); ++k) {
        curves_[k].times = times_of(of_curves_[k]);
        curves_[k].hidden = hidden(of_curves_[k].node);
    }
    for (size_t k = 0; k < meshes_.size(); ++k) {
        MeshObject& mesh = meshes_[k];
        mesh.times = times_of(of_meshes_[k]);
        mesh.hidden = hidden(of_meshes_[k].node);
        const bool mirrored = world_of(of_meshes_[k].node, of_meshes_[k].codes[0]).determinant() < 0;
        if (mirrored == left_handed_[k]) continue;
        size_t begin = 0;
        for (int count : mesh.counts) {
            if (count > 1)
                std::reverse(mesh.corners.begin() + long(begin) + 1,
                             mesh.corners.begin() + long(begin) + count);
            begin += size_t(count);
        }
    }
    if (notes_.empty()) return;
    std::string found;
    for (const auto& [what, line] : notes_)
        found += (found.empty() ? "" : ", ") + what + " (line " + std::to_string(line) + ")";
    const std::string flatten = "`usdcat --flatten " + file_.path() + " -o flat.usda` puts all into one file";
    if (curves_.empty() && meshes_.empty())
        throw Error(file_.path() + ": found neither curves nor a mesh, but " + found +
                    ", which are not followed; " + flatten);
    log_warning(file_.path() + ": not followed: " + found + "; " + flatten);
}

// ---- points

std::vector<std::array<float, 3>> UsdaReader::stored_points(const Source& source, double time) const {
    const auto& samples = source.points.samples;
    auto read = [&](const TextSpan& span) {
        auto points = values(span).tuples<float, 3>();
        if (points.size() != source.stored)
            file_.fail(span.line, std::to_string(points.size()) + " points",
                       std::to_string(source.stored) + ", as in the first sample");
        return points;
    };
    if (samples.empty()) return read(*source.points.value);
    const Between at = between(
        samples.size(), [&](size_t k) { return samples[k].time; }, time);
    auto points = read(samples[at.a].value);
    if (at.a == at.b) return points;
    const auto later = read(samples[at.b].value);
    for (size_t i = 0; i < points.size(); ++i)
        for (size_t c = 0; c < 3; ++c)
            points[i][c] = float((1 - at.t) * double(points[i][c]) + at.t * double(later[i][c]));
    return points;
}

std::vector<Vec3f> UsdaReader::points_of(const Source& source, const std::string& object,
                                         size_t sample) const {
    const double time = source.codes.at(sample);
    for (const Attribute* topology : {&source.counts, &source.corners})
        if (topology->samples.size() > 1 &&
            values(topology->held(time)).numbers<int>() != values(topology->first()).numbers<int>())
            throw Error(
                where(object) + ", sample " + std::to_string(sample) +
                ": found that its points are joined in another way than in the first sample, expected "
                "the same throughout");
    const auto stored = stored_points(source, time);
    const RowMatrix world = world_of(source.node, time);
    std::vector<Vec3f> out;
    out.reserve(stored.size());
    for (const auto& x : stored) {
        out.push_back(cast<float>(world(Vec3d{double(x[0]), double(x[1]), double(x[2])})));
        const Vec3f& p = out.back();
        if (!(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)))
            throw Error(where(object) + ", sample " + std::to_string(sample) + ", point " +
                        std::to_string(out.size() - 1) + ": found a coordinate beyond what a float holds");
    }
    return out;
}

std::vector<Vec3f> UsdaReader::points_of_curves(size_t object, size_t sample) const {
    const Source& source = of_curves_.at(object);
    const CurvesObject& curves = curves_[object];
    std::vector<Vec3f> points = points_of(source, curves.path, sample);
    if (source.wrap == Wrap::open) return points;
    // Pinned: one control point more at each end, so that the curve begins and ends at those given.
    std::vector<Vec3f> out;
    out.reserve(curves.points());
    auto next = points.begin();
    for (int with_two : curves.counts) {
        if (with_two == 0) continue;
        const auto last = next + (with_two - 3);
        const bool one = next == last;
        out.push_back(one ? *next : 2.0f * *next - *(next + 1));
        out.insert(out.end(), next, last + 1);
        out.push_back(one ? *last : 2.0f * *last - *(last - 1));
        next = last + 1;
    }
    return out;
}

std::vector<Vec3f> UsdaReader::points_of_mesh(size_t object, size_t sample) const {
    return points_of(of_meshes_.at(object), meshes_[object].path, sample);
}

}  // namespace

std::unique_ptr<SceneReader> open_usda(const std::string& path) { return std::make_unique<UsdaReader>(path); }

}  // namespace wetcurl

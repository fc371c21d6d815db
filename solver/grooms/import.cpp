// Strands and meshes from other programs.
#include "solver/grooms/import.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "base/error.h"
#include "base/exchange/scene_mesh.h"
#include "base/file_ending.h"
#include "base/geometry/file_frame.h"
#include "base/geometry/mesh_winding.h"
#include "base/log.h"
#include "base/median.h"
#include "base/number_text.h"
#include "base/output_file.h"
#include "base/strands.h"
#include "solver/grooms/guesses.h"
#include "solver/grooms/writers.h"

namespace wetcurl {
namespace {

struct Format {
    const char* ending;
    StrandFile (*read)(const std::string&);
    const char* units;  // that the format prescribes, or "" where it leaves them open
};
constexpr Format formats[] = {
    {".hair", read_hair, ""}, {".data", read_data, ""},  {".bin", read_bin, "mm"},
    {".ply", read_ply, ""},   {".tfx", read_tfx, ""},    {".obj", read_obj, ""},
    {".npz", read_npz, ""},   {".abc", read_curves, ""}, {".usda", read_curves, ""}};

struct Unit {
    std::string name;
    double metres;
};
const Unit units[] = {{"m", 1}, {"cm", 0.01}, {"mm", 0.001}};

[[noreturn]] void unknown_ending(const std::string& path, const std::string& allowed) {
    throw Misuse(path + ": found the ending '" + ending_of(path) + "', allowed " + allowed);
}

Unit unit_named(const std::string& path, const std::string& name) {
    for (const auto& unit : units)
        if (name == unit.name) return unit;
    throw Misuse(path + ": found the units '" + name + "', allowed m, cm, mm, auto");
}

// A head with its hair measures about half a metre across: the unit that comes nearest to it, by ratio. A
// lock by itself is smaller: one of a finer unit in which its strands are no longer than hair is.
Unit guessed_unit(double diagonal, double length_of_strands) {
    constexpr double usual = 0.5, longest = 1.5;
    auto off = [&](const Unit& unit) { return std::abs(std::log(diagonal * unit.metres / usual)); };
    const Unit* unit = std::min_element(std::begin(units), std::end(units),
                                        [&](const Unit& a, const Unit& b) { return off(a) < off(b); });
    constexpr double smallest = 0.005;  // across
    while (unit + 1 != std::end(units) && length_of_strands * unit->metres > longest &&
           diagonal * unit[1].metres > smallest)
        ++unit;
    return *unit;
}

// File coordinates to metres, Y up.
struct ToMetres {
    Unit unit;
    bool guessed;
    std::string up;
    bool up_told;
    Vec3d operator()(const Vec3d& x) const { return unit.metres * upright(up, x); }
};

// "" where neither caller nor file says it.
std::string up_axis(const std::string& path, const std::string& meant, const FileAxes& says) {
    if (std::find(std::begin(axis_words), std::end(axis_words), meant) == std::end(axis_words))
        throw Misuse(path + ": found the up axis '" + meant + "', allowed x, -x, y, -y, z, -z, auto");
    const std::string said = says.up ? std::string(1, *says.up) : "";
    if (meant != "auto") {
        if (!said.empty() && said != meant)
            log_warning(path + ": says that " + said + " is up, and is read as if " + meant +
                        " were, as told");
        return meant;
    }
    return said;
}

// As the file says, or as is usual for its format.
std::optional<Unit> unit_of_file(const std::string& path, const std::string& prescribed,
                                 const FileAxes& says) {
    if (!prescribed.empty()) return unit_named(path, prescribed);
    if (!says.metres_per_unit) return std::nullopt;
    for (const auto& unit : units)
        if (std::abs(*says.metres_per_unit / unit.metres - 1) < 1e-6) return unit;
    return Unit{number_text(*says.metres_per_unit) + " m", *says.metres_per_unit};
}

ToMetres conversion(const std::string& path, const FileUnits& meant, const std::string& prescribed,
                    const FileAxes& says, const Bounds& box, double length_of_strands = 0) {
    const std::string told_up = up_axis(path, meant.up, says), up = told_up.empty() ? "y" : told_up;
    const bool up_told = !told_up.empty();
    const auto of_file = unit_of_file(path, prescribed, says);
    if (meant.units != "auto") {
        const Unit told = unit_named(path, meant.units);
        if (says.metres_per_unit && of_file->metres != told.metres)
            log_warning(path + ": says that its unit is " + of_file->name + ", and is read in " + told.name +
                        ", as told");
        return {told, false, up, up_told};
    }
    if (says.metres_per_unit) return {*of_file, false, up, up_told};
    const double diagonal = norm(box.high - box.low);
    const Unit unit = of_file ? *of_file : guessed_unit(diagonal, length_of_strands);
    char size[64];
    std::snprintf(size, sizeof size, "%.4g units across, %.3g m", diagonal, diagonal * unit.metres);
    log_warning(path + ": units not given, " + (prescribed.empty() ? "guessed " : "took the format's ") +
                unit.name + " (" + size + "); say m, cm or mm to be sure");
    return {unit, true, up, up_told};
}

// Where nearly all points lie: a stray one changes no unit.
Bounds usual_bounds(const StrandPoints& strands) {
    Bounds box;
    std::vector<double> values;
    for (double Vec3d::*axis : {&Vec3d::x, &Vec3d::y, &Vec3d::z}) {
        values.clear();
        for (const auto& strand : strands)
            for (const Vec3d& x : strand) values.push_back(x.*axis);
        constexpr double outside = 0.005;  // share of the points, at either end
        const auto left_out = long(outside * double(values.size()));
        const auto low = values.begin() + left_out, high = values.end() - 1 - left_out;
        std::nth_element(values.begin(), low, values.end());
        std::nth_element(low, high, values.end());
        box.low.*axis = *low, box.high.*axis = *high;
    }
    return box;
}

// Numbers of those points that do not stand on the one before.
std::vector<size_t> distinct(const std::vector<Vec3d>& strand) {
    constexpr double together = 1e-9;  // [m], as in resampled()
    std::vector<size_t> kept;
    for (size_t i = 0; i < strand.size(); ++i)
        if (kept.empty() || norm(strand[i] - strand[kept.back()]) > together) kept.push_back(i);
    return kept;
}

template <class T>
std::vector<T> picked(const std::vector<T>& from, const std::vector<size_t>& numbers) {
    std::vector<T> out;
    if (from.empty()) return out;
    for (size_t number : numbers) out.push_back(from[number]);
    return out;
}

bool are_widths(const StrandWidths& widths) {
    for (const auto& strand : widths)
        for (float width : strand)
            if (!std::isfinite(width) || width < 0) return false;
    return true;
}

struct Writer {
    const char* ending;
    void (*write)(ByteWriter&, const StrandsOut&);
};
constexpr Writer writers[] = {{".hair", write_hair}, {".data", write_data}, {".ply", write_ply},
                              {".obj", write_obj},   {".tfx", write_tfx},   {".pbrt", write_pbrt}};

template <class Rows>
std::string endings(const Rows& rows) {
    std::string text;
    for (const auto& row : rows) text += std::string(row.ending) + " ";
    text.pop_back();
    return text;
}

// Strands of a file, or of `what` else, in metres; degenerate ones are dropped.
ImportedStrands taken(const std::string& what, const StrandFile& file, const ToMetres& to_metres) {
    const StrandPoints& raw = file.points;
    ImportedStrands out;
    out.found = raw.size();
    out.units = to_metres.unit.name;
    out.guessed = to_metres.guessed;
    out.up_told = to_metres.up_told;
    out.up = to_metres.up;
    for (size_t s = 0; s < raw.size(); ++s) {
        std::vector<Vec3d> strand(raw[s].size());
        std::transform(raw[s].begin(), raw[s].end(), strand.begin(), to_metres);
        const std::vector<size_t> kept = distinct(strand);
        std::vector<Vec3d> points = picked(strand, kept);
        size_t* reason = strand.empty()       ? &out.no_points
                         : strand.size() == 1 ? &out.one_point
                         : kept.size() == 1 || arc_length(points.data(), int(points.size())) < shortest_strand
                             ? &out.no_length
                             : nullptr;
        if (reason) {
            ++*reason;
            out.dropped_numbers.push_back(s);
            continue;
        }
        out.repeated_points += strand.size() - kept.size();
        out.strands.push_back(std::move(points));
        out.numbers.push_back(s);
        if (file.widths.empty()) continue;
        std::vector<float>& widths = out.widths.emplace_back(picked(file.widths[s], kept));
        for (float& width : widths) width = float(width * to_metres.unit.metres);
    }
    out.ids = picked(file.ids, out.numbers);
    out.groups = picked(file.groups, out.numbers);
    out.root_uv = picked(file.root_uv, out.numbers);
    if (out.dropped())
        log_warning(what + ": dropped " + std::to_string(out.dropped()) + " of " + std::to_string(out.found) +
                    " strands: " + std::to_string(out.no_points) + " without points, " +
                    std::to_string(out.one_point) + " of one point, " + std::to_string(out.no_length) +
                    " without length (below 0.1 mm); counted from 0, these are " +
                    listed(out.dropped_numbers, 12));
    if (out.repeated_points)
        log_warning(what + ": left out " + std::to_string(out.repeated_points) +
                    " points that repeat the one before");
    if (out.strands.empty())
        throw Error(what + ": found no strand of two distinct points, allowed 1 or more");
    return out;
}

}  // namespace

std::string readable_endings() { return endings(formats); }
std::string writable_endings() { return endings(writers); }

ImportedStrands import_strands(const std::string& path, const FileUnits& meant) {
    // Other endings of USD: its bytes decide whether it is text, and the error for binary files says what to
    // run.
    const std::string ending = ending_of(path) != ".abc" && is_scene_file(path) ? ".usda" : ending_of(path);
    const auto* format = std::find_if(std::begin(formats), std::end(formats),
                                      [&](const Format& f) { return ending == f.ending; });
    if (format == std::end(formats)) unknown_ending(path, readable_endings());
    StrandFile file = format->read(path);
    const StrandPoints& raw = file.points;
    if (raw.empty()) throw Error(path + ": found 0 strands, allowed 1 or more");
    if (std::all_of(raw.begin(), raw.end(), [](const auto& strand) { return strand.empty(); }))
        throw Error(path + ": found " + std::to_string(raw.size()) +
                    " strands without a point, allowed 1 with two or more");
    if (!are_widths(file.widths)) {
        log_warning(path + ": found widths that are negative or not finite; widths are left out");
        file.widths.clear();
    }

    std::vector<double> lengths;
    for (const auto& strand : raw) lengths.push_back(arc_length(strand.data(), int(strand.size())));
    ToMetres to_metres =
        conversion(path, meant, format->units, file.axes, usual_bounds(raw), median(lengths));
    const Guess up = guessed_up(raw);
    if (!to_metres.up_told) to_metres.up = up.word;
    ImportedStrands out = taken(path, file, to_metres);
    if (!to_metres.up_told) out.up_reason = up.reason;
    return out;
}

ImportedStrands strands_in_metres(const StrandPoints& points, const std::string& what) {
    return taken(what, {points, {}, {}, {}, {}, {}}, {{"m", 1}, false, "y", true});
}

Mesh import_mesh(const std::string& path, const FileUnits& meant) {
    Mesh mesh = first_mesh(path);
    const ToMetres to_metres = conversion(path, meant, "", axes_of_mesh(path), bounding_box(mesh));
    for (auto& x : mesh.vertices) x = cast<float>(to_metres(cast<double>(x)));
    Winding winding;
    mesh = consistently_wound(mesh, &winding);
    if (winding.changed()) log_info(path + ": " + winding.text());
    return mesh;
}

static const Writer& writer_for(const std::string& path) {
    for (const auto& writer : writers)
        if (ending_of(path) == writer.ending) return writer;
    unknown_ending(path, writable_endings());
}

void require_writable(const std::string& path, bool overwrite) {
    writer_for(path);
    require_place(path, overwrite);
}

void write_strands(const std::string& path, const StrandPoints& strands, bool overwrite,
                   const StrandWidths& widths, const std::string& unit) {
    require_writable(path, overwrite);
    if (!widths.empty() && widths.size() != strands.size())
        throw Error(path + ": found widths of " + std::to_string(widths.size()) +
                    " strands, allowed are those of " + std::to_string(strands.size()));
    for (size_t s = 0; s < strands.size(); ++s) {
        if (strands[s].size() < 2)
            throw Error(path + ": strand " + std::to_string(s) + ": found " +
                        std::to_string(strands[s].size()) + " points, allowed 2 or more");
        if (!widths.empty() && widths[s].size() != strands[s].size())
            throw Error(path + ": strand " + std::to_string(s) + ": found " +
                        std::to_string(widths[s].size()) + " widths, allowed " +
                        std::to_string(strands[s].size()) + ", one a point");
    }
    OutputFile file(path, overwrite);
    ByteWriter out(file);
    writer_for(path).write(out, {path, strands, widths, unit});
    out.flush();
    file.commit();
}

}  // namespace wetcurl

// Strands and meshes from other programs.
#include "solver/grooms/import.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>

#include "base/error.h"
#include "base/log.h"
#include "base/output_file.h"

namespace wetcurl {
namespace {

struct Format {
    const char* ending;
    StrandPoints (*read)(const std::string&);
    const char* units;  // that the format prescribes, or "" where it leaves them open
};
constexpr Format formats[] = {{".hair", read_hair, ""},
                              {".data", read_data, ""},
                              {".bin", read_bin, "mm"},
                              {".ply", read_ply, ""},
                              {".tfx", read_tfx, ""}};

struct Unit {
    const char* name;
    double metres;
};
constexpr Unit units[] = {{"m", 1}, {"cm", 0.01}, {"mm", 0.001}};

std::string ending_of(const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().string();
    for (char& c : ending) c = char(std::tolower(static_cast<unsigned char>(c)));
    return ending;
}

[[noreturn]] void unknown_ending(const std::string& path, const std::string& allowed) {
    throw Misuse(path + ": found the ending '" + ending_of(path) + "', allowed " + allowed);
}

Unit unit_named(const std::string& path, const std::string& name) {
    for (const auto& unit : units)
        if (name == unit.name) return unit;
    throw Misuse(path + ": found the units '" + name + "', allowed m, cm, mm, auto");
}

// A head with its hair measures about half a metre across: the unit that comes nearest to it, by ratio.
Unit guessed_unit(double diagonal) {
    constexpr double usual = 0.5;
    auto off = [&](const Unit& unit) { return std::abs(std::log(diagonal * unit.metres / usual)); };
    return *std::min_element(std::begin(units), std::end(units),
                             [&](const Unit& a, const Unit& b) { return off(a) < off(b); });
}

// Turns z-up coordinates so that y is up and what faced -y faces +z.
Vec3d z_to_y_up(const Vec3d& x) { return {x.x, x.z, -x.y}; }

// File coordinates to metres, Y up.
struct ToMetres {
    Unit unit;
    bool guessed;
    bool z_up;
    Vec3d operator()(const Vec3d& x) const { return unit.metres * (z_up ? z_to_y_up(x) : x); }
};

ToMetres conversion(const std::string& path, const FileUnits& meant, const std::string& prescribed,
                    const Bounds& box) {
    if (meant.up != "y" && meant.up != "z")
        throw Misuse(path + ": found the up axis '" + meant.up + "', allowed y, z");
    const bool z_up = meant.up == "z";
    if (meant.units != "auto") return {unit_named(path, meant.units), false, z_up};
    const double diagonal = norm(box.high - box.low);
    const Unit unit = prescribed.empty() ? guessed_unit(diagonal) : unit_named(path, prescribed);
    char size[64];
    std::snprintf(size, sizeof size, "%.4g units across, %.3g m", diagonal, diagonal * unit.metres);
    log_warning(path + ": units not given, " + (prescribed.empty() ? "guessed " : "took the format's ") +
                unit.name + " (" + size + "); say m, cm or mm to be sure");
    return {unit, true, z_up};
}

void widen(Bounds& box, const Vec3d& x) {
    box.low = {std::min(box.low.x, x.x), std::min(box.low.y, x.y), std::min(box.low.z, x.z)};
    box.high = {std::max(box.high.x, x.x), std::max(box.high.y, x.y), std::max(box.high.z, x.z)};
}

Bounds bounds_of(const StrandPoints& strands) {
    constexpr double far = 1e300;
    Bounds box{{far, far, far}, {-far, -far, -far}};
    for (const auto& strand : strands)
        for (const auto& x : strand) widen(box, x);
    return box;
}

// Leaves out each point that stands on the one before it.
std::vector<Vec3d> distinct(const std::vector<Vec3d>& strand) {
    constexpr double together = 1e-9;  // [m], as in resampled()
    std::vector<Vec3d> out;
    for (const auto& x : strand)
        if (out.empty() || norm(x - out.back()) > together) out.push_back(x);
    return out;
}

// Bytes to a file, many at a time.
class Bytes {
  public:
    explicit Bytes(OutputFile& file) : file_(file) {}
    template <class T>
    void put(const T& value) {
        waiting_.append(reinterpret_cast<const char*>(&value), sizeof value);
        if (waiting_.size() > size_t(1) << 20) flush();
    }
    void put_points(const std::vector<Vec3d>& strand) {
        for (const auto& x : strand) put(cast<float>(x));
    }
    void flush() {
        file_.write(waiting_);
        waiting_.clear();
    }

  private:
    OutputFile& file_;
    std::string waiting_;
};

void write_data(Bytes& out, const StrandPoints& strands) {
    out.put(int32_t(strands.size()));
    for (const auto& strand : strands) {
        out.put(int32_t(strand.size()));
        out.put_points(strand);
    }
}

void write_hair(Bytes& out, const StrandPoints& strands) {
    constexpr float thickness = 8e-5f;  // of a hair [m]
    constexpr uint32_t segments_and_points = 3;
    uint32_t points = 0;
    for (size_t s = 0; s < strands.size(); ++s) {
        if (strands[s].size() > 65536)
            throw Error("strand " + std::to_string(s) + ": found " + std::to_string(strands[s].size()) +
                        " points, allowed at most 65536 in a .hair file");
        points += uint32_t(strands[s].size());
    }
    for (char c : {'H', 'A', 'I', 'R'}) out.put(c);
    for (uint32_t value : {uint32_t(strands.size()), points, segments_and_points, 0u}) out.put(value);
    for (float value : {thickness, 0.0f, 0.4f, 0.3f, 0.2f}) out.put(value);
    char text[88] = "wetcurl: metres, Y up";
    out.put(text);
    for (const auto& strand : strands) out.put(uint16_t(strand.size() - 1));
    for (const auto& strand : strands) out.put_points(strand);
}

struct Writer {
    const char* ending;
    void (*write)(Bytes&, const StrandPoints&);
};
constexpr Writer writers[] = {{".hair", write_hair}, {".data", write_data}};

template <class Rows>
std::string endings(const Rows& rows) {
    std::string text;
    for (const auto& row : rows) text += std::string(row.ending) + " ";
    text.pop_back();
    return text;
}

}  // namespace

std::string readable_endings() { return endings(formats); }
std::string writable_endings() { return endings(writers); }

ImportedStrands import_strands(const std::string& path, const FileUnits& meant) {
    const auto* format = std::find_if(std::begin(formats), std::end(formats),
                                      [&](const Format& f) { return ending_of(path) == f.ending; });
    if (format == std::end(formats)) unknown_ending(path, readable_endings());
    const StrandPoints raw = format->read(path);
    if (raw.empty()) throw Error(path + ": found 0 strands, allowed 1 or more");
    if (std::all_of(raw.begin(), raw.end(), [](const auto& strand) { return strand.empty(); }))
        throw Error(path + ": found " + std::to_string(raw.size()) +
                    " strands without a point, allowed 1 with two or more");

    const ToMetres to_metres = conversion(path, meant, format->units, bounds_of(raw));
    ImportedStrands out;
    out.found = raw.size();
    out.units = to_metres.unit.name;
    out.guessed = to_metres.guessed;
    for (size_t number = 0; number < raw.size(); ++number) {
        const auto& given = raw[number];
        std::vector<Vec3d> strand(given.size());
        std::transform(given.begin(), given.end(), strand.begin(), to_metres);
        std::vector<Vec3d> kept = distinct(strand);
        if (strand.empty())
            ++out.no_points;
        else if (strand.size() == 1)
            ++out.one_point;
        else if (kept.size() == 1)
            ++out.no_length;
        else {
            out.repeated_points += strand.size() - kept.size();
            out.strands.push_back(std::move(kept));
            out.numbers.push_back(int(number));
        }
    }
    if (out.dropped())
        log_warning(path + ": dropped " + std::to_string(out.dropped()) + " of " + std::to_string(out.found) +
                    " strands: " + std::to_string(out.no_points) + " without points, " +
                    std::to_string(out.one_point) + " of one point, " + std::to_string(out.no_length) +
                    " without length");
    if (out.repeated_points)
        log_warning(path + ": left out " + std::to_string(out.repeated_points) +
                    " points that repeat the one before");
    if (out.strands.empty())
        throw Error(path + ": found no strand of two distinct points, allowed 1 or more");
    return out;
}

Mesh import_mesh(const std::string& path, const FileUnits& meant) {
    Mesh mesh = read_mesh(path, 1);
    const ToMetres to_metres = conversion(path, meant, "", bounding_box(mesh));
    for (auto& x : mesh.vertices) x = cast<float>(to_metres(cast<double>(x)));
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
    const auto folder = std::filesystem::path(target_of(path)).parent_path();
    if (!folder.empty() && !std::filesystem::is_directory(folder))
        throw Error(path + ": its folder is not there");
}

void write_strands(const std::string& path, const StrandPoints& strands, bool overwrite) {
    require_writable(path, overwrite);
    OutputFile file(path, overwrite);
    Bytes out(file);
    writer_for(path).write(out, strands);
    out.flush();
    file.commit();
}

}  // namespace wetcurl

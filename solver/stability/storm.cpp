// Random scenes.
#include "solver/stability/storm.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "base/error.h"
#include "base/geometry/shapes.h"
#include "solver/scene/scene_rows.h"

namespace wetcurl {
namespace {

// Reproducible on any library: the engine is the standard's own, distributions are ours.
using Vec = std::array<double, 3>;

class Dice {
  public:
    explicit Dice(unsigned long long seed) : engine_(seed) {}
    double number(double low, double high) { return low + (high - low) * double(engine_() >> 11) * 0x1p-53; }
    bool falls(double chance) { return number(0, 1) < chance; }
    size_t one_of(size_t count) { return std::min(size_t(number(0, double(count))), count - 1); }

  private:
    std::mt19937_64 engine_;
};

// Between a tenth and ten times the default; where that is 0, or there is none, of the size of a share.
double value_of(const KeyRow& row, double usual, Dice& dice) {
    const double factor = std::pow(10, dice.number(-1, 1));
    const double found = usual != 0 ? usual * factor : dice.number(0, 1) * std::min(1.0, row.maximum);
    const double held = std::clamp(found, row.minimum, row.maximum);
    return row.is_whole() ? std::round(held) : held;
}

std::string drawn(const KeyRow& row, Dice& dice) {
    if (row.kind == Kind::boolean) return dice.falls(0.5) ? "true" : "false";
    if (row.kind == Kind::word) return fmt::format("\"{}\"", row.words[dice.one_of(row.words.size())]);
    if (row.is_number()) {
        const double value = value_of(row, row.fallback, dice);
        return row.is_whole() ? fmt::format("{}", (long long)value) : fmt::format("{:.6g}", value);
    }
    std::string text;
    for (size_t k = 0; k < row.size; ++k) {
        const double sign = row.minimum < 0 && dice.falls(0.5) ? -1 : 1,
                     value = sign * value_of(row, row.vector[k], dice);
        text += (k ? ", " : "") +
                (row.is_whole() ? fmt::format("{}", (long long)value) : fmt::format("{:.6g}", value));
    }
    return "[" + text + "]";
}

std::string obj_of(const Mesh& mesh) {
    std::string text;
    for (const Vec3f& v : mesh.vertices) text += fmt::format("v {} {} {}\n", v.x, v.y, v.z);
    for (const auto& t : mesh.triangles) text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    return text;
}

// Keys that decide how long a scene takes, name other files, or say what is allowed.
const std::set<std::string> left_alone{
    "grid",    "particles", "frames", "fps",   "substeps", "settle", "file",  "radius_noise",
    "include", "looks",     "grow",   "title", "seed",     "passes", "allow", "allow_stretch"};

// Keys of [groom] that [fibre] says.
const std::set<std::string> said_by_fibre{"linear_density", "density"};

class Storm {
  public:
    explicit Storm(unsigned long long seed) : dice_(seed) {}

    RandomScene scene() {
        const size_t frames = 8 + dice_.one_of(8);
        text_ = fmt::format("frames = {}\n", frames);
        const bool rides = dice_.falls(0.2);
        fibre_ = dice_.falls(0.3);
        write("groom", 0.25,
              fmt::format("grid = [{}, {}]\nparticles = {}\n{}", 2 + dice_.one_of(5), 2 + dice_.one_of(5),
                          8 + dice_.one_of(40), rides ? "scalp = \"skin\"\n" : ""));
        write("integrator", 0.15, fmt::format("substeps = {}\n", 1 + dice_.one_of(12)));
        if (fibre_)
            write("fibre", 0.3);
        else
            write("stretch", 0.3), write("bend", 0.3);
        for (const char* term : {"core", "stiffness"}) maybe(term, 0.5);
        const bool wet = dice_.falls(0.7);
        if (wet) {
            write("wetness", 0.3);
            maybe("wetness.flow", 0.2);
            for (const char* term : {"curl", "cohesion"}) maybe(term, 0.5);
        }
        maybe("strand_contact", 0.2), maybe("air", 0.2);
        motion(frames);
        const size_t solids = dice_.one_of(4);
        if (wet && (solids || rides)) maybe("adhesion", 0.4);
        if (rides) skin();
        for (size_t k = 0; k < solids; ++k) solid(k == 0 && !rides);
        return {text_, files_};
    }

  private:
    // A table with each of its keys at a chance.
    void write(const std::string& table, double chance, const std::string& more = "") {
        const auto& tables = scene_rows();
        const auto found =
            std::find_if(tables.begin(), tables.end(), [&](const TableRow& t) { return t.name == table; });
        if (found == tables.end()) throw Error("there is no table [" + table + "]");
        text_ += "[" + table + "]\n" + more;
        std::set<std::string> written;
        for (const auto& row : found->rows) {
            if (*row.when.keys || row.kind == Kind::path || row.kind == Kind::text ||
                row.kind == Kind::words || left_alone.contains(row.key) ||
                (fibre_ && said_by_fibre.contains(row.key)))
                continue;
            bool falls = dice_.falls(chance);
            // Of a helix both are written, or neither.
            if (table == "curl" && row.key == std::string("pitch")) falls = written.contains("radius");
            if (falls && written.insert(row.key).second)
                text_ += fmt::format("{} = {}\n", row.key, drawn(row, dice_));
        }
    }
    void maybe(const std::string& table, double chance) {
        if (dice_.falls(chance)) write(table, 0.3);
    }
    Vec way() { return {dice_.number(-1, 1), dice_.number(-1, 1), dice_.number(-1, 1)}; }
    // Of the head, and of the shot.
    void motion(size_t frames) {
        if (dice_.falls(0.3)) return;
        const Vec axis = way();
        text_ +=
            fmt::format("[motion]\naxis = [{:.4g}, {:.4g}, {:.4g}]\nangle = {:.4g}\nperiod = {:.4g}\n",
                        axis[0], axis[1], axis[2], dice_.number(0, 90), std::pow(10, dice_.number(-1, 0.5)));
        if (dice_.falls(0.2)) text_ += fmt::format("cuts = [{}]\n", 1 + dice_.one_of(frames - 1));
        if (dice_.falls(0.2)) text_ += fmt::format("preroll = {:.3g}\n", dice_.number(0, 0.3));
    }
    // A mesh that deforms, on which the roots ride.
    void skin() {
        text_ += "[[solid]]\nname = \"skin\"\nshape = \"mesh\"\nspacing = 0.01\nattached = \"head\"\n";
        const Mesh ball = triangulated(Sphere{0.095}, 24);
        for (int key = 0; key < 3; ++key) {
            Mesh mesh = ball;
            const Vec grown = way(), moved = way();
            for (Vec3f& v : mesh.vertices)
                for (int axis = 0; axis < 3; ++axis) {
                    float& x = axis == 0 ? v.x : axis == 1 ? v.y : v.z;
                    x = float((1 + 0.3 * grown[size_t(axis)]) * double(x) + 0.1 * moved[size_t(axis)]);
                }
            const std::string file = fmt::format("skin_{}.obj", key);
            files_[file] = obj_of(mesh);
            text_ += fmt::format("[[solid.mesh]]\ntime = {}\nfile = \"{}\"\n", 0.15 * key, file);
        }
    }
    void solid(bool head) {
        constexpr const char* shapes[] = {"sphere", "capsule", "box", "plane", "mesh"};
        const std::string shape = head ? (dice_.falls(0.7) ? "sphere" : "head") : shapes[dice_.one_of(5)];
        text_ += fmt::format("[[solid]]\nshape = \"{}\"\nfriction = {:.4g}\n", shape, dice_.number(0, 1));
        if (shape == "sphere" || shape == "capsule")
            text_ += fmt::format("radius = {:.4g}\n", dice_.number(0.02, 0.12));
        if (shape == "mesh") {
            files_["block.obj"] = obj_of(triangulated(Box{{0.05, 0.03, 0.08}}, 12));
            text_ += "file = \"block.obj\"\nspacing = 0.01\n";
        }
        if (head && dice_.falls(0.7)) {
            text_ += "attached = \"head\"\n";
            return;
        }
        // From anywhere to anywhere, through the hair as it may be.
        for (const double time : {0.0, 0.3}) {
            const Vec at = way();
            text_ +=
                fmt::format("[[solid.motion.keyframe]]\ntime = {}\ntranslation = [{:.4g}, {:.4g}, {:.4g}]\n",
                            time, 0.3 * at[0], 0.3 * at[1], 0.3 * at[2]);
        }
    }

    Dice dice_;
    bool fibre_ = false;  // in the place of springs
    std::string text_;
    std::map<std::string, std::string> files_;
};

}  // namespace

RandomScene storm_scene(unsigned long long seed) { return Storm(seed).scene(); }

}  // namespace wetcurl

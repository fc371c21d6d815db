// Every row of a scene, walked: what it says of itself, what it refuses, and that it changes something.
#include <functional>
#include <map>
#include <set>

#include "base/run_cache.h"
#include "solver/scene/scene_rows.h"
#include "tests/grooms/strand_files.h"
#include "tests/solver/written_scene.h"

namespace wetcurl {
namespace {

using namespace testing;
using std::string;

void for_each_row(const std::function<void(const TableRow&, const KeyRow&)>& visit) {
    for (const auto& table : scene_rows())
        for (const auto& row : table.rows) {
            SCOPED_TRACE(table.title() + " " + row.key + " " + row.when.text());
            visit(table, row);
        }
}
const TableRow& table_named(const string& name) {
    for (const auto& table : scene_rows())
        if (table.name == name) return table;
    throw Error("no table " + name);
}
std::vector<string> alternatives(const string& words) {
    std::vector<string> out;
    std::stringstream in(words);
    for (string word; std::getline(in, word, '|');) out.push_back(word);
    return out;
}

// --- what rows say of themselves

TEST(SceneRows, have_a_kind_a_unit_a_range_or_words_and_a_sentence) {
    size_t rows = 0;
    for_each_row([&](const TableRow& table, const KeyRow& row) {
        ++rows;
        const string meaning = row.meaning;
        EXPECT_GT(meaning.size(), 8u);
        EXPECT_TRUE(meaning.ends_with(".") && std::isupper((unsigned char)meaning[0])) << meaning;
        if (row.is_number() || row.is_vector()) {
            EXPECT_NE(string(row.unit), "");
            EXPECT_LT(row.minimum, row.maximum);
            EXPECT_TRUE(std::isfinite(row.minimum) && std::isfinite(row.maximum));
            for (size_t k = 0; k < row.size; ++k) {
                const double value = row.is_vector() ? row.vector[k] : row.fallback;
                EXPECT_TRUE(!row.has_default() || (value >= row.minimum && value <= row.maximum));
            }
        }
        if (row.kind == Kind::word) {
            EXPECT_GT(row.words.size(), 0u);
            EXPECT_TRUE(!row.has_default() ||
                        std::count(row.words.begin(), row.words.end(), string(row.word)) == 1);
        }
        EXPECT_TRUE(row.kind != Kind::path || !row.has_default());
        // A condition speaks of keys of the same table, and of words that they may have.
        for (const auto& key : alternatives(row.when.keys)) {
            const auto other = std::find_if(table.rows.begin(), table.rows.end(),
                                            [&](const KeyRow& r) { return key == r.key; });
            ASSERT_NE(other, table.rows.end()) << key;
            if (!*row.when.words) continue;
            size_t known = 0;
            bool usual = false;
            for (const auto& word : alternatives(row.when.words)) {
                known += size_t(std::count(other->words.begin(), other->words.end(), word));
                usual = usual || (other->has_default() && word == other->word);
            }
            EXPECT_GT(known, 0u) << key;
            EXPECT_EQ(usual, row.when.unwritten) << key;
        }
    });
    EXPECT_GT(rows, 120u);
}

TEST(SceneRows, name_each_table_once_and_each_key_once_for_each_condition) {
    std::set<string> tables, keys;
    for (const auto& table : scene_rows()) {
        EXPECT_TRUE(tables.insert(table.name).second) << table.name;
        EXPECT_TRUE(tables.contains(holder_of_table(table.name))) << table.name;
        EXPECT_TRUE(table.meaning.ends_with(".")) << table.name;
        EXPECT_GT(table.rows.size(), 0u) << table.name;
        for (const auto& row : table.rows)
            EXPECT_TRUE(keys.insert(full_key(table, row) + " " + row.when.text()).second) << row.key;
    }
}

// --- what is read and what is refused

// Files that keys of kind path name: of each, one and another.
class Fixtures {
  public:
    Fixtures() {
        for (const bool other : {false, true}) {
            const Mesh ball = triangulated(Sphere{other ? 0.09 : 0.1}, 16);
            scratch_.file(name(".obj", other), obj_of(ball));
            scratch_.file(other ? "grows.0002.obj" : "grows.0001.obj", obj_of(ball));
            scratch_.file(name(".txt", other), other ? "0.05 0 0 0 0 0 0\n0.2 0 50 0 0 0 0\n"
                                                     : "0.05 0 0 0 0 0 0\n0.2 0 30 0 0 0 0\n");
            StrandPoints strands;
            for (int s = 0; s < 16; ++s) {
                std::vector<Vec3d> strand;
                for (int i = 0; i < 9; ++i)
                    strand.push_back(
                        {0.15 + 0.02 * (s % 4), 0.1 - 0.015 * i, 0.02 * (s / 4) + (other ? 0.01 : 0)});
                strands.push_back(strand);
            }
            scratch_.file(name(".data", other), data_file(strands));
        }
        scratch_.file("grows.0003.obj", obj_of(triangulated(Sphere{0.12}, 16)));
        const auto balls = create_scene_file(scratch_.path("balls.usda"), true, {});
        std::vector<Mesh> each{triangulated(Sphere{0.1}, 16), triangulated(Sphere{0.09}, 16)};
        for (const char* path : {"/balls/one", "/balls/other"}) {
            MeshObject object;
            object.path = path, object.points = each[0].vertices.size();
            for (const auto& t : each[0].triangles) {
                object.counts.push_back(3);
                object.corners.insert(object.corners.end(), t.begin(), t.end());
            }
            balls->add_mesh(object);
        }
        for (int frame = 0; frame < 2; ++frame)
            for (size_t k = 0; k < each.size(); ++k) {
                balls->append_mesh(k, each[k].vertices);
                for (auto& v : each[k].vertices) v = 1.05f * v;
            }
        balls->finish();
    }
    // Of the rows of kind path: "groom.file" has strands, "motion.file" keyframes.
    string path(const string& key, bool other = false) const {
        if (key == "groom.file") return scratch_.path(name(".data", other));
        if (key.ends_with("motion.file")) return scratch_.path(name(".txt", other));
        if (key == "groom.scalp" || key.starts_with("solid.")) return scratch_.path(name(".obj", other));
        return scratch_.path(name(".h5", other));  // read by none of these scenes
    }
    // A mesh that grows, and two of them in a file.
    string grows() const { return scratch_.path("grows.####.obj"); }
    string balls() const { return scratch_.path("balls.usda"); }
    // A run of `scene` that is as wet as `level` everywhere.
    void write_run(const Scene& scene, float level, bool other) const {
        RunHeader header;
        header.groom = scene.groom;
        header.saturation.assign(scene.groom.rest.points.size(), level);
        RunWriter run(scratch_.path(name(".h5", other)), header, true);
        RunFrame frame;
        frame.positions = scene.groom.rest;
        run.append(frame);
        run.commit();
    }

  private:
    static string name(const string& ending, bool other) { return (other ? "other" : "one") + ending; }
    Scratch scratch_;
};

const Fixtures& fixtures() {
    static const Fixtures all;
    return all;
}

// A value that the row takes, as TOML: its default, or what serves where it has none.
string allowed_value(const TableRow& table, const KeyRow& row) {
    if (row.kind == Kind::path) return quoted(fixtures().path(full_key(table, row)));
    if (row.kind == Kind::word) return quoted(row.has_default() ? row.word : row.words.front());
    if (row.kind == Kind::text) return quoted(row.key == string("object") ? "/balls/one" : "a name");
    if (row.kind == Kind::words) return "[" + quoted(row.words.front()) + "]";
    if (row.kind == Kind::boolean) return row.fallback != 0 ? "true" : "false";
    if (row.is_vector()) return row.default_text().empty() ? "[0, 0, 0]" : row.default_text();
    if (row.key == string("rest_frame")) return "1";  // one that is there
    // What stands beside [wetness.flow].
    if ((row.key == string("spacing") && !row.has_default()) || row.key == string("neighbours")) return "0";
    const double usual = row.has_default() ? row.fallback : std::clamp(0.01, row.minimum, row.maximum);
    return row.is_whole() ? std::to_string(long(usual)) : number_text(usual);
}

const char* every_table =
    "[groom]\ngrid = [2, 2]\nparticles = 8\ncurl_radius = "
    "0\n[integrator]\n[motion]\n[[motion.keyframe]]\n[stretch]\n[bend]\n"
    "[core]\n[adhesion]\n[stiffness]\n[wetness]\n[wetness.flow]\n[[wetness.source]]\n"
    "[wetness.source.motion]\n[[wetness.source.motion.keyframe]]\n[curl]\nradius = 0.008\npitch = 0.02\n"
    "[cohesion]\n[strand_contact]\n[[solid]]\n[solid.motion]\n[[solid.motion.keyframe]]\n[air]\n"
    "[[air.source]]\n[learned]\nmodel = \"a.h5\"\n";

// A scene in which the row is read, less its own line. It names every table, but what stands in the place of
// others.
WrittenScene scene_around(const TableRow& table, const KeyRow& row) {
    WrittenScene out(every_table);
    if (table.name == Fibre::table)  // in the place of [stretch] and [bend]
        out = WrittenScene("[groom]\ngrid = [2, 2]\nparticles = 8\ncurl_radius = 0\n[fibre]\n[wetness]\n");
    if (table.name == "baseline")
        out = WrittenScene(
            "[groom]\ngrid = [2, 2]\nparticles = 8\ncurl_radius = "
            "0\n[stretch]\n[wetness]\n[[solid]]\n[baseline]\n");
    if (table.name == "solid.mesh")
        out = WrittenScene(
            "[groom]\ngrid = [2, 2]\nparticles = 8\ncurl_radius = 0\n[stretch]\n[[solid]]\nshape = \"mesh\"\n"
            "[[solid.mesh]]\nfile = " +
            quoted(fixtures().path("solid.mesh.file")) +
            "\n[[solid.mesh]]\ntime = 1\nfile = " + quoted(fixtures().path("solid.mesh.file")) + "\n");
    if (table.name == "baseline" && !*row.when.keys && row.key != string("method"))
        out.set(table, "boundary", "\"particles\"");  // one at least is needed
    if (!*row.when.keys) return out;
    const string key = alternatives(row.when.keys).front();
    const string word =
        *row.when.words ? alternatives(row.when.words).front() : fixtures().path(table.name + "." + key);
    out.set(table, key, quoted(word));
    if (table.name == "solid" && word == "mesh" && row.key != string("file")) {
        const std::set<string> of_frames = {"file_fps", "first_file_frame", "rest", "rest_frame"};
        out.set(table, "file",
                quoted(row.key == string("object")   ? fixtures().balls()
                       : of_frames.contains(row.key) ? fixtures().grows()
                                                     : fixtures().path("solid.file")));
    }
    return out;
}

// `include` is read when a file is loaded: tests/base/test_config.cpp.
bool is_include(const KeyRow& row) { return row.key == string(include_row.key); }

TEST(SceneRows, are_all_read) {
    for_each_row([](const TableRow& table, const KeyRow& row) {
        if (is_include(row)) return;
        WrittenScene scene = scene_around(table, row);
        scene.set(table, row.key, allowed_value(table, row));
        EXPECT_NO_THROW(scene_of(scene.text())) << scene.text();
    });
}

// Values that the row must refuse, and what the message must say.
std::vector<std::pair<string, string>> refused_values(const KeyRow& row) {
    const string needs_string = "a string is needed";
    if (row.kind == Kind::word)
        return {{"\"no such word\"", "allowed: " + string(row.words.front())},
                {"3", needs_string},
                {"true", needs_string},
                {"[\"a\"]", needs_string}};
    if (row.kind == Kind::words)
        return {{"\"size\"", "in brackets"},
                {"[\"no such word\"]", "allowed: "},
                {"[3]", "allowed: "},
                {"true", "in brackets"}};
    if (row.is_text()) return {{"3", needs_string}, {"true", needs_string}, {"[\"a\"]", needs_string}};
    if (row.kind == Kind::boolean)
        return {{"1", "true or false"}, {"\"true\"", "true or false"}, {"[true]", "true or false"}};
    std::vector<std::pair<string, string>> out;
    const auto all = [&](const string& number) {
        string text = number;
        if (!row.is_vector()) return text;
        for (size_t k = 1; k < row.size; ++k) text += ", " + number;
        return "[" + text + "]";
    };
    const string needs = row.is_vector() ? "numbers are needed" : "number is needed";
    if (row.is_vector()) {
        out = {{"3", "numbers in brackets"}, {all("\"much\""), needs}, {all("true"), needs}};
        if (row.size > 1) out.emplace_back("[1]", "numbers in brackets");
    } else {
        out = {{"\"much\"", needs}, {"true", needs}, {"[1]", needs}};
    }
    const bool whole = row.is_whole();
    const auto outside = [&](double value) {
        out.emplace_back(all(whole ? std::to_string(long(value)) : number_text(value)), "allowed");
    };
    outside(row.minimum - (whole ? 1 : std::abs(row.minimum) * 0.01 + 1e-9));
    outside(row.maximum + (whole ? 1 : std::abs(row.maximum) * 0.01));
    if (row.kind == Kind::integer) out.emplace_back("1.5", "whole number");
    if (row.kind == Kind::integers) out.emplace_back(all(number_text(row.minimum + 0.5)), "whole");
    if (!whole) {
        out.emplace_back(all("nan"), "allowed");
        out.emplace_back(all("inf"), "allowed");
    }
    return out;
}

TEST(SceneRows, refuse_wrong_kinds_and_values_with_file_and_line) {
    size_t refused = 0;
    for_each_row([&](const TableRow& table, const KeyRow& row) {
        if (is_include(row)) return;
        for (const auto& [value, said] : refused_values(row)) {
            WrittenScene scene = scene_around(table, row);
            const int line = scene.set(table, row.key, value);
            SCOPED_TRACE(value);
            expect_error<Misuse>([&] { scene_of(scene.text()); },
                                 {"scene.toml:" + std::to_string(line) + ": ", row.key, said});
            ++refused;
        }
    });
    EXPECT_GT(refused, 500u);
}

TEST(SceneRows, refuse_keys_that_are_none_with_the_nearest_one) {
    for_each_row([](const TableRow& table, const KeyRow& row) {
        WrittenScene scene = scene_around(table, row);
        if (row.key == string("method")) scene.set(table, "chain", "\"iben\"");
        if (row.key == string("file")) scene.set(table, row.key, allowed_value(table, row));
        const int line = scene.set(table, row.key + string("qx"), "1");
        const string nearest = string(row.key).size() > 4 ? string("did you mean '") + row.key : "";
        expect_error<Misuse>([&] { scene_of(scene.text()); },
                             {"scene.toml:" + std::to_string(line) + ": ", "unknown or unused key", nearest});
    });
}

// A key of a sphere on a box.
TEST(SceneRows, of_a_condition_that_does_not_hold_are_refused_and_say_where_they_are_read) {
    size_t conditions = 0;
    for_each_row([&](const TableRow& table, const KeyRow& row) {
        if (!*row.when.keys || table.name == "baseline")
            return;  // of methods: tests/solver/test_baselines.cpp
        if (std::count_if(table.rows.begin(), table.rows.end(),
                          [&](const KeyRow& other) { return row.key == string(other.key); }) > 1)
            return;  // read under another condition too
        const TableRow& solid = table_named("solid");
        WrittenScene scene(every_table);
        if (table.name == solid.name) scene.set(solid, "shape", "\"plane\"");
        if (row.when.keys == string("hairline")) scene.set(table, row.when.keys, quoted("natural"));
        const int line = scene.set(table, row.key, allowed_value(table, row));
        ++conditions;
        expect_error<Misuse>([&] { scene_of(scene.text()); }, {"scene.toml:" + std::to_string(line) + ": ",
                                                               row.key, "read " + row.when.text()});
    });
    EXPECT_GT(conditions, 10u);
}

TEST(SceneRows, refuse_what_is_no_table_where_one_is_needed) {
    for (const auto& table : scene_rows()) {
        if (table.name.empty() || table.name == "solid.mesh") continue;  // that one's needs a mesh
        SCOPED_TRACE(table.name);
        const string holder = holder_of_table(table.name), name = name_in_holder(table.name);
        string text = table.name.starts_with("wetness.source") ? "[wetness.flow]\n" : "";
        for (const auto& outer : scene_rows())
            if (!outer.name.empty() && (outer.name == holder || outer.name == holder_of_table(holder)))
                text += outer.title() + "\n";
        expect_error<Misuse>([&] { scene_of(text + name + " = 3\n"); },
                             {"scene.toml:", name, table.repeats ? "[[" : "["});
    }
}

// --- every row changes something

// Rows that change no small scene's result, and why.
const std::map<string, string> no_effect = {
    {"include", "names a file whose keys are walked themselves"},
    {"title", "is for people"},
    {"frames", "says how long a run is, not what a frame shows"},
    {"allow", "lets a scene go on that would stop (tests/grooms/test_findings.cpp)"},
    {"groom.repair", "leaves out stray points, of which this file has none (the same)"},
    {"integrator.allow_stretch", "ends a run, or does not"},
    {"groom.density", "cancels in Eq 10, which is a ratio; only rounding is left"},
    {"adhesion.model", "is a network, which the program loads"},
    {"solid.name", "is for people"},
    {"baseline.method", "is the shorthand of chain, cohesion and boundary"},
    {"learned.model", "is read by infer"},
    {"learned.reconstruct", "is read by infer"},
    {"learned.gain", "is read by infer"},
    {"learned.units", "is read by infer"},
};

struct Setting {
    string key, value;  // "groom.scalp"; "": the key is removed
};
// What the scene needs for the row to matter, and the value to compare with, where a small change is too
// little or its default stands still.
struct Change {
    std::vector<Setting> around;
    string value = "";
};

const std::vector<Setting> a_helix = {{"curl.radius", "0.008"}, {"curl.pitch", "0.02"}};
std::vector<Setting> with_helix(std::vector<Setting> more) {
    more.insert(more.end(), a_helix.begin(), a_helix.end());
    return more;
}
Setting file_of(const string& key) { return {key, quoted(fixtures().path(key))}; }

// By key, or by key and condition where several rows have that key.
std::map<string, Change> changes() {
    const Setting mesh{"solid.shape", "\"mesh\""}, no_radius{"solid.radius", ""};
    const std::vector<Setting> soft = {{"stretch.stiffness", "0.05"},
                                       {"bend.stiffness", "5e-4"},
                                       {"core.stiffness", "5e-4"},
                                       {"integrator.substeps", "40"}};
    const std::vector<Setting> of_file = {mesh, no_radius, file_of("solid.file")},
                               grows = {mesh, no_radius, {"solid.file", quoted(fixtures().grows())}};
    std::vector<Setting> rides = grows;
    rides.insert(rides.end(), {{"solid.name", "\"skin\""},
                               {"solid.attached", "\"head\""},
                               {"groom.scalp", "\"skin\""},
                               {"solid.spacing", "0.02"}});
    auto iben = soft;
    iben.insert(iben.end(), {{"baseline.chain", "\"iben\""}, {"baseline.velocity_limit", "0.05"}});
    const Setting lin{"baseline.cohesion", "\"lin\""}, kim{"baseline.cohesion", "\"kim\""},
        wide{"baseline.radius", "0.05"}, particles{"baseline.boundary", "\"particles\""},
        shorthand{"baseline.method", "\"boundary_particles\""};
    return {
        {"groom.scalp_units", {{file_of("groom.scalp"), {"groom.units", "\"m\""}}, "\"cm\""}},
        {"groom.scalp_up",
         {{file_of("groom.scalp"), {"groom.units", "\"m\""}, {"groom.scalp_centre", "[0, 0.01, 0]"}},
          "\"z\""}},
        {"groom.units", {{file_of("groom.file"), {"groom.units", "\"m\""}, {"groom.grid", ""}}, "\"cm\""}},
        {"groom.up", {{file_of("groom.file"), {"groom.units", "\"m\""}, {"groom.grid", ""}}, "\"z\""}},
        {"groom.scale", {{file_of("groom.file"), {"groom.units", "\"m\""}, {"groom.grid", ""}}}},
        {"groom.offset", {{file_of("groom.file"), {"groom.units", "\"m\""}, {"groom.grid", ""}}}},
        {"groom.order", {{file_of("groom.file"), {"groom.units", "\"m\""}, {"groom.grid", ""}}}},
        {"groom.rotation",
         {{file_of("groom.file"), {"groom.units", "\"m\""}, {"groom.grid", ""}}, "[0, 20, 0]"}},
        {"groom.file", {{{"groom.grid", ""}}}},
        {"integrator.looks", {{{"integrator.turn", "0"}}, "1"}},
        {"integrator.turn", {{}, "0"}},
        {"integrator.settle", {{}, "0.1"}},
        {"integrator.settle_after_cut", {{{"motion.cuts", "[2]"}}, "0.1"}},
        {"integrator.limiter", {{}, "1e-5"}},
        {"fibre.profile", {{}, "[1, 0.9]"}},
        {"motion.cuts", {{}, "[2]"}},
        {"motion.preroll", {{}, "0.2"}},
        {"solid.motion.cuts", {{}, "[2]"}},
        {"motion.keyframe.time",
         {{{"motion.keyframe.time", "0.1"}, {"motion.keyframe.rotation", "[0, 30, 0]"}}, "0.05"}},
        {"solid.motion.keyframe.time", {{}, "0.05"}},
        {"wetness.source.motion.axis", {{}, "[1, 0, 0]"}},  // a little less wets no other particle
        {"wetness.source.motion.keyframe.time", {{}, "0.04"}},
        {"wetness.source.motion.keyframe.rotation",
         {{}, "[20, 0, 0]"}},  // a plane: less wets no other particle
        {"wetness.source.motion.keyframe.translation", {{}, "[0, 0.02, 0]"}},
        {"wetness.jitter", {{{"wetness.jitter", ""}}}},
        {"wetness.edge", {{{"wetness.pattern", "\"tip\""}}}},
        {"wetness.radius", {{{"wetness.pattern", "\"region\""}, {"wetness.center", "[0, 0.05, -0.08]"}}}},
        {"wetness.center", {{{"wetness.pattern", "\"region\""}}, "[0, 0.05, -0.08]"}},
        {"wetness.file", {{{"wetness.pattern", "\"file\""}, file_of("wetness.file")}}},
        {"curl.radius", {a_helix, "0.0085"}},
        {"curl.pitch", {a_helix, "0.022"}},
        {"curl.form", {a_helix, "\"printed\""}},
        {"curl.push", {with_helix({{"curl.form", "\"printed\""}})}},
        {"cohesion.relaxation", {{}, "2"}},  // a little less takes as many sweeps
        {"cohesion.lock_width", {{{"cohesion.radius", ""}}, "0.05"}},
        {"cohesion.neighbours", {{{"cohesion.radius", "0.1"}}, "1"}},
        {"solid.shape", {{}, "\"capsule\""}},
        {"solid.radius with shape = capsule", {{{"solid.shape", "\"capsule\""}}}},
        {"solid.radius with shape = head", {{{"solid.shape", "\"head\""}}}},
        {"solid.spacing with shape = head", {{{"solid.shape", "\"head\""}, no_radius}, "0.02"}},
        {"solid.half_length", {{{"solid.shape", "\"capsule\""}}}},
        {"solid.half", {{{"solid.shape", "\"box\""}, no_radius}}},
        {"solid.file", {{mesh, no_radius, file_of("solid.file")}}},
        {"solid.units", {of_file, "\"cm\""}},
        {"solid.up", {of_file, "\"z\""}},
        {"solid.rotation", {of_file, "[0, 0, 20]"}},
        {"solid.scale", {of_file}},
        {"solid.offset", {of_file}},
        {"solid.object",
         {{mesh, no_radius, {"solid.file", quoted(fixtures().balls())}, {"solid.object", "\"/balls/one\""}},
          "\"/balls/other\""}},
        {"solid.file_fps", {grows, "48"}},
        {"solid.first_file_frame", {grows, "2"}},
        {"solid.rest_frame", {rides, "3"}},
        {"solid.rest", {rides, quoted(fixtures().path("solid.rest", true))}},
        {"solid.spacing", {{mesh, no_radius, file_of("solid.file")}, "0.02"}},
        {"solid.mesh.time", {{}, "0.05"}},
        {"wetness.source.shape", {{}, "\"sphere\""}},
        {"wetness.source.radius", {{{"wetness.source.shape", "\"sphere\""}}}},
        {"wetness.source.from", {{}, "0.1"}},
        {"wetness.source.until", {{}, "0.1"}},
        {"air.density", {{{"air.two_way", "true"}}}},
        {"baseline.chain", {soft, "\"iben\""}},
        {"baseline.cohesion", {{}, "\"lin\""}},
        {"baseline.boundary", {{}, "\"particles\""}},
        {"baseline.velocity_limit", {iben, "0.051"}},
        {"baseline.strength with cohesion or method = lin", {{lin, wide}}},
        {"baseline.radius with cohesion or method = lin", {{lin, wide}, "0.0505"}},
        {"baseline.strength with cohesion or method = kim", {{kim, wide}}},
        {"baseline.area", {{kim, wide}}},
        {"baseline.radius with cohesion or method = kim", {{kim, wide}, "0.0505"}},
        {"baseline.boundary_strength", {{particles}}},
        {"baseline.boundary_range", {{particles}}},
        {"baseline.boundary_spacing", {{particles}}},
        {"baseline.strength with method = boundary_particles", {{shorthand}}},
        {"baseline.range", {{shorthand}}},
        {"baseline.spacing", {{shorthand}}},
    };
}

// The scene that a table's rows are changed in.
string base_scene(const string& table) {
    const string turning = "[motion]\nangle = 40\nperiod = 0.2\n", ball = "[[solid]]\nradius = 0.1\n";
    const string moving = "angle = 40\nperiod = 0.4\nshift = [0, 0.01, 0]\n";
    if (table.starts_with("wetness.")) {
        WrittenScene half_wet(flowing_scene(0.05, 0.2));
        half_wet.set(table_named("wetness"), "level", "0.5");
        return half_wet.text() +
               (table == "wetness.source.motion" ? "[wetness.source.motion]\n" + moving : "");
    }
    if (table.starts_with("air"))
        return dry_scene +
               "[air]\ngrid = [16, 16, 16]\nsize = 0.6\nwind = [0.2, 0, 0]\n[[air.source]]\n"
               "center = [0.1, -0.1, 0]\nvelocity = [-2, 0.5, 0.3]\nperiod = 0.4\n";
    if (table == Fibre::table) return as_fibre(dry_scene) + turning + "[wetness]\nlevel = 0.5\n";
    if (table == "strand_contact") return wet_scene + "[strand_contact]\nradius = 0.03\n";
    if (table == "baseline") return dry_scene + turning + "[wetness]\n" + ball;
    if (table == "motion.keyframe")
        return dry_scene +
               "[[motion.keyframe]]\ntime = 0.1\nrotation = [0, 30, 0]\n[[motion.keyframe]]\n"
               "time = 0.4\n";
    if (table == "solid.mesh")
        return dry_scene +
               "[[solid]]\nshape = \"mesh\"\nspacing = 0.01\n[[solid.mesh]]\ntime = 0.02\nfile = " +
               quoted(fixtures().path("solid.mesh.file")) +
               "\n[[solid.mesh]]\ntime = 0.2\nfile = " + quoted(fixtures().path("solid.mesh.file", true)) +
               "\n";
    if (table == "solid" || table == "solid.motion")
        return dry_scene + turning + "[wetness]\n[adhesion]\n" + ball +
               (table == "solid.motion" ? "[solid.motion]\n" + moving : "");
    // A term of its own is there with its defaults.
    const TableRow& row = table_named(table);
    const string header = row.title() + "\n";
    const bool there = table.empty() || wet_scene.find(header) != string::npos;
    return there || !std::ranges::all_of(row.rows, &KeyRow::has_default) ? wet_scene : wet_scene + header;
}

// A value that differs: by 1 % (from 0: a fifth of the range, at most 1), by one, the next word, the other
// file.
string changed_value(const TableRow& table, const KeyRow& row) {
    if (row.kind == Kind::path) return quoted(fixtures().path(full_key(table, row), true));
    if (row.kind == Kind::boolean) return row.fallback != 0 ? "false" : "true";
    if (row.kind == Kind::word) {
        const auto at = std::find(row.words.begin(), row.words.end(), string(row.word));
        return quoted(at + 1 < row.words.end() ? at[1] : row.words.front());
    }
    const auto changed = [&](double value) {
        if (row.is_whole()) return std::to_string(long(value < row.maximum ? value + 1 : value - 1));
        if (row.is_vector()) return number_text(value + (value + 0.01 <= row.maximum ? 0.01 : -0.01));
        if (value == 0) return number_text(std::min(1.0, row.maximum / 5));
        return number_text(value * 1.01 <= row.maximum ? value * 1.01 : value * 0.99);
    };
    if (!row.is_vector()) return changed(row.fallback);
    string text;
    for (size_t k = 0; k < row.size; ++k) text += (k ? ", " : "[") + changed(row.vector[k]);
    return text + "]";
}

void set(WrittenScene& scene, const Setting& setting) {
    const TableRow& table = table_named(holder_of_table(setting.key));
    const string key = name_in_holder(setting.key);
    if (setting.value.empty()) return scene.remove(table, key);
    scene.set(table, key, setting.value);
}

bool is_finite(const RunFrame& frame) {
    for (const Vec3f& x : frame.seen().points)
        if (!std::isfinite(norm(x))) return false;
    return true;
}
bool same_result(const RunFrame& a, const RunFrame& b) {
    return same_bits(a.seen(), b.seen()) && a.saturation == b.saturation;
}

TEST(SceneRows, each_changes_the_result_or_has_a_reason_not_to) {
    constexpr int frames = 6;
    const Scene usual = scene_of(wet_scene);
    fixtures().write_run(usual, 0.3f, false), fixtures().write_run(usual, 0.6f, true);
    std::map<string, RunFrame> results;
    auto result_of = [&](const string& text) -> const RunFrame& {
        if (!results.contains(text)) results[text] = after(scene_of(text), frames);
        return results[text];
    };
    auto special = changes();
    std::set<string> used;
    for_each_row([&](const TableRow& table, const KeyRow& row) {
        const string key = full_key(table, row), exact = key + " " + row.when.text();
        if (no_effect.contains(key)) {
            used.insert(key);
            return;
        }
        const string name = special.contains(exact) ? exact : key;
        const Change change = special[name];
        used.insert(name);
        WrittenScene scene(base_scene(table.name));
        for (const auto& setting : change.around) set(scene, setting);
        const string before = scene.text();
        scene.set(table, row.key, change.value.empty() ? changed_value(table, row) : change.value);
        SCOPED_TRACE(scene.text());
        ASSERT_NE(before, scene.text());
        const RunFrame &base = result_of(before), &other = result_of(scene.text());
        EXPECT_TRUE(is_finite(base) && is_finite(other));
        EXPECT_FALSE(same_result(base, other));
    });
    // No exception and no special case without its row.
    for (const auto& [key, reason] : no_effect) EXPECT_TRUE(used.contains(key)) << key;
    for (const auto& [key, change] : changes()) EXPECT_TRUE(used.contains(key)) << key;
}

// What a row says of its default is so: to write it changes nothing.
TEST(SceneRows, have_the_defaults_that_they_say) {
    constexpr int frames = 2;
    for_each_row([&](const TableRow& table, const KeyRow& row) {
        if (!row.has_default() || no_effect.contains(full_key(table, row))) return;
        auto special = changes();
        const string exact = full_key(table, row) + " " + row.when.text();
        WrittenScene scene(base_scene(table.name));
        for (const auto& s : special[special.contains(exact) ? exact : full_key(table, row)].around)
            set(scene, s);
        scene.remove(table, row.key);
        if (table.name.ends_with("motion") && row.key == string("period"))  // without one nothing oscillates
            scene.remove(table, "angle"), scene.remove(table, "shift");
        const string absent = scene.text();
        scene.set(table, row.key, row.default_text());
        SCOPED_TRACE(scene.text());
        EXPECT_TRUE(same_result(after(scene_of(absent), frames), after(scene_of(scene.text()), frames)));
    });
}

}  // namespace
}  // namespace wetcurl

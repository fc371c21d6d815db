// Scenes: what is read, what is refused and with which words. test_scene_rows.cpp walks the single keys.
#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;
namespace fs = std::filesystem;

// A scene that names every table, with one more line in one of them; the line's number, for its message.
struct Written {
    std::string text, place;
};
Written with_line(const std::string& table, const std::string& line) {
    const std::string names[] = {"groom",     "integrator",   "stretch", "bend",          "core",
                                 "wetness",   "wetness.flow", "curl",    "cohesion",      "adhesion",
                                 "stiffness", "motion",       "air",     "strand_contact"};
    Written out;
    int number = 0;
    auto add = [&](const std::string& l) { out.text += l + "\n", ++number; };
    if (table.empty()) add(line), out.place = "scene.toml:1";
    for (const auto& name : names) {
        add("[" + name + "]");
        if (name == "groom") add("grid = [2, 2]"), add("particles = 8");
        if (name == table) add(line), out.place = "scene.toml:" + std::to_string(number);
    }
    add("[[solid]]");
    if (table == "solid") add(line), out.place = "scene.toml:" + std::to_string(number);
    return out;
}

void expect_misuse(const std::string& table, const std::string& line, const std::string& said) {
    SCOPED_TRACE("[" + table + "] " + line);
    const Written w = with_line(table, line);
    expect_error<Misuse>([&] { scene_of(w.text); }, {w.place.c_str(), said.c_str()});
}

TEST(Scene, values_that_are_written_are_taken) {
    const Scene s = scene_of(with_line("bend", "stiffness = 0.125").text,
                             {"frames=7", "cohesion.passes=3", "integrator.substeps=2"});
    EXPECT_EQ(s.term<Bend>()->k_b, 0.125);
    EXPECT_EQ(s.frames, 7);
    EXPECT_EQ(s.cohesion->passes, 3);
    EXPECT_EQ(s.integrator.substeps, 2);
    EXPECT_EQ(s.groom.rest.count, 4);
}

TEST(Scene, words_and_keys_that_are_none_are_told_the_nearest_and_what_else_is_needed) {
    expect_misuse("", "framse = 3", "did you mean 'frames'");
    expect_misuse("", "wetnes = {}", "did you mean 'wetness'");
    expect_misuse("groom", "rest = \"saggy\"", "sag_free");
    expect_misuse("integrator", "kind = \"explicti\"", "did you mean 'explicit'");
    expect_misuse("integrator", "setle = 1", "did you mean 'settle'");
    expect_misuse("bend", "form = \"print\"", "printed");
    expect_misuse("wetness", "pattern = \"tipp\"", "did you mean 'tip'");
    expect_misuse("wetness", "pattern = \"file\"", "file");
    expect_misuse("curl", "radius = 0.01", "both radius and pitch");
    expect_misuse("curl", "pitch = 0.01", "both radius and pitch");
    expect_misuse("curl", "form = \"printed\"", "radius and pitch");
    expect_misuse("motion", "angel = 3", "did you mean 'angle'");
    expect_misuse("solid", "shape = \"spere\"", "did you mean 'sphere'");
    expect_misuse("solid", "shape = \"mesh\"", "file");
    expect_misuse("solid", "raduis = 0.1", "did you mean 'radius'");
    expect_misuse("solid", "half = [1, 1, 1]", "read with shape = box");
}

TEST(Scene, tables_that_lean_on_others_say_so) {
    const std::string chain = "[groom]\ngrid = [2, 2]\nparticles = 8\n[stretch]\n";
    expect_error<Misuse>([&] { scene_of(chain + "[bend]\n[curl]\n"); }, {"scene.toml:6", "[wetness]"});
    expect_error<Misuse>([&] { scene_of(chain + "[cohesion]\n"); }, {"scene.toml:5", "[wetness]"});
    expect_error<Misuse>([&] { scene_of(chain + "[wetness]\n[curl]\n"); }, {"scene.toml:6", "[bend]"});
    expect_error<Misuse>([&] { scene_of(chain + "[wetness]\n[adhesion]\n"); }, {"scene.toml:6", "[[solid]]"});
    expect_error<Misuse>([&] { scene_of(chain + "[wetness]\n[wetness.flow]\n[cohesion]\nspacing = 0.01\n"); },
                         {"scene.toml:8", "spacing", "[wetness.flow]"});
    expect_error<Misuse>(
        [&] { scene_of(chain + "[wetness]\n[cohesion]\nlock_width = 0.01\nradius = 0.01\n"); },
        {"scene.toml:7", "lock_width", "radius"});
    for (const char* beside : {"[wetness.flow]\n[cohesion]\n", "[cohesion]\nstrength = 20\n"})
        expect_error<Misuse>([&] { scene_of(chain + "[wetness]\n" + beside + "neighbours = 50\n"); },
                             {"scene.toml:8", "neighbours", "allowed is 0"});
    expect_error<Misuse>([&] { scene_of(chain, {"groom.rest='sag_free'"}); }, {"sag_free", "[bend]"});
    expect_error<Misuse>(
        [&] { scene_of(chain + "[[solid]]\nattached = \"head\"\n[solid.motion]\nperiod = 1\n"); },
        {"attached", "head"});
    expect_error<Misuse>([&] { scene_of(chain + "[stretch"); }, {"scene.toml:5"});
}

TEST(Scene, a_learned_scene_names_its_model_trained_or_not) {
    const Scene s = scene_of(dry_scene + "[learned]\nmodel = \"absent.h5\"\n");
    ASSERT_TRUE(s.learned);
    EXPECT_EQ(fs::path(s.learned->model).filename(), "absent.h5");
    EXPECT_TRUE(fs::path(s.learned->model).is_absolute());
    EXPECT_EQ(s.learned->reconstruct, "");
    EXPECT_FALSE(s.learned->gain);
    EXPECT_EQ(s.learned->units, "");
    const Scene set = scene_of(dry_scene + "[learned]\nmodel = \"a.h5\"\ngain = 30\nunits = \"printed\"\n");
    EXPECT_EQ(set.learned->gain, 30);
    EXPECT_EQ(set.learned->units, "printed");
    EXPECT_EQ(
        scene_of(dry_scene + "[learned]\nmodel = \"a.h5\"\nreconstruct = \"paper\"\n").learned->reconstruct,
        "paper");
    EXPECT_FALSE(scene_of(dry_scene).learned);
    const auto refuses = [](const std::string& lines, std::initializer_list<std::string> said) {
        expect_error<Misuse>([&] { scene_of(dry_scene + "[learned]\n" + lines); }, said);
    };
    refuses("", {"scene.toml:11", "learned.model", "needed"});
    refuses("model = 3", {"scene.toml:12", "learned.model"});
    refuses("model = \"a.h5\"\nmodell = \"b.h5\"", {"scene.toml:13", "did you mean 'model'"});
    refuses("model = \"a.h5\"\nreconstruct = \"cor\"",
            {"scene.toml:13", "did you mean 'core'", "paper, core"});
    refuses("model = \"a.h5\"\ngain = -1", {"scene.toml:13", "learned.gain", "found -1"});
    refuses("model = \"a.h5\"\nunits = \"meters\"", {"scene.toml:13", "length, printed"});
}

TEST(Scene, a_dry_twin_keeps_the_record_of_its_wetness_and_nothing_that_acts) {
    Scene s = scene_of(wet_scene);
    const auto saturation = s.saturation;
    make_dry(s);
    EXPECT_FALSE(acts_wet(s));
    EXPECT_FALSE(s.curl || s.cohesion || s.term<Adhesion>() || s.term<CurlPush>());
    EXPECT_TRUE(s.term<Stretch>() && s.term<Bend>() && s.term<Core>());
    EXPECT_EQ(s.saturation, saturation);
    EXPECT_GT(saturation.size(), 0u);
}

TEST(Scene, strides_take_every_second_root_each_way_with_its_saturation) {
    const Scene fine = scene_of(wet_scene), coarse = scene_of(wet_scene, {}, 2);
    const int n = fine.groom.rest.particles;
    ASSERT_EQ(coarse.groom.rest.count, 4);
    for (int row = 0; row < 2; ++row)
        for (int column = 0; column < 2; ++column) {
            const int a = coarse.groom.grid.at(column, row), b = fine.groom.grid.at(2 * column, 2 * row);
            for (int i = 0; i < n; ++i) {
                EXPECT_TRUE(same_bits(coarse.groom.rest.at(a, i), fine.groom.rest.at(b, i)));
                EXPECT_EQ(coarse.saturation[size_t(a * n + i)], fine.saturation[size_t(b * n + i)]);
            }
        }
}

}  // namespace
}  // namespace wetcurl

// Scene files: typed reading, includes, assignments, and what is said about every kind of bad input.
#include "base/config.h"
#include "base/parameters.h"
#include "scratch.h"

namespace wetcurl {
namespace {

using testing::expect_error;
using testing::Scratch;

constexpr double inf = unbounded;

Config scene(const std::string& text) { return Config::parse(text, "scene.toml"); }

TEST(Config, getters_return_what_is_written) {
    const Config c = [] {
        return scene(
            "frames = 48\nwet = true\ntitle = \"curl\"\ng = [0, -9.81, 0.5]\n[bend]\nform = "
            "\"printed\"\nstiffness = 1e-3\n");
    }();
    Config config = c;
    Table root = config.root(), bend = root.table("bend");
    EXPECT_EQ(root.integer("frames", 1, 1, 1000), 48);
    EXPECT_TRUE(root.boolean("wet", false));
    EXPECT_EQ(root.text("title", ""), "curl");
    EXPECT_EQ(root.numbers("g", {0, 0, 0}, -inf, inf), (std::vector<double>{0, -9.81, 0.5}));
    EXPECT_TRUE(bend.present());
    EXPECT_EQ(bend.choice("form", "variational", {"variational", "printed"}), "printed");
    EXPECT_EQ(bend.number("stiffness", 1, 0, inf), 1e-3);
    EXPECT_EQ(*bend.optional_number("stiffness", 0, inf), 1e-3);
    EXPECT_NO_THROW(config.require_all_used());
}

TEST(Config, absent_keys_give_their_default_and_absent_tables_are_not_there) {
    Config config = scene("frames = 3\n");
    Table root = config.root(), air = root.table("air");
    EXPECT_FALSE(air.present());
    EXPECT_FALSE(root.has("wet"));
    EXPECT_TRUE(root.has("frames"));
    EXPECT_EQ(air.number("drag", 0.25, 0, 1), 0.25);
    EXPECT_EQ(air.numbers("grid", {64, 64}, 1, 512), (std::vector<double>{64, 64}));
    EXPECT_EQ(air.choice("form", "a", {"a", "b"}), "a");
    EXPECT_FALSE(root.optional_number("spacing", 0, 1).has_value());
    EXPECT_EQ(root.path("file"), "");
    EXPECT_TRUE(root.tables("solid").empty());
}

TEST(Config, an_empty_table_is_present) {
    Config config = scene("[curl]\n");
    EXPECT_TRUE(config.root().table("curl").present());
}

TEST(Config, arrays_of_tables_keep_their_order_and_place) {
    Config config = scene("[[solid]]\nshape = \"sphere\"\n[[solid]]\nshape = \"box\"\nradius = -1\n");
    const auto solids = config.root().tables("solid");
    ASSERT_EQ(solids.size(), 2u);
    EXPECT_EQ(solids[0].text("shape", ""), "sphere");
    EXPECT_EQ(solids[1].text("shape", ""), "box");
    expect_error<Misuse>([&] { solids[1].number("radius", 1, 0, inf); },
                         {"scene.toml:5", "solid[1].radius", "-1", "0"});
}

TEST(Config, paths_start_at_the_folder_of_the_file) {
    const Scratch scratch;
    std::filesystem::create_directory(scratch.path("heads"));
    Config config = Config::load(scratch.file("s.toml", "file = \"heads/../head.obj\"\n"));
    EXPECT_EQ(config.root().path("file"), scratch.path("head.obj"));
    EXPECT_EQ(config.folder(), scratch.path());
}

TEST(Config, ranges_stand_in_the_place_of_numbers) {
    Config config = scene(
        "length = [0.1, 0.25]\nturns = [3, 6]\nsame = [2, 2]\n"
        "axis = [[-1, 1], [0.5, 0.5], [-2.5, 0]]\nwhole = [[-3, 4]]\n"
        "keys = [{ time = [0.1, 0.2] }, { time = [0.5, 0.9], at = [[0, 1], [2, 3]] }]\n");
    const Table root = config.root();
    using Each = std::vector<std::array<double, 2>>;
    auto expect = [&](const std::string& key, const Each& each, const std::string& text) {
        const Table::Ranges found = root.ranges(key);
        EXPECT_EQ(found.each, each) << key;
        std::vector<double> lower;
        for (const auto& [low, high] : found.each) lower.push_back(low);
        EXPECT_EQ(found.with(lower), text) << key;
    };
    expect("length", {{0.1, 0.25}}, "0.1");
    expect("turns", {{3, 6}}, "3");  // whole numbers are numbers
    expect("same", {{2, 2}}, "2");
    expect("axis", {{-1, 1}, {0.5, 0.5}, {-2.5, 0}}, "[-1, 0.5, -2.5]");
    expect("whole", {{-3, 4}}, "[-3]");
    // Of an inline table in the order of names.
    expect("keys", {{0.1, 0.2}, {0, 1}, {2, 3}, {0.5, 0.9}}, "[{time = 0.1}, {at = [0, 2], time = 0.5}]");
    EXPECT_NO_THROW(config.require_all_used());
}

TEST(Config, keys_are_those_written_in_order_and_are_not_used_by_being_listed) {
    Config config = scene("[vary]\nturns = [3, 6]\n\"groom.length\" = [1, 2]\nhead = 1\n[empty]\n");
    const Table vary = config.root().table("vary");
    EXPECT_EQ(vary.keys(), (std::vector<std::string>{"groom.length", "head", "turns"}));
    EXPECT_EQ(config.root().keys(), (std::vector<std::string>{"empty", "vary"}));
    EXPECT_TRUE(config.root().table("empty").keys().empty());
    EXPECT_TRUE(config.root().table("absent").keys().empty());
    vary.ranges("turns");
    expect_error<Misuse>([&] { config.require_all_used(); }, {"scene.toml", "vary."});
    config.set("vary.added=3");
    EXPECT_EQ(vary.keys(), (std::vector<std::string>{"added", "groom.length", "head", "turns"}));
}

struct BadValue {
    const char* text;
    void (*read)(Table);
    std::vector<std::string> parts;
};

TEST(Config, bad_values_name_file_line_key_what_was_found_and_what_is_allowed) {
    constexpr auto ranges = [](Table t) { t.ranges("x"); };
    const BadValue bad[] = {
        {"\nx = \"abc\"",
         [](Table t) { t.number("x", 0, 0, 1); },
         {"scene.toml:2", "x", "abc", "string", "number"}},
        {"x = 1.5", [](Table t) { t.number("x", 0, 0, 1); }, {"scene.toml:1", "1.5", "0 to 1"}},
        {"x = -0.1", [](Table t) { t.number("x", 0, 0, 1); }, {"-0.1", "0 to 1"}},
        {"x = nan", [](Table t) { t.number("x", 0, -inf, inf); }, {"scene.toml:1", "nan"}},
        {"x = inf", [](Table t) { t.number("x", 0, -inf, inf); }, {"scene.toml:1", "inf"}},
        {"x = 2.5", [](Table t) { t.integer("x", 0, 0, 9); }, {"2.5", "whole"}},
        {"x = 10", [](Table t) { t.integer("x", 0, 0, 9); }, {"10", "0 to 9"}},
        {"x = 1", [](Table t) { t.boolean("x", false); }, {"1", "true or false"}},
        {"x = 1", [](Table t) { t.text("x", ""); }, {"1", "string"}},
        {"x = \"varational\"",
         [](Table t) {
             t.choice("x", "variational", {"variational", "printed"});
         },
         {"'varational'", "variational, printed", "did you mean 'variational'"}},
        {"x = [1, 2]",
         [](Table t) {
             t.numbers("x", {0, 0, 0}, 0, 9);
         },
         {"3 numbers"}},
        {"x = [1, 2, \"c\"]",
         [](Table t) {
             t.numbers("x", {0, 0, 0}, 0, 9);
         },
         {"scene.toml:1", "c", "numbers"}},
        {"x = [1, 2, 30]",
         [](Table t) {
             t.numbers("x", {0, 0, 0}, 0, 9);
         },
         {"30", "0 to 9"}},
        {"x = 5",
         [](Table t) {
             t.numbers("x", {0, 0, 0}, 0, 9);
         },
         {"3 numbers"}},
        {"x = 5", [](Table t) { t.table("x"); }, {"an integer", "[x]"}},
        {"x = 5", [](Table t) { t.tables("x"); }, {"[[x]]"}},
        {"\nx = [2, 1]", ranges, {"scene.toml:2: x", "[ 2, 1 ]", "[low, high]"}},
        {"x = 3", ranges, {"scene.toml:1: x", "found 3", "[low, high]"}},
        {"x = \"wide\"", ranges, {"scene.toml:1: x", "wide", "[low, high]"}},
        {"x = []", ranges, {"scene.toml:1: x", "[]", "[low, high]"}},
        {"x = [1]", ranges, {"scene.toml:1: x", "[ 1 ]", "[low, high]"}},
        {"x = [1, 2, 3]", ranges, {"scene.toml:1: x", "[ 1, 2, 3 ]", "[low, high]"}},
        {"x = [1, \"b\"]", ranges, {"scene.toml:1: x", "b", "[low, high]"}},
        {"x = [false, true]", ranges, {"scene.toml:1: x", "[ false, true ]", "[low, high]"}},
        {"x = [0, inf]", ranges, {"scene.toml:1: x", "inf", "[low, high]"}},
        {"x = [nan, 1]", ranges, {"scene.toml:1: x", "nan", "[low, high]"}},
        {"\n\nx = [[0, 1], [3, 2]]", ranges, {"scene.toml:3: x", "[ 3, 2 ]", "such pairs in arrays"}},
        {"x = [[0, 1], 2]", ranges, {"scene.toml:1: x", "2", "such pairs in arrays"}},
        {"x = [[]]", ranges, {"scene.toml:1: x", "such pairs in arrays"}},
        {"x = [[0, 1, 2]]", ranges, {"scene.toml:1: x", "such pairs in arrays"}},
        {"[x]\ny = 1", ranges, {"scene.toml:1: x", "a table", "[low, high]"}},
        {"y = 1", ranges, {"x", "found nothing", "[low, high]"}},
        {"[x]", [](Table t) { t.number("x", 0, 0, 1); }, {"a table", "number"}},
    };
    for (const auto& b : bad) {
        SCOPED_TRACE(b.text);
        Config config = scene(b.text);
        expect_error<Misuse>([&] { b.read(config.root()); }, {"scene.toml"});
        for (const auto& part : b.parts) expect_error<Misuse>([&] { b.read(config.root()); }, {part});
    }
}

TEST(Config, an_unknown_key_is_an_error_with_its_line_and_the_nearest_name) {
    Config config = scene("frames = 2\n[bend]\nstiffnes = 3\n");
    Table root = config.root();
    root.integer("frames", 1, 1, 9);
    root.table("bend").number("stiffness", 1, 0, 9);
    root.number("stiffnesses", 1, 0, 9);  // of another table: must not be proposed
    expect_error<Misuse>([&] { config.require_all_used(); },
                         {"scene.toml:3", "'bend.stiffnes'", "did you mean 'stiffness'"});
}

TEST(Config, a_value_of_an_included_file_is_blamed_on_that_file) {
    Scratch scratch;
    scratch.file("below.toml", "\n[groom]\n\nlength = 3\nwdith = 1\n[[solid]]\n[[solid]]\nradius = 5\n");
    Config config =
        Config::load(scratch.file("above.toml", "include = \"below.toml\"\n[groom]\npitch = 9\n"));
    Table groom = config.root().table("groom");
    expect_error<Misuse>([&] { groom.number("length", 1, 0, 2); }, {"below.toml:4: groom.length"});
    expect_error<Misuse>([&] { groom.number("pitch", 1, 0, 2); }, {"above.toml:3: groom.pitch"});
    expect_error<Misuse>([&] { config.root().tables("solid").at(1).number("radius", 1, 0, 2); },
                         {"below.toml:8: solid[1].radius"});
    expect_error<Misuse>([&] { config.require_all_used(); }, {"below.toml:5: ", "'groom.wdith'"});
    // A table that --set gives whole has no line of the file.
    config.set("groom={length = 7}");
    expect_error<Misuse>([&] { config.root().table("groom").number("length", 1, 0, 2); },
                         {"--set groom: groom.length: found 7"});
}

TEST(Config, backslashes_of_a_path_are_named_as_what_they_are) {
    auto path = [](const std::string& text) { return scene(text).root().path("file"); };
    const std::string printed = "found 'in\\base.data', which has control characters";  // no backspace in it
    expect_error<Misuse>([&] { path("\nfile = \"in\\base.data\"\n"); },
                         {"scene.toml:2: file", printed, "escape", "write /"});
    expect_error<Misuse>([&] { path("file = \"in\\data\"\n"); }, {"scene.toml:1", "escape", "write /"});
    expect_error<Misuse>([&] { path("file = 'in\\data'\n"); }, {"scene.toml:1", "write 'in/data'"});
    expect_error<Misuse>([&] { scene("include = \"in\\base.toml\"\n"); },
                         {"scene.toml:1: include", "in\\base"});
    EXPECT_TRUE(path("file = \"in/data\"\n").ends_with("/in/data"));
}

TEST(Config, what_replaces_is_blamed_on_its_own_text_and_a_copy_is_its_own) {
    Config config = scene("[groom]\nlength = 1\n[[solid]]\nradius = 1\n");
    Config other = config.copy();
    other.replace("\n[groom]\npitch = 9\n[[solid]]\nradius = 8\n", "recipe.toml:7: text");
    other.set("fps=9", "recipe.toml:9: draw.fps");
    expect_error<Misuse>([&] { other.root().table("groom").number("pitch", 1, 0, 2); },
                         {"recipe.toml:7: text:3: groom.pitch"});
    expect_error<Misuse>([&] { other.root().tables("solid").at(1).number("radius", 1, 0, 2); },
                         {"recipe.toml:7: text:5: solid[1].radius"});
    expect_error<Misuse>([&] { other.root().number("fps", 1, 0, 2); }, {"recipe.toml:9: draw.fps: found 9"});
    EXPECT_EQ(config.root().table("groom").number("length", 0, 0, 2), 1);
    EXPECT_EQ(config.root().tables("solid").size(), 1u);
    EXPECT_FALSE(config.root().has("fps"));
}

TEST(Config, an_unknown_table_and_a_key_unknown_in_an_array_of_tables_are_errors) {
    Config tables = scene("[wetnes]\nlevel = 1\n");
    tables.root().table("wetness");
    expect_error<Misuse>([&] { tables.require_all_used(); },
                         {"scene.toml:1", "'wetnes'", "did you mean 'wetness'"});
    Config arrays = scene("[[solid]]\nshape = \"box\"\nhafl = 1\n");
    for (const Table& t : arrays.root().tables("solid")) t.text("shape", ""), t.number("half", 1, 0, 1);
    expect_error<Misuse>([&] { arrays.require_all_used(); }, {"scene.toml:3", "hafl", "did you mean 'half'"});
}

TEST(Config, assignments_are_typed_win_and_are_named_in_errors) {
    Config config = scene("[bend]\nstiffness = 3\n");
    config.set("bend.stiffness=0.5");
    config.set("bend.form=printed");
    config.set("head.radius=-1");
    config.set("grid=[4, 8]");
    Table root = config.root();
    EXPECT_EQ(root.table("bend").number("stiffness", 1, 0, 9), 0.5);
    EXPECT_EQ(root.table("bend").text("form", ""), "printed");
    EXPECT_EQ(root.numbers("grid", {0, 0}, 0, 9), (std::vector<double>{4, 8}));
    expect_error<Misuse>([&] { root.table("head").number("radius", 1, 0, 9); },
                         {"--set", "head.radius", "-1"});
}

TEST(Config, assignments_reach_names_that_hold_dots) {
    Config config = scene("[draw]\n\"groom.length\" = [0.1, 0.2]\n");
    config.set("draw.\"groom.length\"=[0.3, 0.4]");
    EXPECT_EQ(config.root().table("draw").numbers("groom.length", {0, 0}, 0, 9),
              (std::vector<double>{0.3, 0.4}));
    config.require_all_used();
    for (const char* wrong : {"draw.\"groom.length=1", "draw.\"\"=1", "draw..length=1", "draw.[0]=1"})
        expect_error<Misuse>([&] { config.set(wrong); }, {"found key", "in quotes where a name has dots"});
    config.set("draw.\"groom.width\"=1");
    expect_error<Misuse>([&] { config.require_all_used(); }, {"--set", "groom.width"});
}

TEST(Config, malformed_and_unused_assignments_are_errors) {
    Config config = scene("[bend]\nstiffness = 3\n");
    expect_error<Misuse>([&] { config.set("nonsense"); }, {"nonsense", "key.path=value"});
    expect_error<Misuse>([&] { config.set("=3"); }, {"key.path=value"});
    expect_error<Misuse>([&] { config.set("bend.stiffness.deeper=3"); }, {"'stiffness' is no table"});
    config.set("bend.stifness=1");
    config.root().table("bend").number("stiffness", 1, 0, 9);
    expect_error<Misuse>([&] { config.require_all_used(); },
                         {"--set", "stifness", "did you mean 'stiffness'"});
}

TEST(Config, includes_merge_below_the_file_that_names_them) {
    const Scratch scratch;
    scratch.file("head.toml", "fps = 30\n[head]\nradius = 0.1\nspin = 2\n");
    Config config =
        Config::load(scratch.file("wet.toml", "include = \"head.toml\"\nframes = 2\n[head]\nradius = 0.2\n"));
    Table head = config.root().table("head");
    EXPECT_EQ(head.number("radius", 0, 0, 1), 0.2);
    EXPECT_EQ(head.number("spin", 0, 0, 9), 2);
    EXPECT_EQ(config.root().number("fps", 24, 1, 100), 30);
    EXPECT_EQ(config.root().integer("frames", 1, 1, 9), 2);
    EXPECT_NO_THROW(config.require_all_used());
}

TEST(Config, includes_that_are_missing_circular_or_no_text_are_errors) {
    const Scratch scratch;
    expect_error<Misuse>([&] { Config::load(scratch.file("a.toml", "\ninclude = \"none.toml\"\n")); },
                         {"a.toml:2", "none.toml"});
    expect_error<Misuse>([&] { Config::load(scratch.file("b.toml", "include = \"b.toml\"\n")); },
                         {"b.toml:1", "include"});
    expect_error<Misuse>([&] { Config::load(scratch.file("c.toml", "include = 3\n")); },
                         {"c.toml:1", "include"});
}

TEST(Config, text_reads_back_as_the_same_scene) {
    Config config =
        scene("frames = 2\nx = 0.1\n[bend]\nform = \"a \\\"b\\\"\"\n[[solid]]\nhalf = [1, 2.5, 3]\n");
    config.set("bend.stiffness=1e-7");
    const std::string text = config.text();
    Config again = Config::parse(text, "again.toml");
    EXPECT_EQ(again.text(), text);
    EXPECT_EQ(again.root().number("x", 0, 0, 1), 0.1);
    EXPECT_EQ(again.root().table("bend").number("stiffness", 0, 0, 1), 1e-7);
    EXPECT_EQ(again.root().table("bend").text("form", ""), "a \"b\"");
    EXPECT_EQ(again.root().tables("solid")[0].numbers("half", {0, 0, 0}, 0, 9)[1], 2.5);
}

TEST(Config, broken_files_are_errors_with_their_name_and_line) {
    const Scratch scratch;
    expect_error<Misuse>([&] { Config::load(scratch.path("none.toml")); }, {"none.toml"});
    expect_error<Misuse>([&] { Config::load(scratch.path()); }, {scratch.path(), "folder"});
    expect_error<Misuse>([&] { Config::load(scratch.file("cut.toml", "a = 1\nb = [1, 2")); }, {"cut.toml:2"});
    expect_error<Misuse>([&] { Config::load(scratch.file("twice.toml", "a = 1\na = 2\n")); },
                         {"twice.toml:2"});
    expect_error<Misuse>(
        [&] { Config::load(scratch.file("foreign.toml", std::string("\x89HDF\r\n\x1a\n\0\0", 10))); },
        {"foreign.toml:1", "HDF5", "a scene (TOML)"});
    EXPECT_NO_THROW(Config::load(scratch.file("empty.toml", "")));  // every default: the built-in groom
}

TEST(Config, knows_the_files_that_it_was_read_from) {
    Scratch scratch;
    const std::string below = scratch.file("below.toml", "[motion]\nfile = \"walk.csv\"\n"),
                      file = scratch.file("scene.toml", "include = \"below.toml\"\n");
    Config config = Config::load(file);
    config.root().table("motion").path("file");
    EXPECT_EQ(config.files(), (std::vector<std::string>{below, file, scratch.path("walk.csv")}));
}

TEST(Config, a_value_of_an_option_is_named_by_the_option) {
    Config config = scene("");
    config.set("seed=-1", "--seed");
    config.set("frames=0");
    expect_error<Misuse>([&] { config.root().integer("seed", 1, 0, 9); },
                         {"--seed: found -1, allowed 0 to 9"});
    expect_error<Misuse>([&] { config.root().integer("frames", 1, 1, 9); }, {"--set frames: found 0"});
}

struct Spring {
    double stiffness, damping;
};
constexpr Parameter<Spring> rows[] = {{"stiffness", &Spring::stiffness, "N/m", 5, 0, 100, "Eq 1, k_s"},
                                      {"damping", &Spring::damping, "N s/m", 0.5, 0, unbounded, "Eq 1, c_s"}};

TEST(Parameters, rows_fill_their_members_from_the_table_or_with_defaults) {
    Config config = scene("[stretch]\nstiffness = 7\n");
    Spring spring{};
    read_parameters(spring, rows, config.root().table("stretch"));
    EXPECT_EQ(spring.stiffness, 7);
    EXPECT_EQ(spring.damping, 0.5);
    Config bad = scene("[stretch]\n\nstiffness = 101\n");
    expect_error<Misuse>([&] { read_parameters(spring, rows, bad.root().table("stretch")); },
                         {"scene.toml:3", "stretch.stiffness", "101", "0 to 100"});
}

TEST(DidYouMean, proposes_near_names_only) {
    EXPECT_EQ(did_you_mean("radios", {"radius", "length"}), ", did you mean 'radius'?");
    EXPECT_EQ(did_you_mean("temperature", {"radius", "length"}), "");
    EXPECT_EQ(did_you_mean("x", {}), "");
}

}  // namespace
}  // namespace wetcurl

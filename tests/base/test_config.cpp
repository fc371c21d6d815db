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

// Values read by a row of that kind.
double number(const Table& t, const char* key, double fallback, double minimum, double maximum) {
    return t.number(KeyRow::number(key, "1", fallback, minimum, maximum, ""));
}
long integer(const Table& t, const char* key, long fallback, long minimum, long maximum) {
    return t.integer(KeyRow::integer(key, double(fallback), double(minimum), double(maximum), ""));
}
bool boolean(const Table& t, const char* key, bool fallback) {
    return t.boolean(KeyRow::boolean(key, fallback, ""));
}
std::string text(const Table& t, const char* key, const char* fallback) {
    return t.text(KeyRow::text(key, fallback, ""));
}
std::string choice(const Table& t, const char* key, const char* fallback,
                   const std::vector<const char*>& words) {
    return t.text(KeyRow::one_of(key, words, fallback, ""));
}
std::string path(const Table& t, const char* key) { return t.text(KeyRow::path(key, "none", "")); }
template <size_t n>
std::vector<double> numbers(const Table& t, const char* key, const double (&fallback)[n], double minimum,
                            double maximum) {
    return t.numbers(KeyRow::numbers(key, "1", fallback, minimum, maximum, ""));
}

TEST(Config, getters_return_what_is_written) {
    const Config c = [] {
        return scene(
            "frames = 48\nwet = true\ntitle = \"curl\"\ng = [0, -9.81, 0.5]\n[bend]\nform = "
            "\"printed\"\nstiffness = 1e-3\n");
    }();
    Config config = c;
    Table root = config.root(), bend = root.table("bend");
    EXPECT_EQ(integer(root, "frames", 1, 1, 1000), 48);
    EXPECT_TRUE(boolean(root, "wet", false));
    EXPECT_EQ(text(root, "title", ""), "curl");
    EXPECT_EQ(numbers(root, "g", {0, 0, 0}, -inf, inf), (std::vector<double>{0, -9.81, 0.5}));
    EXPECT_TRUE(bend.present());
    EXPECT_EQ(choice(bend, "form", "variational", {"variational", "printed"}), "printed");
    EXPECT_EQ(number(bend, "stiffness", 1, 0, inf), 1e-3);
    EXPECT_NO_THROW(config.require_all_used());
}

TEST(Config, absent_keys_give_their_default_and_absent_tables_are_not_there) {
    Config config = scene("frames = 3\n");
    Table root = config.root(), air = root.table("air");
    EXPECT_FALSE(air.present());
    EXPECT_FALSE(root.has("wet"));
    EXPECT_TRUE(root.has("frames"));
    EXPECT_EQ(number(air, "drag", 0.25, 0, 1), 0.25);
    EXPECT_EQ(numbers(air, "grid", {64, 64}, 1, 512), (std::vector<double>{64, 64}));
    EXPECT_EQ(choice(air, "form", "a", {"a", "b"}), "a");
    EXPECT_EQ(path(root, "file"), "");
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
    EXPECT_EQ(text(solids[0], "shape", ""), "sphere");
    EXPECT_EQ(text(solids[1], "shape", ""), "box");
    expect_error<Misuse>([&] { number(solids[1], "radius", 1, 0, inf); },
                         {"scene.toml:5", "solid[1].radius", "-1", "0"});
}

TEST(Config, paths_start_at_the_folder_of_the_file) {
    const Scratch scratch;
    std::filesystem::create_directory(scratch.path("heads"));
    Config config = Config::load(scratch.file("s.toml", "file = \"heads/../head.obj\"\n"));
    EXPECT_EQ(path(config.root(), "file"), scratch.path("head.obj"));
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
         [](Table t) { number(t, "x", 0, 0, 1); },
         {"scene.toml:2", "x", "abc", "string", "number"}},
        {"x = 1.5", [](Table t) { number(t, "x", 0, 0, 1); }, {"scene.toml:1", "1.5", "0 to 1"}},
        {"x = -0.1", [](Table t) { number(t, "x", 0, 0, 1); }, {"-0.1", "0 to 1"}},
        {"x = nan", [](Table t) { number(t, "x", 0, -inf, inf); }, {"scene.toml:1", "nan"}},
        {"x = inf", [](Table t) { number(t, "x", 0, -inf, inf); }, {"scene.toml:1", "inf"}},
        {"x = 2.5", [](Table t) { integer(t, "x", 0, 0, 9); }, {"2.5", "whole"}},
        {"x = 10", [](Table t) { integer(t, "x", 0, 0, 9); }, {"10", "0 to 9"}},
        {"x = 1", [](Table t) { boolean(t, "x", false); }, {"1", "true or false"}},
        {"x = 1", [](Table t) { text(t, "x", ""); }, {"1", "string"}},
        {"x = \"varational\"",
         [](Table t) {
             choice(t, "x", "variational", {"variational", "printed"});
         },
         {"'varational'", "variational, printed", "did you mean 'variational'"}},
        {"x = [1, 2]",
         [](Table t) {
             numbers(t, "x", {0, 0, 0}, 0, 9);
         },
         {"3 numbers"}},
        {"x = [1, 2, \"c\"]",
         [](Table t) {
             numbers(t, "x", {0, 0, 0}, 0, 9);
         },
         {"scene.toml:1", "c", "numbers"}},
        {"x = [1, 2, 30]",
         [](Table t) {
             numbers(t, "x", {0, 0, 0}, 0, 9);
         },
         {"30", "0 to 9"}},
        {"x = 5",
         [](Table t) {
             numbers(t, "x", {0, 0, 0}, 0, 9);
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
        {"[x]", [](Table t) { number(t, "x", 0, 0, 1); }, {"a table", "number"}},
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
    integer(root, "frames", 1, 1, 9);
    number(root.table("bend"), "stiffness", 1, 0, 9);
    number(root, "stiffnesses", 1, 0, 9);  // of another table: must not be proposed
    expect_error<Misuse>([&] { config.require_all_used(); },
                         {"scene.toml:3", "'bend.stiffnes'", "did you mean 'stiffness'"});
}

TEST(Config, a_value_of_an_included_file_is_blamed_on_that_file) {
    Scratch scratch;
    scratch.file("below.toml", "\n[groom]\n\nlength = 3\nwdith = 1\n[[solid]]\n[[solid]]\nradius = 5\n");
    Config config =
        Config::load(scratch.file("above.toml", "include = \"below.toml\"\n[groom]\npitch = 9\n"));
    Table groom = config.root().table("groom");
    expect_error<Misuse>([&] { number(groom, "length", 1, 0, 2); }, {"below.toml:4: groom.length"});
    expect_error<Misuse>([&] { number(groom, "pitch", 1, 0, 2); }, {"above.toml:3: groom.pitch"});
    expect_error<Misuse>([&] { number(config.root().tables("solid").at(1), "radius", 1, 0, 2); },
                         {"below.toml:8: solid[1].radius"});
    expect_error<Misuse>([&] { config.require_all_used(); }, {"below.toml:5: ", "'groom.wdith'"});
    // A table that --set gives whole has no line of the file.
    config.set("groom={length = 7}");
    expect_error<Misuse>([&] { number(config.root().table("groom"), "length", 1, 0, 2); },
                         {"--set groom: groom.length: found 7"});
}

TEST(Config, backslashes_of_a_path_are_named_as_what_they_are) {
    auto path_in = [](const std::string& text) { return path(scene(text).root(), "file"); };
    const std::string printed = "found 'in\\base.data', which has control characters";  // no backspace in it
    expect_error<Misuse>([&] { path_in("\nfile = \"in\\base.data\"\n"); },
                         {"scene.toml:2: file", printed, "escape", "write /"});
    expect_error<Misuse>([&] { path_in("file = \"in\\data\"\n"); }, {"scene.toml:1", "escape", "write /"});
    expect_error<Misuse>([&] { path_in("file = 'in\\data'\n"); }, {"scene.toml:1", "write 'in/data'"});
    expect_error<Misuse>([&] { scene("include = \"in\\base.toml\"\n"); },
                         {"scene.toml:1: include", "in\\base"});
    EXPECT_TRUE(path_in("file = \"in/data\"\n").ends_with("/in/data"));
}

TEST(Config, what_replaces_is_blamed_on_its_own_text_and_a_copy_is_its_own) {
    Config config = scene("[groom]\nlength = 1\n[[solid]]\nradius = 1\n");
    Config other = config.copy();
    other.replace("\n[groom]\npitch = 9\n[[solid]]\nradius = 8\n", "recipe.toml:7: text");
    other.set("fps=9", "recipe.toml:9: draw.fps");
    expect_error<Misuse>([&] { number(other.root().table("groom"), "pitch", 1, 0, 2); },
                         {"recipe.toml:7: text:3: groom.pitch"});
    expect_error<Misuse>([&] { number(other.root().tables("solid").at(1), "radius", 1, 0, 2); },
                         {"recipe.toml:7: text:5: solid[1].radius"});
    expect_error<Misuse>([&] { number(other.root(), "fps", 1, 0, 2); }, {"recipe.toml:9: draw.fps: found 9"});
    EXPECT_EQ(number(config.root().table("groom"), "length", 0, 0, 2), 1);
    EXPECT_EQ(config.root().tables("solid").size(), 1u);
    EXPECT_FALSE(config.root().has("fps"));
}

TEST(Config, an_unknown_table_and_a_key_unknown_in_an_array_of_tables_are_errors) {
    Config tables = scene("[wetnes]\nlevel = 1\n");
    tables.root().table("wetness");
    expect_error<Misuse>([&] { tables.require_all_used(); },
                         {"scene.toml:1", "'wetnes'", "did you mean 'wetness'"});
    Config arrays = scene("[[solid]]\nshape = \"box\"\nhafl = 1\n");
    for (const Table& t : arrays.root().tables("solid")) text(t, "shape", ""), number(t, "half", 1, 0, 1);
    expect_error<Misuse>([&] { arrays.require_all_used(); }, {"scene.toml:3", "hafl", "did you mean 'half'"});
}

TEST(Config, assignments_are_typed_win_and_are_named_in_errors) {
    Config config = scene("[bend]\nstiffness = 3\n");
    config.set("bend.stiffness=0.5");
    config.set("bend.form=printed");
    config.set("head.radius=-1");
    config.set("grid=[4, 8]");
    Table root = config.root();
    EXPECT_EQ(number(root.table("bend"), "stiffness", 1, 0, 9), 0.5);
    EXPECT_EQ(text(root.table("bend"), "form", ""), "printed");
    EXPECT_EQ(numbers(root, "grid", {0, 0}, 0, 9), (std::vector<double>{4, 8}));
    expect_error<Misuse>([&] { number(root.table("head"), "radius", 1, 0, 9); },
                         {"--set", "head.radius", "-1"});
}

TEST(Config, assignments_reach_names_that_hold_dots) {
    Config config = scene("[draw]\n\"groom.length\" = [0.1, 0.2]\n");
    config.set("draw.\"groom.length\"=[0.3, 0.4]");
    EXPECT_EQ(numbers(config.root().table("draw"), "groom.length", {0, 0}, 0, 9),
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
    number(config.root().table("bend"), "stiffness", 1, 0, 9);
    expect_error<Misuse>([&] { config.require_all_used(); },
                         {"--set", "stifness", "did you mean 'stiffness'"});
}

TEST(Config, includes_merge_below_the_file_that_names_them) {
    const Scratch scratch;
    scratch.file("head.toml", "fps = 30\n[head]\nradius = 0.1\nspin = 2\n");
    Config config =
        Config::load(scratch.file("wet.toml", "include = \"head.toml\"\nframes = 2\n[head]\nradius = 0.2\n"));
    Table head = config.root().table("head");
    EXPECT_EQ(number(head, "radius", 0, 0, 1), 0.2);
    EXPECT_EQ(number(head, "spin", 0, 0, 9), 2);
    EXPECT_EQ(number(config.root(), "fps", 24, 1, 100), 30);
    EXPECT_EQ(integer(config.root(), "frames", 1, 1, 9), 2);
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
    const std::string whole = config.text();
    Config again = Config::parse(whole, "again.toml");
    EXPECT_EQ(again.text(), whole);
    EXPECT_EQ(number(again.root(), "x", 0, 0, 1), 0.1);
    EXPECT_EQ(number(again.root().table("bend"), "stiffness", 0, 0, 1), 1e-7);
    EXPECT_EQ(text(again.root().table("bend"), "form", ""), "a \"b\"");
    EXPECT_EQ(numbers(again.root().tables("solid")[0], "half", {0, 0, 0}, 0, 9)[1], 2.5);
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
    path(config.root().table("motion"), "file");
    EXPECT_EQ(config.files(), (std::vector<std::string>{below, file, scratch.path("walk.csv")}));
}

TEST(Config, a_value_of_an_option_is_named_by_the_option) {
    Config config = scene("");
    config.set("seed=-1", "--seed");
    config.set("frames=0");
    expect_error<Misuse>([&] { integer(config.root(), "seed", 1, 0, 9); },
                         {"--seed: found -1, allowed 0 to 9"});
    expect_error<Misuse>([&] { integer(config.root(), "frames", 1, 1, 9); }, {"--set frames: found 0"});
}

// A whole number in a vector, and rows that are read only where another key says so.
TEST(Config, rows_of_vectors_hold_whole_numbers_where_they_say_so) {
    const KeyRow row = KeyRow::integers("grid", {32, 32}, 1, 64, "");
    auto read = [&](const std::string& text) { return scene(text).root().numbers(row); };
    EXPECT_EQ(read(""), (std::vector<double>{32, 32}));
    EXPECT_EQ(read("grid = [4, 8]"), (std::vector<double>{4, 8}));
    expect_error<Misuse>([&] { read("\ngrid = [4, 4.5]"); },
                         {"scene.toml:2: grid: found 4.5", "whole numbers from 1 to 64"});
    expect_error<Misuse>([&] { read("grid = [4, 65]"); }, {"found 65, allowed whole numbers from 1 to 64"});
    expect_error<Misuse>([&] { read("grid = [4]"); }, {"2 numbers in brackets"});
}

TEST(Config, a_row_of_another_kind_is_an_error_of_the_program) {
    const Table t = scene("x = 1").root();
    EXPECT_THROW(t.number(KeyRow::integer("x", 0, 0, 9, "")), std::logic_error);
    EXPECT_THROW(t.integer(KeyRow::number("x", "1", 0, 0, 9, "")), std::logic_error);
    EXPECT_THROW(t.boolean(KeyRow::text("x", "", "")), std::logic_error);
    EXPECT_THROW(t.text(KeyRow::boolean("x", false, "")), std::logic_error);
    EXPECT_THROW(t.numbers(KeyRow::number("x", "1", 0, 0, 9, "")), std::logic_error);
}

TEST(Config, reading_what_no_row_lists_is_an_error_of_the_program) {
    const std::vector<TableRow> tables = {
        {.name = "", .meaning = "", .rows = {KeyRow::integer("frames", 1, 1, 9, "")}},
        {.name = "solid", .meaning = "", .repeats = true, .rows = {KeyRow::text("name", "", "")}},
    };
    Config config = scene("frames = 2\n[[solid]]\nname = \"a\"\nsize = 1\n[bend]\n");
    config.expect(tables);
    const Table root = config.root();
    EXPECT_EQ(integer(root, "frames", 1, 1, 9), 2);
    EXPECT_EQ(text(root.tables("solid")[0], "name", ""), "a");
    EXPECT_THROW(number(root, "fps", 1, 1, 9), std::logic_error);
    EXPECT_THROW(number(root.tables("solid")[0], "size", 1, 1, 9), std::logic_error);
    EXPECT_THROW(root.table("bend"), std::logic_error);
}

// Where a row is read, and what is said where it is not.
TEST(Config, conditions_of_rows_hold_by_the_keys_that_are_written) {
    auto holds = [](const std::string& text, const When& when) { return scene(text).root().holds(when); };
    EXPECT_TRUE(holds("", {}));
    EXPECT_FALSE(holds("", {"file|scalp"}));
    EXPECT_TRUE(holds("scalp = \"a\"", {"file|scalp"}));
    EXPECT_TRUE(holds("shape = \"box\"", {"shape", "sphere|box"}));
    EXPECT_FALSE(holds("shape = \"bo\"", {"shape", "sphere|box"}));
    EXPECT_FALSE(holds("shape = 3", {"shape", "sphere|box"}));
    EXPECT_FALSE(holds("", {"shape", "sphere"}));
    EXPECT_TRUE(holds("", {"shape", "sphere", true}));
    EXPECT_FALSE(holds("shape = \"box\"", {"shape", "sphere", true}));
    EXPECT_EQ((When{"shape", "sphere|box"}.text()), "with shape = sphere or box");
    EXPECT_EQ((When{"file|scalp"}.text()), "with file or scalp");
    EXPECT_EQ(When{}.text(), "");
    const std::vector<TableRow> tables = {
        {.name = "solid",
         .meaning = "",
         .repeats = true,
         .rows = {KeyRow::number("half", "m", 1, 0, 9, "", "", {"shape", "box"})}}};
    Config config = scene("[[solid]]\nhalf = 1\n");
    config.expect(tables);
    config.root().tables("solid");
    expect_error<Misuse>([&] { config.require_all_used(); },
                         {"scene.toml:2: solid[0].half: unused key", "(read with shape = box)"});
}

struct Spring {
    double stiffness, damping;
    std::optional<double> pitch;
    std::string name = "unnamed";
    int passes;
    bool printed, two_way;
    Vec3d wind;
    static constexpr const char* forms[] = {"variational", "printed"};
    static constexpr Parameter<Spring> parameters[] = {
        {KeyRow::number("stiffness", "N/m", 5, 0, 100, "Force.", "Eq 1, k_s"), &Spring::stiffness},
        {KeyRow::number("damping", "N s/m", 0.5, 0, unbounded, "Damping."), &Spring::damping},
        {KeyRow::number("pitch", "m", 0, 0, 1, "Pitch.").without_default("none"), &Spring::pitch},
        {KeyRow::text("name", "", "Name.").without_default("its number"), &Spring::name},
        {KeyRow::integer("passes", 10, 1, 99, "Passes."), &Spring::passes},
        {KeyRow::one_of("form", forms, "variational", "Form."), &Spring::printed},
        {KeyRow::boolean("two_way", true, "Both ways."), &Spring::two_way},
        {KeyRow::numbers("wind", "m/s", {1, 2, 3}, -9, 9, "Wind."), &Spring::wind},
    };
};

TEST(Parameters, rows_fill_their_members_from_the_table_or_with_defaults) {
    Config config = scene("[stretch]\nstiffness = 7\n");
    Spring spring{};
    read_parameters(spring, Spring::parameters, config.root().table("stretch"));
    EXPECT_EQ(spring.stiffness, 7);
    EXPECT_EQ(spring.damping, 0.5);
    EXPECT_FALSE(spring.pitch);
    EXPECT_EQ(spring.name, "unnamed");
    EXPECT_EQ(spring.passes, 10);
    EXPECT_FALSE(spring.printed);
    EXPECT_TRUE(spring.two_way);
    EXPECT_EQ(spring.wind.y, 2);
    Config all = scene(
        "pitch = 0.5\nname = \"a\"\npasses = 3\nform = \"printed\"\ntwo_way = false\nwind = [4, 5, 6]\n");
    read_parameters(spring, Spring::parameters, all.root());
    EXPECT_EQ(spring.pitch, 0.5);
    EXPECT_EQ(spring.name, "a");
    EXPECT_EQ(spring.passes, 3);
    EXPECT_TRUE(spring.printed);
    EXPECT_FALSE(spring.two_way);
    EXPECT_EQ(spring.wind.z, 6);
    Config bad = scene("[stretch]\n\nstiffness = 101\n");
    expect_error<Misuse>([&] { read_parameters(spring, Spring::parameters, bad.root().table("stretch")); },
                         {"scene.toml:3", "stretch.stiffness", "101", "0 to 100"});
}

TEST(DidYouMean, proposes_near_names_only) {
    EXPECT_EQ(did_you_mean("radios", {"radius", "length"}), ", did you mean 'radius'?");
    EXPECT_EQ(did_you_mean("temperature", {"radius", "length"}), "");
    EXPECT_EQ(did_you_mean("x", {}), "");
}

}  // namespace
}  // namespace wetcurl

// `wetcurl report`: rows and how they are judged, what is refused, what the page and its JSON hold.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "app/commands/infer.h"
#include "app/commands/report.h"
#include "app/commands/simulate.h"
#include "app/measures/comparison.h"
#include "app/report/markup.h"
#include "app/report/report_charts.h"
#include "app/report/report_page.h"
#include "app/report/report_player.h"
#include "app/report/report_rows.h"
#include "base/output_file.h"
#include "tests/base/scratch.h"

namespace wetcurl {
namespace {

namespace fs = std::filesystem;
using testing::bytes_of;
using testing::expect_error;
using testing::Scratch;

// What compare writes of one run.
Json entry(const std::string& kind, double mm, double seconds, const std::string& method = "") {
    Comparison c;
    c.kind = kind, c.method = method.empty() ? kind + " hair" : method;
    c.frames = 2;
    c.position_mm = {mm, 2 * mm, 3 * mm};
    c.mm_per_frame = {mm, 2 * mm};
    c.seconds_per_frame = seconds, c.seconds_per_frame_reference = 0.04;
    c.clumps = 30, c.clumps_reference = 20;
    return json_of(c);
}

const Row& row_named(const Rows& rows, const std::string& name) {
    for (const Row& row : rows.all)
        if (row.name == name) return row;
    throw Error("no row " + name);
}

// Text holds `part`, once at least.
void expect_in(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in it";
}
void expect_not_in(const std::string& text, const std::string& part) {
    EXPECT_EQ(text.find(part), std::string::npos) << "'" << part << "' is in it";
}

// ---------------------------------------------------------------- rows

TEST(ReportRows, are_means_over_scenes_and_name_the_worst) {
    Json b = entry("learned", 5, 0.3);
    b["jitter_mm"] = 0.5;  // the other scene's head never stands still
    b["position_mm_per_frame"] = {7, 8, 9};
    const Rows rows = rows_of({{"net", {{"a", entry("learned", 2, 0.1)}, {"b", b}}}});
    const Row& row = row_named(rows, "net");
    EXPECT_DOUBLE_EQ(row.mm(), 3.5);
    EXPECT_DOUBLE_EQ(row.means["position_mm"]["max"].get<double>(), 10.5);
    EXPECT_DOUBLE_EQ(row.seconds(), 0.2);
    EXPECT_EQ(row.scenes, (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(row.worst_scene, "b");
    EXPECT_EQ(row.worst_mm, 5);
    EXPECT_EQ(row.means["jitter_mm"], 0.5);
    EXPECT_TRUE(row.means["jitter_reference_mm"].is_null());
    EXPECT_EQ(row.means["position_mm_per_frame"], (Json{4.5, 6.0}));  // up to the shortest
    EXPECT_FALSE(row.means.contains("file"));
}

TEST(ReportRows, of_seeds_are_their_median_and_range) {
    Entries entries;
    const double mm[3] = {4.4, 4.1, 4.2};
    for (int k : {0, 1, 2})
        for (const char* scene : {"a", "b"})
            entries["net@" + std::to_string(k + 1)][scene] = entry("learned", mm[k], 0.1 * (k + 1));
    entries["quad"] = {{"a", entry("interpolated", 9, 0.01)}, {"b", entry("interpolated", 9, 0.01)}};
    const Rows rows = rows_of(entries);
    ASSERT_EQ(rows.all.size(), 2u);
    const Row& net = row_named(rows, "net");
    EXPECT_DOUBLE_EQ(net.mm(), 4.2);
    EXPECT_DOUBLE_EQ(net.seconds(), 0.3);  // all numbers are the median's
    ASSERT_TRUE(net.seeds);
    EXPECT_EQ(net.seeds->median, "3");
    EXPECT_EQ(net.seeds->names, (std::vector<std::string>{"1", "2", "3"}));
    EXPECT_DOUBLE_EQ(net.seeds->least_mm, 4.1);
    EXPECT_DOUBLE_EQ(net.seeds->most_mm, 4.4);
    EXPECT_FALSE(row_named(rows, "quad").seeds);

    entries.erase("net@3");  // of two, the worse
    EXPECT_DOUBLE_EQ(row_named(rows_of(entries), "net").mm(), 4.4);
    entries["net@2"].erase("b");
    EXPECT_EQ(row_named(rows_of(entries), "net").lacks, std::vector<std::string>{"b"});
    entries["net"] = entries["quad"];
    expect_error([&] { rows_of(entries); }, {"net and net@1", "found both"});
    // What follows @ is a number, or part of the name.
    EXPECT_EQ(rows_of({{"a@b", {{"s", entry("learned", 1, 1)}}}}).all[0].name, "a@b");
}

TEST(ReportRows, of_other_scenes_are_said_and_not_judged) {
    const auto both = [](double mm, double s) {
        return std::map<std::string, Json>{{"a", entry("interpolated", mm, s)},
                                           {"b", entry("interpolated", mm, s)}};
    };
    const Rows rows =
        rows_of({{"one", both(5, 0.1)},
                 {"two", both(6, 0.05)},
                 {"easy", {{"a", entry("learned", 1, 0.01)}, {"c", entry("learned", 1, 0.01)}}}});
    const Row& easy = row_named(rows, "easy");
    EXPECT_EQ(easy.lacks, std::vector<std::string>{"b"});
    EXPECT_EQ(easy.adds, std::vector<std::string>{"c"});
    EXPECT_FALSE(easy.on_front);
    EXPECT_FALSE(easy.wins);
    expect_in(easy.verdict, "not judged");
    EXPECT_EQ(rows.front, (std::vector<std::string>{"two", "one"}));
    EXPECT_EQ(rows.hypervolume, rows.hypervolume_not_learned);
    EXPECT_EQ(rows.best(true), nullptr);
}

TEST(ReportRows, win_over_the_best_without_a_network_that_takes_no_more_time) {
    const auto of = [](double rest_mm, double rest_seconds) {
        return rows_of({{"net", {{"s", entry("learned", 4, 0.1)}}},
                        {"other_net", {{"s", entry("learned", 1, 0.09)}}},  // a network is no rival
                        {"quad", {{"s", entry("interpolated", 9, 0.01)}}},
                        {"rest", {{"s", entry("interpolated", rest_mm, rest_seconds)}}}});
    };
    Rows rows = of(5, 0.1);
    EXPECT_EQ(row_named(rows, "net").wins, true);
    expect_in(row_named(rows, "net").verdict, "wins over rest");
    expect_in(row_named(rows, "net").verdict, "no faster than the reference");  // 0.1 s to its 0.04
    EXPECT_FALSE(row_named(rows, "rest").wins);
    rows = of(3, 0.1);
    EXPECT_EQ(row_named(rows, "net").wins, false);
    expect_in(row_named(rows, "net").verdict, "does not win over rest");
    EXPECT_EQ(row_named(of(4, 0.1), "net").wins, false);  // as near is no win
    EXPECT_EQ(row_named(of(3, 0.11), "net").wins, true);  // slower is no rival
    const Rows alone =
        rows_of({{"net", {{"s", entry("learned", 4, 0.01)}}}, {"sim", {{"s", entry("simulated", 1, 0.1)}}}});
    EXPECT_FALSE(row_named(alone, "net").wins);
    expect_in(row_named(alone, "net").verdict, "no row without a network");
}

TEST(ReportRows, have_a_front_and_its_area) {
    const Rows rows = rows_of({{"quad", {{"s", entry("interpolated", 10, 0.01)}}},
                               {"bad", {{"s", entry("interpolated", 20, 0.02)}}},
                               {"net", {{"s", entry("learned", 1, 0.1)}}}});
    EXPECT_EQ(rows.front, (std::vector<std::string>{"quad", "net"}));
    EXPECT_TRUE(row_named(rows, "net").on_front);
    EXPECT_FALSE(row_named(rows, "bad").on_front);
    EXPECT_NEAR(rows.hypervolume, 3, 1e-12);  // 2 x 1 and 1 x 1 decades
    EXPECT_NEAR(rows.hypervolume_not_learned, 2, 1e-12);
    EXPECT_EQ(rows.seconds_reference, 0.04);
}

// ---------------------------------------------------------------- tables of files

class Table : public ::testing::Test {
  protected:
    void put(const std::string& row, const std::string& scene, const std::string& text) {
        fs::create_directories(scratch.path("table/" + row));
        scratch.file("table/" + row + "/" + scene + ".json", text);
    }
    void put(const std::string& row, const std::string& scene, const Json& one) {
        put(row, scene, Json{{"reference", "wet.h5"}, {"others", {one}}}.dump());
    }
    Entries read() { return read_table(scratch.path("table")); }
    Scratch scratch;
};

TEST_F(Table, is_read_by_row_and_scene) {
    put("net", "001", entry("learned", 2, 0.1));
    put("net", "002", entry("learned", 3, 0.1));
    put("quad", "001", entry("interpolated", 9, 0.1));
    Json newer = entry("interpolated", 9, 0.1);
    newer["of_tomorrow"] = 1;
    put("quad", "002", newer);
    scratch.file("table/net/notes.txt", "");
    std::vector<std::string> files;
    const Entries entries = read_table(scratch.path("table"), &files);
    EXPECT_EQ(files.size(), 4u);
    ASSERT_EQ(entries.size(), 2u);
    EXPECT_EQ(entries.at("net").at("002")["position_mm"]["mean"], 3);
    EXPECT_EQ(rows_of(entries).all.size(), 2u);
}

TEST_F(Table, malformed_says_file_what_was_found_and_what_is_needed) {
    expect_error([&] { read(); }, {"table: found nothing", "ROW/SCENE.json"});
    fs::create_directories(scratch.path("table"));
    expect_error([&] { read(); }, {"no folder in it", "ROW/SCENE.json"});
    fs::create_directories(scratch.path("table/net"));
    expect_error([&] { read(); }, {"table/net", "no .json"});
    put("net", "a", std::string("{\"others\": [{\"file\""));
    expect_error([&] { read(); }, {"net/a.json", "no JSON"});
    put("net", "a", std::string("[1]"));
    expect_error([&] { read(); }, {"net/a.json: others", "found nothing", "list of one run"});
    const Json good = entry("learned", 2, 0.1);
    put("net", "a", Json{{"others", {good, good}}}.dump());
    expect_error([&] { read(); }, {"net/a.json: others", "2 runs", "list of one run"});

    Json bad = good;
    bad.erase("kind");
    put("net", "a", bad);
    expect_error([&] { read(); }, {"net/a.json", "kind", "found nothing", "compare again"});
    bad["kind"] = "guessed";
    put("net", "a", bad);
    expect_error([&] { read(); }, {"kind", "'guessed'", "simulated, interpolated or learned"});
    bad = good;
    bad["position_mm"].erase("p95");
    put("net", "a", bad);
    expect_error([&] { read(); }, {"others[0].position_mm.p95", "found nothing", "a number is needed"});
    bad = good;
    bad["f1_2mm_20deg"] = "much";
    put("net", "a", bad);
    expect_error([&] { read(); }, {"others[0].f1_2mm_20deg", "found \"much\"", "a number"});
    bad = good;
    bad["position_mm_per_frame"] = {1, nullptr};
    put("net", "a", bad);
    expect_error([&] { read(); }, {"position_mm_per_frame", "a list of numbers"});
    bad = good;
    bad.erase("jitter_mm");
    put("net", "a", bad);
    expect_error([&] { read(); }, {"jitter_mm", "found nothing", "a number or null"});

    put("net", "a", good);
    EXPECT_NO_THROW(read());
    fs::create_symlink(scratch.path("absent"), scratch.path("table/net/b.json"));
    expect_error([&] { read(); }, {"net/b.json", "cannot be read"});
    fs::remove(scratch.path("table/net/b.json"));
    scratch.file("table/stray.json", "{}");
    expect_error([&] { read(); }, {"stray.json", "ROW/SCENE.json"});
}

TEST_F(Table, of_two_methods_in_one_row_is_an_error) {
    put("net", "a", entry("learned", 2, 0.1, "strand_mlp"));
    put("net", "b", entry("learned", 2, 0.1, "unet_vgg19, paper"));
    expect_error([&] { rows_of(read()); }, {"row net, scene b", "unet_vgg19", "strand_mlp", "scene a"});
}

// ---------------------------------------------------------------- the player

// Bytes of base64.
std::vector<uint8_t> bytes_of_base64(const std::string& text) {
    const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::vector<uint8_t> out;
    uint32_t word = 0;
    int bits = 0;
    for (char c : text) {
        if (c == '=') break;
        word = word << 6 | uint32_t(letters.find(c)), bits += 6;
        if (bits >= 8) out.push_back(uint8_t(word >> (bits -= 8)));
    }
    return out;
}

TEST(ReportPlayer, base64_is_that_of_rfc_4648) {
    const auto of = [](const std::string& text) { return base64({text.begin(), text.end()}); };
    EXPECT_EQ(of(""), "");
    EXPECT_EQ(of("f"), "Zg==");
    EXPECT_EQ(of("fo"), "Zm8=");
    EXPECT_EQ(of("foobar"), "Zm9vYmFy");
    EXPECT_EQ(base64({0xff, 0xfe, 0xfd}), "//79");
}

TEST(ReportPlayer, keeps_all_that_fits_and_fits_what_it_keeps) {
    EXPECT_EQ(kept_of(2, 12, 256, 64), (Kept{256, 64, 1, 12}));
    for (const auto& [runs, frames, strands, particles] :
         {std::array{3, 96, 1024, 64}, {2, 2000, 100, 20}, {7, 96, 100000, 100}, {2, 5, 3, 20000}}) {
        const Kept kept = kept_of(runs, frames, strands, particles);
        EXPECT_LE(6l * runs * kept.frames * kept.strands * kept.particles, 14000000) << frames;
        EXPECT_GE(6l * runs * kept.frames * kept.strands * kept.particles, 500000) << frames;
        EXPECT_LE((kept.frames - 1) * kept.frame_step, frames - 1);
        EXPECT_GT(kept.frames * kept.frame_step, frames - 1);
        EXPECT_GE(kept.particles, 2);
    }
}

TEST(ReportPlayer, strands_that_are_kept_are_spread_and_of_no_grid) {
    const auto kept = strands_kept(1024, 256);
    ASSERT_EQ(kept.size(), 256u);
    EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
    int even = 0, largest = 0;
    for (size_t k = 0; k < kept.size(); ++k) {
        even += kept[k] % 2 == 0;
        if (k) largest = std::max(largest, kept[k] - kept[k - 1]);
    }
    EXPECT_NEAR(even, 128, 8);  // those of the low-resolution run and the others alike
    EXPECT_LE(largest, 8);
    EXPECT_EQ(strands_kept(5, 9).size(), 5u);
}

TEST(ReportPlayer, expected_errors_come_with_the_run_that_tells_them) {
    const Scratch scratch;
    RunHeader header;
    header.scene = "[groom]\ngrid = [3, 1]\nparticles = 4\n", header.scene_folder = ".";
    header.groom.rest = Strands(3, 4);
    for (int s = 0; s < 3; ++s)
        for (int i = 0; i < 4; ++i) header.groom.rest.at(s, i) = {0.01f * float(s), -0.01f * float(i), 0};
    header.groom.normal.assign(3, {0, 1, 0});
    header.groom.grid = {3, 1, {0, 1, 2}};
    std::vector<std::string> paths;
    for (const bool tells : {false, true}) {
        paths.push_back(scratch.path(tells ? "tells.h5" : "plain.h5"));
        RunWriter writer(paths.back(), header, true);
        for (int f = 0; f < 2; ++f) {
            RunFrame frame;
            frame.positions = header.groom.rest;
            // Of two halves of a strand, in millimetres: 0 1, 2 3, 4 5, and one more in the second frame.
            for (int k = 0; tells && k < 6; ++k) frame.expected_error.push_back(1e-3f * float(k + f));
            writer.append(frame);
        }
        writer.commit();
    }
    const Json player = player_of(paths, {"plain", "tells"}, 0, 5);
    EXPECT_TRUE(player["runs"][0]["expected"].is_null());
    const auto bytes = bytes_of_base64(player["runs"][1]["expected"].get<std::string>());
    ASSERT_EQ(bytes.size(), 2u * 3 * 4);
    for (int k = 0; k < 24; ++k) {
        const int f = k / 12, half = k % 12 / 4 * 2 + (k % 4 == 3);  // edges 0 and 1 lie in the first
        EXPECT_EQ(bytes[size_t(k)], std::min(255, (half + f) * 51)) << k;
    }
}

// ---------------------------------------------------------------- small parts of the page

TEST(ReportPage, a_row_without_error_or_time_has_its_place_in_the_chart) {
    const Rows rows =
        rows_of({{"same", {{"s", entry("simulated", 0, 0)}}}, {"net", {{"s", entry("learned", 4, 0.1)}}}});
    EXPECT_NEAR(rows.hypervolume, 20, 1e-12);
    ReportPage page;
    page.rows = rows, page.curves = {{"same", "simulated", {0}}, {"net", "learned", {}}};
    for (const std::string& svg :
         {cost_chart(rows), error_chart(page.curves, 0, 1, "frame"), html_of(page)}) {
        expect_in(svg, "same");
        for (const char* bad : {"nan,", "nan ", "\"nan", "inf,", "inf ", "\"inf", "\"-inf"})
            expect_not_in(svg, bad);
    }
}

TEST(ReportPage, text_cannot_become_markup) {
    EXPECT_EQ(escaped("<b a='x' b=\"y\">&\x01"), "&lt;b a=&#39;x&#39; b=&quot;y&quot;&gt;&amp;\xef\xbf\xbd");
    EXPECT_EQ(escaped("30° wet"), "30° wet");
}

TEST(ReportPage, labels_are_spread_apart_in_their_order) {
    EXPECT_EQ(spread_apart({50, 10}, 12, 0, 100), (std::vector<double>{50, 10}));
    EXPECT_EQ(spread_apart({10, 11, 12}, 5, 0, 100), (std::vector<double>{10, 15, 20}));
    EXPECT_EQ(spread_apart({99, 100}, 10, 0, 100), (std::vector<double>{90, 100}));
}

TEST(ReportPage, times_are_in_units_that_suit) {
    EXPECT_EQ(time_text(0.00095), "0.95 ms");
    EXPECT_EQ(time_text(0.0342), "34 ms");
    EXPECT_EQ(time_text(0.2284), "228 ms");
    EXPECT_EQ(time_text(1.24), "1.2 s");
    EXPECT_EQ(time_text(123.4), "123 s");
}

// ---------------------------------------------------------------- the command

constexpr const char* title = "Wet </script><script>alert(1)</script> & <b>\"curls'\"";

class Report : public Table {
  protected:
    // A wet run, and one by interpolation beside it.
    void make_runs() {
        SimulateOptions wet;
        wet.scene = scratch.file("scene.toml",
                                 "title = '''" + std::string(title) +
                                     "'''\nframes = 4\n[groom]\ngrid = [8, 8]\nparticles = 10\n"
                                     "[stretch]\n[bend]\n[wetness]\n[curl]\n[[solid]]\nname = "
                                     "\"head\"\nshape = \"sphere\"\nradius = 0.095\nattached = \"head\"\n");
        wet.output = scratch.path("wet.h5");
        wet.threads = 1;
        simulate_command(wet);
        wet.dry = true, wet.strands = 16, wet.output = scratch.path("dry.h5");
        simulate_command(wet);
        InferOptions quad;
        quad.input = wet.output, quad.interpolate = "quad", quad.output = scratch.path("quad.h5");
        infer_command(quad);
    }
    ReportOptions options() {
        ReportOptions o;
        o.output = scratch.path("report.html"), o.json = scratch.path("report.json");
        return o;
    }
    Json json() { return Json::parse(bytes_of(scratch.path("report.json"))); }
    std::string page() { return bytes_of(scratch.path("report.html")); }
};

TEST_F(Report, misuse_says_what_is_needed) {
    ReportOptions o;
    o.runs = {"a.h5", "b.h5"};
    expect_error<Misuse>([&] { report_command(o); }, {"-o report.html", "--json"});
    o = options();
    expect_error<Misuse>([&] { report_command(o); }, {"REFERENCE.h5", "--table"});
    o.runs = {"a.h5"};
    expect_error<Misuse>([&] { report_command(o); }, {"a.h5 alone", "reference"});
    o.runs = {"a.h5", "b.h5"}, o.output = "report.pdf";
    expect_error<Misuse>([&] { report_command(o); }, {"report.pdf", ".html"});
    o = options(), o.table = "table", o.first_frame = 3;
    expect_error<Misuse>([&] { report_command(o); }, {"--first-frame"});
    o = options(), o.runs = {"a.h5", "b.h5"};
    scratch.file("report.html", "mine");
    expect_error([&] { report_command(o); }, {"report.html", "--overwrite"});
    EXPECT_EQ(page(), "mine");
}

TEST_F(Report, of_runs_holds_rows_player_and_nothing_from_elsewhere) {
    make_runs();
    fs::copy(scratch.path("quad.h5"), scratch.path("<script>copy.h5"));
    ReportOptions o = options();
    o.runs = {scratch.path("wet.h5"), scratch.path("quad.h5"), scratch.path("<script>copy.h5")};
    o.first_frame = 1;
    EXPECT_EQ(report_command(o), 0);
    const std::string html = page();
    for (const char* part :
         {"<!DOCTYPE html>",
          "Wet &lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt; &amp; &lt;b&gt;&quot;curls&#39;&quot;",
          "<b>quad</b>", "quad interpolation", "<svg class=\"chart\"", "Hypervolume",
          "reference point "
          "(1 s a frame, 100 mm)",
          "id=\"player-data\"", "all 64 strands", "wet.h5", "frames 1 to 3"})
        expect_in(html, part);
    for (const char* part :
         {"http:", "https:", " src=", " href=", "@import", "url(", "alert(1)</script>", "<script>copy"})
        expect_not_in(html, part);

    // Data of the player: 3 frames, 64 strands, 10 particles; where they say the run's are.
    const size_t begin = html.find("id=\"player-data\">") + 17;
    const Json data = Json::parse(html.substr(begin, html.find("</script>", begin) - begin));
    EXPECT_EQ(data["frames"], 3);
    EXPECT_EQ(data["runs"].size(), 3u);
    EXPECT_EQ(data["runs"][2]["name"], "<script>copy");
    EXPECT_EQ(data["solids"].size(), 1u);
    EXPECT_TRUE(data["runs"][0]["saturation"].is_string());
    const auto bytes = bytes_of_base64(data["runs"][1]["positions"].get<std::string>());
    ASSERT_EQ(bytes.size(), 6u * 3 * 64 * 10);
    const Strands seen = RunReader(scratch.path("quad.h5")).frame(3).seen();
    for (size_t k = 0; k < seen.points.size(); ++k) {
        const float x[3]{seen.points[k].x, seen.points[k].y, seen.points[k].z};
        for (size_t a = 0; a < 3; ++a) {
            const size_t at = 6 * (2 * 640 + k) + 2 * a;
            const double share = (bytes[at] + 256 * bytes[at + 1]) / 65535.0,
                         size = data["size"][a].get<double>();
            ASSERT_NEAR(data["low"][a].get<double>() + share * size, x[a], 0.51 * size / 65535 + 1e-6);
        }
    }
    EXPECT_GT(data["size"][1].get<double>(), 0.1);
}

TEST_F(Report, json_has_its_keys_and_needs_no_page) {
    make_runs();
    ReportOptions o = options();
    o.output.clear();
    o.runs = {scratch.path("wet.h5"), scratch.path("quad.h5")};
    o.stability =
        scratch.file("battery.json",
                     "{\"cases\": [{\"id\": \"S1\", \"method\": \"ours\", \"integrator\": \"implicit\", "
                     "\"passed\": true, \"gain\": 1.5}], \"summary\": {}}");
    EXPECT_EQ(report_command(o), 0);
    EXPECT_FALSE(fs::exists(scratch.path("report.html")));
    const Json j = json();
    EXPECT_EQ(j["reference"], scratch.path("wet.h5"));
    ASSERT_EQ(j["rows"].size(), 1u);
    const Json& row = j["rows"][0];
    EXPECT_EQ(row["name"], "quad");
    EXPECT_EQ(row["method"], "quad interpolation");
    EXPECT_EQ(row["kind"], "interpolated");
    EXPECT_EQ(row["scenes"], 1);
    EXPECT_EQ(row["worst"]["scene"], "wet");
    EXPECT_EQ(row["worst"]["position_mm"], row["position_mm"]["mean"]);
    EXPECT_TRUE(row["seeds"].is_null());
    EXPECT_TRUE(row["wins"].is_null());
    EXPECT_EQ(row["on_front"], true);
    EXPECT_EQ(j["front"], Json{"quad"});
    EXPECT_GT(row["position_mm"]["mean"].get<double>(), 0.1);
    EXPECT_EQ(row["position_mm_per_frame"].size(), 4u);
    const Json written = json_of(Comparison());
    for (const auto& [key, value] : written.items()) EXPECT_EQ(row.contains(key), key != "file") << key;
    EXPECT_GT(j["hypervolume"]["all"].get<double>(), 0);
    EXPECT_EQ(j["hypervolume"]["all"], j["hypervolume"]["without_learned"]);
    EXPECT_EQ(j["hypervolume"]["reference_point"], (Json{{"seconds", 1.0}, {"mm", 100.0}}));
    EXPECT_EQ(j["stability"]["cases"][0]["gain"], 1.5);
}

TEST_F(Report, of_a_table_says_every_row_its_seeds_and_other_scenes) {
    for (const char* scene : {"a", "b"}) {
        put("net@1", scene, entry("learned", 4, 0.1));
        put("net@2", scene, entry("learned", 4.5, 0.1));
        put("net@3", scene, entry("learned", 5, 0.1));
        put("quad", scene, entry("interpolated", 9, 0.01, "quad interpolation"));
        put("<i>rest", scene, entry("interpolated", 6, 0.09));
        put("sim", scene, entry("simulated", 7, 0.05));
    }
    put("half", "a", entry("learned", 1, 0.001));
    ReportOptions o = options();
    o.table = scratch.path("table");
    o.stability = scratch.file(
        "battery.json",
        "{\"cases\": [{\"id\": \"S4\", \"method\": \"<u>lin\", \"integrator\": \"implicit\", "
        "\"passed\": false, \"gain\": 3e8, \"parameters\": {\"case\": \"stiff\", \"dt\": 0.1}}]}");
    EXPECT_EQ(report_command(o), 0);
    const std::string html = page();
    for (const char* part :
         {"<b>net</b>", "<b>quad</b>", "<b>&lt;i&gt;rest</b>", "<b>sim</b>", "<b>half</b>",
          "seeds 1, 2, 3: median (2) of 4.00 to 5.00 mm", "lacks the scenes b", "Of other scenes than most",
          "wins over &lt;i&gt;rest", "0.500 ×", "the error of quad interpolation", "&lt;u&gt;lin",
          "0 of 1 passed", "gain ≤ 3e+08", "stiff, dt 0.1", "table/quad/a.json"})
        expect_in(html, part);
    for (const char* part : {"<i>rest", "<u>lin", "http:", "https:", "player-data\">"})
        expect_not_in(html, part);
    const Json j = json();
    EXPECT_TRUE(j["reference"].is_null());
    EXPECT_EQ(j["rows"].size(), 5u);
    EXPECT_EQ(j["rows"][0]["name"], "half");
    EXPECT_EQ(j["rows"][0]["lacks"], Json{"b"});
    EXPECT_EQ(j["rows"][1]["seeds"]["median"], "2");
    EXPECT_EQ(j["rows"][1]["seeds"]["position_mm"], (Json{{"min", 4.0}, {"max", 5.0}}));
    EXPECT_EQ(j["rows"][1]["wins"], true);
    EXPECT_EQ(j["front"], (Json{"quad", "sim", "<i>rest", "net"}));
}

TEST_F(Report, follows_a_training_until_it_ends) {
    const std::string log = scratch.path("net.h5.jsonl");
    const auto line = [](int epoch) {
        return "{\"epoch\":" + std::to_string(epoch) + ",\"loss\":" + std::to_string(8 >> epoch) + "}\n";
    };
    ReportOptions o = options();
    o.trainings = {log}, o.watch = 1;
    std::optional<LockedFile> writer;
    writer.emplace(log, log);  // as the training holds it
    writer->append(line(0));
    std::thread report([&] { EXPECT_EQ(report_command(o), 0); });
    const auto wait_for = [&](const std::string& part) {
        for (int k = 0; k < 300; ++k, std::this_thread::sleep_for(std::chrono::milliseconds(100)))
            if (fs::exists(o.output) && page().find(part) != std::string::npos) return true;
        return false;
    };
    // A curve needs two epochs; of a line that is half written nothing is read.
    writer->append(line(1) + "{\"epoch\":2");
    EXPECT_TRUE(wait_for("1 epochs"));
    expect_in(page(), "http-equiv=\"refresh\" content=\"1\"");
    writer->append(line(2).substr(10));
    EXPECT_TRUE(wait_for("2 epochs"));
    writer.reset();
    report.join();
    expect_in(page(), "2 epochs");
    expect_not_in(page(), "http-equiv=\"refresh\"");
    o.overwrite = true;
    EXPECT_EQ(report_command(o), 0);  // of one that has ended: once
    o.runs = {"a.h5", "b.h5"};
    expect_error<Misuse>([&] { report_command(o); }, {"--watch", "--training"});
}

TEST_F(Report, shows_trainings_beside_rows_or_alone) {
    const std::string first = scratch.file("<b>net.h5.jsonl",
                                           "{\"epoch\":1,\"loss\":4,\"validation_mm\":50,\"base_mm\":80}\n"
                                           "{\"epoch\":2,\"loss\":1,\"validation_mm\":0.5,\"base_mm\":80}\n");
    const std::string second =
        scratch.file("other.h5.jsonl", "{\"epoch\":1,\"loss\":4}\n{\"epoch\":2,\"loss\":1}\n");
    put("quad", "a", entry("interpolated", 9, 0.01));
    ReportOptions o = options();
    o.table = scratch.path("table"), o.trainings = {first, second};
    EXPECT_EQ(report_command(o), 0);
    const std::string html = page();
    for (const char* part :
         {"id=\"training\"", "<b>&lt;b&gt;net</b> 2 epochs, held out 0.5 mm at best, 80 mm without a network",
          "mean error [mm]", "loss [1]", "curve learned", "held out 0.5", "epoch", "&lt;b&gt;net.h5.jsonl",
          "<b>quad</b>"})
        expect_in(html, part);
    for (const char* part : {"<b>net", "http:", "https:"}) expect_not_in(html, part);
    // Its own logarithmic axis: a hundredth lies two decades lower, and the points say so.
    const size_t at = html.find("curve learned");
    double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    ASSERT_EQ(
        std::sscanf(html.c_str() + html.find("points=", at), "points=\"%lf,%lf %lf,%lf", &x0, &y0, &x1, &y1),
        4);
    EXPECT_GT(x1, x0 + 300);
    EXPECT_GT(y1, y0 + 250);
    const Json j = json();
    ASSERT_EQ(j["trainings"].size(), 2u);
    EXPECT_EQ(j["trainings"][0]["unit"], "mm");
    EXPECT_EQ(j["trainings"][0]["series"][0]["value"], (Json{50.0, 0.5}));

    o.table.clear(), o.overwrite = true;
    EXPECT_EQ(report_command(o), 0);
    expect_in(page(), "<h1>Trainings</h1>");
    expect_in(page(), "2 trainings.");
    expect_not_in(page(), "Hypervolume");
    o.trainings = {scratch.file("bad.jsonl", "{}\n")};
    expect_error([&] { report_command(o); }, {"bad.jsonl:1", "training"});
}

TEST_F(Report, of_a_malformed_battery_is_an_error) {
    put("net", "a", entry("learned", 4, 0.1));
    ReportOptions o = options();
    o.table = scratch.path("table");
    for (const std::string text : {"", "[]", "{\"cases\": []}", "{\"cases\": [{\"id\": \"S1\"}]}"}) {
        o.stability = scratch.file("battery.json", text);
        expect_error([&] { report_command(o); }, {"battery.json", "cases", "wetcurl stability --json"});
    }
    o.stability = scratch.path("absent.json");
    expect_error([&] { report_command(o); }, {"absent.json", "cannot be read"});
    EXPECT_FALSE(fs::exists(o.output));
}

}  // namespace
}  // namespace wetcurl

// HDF5 files and run caches: round trips to the bit, and an Error for everything else.
#include <cmath>
#include <functional>

#include "base/config.h"
#include "base/geometry/mesh.h"
#include "base/provenance.h"
#include "base/run_cache.h"
#include "small_run.h"

namespace wetcurl {
namespace {

using testing::bytes_of;
using testing::expect_error;
using testing::same_points;
using testing::Scratch;
using testing::small_frame;
using testing::small_header;

constexpr const char* format = "wetcurl test";

// A committed file of format `format`, version 3.
std::string small_file(const Scratch& scratch, const std::string& name = "small.h5") {
    H5Writer w(scratch.path(name), format, 3, true);
    w.write("group/values", std::vector<float>{1, 2, 3});
    w.attribute("scene", "title = \"x\"\n");
    w.commit();
    return scratch.path(name);
}

template <class T>
void expect_round_trip(const std::vector<T>& values) {
    const Scratch scratch;
    const std::string path = scratch.path("a.h5");
    {
        H5Writer w(path, format, 1, false);
        w.write("deep/er/values", values.data(), {2, values.size() / 2});
        w.commit();
    }
    const H5Reader r(path, format, 1);
    EXPECT_EQ(r.shape("deep/er/values"), (std::vector<size_t>{2, values.size() / 2}));
    EXPECT_EQ(r.read<T>("deep/er/values"), values);
    std::vector<T> row(values.size() / 2);
    r.read_row("deep/er/values", 1, row.data());
    EXPECT_TRUE(std::equal(row.begin(), row.end(), values.begin() + long(values.size() / 2)));
}

TEST(Hdf5, values_of_every_type_come_back_to_the_bit) {
    expect_round_trip<float>({1.5f, -0.1f, 3e-30f, 1e30f});
    expect_round_trip<double>({1.0 / 3, -1e-300, 1e300, 0});
    expect_round_trip<int32_t>({1, -2, 2147483647, -2147483647});
    expect_round_trip<int64_t>({1, -2, 9007199254740993, 4});
    expect_round_trip<uint8_t>({0, 1, 255, 7});
}

TEST(H5, whole_numbers_of_another_kind_or_range_are_refused) {
    const Scratch scratch;
    const std::string path = scratch.path("numbers.h5");
    {
        H5Writer w(path, format, 1, false);
        w.attribute("good", 7), w.attribute("huge", 1e300), w.attribute("half", 2.5), w.attribute("nan", NAN);
        w.write("about/words", std::vector<uint8_t>{65, 66, 67});
        w.commit();
    }
    const H5Reader r(path, format, 1);
    EXPECT_EQ(r.integer("good", 1, 7), 7);
    expect_error<Error>([&] { r.integer("good", 8, 9); }, {"numbers.h5", "good", "7", "8 to 9"});
    for (const char* bad : {"huge", "half"})
        expect_error<Error>([&] { r.integer(bad, 1, 100); }, {"numbers.h5", bad, "1 to 100"});
    expect_error<Error>([&] { r.integer("nan", 1, 100); }, {"numbers.h5", "nan", "finite"});
    expect_error<Error>([&] { r.text("words"); }, {"words", "no text"});
}

TEST(Hdf5, attributes_come_back_whatever_their_length) {
    const Scratch scratch;
    const std::string scene(200'000, 'x'), path = scratch.path("a.h5");
    {
        H5Writer w(path, format, 1, false);
        w.attribute("scene", scene + "é\n");
        w.attribute("empty", "");
        w.attribute("fps", 23.976);
        w.commit();
    }
    const H5Reader r(path, format, 1);
    EXPECT_EQ(r.text("scene"), scene + "é\n");
    EXPECT_EQ(r.text("empty"), "");
    EXPECT_EQ(r.number("fps"), 23.976);
    EXPECT_TRUE(r.has_attribute("fps"));
    EXPECT_FALSE(r.has_attribute("seed"));
}

TEST(Hdf5, appended_rows_stand_in_their_order) {
    const Scratch scratch;
    const std::string path = scratch.path("a.h5");
    {
        H5Writer w(path, format, 1, false);
        for (float f = 0; f < 5; ++f) {
            const float row[2] = {f, 10 * f};
            w.append("rows", row, {2});
            w.flush();
        }
        w.commit();
    }
    const H5Reader r(path, format, 1);
    EXPECT_EQ(r.shape("rows"), (std::vector<size_t>{5, 2}));
    float row[2];
    r.read_row("rows", 3, row);
    EXPECT_EQ(row[1], 30);
    EXPECT_EQ(r.list("about").size(), 2 + provenance().size());  // format, version
}

TEST(Hdf5, a_file_has_its_name_only_once_it_is_whole) {
    const Scratch scratch;
    const std::string path = scratch.path("a.h5");
    {
        H5Writer w(path, format, 1, false);
        w.write("v", std::vector<float>{4});
        EXPECT_FALSE(std::filesystem::exists(path));
    }
    EXPECT_FALSE(std::filesystem::exists(path));
    EXPECT_EQ(H5Reader(path + ".partial", format, 1).read<float>("v"), std::vector<float>{4});
}

TEST(Hdf5, nothing_is_overwritten_unasked) {
    const Scratch scratch;
    const std::string path = small_file(scratch), before = bytes_of(path);
    expect_error([&] { H5Writer(path, format, 3, false); }, {path, "--overwrite"});
    EXPECT_EQ(bytes_of(path), before);
    { H5Writer abandoned(path, format, 3, true); }
    EXPECT_EQ(bytes_of(path), before);  // until the new one is whole
}

TEST(Hdf5, a_place_that_cannot_be_written_is_an_error) {
    const Scratch scratch;
    const std::string file = scratch.file("file", "x");
    expect_error([&] { H5Writer(file + "/a.h5", format, 1, false); }, {"a.h5"});
}

TEST(Hdf5, missing_empty_foreign_other_and_newer_files_are_errors) {
    const Scratch scratch;
    const std::string good = small_file(scratch);
    const auto open = [](const std::string& path) { H5Reader(path, format, 3); };
    EXPECT_NO_THROW(open(good));
    expect_error([&] { open(scratch.path("none.h5")); }, {"none.h5", "no such file"});
    expect_error([&] { open(scratch.path()); }, {scratch.path(), "folder"});
    expect_error([&] { open(scratch.file("empty.h5", "")); }, {"empty.h5", "empty"});
    expect_error([&] { open(scratch.file("foreign.h5", std::string(4000, 'x'))); },
                 {"foreign.h5", "no HDF5"});
    expect_error([&] { H5Reader(good, "wetcurl run", 3); }, {good, format, "'wetcurl run'"});
    expect_error([&] { H5Reader(good, format, 2); }, {good, "version 3", "1 to 2", "newer"});
}

TEST(Hdf5, cut_anywhere_is_an_error) {
    const Scratch scratch;
    const std::string whole = bytes_of(small_file(scratch));
    for (size_t n = 0; n < whole.size(); n += 37) {
        const std::string path = scratch.file("cut.h5", whole.substr(0, n));
        expect_error([&] { H5Reader(path, format, 3).read<float>("group/values"); }, {"cut.h5"});
    }
}

TEST(Hdf5, wrong_shapes_types_names_and_rows_are_errors) {
    const Scratch scratch;
    const std::string path = small_file(scratch);
    const H5Reader r(path, format, 3);
    expect_error([&] { r.read<float>("group/value"); }, {path, "'group/value'", "missing"});
    expect_error([&] { r.read<float>("nowhere/at/all"); }, {path, "missing"});
    expect_error([&] { r.read<float>("group/values", {4}); }, {path, "(3)", "(4)"});
    expect_error([&] { r.read<float>("group/values", {0, 3}); }, {path, "(3)"});
    expect_error([&] { r.read<int32_t>("group/values"); }, {path, "type"});
    float row[3];
    expect_error([&] { r.read_row("group/values", 3, row); }, {path, "no row 3"});
    expect_error([&] { r.number("scene"); }, {path, "scene"});
    expect_error([&] { r.text("fps"); }, {path, "'fps'", "missing"});
    EXPECT_EQ(r.read<float>("group/values", {0}).size(), 3u);
    EXPECT_TRUE(r.list("nowhere").empty());
}

TEST(Hdf5, what_is_not_finite_is_an_error_with_its_place) {
    const Scratch scratch;
    for (float bad : {std::nanf(""), HUGE_VALF}) {
        H5Writer w(scratch.path("nan.h5"), format, 1, true);
        w.write("v", std::vector<float>{0, 1, bad});
        w.commit();
        expect_error([&] { H5Reader(scratch.path("nan.h5"), format, 1).read<float>("v"); },
                     {"nan.h5", "'v'", "value 2", "finite"});
    }
}

// ---- run caches ----

std::string small_run(const Scratch& scratch, const RunHeader& header, int frames = 3) {
    RunWriter w(scratch.path("run.h5"), header, true);
    for (int f = 0; f < frames; ++f) w.append(small_frame(f));
    w.commit();
    return scratch.path("run.h5");
}

// Changes how many rows the only dataset of this shape claims, wherever the file says it: its size and its
// largest size, two numbers of 64 bits in a row each.
void claim_rows(const std::string& path, uint64_t rows, uint64_t columns, uint64_t claimed) {
    std::string bytes = testing::bytes_of(path);
    const uint64_t shape[] = {rows, columns};
    const std::string wanted(reinterpret_cast<const char*>(shape), sizeof shape);
    size_t places = 0;
    for (auto at = bytes.find(wanted); at != std::string::npos; at = bytes.find(wanted, at + 1), ++places)
        bytes.replace(at, sizeof claimed, reinterpret_cast<const char*>(&claimed), sizeof claimed);
    ASSERT_TRUE(places == 1 || places == 2) << places;
    std::ofstream(path, std::ios::binary) << bytes;
}

TEST(H5, a_size_that_the_file_cannot_hold_is_refused_before_memory_is_asked_for) {
    const Scratch scratch;
    const std::string path = scratch.path("a.h5");
    {
        H5Writer w(path, "test", 1, false);
        w.write("x", std::vector<float>(17 * 13, 1).data(), {17, 13});
        w.commit();
    }
    EXPECT_EQ(H5Reader(path, "test", 1).read<float>("x").size(), 17u * 13);
    claim_rows(path, 17, 13, 100'000'000);
    const H5Reader r(path, "test", 1);
    std::vector<float> row(13);
    for (const auto& read : std::initializer_list<std::function<void()>>{
             [&] { r.shape("x"); }, [&] { r.read<float>("x"); }, [&] { r.read_row("x", 99, row.data()); }})
        expect_error([&] { read(); }, {path, "'x' claims (100000000, 13)", "5200000000 bytes", "holds 884"});
}

TEST(Files, a_git_lfs_pointer_is_named_as_one) {
    const Scratch scratch;
    const std::string pointer =
        "version https://git-lfs.github.com/spec/v1\noid sha256:0123\nsize 12345678\n";
    for (const char* name : {"run.h5", "head.obj", "head.ply", "scene.toml"}) scratch.file(name, pointer);
    auto refused = [&](const std::string& name, auto read) {
        expect_error([&] { read(scratch.path(name)); }, {name, "Git LFS pointer", "git lfs pull"});
    };
    refused("run.h5", [](const std::string& path) { RunReader run(path); });
    refused("head.obj", [](const std::string& path) { read_mesh(path, 1); });
    refused("head.ply", [](const std::string& path) { read_mesh(path, 1); });
    refused("scene.toml", [](const std::string& path) { Config::load(path); });
}

TEST(RunCache, header_comes_back_whole) {
    const Scratch scratch;
    const RunHeader h = small_header();
    const RunReader r(small_run(scratch, h));
    const RunHeader& g = r.header();
    EXPECT_EQ(g.scene, h.scene);
    EXPECT_EQ(g.scene_folder, h.scene_folder);
    EXPECT_EQ(g.method, h.method);
    EXPECT_EQ(g.device, h.device);
    EXPECT_EQ(g.fps, h.fps);
    EXPECT_EQ(g.seed, h.seed);
    EXPECT_EQ(g.stride, h.stride);
    EXPECT_EQ(g.groom.hash(), h.groom.hash());
    EXPECT_EQ(g.groom.grid.strand, h.groom.grid.strand);
    EXPECT_EQ(g.saturation, h.saturation);
    EXPECT_EQ(g.energy_kinds, h.energy_kinds);
    EXPECT_EQ(g.stages, h.stages);
    EXPECT_EQ(g.inputs, h.inputs);
    EXPECT_EQ(g.terms_present, h.terms_present);
    EXPECT_EQ(g.terms_absent, h.terms_absent);
}

TEST(RunCache, frames_come_back_to_the_bit_in_any_order) {
    const Scratch scratch;
    const RunReader r(small_run(scratch, small_header()));
    ASSERT_EQ(r.frames(), 3);
    EXPECT_EQ(r.seconds(), (std::vector<double>{0, 0.5, 1}));
    for (int f : {2, 0, 1}) {
        const RunFrame wanted = small_frame(f), found = r.frame(f);
        EXPECT_TRUE(same_points(found.positions, wanted.positions));
        EXPECT_TRUE(same_points(found.displayed, wanted.displayed));
        EXPECT_TRUE(same_points(found.seen(), wanted.displayed));
        EXPECT_EQ(found.energy, wanted.energy);
        EXPECT_EQ(found.stage_seconds, wanted.stage_seconds);
        EXPECT_EQ(found.contact, wanted.contact);
        EXPECT_EQ(found.saturation, wanted.saturation);
        EXPECT_EQ(found.water, wanted.water);
        EXPECT_EQ(found.seconds, wanted.seconds);
        EXPECT_EQ(norm(found.head.translation - wanted.head.translation), 0);
        EXPECT_EQ(found.head.rotation.w, wanted.head.rotation.w);
        EXPECT_EQ(found.head.rotation.z, wanted.head.rotation.z);
    }
}

TEST(RunCache, holds_nothing_that_the_run_did_not_have) {
    const Scratch scratch;
    RunHeader h = small_header();
    h.saturation.clear(), h.energy_kinds.clear(), h.stages.clear();
    {
        RunWriter w(scratch.path("run.h5"), h, false);
        RunFrame frame;
        frame.positions = small_frame(0).positions;
        w.append(frame);
        w.commit();
    }
    const H5Reader file(scratch.path("run.h5"), run_format, run_version);
    for (const char* absent :
         {"displayed", "saturation", "energy", "stage_seconds", "contact", "living_saturation", "water"})
        EXPECT_FALSE(file.has(absent)) << absent;
    const RunFrame f = RunReader(scratch.path("run.h5")).frame(0);
    EXPECT_EQ(f.displayed.count, 0);
    EXPECT_TRUE(same_points(f.seen(), small_frame(0).positions));
}

TEST(RunCache, an_interrupted_run_is_readable_under_its_partial_name) {
    const Scratch scratch;
    {
        RunWriter w(scratch.path("run.h5"), small_header(), false);
        w.append(small_frame(0));
        w.append(small_frame(1));
    }
    EXPECT_FALSE(std::filesystem::exists(scratch.path("run.h5")));
    const RunReader r(scratch.path("run.h5.partial"));
    EXPECT_EQ(r.frames(), 2);
    EXPECT_TRUE(same_points(r.frame(1).positions, small_frame(1).positions));
}

TEST(RunCache, frames_out_of_range_and_of_another_size_are_errors) {
    const Scratch scratch;
    const std::string path = small_run(scratch, small_header());
    const RunReader r(path);
    expect_error([&] { r.frame(3); }, {path, "found frame 3", "0 to 2"});
    expect_error([&] { r.frame(-1); }, {path, "found frame -1"});
    RunWriter w(scratch.path("b.h5"), small_header(), false);
    RunFrame wrong = small_frame(0);
    wrong.positions = Strands(3, 5);
    expect_error([&] { w.append(wrong); }, {"b.h5", "number of particles"});
}

TEST(RunCache, bad_content_is_an_error_that_says_what) {
    const Scratch scratch;
    const auto expect_bad = [&](void (*spoil)(RunHeader&), std::initializer_list<std::string> parts) {
        RunHeader h = small_header();
        spoil(h);
        const std::string path = small_run(scratch, h);
        expect_error([&] { RunReader r(path); }, {path});
        expect_error([&] { RunReader r(path); }, parts);
    };
    expect_bad([](RunHeader& h) { h.fps = 0; }, {"fps"});
    expect_bad([](RunHeader& h) { h.fps = std::nan(""); }, {"finite"});
    expect_bad([](RunHeader& h) { h.stride = 0; }, {"stride"});
    expect_bad([](RunHeader& h) { h.groom.rest.points[5].y = std::nanf(""); }, {"'groom/points'", "finite"});
    expect_bad([](RunHeader& h) { h.groom.grid.strand[3] = 3; }, {"'groom/grid'", "strand 3"});
    expect_bad([](RunHeader& h) { h.groom.grid.strand[3] = 1; }, {"'groom/grid'", "strand 1 twice"});
    expect_bad([](RunHeader& h) { h.saturation[3] = HUGE_VALF; }, {"'saturation'", "finite"});
}

TEST(RunCache, its_kind_says_whether_a_network_made_it) {
    RunHeader h;
    h.method = "simulated dry";
    EXPECT_EQ(kind_of(h), "simulated");
    h.method = "simulated wet, adhesion learned";  // a network in Eq 11's place
    EXPECT_EQ(kind_of(h), "learned");
    h.method = "rest interpolation, Eq 9, Eq 10", h.inputs = {"dry.h5"};
    EXPECT_EQ(kind_of(h), "interpolated");
    h.method = "strand_mlp", h.inputs = {"dry.h5", "model.h5"};
    EXPECT_EQ(kind_of(h), "learned");
    h.method = "strand_linear";  // a regression is no network
    EXPECT_EQ(kind_of(h), "interpolated");
}

TEST(RunCache, a_position_that_is_not_finite_names_frame_and_strand) {
    const Scratch scratch;
    {
        RunWriter w(scratch.path("run.h5"), small_header(), false);
        RunFrame f = small_frame(0);
        f.positions.at(2, 1).z = std::nanf("");
        w.append(f);
        w.commit();
    }
    const RunReader r(scratch.path("run.h5"));
    expect_error([&] { r.frame(0); }, {"run.h5", "frame 0", "strand 2", "not finite"});
}

TEST(RunCache, cut_anywhere_is_an_error_or_a_run_whose_frames_are_judged) {
    const Scratch scratch;
    const std::string whole = bytes_of(small_run(scratch, small_header()));
    for (size_t n = 0; n < whole.size(); n += whole.size() / 100) {
        const std::string path = scratch.file("cut.h5", whole.substr(0, n));
        expect_error([&] { RunReader(path).frame(2); }, {"cut.h5"});
    }
}

}  // namespace
}  // namespace wetcurl

// Reading real and made-up strand files: points, units, axes, dropped strands, and writing them again.
#include <algorithm>

#include "base/strands.h"
#include "solver/grooms/import.h"
#include "strand_files.h"

namespace wetcurl {
namespace {

using namespace testing;

const std::string shared = WETCURL_SHARED_DIR "/data/";

// What `act` writes to standard error.
template <class Act>
std::string logged(Act act) {
    ::testing::internal::CaptureStderr();
    act();
    return ::testing::internal::GetCapturedStderr();
}

double median_length(const StrandPoints& strands) {
    std::vector<double> lengths;
    for (const auto& s : strands) lengths.push_back(arc_length(s.data(), int(s.size())));
    std::sort(lengths.begin(), lengths.end());
    return lengths[lengths.size() / 2];
}

StrandPoints scaled(StrandPoints strands, double by) {
    for (auto& strand : strands)
        for (auto& x : strand) x = by * x;
    return strands;
}

TEST(Import, hair_files_may_leave_out_segments_and_carry_other_arrays) {
    Scratch scratch;
    for (uint32_t arrays : {2u, 3u, 2u + 4, 3u + 8, 2u + 16, 31u})
        for (const char* magic : {"HAIR", "hair"})
            EXPECT_TRUE(
                same(read_hair(scratch.file("a.hair", hair_file(sample_strands(), arrays, magic))).points,
                     sample_strands()))
                << arrays;
}

TEST(Import, units_are_as_said) {
    Scratch scratch;
    const std::string file = scratch.file("a.data", data_file(sample_strands()));
    const double metres = median_length(import_strands(file, {"m", "y"}).strands);
    EXPECT_GT(metres, 0.1);
    EXPECT_NEAR(median_length(import_strands(file, {"cm", "y"}).strands), 0.01 * metres, 1e-15);
    EXPECT_NEAR(median_length(import_strands(file, {"mm", "y"}).strands), 0.001 * metres, 1e-15);
    EXPECT_FALSE(import_strands(file, {"cm", "y"}).guessed);
    expect_error<Misuse>([&] { import_strands(file, {"inch", "y"}); }, {"'inch'", "m, cm, mm, auto"});
    expect_error<Misuse>([&] { import_strands(file, {"m", "w"}); }, {"'w'", "y, -y, z"});
}

TEST(Import, units_guessed_from_the_size_are_right_and_said) {
    Scratch scratch;
    for (const auto& [by, units] : {std::pair{1.0, "m"}, {100.0, "cm"}, {1000.0, "mm"}}) {
        const std::string file = scratch.file("a.data", data_file(scaled(sample_strands(), by)));
        ImportedStrands in;
        const std::string log = logged([&] { in = import_strands(file, {"auto", "y"}); });
        EXPECT_EQ(in.units, units);
        EXPECT_TRUE(in.guessed);
        EXPECT_NE(log.find("guessed " + std::string(units)), std::string::npos) << log;
    }
}

TEST(Import, the_unit_of_a_lock_by_itself_makes_it_no_longer_than_hair_is) {
    Scratch scratch;
    StrandPoints lock;
    for (int s = 0; s < 20; ++s) lock.push_back({{0.02 * s, 0, 0}, {0.02 * s, -1.5, 0}, {0.02 * s, -3, 0}});
    const ImportedStrands in = import_strands(scratch.file("a.data", data_file(lock)), {"auto", "y"});
    EXPECT_EQ(in.units, "cm");
    EXPECT_TRUE(in.guessed);
}

TEST(Import, z_up_becomes_y_up_without_mirroring) {
    Scratch scratch;
    const StrandPoints tripod{{{0, 0, 0}, {1, 0, 0}}, {{0, 0, 0}, {0, 1, 0}}, {{0, 0, 0}, {0, 0, 1}}};
    const auto turned = import_strands(scratch.file("a.data", data_file(tripod)), {"m", "z"}).strands;
    const Vec3d x = turned[0][1], y = turned[1][1], z = turned[2][1];
    EXPECT_EQ(z.y, 1);
    EXPECT_EQ(dot(cross(x, y), z), 1);
}

TEST(Import, degenerate_strands_are_dropped_and_counted_by_reason) {
    Scratch scratch;
    StrandPoints strands = sample_strands(4);
    strands[0].insert(strands[0].begin() + 1, strands[0][1]);  // a point twice
    strands.push_back({});
    strands.push_back({});
    strands.push_back({{0.5, 0.5, 0.5}});
    strands.push_back({{0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}});
    ImportedStrands in;
    const std::string log = logged([&] {
        in = import_strands(scratch.file("a.data", data_file(strands)), {"m", "y"});
    });
    EXPECT_EQ(in.found, 8u);
    EXPECT_EQ(in.no_points, 2u);
    EXPECT_EQ(in.one_point, 1u);
    EXPECT_EQ(in.no_length, 1u);
    EXPECT_EQ(in.repeated_points, 1u);
    EXPECT_TRUE(same(in.strands, sample_strands(4)));
    EXPECT_NE(log.find("dropped 4 of 8"), std::string::npos) << log;
}

TEST(Import, what_is_written_reads_back_the_same) {
    Scratch scratch;
    StrandPoints strands = sample_strands(5);
    strands[2].pop_back();  // unequal ones
    for (const char* name : {"a.data", "a.hair", "a.HAIR"}) {
        write_strands(scratch.path(name), strands, false);
        const ImportedStrands back = import_strands(scratch.path(name), {"m", "y"});
        EXPECT_TRUE(same(back.strands, strands)) << name;
        EXPECT_FALSE(std::filesystem::exists(scratch.path(name) + ".partial"));
    }
}

TEST(Import, writing_never_replaces_a_file_unasked_and_knows_its_endings) {
    Scratch scratch;
    const std::string file = scratch.file("a.data", "mine");
    expect_error([&] { write_strands(file, sample_strands(), false); }, {file, "--overwrite"});
    EXPECT_EQ(bytes_of(file), "mine");
    write_strands(file, sample_strands(), true);
    EXPECT_TRUE(same(read_data(file).points, sample_strands()));
    expect_error<Misuse>([&] { write_strands(scratch.path("a.stl"), sample_strands(), false); },
                         {"'.stl'", ".hair .data"});
    expect_error<Misuse>([&] { import_strands(scratch.path("a.stl"), {}); }, {"'.stl'", ".tfx"});
    write_strands(scratch.path("new/folder/a.data"), sample_strands(), false);
    EXPECT_TRUE(same(read_data(scratch.path("new/folder/a.data")).points, sample_strands()));
    // Found out on writing: nothing is left behind.
    StrandPoints long_one{std::vector<Vec3d>(70000, Vec3d{0, 0, 0})};
    expect_error([&] { write_strands(scratch.path("b.hair"), long_one, false); }, {"70000", "65536"});
    EXPECT_FALSE(std::filesystem::exists(scratch.path("b.hair")));
    EXPECT_FALSE(std::filesystem::exists(scratch.path("b.hair.partial")));
}

TEST(Import, meshes_take_units_and_axis_as_strands_do) {
    Scratch scratch;
    const std::string file = scratch.file("a.obj", "v 0 0 0\nv 50 0 0\nv 0 0 50\nf 1 2 3\n");
    Mesh mesh;
    const std::string log = logged([&] { mesh = import_mesh(file, {"auto", "z"}); });
    EXPECT_NE(log.find("guessed cm"), std::string::npos) << log;
    EXPECT_NEAR(mesh.vertices[2].y, 0.5f, 1e-7f);
}

// ---- real files

#define REQUIRE_SHARED(name) \
    if (!std::filesystem::exists(shared + (name))) GTEST_SKIP() << "SKIP: no " << shared << (name)

TEST(RealFiles, the_same_100_strands_come_out_of_five_files) {
    REQUIRE_SHARED("Bangs_100.data");
    const auto reference = import_strands(shared + "Bangs_100.data", {"mm", "y"});
    EXPECT_EQ(reference.strands.size(), 100u);
    EXPECT_EQ(total(reference.strands), 1165u);
    EXPECT_EQ(reference.dropped() + reference.repeated_points, 0u);
    EXPECT_NEAR(median_length(reference.strands), 0.0757, 1e-3);
    for (const char* other :
         {"Bangs_100.bin", "Bangs_100.hair", "Bangs_100_binary.ply", "Bangs_100_ascii.ply"}) {
        const auto in = import_strands(shared + other, {"mm", "y"});
        ASSERT_EQ(in.strands.size(), 100u) << other;
        for (size_t s = 0; s < 100; ++s) {
            ASSERT_EQ(in.strands[s].size(), reference.strands[s].size()) << other;
            for (size_t i = 0; i < in.strands[s].size(); ++i)
                // Nine digits of 250 mm in the ascii file, single precision in the others.
                ASSERT_LE(norm(in.strands[s][i] - reference.strands[s][i]), 1e-9) << other;
        }
    }
}

TEST(RealFiles, harolongo_is_7905_strands_of_21_points_in_centimetres) {
    REQUIRE_SHARED("harolongo.data");
    const auto in = import_strands(shared + "harolongo.data", {});
    EXPECT_EQ(in.strands.size(), 7905u);
    EXPECT_EQ(total(in.strands), 7905u * 21);
    EXPECT_EQ(in.units, "cm");
    EXPECT_NEAR(median_length(in.strands), 0.235, 1e-3);
}

TEST(RealFiles, yuksel_straight_has_no_segments_array_and_hangs_down_once_y_is_up) {
    REQUIRE_SHARED("yuksel_straight.hair");
    const auto in = import_strands(shared + "yuksel_straight.hair", {"cm", "z"});
    EXPECT_EQ(in.strands.size(), 10000u);
    EXPECT_EQ(total(in.strands), 160000u);
    size_t falling = 0;
    for (const auto& s : in.strands) falling += s.back().y < s.front().y;
    EXPECT_GT(falling, 9500u);
}

TEST(RealFiles, ratboy_is_2228_strands_of_32_points) {
    REQUIRE_SHARED("Ratboy_mohawk.tfx");
    const auto in = import_strands(shared + "Ratboy_mohawk.tfx", {"m", "y"});
    EXPECT_EQ(in.found, 2228u);
    EXPECT_EQ(in.no_length, 2u);  // of 7 and 56 micrometres
    EXPECT_EQ(in.dropped_numbers, (std::vector<size_t>{293, 435}));
    EXPECT_EQ(total(in.strands) + in.repeated_points, 2226u * 32);
}

}  // namespace
}  // namespace wetcurl

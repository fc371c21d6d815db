// Every kind of broken strand file, for every reader: an error that names the file, and never a crash.
#include <cmath>
#include <limits>

#include "solver/grooms/import.h"
#include "strand_files.h"

namespace wetcurl {
namespace {

using namespace testing;

class Malformed : public ::testing::TestWithParam<StrandFormat> {
  protected:
    const StrandFormat& format() const { return GetParam(); }
    std::string good() const { return format().make(sample_strands()); }
    bool ascii() const { return std::string(format().name) == "ply_ascii"; }
    std::string path() const { return scratch_.path("broken" + std::string(format().ending)); }
    // Whether reading gives an Error that names the file.
    ::testing::AssertionResult refused(const std::string& bytes, const std::string& also = "") const {
        const std::string file = scratch_.file("broken" + std::string(format().ending), bytes);
        try {
            import_strands(file, {"m", "y"});
        } catch (const Error& e) {
            const std::string what = e.what();
            if (what.find(file) != std::string::npos && what.find(also) != std::string::npos)
                return ::testing::AssertionSuccess();
            return ::testing::AssertionFailure() << "said: " << what;
        }
        return ::testing::AssertionFailure() << "taken";
    }
    Scratch scratch_;
};

TEST_P(Malformed, the_whole_file_is_taken) {
    scratch_.file("broken" + std::string(format().ending), good());
    EXPECT_TRUE(same(import_strands(path(), {"m", "y"}).strands, sample_strands()));
}

TEST_P(Malformed, a_git_lfs_pointer_is_refused_with_the_way_out) {
    EXPECT_TRUE(refused("version https://git-lfs.github.com/spec/v1\noid sha256:0123\nsize 12345678\n",
                        "`git lfs pull`"));
}

TEST_P(Malformed, missing_empty_or_no_file_is_refused) {
    expect_error([&] { import_strands(path(), {"m", "y"}); }, {path(), "no such file"});
    EXPECT_TRUE(refused("", "empty"));
    std::filesystem::create_directory(scratch_.path("folder" + std::string(format().ending)));
    expect_error(
        [&] {
            import_strands(scratch_.path("folder" + std::string(format().ending)), {"m", "y"});
        },
        {"folder"});
}

TEST_P(Malformed, a_file_cut_short_anywhere_is_refused) {
    const std::string whole = format().make(sample_strands(2));
    // An ascii number cut in its digits is still a number: the last one is left out.
    const size_t end = ascii() ? whole.find_last_of('\n', whole.size() - 2) + 1 : whole.size();
    for (size_t length = 0; length < end; ++length)
        ASSERT_TRUE(refused(whole.substr(0, length))) << length << " bytes";
}

TEST_P(Malformed, foreign_files_are_refused) {
    EXPECT_TRUE(
        refused("this is a letter to a friend, and no hair at all: forty-eight bytes and more of it\n"));
    EXPECT_TRUE(refused(std::string(4096, '\xff')));
    for (const auto& other : strand_formats) {
        const bool foreign = std::string(other.ending) != format().ending;
        EXPECT_EQ(bool(refused(other.make(sample_strands(40, 8)))), foreign) << other.name;
    }
}

TEST_P(Malformed, nan_and_infinite_points_are_refused_with_strand_and_point) {
    const float nan = std::numeric_limits<float>::quiet_NaN(),
                infinite = std::numeric_limits<float>::infinity();
    for (float bad : {nan, infinite, -infinite, 1e30f}) {
        StrandPoints strands = sample_strands();
        strands[1][2].y = bad;
        EXPECT_TRUE(refused(format().make(strands), "strand 1, point 2")) << bad;
    }
}

TEST_P(Malformed, no_strands_or_strands_of_one_point_are_refused) {
    EXPECT_TRUE(refused(format().make({})));
    EXPECT_TRUE(refused(format().make(sample_strands(3, 1))));
    EXPECT_TRUE(refused(format().make(StrandPoints(5, std::vector<Vec3d>(4, Vec3d{0.5, 0.25, 0})))));
}

TEST_P(Malformed, absurd_counts_are_refused) {
    if (format().count_at == std::string::npos) {
        for (const char* count : {"4294967295", "99999999999999999999", "-1", "many", "10000000"})
            for (const char* element : {"element vertex 12", "element strand 3"}) {
                std::string bytes = good();
                const size_t at = bytes.find(element), digits = std::string(element).find_last_of(' ') + 1;
                bytes.replace(at + digits, std::string(element).size() - digits, count);
                EXPECT_TRUE(refused(bytes)) << element << " as " << count;
            }
        return;
    }
    for (uint32_t count : {0u, 4u, 1000u, 0x7fffffffu, 0x80000000u, 0xffffffffu})
        EXPECT_TRUE(refused(patched(good(), format().count_at, count))) << count;
}

// Except in .tfx, which goes on with other arrays.
TEST_P(Malformed, bytes_after_the_last_strand_are_refused_where_it_ends_the_file) {
    EXPECT_EQ(bool(refused(good() + "xyz")), format().ends_with_strands);
}

TEST_P(Malformed, random_damage_never_crashes_and_never_gives_points_that_are_not_finite) {
    Random random(7);
    const std::string whole = good();
    int refusals = 0;
    for (int trial = 0; trial < 200; ++trial) {
        std::string bytes = whole;
        for (int k = 0; k < 1 + trial % 3; ++k)
            bytes[size_t(random.number(0, double(bytes.size())))] = char(random.number(-128, 128));
        const std::string file = scratch_.file("broken" + std::string(format().ending), bytes);
        try {
            for (const auto& strand : import_strands(file, {"m", "y"}).strands)
                for (const auto& x : strand)
                    ASSERT_TRUE(std::isfinite(x.x) && std::isfinite(x.y) && std::isfinite(x.z));
        } catch (const Error& e) {
            ASSERT_NE(std::string(e.what()).find(file), std::string::npos) << e.what();
            ++refusals;
        }
    }
    EXPECT_GT(refusals, 20);
}

INSTANTIATE_TEST_SUITE_P(Readers, Malformed, ::testing::ValuesIn(strand_formats),
                         [](const auto& info) { return std::string(info.param.name); });

// ---- what one format alone can get wrong

template <class Read>
void expect_refused(const Scratch& scratch, Read read, const std::string& bytes, const std::string& says) {
    const std::string file = scratch.file("one", bytes);
    expect_error([&] { read(file); }, {file, says});
}

TEST(MalformedHair, sums_and_arrays_that_do_not_fit_are_refused) {
    Scratch scratch;
    const std::string good = hair_file(sample_strands());
    expect_refused(scratch, read_hair, patched(good, 8, uint32_t(11)), "sum of segments");
    expect_refused(scratch, read_hair, patched(good, 128, uint16_t(4)), "sum of segments");
    expect_refused(scratch, read_hair, patched(good, 12, uint32_t(1)), "arrays");
    expect_refused(scratch, read_hair, patched(good, 12, uint32_t(64 + 3)), "arrays");
    expect_refused(scratch, read_hair, patched(hair_file(sample_strands(), 2), 16, uint32_t(0xffffffff)),
                   "sum of segments");
    expect_refused(scratch, read_hair, patched(good, 12, uint32_t(3 + 16)), "colours");
    expect_refused(scratch, read_hair, patched(good, 0, 'J'), "signature");
}

TEST(MalformedTfx, another_version_odd_sizes_and_offsets_are_refused) {
    Scratch scratch;
    const std::string good = tfx_file(sample_strands());
    expect_refused(scratch, read_tfx, patched(good, 0, 3.0f), "version 3");
    for (uint32_t vertices : {0u, 1u, 3u, 5u, 128u, 0xffffffffu})
        expect_refused(scratch, read_tfx, patched(good, 8, vertices), "4, 8, 16, 32, 64");
    for (uint32_t offset : {0u, 159u, 1u << 30})
        expect_refused(scratch, read_tfx, patched(good, 12, offset), "offset");
}

TEST(MalformedPly, headers_and_sums_that_do_not_fit_are_refused) {
    Scratch scratch;
    const std::string good = ply_ascii_file(sample_strands());
    auto with = [&](const std::string& from, const std::string& to) {
        std::string bytes = good;
        const size_t at = bytes.find(from);
        return at == std::string::npos ? "" : bytes.replace(at, from.size(), to);
    };
    expect_refused(scratch, read_ply, with("ascii", "binary_big_endian"), "binary_big_endian");
    expect_refused(scratch, read_ply, with("format ascii 1.0\n", ""), "no format");
    expect_refused(scratch, read_ply, with("float y", "float w"), "'y'");
    expect_refused(scratch, read_ply, with("float y", "half y"), "'half'");
    expect_refused(scratch, read_ply, with("nsegs", "edges"), "nsegs");
    expect_refused(scratch, read_ply, with("end_header", "sparkle"), "sparkle");
    expect_refused(scratch, read_ply, with("0.5 0 7", "half 0 7"), "'half'");
    expect_refused(scratch, read_ply, with("\n3\n", "\n2\n"), "sum of nsegs");
    expect_refused(scratch, read_ply, with("\n3\n", "\n-3\n"), "segments");
}

TEST(MalformedPly, a_vertex_cloud_must_hold_whole_strands_of_100) {
    Scratch scratch;
    auto cloud = [](int vertices) {
        std::ostringstream out;
        out << "ply\nformat ascii 1.0\nelement vertex " << vertices
            << "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
        for (int i = 0; i < vertices; ++i) out << i / 100 << " 0 " << i % 100 << "\n";
        return out.str();
    };
    expect_refused(scratch, read_ply, cloud(250), "multiple of 100");
    const StrandPoints strands = read_ply(scratch.file("cloud.ply", cloud(300))).points;
    ASSERT_EQ(strands.size(), 3u);
    EXPECT_EQ(strands[2].size(), 100u);
    EXPECT_EQ(strands[2][99].z, 99);
}

}  // namespace
}  // namespace wetcurl

// Alembic files: what is written comes back to the bit, what stays the same is stored once, and every damage
// is an Error that names the file. Files of other programs: test_scene_files.sh.
#include <malloc.h>

#include <cmath>
#include <cstring>
#include <functional>

#include "base/exchange/alembic.h"
#include "base/exchange/ogawa.h"
#include "base/log.h"
#include "scratch.h"
#include "shot.h"

namespace wetcurl {
namespace {

using namespace testing;

const std::string shared = WETCURL_SHARED_DIR "/data/";

bool same_bits(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
    return a.size() == b.size() && !a.empty() &&
           std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3f)) == 0;
}

std::string written(const Scratch& scratch, const Shot& shot, const std::string& name = "shot.abc") {
    const std::string path = scratch.path(name);
    shot.write(*create_abc(path, true, shot.settings), !shot.settings.for_unreal);
    return path;
}

// Opens a file and reads all that it holds.
void read_all(const std::string& path) {
    const auto file = open_abc(path);
    for (size_t k = 0; k < file->curves().size(); ++k)
        for (size_t s = 0; s < file->curves()[k].times.size(); ++s) file->points_of_curves(k, s);
    for (size_t k = 0; k < file->meshes().size(); ++k)
        for (size_t s = 0; s < file->meshes()[k].times.size(); ++s) file->points_of_mesh(k, s);
}

// One object of `frames.size()` frames, of strands of two points.
std::string written_frames(const Scratch& scratch, const std::vector<std::vector<Vec3f>>& frames) {
    CurvesObject object;
    object.path = "/strands";
    object.counts.assign(frames[0].size() / 2, 2);
    const std::string path = scratch.path("frames.abc");
    const auto file = create_abc(path, true, {});
    file->add_curves(object);
    for (const auto& points : frames) file->append_curves(0, {points, {}, {}});
    file->finish();
    return path;
}

TEST(Alembic, strands_and_what_belongs_to_them_come_back_to_the_bit) {
    const Scratch scratch;
    const Shot shot;
    const auto file = open_abc(written(scratch, shot));
    EXPECT_EQ(file->axes().metres_per_unit, 0.01);
    EXPECT_EQ(file->axes().up, 'y');
    ASSERT_EQ(file->curves().size(), 1u);
    const CurvesObject& o = file->curves()[0];
    EXPECT_EQ(o.path, "/hair/strands");
    EXPECT_EQ(o.counts, shot.strands.counts);
    EXPECT_EQ(o.basis, CurveBasis::linear);
    EXPECT_EQ(o.widths, shot.strands.widths);
    EXPECT_EQ(o.ids, shot.strands.ids);
    EXPECT_EQ(o.groups, shot.strands.groups);
    EXPECT_EQ(o.root_uv, shot.strands.root_uv);
    EXPECT_EQ(o.is_guide, shot.strands.is_guide);
    EXPECT_EQ(o.guides, shot.strands.guides);
    EXPECT_EQ(o.weights, shot.strands.weights);
    ASSERT_EQ(o.times.size(), size_t(Shot::frames));
    for (int f = 0; f < Shot::frames; ++f) {
        EXPECT_NEAR(o.times[size_t(f)], (3 + f) / 25.0, 1e-14);  // rounding of a sum
        EXPECT_TRUE(same_bits(file->points_of_curves(0, size_t(f)), shot.curves(f).points)) << f;
    }
}

TEST(Alembic, meshes_come_back_to_the_bit_and_lie_in_the_file_clockwise) {
    const Scratch scratch;
    const Shot shot;
    const std::string path = written(scratch, shot);
    const auto file = open_abc(path);
    ASSERT_EQ(file->meshes().size(), 1u);
    const MeshObject& o = file->meshes()[0];
    EXPECT_EQ(o.path, "/body/head");
    EXPECT_EQ(o.counts, shot.mesh.counts);
    EXPECT_EQ(o.corners, shot.mesh.corners);
    EXPECT_EQ(o.points, 5u);
    ASSERT_EQ(o.times.size(), size_t(Shot::frames));
    for (int f = 0; f < Shot::frames; ++f)
        EXPECT_TRUE(same_bits(file->points_of_mesh(0, size_t(f)), shot.mesh_points(f))) << f;
    const std::vector<int> clockwise = {4, 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 3, 2, 1, 0};
    EXPECT_NE(bytes_of(path).find(std::string(reinterpret_cast<const char*>(clockwise.data()), 64)),
              std::string::npos);
}

TEST(Alembic, curves_keep_their_basis_and_objects_their_paths) {
    const Scratch scratch;
    const std::string path = scratch.path("a.abc");
    {
        const auto file = create_abc(path, false, {});
        for (CurveBasis basis :
             {CurveBasis::linear, CurveBasis::bezier, CurveBasis::b_spline, CurveBasis::catmull_rom}) {
            CurvesObject object;
            object.path = "/a/" + std::to_string(int(basis)) + "/c";
            object.counts = {4};
            object.basis = basis;
            const size_t k = file->add_curves(object);
            file->append_curves(k, {{{0, 0, 0}, {0, 1, 0}, {0, 2, 0}, {float(k), 3, 0}}, {}, {}});
        }
        file->finish();
    }
    const auto file = open_abc(path);
    ASSERT_EQ(file->curves().size(), 4u);
    for (size_t k = 0; k < 4; ++k) {
        EXPECT_EQ(file->curves()[k].path, "/a/" + std::to_string(k) + "/c");
        // The last ones go through all of their points, which is all that Alembic says of them.
        EXPECT_EQ(file->curves()[k].basis, k < 3 ? CurveBasis(k) : CurveBasis::linear);
        EXPECT_EQ(file->curves()[k].times.size(), 1u);
        EXPECT_EQ(file->points_of_curves(k, 0)[3].x, float(k));
    }
}

TEST(Alembic, pauses_are_read_as_they_were_written) {
    const Scratch scratch;
    const auto still = [](float x) { return std::vector<Vec3f>{{x, 0, 0}, {x, 1, 0}}; };
    for (const std::vector<float>& shot : std::vector<std::vector<float>>{
             {1, 1, 1}, {1, 2, 3}, {1, 1, 2, 2, 2, 3, 3}, {1, 1, 1, 2}, {1, 2, 2, 2}, {1, 2, 1, 2}}) {
        std::vector<std::vector<Vec3f>> frames;
        for (float x : shot) frames.push_back(still(x));
        const auto file = open_abc(written_frames(scratch, frames));
        const bool moves = shot[0] != shot.back() || shot[1] != shot[0];
        ASSERT_EQ(file->curves()[0].times.size(), moves ? shot.size() : 1);
        for (size_t f = 0; f < file->curves()[0].times.size(); ++f)
            EXPECT_TRUE(same_bits(file->points_of_curves(0, f), frames[f])) << f << " of " << shot.size();
    }
}

TEST(Alembic, what_stays_the_same_is_stored_once) {
    const Scratch scratch;
    constexpr size_t points = 2000, bytes = points * sizeof(Vec3f);
    std::vector<std::vector<Vec3f>> frames(1, std::vector<Vec3f>(points));
    for (size_t i = 0; i < points; ++i) frames[0][i] = {float(i), 1, 2};
    const size_t one = bytes_of(written_frames(scratch, frames)).size();
    EXPECT_GT(one, bytes);
    frames.resize(50, frames[0]);
    EXPECT_LT(bytes_of(written_frames(scratch, frames)).size(), one + 64);
    for (size_t f = 0; f < frames.size(); ++f) frames[f][0].x = float(f % 2);  // there and back
    EXPECT_LT(bytes_of(written_frames(scratch, frames)).size(), one + bytes + 50 * 64);
    // A frame: points, their bounds, and an index.
    for (size_t f = 0; f < frames.size(); ++f) frames[f][0].x = float(f);
    EXPECT_LT(bytes_of(written_frames(scratch, frames)).size(), one + 50 * (bytes + 160));
}

TEST(Alembic, memory_grows_by_an_index_alone) {
    const Scratch scratch;
    constexpr size_t points = 20000, frames = 200;
    CurvesObject object;
    object.path = "/strands";
    object.counts.assign(points / 2, 2);
    const auto file = create_abc(scratch.path("a.abc"), false, {});
    file->add_curves(object);
    CurvesFrame frame{std::vector<Vec3f>(points, Vec3f{1, 2, 3}), {}, {}};
    file->append_curves(0, frame);
    const size_t before = mallinfo2().uordblks;
    for (size_t f = 0; f < frames; ++f) {
        frame.points[7].x = float(f);
        file->append_curves(0, frame);
    }
    const size_t after = mallinfo2().uordblks;
    EXPECT_LT(after, before + frames * 512);  // points are 240,000 bytes a frame
    file->finish();
    EXPECT_GT(std::filesystem::file_size(scratch.path("a.abc")), frames * points * sizeof(Vec3f));
}

TEST(Alembic, keys_are_those_of_files_by_other_programs) {
    const auto key = [](const std::string& bytes) {
        const OgawaKey found = ogawa_key(bytes);
        std::string out;
        for (unsigned char c : std::string(reinterpret_cast<const char*>(found.data()), 16)) {
            constexpr const char* digits = "0123456789abcdef";
            out += digits[c >> 4], out += digits[c & 15];
        }
        return out;
    };
    EXPECT_EQ(key(std::string(1, '\1')), "16fe7483905cce7a85670e43e4678877");
    EXPECT_EQ(key(std::string("\3\0\0\0", 4)), "3ba1d27b7fde4848a86e865c6c402dfa");
    EXPECT_EQ(key(std::string("wetcurl\0", 8)), "64b56e507002415908852e33b0a36f9e");
    EXPECT_EQ(key(std::string("\1\0\0\0\2\0\0\0\3\0\0\0", 12)), "b55c69c3c551cf504135d724a388b34d");
    const double box[6] = {0, -2, 0, 0, 0, 0};
    EXPECT_EQ(key(std::string(reinterpret_cast<const char*>(box), sizeof box)),
              "a3508f015416bee6a28690a703c4f879");
}

TEST(Alembic, a_public_file_holds_the_strands_of_its_other_formats) {
    const std::string path = shared + "Bangs_100.abc";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "SKIP: no " << path;
    const auto file = open_abc(path);
    ASSERT_EQ(file->curves().size(), 1u);
    const CurvesObject& o = file->curves()[0];
    ASSERT_EQ(o.counts.size(), 100u);
    const std::vector<Vec3f> points = file->points_of_curves(0, 0);
    ASSERT_EQ(points.size(), 1165u);
    // .bin: strands; of each the number of points, and 7 floats a point.
    const std::string other = bytes_of(shared + "Bangs_100.bin");
    size_t at = sizeof(int), point = 0;
    for (int count : o.counts) {
        int found;
        std::memcpy(&found, other.data() + at, sizeof found);
        ASSERT_EQ(found, count);
        at += sizeof found;
        for (int i = 0; i < count; ++i, ++point, at += 7 * sizeof(float))
            ASSERT_EQ(std::memcmp(other.data() + at, &points[point], sizeof(Vec3f)), 0) << point;
    }
    EXPECT_GT(norm(points[0]), 1);
}

TEST(Alembic, what_does_not_fit_is_refused_where_it_is_given) {
    const Scratch scratch;
    const std::string path = scratch.path("a.abc");
    const auto refused = [&](const std::function<void(Shot&)>& change,
                             std::initializer_list<std::string> parts) {
        Shot shot;
        change(shot);
        expect_error([&] { shot.write(*create_abc(path, true, shot.settings)); }, parts);
        EXPECT_FALSE(std::filesystem::exists(path));
    };
    refused([](Shot& s) { s.strands.counts[2] = 1; },
            {path, "/hair/strands", "strand 2", "1 points", "2 or more"});
    refused([](Shot& s) { s.strands.widths.pop_back(); }, {path, "widths"});
    refused([](Shot& s) { s.strands.ids.pop_back(); }, {path, "ids"});
    refused([](Shot& s) { s.strands.path = "hair"; }, {path, "'hair'", "/hair/strands"});
    refused([](Shot& s) { s.mesh.path = "/hair/strands"; }, {path, "another object at /hair/strands"});
    refused([](Shot& s) { s.mesh.path = "/hair/strands/head"; }, {path, "another object at /hair/strands"});
    refused([](Shot& s) { s.mesh.corners[0] = 5; }, {path, "/body/head", "the point 5", "0 to 4"});
    refused([](Shot& s) { s.mesh.counts.back() = 5; }, {path, "face 4"});
    refused([](Shot& s) { s.mesh.points = 6, s.mesh.corners[0] = 1; }, {path, "5 points", "allowed 6"});
    refused([](Shot& s) { s.settings.for_unreal = true; }, {path, "/body/head", "a mesh"});
    expect_error<Misuse>([&] { create_abc(path, true, {.fps = 0}); }, {path, "frames a second"});
    expect_error<Misuse>([&] { create_abc(path, true, {.first_frame = -1}); }, {path, "first frame", "-1"});

    const Shot shot;
    const auto broken = [&](const std::function<void(CurvesFrame&)>& change,
                            std::initializer_list<std::string> parts) {
        const auto file = create_abc(path, true, shot.settings);
        file->add_curves(shot.strands);
        file->append_curves(0, shot.curves(0));
        CurvesFrame frame = shot.curves(1);
        change(frame);
        expect_error([&] { file->append_curves(0, frame); }, parts);
    };
    broken([](CurvesFrame& f) { f.points[3].y = NAN; },
           {path, "/hair/strands", "frame 1", "point 3", "finite"});
    broken([](CurvesFrame& f) { f.points[3].y = -INFINITY; }, {path, "frame 1", "point 3"});
    broken([](CurvesFrame& f) { f.velocities[5].z = NAN; }, {path, "frame 1", "velocity 5", "finite"});
    broken([](CurvesFrame& f) { f.wetness[4] = INFINITY; }, {path, "frame 1", "wetness 4", "finite"});
    broken([](CurvesFrame& f) { f.points.pop_back(); }, {path, "frame 1", "points"});
    broken([](CurvesFrame& f) { f.velocities.clear(); }, {path, "frame 1", "0 velocities"});
    broken([](CurvesFrame& f) { f.wetness.pop_back(); }, {path, "frame 1", "wetness"});
    {
        const auto file = create_abc(path, true, shot.settings);
        file->add_curves(shot.strands);
        expect_error([&] { file->finish(); }, {path, "/hair/strands", "0 frames"});
    }
    EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(Alembic, foreign_and_unfinished_files_are_refused_with_the_way_out) {
    const Scratch scratch;
    const auto refused = [&](const std::string& bytes, std::initializer_list<std::string> parts) {
        const std::string path = scratch.file("a.abc", bytes);
        expect_error([&] { open_abc(path); }, {path});
        expect_error([&] { open_abc(path); }, parts);
    };
    expect_error([&] { open_abc(scratch.path("none.abc")); }, {"none.abc", "no such file"});
    expect_error([&] { open_abc(scratch.path()); }, {"no plain file"});
    refused("", {"an empty file"});
    refused("solid nothing of the kind", {"\"Ogawa\""});
    refused(std::string("\x89HDF\r\n\x1a\n", 8) + std::string(100, '\0'), {"HDF5", "abcconvert -toOgawa"});
    refused("version https://git-lfs.github.com/spec/v1\noid sha256:0123\nsize 12345678\n", {"git lfs pull"});
    std::string good = bytes_of(written(scratch, Shot()));
    good[5] = 0;
    refused(good, {"ended early"});
    good[5] = char(0xff), good[7] = 2;
    refused(good, {"version 1"});
}

// A file as numbers of 8 bytes: places of groups and what they list.
struct Words {
    std::string bytes;
    uint64_t at(uint64_t place) const {
        uint64_t word;
        std::memcpy(&word, bytes.data() + place, sizeof word);
        return word;
    }
    void set(uint64_t place, uint64_t word) { std::memcpy(bytes.data() + place, &word, sizeof word); }
    uint64_t root() const { return at(8); }
    static uint64_t child(uint64_t group, uint64_t index) { return group + 8 * (1 + index); }
};

TEST(Alembic, circles_and_absurd_counts_are_refused) {
    const Scratch scratch;
    const std::string good = bytes_of(written(scratch, Shot()));
    const auto refused = [&](const std::function<void(Words&)>& change,
                             std::initializer_list<std::string> parts) {
        Words words{good};
        change(words);
        const std::string path = scratch.file("bad.abc", words.bytes);
        expect_error([&] { read_all(path); }, parts);
    };
    constexpr uint64_t block_bit = uint64_t(1) << 63;
    // Child 2 of the root is the top object; its child 1 is the first object below.
    refused(
        [](Words& w) {
            const uint64_t top = w.at(w.child(w.root(), 2));
            w.set(w.child(top, 1), top);
        },
        {"bad.abc", "circle"});
    refused([](Words& w) { w.set(w.root(), uint64_t(1) << 60); }, {"bad.abc", "root group", "a group of"});
    refused([](Words& w) { w.set(8, w.bytes.size() + 8); }, {"bad.abc", "cut short?"});
    refused([](Words& w) { w.set(8, uint64_t(1) << 62); }, {"bad.abc", "cut short?"});
    refused([&](Words& w) { w.set(8, w.root() | block_bit); }, {"bad.abc", "a block"});
    refused([&](Words& w) { w.set(w.at(w.child(w.root(), 4)) & ~block_bit, uint64_t(1) << 50); },
            {"bad.abc", "time samplings", "a block of"});
}

TEST(Alembic, a_file_cut_short_anywhere_is_refused) {
    const Scratch scratch;
    const std::string good = bytes_of(written(scratch, Shot()));
    ASSERT_GT(good.size(), 5000u);
    for (size_t length = 0; length < good.size(); length += length + 97 < good.size() ? 97 : 1) {
        const std::string path = scratch.file("cut.abc", good.substr(0, length));
        EXPECT_THROW(read_all(path), Error) << length;
    }
}

TEST(Alembic, damaged_bytes_are_read_or_refused_and_nothing_else) {
    const Scratch scratch;
    const std::string good = bytes_of(written(scratch, Shot()));
    set_log_level(LogLevel::error);  // objects that are left out
    size_t refused = 0, tried = 0;
    const auto attempt = [&](const std::string& bytes) {
        const std::string path = scratch.file("damaged.abc", bytes);
        ++tried;
        try {
            read_all(path);
        } catch (const Error& e) {
            ++refused;
            EXPECT_NE(std::string(e.what()).find(path), std::string::npos) << e.what();
        }
    };
    for (size_t at = 0; at < good.size(); at += 29)
        for (unsigned char flipped : {0xff, 0x01}) {
            std::string bytes = good;
            bytes[at] = char(bytes[at] ^ flipped);
            attempt(bytes);
        }
    // Groups and headers stand in the last part.
    Random random(1);
    const double headers = double(good.size()) - 6000;
    for (int k = 0; k < 1000; ++k) {
        std::string bytes = good;
        for (int n = 0; n < 3; ++n)
            bytes[size_t(random.number(headers, double(good.size()) - 1))] = char(random.number(0, 255));
        attempt(bytes);
    }
    set_log_level(LogLevel::info);
    EXPECT_GT(refused, tried / 10);
    EXPECT_LT(refused, tried);
}

TEST(SceneFile, endings_choose_the_format) {
    const Scratch scratch;
    const std::string path = scratch.path("A.ABC");
    const Shot shot;
    shot.write(*create_scene_file(path, false, shot.settings));
    EXPECT_EQ(open_scene_file(path)->curves().size(), 1u);
    expect_error<Misuse>([&] { open_scene_file("a.fbx"); }, {"a.fbx", "'.fbx'", ".abc"});
    expect_error<Misuse>([&] { create_scene_file("a.fbx", false, {}); }, {"a.fbx", "'.fbx'", ".abc"});
    expect_error([&] { create_scene_file(path, false, {}); }, {path, "--overwrite"});
}

}  // namespace
}  // namespace wetcurl

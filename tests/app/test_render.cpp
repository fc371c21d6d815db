// `wetcurl render` on small runs: what is written, and what is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "app/commands/render.h"
#include "base/error.h"
#include "base/run_cache.h"

namespace wetcurl {
namespace {

namespace fs = std::filesystem;

// A folder of its own for each test, with a run of four strands that fall for three frames beside a sphere.
class render : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ =
            fs::temp_directory_path() / (std::string("wetcurl_render_") +
                                         ::testing::UnitTest::GetInstance()->current_test_info()->name());
        fs::remove_all(folder_);
        fs::create_directories(folder_);
        write_run("run.h5", 3);
        options_.runs = {path("run.h5")};
        options_.width = 96, options_.height = 120;
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    void write_run(const std::string& name, int frames) const {
        RunHeader header;
        header.scene =
            "[groom]\ngrid = [2, 2]\nparticles = 8\n[[solid]]\nshape = \"sphere\"\nradius = 0.05\nattached = "
            "\"head\"\n";
        header.scene_folder = folder_.string();
        header.method = "simulated dry";
        header.groom.rest = Strands(4, 8);
        for (int s = 0; s < 4; ++s)
            for (int i = 0; i < 8; ++i) header.groom.rest.at(s, i) = {0.06f + 0.005f * s, -0.01f * i, 0};
        header.groom.normal.assign(4, {1, 0, 0});
        header.groom.grid = {2, 2, {0, 1, 2, 3}};
        RunWriter writer(path(name), header, true);
        for (int f = 0; f < frames; ++f) {
            RunFrame frame;
            frame.positions = header.groom.rest;
            for (Vec3f& x : frame.positions.points) x.y -= 0.01f * f;
            writer.append(frame);
        }
        writer.commit();
    }

    // Draws, or skips the test where there is nothing to draw with.
    bool drawn() {
        try {
            EXPECT_EQ(render_command(options_), 0);
            return true;
        } catch (const Error& e) {
            if (std::string(e.what()).find("OpenCV") == std::string::npos) throw;
            return false;
        }
    }

    // Message of the error that the command ends with.
    template <class Kind>
    std::string refusal() {
        try {
            render_command(options_);
        } catch (const Kind& e) {
            return e.what();
        }
        return "none";
    }

    fs::path folder_;
    RenderOptions options_;
};

TEST_F(render, runs_stand_side_by_side_in_one_png) {
    options_.runs = {path("run.h5"), path("run.h5"), path("run.h5")};
    options_.output = path("new/folder/out.png");
    if (!drawn()) GTEST_SKIP() << "SKIP: built without OpenCV";
    std::ifstream file(options_.output, std::ios::binary);
    std::vector<unsigned char> head(24);
    file.read(reinterpret_cast<char*>(head.data()), 24);
    ASSERT_TRUE(file);
    EXPECT_EQ(head[18] * 256 + head[19], 3 * 96);
    EXPECT_EQ(head[22] * 256 + head[23], 120);
    EXPECT_GT(fs::file_size(options_.output), 2000u);  // more than an even grey
    EXPECT_FALSE(fs::exists(options_.output + ".partial"));
}

TEST_F(render, a_video_is_written_in_the_best_format_there_is) {
    options_.output = path("out.mp4");
    if (!drawn()) GTEST_SKIP() << "SKIP: built without OpenCV";
    const bool mp4 = fs::exists(path("out.mp4")), webm = fs::exists(path("out.webm")),
               pictures = fs::exists(path("out_frames"));
    EXPECT_EQ(mp4 + webm + pictures, 1);
    if (mp4) {
        std::ifstream file(path("out.mp4"), std::ios::binary);
        const std::string bytes((std::istreambuf_iterator<char>(file)), {});
        EXPECT_NE(bytes.find("avc1"), std::string::npos);  // what browsers play
    }
    EXPECT_FALSE(fs::exists(path("out.partial.mp4")));
}

TEST_F(render, an_output_that_is_there_is_not_replaced_unasked) {
    options_.output = path("out.png");
    std::ofstream(options_.output) << "mine";
    EXPECT_NE(refusal<Error>().find("--overwrite"), std::string::npos);
    EXPECT_EQ(fs::file_size(options_.output), 4u);
    options_.overwrite = true;
    if (!drawn()) GTEST_SKIP() << "SKIP: built without OpenCV";
    EXPECT_GT(fs::file_size(options_.output), 1000u);
}

TEST_F(render, misuse_says_what_is_allowed) {
    options_.output = path("out.gif");
    EXPECT_NE(refusal<Misuse>().find(".png, .mp4 and .webm"), std::string::npos);
    options_.output = path("out.png");
    options_.frame = 3;
    EXPECT_NE(refusal<Misuse>().find("0 to 2"), std::string::npos);
    options_.output = path("out.mp4");
    EXPECT_NE(refusal<Misuse>().find("--frame"), std::string::npos);
    options_.frame = -1;
    options_.view.yaw = std::nan("");
    EXPECT_NE(refusal<Misuse>().find("-360 to 360"), std::string::npos);
    options_.view.yaw = 30;
    options_.width = 0;
    EXPECT_NE(refusal<Misuse>().find("16 to 8192"), std::string::npos);
    EXPECT_FALSE(fs::exists(path("out.png")));
}

TEST_F(render, a_run_that_is_missing_or_empty_is_named) {
    options_.output = path("out.png");
    options_.runs = {path("absent.h5")};
    EXPECT_NE(refusal<Error>().find("absent.h5"), std::string::npos);
    write_run("empty.h5", 0);
    options_.runs = {path("empty.h5")};
    EXPECT_NE(refusal<Error>().find("empty.h5"), std::string::npos);
    EXPECT_FALSE(fs::exists(options_.output));
}

}  // namespace
}  // namespace wetcurl

// `wetcurl render` on small runs: what is written, and what is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "app/commands/render.h"
#include "base/error.h"
#include "base/run_cache.h"
#ifdef WETCURL_HAVE_OPENCV
#include <opencv2/imgcodecs.hpp>
#endif

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

    // expected_mm: what a network expects strand s to err by, times s; 0: no network says so.
    void write_run(const std::string& name, int frames, float expected_mm = 0) const {
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
            for (int piece = 0; expected_mm > 0 && piece < 4 * 2; ++piece)
                frame.expected_error.push_back(1e-3f * expected_mm * float(piece / 2));
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

TEST_F(render, strands_show_the_error_that_is_expected_of_them) {
    options_.output = path("out.png"), options_.expected_error = true;
    EXPECT_NE(refusal<Error>().find("run.h5: --expected-error: no run here says"), std::string::npos);
    options_.saturation = true;
    EXPECT_NE(refusal<Misuse>().find("allowed is one of them"), std::string::npos);
    options_.saturation = false;
    // Beside one that says nothing, which keeps hair's colour.
    write_run("told.h5", 3, 3.3f);
    options_.runs = {path("run.h5"), path("told.h5")};
    options_.labels = false;
#ifdef WETCURL_HAVE_OPENCV
    EXPECT_TRUE(drawn());
    const cv::Mat image = cv::imread(options_.output);
    ASSERT_EQ(image.cols, 2 * 96);
    int red[2] = {0, 0}, blue[2] = {0, 0};
    for (int row = image.rows / 2; row < image.rows; ++row)  // below the scale
        for (int column = 0; column < image.cols; ++column) {
            const auto pixel = image.at<cv::Vec3b>(row, column);
            const int b = pixel[0], g = pixel[1], r = pixel[2];
            red[column / 96] += r > g + 60 && r > b + 60;
            blue[column / 96] += b > r + 60 && b > g + 60;
        }
    EXPECT_EQ(red[0] + blue[0], 0);
    EXPECT_GT(red[1], 5);   // 9.9 mm of a scale that ends at 10
    EXPECT_GT(blue[1], 5);  // none
#else
    GTEST_SKIP() << "SKIP: built without OpenCV";
#endif
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

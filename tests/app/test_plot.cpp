// `wetcurl plot`: ticks, where a curve is drawn, what is refused.
// Ours.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "app/chart.h"
#include "app/commands.h"
#include "base/error.h"
#include "base/run_cache.h"
#include "tests/base/scratch.h"

namespace wetcurl {
namespace {

TEST(Ticks, are_round_and_within_and_few) {
    EXPECT_EQ(ticks_between(-0.03, 0.041, 4), (std::vector<double>{-0.02, 0, 0.02, 0.04}));
    EXPECT_EQ(ticks_between(0, 10, 5), (std::vector<double>{0, 2, 4, 6, 8, 10}));
    EXPECT_TRUE(ticks_between(1, 1, 5).empty());
}

TEST(Chart, draws_a_curve_where_its_values_lie) {
    const Vec3f red{1, 0, 0};
    Image image;
    try {
        image = draw_charts({{"a", "x", "y", 1, {{"flat", red, {2, 2, 2}}}}}, 300, 240);
    } catch (const Error&) {
        GTEST_SKIP() << "SKIP: built without OpenCV";
    }
    EXPECT_GT(image.width, 300);  // the legend
    // At 2 of 0 to 2.08, halfway along: near the top, and nowhere else in that column.
    int rows = 0, highest = image.height;
    for (int row = 0; row < image.height; ++row)
        if (image.pixel(170, row)[0] > 0.9f && image.pixel(170, row)[1] < 0.3f)
            ++rows, highest = std::min(highest, row);
    EXPECT_GE(rows, 1);
    EXPECT_LE(rows, 3);
    EXPECT_GT(highest, 24);
    EXPECT_LT(highest, 45);
}

TEST(Plot, refuses_what_has_no_energy_and_what_is_no_png) {
    const auto folder = std::filesystem::temp_directory_path() / "wetcurl_plot";
    std::filesystem::create_directories(folder);
    const std::string run = (folder / "run.h5").string();
    RunHeader header;
    header.scene = "[groom]\n";
    header.groom.rest = Strands(1, 2);
    header.groom.normal.assign(1, {1, 0, 0});
    header.groom.grid = {1, 1, {0}};
    RunWriter writer(run, header, true);
    RunFrame frame;
    frame.positions = header.groom.rest;
    for (int f = 0; f < 2; ++f) writer.append(frame);
    writer.commit();
    PlotOptions options;
    options.runs = {run}, options.output = (folder / "energy.png").string();
    EXPECT_THROW(plot_command(options), Error);
    options.output = (folder / "energy.pdf").string();
    EXPECT_THROW(plot_command(options), Misuse);
    std::ofstream(folder / "log.jsonl") << "{\"epoch\":1,\"loss\":2}\n{\"epoch\":2}\n";
    options.output = (folder / "loss.png").string(), options.runs = {(folder / "log.jsonl").string()};
    testing::expect_error([&] { plot_command(options); }, {"log.jsonl:2", "log"});
    options.runs.push_back(run);
    std::ofstream(folder / "log.jsonl") << "{\"epoch\":1,\"loss\":2}\n{\"epoch\":2,\"loss\":1}\n";
    EXPECT_THROW(plot_command(options), Misuse);
    options.runs = {(folder / "absent.jsonl").string()};
    testing::expect_error([&] { plot_command(options); }, {"absent.jsonl: cannot be read"});
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace wetcurl

// `wetcurl plot`: ticks, where a curve is drawn, what the charts hold, what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "app/commands/plot.h"
#include "app/drawing/chart.h"
#include "app/drawing/chart_file.h"
#include "app/drawing/plot_charts.h"
#include "base/error.h"
#include "base/run_cache.h"
#include "learn/codec/network_module.h"
#include "solver/terms/adhesion.h"
#include "tests/base/scratch.h"
#include "tests/training/make_pairs.h"

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

TEST(ChartFile, holds_curves_with_gaps_and_says_what_is_wrong) {
    testing::Scratch scratch;
    const std::string head = R"({"title": "a", "x_label": "x", "y_label": "y [mm]", "dx": 0.5, "curves": )";
    const Chart chart = chart_of_file(scratch.file(
        "a.json",
        head + R"([{"name": "one", "values": [1, 2.5]}, {"name": "two", "values": [3, null, 4]}]})"));
    EXPECT_EQ(chart.y_label, "y [mm]");
    EXPECT_EQ(chart.dx, 0.5);
    ASSERT_EQ(chart.curves.size(), 2u);
    EXPECT_EQ(chart.curves[0].values, (std::vector<double>{1, 2.5}));
    EXPECT_TRUE(std::isnan(chart.curves[1].values[1]));
    EXPECT_GT(norm(chart.curves[0].color - chart.curves[1].color), 0.3f);
    const std::pair<std::string, std::string> wrong[] = {
        {"no JSON", "is no chart"},
        {R"({"title": "a"})", "x_label"},
        {head + R"([{"name": "one", "values": [1]}]})", "two values"},
        {head + R"([{"name": "one", "values": [1, "2"]}]})", "is no chart"}};
    for (const auto& [text, said] : wrong)
        testing::expect_error([&, &text = text] { chart_of_file(scratch.file("b.json", text)); },
                              {"b.json", said});
}

TEST(Ticks, of_a_logarithmic_axis_are_ones_twos_and_fives) {
    EXPECT_EQ(log_ticks_between(0.9, 11), (std::vector<double>{1, 2, 5, 10}));
    EXPECT_EQ(log_ticks_between(0.5, 2000), (std::vector<double>{1, 10, 100, 1000}));
    EXPECT_EQ(round_above(3.1), 5);
    EXPECT_EQ(round_above(0.02), 0.02);
    EXPECT_EQ(round_above(0), 0.001);
}

// Row of the pixel of that colour in a column, or -1.
int row_of(const Image& image, int column, const Vec3f& color) {
    for (int row = 0; row < image.height; ++row) {
        const float* p = image.pixel(column, row);
        if (std::abs(p[0] - color.x) + std::abs(p[1] - color.y) + std::abs(p[2] - color.z) < 0.1f) return row;
    }
    return -1;
}

TEST(Chart, of_its_own_logarithmic_axis_shows_small_values_as_clearly) {
    const Vec3f red{1, 0, 0}, green{0, 1, 0};
    Chart large{"a", "x", "y", 1, {{"one", red, {1e3, 1e3, 1e3}}, {"two", green, {10, 10, 10}}}, true, true};
    large.curves.push_back({"between", {0, 0, 1}, {100, 100, 100}});
    Chart small{"b", "x", "y", 1, {{"one", red, {1, 1, 1}}, {"two", green, {0.01, 0, 0.01}}}, true, true};
    Image image;
    try {
        image = draw_charts({large, small}, 400, 400);
    } catch (const Error&) {
        GTEST_SKIP() << "SKIP: built without OpenCV";
    }
    // Two decades apart in both, so where the axes are their own they lie alike.
    const int first = row_of(image, 230, red), second = row_of(image, 630, red);
    EXPECT_GT(first, 0);
    EXPECT_EQ(first, second);
    const int lower = row_of(image, 230, green);
    EXPECT_GT(lower, first + 200);
    EXPECT_NEAR(row_of(image, 230, {0, 0, 1}), (first + lower) / 2, 1);  // a decade from both
    // 0 is not on the axis: a gap, and what is beside it are dots.
    EXPECT_EQ(row_of(image, 630, green), -1);
    int dot = 0;
    for (int row = lower - 3; row <= lower + 3; ++row)
        for (int column = 400 + 64; column <= 400 + 69; ++column) {
            const float* p = image.pixel(column, row);
            dot += p[1] > 0.7f && p[0] < 0.4f && p[2] < 0.4f;
        }
    EXPECT_GE(dot, 1);
    EXPECT_LE(dot, 9);
}

TEST(Chart, draws_dashes_dots_and_bars) {
    const Vec3f red{1, 0, 0}, blue{0, 0, 1};
    Chart chart{"a", "x", "y", 1, {}};
    chart.curves = {{"dashed", red, {1, 1}, 2, {0, 4}, true}};
    chart.scatters = {{"points", blue, {2, 2, 2, 3}, {0.5, 0.5, 0.5, 0.5}}};
    Chart bars{"b", "x", "", 1, {}};
    bars.bars = {{"first", 2, red}, {"second", 1, blue}};
    Image image;
    try {
        image = draw_charts({chart, bars}, 400, 400);
    } catch (const Error&) {
        GTEST_SKIP() << "SKIP: built without OpenCV";
    }
    int on = 0, off = 0, deep = 0, faint = 0, reds = 0, blues = 0;
    for (int column = 80; column < 370; ++column) {
        const bool drawn = row_of(image, column, red) > 0;
        (drawn ? on : off)++;
    }
    for (int row = 0; row < 400; ++row)
        for (int column = 0; column < 785; ++column) {  // the legend lies beyond
            const float* p = image.pixel(column, row);
            const bool pure = p[0] < 0.05f && p[1] < 0.05f && p[2] > 0.95f;
            if (column < 400)
                deep += pure, faint += p[2] > 0.95f && p[0] > 0.5f && p[0] < 0.9f && p[1] == p[0];
            if (column >= 400) blues += pure, reds += p[0] > 0.95f && p[1] < 0.05f;
        }
    EXPECT_GT(on, 100);
    EXPECT_GT(off, 60);
    EXPECT_EQ(deep, 9);  // three of the four points in one place
    EXPECT_GE(faint, 9);
    EXPECT_NEAR(double(reds) / blues, 2, 0.05);
}

// A run whose frames' times are its own: frame 0 took none.
std::string write_times(const std::string& path, const std::vector<std::string>& stages, float scale) {
    RunHeader header;
    header.scene = "[groom]\n";
    header.groom.rest = Strands(1, 2);
    header.groom.normal.assign(1, {1, 0, 0});
    header.groom.grid = {1, 1, {0}};
    header.stages = stages;
    RunWriter writer(path, header, true);
    RunFrame frame;
    frame.positions = header.groom.rest;
    for (int f = 0; f < 5; ++f) {
        frame.stage_seconds.clear(), frame.seconds = 0;
        for (size_t k = 0; k < stages.size(); ++k) {
            // The first did nothing but read the clock.
            frame.stage_seconds.push_back(scale * float(f) * (k == 0 ? 1e-6f : float(k)));
            frame.seconds += double(frame.stage_seconds.back());
        }
        writer.append(frame);
    }
    writer.commit();
    return path;
}

TEST(PlotTime, has_the_file_s_numbers_and_their_medians) {
    testing::Scratch scratch;
    std::vector<std::unique_ptr<RunReader>> runs;
    runs.push_back(std::make_unique<RunReader>(
        write_times(scratch.path("slow.h5"), {"none", "air", "strands"}, 0.002f)));
    runs.push_back(
        std::make_unique<RunReader>(write_times(scratch.path("fast.h5"), {"none", "strands"}, 0.001f)));
    auto charts = time_charts(runs);
    ASSERT_EQ(charts.size(), 2u);
    for (size_t r = 0; r < 2; ++r) {
        EXPECT_FALSE(charts[r].own_axes);
        EXPECT_FALSE(charts[r].logarithmic);  // 1 to 15 ms: see below
        const auto& stages = runs[r]->header().stages;
        ASSERT_EQ(charts[r].curves.size(), stages.size());  // the whole, and none of what took no time
        for (const Curve& curve : charts[r].curves) {
            ASSERT_EQ(curve.values.size(), 5u);
            EXPECT_FALSE(std::isfinite(curve.values[0]));
            size_t stage = 0;
            while (stage < stages.size() && !curve.name.starts_with(stages[stage])) ++stage;
            for (int f = 1; f < 5; ++f) {
                const RunFrame frame = runs[r]->frame(f);
                EXPECT_DOUBLE_EQ(
                    curve.values[size_t(f)],
                    1e3 * (stage < stages.size() ? double(frame.stage_seconds[stage]) : frame.seconds))
                    << curve.name;
            }
        }
    }
    // Medians of frames 1 to 4: 2.5 times.
    EXPECT_EQ(charts[0].title, "slow: 15 ms a frame (median)");
    EXPECT_EQ(charts[0].curves[1].name, "strands, 10 ms");
    EXPECT_EQ(charts[0].curves[2].name, "air, 5 ms");
    EXPECT_EQ(charts[1].curves[1].name, "strands, 2.5 ms");
    EXPECT_EQ(charts[0].curves[1].color.x, charts[1].curves[1].color.x);

    runs.push_back(
        std::make_unique<RunReader>(write_times(scratch.path("tiny.h5"), {"none", "strands"}, 1e-4f)));
    for (const Chart& chart : time_charts(runs)) EXPECT_TRUE(chart.logarithmic);

    runs.push_back(
        std::make_unique<RunReader>(write_times(scratch.path("still.h5"), {"none", "strands"}, 0)));
    testing::expect_error([&] { time_charts(runs); }, {"still.h5", "5 frames without run times", "--time"});
}

TEST(PlotTraining, is_in_millimetres_where_the_log_has_them_and_on_its_own_axis) {
    testing::Scratch scratch;
    const std::string log = scratch.file(
        "net.h5.jsonl",
        "{\"epoch\":1,\"loss\":4}\n{\"epoch\":2,\"loss\":2,\"training_mm\":3.5,\"validation_mm\":5,"
        "\"base_mm\":8}\n{\"epoch\":3,\"loss\":1}\n{\"epoch\":4,\"loss\":1,\"training_mm\":2.5,"
        "\"validation_mm\":4.5,\"base_mm\":8}\n");
    const Chart chart = training_chart(read_training_log(log));
    EXPECT_TRUE(chart.own_axes);
    EXPECT_TRUE(chart.logarithmic);
    EXPECT_EQ(chart.y_label, "mean error [mm]");
    EXPECT_EQ(chart.title, "net: held out 4.5 mm at best");
    ASSERT_EQ(chart.curves.size(), 3u);
    EXPECT_EQ(chart.curves[0].values, (std::vector<double>{3.5, 2.5}));
    EXPECT_EQ(chart.curves[1].values, (std::vector<double>{5, 4.5}));
    EXPECT_EQ(chart.curves[1].x, (std::vector<double>{2, 4}));
    EXPECT_EQ(chart.curves[2].values, (std::vector<double>{8, 8}));

    scratch.file("adhesion.h5.jsonl",
                 "{\"epoch\":1,\"loss\":0.25}\n{\"epoch\":2,\"loss\":0.16,\"validation_loss\":1,"
                 "\"validation_nrmse\":0.3,\"base_nrmse\":0.7}\n");
    const TrainingLog adhesion = read_training_log(scratch.path("adhesion.h5.jsonl"));
    EXPECT_EQ(adhesion.unit, "sigma m a_max");
    EXPECT_EQ(adhesion.series[0].value, (std::vector<double>{0.5, 0.4}));
    EXPECT_EQ(adhesion.least("held out"), 0.3);

    scratch.file("old.jsonl", "{\"epoch\":1,\"loss\":3}\n{\"epoch\":2,\"loss\":2}\n");
    EXPECT_EQ(read_training_log(scratch.path("old.jsonl")).label(), "loss [1]");
    scratch.file("short.jsonl", "{\"epoch\":1,\"loss\":3}\n");
    testing::expect_error([&] { read_training_log(scratch.path("short.jsonl")); },
                          {"short.jsonl", "1 epochs"});
    testing::expect_error([&] { read_training_log(scratch.path("no.jsonl")); },
                          {"no.jsonl", "cannot be read"});
}

TEST(PlotAdhesion, shows_the_network_s_answers_beside_targets_and_eq_11) {
    testing::Scratch scratch;
    const std::string path = testing::make_adhesion_pairs(scratch.path("pairs.h5"), 500),
                      model = WETCURL_SOURCE_DIR "/models/weights/adhesion_scene15.h5";
    const PairsReader pairs(path);
    const auto network = network_module().load(model, "cpu", 1);
    const auto charts = adhesion_charts(pairs, *network, model);
    ASSERT_EQ(charts.size(), 3u);
    const auto samples = pairs.adhesion(0);
    const auto layers = network->layers();
    ASSERT_TRUE(layers);
    // Free ones, then those in contact: one in ten.
    size_t at[2] = {0, 0};
    const Scatter *free = &charts[0].scatters[0], *held = &charts[0].scatters[1];
    ASSERT_EQ(held->x.size(), 50u);
    for (const auto& s : samples) {
        const Scatter& to = s.contact ? *held : *free;
        const size_t k = at[s.contact]++;
        ASSERT_EQ(to.x[k], double(s.target));
        ASSERT_NEAR(to.y[k], layers->evaluate(s.input.data()), 1e-5);
    }
    const Curve& eq11 = charts[1].curves[1];
    EXPECT_EQ(eq11.name, "Eq 11");
    for (size_t k = 0; k < eq11.x.size(); k += 20) {
        double value, slope;
        Adhesion::shape(eq11.x[k], value, slope);
        EXPECT_DOUBLE_EQ(eq11.values[k], -value);
    }
    EXPECT_LT(*std::min_element(eq11.values.begin(), eq11.values.end()), -0.99);
    // In contact its own contact is always 1, and so worth nothing; all else does something.
    ASSERT_EQ(charts[2].bars.size(), 12u);
    for (const Bar& bar : charts[2].bars) {
        if (bar.name == "contact of i")
            EXPECT_EQ(bar.value, 0);
        else
            EXPECT_GT(bar.value, 0) << bar.name;
    }

    PlotOptions options;
    options.runs = {path}, options.output = scratch.path("o.png");
    testing::expect_error<Misuse>([&] { plot_command(options); }, {"pairs.h5", "--model"});
    options.model = WETCURL_SOURCE_DIR "/models/weights/strand_m.h5";
    testing::expect_error([&] { plot_command(options); }, {"strand_m.h5", "codec strand", "adhesion"});
    options.runs = {testing::make_root_pairs(scratch.path("roots.h5"), 1)}, options.model = model;
    testing::expect_error([&] { plot_command(options); }, {"roots.h5", "codec root", "render --image"});
    options.runs = {model}, options.model = "";
    testing::expect_error<Misuse>([&] { plot_command(options); }, {"adhesion_scene15.h5", "is a model"});
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
    std::ofstream(folder / "chart.json") << "{}";
    options.runs[1] = (folder / "chart.json").string();
    testing::expect_error<Misuse>([&] { plot_command(options); }, {"chart.json", "one kind"});
    options.runs = {(folder / "absent.jsonl").string()};
    testing::expect_error([&] { plot_command(options); }, {"absent.jsonl: cannot be read"});
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace wetcurl

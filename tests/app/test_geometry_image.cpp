// Geometry images: what is drawn where, of runs, pairs and models, and what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "app/commands/render.h"
#include "app/drawing/geometry_film.h"
#include "learn/codec/doubled_image.h"
#include "learn/codec/encode_runs.h"
#include "learn/codec/network_module.h"
#include "tests/base/scratch.h"
#include "tests/training/make_pairs.h"

namespace wetcurl {
namespace {

using testing::expect_error;
using testing::Scratch;

uint8_t byte_of(float x) { return uint8_t(std::lround(255 * std::clamp(x, 0.f, 1.f))); }

// 2 x 3 pixels of distinct colours, the last without data.
GeometryPanel small_panel() {
    GeometryPanel p;
    p.height = 2, p.width = 3;
    for (int k = 0; k < 18; ++k) p.values.push_back(0.05f * float(k));
    p.mask = {1, 1, 1, 1, 1, 0};
    return p;
}

TEST(GeometryImage, is_enlarged_by_whole_pixels_that_keep_their_colour) {
    const GeometryPanel p = small_panel();
    const Image image = enlarged(p, 7);
    ASSERT_EQ(image.width, 21);
    ASSERT_EQ(image.height, 14);
    for (int row = 0; row < 14; ++row)
        for (int column = 0; column < 21; ++column)
            for (int c = 0; c < 3; ++c) {
                const int pixel = row / 7 * 3 + column / 7;
                const float wanted = pixel == 5 ? neutral_grey(column, row) : p.values[size_t(c * 6 + pixel)];
                ASSERT_EQ(byte_of(image.pixel(column, row)[c]), byte_of(wanted)) << column << " " << row;
            }
    // Stripes: no single colour stands for no data.
    EXPECT_NE(image.pixel(14, 7)[0], image.pixel(20, 7)[0]);
}

TEST(GeometryImage, shows_values_about_a_middle_and_no_further_than_its_colours_go) {
    GeometryPanel p = small_panel();
    p.middle = 0.5f, p.gain = -2;
    EXPECT_FLOAT_EQ(p.colour(0, 2), 0.5f - 2 * 0.1f);
    EXPECT_EQ(p.colour(2, 0), 0);
    p.gain = 2;
    EXPECT_EQ(p.colour(2, 0), 1);
}

TEST(GeometryImage, padding_is_left_out_but_for_one_row_and_column) {
    GeometryPanel p;
    p.height = 5, p.width = 6;
    for (int k = 0; k < 90; ++k) p.values.push_back(0.01f * float(k));
    p.mask.assign(30, 0);
    p.mask[0 * 6 + 2] = p.mask[1 * 6 + 0] = 1;
    const GeometryPanel cut = without_padding(p);
    ASSERT_EQ(cut.height, 3);
    ASSERT_EQ(cut.width, 4);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column) {
            const size_t to = size_t(row * 4 + column), from = size_t(row * 6 + column);
            EXPECT_EQ(cut.mask[to], p.mask[from]);
            for (size_t c = 0; c < 3; ++c) EXPECT_EQ(cut.values[c * 12 + to], p.values[c * 30 + from]);
        }
    EXPECT_EQ(without_padding(small_panel()).width, 3);
    p.mask.assign(30, 0);
    EXPECT_EQ(without_padding(p).height, 5);
}

TEST(GeometryImage, panels_are_at_least_as_large_as_asked_and_all_alike) {
    EXPECT_EQ(enlargement(32, 32, 400), 13);
    EXPECT_EQ(enlargement(64, 128, 400), 7);
    EXPECT_EQ(enlargement(1000, 500, 400), 1);
    EXPECT_EQ(enlargement(1, 4096, 400), 2);  // no picture wider than 8192
    GeometryPanel low = small_panel(), high = small_panel();
    low.height = low.width = 32, high.height = high.width = 64;
    for (auto* p : {&low, &high}) {
        p->values.assign(3 * p->pixels(), 0.25f), p->mask.assign(p->pixels(), 1);
        p->caption = {"one", "two"};
    }
    Image image;
    try {
        image = draw_geometry({low, high}, least_panel);
    } catch (const Error&) {
        GTEST_SKIP() << "SKIP: built without OpenCV";
    }
    // 448 pixels each: 14 and 7 times.
    EXPECT_EQ(image.width, 2 * 448 + 3 * (448 / 24));
    EXPECT_GT(image.height, 448 + 2 * 12);
    int data = 0, letters = 0;
    for (int row = 0; row < image.height; ++row)
        for (int column = 0; column < image.width; ++column) {
            data += image.pixel(column, row)[0] == 0.25f;
            letters += row > 448 + 448 / 24 && image.pixel(column, row)[0] < 0.5f;
        }
    EXPECT_EQ(data, 2 * 448 * 448);
    EXPECT_GT(letters, 50);
}

TEST(GeometryImage, doubles_as_networks_do) {
    const float image[2 * 3] = {0, 2, 6, 4, 8, 16};  // 2 rows of 3
    const auto out = doubled_image(image, 1, 2, 3);
    // Even ones are kept; odd ones are means; the last is extrapolated.
    const std::vector<float> wanted{0, 1, 2, 4,  6,  8,  2, 3.5f, 5,  8,  11, 14,
                                    4, 6, 8, 12, 16, 20, 6, 8.5f, 11, 16, 21, 26};
    ASSERT_EQ(out.size(), wanted.size());
    for (size_t k = 0; k < out.size(); ++k) EXPECT_FLOAT_EQ(out[k], wanted[k]) << k;
}

// ---------------------------------------------------------------- runs

class GeometryOfRuns : public ::testing::Test {
  protected:
    // 6 x 5 strands, one root empty; the head rises by 1 cm a frame. Wet ones near each other.
    std::string write_run(const std::string& name, bool wet, int frames = 3, int strands = 29) {
        RunHeader header;
        header.scene = "[groom]\n[cohesion]\nradius = 0.02\n";
        header.scene_folder = scratch.path();
        header.method = wet ? "simulated wet" : "simulated dry";
        header.groom.rest = Strands(strands, 4);
        header.groom.grid = {6, 5, std::vector<int>(30, -1)};
        for (int k = 0, s = 0; k < 30 && s < strands; ++k) {
            if (k == 8) continue;
            header.groom.grid.strand[size_t(k)] = s;
            for (int i = 0; i < 4; ++i)
                header.groom.rest.at(s, i) = {0.01f * float(k % 6), -0.01f * float(i), 0.012f * float(k / 6)};
            ++s;
        }
        header.groom.normal.assign(size_t(strands), {0, 1, 0});
        if (wet) header.saturation.assign(header.groom.rest.points.size(), 0.7f);
        RunWriter writer(scratch.path(name), header, true);
        for (int f = 0; f < frames; ++f) {
            RunFrame frame;
            frame.positions = header.groom.rest;
            for (Vec3f& x : frame.positions.points) x.y += 0.01f * float(f);
            writer.append(frame);
        }
        writer.commit();
        return scratch.path(name);
    }
    Scratch scratch;
};

TEST_F(GeometryOfRuns, are_the_roots_in_the_codec_s_colours_and_nothing_else) {
    const std::vector<std::string> files{write_run("dry.h5", false), write_run("wet.h5", true)};
    const auto film = geometry_film(files, 0, 1);
    ASSERT_EQ(film->frames(), 3);
    // As encode would: one box around all roots of both.
    ColourBox box;
    std::vector<Strands> strands;
    for (const auto& path : files) {
        const RunReader run(path);
        for (int f = 0; f < 3; ++f)
            grow(box,
                 shifted_roots(run.frame(f).positions,
                               path == files[1] ? run.header().saturation : std::vector<float>(), 0.02f));
    }
    for (int f : {0, 2}) {
        film->settle(f, f);
        const auto panels = film->panels(f);
        ASSERT_EQ(panels.size(), 2u);
        for (size_t k = 0; k < 2; ++k) {
            const RunReader run(files[k]);
            const RootImage image(run.header().groom.grid);
            const auto wanted =
                root_colours(image, run.frame(f).positions,
                             k == 1 ? run.header().saturation : std::vector<float>(), 0.02f, box);
            const auto mask = image.mask();
            const Image drawn = enlarged(panels[k], 3);
            int data = 0;
            for (int row = 0; row < 32; ++row)
                for (int column = 0; column < 32; ++column) {
                    const size_t pixel = size_t(row * 32 + column);
                    const bool strand = row < 5 && column < 6 && pixel != 32 + 2;
                    ASSERT_EQ(mask[pixel], strand);
                    data += strand;
                    for (int c = 0; c < 3; ++c) {
                        const float found = drawn.pixel(3 * column + 1, 3 * row + 1)[c];
                        ASSERT_EQ(byte_of(found), byte_of(strand ? wanted[size_t(c) * 1024 + pixel]
                                                                 : neutral_grey(3 * column + 1, 3 * row + 1)))
                            << row << " " << column;
                    }
                }
            EXPECT_EQ(data, 29);
        }
        EXPECT_NE(panels[0].values, panels[1].values);  // Eq 16
    }
    EXPECT_NE(film->panels(0)[0].values, film->panels(2)[0].values);
    EXPECT_NE(film->panels(2)[1].caption[0].find("wet"), std::string::npos);
    EXPECT_NE(film->panels(2)[1].caption[1].find("wet.h5, frame 2 of 0 to 2"), std::string::npos);
}

TEST_F(GeometryOfRuns, without_frames_or_a_box_or_beside_pairs_are_refused) {
    expect_error([&] { geometry_film({write_run("empty.h5", false, 0)}, 0, 1); }, {"empty.h5", "no frame"});
    expect_error([&] { geometry_film({write_run("one.h5", false, 1, 1)}, 0, 1); }, {"one.h5", "one point"});
    const std::string run = write_run("run.h5", false),
                      pairs = testing::make_root_pairs(scratch.path("p.h5"), 1);
    expect_error<Misuse>([&] { geometry_film({run, pairs}, 0, 1); }, {"1 runs, 1 pairs", "allowed"});
    expect_error<Misuse>([&] { geometry_film({pairs, pairs}, 0, 1); }, {"2 pairs", "allowed"});
    expect_error<Misuse>([&] { geometry_film({run}, 1, 1); }, {"--run"});
    expect_error<Misuse>([&] { geometry_film({pairs}, 1, 1); }, {"--run 1", "0 to 0"});
    expect_error([&] { geometry_film({scratch.file("a.txt", "hair")}, 0, 1); },
                 {"a.txt", "no HDF5", "runs, pairs and models"});
    expect_error([&] { geometry_film({scratch.path("absent.h5")}, 0, 1); }, {"absent.h5", "no such file"});
    expect_error([&] { geometry_film({testing::make_adhesion_pairs(scratch.path("a.h5"), 20)}, 0, 1); },
                 {"a.h5", "adhesion", "plot"});
    RenderOptions options;
    options.image = true, options.runs = {run}, options.frame = 3, options.output = scratch.path("o.png");
    expect_error<Misuse>([&] { render_command(options); }, {"--frame 3", "0 to 2", "run.h5"});
    options.frame = -1, options.pixels = 8;
    expect_error<Misuse>([&] { render_command(options); }, {"--pixels 8", "16 to 8192"});
}

TEST_F(GeometryOfRuns, are_written_as_pictures_and_films) {
    RenderOptions options;
    options.image = true, options.runs = {write_run("run.h5", true)}, options.output = scratch.path("o.png");
    try {
        render_command(options);
    } catch (const Error& e) {
        if (std::string(e.what()).find("OpenCV") == std::string::npos) throw;
        GTEST_SKIP() << "SKIP: built without OpenCV";
    }
    const std::string png = testing::bytes_of(options.output);
    ASSERT_GT(png.size(), 1000u);
    const auto side = [&](size_t at) { return int(uint8_t(png[at])) * 256 + int(uint8_t(png[at + 1])); };
    EXPECT_GE(side(18), 400);
    EXPECT_GE(side(22), 400);
    options.output = scratch.path("o.webm");
    EXPECT_EQ(render_command(options), 0);
    EXPECT_TRUE(std::filesystem::exists(options.output) || std::filesystem::exists(scratch.path("o_frames")));
}

// ---------------------------------------------------------------- pairs and models

TEST(GeometryOfPairs, of_codec_root_are_input_target_and_what_doubling_misses) {
    Scratch scratch;
    const std::string path = testing::make_root_pairs(scratch.path("pairs.h5"), 3);
    const auto film = geometry_film({path}, 0, 1);
    film->settle(1, 1);
    const auto panels = film->panels(1);
    ASSERT_EQ(panels.size(), 3u);
    const PairsReader reader(path);
    std::vector<float> input(3 * 32 * 32), target(3 * 64 * 64);
    reader.frame(0, 1, input.data(), target.data());
    EXPECT_EQ(panels[0].values, input);
    EXPECT_EQ(panels[1].values, target);
    EXPECT_EQ(panels[1].mask[0], 0);  // the left half, whose absurd colours are not shown
    EXPECT_EQ(panels[1].mask[63], 1);
    const auto doubled = doubled_image(input.data(), 3, 32, 32);
    std::vector<float> strengths;
    for (size_t k = 0; k < target.size(); ++k) {
        ASSERT_EQ(panels[2].values[k], target[k] - doubled[k]);
        if (panels[2].mask[k % 4096]) strengths.push_back(std::abs(panels[2].values[k]));
    }
    std::sort(strengths.begin(), strengths.end());
    const float usual = strengths[size_t(0.98 * double(strengths.size() - 1))];
    ASSERT_GT(usual, 0.01f);
    // All but the strongest 2 % are not cut, and not faint either; the caption says how strong.
    EXPECT_LE(usual * panels[2].gain, 0.5f);
    EXPECT_GE(usual * panels[2].gain, 0.5f / 2.6f);
    const double reach_mm = 0.5e3 * 1.3 / double(panels[2].gain);
    EXPECT_NE(panels[2].caption.back().find("full colour " + std::to_string(int(std::lround(reach_mm)))),
              std::string::npos)
        << panels[2].caption.back();
    EXPECT_NE(film->panels(0)[0].values, panels[0].values);
}

class GeometryOfModels : public ::testing::Test {
  protected:
    std::string trained(const std::string& name, const std::string& pairs, const std::string& kind,
                        const std::vector<std::string>& set) {
        TrainRequest request;
        request.kind = kind, request.pairs = {pairs}, request.output = scratch.path(name);
        request.set = set, request.threads = 1;
        network_module().train(request);
        return request.output;
    }
    Scratch scratch;
};

TEST_F(GeometryOfModels, of_codec_strand_are_tips_of_what_the_network_answers) {
    const std::string pairs = testing::make_strand_pairs(scratch.path("pairs.h5"), 6, 4);
    const std::string model = trained("m.h5", pairs, "sr", {"epochs=2", "width=0.1"});
    const auto film = geometry_film({pairs, model}, 0, 1);
    film->settle(0, 3);
    const auto panels = film->panels(2);
    ASSERT_EQ(panels.size(), 4u);  // base, prediction, target, residual

    const PairsReader reader(pairs);
    const StrandPairs shape = reader.strand(0);
    const size_t area = shape.pixels(), channels = size_t(testing::made_static + testing::made_dynamic);
    std::vector<float> inputs = shape.fixed, target(strand_coefficients * area),
                       answer(strand_outputs * area);
    inputs.resize(channels * area);
    float* const dynamic = inputs.data() + testing::made_static * area;
    reader.frame(0, 2, dynamic, target.data());
    network_module().load(model, "cpu", 1)->run(inputs.data(), {1, long(channels), 6, 6}, answer.data());
    const StrandDct dct(testing::made_particles);
    double apart = 0, size = 0, colours = 0;
    for (size_t pixel = 1; pixel < area; ++pixel) {
        float base[strand_coefficients], with[strand_coefficients], wanted[strand_coefficients];
        for (size_t m = 0; m < size_t(strand_coefficients); ++m) {
            base[m] = dynamic[m * area + pixel];
            with[m] = base[m] + answer[m * area + pixel], wanted[m] = base[m] + target[m * area + pixel];
        }
        Vec3f p[testing::made_particles];
        Vec3f tips[3];
        const float* of[3] = {base, with, wanted};
        for (int k = 0; k < 3; ++k)
            dct.decode(of[k], p), tips[k] = shape.length[pixel] * (p[testing::made_particles - 1] - p[0]);
        const Vec3f all[4] = {tips[0], tips[1], tips[2], tips[1] - tips[2]};
        for (size_t k = 0; k < 4; ++k) {
            const float x[3] = {all[k].x, all[k].y, all[k].z};
            for (size_t a = 0; a < 3; ++a) {
                apart = std::max(apart, double(std::abs(panels[k].values[a * area + pixel] - x[a])));
                colours = std::max(colours, double(std::abs(panels[k].colour(int(a), pixel) - 0.5f)));
            }
            size = std::max(size, double(norm(all[3])));
        }
    }
    EXPECT_GT(size, 2e-4);
    EXPECT_LT(apart, 1e-5);
    EXPECT_GT(colours, 0.15);
    EXPECT_EQ(panels[0].mask[0], 0);
    EXPECT_GT(panels[3].gain, panels[1].gain);
    for (const auto& p : panels) EXPECT_EQ(p.caption.size(), 6u);
    EXPECT_NE(panels[1].caption[0].find("strand_mlp"), std::string::npos);

    // Alone: the weights of its first layer.
    const auto alone = geometry_film({model}, 0, 1)->panels(0);
    ASSERT_EQ(alone.size(), 1u);
    EXPECT_EQ(alone[0].width, int(channels));
    EXPECT_NE(alone[0].caption[0].find("first layer"), std::string::npos);
}

TEST_F(GeometryOfModels, of_codec_root_are_the_network_s_colours) {
    const std::string pairs = testing::make_root_pairs(scratch.path("pairs.h5"), 3);
    const std::string model = trained("m.h5", pairs, "sr", {"epochs=1", "width=0.05", "patch=32"});
    const auto film = geometry_film({pairs, model}, 0, 1);
    film->settle(0, 0);
    const auto panels = film->panels(0);
    ASSERT_EQ(panels.size(), 4u);
    const PairsReader reader(pairs);
    std::vector<float> input(3 * 32 * 32), target(3 * 64 * 64), answer(target.size());
    reader.frame(0, 0, input.data(), target.data());
    network_module().load(model, "cpu", 1)->run(input.data(), {1, 3, 32, 32}, answer.data());
    EXPECT_EQ(panels[1].values, answer);
    EXPECT_EQ(panels[2].values, target);
    for (size_t k = 0; k < answer.size(); ++k) ASSERT_EQ(panels[3].values[k], answer[k] - target[k]);

    // Filters of three colours.
    const auto alone = geometry_film({model}, 0, 1)->panels(0);
    EXPECT_NE(alone[0].caption[0].find("filters"), std::string::npos);
    EXPECT_EQ(alone[0].mask[4], 1);  // 5 x 5, then a seam
    EXPECT_EQ(alone[0].mask[5], 0);

    const std::string others = testing::make_strand_pairs(scratch.path("strands.h5"));
    expect_error(
        [&] {
            geometry_film({others, model}, 0, 1);
        },
        {"m.h5", "codec root", "strands.h5", "codec strand"});
}

TEST_F(GeometryOfModels, with_other_channels_or_another_low_run_are_refused) {
    const std::string pairs = testing::make_strand_pairs(scratch.path("pairs.h5"));
    const std::string released = WETCURL_SOURCE_DIR "/models/weights/";
    expect_error(
        [&] {
            geometry_film({pairs, released + "strand_m.h5"}, 0, 1);
        },
        {"strand_m.h5", "251", std::to_string(testing::made_static + testing::made_dynamic)});
    expect_error(
        [&] {
            geometry_film({pairs, released + "strand_m_wet.h5"}, 0, 1);
        },
        {"strand_m_wet.h5", "wet low-resolution"});
}

}  // namespace
}  // namespace wetcurl

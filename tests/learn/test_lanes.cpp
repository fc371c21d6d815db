// What runs a strand a lane against plain loops: strands in lanes, networks, strands out of solids.
#include "base/pack_tile.h"
#include "learn/codec/lane_network.h"
#include "learn/codec/learned_strands.h"
#include "learn/codec/outside_lanes.h"
#include "tests/learn/allocations.h"
#include "tests/learn/hair.h"

namespace wetcurl::testing {
namespace {

using S = Pack<float>;

// Of rows that registers do not divide, with holes; strands are not numbered by pixels.
RootGrid grid_with_holes(int width, int height) {
    RootGrid grid{width, height, std::vector<int>(size_t(width) * height, -1)};
    int strands = 0;
    for (size_t pixel = grid.strand.size(); pixel-- > 0;)
        if (pixel % 7 != 3) grid.strand[pixel] = strands++;
    return grid;
}
int strands_of(const RootGrid& grid) { return 1 + *std::max_element(grid.strand.begin(), grid.strand.end()); }

std::vector<float> random_numbers(size_t count, unsigned seed, double most = 1) {
    Random random(seed);
    std::vector<float> out(count);
    for (float& x : out) x = float(random.number(-most, most));
    return out;
}

TEST(StrandLanes, load_and_store_are_rows_and_columns_of_any_length) {
    const RootGrid grid = grid_with_holes(37, 3);
    const int strands = strands_of(grid);
    for (const StrandLanes& lanes : {StrandLanes::on_grid(grid, strands), StrandLanes::in_order(strands)})
        for (int count : {1, 5, S::lanes, S::lanes + 1, 3 * S::lanes - 1}) {
            const std::vector<float> rows = random_numbers(size_t(strands * count), 1);
            std::vector<float> back(rows.size(), 0);
            int held = 0;
            for (int block = 0; block < lanes.blocks(); ++block) {
                std::vector<S> columns(static_cast<size_t>(count));
                lanes.load(block, count, rows.data(), columns.data());
                for (int lane = 0; lane < S::lanes; ++lane) {
                    const int s = lanes.strand(block, lane);
                    ASSERT_EQ(lanes.holds(block)[lane], s < 0 ? 0 : 1);
                    if (s >= 0) {
                        ASSERT_EQ(lanes.place_of(s), block * S::lanes + lane);
                        ++held;
                    }
                    for (int j = 0; j < count; ++j)
                        ASSERT_EQ(columns[size_t(j)][lane], s < 0 ? 0 : rows[size_t(s * count + j)]);
                }
                lanes.store(block, count, columns.data(), back.data());
            }
            EXPECT_EQ(held, strands);
            EXPECT_EQ(back, rows) << count;
        }
}

TEST(StrandLanes, rows_of_the_grid_begin_blocks) {
    const RootGrid grid = grid_with_holes(37, 3);
    const StrandLanes lanes = StrandLanes::on_grid(grid, strands_of(grid));
    const int row_blocks = (37 + S::lanes - 1) / S::lanes;
    ASSERT_EQ(lanes.blocks(), 3 * row_blocks);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < row_blocks * S::lanes; ++column)
            EXPECT_EQ(lanes.strand(row * row_blocks + column / S::lanes, column % S::lanes),
                      column < 37 ? grid.at(column, row) : -1);
    RootGrid without = grid;
    without.strand[0] = -1;
    expect_error([&] { StrandLanes::on_grid(without, strands_of(grid)); }, {"is at no pixel"});
}

TEST(PackTile, weighted_columns_are_sums_of_rows) {
    for (int count : {2, S::lanes, 2 * S::lanes + 3}) {
        const int width = 3;
        const std::vector<float> rows = random_numbers(size_t(count) * 10, 2),
                                 weight = random_numbers(size_t(S::lanes) * width, 3);
        std::vector<const float*> row;
        for (int k = 0; k < S::lanes * width; ++k) row.push_back(&rows[size_t(k * 7 % 10 * count)]);
        std::vector<S> columns(static_cast<size_t>(count));
        weighted_columns(count, width, row.data(), weight.data(), columns.data());
        for (int lane = 0; lane < S::lanes; ++lane)
            for (int j = 0; j < count; ++j) {
                double sum = 0;
                for (int k = lane * width; k < (lane + 1) * width; ++k)
                    sum += double(weight[size_t(k)]) * row[size_t(k)][j];
                EXPECT_NEAR(columns[size_t(j)][lane], sum, 1e-6);
            }
    }
}

StrandLayers random_layers(int inputs, int channels, int blocks, bool looks) {
    unsigned seed = 0;
    const auto dense = [&](int outputs, int from) {
        return StrandLayers::Dense{random_numbers(size_t(outputs) * from, ++seed, 1.5 / std::sqrt(from)),
                                   random_numbers(size_t(outputs), ++seed, 0.3)};
    };
    StrandLayers layers{inputs, channels, 8, random_numbers(size_t(inputs), 90), {}, dense(channels, inputs),
                        {},     {},       {}};
    for (int j = 0; j < inputs; ++j) layers.deviation.push_back(0.5f + 0.1f * float(j));
    for (int k = 0; k < blocks; ++k) {
        const std::vector<float> around =
            looks
                ? random_numbers(size_t(channels) * StrandLayers::kernel * StrandLayers::kernel, ++seed, 0.2)
                : std::vector<float>();
        layers.blocks.push_back({around, dense(channels, channels), dense(channels, channels)});
    }
    layers.last = dense(8, channels);
    layers.scale = random_numbers(8, 91);
    return layers;
}

// (pixel, outputs) in double precision, as StrandLayers says; input (pixel, inputs). Only pixels within
// `seen` are seen.
std::vector<double> evaluated(const StrandLayers& layers, const RootGrid& grid,
                              const std::vector<float>& input, const GridBox& seen) {
    using Rows = std::vector<std::vector<double>>;
    const auto dense = [](const StrandLayers::Dense& layer, const std::vector<double>& x) {
        std::vector<double> y(layer.bias.begin(), layer.bias.end());
        for (size_t o = 0; o < y.size(); ++o)
            for (size_t j = 0; j < x.size(); ++j) y[o] += double(layer.weight[o * x.size() + j]) * x[j];
        return y;
    };
    const auto relu = [](std::vector<double> x) {
        for (double& v : x) v = std::max(v, 0.0);
        return x;
    };
    const auto is_seen = [&](int row, int column) {
        return row >= seen.row && row < seen.row + seen.height && column >= seen.column &&
               column < seen.column + seen.width && grid.at(column, row) >= 0;
    };
    Rows x;
    for (size_t pixel = 0; pixel < grid.strand.size(); ++pixel) {
        std::vector<double> in;
        for (size_t j = 0; j < size_t(layers.inputs); ++j)
            in.push_back((double(input[pixel * size_t(layers.inputs) + j]) - layers.mean[j]) /
                         layers.deviation[j]);
        x.push_back(dense(layers.first, in));
    }
    for (const StrandLayers::Block& block : layers.blocks) {
        const Rows before = x;
        for (int row = 0; row < grid.height; ++row)
            for (int column = 0; column < grid.width; ++column) {
                std::vector<double> y = before[size_t(row * grid.width + column)];
                for (int r = -2; r <= 2 && !block.around.empty(); ++r)
                    for (int k = -2; k <= 2; ++k) {
                        if (row + r < 0 || row + r >= grid.height || column + k < 0 ||
                            column + k >= grid.width || !is_seen(row + r, column + k))
                            continue;
                        const auto& beside = before[size_t((row + r) * grid.width + column + k)];
                        for (size_t c = 0; c < y.size(); ++c)
                            y[c] += double(block.around[c * 25 + size_t((r + 2) * 5 + k + 2)]) * beside[c];
                    }
                const std::vector<double> add = dense(block.out, relu(dense(block.in, y)));
                for (size_t c = 0; c < y.size(); ++c) x[size_t(row * grid.width + column)][c] += add[c];
            }
    }
    std::vector<double> out;
    for (const auto& row : x) {
        const std::vector<double> y = dense(layers.last, relu(row));
        for (size_t o = 0; o < y.size(); ++o) out.push_back(y[o] * layers.scale[o]);
    }
    return out;
}

TEST(LaneNetwork, is_its_layers_in_plain_loops_on_any_grid_and_cropped) {
    const int inputs = 11, fixed_inputs = 4, channels = 16;
    for (const bool looks : {false, true})
        for (const RootGrid& grid : {grid_with_holes(37, 9), grid_with_holes(3, 2), grid_with_holes(16, 5)}) {
            const int strands = strands_of(grid), pixels = grid.width * grid.height;
            const StrandLayers layers = random_layers(inputs, channels, 3, looks);
            const StrandLanes lanes = StrandLanes::on_grid(grid, strands);
            const std::vector<float> input = random_numbers(size_t(pixels) * inputs, 7, 2);
            const int row_blocks = (grid.width + S::lanes - 1) / S::lanes;
            // (block, channels) of inputs `first` to `end`.
            const auto in_blocks = [&](int first, int end) {
                std::vector<S> out(size_t(lanes.blocks()) * size_t(end - first), S(0));
                for (int pixel = 0; pixel < pixels; ++pixel)
                    for (int j = first; j < end; ++j) {
                        const int column = pixel % grid.width,
                                  block = pixel / grid.width * row_blocks + column / S::lanes;
                        out[size_t(block * (end - first) + j - first)].set(column % S::lanes,
                                                                           input[size_t(pixel * inputs + j)]);
                    }
                return out;
            };
            const std::vector<S> changing = in_blocks(fixed_inputs, inputs);
            for (const bool single : {true, false}) {
                LaneNetwork network(layers, grid, lanes, fixed_inputs, in_blocks(0, fixed_inputs), single);
                // By bytes: two roundings of 1 / 254 of the largest number and weight in each of 16 products,
                // a matrix.
                const double rounding = single || !LaneNetwork::has_bytes ? 2e-5 : 0.1;
                const GridBox whole{0, 0, grid.height, grid.width};
                const GridBox seen{0, 0, (grid.height + 1) / 2, (grid.width + 1) / 2},
                    answered{0, 0, 1, (grid.width + 1) / 2};
                for (const Crop& crop :
                     {Crop{whole, whole}, Crop{answered, seen}, Crop{{}, {}}, Crop{whole, whole}}) {
                    network.crop(crop);
                    const std::vector<double> expected = evaluated(layers, grid, input, crop.seen);
                    std::vector<S> answer(size_t(lanes.blocks()) * 8, S(7));
                    network.prepare();
#pragma omp parallel
                    {
#pragma omp for
                        for (size_t g = 0; g < network.groups().size(); ++g) {
                            const auto& group = network.groups()[g];
                            network.begin(group, &changing[size_t(group.first) * (inputs - fixed_inputs)]);
                        }
                        network.run();
#pragma omp for
                        for (size_t g = 0; g < network.groups().size(); ++g)
                            network.end(network.groups()[g], &answer[size_t(network.groups()[g].first) * 8]);
                    }
                    double most = 0;
                    for (int pixel = 0; pixel < pixels; ++pixel) {
                        const int row = pixel / grid.width, column = pixel % grid.width;
                        const bool holds = grid.strand[size_t(pixel)] >= 0,
                                   asked = row < crop.answered.height && column < crop.answered.width;
                        for (int o = 0; o < 8; ++o) {
                            const double found =
                                answer[size_t((row * row_blocks + column / S::lanes) * 8 + o)]
                                      [column % S::lanes];
                            const double of_layers = expected[size_t(pixel * 8 + o)];
                            EXPECT_NEAR(found, holds && asked ? of_layers : 0, holds && asked ? rounding : 0)
                                << looks << ' ' << pixel;
                            most = std::max(most, std::abs(found));
                        }
                    }
                    EXPECT_EQ(most > 0.5, crop.answered.height > 0);
                }
            }
        }
    const RootGrid grid = grid_with_holes(5, 5);
    const StrandLanes lanes = StrandLanes::on_grid(grid, strands_of(grid));
    expect_error([&] { LaneNetwork(random_layers(3, 16, 1, false), grid, lanes, 4, {}); },
                 {"3 inputs", "4 inputs or more"});
}

// A ball as triangles, twice as wide as high.
Mesh flat_ball(double radius) {
    Mesh mesh = triangulated(Sphere{radius});
    for (Vec3f& x : mesh.vertices) x.y *= 0.5f;
    return mesh;
}

TEST(OutsideLanes, is_each_particle_pushed_and_then_led_by_itself) {
    Curls curls;
    curls.width = 11, curls.height = 5;
    Groom groom = curly_groom(curls);
    const int n = groom.rest.particles, strands = groom.rest.count;
    std::vector<float> edges(groom.rest.points.size(), 0), depth = random_numbers(edges.size(), 5, 1e-3);
    for (int s = 0; s < strands; ++s)
        for (int i = 1; i < n; ++i)
            edges[size_t(s * n + i)] = norm(groom.rest.at(s, i) - groom.rest.at(s, i - 1));
    for (float& d : depth) d = std::min(d, 0.f);
    const Pose head = some_pose(3);
    const Quatf turn = cast<float>(head.rotation);
    const Vec3f place = cast<float>(head.translation);
    const std::vector<std::vector<Shape>> sets{
        {Sphere{0.085}},
        {Capsule{0.02, 0.05}, Box{{0.02, 0.11, 0.03}}},
        {std::make_shared<const LevelSet>(flat_ball(0.14), 0.006)},
        {Box{{0.03, 0.03, 0.03}}, std::make_shared<const LevelSet>(flat_ball(0.12), 0.006)}};
    for (const auto& shapes : sets) {
        const StrandLanes lanes = StrandLanes::in_order(strands);
        const OutsideLanes outside({shapes, depth}, lanes, n, edges);
        const Strands before = moved(groom.rest, head);
        Strands found = before, expected = before;
        std::vector<Vec3<S>> x(static_cast<size_t>(n));
        for (int block = 0; block < lanes.blocks(); ++block) {
            lanes.load(block, 3 * n, &before.points[0].x, &x[0].x);
            outside.push(block, head, x.data());
            lanes.store(block, 3 * n, &x[0].x, &found.points[0].x);
        }
        int pushed = 0, led = 0;
        for (int s = 0; s < strands; ++s) {
            const auto out = [&](int i) {
                return [&, i](const Vec3f& world) {
                    const Vec3f from = rotate(conjugate(turn), world - place);
                    Vec3f to = from;
                    for (const Shape& shape : shapes)
                        to = pushed_out(view_of(shape), to, depth[size_t(s * n + i)]);
                    return norm(to - from) > 0 ? place + rotate(turn, to) : world;
                };
            };
            for (int i = 1; i < n; ++i) {
                const Vec3f to = out(i)(expected.at(s, i));
                pushed += norm(to - expected.at(s, i)) > 1e-5f;
                expected.at(s, i) = to;
            }
            for (int i = 1; i < n; ++i) {
                const Vec3f to = led_around(expected.at(s, i - 1), expected.at(s, i),
                                            torn_lengths * edges[size_t(s * n + i)], out(i));
                led += norm(to - expected.at(s, i)) > 1e-5f;
                expected.at(s, i) = to;
            }
        }
        EXPECT_GT(pushed, 100);
        EXPECT_GT(int(before.points.size()) - pushed, 500);
        EXPECT_GT(led, 3);
        // Each particle that is led starts from the one before: over a strand of the grid's cells roundings
        // grow.
        EXPECT_LT(largest_distance(found, expected), 1e-4);
        double apart = 0;
        for (size_t k = 0; k < found.points.size(); ++k) apart += norm(found.points[k] - expected.points[k]);
        EXPECT_LT(apart / double(found.points.size()), 2e-6);
    }
    // Without shapes strands stay, long edges too.
    std::vector<Vec3<S>> apart(size_t(n), Vec3<S>{S(0), S(0), S(0)});
    for (int i = 0; i < n; ++i) apart[size_t(i)].x = S(i);
    OutsideLanes({{}, depth}, StrandLanes::in_order(strands), n, edges).push(0, head, apart.data());
    for (int i = 0; i < n; ++i) EXPECT_EQ(apart[size_t(i)].x[0], float(i));
    expect_error(
        [&] {
            OutsideLanes({{Sphere{0.1}}, {0, 0}}, StrandLanes::in_order(strands), n, edges);
        },
        {"2 depths", std::to_string(edges.size())});
}

// A network that says its layers alone.
class LayersOnly final : public Network {
  public:
    explicit LayersOnly(StrandLayers layers) : layers_(std::move(layers)) {
        card_.codec = "strand", card_.architecture = "strand_depthwise", card_.target = "displayed";
        card_.input_channels = layers_.inputs, card_.output_channels = layers_.outputs;
    }
    const ModelCard& card() const override { return card_; }
    void run(const float*, std::array<long, 4>, float*, bool) override {
        throw Error("asked for whole images");
    }
    int reach() const override { return layers_.reach(); }
    std::optional<DenseLayers> layers() const override { return std::nullopt; }
    std::optional<StrandLayers> strand_layers() const override { return layers_; }

  private:
    ModelCard card_;
    StrandLayers layers_;
};

TEST(LearnedStrandsInLanes, allocate_nothing_from_the_second_frame_on_and_do_not_depend_on_the_threads) {
    const Groom high = curly_groom({}), low = coarsened(high, 2);
    StrandLayers layers = random_layers(strand_channels, 16, 2, true);
    layers.outputs = strand_outputs;
    layers.last = {random_numbers(size_t(strand_outputs) * 16, 50), random_numbers(strand_outputs, 51)};
    layers.scale.assign(strand_outputs, 1e-3f);
    std::vector<Strands> shown;
    const int threads = omp_get_max_threads();
    for (int team : {1, 3}) {
        omp_set_num_threads(team);
        const auto learned =
            learned_strands(std::make_unique<LayersOnly>(layers), StrandCodec(high, low, {}));
        learned->keep_outside({{Sphere{0.1}}, std::vector<float>(high.rest.points.size(), 0)});
        Strands in = low.rest, out = high.rest;
        learned->bind(in.points.data(), out.points.data());
        HeadWindow heads;
        learned->run(heads);
        const long before = allocations();
        for (int f = 0; f < 3; ++f) {
            for (Vec3f& x : in.points) x += Vec3f{1e-3f, 0, 0};
            learned->run(heads);
        }
        EXPECT_EQ(allocations() - before, 0);
        EXPECT_GT(largest_distance(out, learned->base(Pose{})), 1e-3);
        shown.push_back(out);
    }
    omp_set_num_threads(threads);
    EXPECT_EQ(largest_distance(shown[0], shown[1]), 0);
}

}  // namespace
}  // namespace wetcurl::testing

// `wetcurl dataset`: what a recipe picks and draws, and that shards are what encode makes of simulated runs.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "app/commands/dataset.h"
#include "app/commands/encode.h"
#include "app/commands/simulate.h"
#include "app/dataset/dataset_recipe.h"
#include "app/engine/run_of_scene.h"
#include "app/files/results.h"
#include "base/config.h"
#include "base/run_cache.h"
#include "learn/codec/dct.h"
#include "learn/codec/pairs.h"
#include "learn/codec/stencil.h"
#include "tests/base/scratch.h"
#include "tests/base/threads.h"
#include "tests/grooms/strand_files.h"

namespace wetcurl {
namespace {

namespace fs = std::filesystem;
using testing::bytes_of;
using testing::expect_error;
using testing::Scratch;

// Sixteen strands with a curl of two turns.
const std::string small_base = R"(frames = 7
fps = 24
[groom]
grid = [4, 4]
particles = 17
length = 0.1
curl_radius = 0.004
pitch = 0.05
[integrator]
substeps = 2
[stretch]
[bend]
[core]
[curl]
[cohesion]
radius = 0.03
)";

// Of frames 1, 3 and 5.
const std::string small_recipe = R"(scene = "base.toml"
seed = 3
first = 1
every = 2
[draw]
"groom.length" = [0.08, 0.12]
"wetness.level" = [0.5, 1.0]
[test_draw]
"groom.length" = [0.13, 0.14]
[[pick.wetness]]
name = "uniform"
text = '[wetness]'
[[pick.wetness]]
name = "tip"
text = '''
[wetness]
pattern = "tip"
'''
draw = { "wetness.edge" = [0.2, 0.8] }
[[pick.motion]]
name = "turn"
only = "train"
text = '[motion]'
draw = { "motion.angle" = [10, 40], "motion.period" = [0.3, 0.6] }
[[pick.motion]]
name = "shake"
text = '[motion]'
draw = { "motion.shift" = [[-0.06, -0.05], [0.01, 0.02], [0.05, 0.06]], "motion.period" = [0.3, 0.6] }
[[pick.motion]]
name = "jump"
only = "test"
text = '''
[[motion.keyframe]]
time = 0.05
[[motion.keyframe]]
time = 0.2
translation = [0, 0.05, 0]
'''
)";

std::string scenes(int train, int validation, int test) {
    return "[splits]\ntrain = " + std::to_string(train) + "\nvalidation = " + std::to_string(validation) +
           "\ntest = " + std::to_string(test) + "\n";
}

// What `--set` would assign: key -> value as written.
std::map<std::string, std::string> assigned(const DatasetMember& m) {
    std::map<std::string, std::string> out;
    for (const auto& s : m.set) {
        const auto at = s.find('=');
        out[s.substr(0, at)] = s.substr(at + 1);
    }
    return out;
}
double drawn(const DatasetMember& m, const std::string& key) { return std::stod(assigned(m).at(key)); }

// All of a strand pairs file's run.
struct Pairs {
    StrandPairs fixed;
    std::vector<float> dynamic, target;  // (frame, channel, pixel)
};
Pairs pairs_of(const std::string& path, int run = 0) {
    const PairsReader reader(path);
    Pairs out{reader.strand(run), {}, {}};
    const size_t inputs = size_t(out.fixed.dynamic_channels) * out.fixed.pixels(),
                 targets = strand_coefficients * out.fixed.pixels();
    out.dynamic.resize(inputs * size_t(out.fixed.frames));
    out.target.resize(targets * size_t(out.fixed.frames));
    for (int f = 0; f < out.fixed.frames; ++f)
        reader.frame(run, f, out.dynamic.data() + size_t(f) * inputs,
                     out.target.data() + size_t(f) * targets);
    return out;
}
double largest_difference(const std::vector<float>& a, const std::vector<float>& b) {
    if (a.size() != b.size()) return 1e9;
    double most = 0;
    for (size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(double(a[k]) - double(b[k])));
    return most;
}
// Amplitudes of the wet strand: the base, which the input begins with, and what is to be added to it.
std::vector<float> wet_strands(const Pairs& p) {
    const size_t area = p.fixed.pixels(), inputs = size_t(p.fixed.dynamic_channels) * area,
                 targets = strand_coefficients * area;
    std::vector<float> out = p.target;
    for (size_t k = 0; k < out.size(); ++k) out[k] += p.dynamic[k / targets * inputs + k % targets];
    return out;
}

class Dataset : public ::testing::Test {
  protected:
    Dataset() { scratch.file("base.toml", small_base); }

    std::string recipe(const std::string& text) const { return scratch.file("recipe.toml", text); }
    DatasetRecipe read(const std::string& text) const { return read_dataset_recipe(recipe(text), {}); }
    DatasetOptions options(const std::string& text, const std::string& folder) const {
        DatasetOptions o;
        o.recipe = recipe(text);
        o.output = scratch.path(folder);
        o.threads = 1;
        return o;
    }
    // Makes it, and says how many scenes were simulated and whether all are there.
    std::pair<int, bool> make(DatasetOptions o) const {
        o.json = scratch.path("said.json");
        fs::remove(o.json);
        EXPECT_EQ(dataset_command(o), 0);
        const Json said = Json::parse(bytes_of(o.json));
        return {said["made"].get<int>(), said["whole"].get<bool>()};
    }
    // Name -> bytes of all files in a folder.
    std::map<std::string, std::string> contents(const std::string& folder) const {
        std::map<std::string, std::string> out;
        for (const auto& entry : fs::recursive_directory_iterator(scratch.path(folder)))
            if (entry.is_regular_file())
                out[fs::relative(entry.path(), scratch.path(folder)).string()] = bytes_of(entry.path());
        return out;
    }
    void expect_same(const std::string& a, const std::string& b) const {
        const auto one = contents(a), other = contents(b);
        for (const auto& [name, bytes] : one)
            EXPECT_TRUE(other.contains(name) && other.at(name) == bytes) << b << "/" << name;
        for (const auto& [name, bytes] : other) EXPECT_TRUE(one.contains(name)) << b << "/" << name;
    }
    Scratch scratch;
};

TEST_F(Dataset, leaves_out_a_scene_that_diverges_and_says_which_but_not_many) {
    // No edge of the second may be longer than at rest.
    const std::string text = small_recipe + R"(
[[pick.care]]
name = "sound"
weight = 2
text = "[integrator]\nsubsteps = 2"
[[pick.care]]
name = "torn"
text = "[integrator]\nsubsteps = 2\nallow_stretch = 1"
)" + scenes(8, 0, 0);
    const std::string half = "may_diverge = 0.5\n" + text;
    const DatasetRecipe recipe = read_dataset_recipe(options(half, "some").recipe, {});
    std::set<std::string> torn;
    for (const auto& m : recipe.members)
        if (m.picked.at("care") == "torn") torn.insert(m.name);
    ASSERT_GE(torn.size(), 1u);
    ASSERT_LE(torn.size(), 4u);

    EXPECT_EQ(make(options(half, "some")), std::pair(8, true));
    const auto manifest = nlohmann::json::parse(bytes_of(scratch.path("some/manifest.json")));
    ASSERT_EQ(manifest["scenes"].size(), 8u);
    for (const auto& scene : manifest["scenes"]) {
        const std::string name = scene["name"];
        EXPECT_NE(scene.contains("diverged"), scene.contains("hash_strand")) << name;
        EXPECT_EQ(scene.contains("diverged"), torn.contains(name)) << name;
        EXPECT_NE(fs::exists(scratch.path("some/shards/" + name + "_strand.h5")), torn.contains(name))
            << name;
        if (torn.contains(name)) {
            const std::string how = scene["diverged"];
            EXPECT_TRUE(how.starts_with(name + ": ")) << how;
            EXPECT_NE(how.find("allow_stretch"), std::string::npos) << how;
        }
    }
    EXPECT_EQ(PairsReader(scratch.path("some/train_strand.h5")).runs(), int(8 - torn.size()));
    DatasetOptions again = options(half, "some");
    again.resume = true;
    EXPECT_EQ(make(again), std::pair(0, true));

    for (const char* part : {"1/2", "2/2"}) {
        DatasetOptions o = options(half, "parts");
        o.part = part;
        EXPECT_EQ(make(o), std::pair(4, o.part == "2/2"));
    }
    expect_same("some", "parts");

    // One in a hundred by default.
    expect_error([&] { make(options(text, "none")); },
                 {"train-000", "diverged at frame", "1 of the 8 scenes of train diverged", "allowed is 0",
                  "may_diverge"});
    EXPECT_FALSE(contents("none").contains("manifest.json"));
    // What it may lose changes no scene: what is there is kept.
    DatasetOptions more = options(half, "none");
    more.resume = true;
    EXPECT_TRUE(make(more).second);
    EXPECT_EQ(contents("none").at("train_strand.h5"), contents("some").at("train_strand.h5"));
    // Too many of all parts together, though not of each.
    const std::string one_less =
        "may_diverge = " + fmt::format("{}", (double(torn.size()) - 0.5) / 8) + "\n" + text;
    DatasetOptions first = options(one_less, "many"), second = options(one_less, "many");
    first.part = "1/2", second.part = "2/2";
    expect_error([&] { make(first), make(second); }, {"diverged", "may_diverge"});
}

TEST_F(Dataset, is_the_same_bytes_on_any_threads_in_parts_and_resumed) {
    const std::string text = "codecs = \"both\"\n" + small_recipe + scenes(3, 1, 2);
    const auto [one, three] = testing::with_one_and_three_threads([&, folder = 0]() mutable {
        const std::string name = "whole" + std::to_string(folder++);
        EXPECT_EQ(make(options(text, name)), std::pair(6, true));
        return name;
    });
    const auto whole = contents(one);
    // Six scenes of two codecs, a file for each split and codec, the recipe and the list.
    ASSERT_EQ(whole.size(), 12u + 6u + 2u);
    for (const char* name : {"recipe.toml", "manifest.json", "train_strand.h5", "validation_root.h5",
                             "test_root.h5", "shards/train-0002_strand.h5", "shards/test-0001_root.h5"})
        EXPECT_TRUE(whole.contains(name)) << name;
    expect_same(one, three);

    DatasetOptions part = options(text, "parts");
    part.part = "1/2";
    EXPECT_EQ(make(part), std::pair(3, false));
    EXPECT_FALSE(contents("parts").contains("manifest.json"));
    part.part = "2/2";
    EXPECT_EQ(make(part), std::pair(3, true));
    expect_same(one, "parts");

    // Of one scene both codecs are gone, of another one, and what lists them.
    for (const char* gone : {"shards/train-0001_strand.h5", "shards/train-0001_root.h5",
                             "shards/test-0000_root.h5", "train_strand.h5", "manifest.json"})
        ASSERT_TRUE(fs::remove(scratch.path(three + "/" + gone))) << gone;
    DatasetOptions again = options(text, three);
    again.resume = true;
    EXPECT_EQ(make(again), std::pair(2, true));
    expect_same(one, three);
    EXPECT_EQ(make(again), std::pair(0, true));
    expect_same(one, three);
}

TEST_F(Dataset, parts_that_begin_at_once_are_the_same_bytes) {
    const std::string text = small_recipe + scenes(4, 1, 1);
    make(options(text, "whole"));
    for (int repeat = 0; repeat < 4; ++repeat) {
        const std::string name = "shared" + std::to_string(repeat);
        const DatasetOptions whole = options(text, name);
        std::vector<std::thread> parts;
        for (int k = 1; k <= 3; ++k)
            parts.emplace_back([&, part = whole, k]() mutable {
                part.part = std::to_string(k) + "/3";
                EXPECT_EQ(dataset_command(part), 0);
            });
        for (auto& part : parts) part.join();
        expect_same("whole", name);
    }
}

TEST_F(Dataset, overwriting_leaves_what_a_new_folder_would_hold) {
    make(options(small_recipe + scenes(1, 1, 1), "over"));
    DatasetOptions other = options(small_recipe + scenes(2, 1, 1), "over");
    other.set = {"seed=4"};
    other.overwrite = true;
    EXPECT_EQ(make(other), std::pair(4, true));
    other.output = scratch.path("fresh");
    make(other);
    expect_same("fresh", "over");
}

TEST_F(Dataset, each_split_has_its_scenes_and_its_entries) {
    const DatasetRecipe r = read(small_recipe + R"(
[[pick.friction]]
name = "a"
[[pick.friction]]
name = "b"
only = "train"
)" + scenes(60, 30, 30));
    std::map<std::string, int> count;
    std::set<std::string> names;
    std::map<std::string, std::set<std::string>> motion, wetness, friction;
    for (const auto& m : r.members) {
        ++count[m.split];
        names.insert(m.name);
        EXPECT_EQ(m.name.find(m.split + "-"), 0u) << m.name;
        motion[m.split].insert(m.picked.at("motion"));
        wetness[m.split].insert(m.picked.at("wetness"));
        friction[m.split].insert(m.picked.at("friction"));
        // The entry's text and its draws go together.
        EXPECT_EQ(m.text.find("[[motion.keyframe]]") != std::string::npos, m.picked.at("motion") == "jump");
        EXPECT_EQ(assigned(m).contains("motion.shift"), m.picked.at("motion") == "shake");
        EXPECT_EQ(assigned(m).contains("wetness.edge"), m.picked.at("wetness") == "tip");
    }
    EXPECT_EQ(count, (std::map<std::string, int>{{"train", 60}, {"validation", 30}, {"test", 30}}));
    EXPECT_EQ(names.size(), r.members.size());
    // Of so many scenes one side of two is left out with a chance of 2^-29.
    using Names = std::set<std::string>;
    for (const char* split : {"train", "validation"}) {
        EXPECT_EQ(motion[split], (Names{"shake", "turn"})) << split;
        EXPECT_EQ(friction[split], (Names{"a", "b"})) << split;
    }
    EXPECT_EQ(motion["test"], Names{"jump"});
    EXPECT_EQ(friction["test"], Names{"a"});  // none is kept for the test: those open to all
    for (const auto& [split, picked] : wetness) EXPECT_EQ(picked, (Names{"tip", "uniform"})) << split;
}

TEST_F(Dataset, drawn_values_fill_their_ranges_and_the_test_has_its_own) {
    const DatasetRecipe r = read(small_recipe + scenes(300, 0, 300));
    std::map<std::string, std::vector<double>> share;  // of the range, by split and key
    auto add = [&](const DatasetMember& m, const std::string& key, double value, double low, double high) {
        EXPECT_GE(value, low) << m.name << " " << key;
        EXPECT_LT(value, high) << m.name << " " << key;
        share[m.split + " " + key].push_back((value - low) / (high - low));
    };
    for (const auto& m : r.members) {
        const bool test = m.split == "test";
        add(m, "groom.length", drawn(m, "groom.length"), test ? 0.13 : 0.08, test ? 0.14 : 0.12);
        add(m, "wetness.level", drawn(m, "wetness.level"), 0.5, 1.0);
        if (m.picked.at("wetness") == "tip") add(m, "wetness.edge", drawn(m, "wetness.edge"), 0.2, 0.8);
        if (m.picked.at("motion") != "shake") continue;
        const auto shift = Config::parse("shift = " + assigned(m).at("motion.shift"), "drawn")
                               .root()
                               .numbers(KeyRow::numbers("shift", "m", {0, 0, 0}, -1, 1, ""));
        const double low[3] = {-0.06, 0.01, 0.05};
        for (size_t k = 0; k < 3; ++k)
            add(m, "motion.shift " + std::to_string(k), shift[k], low[k], low[k] + 0.01);
    }
    ASSERT_EQ(share.size(), 6u + 3u);
    for (const auto& [what, values] : share) {
        // Uniform numbers of variance 1/12, at five standard deviations; so is the mean product of successive
        // ones, whose variance is 1/144.
        const double n = double(values.size());
        double mean = 0, product = 0;
        for (double v : values) mean += v / n;
        for (size_t k = 1; k < values.size(); ++k)
            product += (values[k] - 0.5) * (values[k - 1] - 0.5) / (n - 1);
        EXPECT_NEAR(mean, 0.5, 5 / std::sqrt(12 * n)) << what;
        EXPECT_NEAR(product, 0, 5 / std::sqrt(144 * (n - 1))) << what;
    }
    // Nor do keys follow one another.
    double product = 0;
    for (size_t k = 0; k < 300; ++k)
        product += (share["train groom.length"][k] - 0.5) * (share["train wetness.level"][k] - 0.5) / 300;
    EXPECT_NEAR(product, 0, 5 / std::sqrt(144 * 300.0));
}

TEST_F(Dataset, a_further_key_or_scene_changes_nothing_drawn_before) {
    const DatasetRecipe before = read(small_recipe + scenes(6, 2, 2));
    const std::string head = "[draw]\n";
    std::string more = small_recipe;
    more.insert(more.find(head) + head.size(),
                "\"bend.stiffness\" = [1e-9, 2e-9]\n\"groom.lift\" = [0.01, 0.02]\n");
    const DatasetRecipe after = read(more + scenes(9, 2, 3));
    std::map<std::string, const DatasetMember*> found;
    for (const auto& m : after.members) found[m.name] = &m;
    for (const auto& m : before.members) {
        ASSERT_TRUE(found.contains(m.name));
        const auto now = assigned(*found[m.name]), then = assigned(m);
        EXPECT_EQ(now.size(), then.size() + 2) << m.name;
        for (const auto& [key, value] : then) EXPECT_EQ(now.at(key), value) << m.name << " " << key;
        EXPECT_EQ(found[m.name]->picked, m.picked);
        EXPECT_EQ(found[m.name]->text, m.text);
    }
    // Another seed is another data set.
    const DatasetRecipe other = read_dataset_recipe(recipe(small_recipe + scenes(6, 2, 2)), {"seed=4"});
    for (size_t k = 0; k < before.members.size(); ++k)
        for (const char* key : {"seed", "groom.length", "wetness.level"})
            EXPECT_NE(assigned(other.members[k]).at(key), assigned(before.members[k]).at(key)) << key;
}

TEST_F(Dataset, a_shard_is_what_encode_makes_of_the_runs_that_simulate_writes) {
    std::string text = small_recipe + scenes(2, 0, 0);
    text.replace(text.find("first = 1\nevery = 2\n"), 20, "runs = \"train\"\n");
    make(options(text, "kept"));
    const DatasetRecipe r = read(text);
    for (const auto& m : r.members) {
        SimulateOptions simulate;
        simulate.scene = scratch.file("member.toml", m.text);
        simulate.set = m.set;
        simulate.overwrite = true;
        simulate.output = scratch.path("wet.h5");
        simulate_command(simulate);
        simulate.output = scratch.path("dry.h5");
        simulate.dry = true;
        simulate.strands = 4;
        simulate_command(simulate);
        const std::string kept = scratch.path("kept/runs/" + m.name);
        const Pairs shard = pairs_of(scratch.path("kept/shards/" + m.name + "_strand.h5"));
        ASSERT_EQ(shard.fixed.frames, 7);
        EXPECT_GT(largest_difference(shard.target, std::vector<float>(shard.target.size(), 0)), 1e-3);
        for (const auto& inputs : {std::vector{scratch.path("dry.h5"), scratch.path("wet.h5")},
                                   std::vector{kept + "_low.h5", kept + "_wet.h5"}}) {
            EncodeOptions encode;
            encode.inputs = inputs;
            encode.output = scratch.path("pairs.h5");
            encode.overwrite = true;
            encode_command(encode);
            const Pairs pairs = pairs_of(encode.output);
            // Metres and metres a second squared in float; the same numbers come in from memory and from
            // files.
            EXPECT_LT(largest_difference(shard.dynamic, pairs.dynamic), 1e-6) << inputs[0];
            EXPECT_LT(largest_difference(shard.target, pairs.target), 1e-6) << inputs[0];
            EXPECT_LT(largest_difference(shard.fixed.fixed, pairs.fixed.fixed), 1e-6) << inputs[0];
            EXPECT_LT(largest_difference(shard.fixed.length, pairs.fixed.length), 1e-6) << inputs[0];
            EXPECT_EQ(shard.fixed.mask, pairs.fixed.mask) << inputs[0];
            EXPECT_NEAR(PairsReader(encode.output).number("floor_mm"),
                        PairsReader(scratch.path("kept/shards/" + m.name + "_strand.h5")).number("floor_mm"),
                        1e-6);
        }
    }
}

TEST_F(Dataset, low_resolution_runs_take_the_substeps_that_the_recipe_gives_them) {
    const std::string text = "runs = \"train\"\n" + small_recipe + scenes(1, 0, 0);
    make(options(text, "own"));
    make(options("low_substeps = [1]\n" + text, "fewer"));
    auto run = [&](const std::string& name) { return RunReader(scratch.path(name)); };
    const RunReader wet = run("fewer/runs/train-0000_wet.h5"), low = run("fewer/runs/train-0000_low.h5");
    EXPECT_EQ(substeps_of(wet.header()), 2);
    EXPECT_EQ(substeps_of(low.header()), 1);
    EXPECT_EQ(substeps_of(run("own/runs/train-0000_low.h5").header()), 2);
    const auto tip = [](const RunReader& r) { return r.frame(6).positions.at(2, 16); };
    EXPECT_EQ(norm(tip(wet) - tip(run("own/runs/train-0000_wet.h5"))), 0);
    EXPECT_GT(norm(tip(low) - tip(run("own/runs/train-0000_low.h5"))), 1e-5f);
    for (const std::string file : {"shards/train-0000_strand.h5", "train_strand.h5"}) {
        EXPECT_EQ(PairsReader(scratch.path("fewer/" + file)).low_substeps(), 1) << file;
        EXPECT_EQ(PairsReader(scratch.path("own/" + file)).low_substeps(), 2) << file;
    }
    // Of scenes that are stepped each in its own way the fewest are told.
    const std::string steps = "[integrator]\nsubsteps = 2\n";
    std::string base = small_base, mixed = small_recipe;
    scratch.file("base.toml", base.erase(base.find(steps), steps.size()));
    for (const char* n : {"2", "3"})
        mixed += "[[pick.steps]]\nname = \"" + std::string(n) +
                 "\"\ntext = '''\n[integrator]\nsubsteps = " + n + "\n'''\n";
    make(options(mixed + scenes(4, 0, 0), "mixed"));
    std::set<int> substeps;
    for (int k = 0; k < 4; ++k)
        substeps.insert(PairsReader(scratch.path("mixed/shards/train-000" + std::to_string(k) + "_strand.h5"))
                            .low_substeps());
    EXPECT_EQ(substeps, (std::set<int>{2, 3}));
    EXPECT_EQ(PairsReader(scratch.path("mixed/train_strand.h5")).low_substeps(), 2);
    expect_error([&] { read("low_substeps = [-1]\n" + text); }, {"low_substeps", "-1"});
    expect_error([&] { read("low_substeps = [2.5]\n" + text); }, {"low_substeps", "2.5", "whole numbers"});
}

TEST_F(Dataset, low_resolution_runs_have_the_grids_and_guides_that_the_recipe_lists) {
    const std::string lists =
        "low_strides = [2, 4]\nlow_guides = [3]\nlow_substeps = [1, 2]\nruns = \"train\"\n";
    make(options(lists + small_recipe + scenes(12, 0, 0), "any"));
    std::map<int, int> strands;
    std::set<int> substeps;
    for (int k = 0; k < 12; ++k) {
        const RunReader low(scratch.path(fmt::format("any/runs/train-{:04d}_low.h5", k)));
        const RunReader wet(scratch.path(fmt::format("any/runs/train-{:04d}_wet.h5", k)));
        ++strands[low.header().groom.rest.count];
        substeps.insert(substeps_of(low.header()));
        require_part(wet.header().groom, low.header().groom);
        EXPECT_EQ(low.header().guides, low.header().groom.rest.count == 3 ? 3 : 0);
    }
    const RunReader wet(scratch.path("any/runs/train-0000_wet.h5"));
    const Groom& all = wet.header().groom;
    EXPECT_EQ(strands.size(), 3u);
    for (int count : {coarsened(all, 2).rest.count, coarsened(all, 4).rest.count, 3})
        EXPECT_GT(strands[count], 0);
    EXPECT_EQ(substeps, (std::set<int>{1, 2}));
    expect_error([&] { read("codecs = \"root\"\nlow_guides = [3]\n" + small_recipe); },
                 {"low_guides", "codec root"});
    expect_error([&] { read("codecs = \"both\"\nlow_strides = [4]\n" + small_recipe); },
                 {"low_strides", "found 4", "2 alone"});
}

TEST_F(Dataset, frames_are_those_that_the_recipe_keeps) {
    const std::string each = "first = 0\nevery = 1\n", some = "first = 1\nevery = 2\n";
    std::string text = small_recipe + scenes(1, 0, 0);
    make(options(text, "some"));
    make(options(text.replace(text.find(some), some.size(), each), "each"));
    const Pairs all = pairs_of(scratch.path("each/train_strand.h5")),
                few = pairs_of(scratch.path("some/train_strand.h5"));
    ASSERT_EQ(all.fixed.frames, 7);
    ASSERT_EQ(few.fixed.frames, 3);
    auto frame = [](const Pairs& p, int f) {
        const size_t size = p.dynamic.size() / size_t(p.fixed.frames);
        return std::vector<float>(p.dynamic.begin() + long(size_t(f) * size),
                                  p.dynamic.begin() + long(size_t(f + 1) * size));
    };
    for (int k = 0; k < 3; ++k) EXPECT_EQ(frame(few, k), frame(all, 1 + 2 * k)) << k;
}

TEST_F(Dataset, frames_are_kept_in_a_row_where_the_recipe_says) {
    const std::string some = "first = 1\nevery = 2\n", rows = "first = 1\nevery = 4\ntogether = 2\n";
    std::string text = small_recipe + scenes(1, 0, 0);
    make(options(text.replace(text.find(some), some.size(), rows), "rows"));
    EXPECT_EQ(PairsReader(scratch.path("rows/train_strand.h5")).strand(0).frame,
              (std::vector<int>{1, 2, 5, 6}));
    text.replace(text.find("together = 2"), 12, "together = 5");
    expect_error([&] { read(text); }, {"together", "5", "4"});
}

// Cohesion moves what is seen alone: a shard of codec strand does without, unless its runs are kept.
TEST_F(Dataset, keeping_runs_or_another_codec_changes_no_shard) {
    const std::string text = small_recipe + scenes(1, 0, 1);
    make(options(text, "plain"));
    make(options("codecs = \"both\"\nruns = \"test\"\n" + text, "kept"));
    for (const char* shard : {"shards/train-0000_strand.h5", "shards/test-0000_strand.h5"})
        EXPECT_EQ(contents("plain").at(shard), contents("kept").at(shard)) << shard;
    EXPECT_TRUE(RunReader(scratch.path("kept/runs/test-0000_wet.h5")).frame(6).displayed.count);
    EXPECT_FALSE(fs::exists(scratch.path("kept/runs/train-0000_wet.h5")));
}

TEST_F(Dataset, a_wet_low_run_is_another_input_for_the_same_strands) {
    const std::string text = small_recipe + scenes(1, 0, 0);
    make(options("low = \"dry\"\n" + text, "dry"));
    make(options("low = \"wet\"\n" + text, "wet"));
    const Pairs dry = pairs_of(scratch.path("dry/train_strand.h5")),
                wet = pairs_of(scratch.path("wet/train_strand.h5"));
    EXPECT_EQ(dry.fixed.fixed, wet.fixed.fixed);
    EXPECT_EQ(PairsReader(scratch.path("dry/train_strand.h5")).low(), "dry");
    EXPECT_EQ(PairsReader(scratch.path("wet/train_strand.h5")).low(), "wet");
    EXPECT_GT(largest_difference(dry.dynamic, wet.dynamic), 1e-4);
    // Base and difference come back together as the strand: amplitudes to 0.1 m, rounded twice.
    EXPECT_LT(largest_difference(wet_strands(dry), wet_strands(wet)), 1e-7);
}

TEST_F(Dataset, root_shards_open_as_pairs_of_codec_root_and_hold_the_roots) {
    make(options("codecs = \"both\"\nruns = \"train\"\nbox_lower = [-0.5, -0.4, -0.3]\n" + small_recipe +
                     scenes(2, 0, 0),
                 "both"));
    const PairsReader pairs(scratch.path("both/train_root.h5"));
    EXPECT_EQ(pairs.codec(), Codec::root);
    ASSERT_EQ(pairs.runs(), 2);
    EXPECT_EQ(pairs.particles(), 17);
    EXPECT_FLOAT_EQ(float(pairs.number("support_radius")), 0.03f);
    ColourBox box;
    pairs.box(&box.lower.x, &box.upper.x);
    EXPECT_EQ(norm(box.lower - Vec3d{-0.5, -0.4, -0.3}) + norm(box.upper - Vec3d{0.6, 0.6, 0.6}), 0);
    for (int run = 0; run < 2; ++run) {
        const RootPairs root = pairs.root(run);
        ASSERT_EQ(root.frames, 3);
        EXPECT_EQ(std::count(root.mask_low.begin(), root.mask_low.end(), 1), 4);
        EXPECT_EQ(std::count(root.mask.begin(), root.mask.end(), 1), 16);
        const std::string kept = scratch.path("both/runs/train-000" + std::to_string(run));
        const RunReader low(kept + "_low.h5"), wet(kept + "_wet.h5");
        const RootImage low_image(low.header().groom.grid), high_image(wet.header().groom.grid, 2);
        std::vector<float> input(3 * root.pixels()), target(12 * root.pixels());
        for (int k = 0; k < 3; ++k) {
            pairs.frame(run, k, input.data(), target.data());
            const RunFrame l = low.frame(1 + 2 * k), w = wet.frame(1 + 2 * k);
            const auto dry = low_image.read(input.data()), shifted = high_image.read(target.data());
            // Colours to 1 of a box of 1.9 m are rounded to 6e-8 of it.
            for (int s = 0; s < 4; ++s)
                EXPECT_LT(norm(position_of(dry[size_t(s)], box) - l.positions.at(s, 0)), 1e-6);
            const auto wanted = shifted_roots(w.seen(), w.wetness(wet.header()), 0.03f);
            double moved = 0;
            for (int s = 0; s < 16; ++s) {
                EXPECT_LT(norm(position_of(shifted[size_t(s)], box) - wanted[size_t(s)]), 1e-6);
                moved = std::max(moved, double(norm(wanted[size_t(s)] - w.positions.at(s, 0))));
            }
            EXPECT_GT(moved, 1e-5);  // Eq 16 is in it
        }
    }
    // Each codec's reader refuses the other's file.
    expect_error([&] { pairs.strand(0); }, {"train_root.h5", "codec root", "codec strand"});
}

TEST_F(Dataset, a_folder_is_not_written_to_unasked) {
    const std::string text = small_recipe + scenes(1, 0, 0);
    DatasetOptions o = options(text, "mine");
    make(o);
    const auto before = contents("mine");
    expect_error([&] { dataset_command(o); },
                 {"mine/recipe.toml", "there already", "--resume", "--overwrite"});
    o.set = {"seed=8"};
    expect_error([&] { dataset_command(o); }, {"mine/recipe.toml", "another recipe", "--overwrite"});
    o.resume = true;
    expect_error([&] { dataset_command(o); }, {"mine/recipe.toml", "another recipe", "--overwrite"});
    o.resume = false;
    o.part = "2/2";
    expect_error([&] { dataset_command(o); }, {"mine/recipe.toml", "another recipe", "--overwrite"});
    EXPECT_EQ(contents("mine"), before);
}

TEST_F(Dataset, a_second_process_in_the_same_folder_is_refused_and_changes_nothing) {
    using Kind = LockedFile::Kind;
    const std::string text = "runs = \"train\"\n" + small_recipe + scenes(2, 0, 0);
    make(options(text, "whole"));
    DatasetOptions o = options(text, "folder");
    o.part = "1/2";
    make(o);
    const auto half = contents("folder");
    auto refused = [&](const std::string& part, bool resume, bool overwrite, const std::string& named) {
        o.part = part, o.resume = resume, o.overwrite = overwrite;
        const auto before = contents("folder");
        expect_error([&] { dataset_command(o); }, {named, "writes it", "wait until it ends"});
        EXPECT_EQ(contents("folder"), before);
    };
    {
        const OutputFolder all(o.output, Kind::alone);
        refused("", true, false, o.output);
        refused("", false, true, o.output);
        refused("2/2", false, false, o.output);
    }
    {
        const OutputFolder part(o.output, Kind::shared);
        refused("", true, false, o.output);
        refused("", false, true, o.output);
        // Another process at the same scene, whichever of its files it writes.
        for (const std::string file : {"/shards/train-0001_strand.h5", "/runs/train-0001_wet.h5"}) {
            const OutputFile there(o.output + file, false);
            refused("2/2", false, false, file);
        }
    }
    EXPECT_EQ(contents("folder"), half);
    EXPECT_EQ(make(o), std::pair(1, true));
    for (const auto& [name, bytes] : contents("whole")) {
        if (name.starts_with("runs/")) continue;  // they hold run times
        EXPECT_EQ(contents("folder").at(name), bytes) << name;
    }
}

TEST_F(Dataset, errors_of_a_recipe_say_what_and_where_before_anything_is_written) {
    auto refused = [&](const std::string& text, std::initializer_list<std::string> parts) {
        SCOPED_TRACE(text.substr(0, 60));
        expect_error<Misuse>([&] { dataset_command(options(text, "none")); }, parts);
        EXPECT_FALSE(fs::exists(scratch.path("none")));
    };
    const std::string some = scenes(1, 0, 0);
    refused("seed = 1\n" + some, {"recipe.toml", "scene"});
    refused(small_recipe + scenes(0, 0, 0), {"recipe.toml", "[splits]", "no scene"});
    refused("seed = 3\nfrist = 2\nscene = \"base.toml\"\n" + some,
            {"recipe.toml:2", "unknown", "'frist'", "did you mean 'first'"});
    refused("scene = \"base.toml\"\n" + some + "tset = 4\n", {"recipe.toml:6", "'splits.tset'", "'test'"});
    refused("scene = \"base.toml\"\nlow = \"damp\"\n" + some, {"recipe.toml:2", "'damp'", "dry, wet"});
    refused("scene = \"base.toml\"\nruns = \"tets\"\n" + some, {"recipe.toml:2", "'tets'", "'test'"});
    refused("scene = \"base.toml\"\n[draw]\n\"groom.length\" = [0.3, 0.1]\n" + some,
            {"recipe.toml:3", "groom.length", "[low, high]"});
    refused("scene = \"base.toml\"\n[draw]\n\"groom.length\" = 0.3\n" + some,
            {"recipe.toml:3", "groom.length", "[low, high]"});
    refused("scene = \"base.toml\"\n[[pick.motion]]\nname = \"a\"\nonly = \"never\"\n" + some,
            {"recipe.toml:4", "'never'", "test, train"});
    refused("scene = \"base.toml\"\n[[pick.motion]]\nname = \"a\"\nonly = \"test\"\n" + some,
            {"pick.motion", "no entry", "train"});
    expect_error([&] { dataset_command(options("scene = \"absent.toml\"\n" + some, "none")); },
                 {"absent.toml", "cannot be read"});
    DatasetOptions o = options(small_recipe + some, "none");
    o.seed = 4;
    expect_error<Misuse>([&] { dataset_command(o); }, {"--seed", "--set seed=4"});
    EXPECT_FALSE(fs::exists(scratch.path("none")));
}

TEST_F(Dataset, a_part_is_one_of_how_many) {
    DatasetOptions o = options(small_recipe + scenes(1, 0, 0), "part");
    for (const char* part : {"3/2", "0/2", "1/0", "2", "1/2/3", "a/b", "-1/2"}) {
        o.part = part;
        expect_error<Misuse>([&] { dataset_command(o); },
                             {"--part", std::string("'").append(part) + "'", "K/N", "1 <= K <= N"});
    }
    EXPECT_FALSE(fs::exists(o.output));
}

TEST_F(Dataset, errors_of_a_scene_name_it) {
    auto refused = [&](const std::string& text, std::initializer_list<std::string> parts) {
        SCOPED_TRACE(text.substr(0, 60));
        DatasetOptions o = options(text + scenes(1, 0, 0), "bad");
        o.overwrite = true;
        expect_error<Misuse>([&] { dataset_command(o); }, parts);
        EXPECT_FALSE(fs::exists(scratch.path("bad")));
    };
    scratch.file("dry.toml", small_base.substr(0, small_base.find("[curl]")));
    refused("scene = \"dry.toml\"\n", {"train-0000", "[wetness]"});
    refused("scene = \"dry.toml\"\n[[pick.w]]\ntext = \"[wetness]\\n[wetness.flow]\"\n",
            {"train-0000", "[wetness.flow]", "stays"});
    refused("seed = 4\nscene = \"base.toml\"\n", {"recipe.toml:2: scene: train-0000 has no [wetness]"});
    // What is drawn for no one.
    const std::string wet = "scene = \"dry.toml\"\n[[pick.w]]\ntext = \"[wetness]\"\n";
    refused(wet + "[draw]\n\"groom.lenght\" = [0.1, 0.2]\n",
            {"recipe.toml:5: draw.groom.lenght", "did you mean 'length'"});
}

TEST_F(Dataset, a_wrong_value_of_a_scene_is_blamed_on_the_line_that_holds_it_before_anything_is_written) {
    auto refused = [&](const std::string& text, std::initializer_list<std::string> parts) {
        SCOPED_TRACE(text);
        expect_error<Misuse>([&] { dataset_command(options(text, "bad")); }, parts);
        EXPECT_FALSE(fs::exists(scratch.path("bad")));
    };
    const std::string wet = "scene = \"base.toml\"\n[[pick.w]]\ntext = \"[wetness]\"\n";  // three lines
    // Of another split than the first.
    refused(wet + "[test_draw]\n\"groom.lenght\" = [0.1, 0.2]\n" + scenes(2, 0, 1),
            {"test-0000", "recipe.toml:5: test_draw.groom.lenght", "did you mean 'length'"});
    refused(wet + "[draw]\n\"wetness.level\" = [2, 3]\n" + scenes(1, 0, 0),
            {"train-0000", "recipe.toml:5: draw.wetness.level", "found 2.", "allowed 0 to 1"});
    // The third line of the text, which begins where it is quoted.
    refused(wet + "[[pick.m]]\ntext = \"\"\"\n\n[motion]\nagnle = 3\"\"\"\n" + scenes(1, 0, 0),
            {"train-0000", "recipe.toml:5: pick.m[0].text:3: motion.agnle", "did you mean 'angle'"});
    refused("low_substeps = [7]\n" + wet + "[[pick.i]]\ntext = '''[integrator]\nkind = \"explicti\"'''\n" +
                scenes(1, 0, 0),
            {"recipe.toml:6: pick.i[0].text:2: integrator.kind", "'explicti'"});
    std::string base = small_base;
    base.replace(base.find("substeps = 2"), 12, "substeps = 0");
    scratch.file("head.toml", base);
    scratch.file("base.toml", "\n\ninclude = \"head.toml\"\n");
    refused(wet + scenes(1, 0, 0), {"train-0000", "head.toml:10: integrator.substeps", "found 0"});
}

// Each key of the recipe, but what is drawn: a value of another kind is refused with its line.
TEST_F(Dataset, every_row_of_a_recipe_refuses_another_kind_with_its_line) {
    size_t rows = 0;
    for (const auto& table : dataset_rows()) {
        EXPECT_TRUE(table.meaning.ends_with("."));
        for (const auto& row : table.rows) {
            SCOPED_TRACE(table.name + " " + row.key);
            EXPECT_TRUE(std::string(row.meaning).ends_with("."));
            if (row.key == std::string(include_row.key)) continue;  // read when a file is loaded
            const std::string header = table.name.empty()       ? ""
                                       : table.name == "splits" ? "[splits]\n"
                                                                : "[[pick.motion]]\n",
                              text = row.key == std::string("scene") ? "" : "scene = \"base.toml\"\n";
            const std::string line = std::string(row.key) + " = {}\n";
            const int place = int(std::count(text.begin(), text.end(), '\n') +
                                  std::count(header.begin(), header.end(), '\n')) +
                              1;
            expect_error<Misuse>([&] { read(text + header + line); },
                                 {":" + std::to_string(place) + ": ", row.key, "needed"});
            ++rows;
        }
    }
    EXPECT_GT(rows, 15u);
}

TEST_F(Dataset, a_box_of_colours_that_is_upside_down_is_refused_with_its_line) {
    const std::string head = "scene = \"base.toml\"\n";
    expect_error<Misuse>([&] { read(head + "box_lower = [0, 0.6, 0]\n" + scenes(1, 0, 0)); },
                         {"recipe.toml:2: box_lower", "found 0.6 to 0.6 along y"});
    expect_error<Misuse>([&] { read(head + "box_upper = [1, 1, -0.7]\n" + scenes(1, 0, 0)); },
                         {"recipe.toml:2: box_upper", "found -0.6 to -0.7 along z"});
}

TEST_F(Dataset, stiff_scenes_run_in_the_precision_that_simulate_trusts) {
    std::string stiff = small_base;
    stiff.replace(stiff.find("[stretch]\n"), 10,
                  "[stretch]\nstiffness = 1e6\n");  // h^2 k / m 5e9, allowed 1e5
    scratch.file("base.toml", stiff);
    EXPECT_EQ(make(options(small_recipe + scenes(1, 0, 0), "stiff")), std::pair(1, true));
}

TEST_F(Dataset, overwriting_leaves_nothing_of_a_split_that_is_gone) {
    make(options(small_recipe + scenes(1, 1, 1), "over"));
    DatasetOptions other = options(small_recipe + scenes(2, 0, 1), "over");
    other.overwrite = true;
    make(other);
    other.output = scratch.path("fresh");
    make(other);
    expect_same("fresh", "over");
}

TEST_F(Dataset, a_changed_base_scene_is_another_recipe) {
    make(options(small_recipe + scenes(1, 0, 0), "mine"));
    scratch.file("base.toml", small_base + "tightness = 0.5\n");
    DatasetOptions o = options(small_recipe + scenes(1, 0, 0), "mine");
    o.resume = true;
    expect_error([&] { dataset_command(o); }, {"mine/recipe.toml", "another recipe"});
}

// An imported groom in the place of the base scene's; another one under its name makes other scenes.
TEST_F(Dataset, a_picked_table_takes_the_place_of_the_base_scenes) {
    auto strands = testing::sample_strands(9, 12);
    for (size_t s = 0; s < strands.size(); ++s)
        for (auto& x : strands[s]) x.x = 0.05 + 0.02 * double(s % 3), x.z = 0.02 * x.z + 0.02 * double(s / 3);
    scratch.file("nine.data", testing::data_file(strands));
    std::string text =
        small_recipe + scenes(2, 0, 0) +
        "[[pick.groom]]\nname = \"nine\"\ntext = '''\n[groom]\nfile = \"nine.data\"\nparticles = 30\n'''\n";
    text.erase(text.find("\"groom.length\" = [0.08"), 30);
    DatasetOptions o = options(text, "imported");
    o.resume = true;
    dataset_command(o);
    EXPECT_EQ(PairsReader(scratch.path("imported/train_strand.h5")).particles(), 30);
    strands.pop_back();
    scratch.file("nine.data", testing::data_file(strands));
    expect_error([&] { dataset_command(o); }, {"imported/recipe.toml", "another recipe"});
}

TEST_F(Dataset, a_first_frame_beyond_the_last_is_refused) {
    for (const char* codec : {"strand", "root"}) {
        std::string text = std::string("codecs = \"") + codec + "\"\n" + small_recipe + scenes(1, 0, 0);
        text.replace(text.find("first = 1"), 9, "first = 7");
        expect_error<Misuse>([&] { dataset_command(options(text, codec)); }, {"first", "7 frames"});
        EXPECT_FALSE(fs::exists(scratch.path(codec)));
    }
}

TEST_F(Dataset, of_scenes_with_several_cohesion_radii_the_whole_names_none) {
    std::string text = "codecs = \"root\"\n" + small_recipe + scenes(2, 0, 0);
    text.insert(text.find("[draw]\n") + 7, "\"cohesion.radius\" = [0.01, 0.02]\n");
    dataset_command(options(text, "radii"));
    auto radius = [&](const char* file) {
        return PairsReader(scratch.path(std::string("radii/") + file)).number("support_radius");
    };
    EXPECT_GT(radius("shards/train-0000_root.h5"), 0);
    EXPECT_NE(radius("shards/train-0000_root.h5"), radius("shards/train-0001_root.h5"));
    EXPECT_EQ(radius("train_root.h5"), 0);
}

}  // namespace
}  // namespace wetcurl

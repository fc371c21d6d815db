// Recipes: every row of the table, and what a malformed one says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>

#include "base/hdf5.h"
#include "base/network_channels.h"
#include "learn/codec/release_recipe.h"
#include "models/model_card.h"
#include "tests/base/scratch.h"
#include "training/metrics_log.h"
#include "training/recipe.h"

namespace wetcurl {
namespace {

using testing::expect_error;
using testing::Scratch;

constexpr Codec codecs[] = {Codec::strand, Codec::root, Codec::adhesion};
const std::vector<std::string> names{"first", "second"};

Recipe with(Codec codec, const std::vector<std::string>& set) {
    TrainRequest request;
    request.set = set;
    return read_recipe(request, codec, names);
}
std::string text(double value) {
    char out[40];
    std::snprintf(out, sizeof out, "%.17g", value);
    return out;
}

TEST(Recipe, DefaultsOfTheRootCodecAreThePapers) {
    const Recipe r = with(Codec::root, {});
    EXPECT_EQ(r.batch, 128);
    EXPECT_EQ(r.learning_rate, 1e-4);
    EXPECT_EQ(r.patch, 128);
    EXPECT_EQ(r.weight_decay, 0);
    EXPECT_EQ(r.schedule, "constant");
    EXPECT_EQ(with(Codec::adhesion, {}).epochs, 9000);
}

TEST(Recipe, DefaultsOfTheStrandCodecAreThoseThatTrained) {
    const Recipe r = with(Codec::strand, {});
    EXPECT_EQ(r.learning_rate, 1e-3);
    EXPECT_EQ(r.gradient_clip, 1);
    EXPECT_EQ(r.schedule, "cosine");
    EXPECT_EQ(r.architecture, "first");
}

// Values that a row must refuse.
std::vector<std::string> refused_by(const KeyRow& row) {
    if (row.kind == Kind::word) return {"3", "no_such_word"};
    if (row.kind == Kind::text) return {"3", "true"};
    if (row.kind == Kind::boolean) return {"1", "'true'"};
    const bool whole = row.kind == Kind::integer;
    std::vector<std::string> out{"'many'", "true", "[1]"};
    for (double value : {row.minimum - 1, row.maximum * 2 + 1})
        out.push_back(whole ? std::to_string(long(value)) : text(value));
    if (whole) out.push_back("2.5");
    return out;
}
// Another one than its default that it takes.
std::string allowed_by(const KeyRow& row, double fallback) {
    if (row.kind == Kind::word) return row.words[size_t(fallback) == 0 ? 1 : 0];
    if (row.kind == Kind::text) return row.key == std::string("leave_out") ? "radius" : "cuda";
    if (row.kind == Kind::boolean) return fallback != 0 ? "false" : "true";
    if (row.kind == Kind::integer) return std::to_string(long(std::min(fallback + 1, row.maximum)));
    return text(row.minimum + 0.5 * (std::min(row.maximum, 2 * fallback + 1) - row.minimum));
}

TEST(Recipe, EveryRowIsReadAndKeptInItsRange) {
    for (Codec codec : codecs)
        for (const auto& row : recipe_rows) {
            const std::string key = row.full_key();
            SCOPED_TRACE(key);
            if (!row.has(codec)) {
                expect_error<Misuse>([&] { with(codec, {key + "=16"}); }, {});  // not of this codec
                continue;
            }
            const std::string other = allowed_by(row, row.default_of(codec));
            const Recipe usual = with(codec, {}), changed = with(codec, {key + "=" + other});
            const bool same = std::visit(
                [&](auto member) {
                    if constexpr (requires { usual.*member == changed.*member; } &&
                                  !std::is_same_v<decltype(member), std::optional<Vec3d> Recipe::*>)
                        return usual.*member == changed.*member;
                    else
                        return true;
                },
                row.member);
            EXPECT_FALSE(same) << other;
            for (const auto& wrong : refused_by(row)) {
                SCOPED_TRACE(wrong);
                expect_error<Misuse>([&] { with(codec, {key + "=" + wrong}); }, {row.key});
            }
        }
}

TEST(Recipe, SaysWhichInputsMayBeLeftOut) {
    const auto& row = *std::ranges::find(recipe_rows, std::string("leave_out"),
                                         [](const RecipeRow& r) { return std::string(r.key); });
    for (const InputGroup& inputs : strand_inputs)
        EXPECT_NE(std::string(row.meaning).find(inputs.name), std::string::npos) << inputs.name;
}

TEST(Recipe, ItsListingHasEachKeyOnceWithADefaultAndASentence) {
    for (Codec codec : codecs) {
        std::set<std::string> keys;
        for (const auto& table : recipe_tables(codec)) {
            EXPECT_TRUE(table.meaning.ends_with("."));
            for (const auto& row : table.rows) {
                EXPECT_TRUE(keys.insert(table.name + "." + row.key).second) << row.key;
                EXPECT_TRUE(std::string(row.meaning).ends_with(".")) << row.key;
                if (row.is_number() && row.has_default()) {
                    EXPECT_TRUE(row.fallback >= row.minimum && row.fallback <= row.maximum) << row.key;
                }
            }
        }
        EXPECT_GT(keys.size(), 12u);
    }
}

TEST(Recipe, UnknownKeysNameFileLineAndTheNearestName) {
    Scratch scratch;
    TrainRequest request;
    request.recipe = scratch.file("my.toml", "epochs = 3\nlerning_rate = 0.1\n");
    expect_error<Misuse>([&] { read_recipe(request, Codec::root, names); },
                         {"my.toml:2", "lerning_rate", "learning_rate"});
    request.recipe = scratch.file("my.toml", "[loss]\nedges = 1\n");
    expect_error<Misuse>([&] { read_recipe(request, Codec::strand, names); }, {"my.toml:2", "edge"});
    request.recipe = scratch.file("my.toml", "epochs = \n");
    expect_error<Misuse>([&] { read_recipe(request, Codec::strand, names); }, {"my.toml:1"});
    request.recipe = scratch.path("absent.toml");
    expect_error([&] { read_recipe(request, Codec::strand, names); }, {"absent.toml"});
}

TEST(Recipe, PredictsWhatItBeganWithDoesUnlessItSays) {
    Scratch scratch;
    TrainRequest request;
    EXPECT_EQ(read_recipe(request, Codec::strand, names).target, "strands");
    request.target = "displayed";  // of the model
    EXPECT_EQ(read_recipe(request, Codec::strand, names).target, "displayed");
    request.set = {"target=strands"};
    EXPECT_EQ(read_recipe(request, Codec::strand, names).target, "strands");
    request.set.clear();
    request.recipe = scratch.file("my.toml", "target = \"strands\"\n");
    EXPECT_EQ(read_recipe(request, Codec::strand, names).target, "strands");
}

TEST(Recipe, ATableReleaseIsCheckedAndChangesNothing) {
    Scratch scratch;
    TrainRequest request;
    request.recipe = scratch.file("plain.toml", "epochs = 3\n");
    const std::string plain = read_recipe(request, Codec::strand, names).text;
    request.recipe =
        scratch.file("my.toml", "epochs = 3\n[release]\nfrom = \"other.toml\"\ndataset = \"many.toml\"\n");
    EXPECT_EQ(read_recipe(request, Codec::strand, names).text, plain);
    const ReleaseRecipe release = read_release(Config::load(request.recipe).root());
    EXPECT_EQ(release.from, scratch.path("other.toml"));
    EXPECT_EQ(release.dataset, scratch.path("many.toml"));
    EXPECT_TRUE(release.present);
    EXPECT_FALSE(read_release(Config::load(scratch.path("plain.toml")).root()).present);

    request.recipe = scratch.file(
        "my.toml", "[[release.scene]]\nfile = \"a.toml\"\n[[release.scene]]\nfile = \"b.toml\"\n");
    read_recipe(request, Codec::adhesion, names);
    const auto scenes = read_release(Config::load(request.recipe).root()).scenes;
    ASSERT_EQ(scenes.size(), 2u);
    EXPECT_EQ(scenes[0].file, scratch.path("a.toml"));
    EXPECT_EQ(scenes[1].file, scratch.path("b.toml"));
    EXPECT_EQ(scenes[0].low_strands, 0);
    auto expect_refused = [&](const char* wrong, std::initializer_list<std::string> why) {
        request.recipe = scratch.file("my.toml", wrong);
        expect_error<Misuse>([&] { read_recipe(request, Codec::strand, names); }, why);
    };
    expect_refused("[release]\ndatset = \"a.toml\"\n", {"my.toml:2", "datset", "did you mean 'dataset'"});
    expect_refused("[release]\nfrom = \"a.toml\"\n", {"my.toml:1", "neither"});
    expect_refused("[release]\ndataset = \"a.toml\"\n[[release.scene]]\nfile = \"b.toml\"\n", {"both"});
    expect_refused("[[release.scene]]\nfiles = \"b.toml\"\n", {"my.toml:2", "did you mean 'file'"});
    expect_refused("[[release.scene]]\nfile = \"a.toml\"\nframes = 3\n", {"my.toml:3", "low_strands"});
    expect_refused(
        "[[release.scene]]\nfile = \"a.toml\"\nlow_strands = 4\n[[release.scene]]\nfile = \"b.toml\"\n",
        {"low_strands", "all or none"});
}

TEST(Recipe, EveryReleasedModelWasTrainedByItsRecipe) {
    int models = 0;
    for (const auto& entry : std::filesystem::directory_iterator(WETCURL_SOURCE_DIR "/models/weights")) {
        if (entry.path().extension() != ".h5") continue;
        const H5Reader model(entry.path(), model_format, model_version);
        const Codec codec = codec_named(model.text("codec"));
        const char* const usual[] = {"strand_mlp", "unet_vgg19", "adhesion_mlp"};
        TrainRequest request;
        request.recipe = entry.path().parent_path() / "recipes" / entry.path().stem().concat(".toml");
        EXPECT_EQ(read_recipe(request, codec, {usual[size_t(codec)], model.text("architecture")}).text,
                  model.text("recipe"))
            << request.recipe;
        ++models;
    }
    EXPECT_GT(models, 5);
}

TEST(Recipe, MessagesNameTheOptionThatGaveTheValue) {
    for (const double width : {0.0, -1.0, 20.0, std::numeric_limits<double>::quiet_NaN()}) {
        TrainRequest request;
        request.width = width;
        expect_error<Misuse>([&] { read_recipe(request, Codec::root, names); },
                             {"--width: found", "0.001 to 16"});
    }
    TrainRequest request;
    request.seed = -1;
    expect_error<Misuse>([&] { read_recipe(request, Codec::root, names); }, {"--seed: found -1", "0 to "});
}

TEST(Recipe, WordsAreChosenFromAList) {
    expect_error<Misuse>([] { with(Codec::root, {"architecture=third"}); }, {"third", "second"});
    expect_error<Misuse>([] { with(Codec::root, {"schedule=linear"}); }, {"linear", "cosine"});
    expect_error<Misuse>([] { with(Codec::root, {"precision=double"}); }, {"double", "bfloat16"});
    expect_error<Misuse>([] { with(Codec::root, {"reconstruct.units=print"}); },
                         {"print", "length, printed"});
    expect_error<Misuse>([] { with(Codec::strand, {"reconstruct.units=length"}); }, {"reconstruct"});
}

TEST(Recipe, ALossWithoutWeightsIsRefused) {
    expect_error<Misuse>([] { with(Codec::strand, {"loss.position=0", "loss.edge=0"}); }, {"[loss]"});
}

TEST(Recipe, WhatTheCommandLineSaysGoesFirst) {
    TrainRequest request;
    request.set = {"width=0.5", "seed=3", "architecture=first", "device=cpu"};
    request.width = 0.25;
    request.seed = 9;
    request.architecture = "second";
    request.device = "cuda:1";
    const Recipe r = read_recipe(request, Codec::root, names);
    EXPECT_EQ(r.width, 0.25);
    EXPECT_EQ(r.seed, 9);
    EXPECT_EQ(r.architecture, "second");
    EXPECT_EQ(r.device, "cuda:1");
}

TEST(Recipe, TheTextKeptWithAModelReadsBackAsItself) {
    Scratch scratch;
    for (Codec codec : codecs) {
        const Recipe r = with(codec, {"learning_rate=0.00123456789", "seed=77", "width=0.3"});
        TrainRequest request;
        request.recipe = scratch.file("kept.toml", r.text);
        EXPECT_EQ(read_recipe(request, codec, names).text, r.text);
        EXPECT_NE(r.text.find("0.00123456789"), std::string::npos);
    }
}

TEST(MetricsLog, GoesOnWhereACheckpointWasAndDropsTheRest) {
    Scratch scratch;
    const std::string path = scratch.path("m.jsonl");
    long position = 0;
    {
        MetricsLog log(path, 0);
        log.line({{"epoch", 1}, {"loss", 0.5}});
        position = log.position();
        log.line({{"epoch", 2}, {"loss", 0.25}});
    }
    {
        MetricsLog log(path, position);
        EXPECT_EQ(log.position(), position);
        log.line({{"epoch", 2}, {"loss", 0.125}});
    }
    EXPECT_EQ(testing::bytes_of(path), "{\"epoch\":1,\"loss\":0.5}\n{\"epoch\":2,\"loss\":0.125}\n");
}

TEST(MetricsLog, IsNotCutByAnotherTraining) {
    Scratch scratch;
    const std::string path = scratch.path("m.jsonl");
    MetricsLog log(path, 0);
    log.line({{"epoch", 1}});
    testing::expect_error([&] { MetricsLog(path, 0); }, {path, "writes it"});
    log.line({{"epoch", 2}});
    EXPECT_EQ(testing::bytes_of(path), "{\"epoch\":1}\n{\"epoch\":2}\n");
}

}  // namespace
}  // namespace wetcurl

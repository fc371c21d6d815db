// What commands do with their files and with one another's results: nothing is lost, nothing is silent.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <iterator>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/commands/compare.h"
#include "app/commands/encode.h"
#include "app/commands/infer.h"
#include "app/commands/inspect.h"
#include "app/commands/render.h"
#include "app/commands/simulate.h"
#include "app/commands/train.h"
#include "app/engine/device.h"
#include "app/engine/run_of_scene.h"
#include "app/files/results.h"
#include "app/measures/metrics.h"
#include "base/interrupt.h"
#include "base/provenance.h"
#include "base/run_cache.h"
#include "learn/codec/network_module.h"
#include "learn/codec/pairs.h"
#include "tests/base/scratch.h"

namespace wetcurl {
namespace {

namespace fs = std::filesystem;
using testing::bytes_of;
using testing::expect_error;
using testing::Scratch;

constexpr const char* small_scene = "frames = 3\n[groom]\ngrid = [8, 8]\nparticles = 10\n[stretch]\n[bend]\n";

// Wet curls of two turns, near enough to be drawn together.
const std::string wet_scene =
    "frames = 4\n[groom]\ngrid = [8, 8]\nparticles = 25\nlength = 0.1\npitch = 0.04\n[integrator]\n"
    "substeps = 4\n[stretch]\n[bend]\n[core]\n[wetness]\n[curl]\n[cohesion]\nradius = 0.03\n";

class Commands : public ::testing::Test {
  protected:
    SimulateOptions simulation(const std::string& output, int strands) const {
        SimulateOptions o;
        o.scene = scratch.file("scene.toml", small_scene);
        o.output = scratch.path(output);
        o.strands = strands;
        o.threads = 1;
        return o;
    }
    InferOptions inference(const std::string& interpolate, int roots) const {
        InferOptions o;
        o.input = scratch.path("low.h5");
        o.interpolate = interpolate;
        o.roots = roots;
        o.output = scratch.path(interpolate + std::to_string(roots) + ".h5");
        return o;
    }
    Scratch scratch;
};

TEST_F(Commands, an_output_that_is_an_input_is_refused_before_anything_is_written) {
    const std::string input = scratch.file("a.h5", "mine"), linked = scratch.path("linked.h5");
    fs::create_symlink(input, linked);
    CommonOptions o;
    o.overwrite = true;
    for (const std::string& output : {input, linked, scratch.path("./a.h5")})
        expect_error<Misuse>([&] { check_files(o, output, {"", input}); }, {output, "destroy", input});
    // The writers begin with NAME.partial.
    const std::string left = scratch.file("b.h5.partial", "kept");
    expect_error<Misuse>([&] { check_files(o, scratch.path("b.h5"), {left}); }, {"b.h5.partial"});
    o.json = input;
    expect_error<Misuse>([&] { check_files(o, "", {input}); }, {"destroy"});
    o.json = scratch.path("c.h5");
    expect_error<Misuse>([&] { check_files(o, scratch.path("./c.h5"), {}); }, {"--json", "c.h5"});
    EXPECT_EQ(bytes_of(input), "mine");
    EXPECT_NO_THROW(check_files(o, scratch.path("d.h5"), {input, left}));
}

TEST_F(Commands, json_is_not_overwritten_unasked) {
    CommonOptions o;
    o.json = scratch.file("out.json", "mine");
    expect_error([&] { check_files(o, "", {}); }, {"out.json", "--overwrite"});
    o.overwrite = true;
    EXPECT_NO_THROW(check_files(o, "", {}));
    o.overwrite = false;
    for (const std::string& free : std::vector<std::string>{"-", "/dev/null", scratch.path("new.json")}) {
        o.json = free;
        EXPECT_NO_THROW(check_files(o, "", {})) << free;
    }
}

TEST_F(Commands, json_gets_its_folder_before_the_work_begins) {
    CommonOptions o;
    o.json = scratch.path("new/folder/out.json");
    check_files(o, "", {});
    EXPECT_TRUE(fs::is_directory(scratch.path("new/folder")));
    o.json = scratch.path("new");
    expect_error([&] { check_files(o, "", {}); }, {"new: is a folder"});
    o.json = scratch.file("file", "") + "/out.json";
    expect_error([&] { check_files(o, "", {}); }, {"file/out.json", "folder cannot be made"});
}

TEST_F(Commands, what_cannot_be_written_is_refused_before_the_work_begins) {
    SimulateOptions o = simulation("run.h5", 16);
    o.json = scratch.path(std::string(300, 'a'));
    expect_error([&] { simulate_command(o); }, {"aaa", "too long"});
    o.json.clear();
    o.output = scratch.file("file", "") + "/folder/run.h5";
    expect_error([&] { simulate_command(o); }, {"run.h5: cannot be written", "file is no folder"});
    EXPECT_FALSE(fs::exists(scratch.path("run.h5")));
    EXPECT_NO_THROW(check_files({}, scratch.path("new/folder/run.h5"), {}));
    EXPECT_FALSE(fs::exists(scratch.path("new")));
}

TEST_F(Commands, json_is_utf8_whatever_the_names_of_files_are) {
    const std::string path = scratch.path("named.json"), name = "hair\xff\xfe.h5";
    ResultFile(path, false).write_json(Json{{"file", name}});
    EXPECT_EQ(Json::parse(bytes_of(path))["file"], "hair\xef\xbf\xbd\xef\xbf\xbd.h5");
    simulate_command(simulation("run.h5", 16));
    fs::copy_file(scratch.path("run.h5"), scratch.path(name));
    CompareOptions c;
    c.reference = scratch.path("run.h5"), c.others = {scratch.path(name)};
    c.json = scratch.path("compared.json");
    ::testing::internal::CaptureStdout();
    EXPECT_EQ(compare_command(c), 0);
    ::testing::internal::GetCapturedStdout();
    EXPECT_EQ(Json::parse(bytes_of(c.json))["others"].size(), 1u);
}

TEST_F(Commands, json_says_what_made_it) {
    const std::string path = scratch.path("a.json");
    ResultFile(path, false).write_json({{"answer", 1}});
    const Json json = Json::parse(bytes_of(path));
    EXPECT_EQ(json.at("answer"), 1);
    EXPECT_EQ(json.at("provenance").size(), provenance().size());
    for (const auto& [name, text] : provenance()) EXPECT_EQ(json.at("provenance").at(name), text);
}

// On a device where there is one, else an error that says what is missing.
TEST_F(Commands, interpolation_runs_where_it_is_told) {
    simulate_command(simulation("low.h5", 16));
    InferOptions infer = inference("quad", 4);
    infer_command(infer);
    const std::string on_cpu = infer.output;
    infer.output = scratch.path("there.h5"), infer.device = "cuda";
    if (names_of_cuda_devices().empty()) {
        expect_error<Error>([&] { infer_command(infer); }, {"--device cuda"});
        EXPECT_FALSE(fs::exists(infer.output));
        return;
    }
    infer_command(infer);
    const Strands there = RunReader(infer.output).frame(1).positions,
                  here = RunReader(on_cpu).frame(1).positions;
    for (size_t k = 0; k < here.points.size(); ++k) EXPECT_LT(norm(there.points[k] - here.points[k]), 1e-6);
}

TEST_F(Commands, options_that_nothing_reads_are_refused) {
    simulate_command(simulation("low.h5", 16));
    InferOptions infer = inference("quad", 4);
    infer.set = {"frames=2"};
    expect_error<Misuse>([&] { infer_command(infer); }, {"--set frames=2", "--wetness"});
    infer.set.clear();
    infer.oracle_colours = "low.h5", infer.interpolate.clear(), infer.device = "cuda";
    expect_error<Misuse>([&] { infer_command(infer); }, {"skin and oracles run on the CPU alone"});
    InspectOptions inspect;
    inspect.what = "schema";
    inspect.file = "a.h5";
    expect_error<Misuse>([&] { inspect_command(inspect); }, {"a.h5", "none is needed"});
    EXPECT_FALSE(fs::exists(infer.output));
}

// The message of an Error that `run` throws.
template <class Run>
std::string error_of(Run run) {
    try {
        run();
    } catch (const Error& e) {
        return e.what();
    }
    ADD_FAILURE() << "no Error";
    return "";
}

// The commands that an error message lists, a line each: without the name of the program.
std::vector<std::string> commands_in(const std::string& message) {
    std::vector<std::string> out;
    std::istringstream lines(message);
    const std::string start = "  wetcurl ";
    for (std::string line; std::getline(lines, line);)
        if (line.starts_with(start)) out.push_back(line.substr(start.size()));
    return out;
}

TEST_F(Commands, infer_of_a_learned_scene_says_which_model_is_missing_before_it_simulates) {
    InferOptions o;
    o.input = scratch.file("plain.toml", small_scene);
    o.output = scratch.path("learned.h5");
    expect_error<Misuse>([&] { infer_command(o); }, {"--model", "--interpolate", "[learned]"});
    o.input = scratch.file("learned.toml", std::string(small_scene) + "[learned]\nmodel = \"absent.h5\"\n");
    o.set = {"frames=2", "title=two words"};
    const std::string said = error_of([&] { infer_command(o); });
    EXPECT_NE(said.find("learned.toml: [learned] model names it"), std::string::npos) << said;
    const std::string set = " --set frames=2 --set 'title=two words'", folder = scratch.path() + "/";
    EXPECT_EQ(commands_in(said),
              (std::vector<std::string>{
                  "simulate " + folder + "learned.toml --dry --strands 16" + set + " -o " + folder +
                      "absent_dry.h5",
                  "simulate " + folder + "learned.toml" + set + " -o " + folder + "absent_wet.h5",
                  "encode " + folder + "absent_dry.h5 " + folder + "absent_wet.h5 --codec strand -o " +
                      folder + "absent_pairs.h5",
                  "train sr " + folder + "absent_pairs.h5 -o " + folder + "absent.h5"}));
    EXPECT_FALSE(fs::exists(o.output) || fs::exists(partial_of(o.output)));
    o.interpolate = "quad";  // needs none
    EXPECT_EQ(infer_command(o), 0);

    // Of a run, which is the low-resolution one already.
    SimulateOptions low = simulation("low.h5", 16);
    low.scene = o.input, low.set = o.set, low.dry = true;
    simulate_command(low);
    InferOptions run;
    run.input = low.output, run.output = scratch.path("again.h5");
    const auto commands = commands_in(error_of([&] { infer_command(run); }));
    ASSERT_EQ(commands.size(), 3u);
    EXPECT_EQ(commands[0], "simulate " + run.input + " -o " + folder + "absent_wet.h5");
    EXPECT_NE(commands[1].find("encode " + run.input + " "), std::string::npos) << commands[1];
}

TEST_F(Commands, a_missing_adhesion_model_is_named_with_the_commands_of_its_own_scene) {
    const std::string scene =
        std::string(small_scene) + "[wetness]\n[adhesion]\n[[solid]]\nshape = \"sphere\"\nradius = 0.09\n";
    const std::string folder = scratch.path() + "/";
    scratch.file("adhesion_recipe.toml", "epochs = 1\n");
    auto wanted = [&](const std::string& name) {
        return std::vector<std::string>{
            "encode " + folder + name + " --codec adhesion -o " + folder + "absent_pairs.h5",
            "train adhesion " + folder + "absent_pairs.h5 --recipe " + folder + "adhesion_recipe.toml -o " +
                folder + "absent.h5"};
    };
    InferOptions infer;
    infer.input = scratch.file("stick.toml", scene + "[learned]\nmodel = \"absent.h5\"\n");
    infer.output = scratch.path("learned.h5");
    EXPECT_EQ(commands_in(error_of([&] { infer_command(infer); })), wanted("stick.toml"));
    // A way of reconstruction is for a model of images.
    infer.reconstruct = "core";
    EXPECT_NE(error_of([&] { infer_command(infer); }).find("--codec root"), std::string::npos);

    SimulateOptions simulate;
    simulate.scene = scratch.file("model.toml", scene);
    simulate.set = {"adhesion.model=absent.h5"};
    simulate.output = scratch.path("wet.h5"), simulate.threads = 1;
    const std::string said = error_of([&] { simulate_command(simulate); });
    EXPECT_NE(said.find("model.toml: [adhesion] model names it"), std::string::npos) << said;
    EXPECT_EQ(commands_in(said), wanted("model.toml"));
    simulate.dry = true;  // needs none
    EXPECT_EQ(simulate_command(simulate), 0);
}

TEST_F(Commands, encode_and_simulate_keep_their_inputs) {
    SimulateOptions o = simulation("scene.toml", 16);
    o.overwrite = true;
    expect_error<Misuse>([&] { simulate_command(o); }, {"scene.toml", "destroy"});
    EXPECT_EQ(bytes_of(o.scene), small_scene);
    scratch.file("part.toml", "[stretch]\n[bend]\n");
    o.scene = scratch.file("whole.toml", "include = \"part.toml\"\nframes = 2\n[groom]\ngrid = [4, 4]\n");
    o.output = scratch.path("part.toml");
    expect_error<Misuse>([&] { simulate_command(o); }, {"part.toml", "destroy"});
    EncodeOptions e;
    e.inputs = {scratch.file("dry.h5", "dry"), scratch.file("wet.h5", "wet")};
    e.output = e.inputs[0];
    e.overwrite = true;
    expect_error<Misuse>([&] { encode_command(e); }, {"dry.h5", "destroy"});
    EXPECT_EQ(bytes_of(e.inputs[0]), "dry");
}

TEST_F(Commands, a_run_is_simulated_again_to_the_bit) {
    SimulateOptions first = simulation("first.h5", 16);
    simulate_command(first);
    SimulateOptions again = first;
    again.scene = first.output, again.output = scratch.path("again.h5");
    simulate_command(again);
    const RunReader a(first.output), b(again.output);
    ASSERT_EQ(a.frames(), b.frames());
    for (int f = 0; f < a.frames(); ++f)
        for (size_t k = 0; k < a.frame(f).positions.points.size(); ++k)
            ASSERT_EQ(norm(a.frame(f).positions.points[k] - b.frame(f).positions.points[k]), 0);
    // By its content, whatever its name: an interrupted run is NAME.partial.
    again.scene = scratch.path("first.h5.partial"), again.output = scratch.path("third.h5");
    fs::copy_file(first.output, again.scene);
    simulate_command(again);
    EXPECT_EQ(norm(RunReader(again.output).frame(2).positions.at(3, 9) - a.frame(2).positions.at(3, 9)), 0);
    // With other options it is another.
    again.scene = first.output, again.output = scratch.path("other.h5"),
    again.set = {"integrator.substeps=2"};
    simulate_command(again);
    EXPECT_GT(norm(RunReader(again.output).frame(2).positions.at(3, 9) - a.frame(2).positions.at(3, 9)), 0);
    again.output = again.scene, again.overwrite = true;
    expect_error<Misuse>([&] { simulate_command(again); }, {"first.h5", "destroy"});
}

TEST_F(Commands, a_network_asks_for_the_substeps_of_the_runs_that_it_learned_from) {
    auto run = [&](const std::string& output, int strands, bool dry, int substeps) {
        SimulateOptions o = simulation(output, strands);
        o.scene = scratch.file("wet.toml", wet_scene);
        o.dry = dry;
        o.set = {"integrator.substeps=" + std::to_string(substeps)};
        simulate_command(o);
        return o.output;
    };
    const std::string wet = run("wet.h5", 64, false, 4), low = run("low.h5", 16, true, 4),
                      coarse = run("coarse.h5", 16, true, 2);
    auto encode = [&](const std::string& output, const std::vector<std::string>& inputs) {
        EncodeOptions o;
        o.inputs = inputs;
        o.output = scratch.path(output);
        encode_command(o);
        return o.output;
    };
    const std::string pairs = encode("pairs.h5", {low, wet});
    EXPECT_EQ(PairsReader(pairs).low_substeps(), 4);
    EXPECT_EQ(PairsReader(encode("both.h5", {coarse, wet, low, wet})).low_substeps(), 2);

    TrainRequest train;
    train.kind = "sr";
    train.pairs = {pairs};
    train.output = scratch.path("model.h5");
    train.set = {"epochs=1", "width=0.1"};
    train.threads = 1;
    network_module().train(train);
    EXPECT_EQ(network_module().card(train.output).low_substeps, 4);

    InferOptions o;
    o.model = train.output;
    o.threads = 1;
    o.overwrite = true;
    // What it says on the way.
    auto infer = [&](const std::string& input, const std::vector<std::string>& set = {}) {
        o.input = input, o.set = set, o.output = scratch.path("learned.h5");
        ::testing::internal::CaptureStderr();
        EXPECT_EQ(infer_command(o), 0);
        return ::testing::internal::GetCapturedStderr();
    };
    const std::string warning = "learned from runs of 4 or more";
    EXPECT_EQ(infer(low).find(warning), std::string::npos);
    const std::string said = infer(coarse);
    for (const char* part : {warning.c_str(), "coarse.h5", "2 substeps a frame"})
        EXPECT_NE(said.find(part), std::string::npos) << part << " in " << said;
    auto made = [&] { return substeps_of(RunReader(scratch.path("learned.h5")).header()); };
    EXPECT_EQ(infer(scratch.path("wet.toml")).find(warning), std::string::npos);
    EXPECT_EQ(made(), 4);
    EXPECT_NE(infer(scratch.path("wet.toml"), {"integrator.substeps=3"}).find(warning), std::string::npos);
    EXPECT_EQ(made(), 3);
}

// From guides; all strands that are not trusted are simulated, so that with none trusted it is the
// simulation.
TEST_F(Commands, a_network_says_how_far_it_is_off_and_within_simulates_what_is_farther) {
    SimulateOptions s = simulation("wet.h5", 64);
    s.scene = scratch.file("wet.toml", wet_scene);
    simulate_command(s);
    s.output = scratch.path("low.h5"), s.strands.reset(), s.guides = 16, s.dry = true;
    simulate_command(s);
    EXPECT_EQ(RunReader(s.output).header().groom.rest.count, 16);
    EXPECT_EQ(RunReader(s.output).header().guides, 16);
    InferOptions o;
    o.input = s.output, o.overwrite = true, o.threads = 1;
    for (const char* model : {"displayed_s", "strand_m"}) {
        o.model = std::string(WETCURL_SOURCE_DIR "/models/weights/") + model + ".h5";
        auto infer = [&](const std::string& output, std::optional<double> within) {
            o.output = scratch.path(output), o.within = within;
            EXPECT_EQ(infer_command(o), 0);
            return std::make_unique<RunReader>(o.output);
        };
        auto error_mm = [&](const RunReader& run) {
            return compare(RunReader(scratch.path("wet.h5")), run, 0, {}).position_mm.mean;
        };
        const auto plain = infer("plain.h5", {}), trusting = infer("trusting.h5", 1e6),
                   none = infer("none.h5", 0);
        const std::vector<int> followed = plain->header().followed.value();
        const Strands few = RunReader(o.input).header().groom.rest, all = plain->header().groom.rest;
        ASSERT_EQ(followed.size(), 16u);
        for (size_t k = 0; k < 16; ++k) EXPECT_LT(norm(few.at(int(k), 24) - all.at(followed[k], 24)), 1e-6);
        const RunFrame a = plain->frame(2), b = trusting->frame(2);
        ASSERT_EQ(a.expected_error.size(), size_t(64 * 8));
        for (float e : a.expected_error) EXPECT_GT(e, 0);
        EXPECT_EQ(a.seen().points.size(), b.seen().points.size());
        for (size_t k = 0; k < a.seen().points.size(); ++k)
            ASSERT_EQ(norm(a.seen().points[k] - b.seen().points[k]), 0);
        EXPECT_GT(error_mm(*plain), 0.05);
        EXPECT_LT(error_mm(*none), 1e-3);
        for (float e : none->frame(2).expected_error) EXPECT_EQ(e, 0);
        // Half of them: those that it expects to be off most.
        std::vector<std::pair<double, int>> expected(64, {0, 0});
        for (int f = 0; f < plain->frames(); ++f)
            for (int strand = 0; strand < 64; ++strand) {
                expected[size_t(strand)].second = strand;
                for (int k = 0; k < 8; ++k)
                    expected[size_t(strand)].first +=
                        double(plain->frame(f).expected_error[size_t(strand * 8 + k)]) / 8 / plain->frames();
            }
        std::sort(expected.begin(), expected.end());
        const auto half = infer("half.h5", 1e3 * 0.5 * (expected[31].first + expected[32].first));
        for (int k = 0; k < 64; ++k)
            EXPECT_EQ(half->frame(2).expected_error[size_t(expected[size_t(k)].second * 8)] == 0, k >= 32)
                << k;
        EXPECT_LT(error_mm(*half), error_mm(*plain));
        const Comparison told = compare(RunReader(scratch.path("wet.h5")), *plain, 0, {});
        ASSERT_TRUE(told.expected_rank && told.expected_mm);
        EXPECT_LE(std::abs(*told.expected_rank), 1);
        EXPECT_GT(*told.expected_mm, 0);
    }
    o = inference("quad", 4);
    o.within = 5;
    expect_error<Misuse>([&] { infer_command(o); },
                         {"--within: found with --interpolate quad", "models of whole"});
}

// A network that learned from one run alone: in it nothing is new to it; under a head that turns faster, and
// with other hair, much is.
TEST_F(Commands, infer_says_how_far_hair_lies_outside_of_what_a_network_learned_from) {
    SimulateOptions s = simulation("wet.h5", 64);
    s.scene = scratch.file("wet.toml", wet_scene + "[motion]\nperiod = 1\nangle = 10\n");
    s.frames = 9;
    simulate_command(s);
    s.output = scratch.path("low.h5"), s.strands = 16, s.dry = true;
    simulate_command(s);
    EncodeOptions encode;
    encode.inputs = {scratch.path("low.h5"), scratch.path("wet.h5")}, encode.codec = "strand";
    encode.output = scratch.path("pairs.h5"), encode.threads = 1;
    encode_command(encode);
    TrainOptions train;
    train.kind = "sr", train.pairs = {encode.output}, train.architecture = "strand_linear";
    train.threads = 1, train.output = scratch.path("model.h5"), train.set = {"epochs=1", "validation=0"};
    train_command(train);

    InferOptions o;
    o.model = train.output, o.input = s.output, o.threads = 1, o.overwrite = true;
    o.output = scratch.path("out.h5"), o.json = scratch.path("out.json");
    auto found = [&] {
        EXPECT_EQ(infer_command(o), 0);
        return Json::parse(bytes_of(o.json))["outside_of_training"];
    };
    Json outside = found();
    EXPECT_EQ(outside["share"], 0) << outside;
    EXPECT_TRUE(outside["inputs"].empty());
    s.scene =
        scratch.file("faster.toml", wet_scene + "[motion]\nperiod = 1\nangle = 40\n[stiffness]\ndry = 9\n");
    s.output = o.input = scratch.path("faster.h5");
    simulate_command(s);
    outside = found();
    EXPECT_EQ(outside["share"], 1) << outside;
    double drag = 0, turning = 0;
    for (const Json& kind : outside["inputs"]) {
        if (kind["input"] == "drag when dry") drag = kind["share"];
        if (kind["input"] == "turning") turning = kind["most"];
    }
    EXPECT_EQ(drag, 1) << outside;
    EXPECT_GT(turning, 0.5) << outside;  // four times as fast
    // A network of an earlier version does not know.
    o.model = WETCURL_SOURCE_DIR "/models/weights/displayed_s.h5";
    if (network_module().card(o.model).arrays.count("input_low") == 0) {
        EXPECT_TRUE(found().is_null());
    }
}

// Networks of displayed strands run without what would keep hair out of a shoulder.
TEST_F(Commands, a_displayed_network_refuses_a_solid_that_is_not_the_heads_before_anything_is_simulated) {
    const std::string model = WETCURL_SOURCE_DIR "/models/weights/displayed_s.h5";
    InferOptions o;
    o.model = model;
    o.output = scratch.path("learned.h5");
    o.input =
        scratch.file("shoulder.toml", wet_scene + "[[solid]]\nname = \"shoulder\"\nshape = \"plane\"\n");
    o.threads = 1;
    expect_error([&] { infer_command(o); }, {"shoulder.toml", "'shoulder'", "not attached to the head"});
    EXPECT_FALSE(fs::exists(o.output) || fs::exists(partial_of(o.output)));
    o.input = scratch.file("free.toml", wet_scene);
    infer_command(o);
    const RunReader run(o.output);
    EXPECT_EQ(run.header().method, "strand_depthwise displayed_s");
    EXPECT_EQ(run.frame(2).displayed.count, 0);  // Eq 10 is in the network
    // It follows where asked for, in as many passes.
    const Vec3f alone = run.frame(3).seen().at(20, 24);
    InferOptions more = o;
    SimulateOptions low = simulation("low.h5", 16);
    low.scene = o.input, low.dry = true;
    low.set = {"integrator.substeps=" + std::to_string(substeps_of(run.header()))};
    simulate_command(low);
    more.input = low.output, more.cohesion = true, more.overwrite = true;
    std::vector<Vec3f> tips;
    for (int passes : {1, 6}) {
        more.output = scratch.path("more" + std::to_string(passes) + ".h5"), more.passes = passes;
        infer_command(more);
        tips.push_back(RunReader(more.output).frame(3).seen().at(20, 24));
    }
    EXPECT_GT(norm(tips[0] - alone), 1e-6);
    EXPECT_GT(norm(tips[1] - tips[0]), 1e-6);
    more.output = scratch.path("some.h5"), more.spacing = 0.02;
    infer_command(more);
    const float apart = norm(RunReader(more.output).frame(3).seen().at(20, 24) - tips[1]);
    EXPECT_GT(apart, 1e-7);
    EXPECT_LT(apart, 0.7f * norm(tips[1] - alone));
    more.cohesion = false;
    expect_error<Misuse>([&] { infer_command(more); }, {"--passes", "--cohesion"});
    more.passes.reset();
    expect_error<Misuse>([&] { infer_command(more); }, {"--spacing", "--cohesion"});
    // By default 8 of each 14 of the scene's.
    more.spacing.reset(), more.cohesion = true;
    more.wetness = o.input, more.set = {"cohesion.passes=14"}, more.output = scratch.path("default.h5");
    auto tip = [&](std::optional<int> passes) {
        more.passes = passes;
        infer_command(more);
        return RunReader(more.output).frame(3).seen().at(20, 24);
    };
    const Vec3f by_default = tip({});
    EXPECT_EQ(norm(by_default - tip(8)), 0);
    EXPECT_GT(norm(by_default - tip(14)), 1e-6);
    for (const Vec3f& p : run.frame(3).positions.points) EXPECT_LT(norm(p), 1);
}

TEST_F(Commands, three_roots_give_other_strands_than_four) {
    simulate_command(simulation("low.h5", 16));
    for (const std::string kind : {"quad", "core", "rest"}) {
        for (int roots : {3, 4}) infer_command(inference(kind, roots));
        const RunReader three(scratch.path(kind + "3.h5")), four(scratch.path(kind + "4.h5"));
        EXPECT_EQ(three.header().method, kind + " interpolation, 3 roots");
        EXPECT_EQ(four.header().method, kind + " interpolation");
        const Strands a = three.frame(2).positions, b = four.frame(2).positions;
        ASSERT_EQ(a.count, 64);
        float largest = 0;
        for (int s = 0; s < a.count; ++s) {
            EXPECT_NEAR(norm(a.at(s, 0) - b.at(s, 0)), 0, 1e-6);  // roots are exact
            largest = std::max(largest, norm(a.at(s, 9) - b.at(s, 9)));
        }
        EXPECT_GT(largest, 1e-4);
        EXPECT_LT(largest, 0.5);
    }
    expect_error<Misuse>([&] { infer_command(inference("nearest", 3)); }, {"--roots 3", "nearest"});
}

TEST_F(Commands, rest_with_its_water_curls_the_strands_and_draws_them_together) {
    SimulateOptions low = simulation("low.h5", 16);
    low.scene = scratch.file("wet.toml", wet_scene);
    low.dry = true;
    simulate_command(low);
    auto inferred = [&](bool wet_shape, bool cohesion, const std::string& input = "low.h5") {
        InferOptions o = inference("rest", 4);
        o.input = scratch.path(input);
        o.wet_shape = wet_shape, o.cohesion = cohesion;
        o.overwrite = true;
        EXPECT_EQ(infer_command(o), 0);
        const RunReader run(o.output);
        EXPECT_EQ(run.header().method, std::string("rest interpolation") + (wet_shape ? ", Eq 9" : "") +
                                           (cohesion ? ", Eq 10" : ""));
        EXPECT_EQ(run.frames(), 4);
        return run.frame(3);
    };
    auto moved = [](const Strands& a, const Strands& b) {
        double sum = 0;
        for (size_t k = 0; k < a.points.size(); ++k) sum += norm(a.points[k] - b.points[k]);
        return sum / double(a.points.size());
    };
    const RunFrame plain = inferred(false, false), shaped = inferred(true, false),
                   both = inferred(true, true);
    ASSERT_EQ(plain.positions.count, 64);
    EXPECT_EQ(plain.displayed.count, 0);
    // Eq 9 contracts drenched hair to 0.75 of its extent: a tip 0.1 m down the strand rises by some 2 cm.
    EXPECT_GT(moved(shaped.positions, plain.positions), 2e-3);
    EXPECT_LT(moved(shaped.positions, plain.positions), 0.025);
    // Eq 10 moves what is seen alone, toward others within its radius.
    EXPECT_EQ(moved(both.positions, shaped.positions), 0);
    ASSERT_EQ(both.displayed.count, 64);
    EXPECT_GT(moved(both.displayed, both.positions), 1e-4);
    EXPECT_LT(moved(both.displayed, both.positions), 0.03);
    const RunFrame cohesion = inferred(false, true);
    EXPECT_EQ(moved(cohesion.positions, plain.positions), 0);
    EXPECT_GT(moved(cohesion.displayed, plain.positions), 1e-4);

    // Where hair is dry both leave it: its shape is rebuilt in double and rounded to 1e-8 m, 24 edges of it.
    low.set = {"wetness.level=0"};
    low.output = scratch.path("dry.h5");
    simulate_command(low);
    const RunFrame dry = inferred(false, false, "dry.h5"), dry_both = inferred(true, true, "dry.h5");
    EXPECT_LT(moved(dry_both.positions, dry.positions), 1e-6);
    EXPECT_LT(moved(dry_both.displayed, dry.positions), 1e-6);
}

TEST_F(Commands, before_cohesion_strands_are_the_same_and_nothing_is_displayed_of_them) {
    SimulateOptions low = simulation("whole.h5", 16);
    low.scene = scratch.file("wet.toml", wet_scene);
    simulate_command(low);
    low.before_cohesion = true, low.output = scratch.path("low.h5");
    simulate_command(low);
    const RunReader whole(scratch.path("whole.h5")), before(low.output);
    EXPECT_EQ(before.header().method, "simulated wet");
    const auto whole_points = whole.frame(3).positions.points, points = before.frame(3).positions.points;
    ASSERT_EQ(points.size(), whole_points.size());
    for (size_t k = 0; k < points.size(); ++k) EXPECT_EQ(norm(points[k] - whole_points[k]), 0);
    EXPECT_EQ(whole.frame(3).displayed.count, 16);
    EXPECT_EQ(before.frame(3).displayed.count, 0);
    // What follows takes Eq 10 from the scene all the same.
    InferOptions o = inference("rest", 4);
    o.cohesion = true;
    EXPECT_EQ(infer_command(o), 0);
    EXPECT_EQ(RunReader(o.output).frame(3).displayed.count, 64);

    low.set = {"cohesion.strength=1e-6"};
    low.output = scratch.path("refused.h5");
    expect_error<Misuse>([&] { simulate_command(low); },
                         {"--before-cohesion", "cohesion.strength = 1e-06", "0"});
    EXPECT_FALSE(fs::exists(low.output));
}

TEST_F(Commands, a_crop_is_refused_where_no_network_is_asked) {
    simulate_command(simulation("low.h5", 16));
    InferOptions o = inference("quad", 4);
    o.crop = true;
    expect_error<Misuse>([&] { infer_command(o); }, {"--crop", "no network"});
    EXPECT_FALSE(fs::exists(o.output));
}

TEST_F(Commands, water_that_nothing_takes_up_is_refused) {
    simulate_command(simulation("low.h5", 16));
    for (const std::string kind : {"nearest", "quad", "core"}) {
        InferOptions o = inference(kind, 4);
        o.wet_shape = true;
        expect_error<Misuse>([&] { infer_command(o); }, {"--wet-shape", "--interpolate rest"});
        EXPECT_FALSE(fs::exists(o.output));
    }
    InferOptions model;
    model.input = scratch.path("low.h5");
    model.model = "model.h5";
    model.output = scratch.path("out.h5");
    model.wet_shape = true;
    expect_error<Misuse>([&] { infer_command(model); }, {"--wet-shape", "--interpolate rest"});
    model.wet_shape = false, model.cohesion = true;
    expect_error<Misuse>([&] { infer_command(model); }, {"--cohesion", "[cohesion]"});
    for (const std::string kind : {"quad", "rest"}) {
        InferOptions o = inference(kind, 4);
        o.cohesion = true;
        expect_error<Misuse>([&] { infer_command(o); }, {"--cohesion", "no [cohesion]", "--wetness"});
        EXPECT_FALSE(fs::exists(o.output));
        // A scene that has some helps.
        o.wetness =
            scratch.file("wetness.toml", std::string(small_scene) + "[wetness]\n[cohesion]\nradius = 0.03\n");
        EXPECT_EQ(infer_command(o), 0);
        EXPECT_EQ(RunReader(o.output).frame(2).displayed.count, 64);
    }
}

// The low-resolution run of a scene is simulated frame by frame, and no file is left of it.
TEST_F(Commands, infer_of_a_scene_gives_the_bits_of_infer_of_its_run) {
    const std::string scene = scratch.file("wet.toml", wet_scene + "[motion]\nangle = 40\nperiod = 0.4\n");
    SimulateOptions low = simulation("low.h5", 16);
    low.scene = scene, low.dry = true;
    simulate_command(low);
    struct Way {
        std::string interpolate, model;
    };
    const std::string weights = WETCURL_SOURCE_DIR "/models/weights/";
    for (const Way& way : {Way{"quad", ""}, Way{"rest", ""}, Way{"", weights + "displayed_s.h5"},
                           Way{"", weights + "strand_m.h5"}}) {
        InferOptions o = inference(way.interpolate, 4);
        o.model = way.model, o.threads = 1, o.overwrite = true;
        o.set = {"integrator.substeps=4"}, o.input = scene, o.output = scratch.path("of_scene.h5");
        infer_command(o);
        o.set.clear(), o.input = low.output, o.output = scratch.path("of_run.h5");
        infer_command(o);
        const RunReader of_scene(scratch.path("of_scene.h5")), of_run(scratch.path("of_run.h5"));
        ASSERT_EQ(of_scene.frames(), 4);
        ASSERT_EQ(of_run.frames(), 4);
        for (int f = 0; f < 4; ++f) {
            const Strands a = of_scene.frame(f).seen(), b = of_run.frame(f).seen();
            ASSERT_EQ(a.count, 64);
            for (size_t k = 0; k < a.points.size(); ++k)
                ASSERT_EQ(norm(a.points[k] - b.points[k]), 0) << way.interpolate << way.model << " " << f;
        }
        // Its header says what it was made from.
        std::vector<std::string> made_from{scene + " (simulated dry, 16 strands, 4 substeps a frame)"};
        if (!way.model.empty()) made_from.push_back(way.model);
        EXPECT_EQ(of_scene.header().inputs, made_from);
        EXPECT_EQ(of_scene.header().scene, of_run.header().scene);
        EXPECT_EQ(of_scene.header().method, of_run.header().method);
    }
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(scratch.path())) files.push_back(entry.path().filename());
    std::sort(files.begin(), files.end());
    EXPECT_EQ(files,
              (std::vector<std::string>{"low.h5", "of_run.h5", "of_scene.h5", "scene.toml", "wet.toml"}));
}

TEST_F(Commands, runs_of_different_length_are_compared_over_the_common_frames_and_say_so) {
    SimulateOptions o = simulation("long.h5", 16);
    simulate_command(o);
    o.output = scratch.path("short.h5");
    o.frames = 2;
    simulate_command(o);
    CompareOptions c;
    c.reference = scratch.path("long.h5");
    c.others = {o.output};
    ::testing::internal::CaptureStderr();
    ::testing::internal::CaptureStdout();
    compare_command(c);
    ::testing::internal::GetCapturedStdout();
    const std::string said = ::testing::internal::GetCapturedStderr();
    EXPECT_NE(said.find("short.h5 has 2 frames"), std::string::npos) << said;
    EXPECT_NE(said.find("long.h5 has 3: frames 0 to 1"), std::string::npos) << said;
}

TEST_F(Commands, a_count_of_strands_that_no_grid_has_is_said_with_those_that_there_are) {
    auto said = [&](int strands) {
        SimulateOptions o = simulation("run.h5", strands);
        o.overwrite = true;
        ::testing::internal::CaptureStderr();
        simulate_command(o);
        return ::testing::internal::GetCapturedStderr();
    };
    const std::string counts = "this groom nests as 1, 4, 16, 64 strands; ";
    EXPECT_NE(said(30).find("--strands 30: " + counts + "16 are taken"), std::string::npos);
    EXPECT_NE(said(100).find("--strands 100: " + counts + "64 are taken"), std::string::npos);
    EXPECT_EQ(said(16).find("--strands"), std::string::npos);
}

TEST_F(Commands, infer_of_the_first_frames_gives_those_of_the_whole) {
    SimulateOptions low = simulation("low.h5", 16);
    low.scene = scratch.file("wet.toml", wet_scene);
    low.dry = true;
    simulate_command(low);
    InferOptions o = inference("rest", 4);
    infer_command(o);
    InferOptions first = o;
    first.frames = 2, first.output = scratch.path("first.h5"), first.json = scratch.path("first.json");
    EXPECT_EQ(infer_command(first), 0);
    const RunReader whole(o.output), part(first.output);
    ASSERT_EQ(whole.frames(), 4);
    ASSERT_EQ(part.frames(), 2);
    EXPECT_EQ(Json::parse(bytes_of(first.json))["frames"], 2);
    for (int f = 0; f < 2; ++f)
        for (size_t k = 0; k < whole.frame(f).positions.points.size(); ++k)
            ASSERT_EQ(norm(whole.frame(f).positions.points[k] - part.frame(f).positions.points[k]), 0);
    first.frames = 5, first.overwrite = true;
    expect_error<Misuse>([&] { infer_command(first); }, {"--frames", "found 5", "1 to 4", "low.h5"});
    // Of a scene, as many are simulated.
    first.input = low.scene, first.frames = 3;
    EXPECT_EQ(infer_command(first), 0);
    EXPECT_EQ(RunReader(first.output).frames(), 3);
}

Json inspected(const std::string& run, const std::string& json) {
    InspectOptions o;
    o.what = "run", o.file = run, o.json = json, o.overwrite = true;
    inspect_command(o);
    return Json::parse(bytes_of(json));
}

// A run of 16 strands at rest whose frames took these times.
std::string timed_run(const std::string& like, const std::string& path, const std::vector<double>& seconds,
                      const std::string& method = "simulated dry") {
    const RunReader from(like);
    RunHeader header = from.header();
    header.method = method;
    RunWriter out(path, header, true);
    RunFrame frame = from.frame(0);
    for (const double s : seconds) {
        frame.seconds = s;
        std::fill(frame.stage_seconds.begin(), frame.stage_seconds.end(), float(s));
        out.append(frame);
    }
    out.commit();
    return path;
}

TEST_F(Commands, inspect_counts_no_time_for_the_frame_that_nothing_was_computed_for) {
    simulate_command(simulation("run.h5", 16));
    const std::string json = scratch.path("run.json");
    const Json found =
        inspected(timed_run(scratch.path("run.h5"), scratch.path("timed.h5"), {0, 0.25, 0.5, 0.75}), json);
    const Json seconds = found["seconds_per_frame"];
    EXPECT_EQ(seconds["min"], 0.25);
    EXPECT_EQ(seconds["max"], 0.75);
    EXPECT_EQ(seconds["mean"], 0.5);
    EXPECT_EQ(seconds["median"], 0.5);
    EXPECT_NEAR(seconds["std"].get<double>(), std::sqrt(0.125 / 3), 1e-12);
    ASSERT_FALSE(found["mean_stage_seconds"].empty());
    for (const auto& [stage, mean] : found["mean_stage_seconds"].items()) {
        EXPECT_EQ(mean, 0.5) << stage;
        EXPECT_EQ(found["last_stage_seconds"][stage], 0.75) << stage;
    }
    // One frame alone has no time, and simulate says no other.
    const Json one = inspected(timed_run(scratch.path("run.h5"), scratch.path("one.h5"), {0}), json);
    EXPECT_TRUE(one["seconds_per_frame"]["min"].is_null());
    SimulateOptions single = simulation("single.h5", 16);
    single.frames = 1, single.json = json, single.overwrite = true;
    simulate_command(single);
    EXPECT_TRUE(Json::parse(bytes_of(json))["seconds_per_frame"]["median"].is_null());
}

TEST_F(Commands, compare_names_files_and_times_and_how_many_times_faster_a_run_is) {
    simulate_command(simulation("run.h5", 16));
    const std::string like = scratch.path("run.h5");
    CompareOptions c;
    c.reference = timed_run(like, scratch.path("slow.h5"), {0, 3, 5});
    c.others = {timed_run(like, scratch.path("half.h5"), {0, 2, 2}),
                timed_run(like, scratch.path("untimed.h5"), {0, 0, 0})};
    ::testing::internal::CaptureStdout();
    compare_command(c);
    const std::string table = ::testing::internal::GetCapturedStdout();
    std::istringstream lines(table);
    std::vector<std::vector<std::string>> rows;
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        rows.emplace_back(std::istream_iterator<std::string>(words), std::istream_iterator<std::string>());
    }
    ASSERT_GE(rows.size(), 6u) << table;
    auto row = [&](size_t k) { return std::vector<std::string>(rows[k].begin(), rows[k].begin() + 6); };
    using Row = std::vector<std::string>;
    EXPECT_EQ(row(2), (Row{c.reference, "simulated", "dry", "3", "4000.0", "-"})) << table;
    EXPECT_EQ(row(3), (Row{c.others[0], "simulated", "dry", "3", "2000.0", "2.00"})) << table;
    EXPECT_EQ(row(4), (Row{c.others[1], "simulated", "dry", "3", "-", "-"})) << table;
    EXPECT_NE(table.find("--help"), std::string::npos);
    for (const char* word : {"speed-up", "F1", "crowd", "depth"}) {
        EXPECT_NE(table.find(word), std::string::npos) << word;
        EXPECT_NE(compare_columns().find(word), std::string::npos) << word;
    }

    c.json = scratch.path("compared.json");
    ::testing::internal::CaptureStdout();
    compare_command(c);
    ::testing::internal::GetCapturedStdout();
    const Json json = Json::parse(bytes_of(c.json));
    EXPECT_EQ(json["reference"], c.reference);
    EXPECT_EQ(json["reference_method"], "simulated dry");
    EXPECT_EQ(json["reference_seconds_per_frame"], 4);
    EXPECT_EQ(json["others"][0]["file"], c.others[0]);
    EXPECT_EQ(json["others"][0]["speed_up"], 2);
    EXPECT_TRUE(json["others"][1]["speed_up"].is_null());
}

TEST_F(Commands, damaged_times_and_saturations_of_a_run_are_refused_by_name) {
    simulate_command(simulation("run.h5", 16));
    const std::string like = scratch.path("run.h5");
    CompareOptions c;
    c.reference = like;
    c.others = {timed_run(like, scratch.path("sec.h5"), {0, 0.1, -5})};
    expect_error([&] { compare_command(c); },
                 {"sec.h5", "dataset 'seconds'", "frame 2", "found -5", "allowed 0 or more"});
    RunHeader header = RunReader(like).header();
    header.saturation.assign(header.groom.rest.points.size(), 0.5f);
    header.saturation[7] = 5;
    RunWriter(scratch.path("sat5.h5"), header, true).commit();
    expect_error([&] { RunReader(scratch.path("sat5.h5")); },
                 {"sat5.h5", "dataset 'saturation'", "value 7", "found 5", "allowed 0 to 1"});
}

TEST_F(Commands, encode_takes_no_run_as_wet_that_was_not_simulated_wet) {
    auto run = [&](const std::string& output, int strands, bool dry) {
        SimulateOptions o = simulation(output, strands);
        o.scene = scratch.file("wet.toml", wet_scene);
        o.dry = dry;
        simulate_command(o);
        return o.output;
    };
    EncodeOptions e;
    e.inputs = {run("low.h5", 16, true), run("dry.h5", 64, true)};
    e.output = scratch.path("pairs.h5");
    expect_error([&] { encode_command(e); }, {"dry.h5: found a run 'simulated dry'", "without --dry"});
    InferOptions o = inference("quad", 4);
    infer_command(o);
    e.inputs[1] = o.output;
    expect_error([&] { encode_command(e); }, {"quad4.h5: found a run 'quad interpolation'"});
    e.inputs[1] = run("wet.h5", 64, false);
    EXPECT_EQ(encode_command(e), 0);
}

TEST_F(Commands, errors_of_what_a_run_holds_name_its_file) {
    simulate_command(simulation("run.h5", 16));
    RunHeader header = RunReader(scratch.path("run.h5")).header();
    const RunFrame frame = RunReader(scratch.path("run.h5")).frame(0);
    auto with_scene = [&](const std::string& name, const std::string& text) {
        header.scene = text;
        RunWriter out(scratch.path(name), header, true);
        out.append(frame);
        out.commit();
        return scratch.path(name);
    };
    const std::string damaged = with_scene("damaged.h5", "frames = 3\n[integrator\n");
    InspectOptions inspect;
    inspect.what = "run", inspect.file = damaged;
    expect_error([&] { inspect_command(inspect); }, {"damaged.h5: its scene:2"});
    expect_error([&] { substeps_of(RunReader(damaged).header()); }, {"damaged.h5: its scene:2"});
    InferOptions o = inference("quad", 4);
    o.input = scratch.path("run.h5");
    o.wetness =
        scratch.file("other.toml", "seed = 9\n[groom]\ngrid = [16, 8]\nparticles = 10\n[stretch]\n[bend]\n");
    expect_error([&] { infer_command(o); }, {"run.h5, ", "other.toml: low-resolution strand",
                                             "is none of those to predict", "--any-roots"});
    // Guides of another file may be: then the nearest ones are around a strand.
    o.any_roots = true;
    EXPECT_EQ(infer_command(o), 0);
}

TEST_F(Commands, a_video_wider_than_its_encoders_take_is_refused) {
    RenderOptions o;
    o.runs = {"a.h5", "b.h5", "c.h5"};
    o.output = scratch.path("wide.mp4"), o.width = 8192;
    expect_error<Misuse>([&] { render_command(o); }, {"24576 pixels wide", "16383", "--width of 5461"});
    o.output = scratch.path("wide.png");  // no encoder: the runs are asked for
    expect_error([&] { render_command(o); }, {"a.h5"});
}

TEST_F(Commands, an_interrupted_simulation_keeps_what_it_has) {
    SimulateOptions o = simulation("run.h5", 64);
    o.frames = 1000000;
    std::thread hand([&] {
        const fs::path kept = o.output + ".partial";
        // A signal while it is empty would end this program: there is nothing to keep.
        while (!fs::exists(kept) || fs::file_size(kept) == 0)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        kill(getpid(), SIGTERM);
    });
    EXPECT_THROW(simulate_command(o), Interrupted);
    hand.join();
    EXPECT_FALSE(fs::exists(o.output));
    EXPECT_LT(RunReader(o.output + ".partial").frames(), 1000000);
}

}  // namespace
}  // namespace wetcurl

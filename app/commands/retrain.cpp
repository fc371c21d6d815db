// `wetcurl retrain`: data set, the network that it goes on from, training; what is there is gone on with.
#include "app/commands/retrain.h"

#include <filesystem>

#include "app/dataset/dataset_recipe.h"
#include "app/dataset/encode_pairs.h"
#include "app/dataset/make_dataset.h"
#include "app/engine/simulate_scene.h"
#include "app/engine/train_network.h"
#include "app/files/results.h"
#include "app/options/option_list.h"
#include "base/log.h"
#include "base/output_file.h"
#include "base/ranks.h"
#include "learn/codec/network_module.h"
#include "learn/codec/pairs.h"
#include "learn/codec/release_recipe.h"

namespace wetcurl {

namespace fs = std::filesystem;

namespace {

constexpr const char* of_data = "data.";  // what --set says of the data set, not of the training

class Retraining {
  public:
    // `depth`: how many networks go on from this one.
    Retraining(const RetrainOptions& options, const std::string& recipe, std::optional<long> seed,
               int depth = 0)
        : options_(options), recipe_(recipe), seed_(seed), depth_(depth) {
        if (depth > 8)
            throw Misuse(recipe + ": [release] from: found more than 8 recipes in a row (a circle?)");
        Config config = Config::load(recipe);
        release_ = read_release(config.root());
        if (!release_.present)
            throw Misuse(recipe + ": has no table [release], which says what the network is trained on");
        if (depth == 0 && !options.from.empty()) release_.from = options.from;
        for (const auto& assignment : options.set) {
            const bool data = assignment.starts_with(of_data);
            (data ? set_of_data_ : set_)
                .push_back(data ? assignment.substr(std::string(of_data).size()) : assignment);
        }
    }

    std::string model() const {
        return path(stem(recipe_) + (seed_ ? "@" + std::to_string(*seed_) : "") + ".h5");
    }

    // Throws Misuse where --scene has nothing to replace, and Error where a model that is there was made of
    // other data or other weights.
    void require_as_asked() const {
        if (!options_.scene.empty() && release_.dataset.empty())
            throw Misuse("--scene: " + recipe_ + " trains on no data set, whose scene it could replace");
        if (!is_complete()) return;
        const std::string made_by = path(stem(release_.dataset) + "/recipe.toml");
        if (!release_.dataset.empty() && fs::exists(made_by) && !is_made_by(made_by, dataset()))
            throw Error(model() + ": is there, trained on the data set that " + made_by +
                        " describes; now another is asked for; remove both, or name another folder");
        if (!is_model(release_.from)) return;
        const std::string begun_with = release_.from + " " + hash_of_file(release_.from) + " (begun with)";
        if (network_module().card(model()).inputs.find(begun_with) == std::string::npos)
            throw Error(model() + ": is there, and did not begin with " + release_.from +
                        " as it is now; remove it, or name another folder");
    }

    // The data set, or this process's part of it, and that of the network which is gone on from.
    void make_data() const {
        if (is_complete()) return;
        if (const auto before = start()) before->make_data();
        if (!release_.scenes.empty())
            make_pairs();
        else if (const DatasetRequest data = dataset(); !dataset_is_whole(data))
            make_dataset(data);
    }

    void train() const {
        wait_for_others();
        const bool complete = is_complete(), asked_for = depth_ == 0;
        if (complete && !asked_for) return;
        TrainingRequest train = with_common<TrainingRequest>();
        train.set = set_, train.seed = seed_, train.resume = true;
        train.recipe = recipe_, train.output = model();
        const Codec learned = codec();
        train.kind = learned == Codec::adhesion ? "adhesion" : "sr";
        if (learned == Codec::adhesion) train.device = "cpu";  // 142 weights
        if (!release_.scenes.empty()) {
            train.pairs = {pairs()};
        } else {
            train.pairs = {split("train", learned)};
            if (const std::string held_out = split("validation", learned); fs::exists(held_out))
                train.validation = {held_out};
        }
        if (is_model(release_.from)) train.from = release_.from;
        if (const auto before = start(); before && !complete) {
            before->train();
            train.from = before->model();
        }
        if (asked_for) train.json = options_.json;
        train_network(train);
    }

  private:
    bool is_complete() const { return fs::exists(model()) && !fs::exists(model() + ".checkpoint"); }
    static bool is_model(const std::string& from) { return fs::path(from).extension() == ".h5"; }
    static std::string stem(const std::string& recipe) { return fs::path(recipe).stem().string(); }
    std::string path(const std::string& name) const {
        return (fs::path(options_.output) / name).lexically_normal().string();
    }
    Codec codec() const {
        if (!release_.scenes.empty())
            return release_.scenes.front().low_strands ? Codec::strand : Codec::adhesion;
        const DatasetRecipe recipe = read_dataset_recipe(release_.dataset, dataset().assignments());
        if (recipe.strand && recipe.root)
            throw Misuse(release_.dataset + ": codecs: found both, allowed is one, which is learned");
        return recipe.strand ? Codec::strand : Codec::root;
    }
    std::string pairs() const { return path(stem(recipe_) + "_pairs.h5"); }
    std::string folder() const { return path(stem(release_.dataset)); }
    std::string split(const std::string& name, Codec codec) const {
        return (fs::path(folder()) / (name + "_" + name_of(codec) + ".h5")).string();
    }

    template <class Options>
    Options with_common() const {
        Options out;
        out.device = options_.device, out.threads = options_.threads;
        return out;
    }

    // By its own seed, as the recipe has it.
    std::optional<Retraining> start() const {
        if (release_.from.empty() || is_model(release_.from)) return {};
        return Retraining(options_, release_.from, {}, depth_ + 1);
    }

    DatasetRequest dataset() const {
        DatasetRequest data = with_common<DatasetRequest>();
        data.set = set_of_data_, data.resume = true;
        if (depth_ == 0) data.scene = options_.scene;  // a network that is gone on from has its own
        data.recipe = release_.dataset, data.output = folder(), data.part = options_.part;
        if (!data.part.empty() && depth_ == 0) data.json = options_.json;
        return data;
    }

    // By the first part.
    void make_pairs() const {
        if (fs::exists(pairs()) || !part_of(options_.part).first()) return;
        PairsRequest encode = with_common<PairsRequest>();
        encode.device = "cpu";
        encode.output = pairs(), encode.codec = name_of(codec());
        for (const ReleaseScene& scene : release_.scenes)
            if (scene.low_strands)
                for (const bool wet : {false, true}) encode.inputs.push_back(run_of(scene, wet));
            else
                encode.inputs.push_back(scene.file);
        if (codec() == Codec::adhesion) encode.set = set_of_data_;
        encode_pairs(encode);
    }
    // The low-resolution run, dry, or the wet one, at full resolution.
    std::string run_of(const ReleaseScene& scene, bool wet) const {
        const std::string run = path(stem(recipe_) + "_" + stem(scene.file) + (wet ? "_wet.h5" : "_low.h5"));
        if (fs::exists(run)) return run;
        SceneOptions simulated;
        simulated.set = set_of_data_;
        if (!wet) simulated.strands = scene.low_strands;
        if (scene.frames) simulated.frames = scene.frames;
        Scene whole = load_scene(scene.file, simulated);
        if (!wet) make_dry(whole);
        ResultFile no_json("", false);
        simulate_scene(
            std::move(whole),
            {.output = run, .device = options_.device, .precision = "float", .threads = options_.threads},
            no_json);
        return run;
    }

    // A process that trains this network now ends first.
    void wait_for_others() const {
        if (const std::string writer = writer_of(partial_of(model())); !writer.empty())
            log_info(model() + ": waits for " + writer + ", which makes it");
        make_folder_of(model());
        const OutputFile turn(model(), true, "", LockedFile::Others::wait);
    }

    const RetrainOptions& options_;
    std::string recipe_;
    std::optional<long> seed_;
    int depth_;
    ReleaseRecipe release_;
    std::vector<std::string> set_, set_of_data_;
};

}  // namespace

void add_options(OptionList& options, RetrainOptions& o) {
    options.option("recipe", o.recipe, "recipe (TOML) with a table [release]: NAME.toml")
        .input_file()
        .required();
    options
        .option("-o,--output", o.output,
                "folder of the data set and of the model, NAME.h5, or NAME@SEED.h5 with --seed; what is "
                "there is gone on with")
        .required();
    options
        .option("--scene", o.scene,
                "scene that all of the data set's start from, in place of its recipe's: hair of one's own")
        .input_file();
    options
        .option("--from", o.from,
                "what the training begins with, in place of the recipe's: a model (.h5), or a recipe (.toml)")
        .input_file();
    options.option("--part", o.part,
                   "K/N: makes every N-th scene of the data set and trains nothing, to share the work");
    options.footer(
        "--set data.KEY=VALUE is over the recipe of the data set (or over the scenes), --set KEY=VALUE over "
        "that of the training.");
}

int retrain_command(const RetrainOptions& o) {
    if (o.output.empty()) throw Misuse("output: found an empty folder name");
    if (o.overwrite)
        throw Misuse("--overwrite: what is there is gone on with; remove what is to be made anew from " +
                     o.output);
    if (!ranks_of_launcher().alone())
        throw Misuse(
            "release: found several processes that a launcher started; start one, or share the "
            "work by --part");
    const Retraining release(o, o.recipe, o.seed);
    release.require_as_asked();
    release.make_data();
    if (o.part.empty()) release.train();
    return 0;
}

}  // namespace wetcurl

// `wetcurl dataset`: many scenes, dry at low and wet at high resolution, to pairs in shards.
#include "app/commands/dataset.h"

#include <fmt/format.h>
#include <omp.h>

#include <atomic>
#include <CLI/CLI.hpp>
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "app/commands/dataset_recipe.h"
#include "app/commands/input_file.h"
#include "app/engine/device.h"
#include "app/engine/learned_hair.h"
#include "app/engine/run_of_scene.h"
#include "app/files/results.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "base/progress.h"
#include "base/ranks.h"
#include "learn/codec/encode_runs.h"
#include "solver/chain/scene_checks.h"
#include "solver/scene/rest_state.h"

namespace wetcurl {

namespace fs = std::filesystem;

namespace {

class Folder {
  public:
    explicit Folder(std::string path) : path_(std::move(path)) {}
    std::string of(const std::string& name) const { return path_ + "/" + name; }
    std::string shard(const DatasetMember& m, Codec codec) const {
        return fmt::format("{}/shards/{}_{}.h5", path_, m.name, name_of(codec));
    }
    std::string whole(const std::string& split, Codec codec) const {
        return fmt::format("{}/{}_{}.h5", path_, split, name_of(codec));
    }
    std::string run(const DatasetMember& m, const char* which) const {
        return fmt::format("{}/runs/{}_{}.h5", path_, m.name, which);
    }

  private:
    std::string path_;
};

std::vector<Codec> codecs_of(const DatasetRecipe& recipe) {
    std::vector<Codec> out;
    if (recipe.strand) out.push_back(Codec::strand);
    if (recipe.root) out.push_back(Codec::root);
    return out;
}

// What a member leaves behind; there when it is done.
std::vector<std::string> outputs_of(const DatasetRecipe& recipe, const DatasetMember& m, const Folder& to) {
    std::vector<std::string> out;
    for (Codec codec : codecs_of(recipe)) out.push_back(to.shard(m, codec));
    if (recipe.runs == m.split) out.push_back(to.run(m, "low")), out.push_back(to.run(m, "wet"));
    return out;
}
bool is_done(const DatasetRecipe& recipe, const DatasetMember& m, const Folder& to) {
    const auto outputs = outputs_of(recipe, m, to);
    return std::all_of(outputs.begin(), outputs.end(), [](const auto& f) { return fs::exists(f); });
}

// At the resolution of a stride. Throws as load_scene does, the member's name first.
Scene scene_of(const DatasetRecipe& recipe, const DatasetMember& m, int stride) {
    Config config = m.scene();
    if (!config.root().has("wetness"))
        throw Misuse(recipe.scene_line + ": " + m.name +
                     " has no [wetness], which is what is to be learned; " +
                     "neither the scene that it starts from nor what was picked and drawn for it names one");
    if (stride > 1 && recipe.low_substeps)
        config.set(fmt::format("integrator.substeps={}", recipe.low_substeps), recipe.low_substeps_line);
    SceneOptions options;
    options.stride = stride;
    try {
        Scene scene = parse_scene(config, options);
        if (scene.flow) throw Misuse("its water moves ([wetness.flow]), allowed is wetness that stays");
        if (recipe.first >= scene.frames)
            throw Misuse(fmt::format("{}: found {}, allowed 0 to {}, since the scene has {} frames",
                                     recipe.first_line, recipe.first, scene.frames - 1, scene.frames));
        return scene;
    } catch (const Misuse& e) {
        throw Misuse(m.name + ": " + e.what());
    } catch (const Error& e) {
        throw Error(m.name + ": " + e.what());
    }
}

// Reads a scene of each split and of each entry that is picked, before any is simulated: what is wrong with
// a line of the recipe is said at once.
void check_scenes(const DatasetRecipe& recipe) {
    std::set<std::string> seen;
    for (const auto& m : recipe.members) {
        bool fresh = seen.insert(m.split).second;
        for (const auto& [list, entry] : m.picked)
            fresh = seen.insert(list + "/" + entry + "/" + m.split).second || fresh;
        if (fresh) scene_of(recipe, m, 1), scene_of(recipe, m, 2);
    }
}

// Name -> what is to be written there, by this process alone.
using Places = std::map<std::string, OutputFile>;
Places secured(const std::vector<std::string>& outputs) {
    Places out;
    for (const auto& path : outputs) out.emplace(path, OutputFile(path, true));
    return out;
}

using Images = std::vector<std::pair<std::vector<float>, std::vector<float>>>;  // (frame): input, target

struct StrandImages {
    std::vector<float> input, target, displayed;  // of one frame
};

// One scene at both resolutions, frame by frame.
class MemberRun {
  public:
    MemberRun(const DatasetRecipe& recipe, const DatasetMember& m, const Folder& to, Places places,
              const std::string& device)
        : recipe_(recipe),
          member_(m),
          to_(to),
          places_(std::move(places)),
          high_(scene_of(recipe, m, 1)),
          low_(scene_of(recipe, m, 2)),
          reach_(reach_of(high_)) {
        if (!recipe.low_is_wet) make_dry(low_);
        // Eq 10 moves what is seen alone, and no network sees it of the low-resolution run.
        leave_out_display(low_);
        if (!recipe.root && !recipe.displayed && !keeps_runs()) leave_out_display(high_);
        wet_ = make_simulation_on(device, high_, trusted_precision(high_, "float"));
        dry_ = make_simulation_on(device, low_, trusted_precision(low_, "float"));
    }

    // False: it was asked to stop, and nothing is left but runs as far as they went (.partial).
    bool compute(const InterruptGuard& guard) {
        std::optional<StrandEncoder> strands;
        if (recipe_.strand) {
            const Strands shape = shape_at_rest(high_);
            strands.emplace(high_.groom, low_.groom, high_.saturation, &shape, recipe_.low_is_wet, reach_);
        }
        std::unique_ptr<RunWriter> low_writer, wet_writer;
        if (keeps_runs()) {
            low_writer = writer("low", low_, *dry_);
            wet_writer = writer("wet", high_, *wet_);
        }
        const float radius = high_.cohesion ? float(high_.cohesion->h_c) : 0;
        const RootImage low_image(low_.groom.grid), high_image(high_.groom.grid, 2);
        HeadWindow heads;
        heads.fps = high_.fps, heads.gravity = high_.integrator.gravity;
        RunFrame low, wet;
        for (int f = 0; f < high_.frames; ++f) {
            if (guard.asked()) return false;
            const bool kept = f >= recipe_.first && (f - recipe_.first) % recipe_.every < recipe_.together,
                       shown = kept || keeps_runs();
            // Eq 10 moves what is seen alone.
            if (f > 0) dry_->advance(), wet_->advance(shown);
            require_sound(*dry_, f);
            if (shown) require_sound(*wet_, f);
            dry_->snapshot(low);
            auto at = [&](int frame) { return high_.motion.at(frame / high_.fps); };
            heads.before = at(f - 1), heads.now = at(f),
            heads.after = f + 1 < high_.frames ? at(f + 1) : gone_on(heads.before, heads.now);
            heads.inner = f > 0;
            if (strands) strands->take_up(low.positions, heads);
            if (!shown) continue;
            wet_->snapshot(wet);
            if (keeps_runs()) low_writer->append(low), wet_writer->append(wet);
            if (!kept) continue;
            frames_.push_back(f);
            if (strands) {
                StrandImages& images = strand_images_.emplace_back();
                images.input = strands->dynamic();
                floor_mm_ += strands->encode(wet.positions, images.target);
                if (displayed()) floor_displayed_mm_ += strands->encode(wet.seen(), images.displayed);
            }
            if (recipe_.root)
                root_images_.emplace_back(
                    root_colours(low_image, low.positions, {}, radius, recipe_.box),
                    root_colours(high_image, wet.seen(), high_.saturation, radius, recipe_.box));
        }
        if (strands) write_strands(*strands);
        if (recipe_.root) write_roots(low_image, high_image, radius);
        if (keeps_runs()) low_writer->commit(), wet_writer->commit();
        return true;
    }

  private:
    bool keeps_runs() const { return recipe_.runs == member_.split; }
    void require_sound(const Simulation& simulation, int frame) const {
        if (const auto diverged = simulation.divergence())
            throw Error(fmt::format("{}: the run diverged at frame {}, strand {}", member_.name, frame,
                                    diverged->strand));
    }
    bool displayed() const { return recipe_.displayed && high_.cohesion; }
    void write_strands(const StrandEncoder& encoder) {
        PairsWriter out = shard(Codec::strand);
        out.low(recipe_.low_is_wet, low_.integrator.substeps);
        StrandPairs run = encoder.begin(int(strand_images_.size()), displayed());
        run.frame = frames_;
        out.begin(run);
        for (const auto& i : strand_images_)
            out.append(i.input.data(), i.target.data(), displayed() ? i.displayed.data() : nullptr);
        out.attribute("floor_mm", floor_mm_ / double(strand_images_.size()));
        if (displayed())
            out.attribute("floor_displayed_mm", floor_displayed_mm_ / double(strand_images_.size()));
        out.commit();
    }
    void write_roots(const RootImage& low, const RootImage& high, float radius) {
        PairsWriter out = shard(Codec::root);
        out.low(recipe_.low_is_wet, low_.integrator.substeps);
        out.box(&recipe_.box.lower.x, &recipe_.box.upper.x);
        out.attribute("support_radius", radius);
        out.begin(RootPairs{int(root_images_.size()), low.height(), low.width(), low.mask(), high.mask()});
        for (const auto& [input, target] : root_images_) out.append(input.data(), target.data());
        out.commit();
    }
    PairsWriter shard(Codec codec) {
        return {std::move(places_.at(to_.shard(member_, codec))), codec, high_.groom.rest.particles};
    }
    std::unique_ptr<RunWriter> writer(const char* which, const Scene& scene, const Simulation& simulation) {
        return std::make_unique<RunWriter>(std::move(places_.at(to_.run(member_, which))),
                                           header_of(scene, simulation, method_of(scene)));
    }

    const DatasetRecipe& recipe_;
    const DatasetMember& member_;
    const Folder& to_;
    Places places_;
    Scene high_, low_;
    double reach_;  // of Eq 10, which may be left out of them [m]
    std::unique_ptr<Simulation> dry_, wet_;
    std::vector<int> frames_;  // kept
    std::vector<StrandImages> strand_images_;
    Images root_images_;
    double floor_mm_ = 0, floor_displayed_mm_ = 0;  // what encoding costs, summed over the frames kept
};

// Which of how many share the work: --part K/N, or what a launcher of parallel programs says.
Ranks part_of(const std::string& text) {
    if (text.empty()) return ranks_of_launcher();
    Ranks part;
    long k = 0;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%ld/%ld%c", &k, &part.of, &rest) != 2 || k < 1 || k > part.of ||
        part.of > 1000000)
        throw Misuse("--part: found '" + text + "', allowed K/N with 1 <= K <= N <= 1000000");
    part.mine = k - 1;
    return part;
}

std::string text_of(const std::string& path) {
    std::stringstream text;
    if (std::ifstream in(path); in) text << in.rdbuf();
    return text.str();
}

// By the first of several parts; the others find what it wrote.
void write_once(const std::string& path, const std::string& text) {
    OutputFile file(path, true, "", LockedFile::Others::wait);
    if (!fs::exists(path)) {
        file.write(text);
        file.commit();
    }
    if (text_of(path) != text)
        throw Error(path + ": found another recipe, written just now; every part needs the same one");
}

// The folder is this recipe's, or nobody's.
void take_folder(const CommonOptions& o, const Folder& to, const DatasetRecipe& recipe, const Ranks& part) {
    const std::string path = to.of("recipe.toml"), there = text_of(path);
    const bool shared = !part.alone();
    if (there == recipe.text && (o.resume || shared)) return;
    if (!there.empty() && !o.overwrite)
        throw Error(there == recipe.text
                        ? path + ": the data set is there already; --resume goes on, --overwrite replaces it"
                        : path + ": holds another recipe; --overwrite replaces the data set");
    if (o.overwrite) {
        for (const char* made : {"shards", "runs", "manifest.json", "recipe.toml"})
            fs::remove_all(to.of(made));
        for (const auto& split : dataset_splits)
            for (Codec codec : {Codec::strand, Codec::root}) fs::remove(to.whole(split, codec));
    }
    fs::create_directories(to.of("shards"));
    if (!recipe.runs.empty()) fs::create_directories(to.of("runs"));
    write_once(path, recipe.text);
}

// File -> hash, of many and large ones.
std::map<std::string, std::string> hashes_of(const std::vector<std::string>& files) {
    std::map<std::string, std::string> hashes;
    std::exception_ptr failed;
#pragma omp parallel for schedule(dynamic)
    for (size_t k = 0; k < files.size(); ++k) {
        std::string hash;
        std::exception_ptr why;
        try {
            hash = hash_of_file(files[k]);
        } catch (...) {
            why = std::current_exception();
        }
#pragma omp critical
        hashes[files[k]] = hash, failed = why ? why : failed;
    }
    if (failed) std::rethrow_exception(failed);
    return hashes;
}

// One file a split and codec that shows all its shards as one, and the list of what is there.
Json finish(const DatasetRecipe& recipe, const Folder& to) {
    // One of those who share the folder at a time.
    const LockedFile turn(to.of("recipe.toml"), to.of(""), LockedFile::Kind::alone, LockedFile::Others::wait);
    std::vector<std::string> shards;
    for (const auto& m : recipe.members)
        for (Codec codec : codecs_of(recipe)) shards.push_back(to.shard(m, codec));
    const auto hashes = hashes_of(shards);
    Json manifest{{"scenes", Json::array()}};
    for (const auto& m : recipe.members) {
        Json entry{{"name", m.name}, {"split", m.split}, {"picked", m.picked}, {"set", m.set}};
        for (Codec codec : codecs_of(recipe)) entry["hash_" + name_of(codec)] = hashes.at(to.shard(m, codec));
        manifest["scenes"].push_back(entry);
    }
    for (Codec codec : codecs_of(recipe))
        for (const auto& split : dataset_splits) {
            std::unique_ptr<PairsWriter> out;
            std::map<std::string, std::pair<double, long>> floors;  // sum, of how many scenes
            // 0: not all the same.
            double radius = 0;  // of Eq 16
            int substeps = 0;   // of low-resolution runs
            long runs = 0;
            for (const auto& m : recipe.members) {
                if (m.split != split) continue;
                const std::string shard = to.shard(m, codec);
                const PairsReader reader(shard);
                if (!out)
                    out = std::make_unique<PairsWriter>(to.whole(split, codec), codec, reader.particles(),
                                                        true);
                substeps = runs == 0 || reader.low_substeps() == substeps ? reader.low_substeps() : 0;
                for (const char* floor : {"floor_mm", "floor_displayed_mm"})
                    if (reader.has_attribute(floor))
                        floors[floor].first += reader.number(floor), ++floors[floor].second;
                if (codec == Codec::root) {
                    const double its = reader.number("support_radius");
                    radius = runs == 0 || its == radius ? its : 0;
                }
                const std::string name = "shards/" + fs::path(shard).filename().string();
                out->link(name);
                out->attribute(fmt::format("input {:04d}", runs), name + " " + hashes.at(shard));
                ++runs;
            }
            if (!out) continue;
            out->low(recipe.low_is_wet, substeps);
            if (codec == Codec::root) {
                out->box(&recipe.box.lower.x, &recipe.box.upper.x);
                out->attribute("support_radius", radius);
            }
            for (const auto& [floor, sum] : floors) {
                out->attribute(floor, sum.first / double(sum.second));
                manifest[floor + "_" + split] = sum.first / double(sum.second);
            }
            out->commit();
        }
    ResultFile(to.of("manifest.json"), true).write_json(manifest);
    return manifest;
}

}  // namespace

void add_options(CLI::App& app, DatasetOptions& o) {
    input_file(app.add_option("recipe", o.recipe, "recipe (TOML): the scenes, picked and drawn"))->required();
    app.add_option("-o,--output", o.output, "folder")->required();
    app.add_option("--part", o.part,
                   "K/N: every N-th scene alone, to share the work; mpirun and srun say it themselves");
    app.add_flag("--resume", o.resume, "make what is not there yet");
}

int dataset_command(const DatasetOptions& o) {
    require_device(o.device);
    if (o.output.empty()) throw Misuse("output: found an empty folder name");
    if (o.seed) throw Misuse("--seed: a recipe's is --set seed=" + std::to_string(*o.seed));
    const DatasetRecipe recipe = read_dataset_recipe(o.recipe, o.set);
    const Folder to(o.output);
    for (const auto& file : recipe.files)
        if (fs::exists(file) && fs::exists(to.of("recipe.toml")) &&
            fs::equivalent(file, to.of("recipe.toml")))
            throw Misuse(file + ": lies where the data set keeps its own; another folder is needed for -o");
    if (!o.json.empty() && o.json != "-") check_files(o, "", recipe.files);
    const Ranks part = part_of(o.part);
    if (!part.alone() && o.overwrite)
        throw Misuse("--overwrite: several parts would remove each other's scenes; remove " + to.of("") +
                     " instead");
    check_scenes(recipe);
    // Processes that a launcher started write the same one, each in its turn.
    const bool launched = !part.alone() && o.part.empty();
    ResultFile results(launched ? "" : o.json, o.overwrite);
    const OutputFolder filled(o.output, part.alone() ? LockedFile::Kind::alone : LockedFile::Kind::shared);
    take_folder(o, to, recipe, part);

    std::vector<const DatasetMember*> mine;
    for (size_t k = 0; k < recipe.members.size(); ++k)
        if (long(k) % part.of == part.mine && !is_done(recipe, recipe.members[k], to))
            mine.push_back(&recipe.members[k]);
    const double begin = omp_get_wtime();
    InterruptGuard guard;
    Progress progress("dataset", long(mine.size()), "scene");
    std::atomic<bool> failing = false;
    std::mutex mutex;  // of what follows
    std::exception_ptr failed;
    long done = 0;
    // A scene a thread: small scenes keep no more than one busy, and each gives the same bits on any number.
#pragma omp parallel for schedule(dynamic)
    for (size_t k = 0; k < mine.size(); ++k) {
        if (guard.asked() || failing) continue;
        try {
            Places places = secured(outputs_of(recipe, *mine[k], to));
            if (is_done(recipe, *mine[k], to)) continue;  // by another process, meanwhile
            if (!MemberRun(recipe, *mine[k], to, std::move(places), o.device).compute(guard)) continue;
        } catch (...) {
            const std::lock_guard lock(mutex);
            if (!failed) failed = std::current_exception();
            failing = true;
            continue;
        }
        const std::lock_guard lock(mutex);
        progress.update(++done);
    }
    if (failed) std::rethrow_exception(failed);
    if (guard.asked())
        throw Interrupted(fmt::format("interrupted: {} of {} scenes are kept in {}; --resume goes on", done,
                                      mine.size(), o.output));
    Json json{{"scenes", recipe.members.size()},
              {"made", done},
              {"seconds", omp_get_wtime() - begin},
              {"whole", false}};
    // Who finds all scenes there, whoever made them, lists them.
    if (std::all_of(recipe.members.begin(), recipe.members.end(),
                    [&](const auto& m) { return is_done(recipe, m, to); })) {
        const Json manifest = finish(recipe, to);
        json["whole"] = true;
        for (const auto& [key, value] : manifest.items())
            if (key.starts_with("floor_")) {
                json[key] = value;
                log_info(fmt::format("{}: encoding alone costs {:.2f} mm on average ({})", o.output,
                                     value.get<double>(), key));
            }
    }
    if (launched)
        ResultFile(o.json, true, LockedFile::Others::wait).write_json(json);
    else
        results.write_json(json);
    log_info(fmt::format("{}: {} scenes made in {:.0f} s{}", o.output, done, json["seconds"].get<double>(),
                         json["whole"].get<bool>() ? "" : ", others are not there yet"));
    return 0;
}

}  // namespace wetcurl

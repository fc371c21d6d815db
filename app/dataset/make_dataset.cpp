// Many scenes, dry at low and wet at high resolution, to pairs in shards.
#include "app/dataset/make_dataset.h"

#include <fmt/format.h>
#include <omp.h>

#include <atomic>
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "app/dataset/dataset_member.h"
#include "app/engine/device.h"
#include "app/engine/simulated_frames.h"
#include "app/files/results.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "base/progress.h"
#include "base/ranks.h"

namespace wetcurl {

namespace fs = std::filesystem;

namespace {

std::string text_of(const std::string& path) {
    std::stringstream text;
    if (std::ifstream in(path); in) text << in.rdbuf();
    return text.str();
}

// The text of a recipe but for what changes no scene.
std::string scenes_of(const std::string& recipe) {
    std::istringstream lines(recipe);
    std::string out;
    for (std::string line; std::getline(lines, line);)
        if (!line.starts_with("may_diverge = ")) out += line + "\n";
    return out;
}

// By the first of several parts; the others find what it wrote.
void write_once(const std::string& path, const std::string& text) {
    OutputFile file(path, true, "", LockedFile::Others::wait);
    if (!fs::exists(path)) {
        file.write(text);
        file.commit();
    }
    if (scenes_of(text_of(path)) != scenes_of(text))
        throw Error(path + ": found another recipe, written just now; every part needs the same one");
}

// The folder is this recipe's, or nobody's.
void take_folder(const CommonOptions& o, const DatasetFolder& to, const DatasetRecipe& recipe,
                 const Ranks& part) {
    const std::string path = to.of("recipe.toml"), there = text_of(path);
    const bool shared = !part.alone(), same = scenes_of(there) == scenes_of(recipe.text);
    if (same && (o.resume || shared)) return;
    if (!there.empty() && !o.overwrite)
        throw Error(same ? path + ": the data set is there already; --resume goes on, --overwrite replaces it"
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

// Scenes that are left out since they diverged.
class LeftOut {
  public:
    // Counts those of all parts, as far as they have come.
    LeftOut(const DatasetRecipe& recipe, const DatasetFolder& to) : recipe_(recipe), to_(to) {
        for (const auto& m : recipe.members) count_[m.split] += fs::exists(to.diverged(m));
    }
    // One more. Throws Error where they are too many.
    void add(const DatasetMember& m, const std::string& why) {
        const std::string text = m.name + ": " + why;
        require(m.split, ++count_[m.split], text + "; ");
        for (const auto& output : outputs_of(recipe_, m, to_)) fs::remove(partial_of(output));
        OutputFile file(to_.diverged(m), true);
        file.write(text + "\n");
        file.commit();
    }
    // Throws Error where a split has too many, and says how many each has.
    void tell() const {
        for (const auto& [split, count] : count_) {
            require(split, count, to_.of("") + ": ");
            if (count > 0)
                log_warning(
                    fmt::format("{}: {} of the {} scenes of {} diverged and are left out; manifest.json "
                                "says which and how",
                                to_.of(""), count, recipe_.members_of(split), split));
        }
    }

  private:
    void require(const std::string& split, long count, const std::string& text) const {
        const long allowed = recipe_.may_leave_out(split);
        if (count > allowed)
            throw Error(
                fmt::format("{}{} of the {} scenes of {} diverged, allowed is {} (may_diverge in the "
                            "recipe; after a change of it --resume goes on)",
                            text, count, recipe_.members_of(split), split, allowed));
    }
    const DatasetRecipe& recipe_;
    const DatasetFolder& to_;
    std::map<std::string, long> count_;
};

// One file a split and codec that shows all its shards as one, and the list of what is there.
Json finish(const DatasetRecipe& recipe, const DatasetFolder& to) {
    // One of those who share the folder at a time.
    const LockedFile turn(to.of("recipe.toml"), to.of(""), LockedFile::Kind::alone, LockedFile::Others::wait);
    LeftOut(recipe, to).tell();
    std::vector<const DatasetMember*> whole;
    std::vector<std::string> shards;
    for (const auto& m : recipe.members) {
        if (fs::exists(to.diverged(m))) continue;
        whole.push_back(&m);
        for (Codec codec : codecs_of(recipe)) shards.push_back(to.shard(m, codec));
    }
    const auto hashes = hashes_of(shards);
    Json manifest{{"scenes", Json::array()}};
    for (const auto& m : recipe.members) {
        Json entry{{"name", m.name}, {"split", m.split}, {"picked", m.picked}, {"set", m.set}};
        if (const std::string how = text_of(to.diverged(m)); !how.empty())
            entry["diverged"] = how.substr(0, how.find('\n'));
        else
            for (Codec codec : codecs_of(recipe))
                entry["hash_" + name_of(codec)] = hashes.at(to.shard(m, codec));
        manifest["scenes"].push_back(entry);
    }
    for (Codec codec : codecs_of(recipe))
        for (const auto& split : dataset_splits) {
            std::unique_ptr<PairsWriter> out;
            std::map<std::string, std::pair<double, long>> floors;  // sum, of how many scenes
            // 0: not all the same.
            double radius = 0;  // of Eq 16
            int substeps = 0;   // of low-resolution runs, the fewest
            long runs = 0;
            std::string all_hashes;
            for (const DatasetMember* m : whole) {
                if (m->split != split) continue;
                const std::string shard = to.shard(*m, codec);
                const PairsReader reader(shard);
                if (!out)
                    out = std::make_unique<PairsWriter>(to.whole(split, codec), codec, reader.particles(),
                                                        true);
                substeps = runs == 0 ? reader.low_substeps() : std::min(substeps, reader.low_substeps());
                for (const char* floor : {"floor_mm", "floor_displayed_mm"})
                    if (reader.has_attribute(floor))
                        floors[floor].first += reader.number(floor), ++floors[floor].second;
                if (codec == Codec::root) {
                    const double its = reader.number("support_radius");
                    radius = runs == 0 || its == radius ? its : 0;
                }
                const std::string name = "shards/" + fs::path(shard).filename().string();
                out->link(name);
                all_hashes += hashes.at(shard);
                ++runs;
            }
            if (!out) continue;
            out->low(recipe.low_is_wet, substeps);
            // Links have no bytes of what they lead to.
            out->attribute("shards", hash_bytes(all_hashes.data(), all_hashes.size()));
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

std::vector<std::string> DatasetRequest::assignments() const {
    std::vector<std::string> out = set;
    if (!scene.empty()) out.push_back(assignment_of_scene(scene));
    return out;
}

bool is_made_by(const std::string& file, const DatasetRequest& o) {
    return scenes_of(text_of(file)) == scenes_of(read_dataset_recipe(o.recipe, o.assignments()).text);
}

bool dataset_is_whole(const DatasetRequest& o) {
    const DatasetRecipe recipe = read_dataset_recipe(o.recipe, o.assignments());
    const DatasetFolder to(o.output);
    // The list of what is there is written last.
    return fs::exists(to.of("manifest.json")) &&
           scenes_of(text_of(to.of("recipe.toml"))) == scenes_of(recipe.text) &&
           std::all_of(recipe.members.begin(), recipe.members.end(),
                       [&](const auto& m) { return is_done(recipe, m, to); });
}

void make_dataset(const DatasetRequest& o) {
    require_device(o.device);
    if (o.output.empty()) throw Misuse("output: found an empty folder name");
    if (o.seed) throw Misuse("--seed: a recipe's is --set seed=" + std::to_string(*o.seed));
    const DatasetRecipe recipe = read_dataset_recipe(o.recipe, o.assignments());
    const DatasetFolder to(o.output);
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
    std::optional<QuietLog> quiet(std::in_place);  // a scene of each kind has been looked at
    std::atomic<bool> failing = false;
    std::mutex mutex;  // of what follows
    std::exception_ptr failed;
    LeftOut left_out(recipe, to);
    long done = 0;
    // A scene a thread: small scenes keep no more than one busy, and each gives the same bits on any number.
#pragma omp parallel for schedule(dynamic)
    for (size_t k = 0; k < mine.size(); ++k) {
        if (guard.asked() || failing) continue;
        try {
            Places places = secured(outputs_of(recipe, *mine[k], to));
            if (is_done(recipe, *mine[k], to)) continue;  // by another process, meanwhile
            try {
                if (!make_member(recipe, *mine[k], to, std::move(places), o.device, guard)) continue;
            } catch (const Diverged& e) {
                const std::lock_guard lock(mutex);
                left_out.add(*mine[k], e.what());
            }
        } catch (...) {
            const std::lock_guard lock(mutex);
            if (!failed) failed = std::current_exception();
            failing = true;
            continue;
        }
        const std::lock_guard lock(mutex);
        progress.update(++done);
    }
    quiet.reset();
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
}

}  // namespace wetcurl

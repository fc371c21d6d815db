// Scenes of a data set, picked and drawn.
#include "app/dataset/dataset_recipe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/parameters.h"
#include "base/strands.h"

namespace wetcurl {

namespace {

struct Draw {
    std::string key, where;
    Table::Ranges ranges;
};
struct Entry {
    std::string name, only, text, where;  // of the text
    long weight;
    std::vector<Draw> draws;
};
struct List {
    std::string name, where;
    std::vector<Entry> entries;
};

constexpr KeyRow seed_row =
    KeyRow::integer("seed", 1, 0, double(largest_seed), "Seed of all that is picked and drawn.");

constexpr const char *codecs_words[] = {"strand", "root", "both"}, *low_words[] = {"dry", "wet"},
                     *runs_words[] = {"", "train", "validation", "test"},
                     *only_words[] = {"", "test", "train"};

// The top of a recipe as it is written.
struct RecipeTable {
    std::string title, scene, codecs, runs;
    bool low_is_wet, displayed;
    std::vector<double> low_substeps, low_strides, low_guides;
    int first, every, together;
    double may_diverge;
    Vec3d box_lower, box_upper;
    static constexpr Parameter<RecipeTable> parameters[] = {
        {KeyRow::text("title", "", "Name of the data set."), &RecipeTable::title},
        {KeyRow::path("scene", "needed", "Scene that all scenes of the data set start from."),
         &RecipeTable::scene},
        {KeyRow::one_of("codecs", codecs_words, "strand", "Codecs to encode for."), &RecipeTable::codecs},
        {KeyRow::one_of("low", low_words, "dry", "What the low-resolution run is."),
         &RecipeTable::low_is_wet},
        {KeyRow::list_of_numbers("low_substeps", "", 1, 1'000'000,
                                 "Substeps of its frames, one of these for each scene; none: as many as the "
                                 "scene has."),
         &RecipeTable::low_substeps},
        {KeyRow::list_of_numbers("low_strides", "", 2, 1'000'000,
                                 "It has every so many roots each way of the grid, or as many as low_guides "
                                 "says: one of all these for each scene; none of both: every second."),
         &RecipeTable::low_strides},
        {KeyRow::list_of_numbers("low_guides", "", 1, 1e9,
                                 "Numbers of strands of it, chosen where hair differs."),
         &RecipeTable::low_guides},
        {KeyRow::boolean("displayed", true, "Codec strand: the strands after cohesion are targets too."),
         &RecipeTable::displayed},
        {KeyRow::integer("first", 0, 0, 1 << 20, "First frame of each scene that is kept."),
         &RecipeTable::first},
        {KeyRow::integer("every", 1, 1, 1 << 20, "Frames from one kept frame to the next."),
         &RecipeTable::every},
        {KeyRow::integer("together", 1, 1, 1 << 20,
                         "Frames in a row that are kept each time; at most every."),
         &RecipeTable::together},
        {KeyRow::number("may_diverge", "1", 0.01, 0, 1,
                        "Share of the scenes of a split that are left out, at most, where a run of theirs "
                        "diverges."),
         &RecipeTable::may_diverge},
        {KeyRow::one_of("runs", runs_words, "", "Split whose runs are kept whole too."), &RecipeTable::runs},
        {KeyRow::numbers("box_lower", "m", {-0.6, -0.6, -0.6}, -100, 100,
                         "Lower corner of the box of colours."),
         &RecipeTable::box_lower},
        {KeyRow::numbers("box_upper", "m", {0.6, 0.6, 0.6}, -100, 100, "Upper corner of the box of colours."),
         &RecipeTable::box_upper},
    };
};

// An entry of a [[pick]] list as it is written.
struct EntryTable {
    std::string name, only, text;
    int weight;
    static constexpr Parameter<EntryTable> parameters[] = {
        {KeyRow::text("name", "", "Name of the entry.").without_default("its number"), &EntryTable::name},
        {KeyRow::one_of("only", only_words, "", "Split that the entry is for; train: validation too."),
         &EntryTable::only},
        {KeyRow::text("text", "", "TOML whose tables take the place of the scene's."), &EntryTable::text},
        {KeyRow::integer("weight", 1, 1, 1000, "An entry of 2 is picked twice as often."),
         &EntryTable::weight},
    };
};

std::vector<Draw> draws_of(const Table& table) {
    std::vector<Draw> out;
    for (const auto& key : table.keys()) out.push_back({key, table.where(key), table.ranges(key)});
    return out;
}

// In [0, 1), of a scene's name and what is drawn for it.
double uniform(long seed, const std::string& scene, const std::string& what) {
    const std::string all = fmt::format("{}/{}/{}", seed, scene, what);
    unsigned long long h = std::stoull(hash_bytes(all.data(), all.size()), nullptr, 16);
    // FNV leaves names that differ in their last letter close together (splitmix64's end).
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ull;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebull;
    return double((h ^ (h >> 31)) >> 11) * 0x1p-53;
}

class Members {
  public:
    Members(const Table& root, const RecipeTable& top, const Config& base)
        : base_(std::make_shared<const Config>(base.copy())) {
        for (const double n : top.low_substeps) substeps_.push_back(int(n));
        for (const double n : top.low_strides) resolutions_.push_back({.each = int(n), .guides = 0});
        for (const double n : top.low_guides) resolutions_.push_back({.each = 2, .guides = int(n)});
        seed_ = root.integer(seed_row), seed_line_ = root.where("seed");
        all_ = draws_of(root.table("draw")), test_ = draws_of(root.table("test_draw"));
        const Table pick = root.table("pick");
        for (const auto& name : pick.keys()) {
            List list{name, pick.where(name), {}};
            for (const Table& t : pick.tables(name)) {
                EntryTable read;
                read.name = fmt::format("{}", list.entries.size());
                read_parameters(read, EntryTable::parameters, t);
                list.entries.push_back({read.name, read.only, read.text, t.where("text"), read.weight,
                                        draws_of(t.table("draw"))});
            }
            lists_.push_back(list);
        }
    }
    DatasetMember make(const std::string& split, long index) const {
        DatasetMember m;
        m.name = fmt::format("{}-{:04d}", split, index), m.split = split;
        m.base = base_;
        Config scene = base_->copy();
        std::map<std::string, Draw> draws;
        auto add = [&](const std::vector<Draw>& more) {
            for (const auto& d : more) draws[d.key] = d;
        };
        add(all_);
        for (const auto& list : lists_) {
            const Entry& entry = picked(list, split, m.name);
            m.picked[list.name] = entry.name;
            m.replacements.push_back({entry.text, entry.where});
            scene.replace(entry.text, entry.where);
            add(entry.draws);
        }
        m.text = scene.text();
        if (split == "test") add(test_);
        if (!resolutions_.empty()) m.low = one_of(resolutions_, m.name, "low resolution");
        if (!substeps_.empty()) m.low_substeps = one_of(substeps_, m.name, "low substeps");
        m.set.push_back(fmt::format("seed={}", long(uniform(seed_, m.name, "seed") * 1e9)));
        m.set_by.push_back(seed_line_);
        for (const auto& [key, draw] : draws) {
            const Table::Ranges& ranges = draw.ranges;
            std::vector<double> values;
            for (size_t k = 0; k < ranges.each.size(); ++k) {
                const auto [low, high] = ranges.each[k];
                values.push_back(low + (high - low) * uniform(seed_, m.name, fmt::format("{}/{}", key, k)));
            }
            m.set.push_back(key + "=" + ranges.with(values));
            m.set_by.push_back(draw.where);
        }
        return m;
    }

    // What scenes name, and the hash of each.
    std::map<std::string, std::string> files() const {
        std::map<std::string, std::string> out;
        auto add = [&](const Config& config) {
            for (const auto& file : config.named_files()) out[file] = hash_of_file(file);
        };
        add(*base_);
        for (const auto& list : lists_)
            for (const auto& entry : list.entries)
                add(Config::parse(entry.text, entry.where, base_->folder()));
        return out;
    }

  private:
    const Entry& picked(const List& list, const std::string& split, const std::string& name) const {
        const std::string side = split == "test" ? "test" : "train";
        std::vector<const Entry*> own, open;
        for (const auto& e : list.entries)
            if (e.only == side)
                own.insert(own.end(), size_t(e.weight), &e);
            else if (e.only.empty())
                open.insert(open.end(), size_t(e.weight), &e);
        // Where something is kept for the test, it is tested on that alone.
        std::vector<const Entry*> allowed = own;
        if (side == "train" || own.empty()) allowed.insert(allowed.end(), open.begin(), open.end());
        if (allowed.empty())
            throw Misuse(fmt::format("{}: no entry is left for the split {}", list.where, split));
        return *allowed[size_t(uniform(seed_, name, "pick " + list.name) * double(allowed.size()))];
    }

    template <class T>
    T one_of(const std::vector<T>& all, const std::string& name, const std::string& what) const {
        return all[size_t(uniform(seed_, name, what) * double(all.size()))];
    }

    std::shared_ptr<const Config> base_;
    std::vector<int> substeps_;
    std::vector<LowResolution> resolutions_;
    std::string seed_line_;
    long seed_ = 1;
    std::vector<Draw> all_, test_;
    std::vector<List> lists_;
};

KeyRow split_row(const std::string& split) {
    return KeyRow::integer(split.c_str(), 0, 0, 999999, "Number of scenes of the split.");
}

std::vector<TableRow> listed_rows() {
    TableRow top{.name = "", .meaning = "Keys above the first table.", .always = true},
        splits{.name = "splits", .meaning = "How many scenes each split has; one at least."},
        entry{.name = "pick.NAME",
              .meaning =
                  "One entry of each list, whatever its name, is picked for a scene; where entries are kept "
                  "for "
                  "the test, it is tested on those alone.",
              .repeats = true};
    top.rows = {include_row};
    top.rows.insert(top.rows.end(), std::begin(RecipeTable::parameters), std::end(RecipeTable::parameters));
    top.rows.push_back(seed_row);
    for (const auto& split : dataset_splits) splits.rows.push_back(split_row(split));
    entry.rows.insert(entry.rows.end(), std::begin(EntryTable::parameters), std::end(EntryTable::parameters));
    const std::string ranges =
        "A scene's key in quotes, and its range: uniform in [low, high]; arrays of them for a "
        "vector.";
    return {top,
            splits,
            {.name = "draw", .meaning = ranges, .open = true},
            {.name = "test_draw", .meaning = "The same for the test split, in their place.", .open = true},
            entry,
            {.name = "pick.NAME.draw", .meaning = "The same where the entry is picked.", .open = true}};
}

}  // namespace

const std::vector<TableRow>& dataset_rows() {
    static const std::vector<TableRow> rows = listed_rows();
    return rows;
}

long DatasetRecipe::members_of(const std::string& split) const {
    return std::count_if(members.begin(), members.end(), [&](const auto& m) { return m.split == split; });
}

Config DatasetMember::scene() const {
    Config config = base->copy();
    for (const auto& [text, where] : replacements) config.replace(text, where);
    for (size_t k = 0; k < set.size(); ++k) config.set(set[k], set_by[k]);
    return config;
}

std::string assignment_of_scene(const std::string& file) {
    return "scene=" + nlohmann::json(std::filesystem::absolute(file).lexically_normal().string()).dump();
}

DatasetRecipe read_dataset_recipe(const std::string& path, const std::vector<std::string>& set) {
    Config config = Config::load(path);
    for (const auto& assignment : set) config.set(assignment);
    const Table root = config.root();
    DatasetRecipe r;
    RecipeTable read;
    read_parameters(read, RecipeTable::parameters, root);
    r.strand = read.codecs != "root", r.root = read.codecs != "strand";
    r.low_is_wet = read.low_is_wet, r.displayed = read.displayed;
    r.first = read.first, r.every = read.every, r.together = read.together, r.runs = read.runs;
    r.may_diverge = read.may_diverge;
    if (r.together > r.every)
        root.fail("together",
                  fmt::format("found {}, allowed 1 to {}, the value of every", r.together, r.every));
    for (const auto& [key, list] : {std::pair{"low_substeps", &read.low_substeps},
                                    {"low_strides", &read.low_strides},
                                    {"low_guides", &read.low_guides}})
        for (const double n : *list)
            if (n != std::floor(n)) root.fail(key, fmt::format("found {}, allowed are whole numbers", n));
    for (const double n : read.low_strides)
        if (r.root && n != 2)
            root.fail("low_strides", fmt::format("found {}, allowed with codec root is 2 alone", n));
    if (r.root && !read.low_guides.empty())
        root.fail("low_guides", "found with codec root, which needs a grid of every second root");
    const double lower[] = {read.box_lower.x, read.box_lower.y, read.box_lower.z},
                 upper[] = {read.box_upper.x, read.box_upper.y, read.box_upper.z};
    for (size_t axis = 0; axis < 3; ++axis)
        if (lower[axis] >= upper[axis])
            root.fail(root.has("box_lower") ? "box_lower" : "box_upper",
                      fmt::format("found {} to {} along {}, allowed is a lower end below the upper one",
                                  lower[axis], upper[axis], "xyz"[axis]));
    r.box = {read.box_lower, read.box_upper};
    const std::string& scene = read.scene;
    if (scene.empty()) throw Misuse(path + ": scene: names the scene that all others start from");
    if (!std::filesystem::exists(scene)) root.fail("scene", scene + " cannot be read (no such file)");
    r.scene_line = root.where("scene"), r.first_line = root.where("first");
    const Config base = Config::load(scene);
    const Members members(root, read, base);
    const Table splits = root.table("splits");
    for (const auto& split : dataset_splits)
        for (long k = splits.integer(split_row(split)), i = 0; i < k; ++i)
            r.members.push_back(members.make(split, i));
    if (r.members.empty())
        throw Misuse(path + ": [splits] train, validation and test are 0: there is no scene");
    config.require_all_used();
    r.folder = std::filesystem::path(scene).parent_path().string();
    if (r.folder.empty()) r.folder = ".";
    const std::string text = base.text();
    r.text = config.text() + "# base scene " + hash_bytes(text.data(), text.size()) + "\n";
    r.files = config.files();
    for (const auto& [file, hash] : members.files())
        r.text += "# " + std::filesystem::relative(file, r.folder).string() + " " + hash + "\n";
    return r;
}

}  // namespace wetcurl

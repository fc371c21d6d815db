// The recipe of a training.
#include "training/recipe.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>

#include "base/config.h"
#include "base/network_channels.h"
#include "base/shift_units.h"

namespace wetcurl {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

// [loss] edge for "loss.edge".
std::pair<Table, std::string> place_of(const Table& root, const std::string& key) {
    const size_t dot = key.find('.');
    if (dot == std::string::npos) return {root, key};
    return {root.table(key.substr(0, dot)), key.substr(dot + 1)};
}

double read_row(const RecipeRow& row, const Table& root, double fallback) {
    const auto [table, key] = place_of(root, row.key);
    if (row.whole) return double(table.integer(key, long(fallback), long(row.minimum), long(row.maximum)));
    return table.number(key, fallback, row.minimum, row.maximum);
}

// Names of inputs of the strand codec, blanks between.
void require_inputs(const Table& root, const std::string& leave_out) {
    std::istringstream words(leave_out);
    for (std::string word; words >> word;) {
        const bool known = std::any_of(strand_inputs.begin(), strand_inputs.end(),
                                       [&](const InputGroup& g) { return word == g.name; });
        if (known) continue;
        std::vector<std::string> names;
        std::string list;
        for (const auto& g : strand_inputs) names.push_back(g.name), list += " " + names.back();
        root.fail("leave_out",
                  "found '" + word + "', allowed are names of inputs:" + list + did_you_mean(word, names));
    }
}

// The shortest text that reads back as this number.
std::string as_text(double value) {
    char text[32];
    const auto end = value == std::floor(value) && std::abs(value) < 1e16
                         ? std::to_chars(text, text + 32, long(value)).ptr
                         : std::to_chars(text, text + 32, value).ptr;
    return {text, end};
}

std::string resolved_text(const Recipe& recipe, Codec codec) {
    std::string out = "architecture = \"" + recipe.architecture + "\"\nschedule = \"" + recipe.schedule +
                      "\"\nprecision = \"" + recipe.precision +
                      "\"\ndeterministic = " + (recipe.deterministic ? "true" : "false") + "\n";
    if (codec == Codec::strand)
        out += "target = \"" + recipe.target + "\"\nleave_out = \"" + recipe.leave_out + "\"\n";
    if (codec == Codec::root) out += "reconstruct.units = \"" + recipe.units + "\"\n";
    for (const auto& row : recipe_rows())
        if (!std::isnan(row.fallback(codec)) && row.member != &Recipe::checkpoint_seconds)
            out += std::string(row.key) + " = " + as_text(recipe.*row.member) + "\n";
    return out;
}

}  // namespace

double RecipeRow::fallback(Codec codec) const {
    return codec == Codec::strand ? strand : codec == Codec::root ? root : adhesion;
}

const std::vector<RecipeRow>& recipe_rows() {
    using R = Recipe;
    static const std::vector<RecipeRow> rows = {
        // key, member, strand, root, adhesion, minimum, maximum, whole, meaning
        {"epochs", &R::epochs, 60, 200, 9000, 1, 1e7, true, "passes over the data"},
        {"batch", &R::batch, 1, 128, 4096, 1, 1 << 20, true,
         "a step's frames (strand; in whole pairs with loss.steady), patches (root), samples (adhesion)"},
        {"learning_rate", &R::learning_rate, 1e-3, 1e-4, 1e-3, 1e-12, 10, false, "of Adam"},
        {"weight_decay", &R::weight_decay, 1e-2, 0, 0, 0, 1, false, "decoupled (AdamW)"},
        {"gradient_clip", &R::gradient_clip, 1, 0, 0, 0, 1e9, false, "largest norm of the gradient; 0: any"},
        {"patch", &R::patch, none, 128, none, 8, 4096, true,
         "side of a patch [low-resolution pixels]; smaller images go whole"},
        {"epoch_samples", &R::epoch_samples, none, none, 8192, 2, 1e9, true,
         "samples drawn an epoch, contact and free 1:1"},
        {"width", &R::width, 1, 1, 1, smallest_width, largest_width, false, "channel multiplier"},
        {"seed", &R::seed, 0, 0, 0, 0, largest_seed, true,
         "of the first weights and of the order of the data"},
        {"validation", &R::validation, 0.2, 0.2, 0.2, 0, 0.9, false,
         "share of each run's frames, the last ones, held out"},
        {"validate_every", &R::validate_every, 1, 1, 100, 1, 1e7, true, "epochs between two validations"},
        {"checkpoint_seconds", &R::checkpoint_seconds, 60, 60, 60, 0, 1e6, false,
         "between two checkpoints [s]"},
        {"loss.position", &R::position, 1, none, none, 0, 1e6, false,
         "weight: mean distance of decoded particles / strand length"},
        {"loss.edge", &R::edge, 0.3, none, none, 0, 1e6, false,
         "weight: mean difference of edges / segment length"},
        {"loss.curvature", &R::curvature, 0, none, none, 0, 1e6, false,
         "weight: mean second difference / segment length"},
        {"loss.length", &R::length, 0, none, none, 0, 1e6, false,
         "weight: mean difference of edge lengths / segment length"},
        {"loss.steady", &R::steady, 0, none, none, 0, 1e6, false,
         "weight: mean error of how far particles go in a frame / strand length; frames then come in pairs, "
         "held out ones alone"},
        {"reconstruct.gain", &R::gain, none, 1, none, 0, largest_gain, false,
         "kappa of Eq 18, which infer reconstructs with"},
    };
    return rows;
}

Recipe read_recipe(const TrainRequest& request, Codec codec, const std::vector<std::string>& architectures) {
    Config config = request.recipe.empty() ? Config::parse("", "recipe") : Config::load(request.recipe);
    for (const auto& assignment : request.set) config.set(assignment);
    if (request.width) config.set("width=" + as_text(*request.width), "--width");
    if (request.seed) config.set("seed=" + std::to_string(*request.seed), "--seed");
    const Table root = config.root();
    Recipe recipe{};
    for (const auto& row : recipe_rows())
        if (const double fallback = row.fallback(codec); !std::isnan(fallback))
            recipe.*row.member = read_row(row, root, fallback);
    recipe.architecture = root.choice("architecture", architectures.front(), architectures);
    recipe.schedule =
        root.choice("schedule", codec == Codec::strand ? "cosine" : "constant", {"constant", "cosine"});
    recipe.precision = root.choice("precision", "float", {"float", "bfloat16"});
    recipe.device = root.text("device", "cpu");
    recipe.deterministic = root.boolean("deterministic", true);
    if (codec == Codec::strand) {
        recipe.target = root.choice("target", "strands", {"strands", "displayed"});
        recipe.leave_out = root.text("leave_out", "");
        require_inputs(root, recipe.leave_out);
    }
    if (codec == Codec::root)
        recipe.units = root.table("reconstruct").choice("units", "length", shift_units_names);
    config.require_all_used();

    if (!request.architecture.empty()) recipe.architecture = request.architecture;
    if (!request.device.empty()) recipe.device = request.device;
    if (codec == Codec::strand && recipe.position + recipe.edge + recipe.curvature + recipe.length == 0)
        throw Misuse("recipe: all weights of [loss] are 0, one above 0 is needed");
    recipe.text = resolved_text(recipe, codec);
    return recipe;
}

}  // namespace wetcurl

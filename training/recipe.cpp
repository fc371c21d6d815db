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
#include "learn/codec/release_recipe.h"

namespace wetcurl {
namespace {

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
    for (const auto& row : recipe_rows) {
        const auto* number = std::get_if<double Recipe::*>(&row.member);
        if (number && row.has(codec) && *number != &Recipe::checkpoint_seconds)
            out += row.full_key() + " = " + as_text(recipe.**number) + "\n";
    }
    return out;
}

}  // namespace

Recipe read_recipe(const TrainRequest& request, Codec codec, const std::vector<std::string>& architectures) {
    Config config = request.recipe.empty() ? Config::parse("", "recipe") : Config::load(request.recipe);
    for (const auto& assignment : request.set) config.set(assignment);
    if (request.width) config.set("width=" + as_text(*request.width), "--width");
    if (request.seed) config.set("seed=" + std::to_string(*request.seed), "--seed");
    const Table root = config.root();
    Recipe recipe{};
    for (const auto& row : recipe_rows)
        if (row.has(codec)) {
            const Parameter<Recipe> own{row.of(codec), row.member};
            const Table table = *row.table ? root.table(row.table) : root;
            if (row.kind == Kind::integer)
                recipe.*std::get<double Recipe::*>(row.member) = double(table.integer(own));
            else
                read_parameter(recipe, own, table);
        }
    std::vector<const char*> words;
    for (const auto& name : architectures) words.push_back(name.c_str());
    recipe.architecture =
        root.text(KeyRow::one_of(architecture_row.key, words, words.front(), architecture_row.meaning));
    if (codec == Codec::strand) require_inputs(root, recipe.leave_out);
    read_release(root);
    config.require_all_used();

    if (!request.architecture.empty()) recipe.architecture = request.architecture;
    if (!request.target.empty() && !root.has("target")) recipe.target = request.target;
    if (!request.device.empty()) recipe.device = request.device;
    if (codec == Codec::strand && recipe.position + recipe.edge + recipe.curvature + recipe.length == 0)
        throw Misuse("recipe: all weights of [loss] are 0, one above 0 is needed");
    recipe.text = resolved_text(recipe, codec);
    return recipe;
}

}  // namespace wetcurl

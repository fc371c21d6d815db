// Commands that make a missing model.
#include "app/engine/missing_model.h"

#include <fmt/format.h>

#include <filesystem>

#include "base/error.h"

namespace wetcurl {

namespace fs = std::filesystem;

namespace {

// As one word of a shell.
std::string word(const std::string& text) {
    const bool plain = !text.empty() && text.find_first_not_of(
                                            "abcdefghijklmnopqrstuvwxyz"
                                            "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                            "_-./=:,+@%") == std::string::npos;
    if (plain) return text;
    std::string out = "'";
    for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

// Relative to the working folder where that is shorter.
std::string shorter(const std::string& path) {
    std::error_code none;
    const std::string relative = fs::relative(path, none).string();
    return !relative.empty() && relative.size() < path.size() ? relative : path;
}

// What was given on the command line and changes the scene, less what names the model.
std::string scene_options(const CommonOptions& o) {
    std::string out;
    for (const auto& set : o.set)
        if (!set.starts_with("adhesion.model") && !set.starts_with("learned.")) out += " --set " + word(set);
    if (o.seed) out += fmt::format(" --seed {}", *o.seed);
    return out;
}

// A recipe that lies beside the scene; "": none does.
std::string recipe_beside(const std::string& scene, const std::string& name) {
    const fs::path path = fs::path(scene).parent_path() / name;
    return fs::exists(path) ? " --recipe " + word(path.string()) : "";
}

// "model_dry.h5" beside "model.h5".
std::string beside(const std::string& model, const std::string& what) {
    const fs::path path(model);
    return word((path.parent_path() / (path.stem().string() + "_" + what + ".h5")).string());
}

[[noreturn]] void fail(const std::string& model, const std::string& where, const std::string& commands) {
    throw Error(fmt::format("{}: {} names it, and there is no such file; these commands make it:\n{}", model,
                            where, commands));
}

// Of a released model, which a checkout lacks: its training is no default one.
void refer_to_card(const std::string& file, const std::string& where) {
    const fs::path card = fs::path(file).replace_extension(".md");
    if (fs::exists(card))
        throw Error(fmt::format(
            "{}: {} names it, and there is no such file; it is a released model, which comes with "
            "the sources, and {} says how it was made",
            shorter(file), where, shorter(card.string())));
}

}  // namespace

void require_model_of_strands(const std::string& file, const std::string& where, const RunsToLearnFrom& runs,
                              const CommonOptions& o) {
    if (fs::exists(file)) return;
    refer_to_card(file, where);
    const std::string model = shorter(file), scene = word(runs.scene), set = scene_options(o),
                      wet = beside(model, "wet"), pairs = beside(model, "pairs");
    std::string low = word(runs.low), commands;
    if (runs.low.empty()) {
        low = beside(model, "dry");
        commands += fmt::format("  wetcurl simulate {} --dry --strands {}{} -o {}\n", word(runs.low_scene),
                                runs.low_strands, set, low);
    }
    commands += fmt::format("  wetcurl simulate {}{}{} -o {}\n", scene,
                            runs.strands ? fmt::format(" --strands {}", runs.strands) : "", set, wet);
    commands += fmt::format("  wetcurl encode {} {} --codec {} -o {}\n", low, wet, runs.codec, pairs);
    // Recipes beside scenes are for the codec of strands.
    const std::string recipe = runs.codec == "strand" ? recipe_beside(runs.scene, "learned_recipe.toml") : "";
    commands += fmt::format("  wetcurl train sr {}{} -o {}", pairs, recipe, word(model));
    fail(file, where, commands);
}

void require_model_of_adhesion(const std::string& file, const std::string& where,
                               const std::string& scene_file, const CommonOptions& o) {
    if (fs::exists(file)) return;
    refer_to_card(file, where);
    const std::string model = shorter(file), pairs = beside(model, "pairs");
    fail(file, where,
         fmt::format("  wetcurl encode {} --codec adhesion{} -o {}\n  wetcurl train adhesion {}{} -o {}",
                     word(scene_file), scene_options(o), pairs, pairs,
                     recipe_beside(scene_file, "adhesion_recipe.toml"), word(model)));
}

}  // namespace wetcurl

// The recipe of a training: TOML, one table of keys with their defaults for each codec.
// Ours; the root codec's batch, rate and optimiser are the paper's (section V), its epochs are not printed.
// The table [release], which changes nothing of a training: learn/codec/release_recipe.h.
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/parameters.h"
#include "base/shift_units.h"
#include "learn/codec/network_module.h"
#include "learn/codec/pairs.h"
#include "learn/codec/release_recipe.h"

namespace wetcurl {

struct Recipe {
    double epochs, batch, learning_rate, weight_decay, gradient_clip, patch, epoch_samples, width, seed;
    double validation, validate_every, checkpoint_seconds;
    double position, edge, curvature, length, steady, doubt;  // weights of the losses
    double gain;                                              // kappa of Eq 18, codec root
    std::string architecture, schedule, device, precision;
    bool deterministic;     // on CUDA devices
    std::string target;     // codec strand: "strands", which Eq 10 follows, or "displayed", after it
    std::string units;      // of Eq 18, codec root: "length" or "printed" (base/shift_units.h)
    std::string leave_out;  // codec strand: names of inputs (base/network_channels.h), blanks between
    std::string
        text;  // the whole recipe as TOML, `device` and `checkpoint_seconds` apart: they change no result
};

// One key, with its default for each codec.
struct RecipeRow : Parameter<Recipe> {
    const char* table;  // "loss"; "": above the first table
    // A number, a boolean as 0 or 1, a word by its place in the list, an empty text as 0. NaN: not a key of
    // that codec.
    double strand, root, adhesion;

    bool has(Codec codec) const { return !std::isnan(default_of(codec)); }
    double default_of(Codec codec) const {
        return codec == Codec::strand ? strand : codec == Codec::root ? root : adhesion;
    }
    // As that codec reads it.
    KeyRow of(Codec codec) const {
        KeyRow row = *this;
        row.fallback = default_of(codec);
        if (row.kind == Kind::word) row.word = row.words[size_t(row.fallback)];
        return row;
    }
    // "loss.edge".
    std::string full_key() const { return *table ? std::string(table) + "." + key : key; }
};

// `architecture` has the names of models/registry.h beside these rows.
inline constexpr KeyRow architecture_row =
    KeyRow::text("architecture", "",
                 "Architecture of the network: one that the registry lists for the codec.")
        .without_default("the first one of the codec");

inline constexpr double not_there = std::numeric_limits<double>::quiet_NaN();
inline constexpr const char *recipe_schedules[] = {"constant", "cosine"},
                            *recipe_precisions[] = {"float", "bfloat16"},
                            *recipe_targets[] = {"strands", "displayed"};
inline constexpr RecipeRow recipe_rows[] = {
    {{KeyRow::integer("epochs", 0, 1, 1e7, "Passes over the data."), &Recipe::epochs}, "", 60, 200, 9000},
    {{KeyRow::integer(
          "batch", 0, 1, 1 << 20,
          "Frames (strand; in whole pairs with loss.steady), patches (root) or samples (adhesion) of a "
          "step."),
      &Recipe::batch},
     "",
     1,
     128,
     4096},
    {{KeyRow::number("learning_rate", "1", 0, 1e-12, 10, "Learning rate of Adam."), &Recipe::learning_rate},
     "",
     1e-3,
     1e-4,
     1e-3},
    {{KeyRow::number("weight_decay", "1", 0, 0, 1, "Decoupled weight decay.", "AdamW"),
      &Recipe::weight_decay},
     "",
     1e-2,
     0,
     0},
    {{KeyRow::number("gradient_clip", "1", 0, 0, 1e9, "Largest norm of the gradient; 0: any."),
      &Recipe::gradient_clip},
     "",
     1,
     0,
     0},
    {{KeyRow::integer("patch", 0, 8, 4096,
                      "Side of a patch in low-resolution pixels; smaller images go whole."),
      &Recipe::patch},
     "",
     not_there,
     128,
     not_there},
    {{KeyRow::integer("epoch_samples", 0, 2, 1e9, "Samples drawn in an epoch, as many in contact as free."),
      &Recipe::epoch_samples},
     "",
     not_there,
     not_there,
     8192},
    {{KeyRow::number("width", "1", 0, smallest_width, largest_width, "Factor of the numbers of channels."),
      &Recipe::width},
     "",
     1,
     1,
     1},
    {{KeyRow::integer("seed", 0, 0, double(largest_seed),
                      "Seed of the first weights and of the order of the data."),
      &Recipe::seed},
     "",
     0,
     0,
     0},
    {{KeyRow::number("validation", "1", 0, 0, 0.9,
                     "Share of the frames of each run, its last ones, that is held out."),
      &Recipe::validation},
     "",
     0.2,
     0.2,
     0.2},
    {{KeyRow::integer("validate_every", 0, 1, 1e7, "Epochs from one validation to the next."),
      &Recipe::validate_every},
     "",
     1,
     1,
     100},
    {{KeyRow::number("checkpoint_seconds", "s", 0, 0, 1e6, "Time from one checkpoint to the next."),
      &Recipe::checkpoint_seconds},
     "",
     60,
     60,
     60},
    {{KeyRow::one_of("schedule", recipe_schedules, "", "Course of the learning rate."), &Recipe::schedule},
     "",
     1,
     0,
     0},
    {{KeyRow::one_of("precision", recipe_precisions, "", "Number format of the body of the network."),
      &Recipe::precision},
     "",
     0,
     0,
     0},
    {{KeyRow::text("device", "cpu", "Where to train: cpu, cuda or cuda:N."), &Recipe::device}, "", 0, 0, 0},
    {{KeyRow::boolean("deterministic", true, "On a GPU too, the same recipe makes the same bits."),
      &Recipe::deterministic},
     "",
     1,
     1,
     1},
    {{KeyRow::one_of(
          "target", recipe_targets, "",
          "What the network predicts: strands, which Eq 10 follows, or those that are displayed; with --from "
          "and without this key, what that network does."),
      &Recipe::target},
     "",
     0,
     not_there,
     not_there},
    {{KeyRow::text("leave_out", "",
                   "Names of inputs to leave out, with blanks between: rest, saturation, radius, scalp, "
                   "density, guides, fibre, base, gravity, motion, doubt, history."),
      &Recipe::leave_out},
     "",
     0,
     not_there,
     not_there},
    {{KeyRow::number("position", "1", 0, 0, 1e6,
                     "Weight of the mean distance of decoded particles, by the length of a strand."),
      &Recipe::position},
     "loss",
     1,
     not_there,
     not_there},
    {{KeyRow::number("edge", "1", 0, 0, 1e6,
                     "Weight of the mean difference of edges, by the length of a segment."),
      &Recipe::edge},
     "loss",
     0.3,
     not_there,
     not_there},
    {{KeyRow::number("curvature", "1", 0, 0, 1e6,
                     "Weight of the mean second difference, by the length of a segment."),
      &Recipe::curvature},
     "loss",
     0,
     not_there,
     not_there},
    {{KeyRow::number("length", "1", 0, 0, 1e6,
                     "Weight of the mean difference of the lengths of edges, by the length of a segment."),
      &Recipe::length},
     "loss",
     0,
     not_there,
     not_there},
    {{KeyRow::number(
          "steady", "1", 0, 0, 1e6,
          "Weight of the mean error of how far particles go in a frame, by the length of a strand; "
          "frames then come in pairs, held-out ones alone."),
      &Recipe::steady},
     "loss",
     0,
     not_there,
     not_there},
    {{KeyRow::number("doubt", "1", 0, 0, 1e6, "Weight of how badly the network tells its own errors."),
      &Recipe::doubt},
     "loss",
     0.003,
     not_there,
     not_there},
    {{gain_row, &Recipe::gain}, "reconstruct", not_there, 1, not_there},
    {{shift_units_row, &Recipe::units}, "reconstruct", not_there, 0, not_there},
};

// The tables of a recipe of that codec, for listings.
inline std::vector<TableRow> recipe_tables(Codec codec) {
    std::vector<TableRow> tables = {
        {.name = "", .meaning = "Keys above the first table.", .always = true},
        {.name = "loss", .meaning = "Weights of the parts of the loss.", .always = true},
        {.name = "reconstruct",
         .meaning = "How `infer` reconstructs strands with the network.",
         .always = true}};
    tables[0].rows = {include_row, architecture_row};
    for (const auto& row : recipe_rows)
        for (auto& table : tables)
            if (row.has(codec) && table.name == row.table) table.rows.push_back(row.of(codec));
    std::erase_if(tables, [](const TableRow& table) { return table.rows.empty(); });
    tables.insert(tables.end(), release_tables().begin(), release_tables().end());
    return tables;
}

// The file of `request` (or the defaults), its assignments, and what the request gives itself, which goes
// first. Throws Misuse with file and line for an unknown key, a wrong type, a value out of range.
Recipe read_recipe(const TrainRequest& request, Codec codec, const std::vector<std::string>& architectures);

}  // namespace wetcurl

// Scene and recipe files: TOML with the place of every value, read by rows (base/rows.h), and a record of
// what was read, so that an unknown or unused key is an error. toml++ stands behind it, in one translation
// unit.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/rows.h"

namespace wetcurl {

class Table;

// Of a scene or a recipe: whole numbers of files are exact up to here.
inline constexpr long largest_seed = 9000000000000000;

// Read when a file is loaded.
inline constexpr KeyRow include_row =
    KeyRow::path("include", "none", "A file whose keys hold where this file does not write them.");

class Config {
  public:
    // Reads a TOML file; `include = "other.toml"` at the top level is merged below it (this file wins).
    // Throws Misuse with file and line.
    static Config load(const std::string& path);
    // The same from text; `name` stands for the file in messages, `folder` is where relative paths start.
    static Config parse(const std::string& text, const std::string& name, const std::string& folder = ".");

    // `key.path=value` as TOML, names that hold dots in quotes; a bare word is taken as a string. `option`
    // gave it, where that is not --set, and is what messages name.
    void set(const std::string& assignment, const std::string& option = "");
    // Another text's tables and values take the place of those of their name; its [[tables]] come after them.
    // `name` stands for it in messages.
    void replace(const std::string& text, const std::string& name);
    // A config of its own: what is set or read there is not set or read here.
    Config copy() const;
    // All tables that a file of this kind may have; they must outlive the config. From now on it is a
    // std::logic_error to read a key or a table that they do not list.
    void expect(const std::vector<TableRow>& tables);
    Table root();
    // Throws Misuse for the first key that nothing read: with the reason where its row has a condition, else
    // with the nearest key that is expected (or that was read, where expect() was not called).
    void require_all_used() const;
    // The whole as TOML text, includes and assignments merged: what goes into a cache's provenance.
    std::string text() const;
    const std::string& folder() const;
    // The file itself, what it includes, and every path that was asked for.
    std::vector<std::string> files() const;
    // Every file there is that a value names, from the folder on, asked for or not.
    std::vector<std::string> named_files() const;

  private:
    friend class Table;
    struct Body;
    std::shared_ptr<Body> body_;
};

// One table of a Config. Getters take a row, mark its key as used and return its default where the key is not
// written (0 or "" where it has none). Each throws Misuse with file, line, what was found and what is
// allowed; std::logic_error for a row of another kind than its own.
class Table {
  public:
    bool has(const std::string& key) const;
    bool holds(const When& when) const;
    bool present() const;  // whether the table itself is written
    double number(const KeyRow& row) const;
    long integer(const KeyRow& row) const;
    bool boolean(const KeyRow& row) const;
    // A word, a text, or a path, made absolute from the file's folder.
    std::string text(const KeyRow& row) const;
    // Those of the row's words that are written, each once at most.
    std::vector<std::string> words(const KeyRow& row) const;
    // The text of a path where it is one of `names`, which names something else than a file: `text` then
    // returns "" for it. Else "".
    std::string name_in_place_of(const KeyRow& path, const std::vector<std::string>& names) const;
    // A vector: exactly `row.size` numbers.
    std::vector<double> numbers(const KeyRow& row) const;
    // A value with [low, high] in a number's place, low ≤ high: one such pair, an array of them for a vector,
    // or arrays and inline tables of them.
    struct Ranges {
        std::vector<std::array<double, 2>> each;
        std::vector<std::string> around;  // TOML before each and after the last
        // TOML with a number for each.
        std::string with(const std::vector<double>& numbers) const;
    };
    Ranges ranges(const std::string& key) const;
    Table table(const std::string& key) const;
    std::vector<std::string> keys() const;                    // that are written, sorted
    std::vector<Table> tables(const std::string& key) const;  // [[key]]
    // "scene.toml:12: groom.grid": where a message should point; the file is the one that the value was
    // written in, be it included or replaced.
    std::string where(const std::string& key = "") const;
    [[noreturn]] void fail(const std::string& key, const std::string& message) const;

  private:
    friend class Config;
    void note(const std::string& key) const;
    void require_kind(const KeyRow& row, bool right) const;
    std::shared_ptr<Config::Body> body_;
    std::string path_;  // "groom", "solid[0]"
    const void* node_ = nullptr;
};

}  // namespace wetcurl

// Rows: every key of a scene or a recipe is one. A row says the kind of the key, its unit, range, default and
// meaning. Reading a file, its error messages, `wetcurl inspect keys`, docs/scene.md, the schema for editors
// and the tests follow from the rows.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace wetcurl {

inline constexpr double unbounded = std::numeric_limits<double>::infinity();

// integers: a vector of them, or a list of any length; words: an array of any of the words.
enum class Kind { number, integer, boolean, word, text, path, vector, integers, words };
// "number", ..., as listings name it.
const char* name_of(Kind kind);

// Where a row is read: where one of `keys` of the same table is written or, with `words`, has one of these.
// Alternatives are divided by '|'; without keys the row is always read.
struct When {
    const char *keys = "", *words = "";
    bool unwritten = false;  // also where none of the keys is written: a default is among the words
    // "with shape = sphere or capsule"; "" where it is always read.
    std::string text() const;
};

struct KeyRow {
    const char* key;
    Kind kind;
    const char* unit = "";           // of numbers; "1": a ratio or a count
    size_t size = 1;                 // how many numbers a vector has; 0: any number of them
    double fallback = 0;             // of a number; of a boolean 0 or 1
    std::array<double, 3> vector{};  // of a vector: its default
    const char* word = "";           // of a word, a text or a path: its default
    std::span<const char* const> words{};
    double minimum = 0, maximum = 0;  // of each number
    const char* absent = "";   // what holds where the key is not written, if that is no value of its own
    const char* meaning = "";  // one sentence
    const char* source = "";   // where it comes from: "Eq 1, k_s"
    When when{};

    bool has_default() const { return !*absent; }
    bool is_number() const { return kind == Kind::number || kind == Kind::integer; }
    bool is_vector() const { return kind == Kind::vector || kind == Kind::integers; }
    bool is_text() const { return kind == Kind::word || kind == Kind::text || kind == Kind::path; }
    bool is_whole() const { return kind == Kind::integer || kind == Kind::integers; }
    // The default as TOML; "" where there is none.
    std::string default_text() const;

    static constexpr KeyRow number(const char* key, const char* unit, double fallback, double minimum,
                                   double maximum, const char* meaning, const char* source = "",
                                   When when = {}) {
        KeyRow row = of(key, Kind::number, meaning, source, when);
        row.unit = unit, row.fallback = fallback, row.minimum = minimum, row.maximum = maximum;
        return row;
    }
    static constexpr KeyRow integer(const char* key, double fallback, double minimum, double maximum,
                                    const char* meaning, const char* source = "", When when = {}) {
        KeyRow row = number(key, "1", fallback, minimum, maximum, meaning, source, when);
        row.kind = Kind::integer;
        return row;
    }
    template <size_t n>
    static constexpr KeyRow numbers(const char* key, const char* unit, const double (&fallback)[n],
                                    double minimum, double maximum, const char* meaning,
                                    const char* source = "", When when = {}) {
        static_assert(n <= 3);
        KeyRow row = number(key, unit, 0, minimum, maximum, meaning, source, when);
        row.kind = Kind::vector, row.size = n;
        for (size_t k = 0; k < n; ++k) row.vector[k] = fallback[k];
        return row;
    }
    template <size_t n>
    static constexpr KeyRow integers(const char* key, const double (&fallback)[n], double minimum,
                                     double maximum, const char* meaning, const char* source = "",
                                     When when = {}) {
        KeyRow row = numbers(key, "1", fallback, minimum, maximum, meaning, source, when);
        row.kind = Kind::integers;
        return row;
    }
    // Any number of numbers, none by default.
    static constexpr KeyRow list_of_numbers(const char* key, const char* unit, double minimum, double maximum,
                                            const char* meaning, const char* source = "", When when = {}) {
        KeyRow row = number(key, unit, 0, minimum, maximum, meaning, source, when);
        row.kind = Kind::vector, row.size = 0;
        return row;
    }
    // Of whole numbers.
    static constexpr KeyRow list(const char* key, double minimum, double maximum, const char* meaning,
                                 const char* source = "", When when = {}) {
        KeyRow row = number(key, "1", 0, minimum, maximum, meaning, source, when);
        row.kind = Kind::integers, row.size = 0;
        return row;
    }
    static constexpr KeyRow boolean(const char* key, bool fallback, const char* meaning,
                                    const char* source = "", When when = {}) {
        KeyRow row = of(key, Kind::boolean, meaning, source, when);
        row.fallback = fallback;
        return row;
    }
    static constexpr KeyRow one_of(const char* key, std::span<const char* const> words, const char* fallback,
                                   const char* meaning, const char* source = "", When when = {}) {
        KeyRow row = of(key, Kind::word, meaning, source, when);
        row.word = fallback, row.words = words;
        return row;
    }
    // None of them by default.
    static constexpr KeyRow some_of(const char* key, std::span<const char* const> words, const char* meaning,
                                    const char* source = "", When when = {}) {
        KeyRow row = of(key, Kind::words, meaning, source, when);
        row.words = words;
        return row;
    }
    static constexpr KeyRow text(const char* key, const char* fallback, const char* meaning,
                                 const char* source = "", When when = {}) {
        KeyRow row = of(key, Kind::text, meaning, source, when);
        row.word = fallback;
        return row;
    }
    static constexpr KeyRow path(const char* key, const char* absent, const char* meaning,
                                 const char* source = "", When when = {}) {
        KeyRow row = of(key, Kind::path, meaning, source, when);
        row.absent = absent;
        return row;
    }
    // The row without a default: `what` holds where it is not written.
    constexpr KeyRow without_default(const char* what) const {
        KeyRow row = *this;
        row.absent = what;
        return row;
    }

  private:
    static constexpr KeyRow of(const char* key, Kind kind, const char* meaning, const char* source,
                               When when) {
        KeyRow row{key, kind};
        row.meaning = meaning, row.source = source, row.when = when;
        return row;
    }
};

// One table of a file: "groom", "wetness.source"; "" for the keys above the first table.
struct TableRow {
    std::string name, meaning;
    bool repeats = false;  // [[name]]
    bool always = false;   // acts with its defaults where it is not written
    bool open = false;     // has keys of the user's own beside the rows
    When when{};           // of keys of the table that holds it
    std::vector<KeyRow> rows{};
    // "[groom]", "[[solid]]"; "" at the top.
    std::string title() const;
};

// The table that holds another one, and the name in it: "wetness" and "source".
std::string holder_of_table(const std::string& name);
std::string name_in_holder(const std::string& name);

}  // namespace wetcurl

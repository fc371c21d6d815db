// Scene and recipe files, on toml++ (the only place that includes it).
#include "base/config.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#define TOML_ENABLE_FORMATTERS 1
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include "base/lfs_pointer.h"

namespace wetcurl {

namespace fs = std::filesystem;

namespace {

// Where a value was written.
struct Place {
    std::string file;
    int line;
};
using Places = std::map<std::string, Place>;  // of each full path

// The path of the table or array that holds `path`; "" of a name at the top.
std::string holder_of(const std::string& path) {
    const auto end = path.find_last_of(".[");
    return end == std::string::npos ? "" : path.substr(0, end);
}

// "solid.motion" of "solid[0].motion".
std::string without_indices(const std::string& path) {
    std::string out;
    bool within = false;
    for (const char c : path) {
        within = c == '[' || (within && c != ']');
        if (!within && c != ']') out += c;
    }
    return out;
}

}  // namespace

struct Config::Body {
    toml::table root;
    std::string name, folder;
    std::set<std::string> used;                  // full paths that a getter asked for
    std::set<std::string> names;                 // full paths of keys whose value names no file
    std::set<std::string> files;                 // read, or named by a value that was asked for
    std::map<std::string, std::string> written;  // by set(), and what gave it: no line to show
    Places places;                               // of the others
    const std::vector<TableRow>* expected = nullptr;
    std::set<std::string> listed;  // full paths of all keys and tables of `expected`, without indices

    void require_listed(const std::string& path) const {
        if (expected && !listed.contains(without_indices(path)))
            throw std::logic_error(where(path) + ": is read, but no row lists it");
    }

    // "scene.toml:12: ", "--set groom.grid: ", or the file alone where no line is known. What a message about
    // `path` begins with, less the path itself where `set` has said it.
    std::string where(const std::string& path) const {
        for (std::string at = path;; at = holder_of(at)) {
            if (const auto given = written.find(at); given != written.end())
                return at == path ? given->second : given->second + ": " + path;
            if (const auto place = places.find(at); place != places.end())
                return fmt::format("{}:{}: {}", place->second.file, place->second.line, path);
            if (at.empty()) return name + ": " + path;
        }
    }
};

namespace {

std::string read_file(const std::string& path) {
    if (fs::is_directory(path)) throw Misuse(path + ": found a folder, a TOML file is needed");
    std::ifstream in(path, std::ios::binary);
    if (!in) throw Misuse(path + ": cannot be read (no such file, or no permission)");
    std::stringstream text;
    text << in.rdbuf();
    refuse_lfs_pointer(text.str(), path);
    return text.str();
}

constexpr const char* about_backslashes =
    "; a backslash in double quotes begins an escape sequence (\\b is a backspace): in paths write / instead";

// Control characters as TOML writes them.
std::string printable(const std::string& text) {
    const std::pair<char, const char*> short_ones[] = {
        {'\b', "\\b"}, {'\t', "\\t"}, {'\n', "\\n"}, {'\f', "\\f"}, {'\r', "\\r"}};
    std::string out;
    for (const char c : text) {
        const auto known = std::find_if(std::begin(short_ones), std::end(short_ones),
                                        [&](const auto& one) { return one.first == c; });
        if (known != std::end(short_ones))
            out += known->second;
        else if ((unsigned char)c < 32 || c == 127)
            out += fmt::format("\\u{:04x}", int(c));
        else
            out += c;
    }
    return out;
}

// What is wrong with the name of a file in a scene or recipe, where that is its backslashes; "": nothing.
std::string backslashes_in(const std::string& path, const fs::path& folder) {
    if (printable(path) != path)
        return "found '" + printable(path) + "', which has control characters" + about_backslashes;
    std::string slashes = path;
    std::replace(slashes.begin(), slashes.end(), '\\', '/');
    std::error_code none;
    if (slashes != path && !fs::exists(folder / path, none))
        return "no file '" + path + "': folders are divided by / here, not by a backslash; write '" +
               slashes + "'";
    return "";
}

toml::table parse_toml(const std::string& text, const std::string& name) {
    // A run or model in a scene's place would be called bad UTF-8.
    if (text.starts_with("\x89HDF")) throw Misuse(name + ":1: found an HDF5 file, allowed is a scene (TOML)");
    try {
        return toml::parse(text, name);
    } catch (const toml::parse_error& e) {
        const std::string said(e.description());
        throw Misuse(fmt::format("{}:{}: {}{}", name, e.source().begin.line, said,
                                 said.find("escape sequence") == std::string::npos ? "" : about_backslashes));
    }
}

std::string joined(const std::string& path, const std::string& key) {
    return path.empty() ? key : path + "." + key;
}

void note_places(const toml::node& node, const std::string& path, const std::string& file, Places& places) {
    const int line = int(node.source().begin.line);
    if (!path.empty() && line > 0) places[path] = {file, line};
    if (const auto* t = node.as_table())
        for (const auto& [key, value] : *t)
            note_places(value, joined(path, std::string(key.str())), file, places);
    if (const auto* a = node.as_array())
        for (size_t i = 0; i < a->size(); ++i)
            note_places(*a->get(i), fmt::format("{}[{}]", path, i), file, places);
}

// Whether `path` is `top` or lies in it.
bool lies_in(const std::string& path, const std::string& top) {
    return path.starts_with(top) &&
           (path.size() == top.size() || path[top.size()] == '.' || path[top.size()] == '[');
}

// A table and where its values were written.
struct Written {
    toml::table root;
    Places places;
};

Written written_in(const std::string& text, const std::string& name) {
    Written out{parse_toml(text, name), {}};
    note_places(out.root, "", name, out.places);
    return out;
}

// Tables merge key by key; anything else in `over` wins.
void merge_below(toml::table& over, Places& places, const std::string& path, const toml::table& below,
                 const Places& below_places) {
    for (const auto& [key, value] : below) {
        const std::string at = joined(path, std::string(key.str()));
        if (!over.contains(key.str())) {
            over.insert(key, value);
            for (const auto& [name, place] : below_places)
                if (lies_in(name, at)) places[name] = place;
        } else if (value.is_table() && over[key.str()].is_table()) {
            merge_below(*over[key.str()].as_table(), places, at, *value.as_table(), below_places);
        }
    }
}

void include_files(Written& table, const fs::path& folder, const std::string& name, int depth,
                   std::set<std::string>& files) {
    const toml::node* node = table.root.get(include_row.key);
    if (!node) return;
    const auto line = node->source().begin.line;
    if (depth > 8)
        throw Misuse(fmt::format("{}:{}: include: nested deeper than 8 files (a circle?)", name, line));
    if (!node->is_string())
        throw Misuse(fmt::format("{}:{}: include: a file name in quotes is needed", name, line));
    const std::string& given = node->as_string()->get();
    if (const std::string wrong = backslashes_in(given, folder); !wrong.empty())
        throw Misuse(fmt::format("{}:{}: include: {}", name, line, wrong));
    const fs::path path = folder / given;
    if (!fs::exists(path))
        throw Misuse(fmt::format("{}:{}: include: no file '{}'", name, line, path.string()));
    Written below = written_in(read_file(path.string()), path.string());
    files.insert(path.string());
    include_files(below, path.parent_path(), path.string(), depth + 1, files);
    table.root.erase(include_row.key);
    table.places.erase(include_row.key);
    merge_below(table.root, table.places, "", below.root, below.places);
}

const char* type_name(const toml::node& n) {
    switch (n.type()) {
        case toml::node_type::table:
            return "a table";
        case toml::node_type::array:
            return "an array";
        case toml::node_type::string:
            return "a string";
        case toml::node_type::integer:
            return "an integer";
        case toml::node_type::floating_point:
            return "a number";
        case toml::node_type::boolean:
            return "true or false";
        default:
            return "a date or time";
    }
}

std::string shown(const toml::node& n) {
    std::stringstream out;
    n.visit([&](const auto& v) {
        if constexpr (toml::is_table<decltype(v)>)
            out << "a table";
        else
            out << v;
    });
    return out.str();
}

}  // namespace

Config Config::parse(const std::string& text, const std::string& name, const std::string& folder) {
    Config c;
    c.body_ = std::make_shared<Body>();
    c.body_->name = name;
    c.body_->folder = fs::absolute(folder).lexically_normal().string();
    Written written = written_in(text, name);
    include_files(written, folder, name, 0, c.body_->files);
    c.body_->root = std::move(written.root);
    c.body_->places = std::move(written.places);
    return c;
}

Config Config::load(const std::string& path) {
    const std::string text = read_file(path);
    const fs::path folder = fs::path(path).parent_path();
    Config c = parse(text, path, folder.empty() ? "." : folder.string());
    c.body_->files.insert(path);
    return c;
}

// The names of a path, split at its dots; those within quotes belong to a name. Empty where it is none.
static std::vector<std::string> names_of_path(const std::string& path) {
    std::vector<std::string> names(1);
    bool quoted = false;
    for (const unsigned char c : path) {
        if (c == '"')
            quoted = !quoted;
        else if (c == '.' && !quoted)
            names.emplace_back();
        else if (std::isalnum(c) || c == '_' || c == '-' || c == '.')
            names.back() += char(c);
        else if (!std::isspace(c))
            return {};
    }
    const bool whole =
        !quoted && std::none_of(names.begin(), names.end(), [](const auto& n) { return n.empty(); });
    return whole ? names : std::vector<std::string>{};
}

void Config::set(const std::string& assignment, const std::string& option) {
    const std::string who = option.empty() ? "--set " + assignment : option;
    const auto equals = assignment.find('=');
    if (equals == std::string::npos || equals == 0) throw Misuse(who + ": found no 'key.path=value'");
    const std::string value = assignment.substr(equals + 1);
    const auto keys = names_of_path(assignment.substr(0, equals));
    const std::string path = fmt::format("{}", fmt::join(keys, "."));
    if (keys.empty())
        throw Misuse(who + ": found key '" + assignment.substr(0, equals) +
                     "', allowed are names joined by dots, in quotes where a name has dots itself "
                     "(tables [[…]] cannot be set)");
    if (value.find('\n') != std::string::npos)
        throw Misuse((option.empty() ? "--set " + path : option) +
                     ": found a value of several lines, allowed is one");
    toml::table one;
    try {
        one = toml::parse("v = " + value);
    } catch (const toml::parse_error&) {
        one.insert("v", value);
    }
    toml::table* at = &body_->root;
    for (size_t i = 0; i + 1 < keys.size(); ++i) {
        if (!at->contains(keys[i])) at->insert(keys[i], toml::table{});
        at = at->get(keys[i])->as_table();
        if (!at) throw Misuse(who + ": '" + keys[i] + "' is no table");
    }
    at->insert_or_assign(keys.back(), *one.get("v"));
    std::erase_if(body_->places, [&](const auto& place) { return lies_in(place.first, path); });
    std::erase_if(body_->written, [&](const auto& given) { return lies_in(given.first, path); });
    body_->written[path] = option.empty() ? "--set " + path : option;
}

void Config::replace(const std::string& text, const std::string& name) {
    const Written more = written_in(text, name);
    for (const auto& [key, value] : more.root) {
        const std::string path(key.str());
        toml::array* mine = body_->root[key.str()].as_array();
        const toml::array* others = value.as_array();
        if (mine && mine->is_array_of_tables() && others && others->is_array_of_tables()) {
            for (const auto& table : *others) {
                note_places(table, fmt::format("{}[{}]", path, mine->size()), name, body_->places);
                mine->push_back(table);
            }
            continue;
        }
        body_->root.insert_or_assign(key.str(), value);
        std::erase_if(body_->places, [&](const auto& place) { return lies_in(place.first, path); });
        std::erase_if(body_->written, [&](const auto& given) { return lies_in(given.first, path); });
        note_places(value, path, name, body_->places);
    }
}

Config Config::copy() const {
    Config out;
    out.body_ = std::make_shared<Body>(*body_);
    return out;
}

void Config::expect(const std::vector<TableRow>& tables) {
    body_->expected = &tables;
    body_->listed.clear();
    for (const auto& table : tables) {
        body_->listed.insert(table.name);
        for (const auto& row : table.rows) body_->listed.insert(joined(table.name, row.key));
    }
}

Table Config::root() {
    Table t;
    t.body_ = body_;
    t.node_ = &body_->root;
    return t;
}

static void find_unused(const toml::node& node, const std::string& path, const std::set<std::string>& used,
                        std::vector<std::string>& out) {
    if (const auto* t = node.as_table()) {
        if (!path.empty() && !used.count(path)) return out.push_back(path);
        for (const auto& [key, value] : *t)
            find_unused(value, joined(path, std::string(key.str())), used, out);
    } else if (const auto* a = node.as_array(); a && a->is_array_of_tables() && used.count(path)) {
        for (size_t i = 0; i < a->size(); ++i)
            find_unused(*a->get(i), fmt::format("{}[{}]", path, i), used, out);
    } else if (!used.count(path)) {
        out.push_back(path);
    }
}

// " (read with shape = box)" of a key or table that is known and yet was not read; "" of another.
static std::string condition_of(const std::vector<TableRow>& tables, const std::string& path) {
    std::string all;
    auto add = [&](const When& when) {
        if (const std::string text = when.text(); !text.empty()) all += (all.empty() ? "" : ", or ") + text;
    };
    for (const auto& table : tables) {
        if (table.name == path) add(table.when);
        for (const auto& row : table.rows)
            if (joined(table.name, row.key) == path) add(row.when);
    }
    return all.empty() ? "" : " (read " + all + ")";
}

void Config::require_all_used() const {
    std::vector<std::string> unused;
    find_unused(body_->root, "", body_->used, unused);
    if (unused.empty()) return;
    const std::string& path = unused.front();
    if (body_->expected)
        if (const std::string when = condition_of(*body_->expected, without_indices(path)); !when.empty())
            throw Misuse(body_->where(path) + ": unused key '" + path + "'" + when);
    // Names are compared within their table.
    const auto dot = path.rfind('.');
    const std::string prefix = dot == std::string::npos ? "" : path.substr(0, dot + 1);
    std::vector<std::string> siblings;
    auto propose = [&](const std::set<std::string>& names, const std::string& start) {
        for (const auto& name : names)
            if (name.starts_with(start) && name.find('.', start.size()) == std::string::npos)
                siblings.push_back(name.substr(start.size()));
    };
    if (body_->expected)
        propose(body_->listed, without_indices(prefix));
    else
        propose(body_->used, prefix);
    throw Misuse(body_->where(path) + ": unknown or unused key '" + path + "'" +
                 did_you_mean(path.substr(prefix.size()), siblings));
}

std::string Config::text() const {
    std::stringstream out;
    out << toml::toml_formatter(body_->root) << "\n";
    return out.str();
}
const std::string& Config::folder() const { return body_->folder; }
std::vector<std::string> Config::files() const { return {body_->files.begin(), body_->files.end()}; }
std::vector<std::string> Config::named_files() const {
    std::vector<std::string> out;
    std::function<void(const toml::node&)> find = [&](const toml::node& node) {
        if (const auto* t = node.as_table())
            for (const auto& [key, value] : *t) find(value);
        if (const auto* a = node.as_array())
            for (const auto& value : *a) find(value);
        std::error_code none;
        if (const auto* s = node.as_string())
            if (const fs::path path = fs::path(folder()) / s->get(); fs::is_regular_file(path, none))
                out.push_back(path.lexically_normal().string());
    };
    find(body_->root);
    return out;
}

static const toml::table* as_table(const void* node) { return static_cast<const toml::table*>(node); }

bool Table::present() const { return node_ != nullptr; }

std::string Table::where(const std::string& key) const {
    return body_->where(key.empty() ? path_ : joined(path_, key));
}

void Table::fail(const std::string& key, const std::string& message) const {
    throw Misuse(where(key) + ": " + message);
}

bool Table::has(const std::string& key) const {
    body_->require_listed(joined(path_, key));
    return node_ && as_table(node_)->contains(key);
}

void Table::note(const std::string& key) const {
    const std::string path = joined(path_, key);
    body_->require_listed(path);
    body_->used.insert(path);
}

void Table::require_kind(const KeyRow& row, bool right) const {
    if (!right)
        throw std::logic_error(
            fmt::format("{}: a row of kind {} is read as another one", where(row.key), name_of(row.kind)));
}

// Whether one of words that are divided by '|' is `word`.
static bool is_among(const std::string& words, const std::string& word) {
    return ("|" + words + "|").find("|" + word + "|") != std::string::npos;
}

bool Table::holds(const When& when) const {
    if (!*when.keys) return true;
    bool any = false;
    std::stringstream keys(when.keys);
    for (std::string key; std::getline(keys, key, '|');) {
        if (!has(key)) continue;
        any = true;
        const auto* text = as_table(node_)->get(key)->as_string();
        if (!*when.words || (text && is_among(when.words, text->get()))) return true;
    }
    return !any && when.unwritten;
}

// Marks `key` as used and finds its node, null where it is not written.
#define WETCURL_TAKE(key) \
    note(key);            \
    const toml::node* n = node_ ? as_table(node_)->get(key) : nullptr

// "0 to 9", or "whole numbers from 0 to 9".
static std::string range_of(const KeyRow& row) {
    if (row.is_whole()) {
        const long low = long(row.minimum), high = long(row.maximum);
        return fmt::format("{}{} to {}", row.is_vector() ? "whole numbers from " : "", low, high);
    }
    return fmt::format("{} to {}", row.minimum, row.maximum);
}

static double in_range(const Table& t, const KeyRow& row, const toml::node& n) {
    // A whole number beyond 2^53 is no `value` of kind double.
    const double v = n.is_integer() ? double(n.as_integer()->get()) : *n.value<double>();
    const bool whole = !row.is_whole() || v == std::floor(v);
    if (!std::isfinite(v) || v < row.minimum || v > row.maximum || !whole)
        t.fail(row.key, fmt::format("found {}, allowed {}", shown(n), range_of(row)));
    return v;
}

double Table::number(const KeyRow& row) const {
    require_kind(row, row.kind == Kind::number);
    WETCURL_TAKE(row.key);
    if (!n) return row.fallback;
    if (!n->is_number())
        fail(row.key, fmt::format("found {} ({}), a number is needed", shown(*n), type_name(*n)));
    return in_range(*this, row, *n);
}

long Table::integer(const KeyRow& row) const {
    require_kind(row, row.kind == Kind::integer);
    WETCURL_TAKE(row.key);
    if (!n) return long(row.fallback);
    if (!n->is_integer())
        fail(row.key, fmt::format("found {} ({}), a whole number is needed", shown(*n), type_name(*n)));
    in_range(*this, row, *n);
    return long(n->as_integer()->get());
}

bool Table::boolean(const KeyRow& row) const {
    require_kind(row, row.kind == Kind::boolean);
    WETCURL_TAKE(row.key);
    if (!n) return row.fallback != 0;
    if (!n->is_boolean())
        fail(row.key, fmt::format("found {} ({}), true or false is needed", shown(*n), type_name(*n)));
    return n->as_boolean()->get();
}

std::string Table::text(const KeyRow& row) const {
    require_kind(row, row.is_text());
    WETCURL_TAKE(row.key);
    if (!n) return row.word;
    if (!n->is_string())
        fail(row.key, fmt::format("found {} ({}), a string is needed", shown(*n), type_name(*n)));
    const std::string& found = n->as_string()->get();
    if (row.kind == Kind::word && std::find(row.words.begin(), row.words.end(), found) == row.words.end())
        fail(row.key, fmt::format("found '{}', allowed: {}{}", found, fmt::join(row.words, ", "),
                                  did_you_mean(found, {row.words.begin(), row.words.end()})));
    if (row.kind != Kind::path || found.empty()) return found;
    if (body_->names.contains(joined(path_, row.key))) return "";
    if (const std::string wrong = backslashes_in(found, body_->folder); !wrong.empty()) fail(row.key, wrong);
    return *body_->files.insert((fs::path(body_->folder) / found).lexically_normal().string()).first;
}

std::vector<std::string> Table::words(const KeyRow& row) const {
    require_kind(row, row.kind == Kind::words);
    WETCURL_TAKE(row.key);
    std::vector<std::string> out;
    if (!n) return out;
    const auto* a = n->as_array();
    if (!a) fail(row.key, fmt::format("found {}, words in brackets are needed", shown(*n)));
    for (const auto& e : *a) {
        const std::string found = e.is_string() ? e.as_string()->get() : shown(e);
        if (!e.is_string() || std::find(row.words.begin(), row.words.end(), found) == row.words.end())
            fail(row.key, fmt::format("found '{}', allowed: {}{}", found, fmt::join(row.words, ", "),
                                      did_you_mean(found, {row.words.begin(), row.words.end()})));
        if (std::find(out.begin(), out.end(), found) == out.end()) out.push_back(found);
    }
    return out;
}

std::string Table::name_in_place_of(const KeyRow& path, const std::vector<std::string>& names) const {
    const toml::node* n = has(path.key) ? as_table(node_)->get(path.key) : nullptr;
    if (!n || !n->is_string() || std::find(names.begin(), names.end(), n->as_string()->get()) == names.end())
        return "";
    body_->names.insert(joined(path_, path.key));
    return n->as_string()->get();
}

std::vector<double> Table::numbers(const KeyRow& row) const {
    require_kind(row, row.is_vector());
    WETCURL_TAKE(row.key);
    if (!n) return {row.vector.begin(), row.vector.begin() + long(row.size)};
    const auto* a = n->as_array();
    if (!a || (row.size > 0 && a->size() != row.size))
        fail(row.key, fmt::format("found {}, {}numbers in brackets are needed", shown(*n),
                                  row.size > 0 ? fmt::format("{} ", row.size) : ""));
    std::vector<double> out;
    for (const auto& e : *a) {
        if (!e.is_number())
            fail(row.key, fmt::format("found {} ({}), numbers are needed", shown(e), type_name(e)));
        out.push_back(in_range(*this, row, e));
    }
    return out;
}

Table::Ranges Table::ranges(const std::string& key) const {
    WETCURL_TAKE(key);
    Ranges out;
    std::string text;
    auto refuse = [&] {
        fail(key, fmt::format("found {}, [low, high] is needed, or such pairs in arrays and inline tables",
                              n ? shown(*n) : "nothing"));
    };
    std::function<void(const toml::node&, const std::string&)> walk = [&](const toml::node& node,
                                                                          const std::string& path) {
        body_->used.insert(path);
        const auto* array = node.as_array();
        const auto* table = node.as_table();
        if (array && array->size() == 2 && array->get(0)->is_number()) {
            const auto low = array->get(0)->value<double>(), high = array->get(1)->value<double>();
            if (!high || !std::isfinite(*low) || !std::isfinite(*high) || *low > *high) refuse();
            out.each.push_back({*low, *high});
            out.around.push_back(std::exchange(text, ""));
        } else if (array && !array->empty()) {
            for (size_t k = 0; k < array->size(); ++k) {
                text += k ? ", " : "[";
                walk(*array->get(k), fmt::format("{}[{}]", path, k));
            }
            text += "]";
        } else if (table && !table->empty()) {
            const char* before = "{";
            for (const auto& [name, one] : *table) {
                text += fmt::format("{}{} = ", std::exchange(before, ", "), name.str());
                walk(one, joined(path, std::string(name.str())));
            }
            text += "}";
        } else {
            refuse();
        }
    };
    if (!n) refuse();
    walk(*n, joined(path_, key));
    out.around.push_back(text);
    return out;
}

std::string Table::Ranges::with(const std::vector<double>& numbers) const {
    std::string text = around[0];
    for (size_t k = 0; k < each.size(); ++k) text += fmt::format("{}{}", numbers[k], around[k + 1]);
    return text;
}

std::vector<std::string> Table::keys() const {
    std::vector<std::string> out;
    if (node_)
        for (const auto& [key, value] : *as_table(node_)) out.emplace_back(key.str());
    return out;
}

Table Table::table(const std::string& key) const {
    WETCURL_TAKE(key);
    if (n && !n->is_table()) fail(key, fmt::format("found {}, a table [{}] is needed", type_name(*n), key));
    Table t;
    t.body_ = body_;
    t.path_ = joined(path_, key);
    t.node_ = n ? n->as_table() : nullptr;
    return t;
}

std::vector<Table> Table::tables(const std::string& key) const {
    WETCURL_TAKE(key);
    std::vector<Table> out;
    if (!n) return out;
    const auto* a = n->as_array();
    if (!a || (!a->empty() && !a->is_array_of_tables()))
        fail(key, fmt::format("found {}, tables [[{}]] are needed", type_name(*n), key));
    for (size_t i = 0; i < a->size(); ++i) {
        Table t;
        t.body_ = body_;
        t.path_ = fmt::format("{}[{}]", joined(path_, key), i);
        t.node_ = a->get(i)->as_table();
        body_->used.insert(t.path_);
        out.push_back(t);
    }
    return out;
}

#undef WETCURL_TAKE

}  // namespace wetcurl

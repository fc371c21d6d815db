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

namespace wetcurl {

namespace fs = std::filesystem;

struct Config::Body {
    toml::table root;
    std::string name, folder;
    std::set<std::string> used;                  // full paths that a getter asked for
    std::set<std::string> files;                 // read, or named by a value that was asked for
    std::map<std::string, std::string> written;  // by set(), and what gave it: no line to show
};

namespace {

std::string read_file(const std::string& path) {
    if (fs::is_directory(path)) throw Misuse(path + ": found a folder, a TOML file is needed");
    std::ifstream in(path, std::ios::binary);
    if (!in) throw Misuse(path + ": cannot be read (no such file, or no permission)");
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

toml::table parse_toml(const std::string& text, const std::string& name) {
    // A run or model in a scene's place would be called bad UTF-8.
    if (text.starts_with("\x89HDF")) throw Misuse(name + ":1: found an HDF5 file, allowed is a scene (TOML)");
    try {
        return toml::parse(text, name);
    } catch (const toml::parse_error& e) {
        throw Misuse(fmt::format("{}:{}: {}", name, e.source().begin.line, e.description()));
    }
}

// Tables merge key by key; anything else in `over` wins.
void merge_below(toml::table& over, const toml::table& below) {
    for (const auto& [key, value] : below) {
        if (!over.contains(key.str()))
            over.insert(key, value);
        else if (value.is_table() && over[key.str()].is_table())
            merge_below(*over[key.str()].as_table(), *value.as_table());
    }
}

void include_files(toml::table& table, const fs::path& folder, const std::string& name, int depth,
                   std::set<std::string>& files) {
    const toml::node* node = table.get("include");
    if (!node) return;
    const auto line = node->source().begin.line;
    if (depth > 8)
        throw Misuse(fmt::format("{}:{}: include: nested deeper than 8 files (a circle?)", name, line));
    if (!node->is_string())
        throw Misuse(fmt::format("{}:{}: include: a file name in quotes is needed", name, line));
    const fs::path path = folder / node->as_string()->get();
    if (!fs::exists(path))
        throw Misuse(fmt::format("{}:{}: include: no file '{}'", name, line, path.string()));
    toml::table below = parse_toml(read_file(path.string()), path.string());
    files.insert(path.string());
    include_files(below, path.parent_path(), path.string(), depth + 1, files);
    table.erase("include");
    merge_below(table, below);
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

std::string joined(const std::string& path, const std::string& key) {
    return path.empty() ? key : path + "." + key;
}

}  // namespace

Config Config::parse(const std::string& text, const std::string& name, const std::string& folder) {
    Config c;
    c.body_ = std::make_shared<Body>();
    c.body_->name = name;
    c.body_->folder = fs::absolute(folder).lexically_normal().string();
    c.body_->root = parse_toml(text, name);
    include_files(c.body_->root, folder, name, 0, c.body_->files);
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
    const auto equals = assignment.find('=');
    if (equals == std::string::npos || equals == 0)
        throw Misuse("--set " + assignment + ": found no 'key.path=value'");
    const std::string value = assignment.substr(equals + 1);
    const auto keys = names_of_path(assignment.substr(0, equals));
    const std::string path = fmt::format("{}", fmt::join(keys, "."));
    if (keys.empty())
        throw Misuse("--set " + assignment + ": found key '" + assignment.substr(0, equals) +
                     "', allowed are names joined by dots, in quotes where a name has dots itself "
                     "(tables [[…]] cannot be set)");
    if (value.find('\n') != std::string::npos)
        throw Misuse("--set " + path + ": found a value of several lines, allowed is one");
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
        if (!at) throw Misuse("--set " + assignment + ": '" + keys[i] + "' is no table");
    }
    at->insert_or_assign(keys.back(), *one.get("v"));
    body_->written[path] = option.empty() ? "--set " + path : option;
}

void Config::replace(const std::string& text, const std::string& name) {
    for (const auto& [key, value] : parse_toml(text, name)) {
        toml::array* mine = body_->root[key.str()].as_array();
        const toml::array* more = value.as_array();
        if (mine && mine->is_array_of_tables() && more && more->is_array_of_tables())
            for (const auto& table : *more) mine->push_back(table);
        else
            body_->root.insert_or_assign(key.str(), value);
    }
}

Table Config::root() {
    Table t;
    t.body_ = body_;
    t.node_ = &body_->root;
    return t;
}

static void find_unused(const toml::node& node, const std::string& path, const std::set<std::string>& used,
                        std::vector<std::pair<std::string, int>>& out) {
    if (const auto* t = node.as_table()) {
        if (!path.empty() && !used.count(path)) {
            out.emplace_back(path, int(t->source().begin.line));
            return;
        }
        for (const auto& [key, value] : *t)
            find_unused(value, joined(path, std::string(key.str())), used, out);
    } else if (const auto* a = node.as_array(); a && a->is_array_of_tables() && used.count(path)) {
        for (size_t i = 0; i < a->size(); ++i)
            find_unused(*a->get(i), fmt::format("{}[{}]", path, i), used, out);
    } else if (!used.count(path)) {
        out.emplace_back(path, int(node.source().begin.line));
    }
}

void Config::require_all_used() const {
    std::vector<std::pair<std::string, int>> unused;
    find_unused(body_->root, "", body_->used, unused);
    if (unused.empty()) return;
    const auto& [path, line] = unused.front();
    // Names are compared within their table.
    const auto dot = path.rfind('.');
    const std::string prefix = dot == std::string::npos ? "" : path.substr(0, dot + 1);
    std::vector<std::string> siblings;
    for (const auto& u : body_->used)
        if (u.rfind(prefix, 0) == 0 && u.find('.', prefix.size()) == std::string::npos)
            siblings.push_back(u.substr(prefix.size()));
    throw Misuse(fmt::format("{}: unknown or unused key '{}'{}",
                             line > 0 ? fmt::format("{}:{}", body_->name, line) : "--set", path,
                             did_you_mean(path.substr(prefix.size()), siblings)));
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
    const std::string path = key.empty() ? path_ : joined(path_, key);
    if (const auto given = body_->written.find(path); given != body_->written.end()) return given->second;
    const toml::node* at = node_ ? as_table(node_) : nullptr;
    if (at && !key.empty())
        if (const toml::node* child = as_table(node_)->get(key)) at = child;
    const int line = at ? int(at->source().begin.line) : 0;
    return line > 0 ? fmt::format("{}:{}: {}", body_->name, line, path)
                    : fmt::format("{}: {}", body_->name, path);
}

void Table::fail(const std::string& key, const std::string& message) const {
    throw Misuse(where(key) + ": " + message);
}

bool Table::has(const std::string& key) const { return node_ && as_table(node_)->contains(key); }

// Marks `key` as used and finds its node, null where absent.
#define WETCURL_TAKE(key)                   \
    body_->used.insert(joined(path_, key)); \
    const toml::node* n = node_ ? as_table(node_)->get(key) : nullptr

static double finite_in(const Table& t, const std::string& key, double v, const std::string& found,
                        double minimum, double maximum) {
    if (!std::isfinite(v) || v < minimum || v > maximum)
        t.fail(key, fmt::format("found {}, allowed {} to {}", found, minimum, maximum));
    return v;
}

double Table::number(const std::string& key, double fallback, double minimum, double maximum) const {
    WETCURL_TAKE(key);
    if (!n) return fallback;
    if (!n->is_number())
        fail(key, fmt::format("found {} ({}), a number is needed", shown(*n), type_name(*n)));
    return finite_in(*this, key, *n->value<double>(), shown(*n), minimum, maximum);
}

std::optional<double> Table::optional_number(const std::string& key, double minimum, double maximum) const {
    if (!has(key)) {
        body_->used.insert(joined(path_, key));
        return std::nullopt;
    }
    return number(key, 0, minimum, maximum);
}

long Table::integer(const std::string& key, long fallback, long minimum, long maximum) const {
    WETCURL_TAKE(key);
    if (!n) return fallback;
    if (!n->is_integer())
        fail(key, fmt::format("found {} ({}), a whole number is needed", shown(*n), type_name(*n)));
    const long v = long(n->as_integer()->get());
    if (v < minimum || v > maximum) fail(key, fmt::format("found {}, allowed {} to {}", v, minimum, maximum));
    return v;
}

bool Table::boolean(const std::string& key, bool fallback) const {
    WETCURL_TAKE(key);
    if (!n) return fallback;
    if (!n->is_boolean())
        fail(key, fmt::format("found {} ({}), true or false is needed", shown(*n), type_name(*n)));
    return n->as_boolean()->get();
}

std::string Table::text(const std::string& key, const std::string& fallback) const {
    WETCURL_TAKE(key);
    if (!n) return fallback;
    if (!n->is_string())
        fail(key, fmt::format("found {} ({}), a string is needed", shown(*n), type_name(*n)));
    return n->as_string()->get();
}

std::string Table::choice(const std::string& key, const std::string& fallback,
                          const std::vector<std::string>& allowed) const {
    const std::string found = text(key, fallback);
    for (const auto& a : allowed)
        if (a == found) return found;
    fail(key, fmt::format("found '{}', allowed: {}{}", found, fmt::join(allowed, ", "),
                          did_you_mean(found, allowed)));
}

std::vector<double> Table::numbers(const std::string& key, const std::vector<double>& fallback,
                                   double minimum, double maximum) const {
    WETCURL_TAKE(key);
    if (!n) return fallback;
    const auto* a = n->as_array();
    if (!a || a->size() != fallback.size())
        fail(key, fmt::format("found {}, {} numbers in brackets are needed", shown(*n), fallback.size()));
    std::vector<double> out;
    for (const auto& e : *a) {
        if (!e.is_number())
            fail(key, fmt::format("found {} ({}), numbers are needed", shown(e), type_name(e)));
        out.push_back(finite_in(*this, key, *e.value<double>(), shown(e), minimum, maximum));
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

std::string Table::path(const std::string& key) const {
    const std::string p = text(key, "");
    if (p.empty()) return p;
    return *body_->files.insert((fs::path(body_->folder) / p).lexically_normal().string()).first;
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

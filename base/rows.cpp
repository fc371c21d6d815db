// Rows as text.
#include "base/rows.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace wetcurl {

const char* name_of(Kind kind) {
    const char* names[] = {"number", "integer", "boolean",  "word", "text",
                           "path",   "vector",  "integers", "words"};
    return names[size_t(kind)];
}

// "sphere or capsule" of "sphere|capsule".
static std::string alternatives(std::string words) {
    for (size_t at; (at = words.find('|')) != std::string::npos;) words.replace(at, 1, " or ");
    return words;
}

std::string When::text() const {
    if (!*keys) return "";
    return "with " + alternatives(keys) + (*words ? " = " + alternatives(words) : "");
}

std::string KeyRow::default_text() const {
    if (!has_default()) return "";
    if (is_text()) return fmt::format("\"{}\"", word);
    if (kind == Kind::words) return "[]";
    if (kind == Kind::boolean) return fallback != 0 ? "true" : "false";
    if (is_vector()) return fmt::format("[{}]", fmt::join(vector.begin(), vector.begin() + long(size), ", "));
    return fmt::format("{}", fallback);
}

std::string TableRow::title() const {
    if (name.empty()) return "";
    return repeats ? "[[" + name + "]]" : "[" + name + "]";
}

std::string holder_of_table(const std::string& name) {
    const auto dot = name.rfind('.');
    return dot == std::string::npos ? "" : name.substr(0, dot);
}

std::string name_in_holder(const std::string& name) { return name.substr(name.rfind('.') + 1); }

}  // namespace wetcurl

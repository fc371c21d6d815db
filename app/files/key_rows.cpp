// Listings of rows.
#include "app/files/key_rows.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "app/files/results.h"

namespace wetcurl {

namespace {

Json number_of(const KeyRow& row, double value) {
    return row.is_whole() ? Json((long long)value) : Json(value);
}

Json default_of(const KeyRow& row) {
    if (row.is_text()) return row.word;
    if (row.kind == Kind::words) return Json::array();
    if (row.kind == Kind::boolean) return row.fallback != 0;
    if (row.is_number()) return number_of(row, row.fallback);
    Json all = Json::array();
    for (size_t k = 0; k < row.size; ++k) all.push_back(number_of(row, row.vector[k]));
    return all;
}

// {keys, words, unwritten, text}.
Json json_of(const When& when) {
    auto list = [](const char* words) {
        std::vector<std::string> out;
        std::stringstream in(words);
        for (std::string word; std::getline(in, word, '|');) out.push_back(word);
        return out;
    };
    return {{"keys", list(when.keys)},
            {"words", list(when.words)},
            {"unwritten", when.unwritten},
            {"text", when.text()}};
}

Json json_of(const KeyRow& row) {
    Json out{{"key", row.key}, {"kind", name_of(row.kind)}};
    if (row.is_vector()) out["size"] = row.size;
    if (*row.unit) out["unit"] = row.unit;
    if (row.has_default())
        out["default"] = default_of(row);
    else
        out["absent"] = row.absent;
    if (row.is_number() || row.is_vector()) {
        out["minimum"] = number_of(row, row.minimum);
        out["maximum"] = number_of(row, row.maximum);
    }
    if (!row.words.empty()) out["allowed"] = std::vector<std::string>(row.words.begin(), row.words.end());
    out["meaning"] = row.meaning;
    if (*row.source) out["source"] = row.source;
    if (*row.when.keys) out["read"] = json_of(row.when);
    return out;
}

// "0.05 N/m, 0 to 1e+12", "drawn, or sag_free".
std::string values_of(const KeyRow& row) {
    const std::string usual = row.has_default() ? row.default_text() : std::string(row.absent);
    const std::string unit = *row.unit && row.unit != std::string("1") ? fmt::format(" {}", row.unit) : "";
    if (row.is_number() || row.is_vector())
        return fmt::format("{}{}; {} to {}", usual, row.has_default() ? unit : "", row.minimum, row.maximum);
    if (!row.words.empty()) return fmt::format("{}; {}", usual, fmt::join(row.words, " | "));
    return usual;
}

std::string kind_of(const KeyRow& row) {
    if (row.is_vector() && row.size == 0) return row.is_whole() ? "integers" : "numbers";
    if (row.kind == Kind::vector) return fmt::format("{} numbers", row.size);
    if (row.kind == Kind::integers) return fmt::format("{} integers", row.size);
    return name_of(row.kind);
}

// "Force of a segment. (Eq 1, k_s) Read with form = printed."
std::string meaning_of(const KeyRow& row) {
    std::string out = row.meaning;
    if (*row.source) out += fmt::format(" ({})", row.source);
    if (const std::string when = row.when.text(); !when.empty()) out += fmt::format(" Read {}.", when);
    return out;
}

Json schema_of(const KeyRow& row) {
    Json number{{"type", row.is_whole() ? "integer" : "number"},
                {"minimum", number_of(row, row.minimum)},
                {"maximum", number_of(row, row.maximum)}};
    std::string description = meaning_of(row);
    if (*row.unit && row.unit != std::string("1")) description += fmt::format(" [{}]", row.unit);
    if (!row.has_default()) description += fmt::format(" Not written: {}.", row.absent);
    Json out{{"description", description}};
    if (row.is_number()) {
        out.update(number);
    } else if (row.is_vector()) {
        out.update({{"type", "array"}, {"items", number}});
        if (row.size > 0) out.update({{"minItems", row.size}, {"maxItems", row.size}});
    } else if (row.kind == Kind::boolean) {
        out["type"] = "boolean";
    } else if (row.kind == Kind::words) {
        const Json word{{"type", "string"},
                        {"enum", std::vector<std::string>(row.words.begin(), row.words.end())}};
        out.update({{"type", "array"}, {"items", word}});
    } else {
        out["type"] = "string";
        if (row.kind == Kind::word)
            out["enum"] = std::vector<std::string>(row.words.begin(), row.words.end());
    }
    if (row.has_default()) out["default"] = default_of(row);
    return out;
}

// The keys of `table` and the tables in it.
Json object_schema(const std::vector<TableRow>& tables, const TableRow& table) {
    Json properties = Json::object();
    for (const auto& row : table.rows) {
        const Json one = schema_of(row);
        if (!properties.contains(row.key)) {
            properties[row.key] = one;
        } else if (properties[row.key].contains("anyOf")) {
            properties[row.key]["anyOf"].push_back(one);
        } else {
            const Json first = properties[row.key];
            properties[row.key] = {{"anyOf", {first, one}}};
        }
    }
    for (const auto& inner : tables) {
        if (inner.name.empty() || holder_of_table(inner.name) != table.name) continue;
        Json one = object_schema(tables, inner);
        if (inner.repeats) one = {{"description", inner.meaning}, {"type", "array"}, {"items", one}};
        properties[name_in_holder(inner.name)] = one;
    }
    return {{"description", table.meaning},
            {"type", "object"},
            {"properties", properties},
            {"additionalProperties", false}};
}

}  // namespace

Json json_of(const std::vector<TableRow>& tables) {
    Json out{{"tables", Json::array()}};
    for (const auto& table : tables) {
        Json one{{"table", table.name},
                 {"repeats", table.repeats},
                 {"always", table.always},
                 {"open", table.open},
                 {"meaning", table.meaning}};
        if (*table.when.keys) one["read"] = json_of(table.when);
        one["keys"] = Json::array();
        for (const auto& row : table.rows) one["keys"].push_back(json_of(row));
        out["tables"].push_back(one);
    }
    return out;
}

std::string text_of(const std::vector<TableRow>& tables) {
    std::string out;
    for (const auto& table : tables) {
        const std::string title = table.title(), when = table.when.text();
        out += fmt::format("{}{}{}{}\n", out.empty() ? "" : "\n", title.empty() ? "" : title + "  ",
                           table.meaning, when.empty() ? "" : " Read " + when + ".");
        for (const auto& row : table.rows)
            out += fmt::format("  {:<18} {:<11} {}\n    {}\n", row.key, kind_of(row), values_of(row),
                               meaning_of(row));
    }
    return out;
}

Json schema_of(const std::vector<TableRow>& tables, const std::string& title) {
    Json out{{"$schema", "http://json-schema.org/draft-04/schema#"}, {"title", title}};
    out.update(object_schema(tables, tables.front()));
    return out;
}

}  // namespace wetcurl

// Scenes as text, a line for each key, for the tests that walk all rows of a scene.
#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "base/parameters.h"
#include "tests/solver/scenes.h"

namespace wetcurl::testing {

// Lines of a scene. Tables are named as in the rows: "wetness.source" is [[wetness.source]].
class WrittenScene {
  public:
    WrittenScene() = default;
    explicit WrittenScene(const std::string& text) {
        std::stringstream in(text);
        for (std::string line; std::getline(in, line);) lines_.push_back(line);
    }
    // In the first table of that name, which is added at the end where there is none. Returns the line,
    // from 1.
    int set(const TableRow& table, const std::string& key, const std::string& value) {
        remove(table, key);
        size_t at = table.name.empty() ? 0 : place_of(table);
        if (!table.name.empty() && at == 0) {
            lines_.push_back(table.title());
            at = lines_.size();
        }
        lines_.insert(lines_.begin() + long(at), key + " = " + value);
        return int(at) + 1;
    }
    void remove(const TableRow& table, const std::string& key) {
        for (size_t k = table.name.empty() ? 0 : place_of(table); k < lines_.size(); ++k) {
            if (lines_[k].starts_with("[")) return;
            if (lines_[k].starts_with(key + " = ")) {
                lines_.erase(lines_.begin() + long(k));
                return;
            }
        }
    }
    std::string text() const {
        std::string out;
        for (const auto& line : lines_) out += line + "\n";
        return out;
    }

  private:
    // The line after the first header of that name; 0: none.
    size_t place_of(const TableRow& table) const {
        for (size_t k = 0; k < lines_.size(); ++k)
            if (lines_[k] == table.title()) return k + 1;
        return 0;
    }
    std::vector<std::string> lines_;
};

inline std::string full_key(const TableRow& table, const KeyRow& row) {
    return table.name.empty() ? row.key : table.name + "." + row.key;
}
inline std::string number_text(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", value);
    return text;
}
inline std::string quoted(const std::string& text) { return "\"" + text + "\""; }

}  // namespace wetcurl::testing

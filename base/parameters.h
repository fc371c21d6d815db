// Parameters: rows and the members that they fill.
#pragma once

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <type_traits>
#include <variant>

#include "base/config.h"
#include "base/vec3.h"

namespace wetcurl {

// A row, and the member of `Owner` that its value goes to. A bool is also filled by a row of two words: the
// second one is true.
template <class Owner>
struct Parameter : KeyRow {
    std::variant<double Owner::*, int Owner::*, unsigned long long Owner::*, bool Owner::*,
                 std::string Owner::*, Vec3d Owner::*, std::array<int, 2> Owner::*,
                 std::array<int, 3> Owner::*, std::vector<int> Owner::*, std::vector<double> Owner::*,
                 std::vector<std::string> Owner::*, std::optional<double> Owner::*,
                 std::optional<int> Owner::*, std::optional<Vec3d> Owner::*>
        member;
};

inline void read_row(const KeyRow& row, const Table& table, double& value) { value = table.number(row); }
inline void read_row(const KeyRow& row, const Table& table, int& value) { value = int(table.integer(row)); }
inline void read_row(const KeyRow& row, const Table& table, unsigned long long& value) {
    value = (unsigned long long)table.integer(row);
}
inline void read_row(const KeyRow& row, const Table& table, bool& value) {
    value = row.kind == Kind::word ? table.text(row) == row.words[1] : table.boolean(row);
}
inline void read_row(const KeyRow& row, const Table& table, std::string& value) { value = table.text(row); }
inline void read_row(const KeyRow& row, const Table& table, Vec3d& value) {
    const auto v = table.numbers(row);
    value = {v.at(0), v.at(1), v.at(2)};
}
template <size_t n>
void read_row(const KeyRow& row, const Table& table, std::array<int, n>& value) {
    const auto v = table.numbers(row);
    for (size_t k = 0; k < n; ++k) value[k] = int(v.at(k));
}
inline void read_row(const KeyRow& row, const Table& table, std::vector<int>& value) {
    const auto v = table.numbers(row);
    value.assign(v.begin(), v.end());
}
inline void read_row(const KeyRow& row, const Table& table, std::vector<double>& value) {
    value = table.numbers(row);
}
inline void read_row(const KeyRow& row, const Table& table, std::vector<std::string>& value) {
    value = table.words(row);
}
template <class Value>
void read_row(const KeyRow& row, const Table& table, std::optional<Value>& value) {
    read_row(row, table, value.emplace());
}

template <class Owner>
void read_parameter(std::type_identity_t<Owner>& owner, const Parameter<Owner>& row, const Table& table) {
    std::visit([&](auto member) { read_row(row, table, owner.*member); }, row.member);
}

// Fills the members of the rows that are read in this table (`KeyRow::when`): from `table`, or with the
// default where the key is not written. A member of a row without default then stays as it is.
template <class Owner, size_t N>
void read_parameters(std::type_identity_t<Owner>& owner, const Parameter<Owner> (&rows)[N],
                     const Table& table) {
    for (const auto& row : rows)
        if (table.holds(row.when) && (row.has_default() || table.has(row.key)))
            read_parameter(owner, row, table);
}

}  // namespace wetcurl

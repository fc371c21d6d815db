// Rows of a scene (base/rows.h) for people, for scripts and for editors.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "base/rows.h"

namespace wetcurl {

using Json = nlohmann::ordered_json;

// {tables: [{table, repeats, always, open, meaning, read, keys: [{key, kind, unit, size, default, absent,
// minimum, maximum, allowed, meaning, source, read}]}]}; what does not apply to a key is left out. `read`,
// the condition under which something is read: {keys, words, unwritten, text}.
Json json_of(const std::vector<TableRow>& tables);
// The same as text, a table after the other.
std::string text_of(const std::vector<TableRow>& tables);
// A JSON schema (draft 4, which Taplo reads) of files with these tables: kinds, ranges, words and names.
// Conditions between keys
// (`When`) are not in it, since a file may include the other key.
Json schema_of(const std::vector<TableRow>& tables, const std::string& title);

}  // namespace wetcurl

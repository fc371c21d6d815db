// Results as JSON and the interrupt key: what several commands share. Ours.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace wetcurl {

using Json = nlohmann::ordered_json;

// To `path`, "-" for standard output, "" for nowhere.
void write_json(const Json& json, const std::string& path);

// {mean, median, min, max, std} of run times [s].
Json time_statistics(std::vector<double> seconds);

}  // namespace wetcurl

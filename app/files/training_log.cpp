// Reads the log of a training.
#include "app/files/training_log.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/error.h"

namespace wetcurl {

using LogLine = nlohmann::json;

double TrainingLog::least(const std::string& series_name) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Series& s : series)
        if (s.name == series_name)
            for (double v : s.value) least = std::min(least, v);
    return least;
}

bool has_two_epochs(const std::string& path) {
    std::ifstream file(path);
    return std::count(std::istreambuf_iterator<char>(file), {}, '\n') >= 2;
}

bool is_training_log(const std::string& path) { return path.ends_with(".jsonl"); }

TrainingLog read_training_log(const std::string& path) {
    std::ifstream file(path);
    if (!file) throw Error(path + ": cannot be read; allowed is what train leaves beside its model");
    std::vector<LogLine> lines;
    for (std::string line; std::getline(file, line) && !file.eof();) {  // a last line may be half written
        lines.push_back(LogLine::parse(line, nullptr, /*allow_exceptions=*/false));
        const LogLine& l = lines.back();
        if (!l.is_object() || !(l.contains("loss") || l.contains("validation_loss")))
            throw Error(path + ":" + std::to_string(lines.size()) +
                        ": found no line of a training's log, allowed is what train leaves beside its model");
    }
    if (lines.size() < 2)
        throw Error(path + ": found " + std::to_string(lines.size()) +
                    " epochs, two or more are needed for a curve");
    auto any = [&](const char* key) {
        return std::any_of(lines.begin(), lines.end(),
                           [&](const LogLine& l) { return l.contains(key) && l[key].is_number(); });
    };
    TrainingLog log;
    log.path = path;
    log.name = std::filesystem::path(path).stem().stem().string();
    const char* keys[3] = {"loss", "validation_loss", "base_loss"};
    const bool root_of_loss = !any("validation_mm") && !any("training_mm") && any("validation_nrmse");
    if (root_of_loss) {
        log.quantity = "root mean square error of F.n", log.unit = "sigma m a_max";
        keys[1] = "validation_nrmse", keys[2] = "base_nrmse";
    } else if (any("validation_mm") || any("training_mm")) {
        log.quantity = "mean error", log.unit = "mm";
        keys[0] = "training_mm", keys[1] = "validation_mm", keys[2] = "base_mm";
    } else {
        log.quantity = "loss", log.unit = "1";
    }
    const char* names[3] = {"training", "held out", "no network"};
    for (int k = 0; k < 3; ++k) {
        TrainingLog::Series s{names[k], {}, {}};
        for (size_t l = 0; l < lines.size(); ++l) {
            const auto found = lines[l].find(keys[k]);
            if (found == lines[l].end() || !found->is_number()) continue;
            const LogLine epoch = lines[l].value("epoch", LogLine());
            s.epoch.push_back(epoch.is_number() ? epoch.get<double>() : double(l + 1));
            s.value.push_back(k == 0 && root_of_loss ? std::sqrt(found->get<double>())
                                                     : found->get<double>());
            log.epochs = std::max(log.epochs, long(s.epoch.back()));
        }
        if (!s.value.empty()) log.series.push_back(std::move(s));
    }
    return log;
}

}  // namespace wetcurl

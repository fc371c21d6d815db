// The log of a training, MODEL.h5.jsonl: one JSON object an epoch (training/metrics_log.h), as curves.
#pragma once

#include <string>
#include <vector>

namespace wetcurl {

struct TrainingLog {
    struct Series {
        std::string name;  // training | held out | no network
        std::vector<double> epoch, value;
    };
    std::string path, name;      // of the model
    std::string quantity, unit;  // "mean error", "mm"
    long epochs = 0;             // the last
    std::vector<Series> series;  // each with one value or more

    std::string label() const { return quantity + " [" + unit + "]"; }
    // The least that a series ever had; infinite where the log has no such series.
    double least(const std::string& series_name) const;
};

// In mm where the log has distances, in units of the largest adhesion force where it has those (root mean
// squares), else the loss itself. A last line that does not end yet is left out. Throws Error where the file
// cannot be read, a line is no training's, or there are fewer than two epochs.
TrainingLog read_training_log(const std::string& path);

// Whether it has what a curve needs.
bool has_two_epochs(const std::string& path);

bool is_training_log(const std::string& path);

}  // namespace wetcurl

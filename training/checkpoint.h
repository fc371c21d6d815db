// The whole state of a training between two steps: HDF5 "wetcurl checkpoint", version 1.
// The order of the data follows from (seed, epoch), so place and recipe stand for sampler and random
// state.
#pragma once

#include <string>

#include "models/layers.h"

namespace wetcurl {

inline constexpr const char* checkpoint_format = "wetcurl checkpoint";
inline constexpr int checkpoint_version = 2;

struct TrainingState {
    Tensor weights, first_moment, second_moment;  // (n)
    Tensor best;                                  // (n), weights of the best validation so far
    long optimiser_steps = 0;
    long epoch = 0, step = 0;    // the next step to be done
    double loss_sum = 0;         // of this epoch's steps so far
    double best_loss = 0;        // of `best`
    long best_epoch = -1;        // epochs done then; -1: none yet
    double begun_with = -1;      // held-out error [m] of the weights of another model; below 0: none
    long log_position = 0;       // [bytes]
    std::string recipe, inputs;  // what it was made with: another one cannot go on from here
};

// Written beside its name and renamed when whole: a reader finds the last one or this one, never a part.
void save_checkpoint(const std::string& path, const TrainingState& state);
// `n` weights are expected. Throws Error where the file is damaged or of another network.
TrainingState load_checkpoint(const std::string& path, long n);

}  // namespace wetcurl

// The model file: HDF5 "wetcurl model", version 1. Named single-precision tensors and the card; never an
// archive of one LibTorch version.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "base/hdf5.h"
#include "models/layers.h"
#include "models/model_card.h"

namespace wetcurl {

// Throws Error where it cannot be written, or is there and `overwrite` is false.
void save_model(const std::string& path, const ModelCard& card, const TorchNetwork& model, bool overwrite);
// Into a place that was secured before.
void save_model(OutputFile place, const ModelCard& card, const TorchNetwork& model);
// Throws Error where the file is missing, cut short, foreign, newer, holds a value that is not finite, or
// weights that do not fit the network it names.
ModelCard read_card(const std::string& path);
std::pair<ModelCard, std::shared_ptr<TorchNetwork>> load_model(const std::string& path);

// The weights under "weights/NAME" of a file.
void write_weights(H5Writer& file, const TorchNetwork& model);
void read_weights(const H5Reader& file, TorchNetwork& model);

}  // namespace wetcurl

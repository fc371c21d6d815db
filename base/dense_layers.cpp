// Sizes of a small network that can be.
#include "base/dense_layers.h"

#include <algorithm>
#include <string>

#include "base/error.h"

namespace wetcurl {

DenseLayers::DenseLayers(std::vector<int> sizes, std::vector<float> numbers)
    : sizes_(std::move(sizes)), numbers_(std::move(numbers)) {
    std::string found = "dense layers: found sizes";
    for (int size : sizes_) found += ' ' + std::to_string(size);
    const int layers = int(sizes_.size()) - 1, most = DenseView::most_layers, widest = DenseView::widest;
    if (layers < 1 || layers > most)
        throw Error(found + ", needed those of 1 to " + std::to_string(most) + " layers and of their input");
    if (std::any_of(sizes_.begin(), sizes_.end(), [&](int size) { return size < 1 || size > widest; }))
        throw Error(found + ", allowed are 1 to " + std::to_string(widest));
    if (sizes_.back() != 1) throw Error(found + ", the last must be 1");
    size_t needed = 0;
    for (size_t k = 0; k + 1 < sizes_.size(); ++k) needed += size_t((sizes_[k] + 1) * sizes_[k + 1]);
    if (numbers_.size() != needed)
        throw Error(found + " and " + std::to_string(numbers_.size()) + " numbers, needed " +
                    std::to_string(needed));
}

DenseView DenseLayers::view(const float* numbers) const {
    DenseView view{{}, int(sizes_.size()) - 1, numbers};
    std::copy(sizes_.begin(), sizes_.end(), view.sizes);
    return view;
}

}  // namespace wetcurl

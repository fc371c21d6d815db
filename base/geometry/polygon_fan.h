// Where polygons are fanned from: a face that is there twice, in either turn, becomes the same triangles
// twice.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <unordered_map>

namespace wetcurl {

class PolygonFans {
  public:
    // Of a polygon whose corners have these keys, equal for equal places: the number of the corner to fan it
    // from. 0, or where the same corners came before, the one that was taken then.
    size_t start_of(std::span<const uint64_t> keys) {
        if (keys.size() < 4) return 0;
        uint64_t sum = 0;
        for (const uint64_t key : keys) sum += mixed(key);
        const uint64_t first = starts_.try_emplace(sum, keys[0]).first->second;
        const auto at = std::find(keys.begin(), keys.end(), first);
        return at == keys.end() ? 0 : size_t(at - keys.begin());
    }

    // splitmix64
    static uint64_t mixed(uint64_t x) {
        x += 0x9e3779b97f4a7c15;
        x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9;
        x = (x ^ x >> 27) * 0x94d049bb133111eb;
        return x ^ x >> 31;
    }

  private:
    std::unordered_map<uint64_t, uint64_t> starts_;
};

}  // namespace wetcurl

// What libwetcurl promises of shots, crops and bad input: shots SCENE.toml MODEL.h5, of a scene that is wet
// everywhere. Ends with status 1 where a promise is broken; prints what was refused.
#include <cmath>
#include <cstdio>
#include <wetcurl/wetcurl.hpp>

#include "promises.h"

namespace {

const wetcurl::PoseArray still{0, 0, 0, 1, 0, 0, 0};

}  // namespace

int main(int argc, char** argv) try {
    if (argc != 3) return std::fprintf(stderr, "use: shots SCENE.toml MODEL.h5\n"), 2;
    wetcurl::Hair hair(argv[1], argv[2]);
    const std::vector<float> rest = hair.low_at_rest();
    std::vector<float> low(rest), high(size_t(hair.high_strands()) * size_t(hair.particles()) * 3);
    hair.bind(low.data(), high.data());
    hair.run(still);
    const std::vector<float> first = high;

    for (size_t k = 0; k < low.size(); k += 3) low[k] += 0.01f;
    const wetcurl::PoseArray turned{0.01, 0, 0, std::cos(0.05), 0, std::sin(0.05), 0};
    hair.run(still, turned, turned);
    require(high != first, "another frame has other strands");

    hair.restart();
    low = rest;
    hair.run(still);
    require(high == first, "another shot begins as the first one did");

    hair.crop();
    hair.restart();
    hair.run(still);
    require(high == first, "a crop of hair that is wet everywhere leaves out nothing");

    require_refused([&] { hair.run({0, NAN, 0, 1, 0, 0, 0}); });
    require_refused([&] { hair.run({0, 0, 0, 2, 0, 0, 0}); });
    require_refused([&] { hair.bind(nullptr, high.data()); });
    low[7] = NAN;
    require_refused([&] { hair.run(still); });
    return 0;
} catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
}

// What libwetcurl promises of shots, crops and bad input: shots SCENE.toml MODEL.h5, of a scene that is wet
// everywhere. Ends with status 1 where a promise is broken; prints what was refused.
#include <algorithm>
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
    const wetcurl::PoseArray turned{0.01, 0, 0, std::cos(0.05), 0, std::sin(0.05), 0};
    // The first frame of a shot, which another shot has too.
    const auto begun_twice = [&](wetcurl::Hair& with) {
        std::vector<float> low(rest), high(size_t(with.high_strands()) * size_t(with.particles()) * 3);
        with.bind(low.data(), high.data());
        with.run(still);
        const std::vector<float> first = high;
        for (size_t k = 0; k < low.size(); k += 3) low[k] += 0.01f;
        with.run(still, turned, turned);
        require(high != first, "another frame has other strands");
        with.restart();
        low = rest;
        with.run(still);
        require(high == first, "another shot begins as the first one did");
        return first;
    };
    const std::vector<float> first = begun_twice(hair);
    std::vector<float> low(rest), high(first.size());
    hair.bind(low.data(), high.data());

    hair.crop();
    hair.restart();
    hair.run(still);
    require(high == first, "a crop of hair that is wet everywhere leaves out nothing");

    // Locks take the place of what draws strands together otherwise.
    wetcurl::Hair drawn(argv[1], argv[2]);
    drawn.locks(14);
    const std::vector<float> in_locks = begun_twice(drawn);
    require(in_locks != first, "locks move strands");
    double apart = 0;
    for (size_t k = 0; k < first.size(); ++k) apart += std::fabs(in_locks[k] - first[k]);
    require(apart / double(first.size()) < 0.01, "strands are drawn to those around them, no further");
    require_refused([&] { drawn.locks(14); });  // it is bound
    wetcurl::Hair none(argv[1], argv[2]);
    require_refused([&] { none.locks(0); });

    // From other strands: places and numbers, and what is expected of the network with few of them.
    wetcurl::Hair few(argv[1], argv[2], wetcurl_low_run{4, 0, 2}),
        guided(argv[1], argv[2], wetcurl_low_run{0, 9, 0});
    require(few.low_strands() * 16 == few.high_strands(), "every fourth root each way is read");
    require(guided.low_strands() == 9, "so many guides are read");
    for (wetcurl::Hair* from : {&few, &guided}) {
        const std::vector<float> at_rest = from->low_at_rest();
        const std::vector<int> places = from->low_places();
        require(std::is_sorted(places.begin(), places.end()) && places.back() < from->high_strands(),
                "strands that are read are some of the scene's");
        require_refused([&] { from->expected_errors(); });
        std::vector<float> wet(high.size());
        from->bind(at_rest.data(), wet.data());
        from->run(still);
        // Their roots are those of the strands that they are.
        const size_t strand = 3 * size_t(from->particles());
        for (size_t k = 0; k < places.size(); ++k)
            for (size_t axis = 0; axis < 3; ++axis)
                require(
                    std::fabs(wet[size_t(places[k]) * strand + axis] - at_rest[k * strand + axis]) < 1e-5f,
                    "a strand that is read is where it is written");
        const std::vector<float> errors = from->expected_errors();
        require(errors.size() == 8 * size_t(from->high_strands()), "each eighth of a strand has an error");
        for (const float e : errors) require(e > 0 && e < 0.5f, "an expected error is a length");
    }
    require_refused([&] { wetcurl::Hair(argv[1], argv[2], wetcurl_low_run{1, 0, 0}); });
    require_refused([&] { wetcurl::Hair(argv[1], argv[2], wetcurl_low_run{2, 65, 0}); });
    require_refused([&] { hair.expected_errors(); });  // of a crop

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

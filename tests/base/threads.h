// The same act by one thread and by several.
#pragma once

#include <omp.h>

#include <utility>

namespace wetcurl::testing {

// What make() gives with one thread, and with three: no power of two, so that shares of the work are uneven.
template <class Make>
auto with_one_and_three_threads(Make make) {
    const int before = omp_get_max_threads();
    omp_set_num_threads(1);
    auto one = make();
    omp_set_num_threads(3);
    auto three = make();
    omp_set_num_threads(before);
    return std::pair(std::move(one), std::move(three));
}

}  // namespace wetcurl::testing

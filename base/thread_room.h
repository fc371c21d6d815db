// Room for numbers, a part for each thread of a team, that is kept from team to team.
#pragma once

#include <omp.h>

#include <cstddef>
#include <vector>

namespace wetcurl {

template <class T>
class ThreadRoom {
  public:
    // Outside a parallel region, before `mine`: of `count` for each thread that the next one may have.
    void require(size_t count) {
        each_ = count;
        const size_t all = count * size_t(omp_get_max_threads());
        if (room_.size() < all) room_.resize(all);
    }
    T* mine() { return room_.data() + each_ * size_t(omp_get_thread_num()); }

  private:
    size_t each_ = 0;
    std::vector<T> room_;
};

}  // namespace wetcurl

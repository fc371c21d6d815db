// What the functions of the library share: errors, threads, arguments.
#pragma once

#include <omp.h>

#include <cmath>
#include <mutex>
#include <string>

#include "base/error.h"
#include "base/vec3.h"

namespace wetcurl {

// Of wetcurl_error().
std::string& last_error();
// Held where files are read: HDF5 is not made for several threads.
std::mutex& opening();

// What `act` returns, or `otherwise` where it throws.
template <class Value, class Act>
Value guarded(Value otherwise, Act act) noexcept {
    try {
        last_error().clear();
        return act();
    } catch (const std::exception& e) {
        last_error() = e.what();
    } catch (...) {
        last_error() = "an error of no known kind";
    }
    return otherwise;
}
// 0, or -1 where `act` throws.
template <class Act>
int status_of(Act act) noexcept {
    return guarded(-1, [&] { return act(), 0; });
}

// Of OpenMP in the caller's thread, which has its own number back afterwards.
class Threads {
  public:
    explicit Threads(int count) : before_(omp_get_max_threads()) { omp_set_num_threads(count); }
    ~Threads() { omp_set_num_threads(before_); }
    Threads(const Threads&) = delete;

  private:
    int before_;
};

// 0 asks for all.
inline int threads_of(int asked, const std::string& function) {
    constexpr int most = 4096;
    if (asked < 0 || asked > most)
        throw Error(function + ": found " + std::to_string(asked) + " threads, allowed 0 to " +
                    std::to_string(most));
    return asked > 0 ? asked : omp_get_num_procs();
}

inline Pose pose_of(const double* p) {
    for (int k = 0; k < 7; ++k)
        if (!std::isfinite(p[k]))
            throw Error("pose: number " + std::to_string(k) + " of 7 is not finite (x y z, then w x y z)");
    const Quatd q{p[3], p[4], p[5], p[6]};
    const double size = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
    if (!(std::abs(size - 1) < 1e-3))
        throw Error("pose: found a quaternion of length " + std::to_string(std::sqrt(size)) +
                    ", allowed 1 (x y z, then w x y z)");
    return {normalized(q), {p[0], p[1], p[2]}};
}

template <class T>
const T* given(const T* what, const std::string& function, const char* name) {
    if (!what) throw Error(function + ": " + name + " is NULL");
    return what;
}

}  // namespace wetcurl

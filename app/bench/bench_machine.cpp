// What the machine does at most, measured on the spot: beside it stand the times of `wetcurl bench`.
#include <omp.h>

#include <algorithm>
#include <cstring>
#include <fstream>

#include "app/bench/bench.h"
#include "app/engine/device.h"
#include "base/pack.h"
#include "base/provenance.h"

namespace wetcurl::bench {

namespace {

// Of a copy far larger than any cache by all threads.
double copy_rate() {
    constexpr size_t chunk = size_t(1) << 20, chunks = 128;
    std::vector<char> from(chunk * chunks, 1), to(chunk * chunks);
    const Times t = repeated([&] {
        return [&] {
#pragma omp parallel for schedule(static)
            for (size_t c = 0; c < chunks; ++c) std::memcpy(&to[c * chunk], &from[c * chunk], chunk);
        };
    });
    return 2.0 * double(from.size()) / t.min;
}

// Of so many independent chains of multiply-adds in every thread's registers.
template <int Chains>
double arithmetic_rate() {
    using S = Pack<float>;
    constexpr int rounds = 1 << 20;
    const int threads = omp_get_max_threads();
    std::vector<float> sums(size_t(threads) * 16);
    const Times t = repeated([&] {
        return [&] {
#pragma omp parallel num_threads(threads)
            {
                S x[Chains];
                for (int k = 0; k < Chains; ++k) x[k] = S(k);
                const S a(0.999f), b(0.001f);
                for (int round = 0; round < rounds; ++round)
                    for (int k = 0; k < Chains; ++k) x[k] = x[k] * a + b;
                for (const S& chain : x)
                    for (int lane = 0; lane < S::lanes; ++lane)
                        sums[size_t(omp_get_thread_num()) * 16] += chain[lane];
            }
        };
    });
    return 2.0 * S::lanes * Chains * rounds * threads / t.min;
}

// The line of a file of /proc that begins with `key`, in kB.
size_t kilobytes(const char* file, const char* key) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);)
        if (line.rfind(key, 0) == 0) return size_t(std::stod(line.substr(std::strlen(key))) * 1024);
    return 0;
}

}  // namespace

Machine machine_of(const std::string& device) {
    if (device != "cpu") {
        const DeviceRates rates = rates_of_cuda_device(device);
        return {rates.name, omp_get_max_threads(), rates.copy_bytes, rates.operations};
    }
    // The first fits the registers of AVX2, the second those of AVX-512.
    return {processor_name(), omp_get_max_threads(), copy_rate(),
            std::max(arithmetic_rate<5>(), arithmetic_rate<10>())};
}

size_t available_bytes() { return kilobytes("/proc/meminfo", "MemAvailable:"); }
size_t peak_bytes() { return kilobytes("/proc/self/status", "VmHWM:"); }

}  // namespace wetcurl::bench

// Provenance.
#include "base/provenance.h"

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <mutex>

#include "base/revision.h"  // made by the build: revision.cmake

namespace wetcurl {

namespace {

std::string gpu = "none";
std::mutex gpu_mutex;

std::string processor() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        const size_t colon = line.find(": ");
        if (line.rfind("model name", 0) == 0 && colon != std::string::npos) return line.substr(colon + 2);
    }
    return "unknown";
}

std::string date() {
    std::time_t now = std::time(nullptr);
    if (const char* epoch = std::getenv("SOURCE_DATE_EPOCH")) now = std::time_t(std::atoll(epoch));
    std::tm utc{};
    gmtime_r(&now, &utc);
    char text[16];
    return {text, std::strftime(text, sizeof text, "%F", &utc)};
}

}  // namespace

void note_gpu(const std::string& name) {
    const std::lock_guard lock(gpu_mutex);
    gpu = name;
}

Provenance provenance() {
    const std::lock_guard lock(gpu_mutex);
    return {
        {"version", WETCURL_VERSION}, {"revision", WETCURL_REVISION}, {"preset", WETCURL_PRESET},
#ifdef __clang__
            {"compiler", "clang " __clang_version__},
#else
            {"compiler", "g++ " __VERSION__},
#endif
#if defined(__AVX512F__)
            {"instruction_set", "AVX-512, " WETCURL_MARCH},
#elif defined(__AVX2__)
            {"instruction_set", "AVX2, " WETCURL_MARCH},
#else
            {"instruction_set", "SSE, " WETCURL_MARCH},
#endif
            {"processor", processor()}, {"gpu", gpu}, {
            "date", date()
        }
    };
}

}  // namespace wetcurl

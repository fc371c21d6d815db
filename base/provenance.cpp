// Provenance.
#include "base/provenance.h"

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <mutex>

#include "base/revision.h"  // made by the build: revision.cmake

namespace wetcurl {

namespace {

#ifdef __clang__
constexpr const char* compiler = "clang " __clang_version__;
#else
constexpr const char* compiler = "g++ " __VERSION__;
#endif

#if defined(__AVX512F__)
constexpr const char* instruction_set = "AVX-512, " WETCURL_MARCH;
#elif defined(__AVX2__)
constexpr const char* instruction_set = "AVX2, " WETCURL_MARCH;
#else
constexpr const char* instruction_set = "SSE, " WETCURL_MARCH;
#endif

std::string gpu = "none";
std::mutex gpu_mutex;

std::string date() {
    std::time_t now = std::time(nullptr);
    if (const char* epoch = std::getenv("SOURCE_DATE_EPOCH")) now = std::time_t(std::atoll(epoch));
    std::tm utc{};
    gmtime_r(&now, &utc);
    char text[16];
    return {text, std::strftime(text, sizeof text, "%F", &utc)};
}

}  // namespace

std::string processor_name() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        const size_t colon = line.find(": ");
        if (line.rfind("model name", 0) == 0 && colon != std::string::npos) return line.substr(colon + 2);
    }
    return "unknown";
}

void note_gpu(const std::string& name) {
    const std::lock_guard lock(gpu_mutex);
    gpu = name;
}

Provenance provenance() {
    const std::lock_guard lock(gpu_mutex);
    return {{"version", WETCURL_VERSION},
            {"revision", WETCURL_REVISION},
            {"preset", WETCURL_PRESET},
            {"compiler", compiler},
            {"instruction_set", instruction_set},
            {"processor", processor_name()},
            {"gpu", gpu},
            {"date", date()}};
}

}  // namespace wetcurl

// Starts the build of the program that this processor runs fastest: of those under lib/wetcurl, made from the
// same source for x86-64-v4 (AVX-512), v3 (AVX2 with FMA) and v2 (SSE 4.2).
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

namespace {

struct Build {
    const char* name;
    bool runs;
};

}  // namespace

int main(int, char** arguments) {
    __builtin_cpu_init();
    const Build builds[] = {{"x86-64-v4", bool(__builtin_cpu_supports("x86-64-v4"))},
                            {"x86-64-v3", bool(__builtin_cpu_supports("x86-64-v3"))},
                            {"x86-64-v2", bool(__builtin_cpu_supports("x86-64-v2"))}};
    std::error_code failed;
    const auto folder = std::filesystem::read_symlink("/proc/self/exe", failed).parent_path().parent_path();
    const char* asked = std::getenv("WETCURL_ARCH");
    for (const Build& build : builds) {
        if (asked ? std::string(asked) != build.name : !build.runs) continue;
        if (!build.runs) {
            std::fprintf(stderr, "error: WETCURL_ARCH: found %s, which this processor does not run\n", asked);
            return 1;
        }
        const std::string program = folder / "lib" / "wetcurl" / build.name / "bin" / "wetcurl";
        if (!std::filesystem::exists(program)) continue;
        arguments[0] = const_cast<char*>(program.c_str());
        execv(arguments[0], arguments);
        std::perror(program.c_str());
        return 1;
    }
    std::fprintf(stderr, "error: found no build for %s under %s, allowed are x86-64-v2, v3 and v4\n",
                 asked ? asked : "this processor", folder.c_str());
    return 1;
}

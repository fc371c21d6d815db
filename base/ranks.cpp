// Which of how many processes this one is.
#include "base/ranks.h"

#include <charconv>
#include <cstdlib>
#include <cstring>

#include "base/error.h"

namespace wetcurl {
namespace {

struct Launcher {
    const char *rank, *size, *here;
};
// torchrun first: it may run inside a job of Slurm, which then counts hosts.
constexpr Launcher by_hand = {"RANK", "WORLD_SIZE", "LOCAL_RANK"};
constexpr Launcher launchers[] = {
    by_hand,
    {"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_LOCAL_RANK"},
    {"PMI_RANK", "PMI_SIZE", "MPI_LOCALRANKID"},
    {"SLURM_PROCID", "SLURM_STEP_NUM_TASKS", "SLURM_LOCALID"}};
constexpr long most_processes = 1 << 20;

bool is_set(const char* variable) { return std::getenv(variable) != nullptr; }

// One of the two alone would start as many trainings as there are processes, over the same files.
void require_both() {
    if (is_set(by_hand.rank) == is_set(by_hand.size)) return;
    const bool rank = is_set(by_hand.rank);
    throw Misuse(std::string(rank ? by_hand.rank : by_hand.size) + ": is set without " +
                 (rank ? by_hand.size : by_hand.rank) + ", which processes that share work need too");
}

}  // namespace

long environment_number(const std::string& variable, long fallback, long minimum, long maximum) {
    const char* text = std::getenv(variable.c_str());
    if (!text) return fallback;
    const char* end = text + std::strlen(text);
    long value = 0;
    const auto [rest, error] = std::from_chars(text, end, value);
    if (error != std::errc() || rest != end || value < minimum || value > maximum)
        throw Misuse(variable + ": found '" + text + "', allowed are whole numbers from " +
                     std::to_string(minimum) + " to " + std::to_string(maximum));
    return value;
}

Ranks ranks_of_launcher() {
    require_both();
    for (const Launcher& l : launchers) {
        if (!is_set(l.rank) || !is_set(l.size)) continue;
        Ranks ranks;
        ranks.of = environment_number(l.size, 1, 1, most_processes);
        ranks.mine = environment_number(l.rank, 0, 0, ranks.of - 1);
        ranks.here = environment_number(l.here, ranks.mine, 0, ranks.of - 1);
        ranks.from = std::string(l.rank) + ", " + l.size;
        return ranks;
    }
    return {};
}

}  // namespace wetcurl

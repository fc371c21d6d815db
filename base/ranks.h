// Which of how many processes this one is: what a launcher of parallel programs tells each of them.
// Ours; the variables are those of torchrun, Open MPI, MPICH and Slurm.
#pragma once

#include <string>

namespace wetcurl {

struct Ranks {
    long mine = 0, of = 1;  // 0 ≤ mine < of
    long here = 0;          // among the processes of this host; `mine` where no launcher says it
    std::string from;       // the variables that say so; "": started alone
    bool first() const { return mine == 0; }
    bool alone() const { return of == 1; }
};

// RANK and WORLD_SIZE (torchrun, or by hand), else mpirun's or srun's. Throws Misuse for what is no number or
// out of range.
Ranks ranks_of_launcher();

// A whole number from the environment; Misuse names the variable and what is allowed.
long environment_number(const std::string& variable, long fallback, long minimum, long maximum);

}  // namespace wetcurl

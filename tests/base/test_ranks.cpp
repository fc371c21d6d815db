// What launchers tell their processes.
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>

#include "base/ranks.h"
#include "tests/base/scratch.h"

namespace wetcurl {
namespace {

using testing::expect_error;

// The launchers' variables as given and no others, until the end of its life.
class Environment {
  public:
    explicit Environment(const std::map<std::string, std::string>& given) {
        for (const char* name :
             {"RANK", "WORLD_SIZE", "LOCAL_RANK", "OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE",
              "OMPI_COMM_WORLD_LOCAL_RANK", "PMI_RANK", "PMI_SIZE", "MPI_LOCALRANKID", "SLURM_PROCID",
              "SLURM_STEP_NUM_TASKS", "SLURM_LOCALID"}) {
            if (const char* value = std::getenv(name)) before_[name] = value;
            names_.push_back(name);
            unsetenv(name);
        }
        for (const auto& [name, value] : given) setenv(name.c_str(), value.c_str(), 1);
    }
    ~Environment() {
        for (const auto& name : names_) unsetenv(name.c_str());
        for (const auto& [name, value] : before_) setenv(name.c_str(), value.c_str(), 1);
    }
    Environment(const Environment&) = delete;

  private:
    std::vector<std::string> names_;
    std::map<std::string, std::string> before_;
};

TEST(Ranks, AreThoseOfTheLauncher) {
    const std::map<std::string, std::string> torchrun = {
        {"RANK", "5"}, {"WORLD_SIZE", "8"}, {"LOCAL_RANK", "1"}};
    const std::map<std::string, std::string> open_mpi = {
        {"OMPI_COMM_WORLD_RANK", "5"}, {"OMPI_COMM_WORLD_SIZE", "8"}, {"OMPI_COMM_WORLD_LOCAL_RANK", "1"}};
    const std::map<std::string, std::string> mpich = {
        {"PMI_RANK", "5"}, {"PMI_SIZE", "8"}, {"MPI_LOCALRANKID", "1"}};
    const std::map<std::string, std::string> slurm = {
        {"SLURM_PROCID", "5"}, {"SLURM_STEP_NUM_TASKS", "8"}, {"SLURM_LOCALID", "1"}};
    for (const auto& given : {torchrun, open_mpi, mpich, slurm}) {
        const Environment environment(given);
        const Ranks ranks = ranks_of_launcher();
        EXPECT_EQ(ranks.mine, 5);
        EXPECT_EQ(ranks.of, 8);
        EXPECT_EQ(ranks.here, 1);
        EXPECT_FALSE(ranks.first() || ranks.alone());
        EXPECT_TRUE(given.contains(ranks.from.substr(0, ranks.from.find(',')))) << ranks.from;
    }
}

TEST(Ranks, AProcessWithoutALauncherIsAlone) {
    // A batch script of Slurm knows how many tasks it may start and is none of them.
    for (const auto& given :
         {std::map<std::string, std::string>{}, {{"SLURM_NTASKS", "4"}, {"SLURM_PROCID", "0"}}}) {
        const Environment environment(given);
        const Ranks ranks = ranks_of_launcher();
        EXPECT_TRUE(ranks.first() && ranks.alone());
        EXPECT_EQ(ranks.from, "");
    }
}

TEST(Ranks, ThoseOfTorchrunGoBeforeTheJobThatItRunsIn) {
    const Environment environment(
        {{"RANK", "1"}, {"WORLD_SIZE", "2"}, {"SLURM_PROCID", "3"}, {"SLURM_STEP_NUM_TASKS", "4"}});
    EXPECT_EQ(ranks_of_launcher().mine, 1);
    EXPECT_EQ(ranks_of_launcher().of, 2);
    EXPECT_EQ(ranks_of_launcher().here, 1);  // said by nobody: one host
}

TEST(Ranks, BadOnesAreRefused) {
    auto refused = [](const std::map<std::string, std::string>& given,
                      std::initializer_list<std::string> parts) {
        const Environment environment(given);
        expect_error<Misuse>([] { ranks_of_launcher(); }, parts);
    };
    refused({{"RANK", "2"}, {"WORLD_SIZE", "2"}}, {"RANK", "'2'", "0 to 1"});
    refused({{"RANK", "-1"}, {"WORLD_SIZE", "2"}}, {"RANK", "'-1'"});
    refused({{"RANK", "1x"}, {"WORLD_SIZE", "2"}}, {"RANK", "'1x'"});
    refused({{"RANK", ""}, {"WORLD_SIZE", "2"}}, {"RANK", "''"});
    refused({{"RANK", "0"}, {"WORLD_SIZE", "0"}}, {"WORLD_SIZE", "'0'"});
    refused({{"RANK", "0"}, {"WORLD_SIZE", "99999999999999999999"}}, {"WORLD_SIZE"});
    refused({{"RANK", "0"}, {"WORLD_SIZE", "2"}, {"LOCAL_RANK", "2"}}, {"LOCAL_RANK", "'2'"});
    refused({{"SLURM_PROCID", "a"}, {"SLURM_STEP_NUM_TASKS", "2"}}, {"SLURM_PROCID", "'a'"});
    refused({{"RANK", "1"}}, {"RANK", "without WORLD_SIZE"});
    refused({{"WORLD_SIZE", "2"}}, {"WORLD_SIZE", "without RANK"});
}

}  // namespace
}  // namespace wetcurl

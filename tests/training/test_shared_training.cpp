// One training by several processes of the program, on the CPU: the weights of one, stopped and resumed
// together, and what each says when another one is missing.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "models/model_file.h"
#include "tests/base/scratch.h"
#include "tests/training/make_pairs.h"
#include "training/group.h"
#include "training/loop.h"

namespace wetcurl {
namespace {

namespace fs = std::filesystem;
using testing::Scratch;
using Words = std::vector<std::string>;

// Free a moment ago, as the system hands them out: the next call gives another one.
int free_port() {
    const int s = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    if (bind(s, reinterpret_cast<sockaddr*>(&address), size) != 0 ||
        getsockname(s, reinterpret_cast<sockaddr*>(&address), &size) != 0)
        throw Error("no port is free for a test");
    close(s);
    return ntohs(address.sin_port);
}

// The program as one process of a launcher's. What it says goes to a file.
class Process {
  public:
    Process(const Words& words, const std::map<std::string, std::string>& environment, const std::string& log)
        : log_(log), id_(fork()) {
        if (id_ != 0) return;
        alarm(60);  // one that hangs ends too
        for (const auto& [name, value] : environment) setenv(name.c_str(), value.c_str(), 1);
        if (!std::freopen(log.c_str(), "w", stderr) || !std::freopen("/dev/null", "w", stdout)) _exit(99);
        std::vector<char*> arguments;
        for (const auto& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
        arguments.push_back(nullptr);
        execv(arguments[0], arguments.data());
        _exit(99);
    }
    ~Process() {
        if (running()) kill(id_, SIGKILL), wait();
    }
    Process(const Process&) = delete;

    void signal(int number) const { kill(id_, number); }
    bool running() {
        if (!ended_ && waitpid(id_, &status_, WNOHANG) == id_) ended_ = true;
        return !ended_;
    }
    // Its exit status, or minus the signal that ended it.
    int wait() {
        if (!ended_) waitpid(id_, &status_, 0);
        ended_ = true;
        return WIFEXITED(status_) ? WEXITSTATUS(status_) : -WTERMSIG(status_);
    }
    std::string said() const { return testing::bytes_of(log_); }

  private:
    std::string log_;
    pid_t id_;
    int status_ = 0;
    bool ended_ = false;
};

void expect_said(const Process& process, const std::vector<std::string>& parts) {
    for (const auto& part : parts) EXPECT_NE(process.said().find(part), std::string::npos) << process.said();
}

class SharedTraining : public ::testing::Test {
  protected:
    void SetUp() override {
        if (!can_share(torch::kCPU)) GTEST_SKIP() << "SKIP: this build is without Gloo (libgloo-dev)";
    }
    // `recipe`: assignments.
    Words words(const std::string& pairs, const std::string& model, const Words& recipe) const {
        const bool adhesion = pairs.find("adhesion") != std::string::npos;
        Words out = {WETCURL_PROGRAM, "train", adhesion ? "adhesion" : "sr", pairs, "-o", model, "--quiet",
                     "--threads",     "1"};
        for (const auto& assignment : recipe) out.insert(out.end(), {"--set", assignment});
        return out;
    }
    std::unique_ptr<Process> start(int rank, int port, const Words& words, int patience = 20) const {
        return std::make_unique<Process>(
            words,
            std::map<std::string, std::string>{{"RANK", std::to_string(rank)},
                                               {"WORLD_SIZE", "2"},
                                               {"MASTER_PORT", std::to_string(port)},
                                               {"WETCURL_RENDEZVOUS_SECONDS", std::to_string(patience)}},
            scratch.path("log" + std::to_string(rank)));
    }
    // Here, which is quicker.
    static void train_alone(const std::string& pairs, const std::string& model, const Words& recipe) {
        TrainRequest request;
        request.kind = pairs.find("adhesion") != std::string::npos ? "adhesion" : "sr";
        request.pairs = {pairs}, request.output = model, request.set = recipe, request.threads = 1;
        train(request);
    }
    void train_by_two(const Words& words) const {
        const int port = free_port();
        const auto first = start(0, port, words), other = start(1, port, words);
        ASSERT_EQ(first->wait(), 0) << first->said();
        ASSERT_EQ(other->wait(), 0) << other->said();
    }
    static Tensor weights(const std::string& path) {
        std::vector<Tensor> parts;
        for (const auto& p : load_model(path).second->parameters()) parts.push_back(p.detach().reshape(-1));
        return torch::cat(parts);
    }
    static std::vector<nlohmann::json> lines(const std::string& model) {
        std::vector<nlohmann::json> out;
        std::ifstream file(model + ".jsonl");
        for (std::string line; std::getline(file, line);) {
            out.push_back(nlohmann::json::parse(line));
            out.back().erase("seconds");
        }
        return out;
    }
    // In the log of a training, so that it is under way.
    static void wait_for_a_line(const std::string& model, Process& process) {
        std::error_code none;
        auto there = [&] { return long(fs::file_size(model + ".jsonl", none)) > 0; };
        while (!there() && process.running()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    // So many epochs that a signal comes long before the last.
    Words long_words() const {
        return words(testing::make_strand_pairs(scratch.path("pairs.h5")), scratch.path("model.h5"),
                     {"epochs=60", "width=0.1", "batch=2"});
    }
    Scratch scratch;
};

TEST_F(SharedTraining, OfTwoProcessesGivesTheWeightsOfOne) {
    // Batches that do not divide by two, and a last one in which a process has none.
    const Words strand = {"width=0.1", "batch=3", "schedule=constant", "validation=0.34"},
                adhesion = {"batch=1023", "epoch_samples=2048"},
                root = {"width=0.125", "patch=16", "batch=3", "architecture=recursive_residual"};
    for (const auto& [pairs, recipe] :
         {std::pair{testing::make_strand_pairs(scratch.path("strand.h5")), strand},
          {testing::make_root_pairs(scratch.path("root.h5")), root},
          {testing::make_adhesion_pairs(scratch.path("adhesion.h5")), adhesion}}) {
        Words short_one = recipe,
              all = recipe;  // the weights after the last epoch: only there is a validation
        short_one.push_back("epochs=1"), all.insert(all.end(), {"epochs=4", "validate_every=4"});
        const std::string one = pairs + ".one", two = pairs + ".two", less = pairs + ".less";
        train_alone(pairs, one, all);
        train_alone(pairs, less, short_one);
        train_by_two(words(pairs, two, all));
        // They differ by the order of sums in single precision, which Adam makes larger where a gradient is
        // small; against the way that three epochs go.
        const double way = (weights(one) - weights(less)).norm().item<double>();
        ASSERT_GT(way, 1e-2);
        const double apart = (weights(one) - weights(two)).norm().item<double>();
        EXPECT_LT(apart, 1e-4 * way) << pairs;
        const auto a = lines(one), b = lines(two);
        ASSERT_EQ(a.size(), 4u);
        ASSERT_EQ(b.size(), 4u);
        for (size_t k = 0; k < 4; ++k)
            for (const auto& [key, value] : a[k].items())
                EXPECT_NEAR(value.get<double>(), b[k][key].get<double>(),
                            1e-4 * std::abs(value.get<double>()))
                    << pairs << " " << key;
    }
}

TEST_F(SharedTraining, StoppedAtOneProcessAndResumedGivesTheBitsOfOneGo) {
    const Words whole = long_words();
    train_by_two(whole);
    Words parts = whole;
    const std::string model = parts[5] = scratch.path("parts.h5");
    const int port = free_port();
    const auto first = start(0, port, parts), other = start(1, port, parts);
    wait_for_a_line(model, *first);
    other->signal(SIGINT);
    EXPECT_EQ(other->wait(), 130) << other->said();
    EXPECT_EQ(first->wait(), 130) << first->said();
    EXPECT_NE(first->said().find("--resume goes on"), std::string::npos) << first->said();
    EXPECT_TRUE(fs::exists(model + ".checkpoint"));
    EXPECT_FALSE(fs::exists(model));
    parts.push_back("--resume");
    train_by_two(parts);
    EXPECT_FALSE(fs::exists(model + ".checkpoint"));
    EXPECT_TRUE(torch::equal(weights(whole[5]), weights(model)));
    EXPECT_EQ(lines(whole[5]), lines(model));
}

TEST_F(SharedTraining, EndsWhereOneProcessIsGone) {
    const Words both = long_words();
    const int port = free_port();
    const auto first = start(0, port, both), other = start(1, port, both);
    wait_for_a_line(both[5], *first);
    other->signal(SIGKILL);
    EXPECT_EQ(other->wait(), -SIGKILL);
    EXPECT_EQ(first->wait(), 1);
    EXPECT_NE(first->said().find("rank 0 of 2 (RANK, WORLD_SIZE): lost another one"), std::string::npos)
        << first->said();
}

TEST_F(SharedTraining, NamesTheProcessThatDidNotCome) {
    const Words both = long_words();
    const int port = free_port();
    const auto first = start(0, port, both, 1);
    EXPECT_EQ(first->wait(), 1);
    expect_said(*first, {"rank 0 of 2", "127.0.0.1:" + std::to_string(port), "waited 1 s for rank 1,"});
    const auto other = start(1, port, both, 1);
    EXPECT_EQ(other->wait(), 1);
    expect_said(*other, {"rank 1 of 2", "MASTER_ADDR", "MASTER_PORT"});
    EXPECT_FALSE(fs::exists(both[5] + ".jsonl"));
}

TEST_F(SharedTraining, RefusesProcessesWithOtherWork) {
    const Words both = long_words();
    Words seeded = both;
    seeded.insert(seeded.end(), {"--seed", "7"});
    const int port = free_port();
    const auto first = start(0, port, both), other = start(1, port, seeded);
    EXPECT_EQ(first->wait(), 2);
    EXPECT_NE(other->wait(), 0);
    expect_said(*first, {"rank 1 would train", "seed = 7", "seed = 0"});
    EXPECT_FALSE(fs::exists(both[5] + ".jsonl"));
}

TEST_F(SharedTraining, RefusesABadRankOrPort) {
    const Words both = long_words();
    const auto third = start(2, free_port(), both), first = start(0, 65536, both);
    EXPECT_EQ(third->wait(), 2);
    EXPECT_NE(third->said().find("RANK: found '2', allowed are whole numbers from 0 to 1"), std::string::npos)
        << third->said();
    EXPECT_EQ(first->wait(), 2);
    EXPECT_NE(first->said().find("MASTER_PORT: found '65536', allowed"), std::string::npos) << first->said();
}

}  // namespace
}  // namespace wetcurl

// Runs that are killed, cut, looked at while they are written, or written to a full disk: what is read is
// whole.
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <thread>

#include "small_run.h"

namespace wetcurl {
namespace {

using namespace testing;

void expect_frames_of(const RunReader& run) {
    for (int f = 0; f < run.frames(); ++f) {
        const RunFrame found = run.frame(f), wanted = small_frame(f);
        ASSERT_TRUE(same_points(found.positions, wanted.positions)) << f;
        ASSERT_TRUE(same_points(found.displayed, wanted.displayed)) << f;
        ASSERT_EQ(found.energy, wanted.energy) << f;
        ASSERT_EQ(found.contact, wanted.contact) << f;
        ASSERT_EQ(found.saturation, wanted.saturation) << f;
        ASSERT_EQ(found.water, wanted.water) << f;
        ASSERT_EQ(found.seconds, wanted.seconds) << f;
        ASSERT_EQ(norm(found.head.translation - wanted.head.translation), 0) << f;
    }
}

// Another process that appends frames `first`, ... < `end` to the run at `path`, and writes the number of
// each that is appended to a pipe.
class Writer {
  public:
    Writer(const std::string& path, int first, int end, int pause_us = 0) {
        int ends[2];
        if (pipe(ends) != 0) throw Error("no pipe");
        process_ = fork();
        if (process_ == 0) {
            int status = 0;
            try {
                OutputFile place(path, true);
                RunWriter run = first > 0 ? RunWriter(std::move(place), small_header(), first)
                                          : RunWriter(std::move(place), small_header());
                for (int f = first; f < end; ++f) {
                    run.append(small_frame(f));
                    if (write(ends[1], &f, sizeof f) != sizeof f) status = 1;
                    if (pause_us) usleep(unsigned(pause_us));
                }
                run.commit();
            } catch (const std::exception& e) {
                status = 2;
            }
            _exit(status);
        }
        close(ends[1]);
        said_ = ends[0];
        fcntl(said_, F_SETFL, O_NONBLOCK);
    }
    ~Writer() {
        if (process_ > 0) kill_it();
        close(said_);
    }
    // The last frame that it has appended, -1 for none.
    int appended() {
        for (int f; read(said_, &f, sizeof f) == sizeof f;) last_ = f;
        return last_;
    }
    // Until it has appended that frame. Throws Error where it ends before.
    void wait_for(int frame) {
        while (appended() < frame) {
            siginfo_t ended{};
            const bool asked = waitid(P_PID, id_t(process_), &ended, WEXITED | WNOHANG | WNOWAIT) == 0;
            if (asked && ended.si_pid == process_ && appended() < frame)
                throw Error("the writer ended before frame " + std::to_string(frame));
            usleep(50);
        }
    }
    void kill_it() {
        kill(process_, SIGKILL);
        wait();
    }
    int wait() {
        int status = 0;
        waitpid(std::exchange(process_, -1), &status, 0);
        return status;
    }

  private:
    pid_t process_ = -1;
    int said_ = -1, last_ = -1;
};

TEST(BrokenRun, has_every_frame_that_was_appended_before_one_of_200_kills) {
    const Scratch scratch;
    const std::string path = scratch.path("run.h5");
    std::mt19937 random(7);
    int frames = 0, in_the_middle = 0;
    for (int k = 0; k < 200; ++k) {
        if (frames > 80) frames = 0;  // another run
        Writer writer(path, frames, 1'000'000);
        writer.wait_for(frames + int(random() % 4));
        usleep(unsigned(random() % 1000));
        writer.kill_it();
        const int appended = writer.appended() + 1;
        const RunReader run(path + ".partial");
        ASSERT_GE(run.frames(), std::max(frames, appended)) << k;
        in_the_middle += run.written() == H5Reader::Written::broken_off;
        expect_frames_of(run);
        frames = run.frames();
    }
    EXPECT_GT(in_the_middle, 100);
    Writer writer(path, frames, frames + 3);
    ASSERT_EQ(writer.wait(), 0);
    const RunReader run(path);
    ASSERT_EQ(run.frames(), frames + 3);
    expect_frames_of(run);
}

TEST(BrokenRun, is_read_while_another_process_writes_it) {
    const Scratch scratch;
    const std::string path = scratch.path("run.h5");
    Writer writer(path, 0, 1'000'000, 1000);
    writer.wait_for(1);
    int readings = 0, before = 0;
    for (; before < 150 && readings < 10'000; ++readings) {
        const int appended = writer.appended() + 1;
        const RunReader run(path + ".partial");
        ASSERT_EQ(run.written(), H5Reader::Written::under_way);
        EXPECT_NE(run.writer().find("process "), std::string::npos) << run.writer();
        ASSERT_GE(run.frames(), appended);
        ASSERT_GE(run.frames(), before);
        expect_frames_of(run);
        before = run.frames();
    }
    EXPECT_GT(readings, 2);
}

TEST(BrokenRun, that_gets_its_name_while_it_is_read_is_read_under_it) {
    const Scratch scratch;
    const std::string path = scratch.path("run.h5");
    for (int k = 0; k < 5; ++k) {
        Writer writer(path, 0, 20 + k, 200);
        writer.wait_for(1);
        for (int frames = 0; frames < 20 + k;) {
            const RunReader run(path + ".partial");
            expect_frames_of(run);
            frames = run.frames();
        }
        EXPECT_EQ(writer.wait(), 0);
        EXPECT_EQ(RunReader(path).written(), H5Reader::Written::whole);
    }
}

// A file that was cut is read up to the last frame that lies in it, or is an error that says so; never a
// frame that is not whole.
TEST(BrokenRun, cut_at_any_byte_holds_whole_frames_alone) {
    const Scratch scratch;
    const std::string path = scratch.path("run.h5"), partial = path + ".partial";
    {
        Writer writer(path, 0, 1'000'000);
        writer.wait_for(40);
        writer.kill_it();
    }
    const std::string whole = bytes_of(partial);
    const int frames = RunReader(partial).frames();
    int read = 0, lost = 0;
    for (size_t cut = 0; cut < whole.size(); cut += 1 + whole.size() / 400) {
        scratch.file("cut.h5.partial", whole.substr(0, whole.size() - cut));
        try {
            const RunReader run(scratch.path("cut.h5.partial"));
            EXPECT_LE(run.frames(), frames);
            expect_frames_of(run);
            ++read;
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()).find("cut.h5.partial"), std::string::npos) << e.what();
            lost += std::string(e.what()).find("whose end is missing") != std::string::npos;
        }
    }
    EXPECT_GT(read, 0);
    EXPECT_GT(lost, 2);
}

TEST(BrokenRun, on_a_full_disk_keeps_its_frames_and_goes_on_when_there_is_room) {
    const Scratch scratch;
    const std::string path = scratch.path("run.h5");
    const pid_t process = fork();
    if (process == 0) {
        signal(SIGXFSZ, SIG_IGN);
        const rlimit most{400'000, 400'000};
        setrlimit(RLIMIT_FSIZE, &most);
        int status = 1;
        try {
            RunWriter run(path, small_header(), false);
            for (int f = 0; f < 10'000; ++f) run.append(small_frame(f));
        } catch (const Error& e) {
            status = std::string(e.what()).find("disk full?") == std::string::npos ? 2 : 0;
        }
        _exit(status);
    }
    int status = 1;
    waitpid(process, &status, 0);
    EXPECT_EQ(status, 0);
    int frames = 0;
    {
        const RunReader run(path + ".partial");
        frames = run.frames();
        EXPECT_GT(frames, 5);
        expect_frames_of(run);
    }
    Writer writer(path, frames, frames + 20);
    ASSERT_EQ(writer.wait(), 0);
    EXPECT_EQ(RunReader(path).frames(), frames + 20);
    expect_frames_of(RunReader(path));
}

}  // namespace
}  // namespace wetcurl

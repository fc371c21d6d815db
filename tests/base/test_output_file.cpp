// What holds for every file that the program writes: one writer, a name only when whole, links followed,
// nothing lost of what another process writes or left. flock(2) tells two openings of one process apart as it
// does two processes, so that a second writer stands for a second process except where a test forks one.
#include <fcntl.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <future>
#include <thread>

#include "base/hdf5.h"
#include "base/output_file.h"
#include "scratch.h"

namespace wetcurl {
namespace {

namespace fs = std::filesystem;
using testing::bytes_of;
using testing::expect_error;
using testing::Scratch;

// What `act` fails with in a process of its own; "" where it does not fail.
std::string failure_in_another_process(const std::function<void()>& act) {
    int ends[2];
    if (pipe(ends) != 0) return "no pipe";
    const pid_t child = fork();
    if (child == 0) {
        std::string said;
        try {
            act();
        } catch (const std::exception& e) {
            said = e.what();
        }
        const bool sent = write(ends[1], said.data(), said.size()) == ssize_t(said.size());
        _exit(sent ? 0 : 1);
    }
    close(ends[1]);
    std::string said;
    char part[4096];
    for (ssize_t n; (n = read(ends[0], part, sizeof part)) > 0;) said.append(part, size_t(n));
    close(ends[0]);
    int status = 1;
    waitpid(child, &status, 0);
    return status == 0 ? said : "the other process ended with " + std::to_string(status);
}

void expect_parts(const std::string& text, std::initializer_list<std::string> parts) {
    for (const auto& part : parts)
        EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
}

std::vector<std::string> names_in(const Scratch& scratch) {
    std::vector<std::string> out;
    for (const auto& entry : fs::directory_iterator(scratch.path())) out.push_back(entry.path().filename());
    std::sort(out.begin(), out.end());
    return out;
}
using Names = std::vector<std::string>;

void write_whole(const std::string& path, const std::string& text, bool overwrite = true) {
    OutputFile file(path, overwrite);
    file.write(text);
    file.commit();
}

TEST(OutputFile, a_second_process_is_refused_and_says_who_writes_it) {
    const Scratch scratch;
    const std::string path = scratch.path("a.txt");
    OutputFile first(path, false);
    first.write("begun, ");
    for (bool overwrite : {false, true})
        expect_parts(failure_in_another_process([&] { write_whole(path, "second", overwrite); }),
                     {path, "process " + std::to_string(getpid()) + " writes it", "one process at a time",
                      "wait until it ends"});
    first.write("ended");
    first.commit();
    EXPECT_EQ(bytes_of(path), "begun, ended");
    EXPECT_EQ(names_in(scratch), Names{"a.txt"});
}

TEST(OutputFile, a_second_writer_of_an_HDF5_file_is_refused_and_the_first_one_is_whole) {
    const Scratch scratch;
    const std::string path = scratch.path("a.h5"), alone = scratch.path("alone.h5");
    const std::vector<float> row{1, 2, 3};
    auto fill = [&](H5Writer& file) {
        for (int k = 0; k < 5; ++k) file.append("rows", row.data(), {3});
        file.flush();
    };
    H5Writer first(path, "wetcurl test", 1, true), single(alone, "wetcurl test", 1, true);
    fill(first), fill(single);
    expect_parts(failure_in_another_process([&] { H5Writer(path, "wetcurl test", 1, true); }),
                 {path, "process " + std::to_string(getpid()) + " writes it"});
    expect_parts(failure_in_another_process([&] { H5Reader(path + ".partial", "wetcurl test", 1); }),
                 {path + ".partial", "process " + std::to_string(getpid()) + " writes it", "wait"});
    fill(first), fill(single);
    first.commit(), single.commit();
    EXPECT_EQ(H5Reader(path, "wetcurl test", 1).shape("rows"), (std::vector<size_t>{10, 3}));
    EXPECT_EQ(bytes_of(path), bytes_of(alone));
}

TEST(OutputFile, what_a_killed_process_left_is_no_obstacle_and_stays_until_the_first_byte) {
    const Scratch scratch;
    const std::string path = scratch.path("a.txt");
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const pid_t child = fork();
    if (child == 0) {
        OutputFile file(path, false);
        file.write("half");
        if (write(ends[1], "x", 1) == 1) pause();
        _exit(1);
    }
    char ready = 0;
    ASSERT_EQ(read(ends[0], &ready, 1), 1);
    expect_error([&] { OutputFile(path, false); }, {"process " + std::to_string(child) + " writes it"});
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    close(ends[0]), close(ends[1]);

    { const OutputFile unused(path, false); }
    EXPECT_EQ(bytes_of(path + ".partial"), "half");
    write_whole(path, "all", false);
    EXPECT_EQ(bytes_of(path), "all");
    EXPECT_FALSE(fs::exists(path + ".partial"));
}

// Whoever waited wakes up with a lock on the file that has just been finished, which is no longer the partial
// one.
TEST(OutputFile, one_that_waited_begins_a_file_of_its_own) {
    const Scratch scratch;
    const std::string path = scratch.path("a.txt");
    auto first = std::make_unique<OutputFile>(path, true);
    first->write("first");
    auto second = std::async(std::launch::async, [&] {
        return std::make_unique<OutputFile>(path, true, "", LockedFile::Others::wait);
    });
    // The kernel's list marks who waits by an arrow.
    const std::string inode = [&] {
        struct stat file {};
        stat((path + ".partial").c_str(), &file);
        return ":" + std::to_string(file.st_ino) + " ";
    }();
    auto waits = [&] {
        std::ifstream locks("/proc/locks");
        for (std::string line; std::getline(locks, line);)
            if (line.find("->") != std::string::npos && line.find(inode) != std::string::npos) return true;
        return false;
    };
    while (!waits()) std::this_thread::yield();
    first->commit();
    const auto waited = second.get();
    EXPECT_EQ(bytes_of(path), "first");
    waited->write("second");
    EXPECT_EQ(bytes_of(path), "first");
    waited->commit();
    EXPECT_EQ(bytes_of(path), "second");
    EXPECT_EQ(names_in(scratch), Names{"a.txt"});
}

TEST(OutputFile, links_are_followed_and_stay) {
    const Scratch scratch;
    fs::create_directory(scratch.path("there"));
    const std::string target = scratch.path("there/real.txt"), link = scratch.path("link.txt"),
                      second = scratch.path("second.txt");
    fs::create_symlink("there/real.txt", link);  // from the link's own folder
    fs::create_symlink(link, second);
    for (const std::string text : {"into a name that is free", "over what is there"}) {
        {
            OutputFile file(second, text[0] == 'o');
            file.write(text);
            EXPECT_TRUE(fs::exists(target + ".partial"));
            EXPECT_EQ(fs::canonical(partial_of(link)), fs::canonical(target + ".partial"));
            expect_error([&] { OutputFile(target, true); }, {target, "writes it"});
            file.commit();
        }
        EXPECT_EQ(bytes_of(target), text);
        EXPECT_TRUE(fs::is_symlink(link) && fs::is_symlink(second));
    }
    expect_error([&] { OutputFile(link, false); }, {link, "--overwrite"});
    fs::create_symlink(scratch.path("b"), scratch.path("a"));
    fs::create_symlink(scratch.path("a"), scratch.path("b"));
    expect_error([&] { OutputFile(scratch.path("a"), true); }, {scratch.path("a"), "in a circle"});
}

TEST(OutputFile, what_is_no_file_is_refused_and_stays) {
    const Scratch scratch;
    const std::string pipe = scratch.path("pipe"), folder = scratch.path("folder"),
                      link = scratch.path("link"), plug = scratch.path("socket");
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    fs::create_directory(folder);
    fs::create_symlink(pipe, link);
    const int socket_of = socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    plug.copy(address.sun_path, sizeof address.sun_path - 1);
    ASSERT_EQ(bind(socket_of, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    const Names before = names_in(scratch);
    for (const auto& [path, found] : {std::pair<std::string, std::string>{pipe, "a pipe"},
                                      {link, "a pipe"},
                                      {plug, "a socket"},
                                      {folder, "is a folder"},
                                      {scratch.path("new/"), "a file name is needed"},
                                      {"/dev/null", "a device"},
                                      {"/dev/stdout", "allowed is the name of a file"}})
        expect_error([&, path = path] { OutputFile(path, true); }, {path, found});
    expect_error<Misuse>([&] { OutputFile("", true); }, {"empty file name"});
    close(socket_of);
    EXPECT_EQ(names_in(scratch), before);
    EXPECT_TRUE(fs::is_fifo(pipe) && fs::is_symlink(link) && fs::is_socket(plug));
}

TEST(OutputFile, a_partial_name_that_is_no_file_is_refused_and_what_it_points_to_stays) {
    const Scratch scratch;
    const std::string other = scratch.file("other.txt", "mine"), path = scratch.path("a.txt");
    fs::create_symlink(other, path + ".partial");
    expect_error([&] { write_whole(path, "new"); }, {path, ".partial is a symbolic link", "remove it"});
    EXPECT_EQ(bytes_of(other), "mine");
    fs::remove(path + ".partial");
    ASSERT_EQ(mkfifo((path + ".partial").c_str(), 0600), 0);
    expect_error([&] { write_whole(path, "new"); }, {path, ".partial is no regular file", "remove it"});
    EXPECT_FALSE(fs::exists(path));
}

TEST(OutputFile, refusals_touch_nothing_and_what_is_given_up_goes) {
    const Scratch scratch;
    const std::string path = scratch.file("a.txt", "mine"), left = scratch.file("a.txt.partial", "left");
    expect_error([&] { OutputFile(path, false); }, {path, "there already", "--overwrite"});
    EXPECT_EQ(bytes_of(path) + bytes_of(left), "mineleft");
    {
        OutputFile given_up(path, true);
        given_up.write("x");
    }
    EXPECT_EQ(names_in(scratch), Names{"a.txt"});
    { const OutputFile empty(path, true); }
    EXPECT_EQ(names_in(scratch), Names{"a.txt"});
    {
        OutputFile kept(path, true);
        kept.write("kept");
        kept.keep();
    }
    EXPECT_EQ(bytes_of(path) + bytes_of(left), "minekept");
}

TEST(OutputFile, a_file_that_comes_to_be_there_meanwhile_is_not_replaced) {
    const Scratch scratch;
    const std::string path = scratch.path("a.txt");
    OutputFile file(path, false);
    file.write("new");
    scratch.file("a.txt", "mine");
    expect_error([&] { file.commit(); }, {path, "meanwhile", path + ".partial"});
    EXPECT_EQ(bytes_of(path), "mine");
    EXPECT_EQ(bytes_of(path + ".partial"), "new");
}

TEST(OutputFile, the_ending_stays_last_where_it_says_what_the_file_is) {
    const Scratch scratch;
    EXPECT_EQ(OutputFile(scratch.path("a.mp4"), true, ".mp4").partial(), scratch.path("a.partial.mp4"));
    fs::create_symlink("real", scratch.path("b.mp4"));
    EXPECT_EQ(OutputFile(scratch.path("b.mp4"), true, ".mp4").partial(), scratch.path("real.partial.mp4"));
}

TEST(OutputFile, several_threads_that_write_one_name_leave_one_of_the_texts_whole) {
    const Scratch scratch;
    const std::string path = scratch.path("a.txt");
    std::vector<std::thread> writers;
    for (char c : {'a', 'b', 'c', 'd'})
        writers.emplace_back([&, c] {
            for (int k = 0; k < 50; ++k) {
                OutputFile file(path, true, "", LockedFile::Others::wait);
                for (int part = 0; part < 10; ++part) file.write(std::string(100, c));
                file.commit();
                const std::string text = bytes_of(path);  // of any of them
                EXPECT_EQ(text, std::string(1000, text.empty() ? '?' : text[0]));
            }
        });
    for (auto& writer : writers) writer.join();
    EXPECT_EQ(names_in(scratch), Names{"a.txt"});
}

TEST(Streams, take_text_as_it_comes) {
    const Scratch scratch;
    EXPECT_TRUE(is_stream("/dev/null") && is_stream("/dev/stdout"));
    EXPECT_FALSE(is_stream("") || is_stream(scratch.path()) || is_stream(scratch.path("none")) ||
                 is_stream(scratch.file("file", "")));
    write_to_stream("/dev/null", "gone");
    expect_error([&] { write_to_stream("/dev/full", "text"); },
                 {"/dev/full", "cannot be written", "No space"});

    const std::string pipe = scratch.path("pipe");
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    EXPECT_TRUE(is_stream(pipe));
    auto read = std::async(std::launch::async, [&] { return bytes_of(pipe); });
    write_to_stream(pipe, "through the pipe");
    EXPECT_EQ(read.get(), "through the pipe");

    // A descriptor is written where it stands, though it leads to a file.
    const std::string file = scratch.file("out", "");
    const int descriptor = open(file.c_str(), O_WRONLY);
    const std::string name = "/dev/fd/" + std::to_string(descriptor);
    ASSERT_EQ(write(descriptor, "before, ", 8), 8);
    EXPECT_TRUE(is_stream(name));
    write_to_stream(name, "between, ");
    ASSERT_EQ(write(descriptor, "after", 5), 5);
    close(descriptor);
    EXPECT_EQ(bytes_of(file), "before, between, after");
}

TEST(OutputFolder, is_filled_by_one_process_or_by_those_that_share) {
    using Kind = LockedFile::Kind;
    const Scratch scratch;
    const std::string path = scratch.path("deep/folder");
    const std::string me = "process " + std::to_string(getpid());
    auto other = [&](Kind kind) {
        return failure_in_another_process([&, kind] { OutputFolder folder(path, kind); });
    };
    {
        const OutputFolder alone(path);
        for (Kind kind : {Kind::alone, Kind::shared}) expect_parts(other(kind), {path, me + " writes it"});
    }
    {
        const OutputFolder shared(path, Kind::shared);
        EXPECT_EQ(other(Kind::shared), "");
        expect_parts(other(Kind::alone), {path, me});
        EXPECT_TRUE(fs::exists(path + "/.lock"));  // the other one that shared did not remove it
    }
    EXPECT_TRUE(fs::is_directory(path) && fs::is_empty(path));
    EXPECT_EQ(other(Kind::alone), "");
}

}  // namespace
}  // namespace wetcurl

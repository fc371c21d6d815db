// Files that the program writes.
#include "base/output_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <thread>
#include <utility>

#include "base/log.h"

namespace wetcurl {

namespace fs = std::filesystem;

namespace {

std::string reason() { return std::strerror(errno); }

// N of a path /proc/.../fd/N, which looks like a symbolic link and is an open descriptor of a process.
struct Descriptor {
    bool own;  // of this process
    int number;
};
std::optional<Descriptor> descriptor_at(const fs::path& path) {
    std::error_code error;
    const std::string folder = fs::canonical(path.parent_path(), error).string();
    if (error || !folder.starts_with("/proc/") || !folder.ends_with("/fd")) return std::nullopt;
    const std::string name = path.filename().string();
    int number = 0;
    const auto [rest, bad] = std::from_chars(name.data(), name.data() + name.size(), number);
    if (bad != std::errc() || rest != name.data() + name.size()) return std::nullopt;
    return Descriptor{folder.starts_with("/proc/" + std::to_string(getpid()) + "/"), number};
}

// Follows symbolic links up to a file, a name that is free, or a descriptor.
fs::path followed(const std::string& path) {
    constexpr int most = 40;  // as Linux itself
    fs::path at = path;
    for (int links = 0; links < most; ++links) {
        std::error_code error;
        if (descriptor_at(at)) return at;
        const fs::path to = fs::read_symlink(at, error);
        if (error) return at;
        at = to.is_absolute() ? to : at.parent_path() / to;
    }
    throw Error(path + ": found symbolic links that lead in a circle, allowed is a file name");
}

bool is_stream_type(fs::file_type type) {
    return type == fs::file_type::character || type == fs::file_type::block || type == fs::file_type::fifo ||
           type == fs::file_type::socket;
}
std::string word_for(fs::file_type type) {
    if (type == fs::file_type::fifo) return "a pipe";
    if (type == fs::file_type::socket) return "a socket";
    if (type == fs::file_type::character || type == fs::file_type::block) return "a device";
    return "an open descriptor";
}

void write_all(int descriptor, const std::string& path, const char* bytes, size_t count) {
    while (count > 0) {
        const ssize_t written = ::write(descriptor, bytes, count);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) throw Error(path + ": cannot be written: " + reason());
        bytes += written, count -= size_t(written);
    }
}

bool same_inode(const struct stat& a, const struct stat& b) {
    return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

// The process that holds a lock of flock(2) on the file, and whether it may write: from the kernel's list.
// None where that does not say, or names one that has ended and left the file open to another.
struct Holder {
    int process;
    bool writes;
};
std::optional<Holder> holder_of(int descriptor) {
    struct stat file;
    if (fstat(descriptor, &file) != 0) return std::nullopt;
    std::ifstream list("/proc/locks");
    for (std::string line; std::getline(list, line);) {
        char kind[16] = "";
        int process = 0;
        unsigned major_number = 0, minor_number = 0;
        unsigned long inode = 0;
        if (std::sscanf(line.c_str(), "%*d: FLOCK ADVISORY %15s %d %x:%x:%lu", kind, &process, &major_number,
                        &minor_number, &inode) == 5 &&
            inode == file.st_ino && major_number == major(file.st_dev) &&
            minor_number == minor(file.st_dev) && process > 0 && (kill(process, 0) == 0 || errno == EPERM))
            return Holder{process, std::strcmp(kind, "WRITE") == 0};
    }
    return std::nullopt;
}

std::string words_for(const std::optional<Holder>& holder) {
    if (!holder) return "another process";
    if (holder->process == getpid()) return "this command itself";
    return "process " + std::to_string(holder->process);
}

[[noreturn]] void fail_locked(const std::string& named, const std::string& path, int descriptor) {
    const auto holder = holder_of(descriptor);
    if (holder && !holder->writes && path.ends_with(".partial"))
        throw Error(named + ": found that " + words_for(holder) + " reads " + path +
                    ", which is to be replaced; wait until it ends, or write elsewhere");
    throw Error(named + ": found that " + words_for(holder) +
                " writes it, allowed is one process at a time; wait until it ends, or write elsewhere");
}

// The file system says that it has no locks, not that another process holds one.
bool no_locks_here(int error) {
    return error == ENOLCK || error == ENOSYS || error == EOPNOTSUPP || error == EINVAL;
}

}  // namespace

std::string target_of(const std::string& path) { return followed(path).string(); }

std::string partial_of(const std::string& path) { return target_of(path) + ".partial"; }

bool is_stream(const std::string& path) {
    if (path.empty()) return false;
    const fs::path at = followed(path);
    std::error_code error;
    return descriptor_at(at) || is_stream_type(fs::status(at, error).type());
}

void write_to_stream(const std::string& path, const std::string& text) {
    // A descriptor of this process is written where it stands: opened anew it would begin at its file's
    // start.
    if (const auto own = descriptor_at(followed(path)); own && own->own) {
        std::fflush(stdout);
        return write_all(own->number, path, text.data(), text.size());
    }
    const int descriptor = open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
    if (descriptor < 0) throw Error(path + ": cannot be written: " + reason());
    try {
        write_all(descriptor, path, text.data(), text.size());
    } catch (...) {
        close(descriptor);
        throw;
    }
    if (close(descriptor) != 0) throw Error(path + ": cannot be written: " + reason());
}

void require_place(const std::string& path, bool overwrite) {
    if (path.empty()) throw Misuse("output: found an empty file name");
    const fs::path target = followed(path);
    std::error_code error;
    const fs::file_type type = fs::status(target, error).type();
    if (type == fs::file_type::directory || target.filename().empty())
        throw Error(path + ": is a folder, a file name is needed");
    if (descriptor_at(target) || is_stream_type(type))
        throw Error(
            path + ": found " + word_for(type) +
            ", allowed is the name of a file, which is written beside its name and renamed when whole");
    if (type != fs::file_type::not_found && type != fs::file_type::none && !overwrite)
        throw Error(path + ": is there already; --overwrite replaces it");
}

void make_folder_of(const std::string& path) {
    const fs::path folder = fs::path(path).parent_path();
    std::error_code error;
    if (!folder.empty()) fs::create_directories(folder, error);
    if (error) throw Error(path + ": its folder cannot be made: " + error.message());
}

LockedFile::LockedFile(const std::string& path, const std::string& named, Kind kind, Others others)
    : path_(path), named_(named) {
    constexpr int most = 1000;  // renamings just before the lock was had
    for (int k = 0; k < most; ++k) {
        // A link or a pipe that lies there is not what this program left; a pipe must not make it wait.
        descriptor_ =
            open(path.c_str(), O_RDWR | O_APPEND | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
        if (descriptor_ < 0 && errno == ELOOP)
            throw Error(named + ": cannot be written: " + path + " is a symbolic link; remove it");
        if (descriptor_ < 0) throw Error(named + ": cannot be written: " + path + ": " + reason());
        struct stat opened;
        if (fstat(descriptor_, &opened) != 0 || !S_ISREG(opened.st_mode)) {
            close(descriptor_);
            throw Error(named + ": cannot be written: " + path + " is no regular file; remove it");
        }
        if (!try_lock(kind, others)) {
            try {
                fail_locked(named, path, descriptor_);
            } catch (...) {
                close(descriptor_);
                throw;
            }
        }
        // Between opening and locking, the process before may have renamed or removed the file: the lock
        // would be one on its finished work.
        if (has_its_name()) return;
        close(descriptor_);
    }
    throw Error(named + ": cannot be written: " + path + " is another file each time it is opened");
}

LockedFile::LockedFile(LockedFile&& from) noexcept
    : path_(from.path_), named_(from.named_), descriptor_(std::exchange(from.descriptor_, -1)) {}

LockedFile::~LockedFile() {
    if (descriptor_ >= 0) close(descriptor_);
}

bool LockedFile::try_lock(Kind kind, Others others) {
    const int operation =
        (kind == Kind::alone ? LOCK_EX : LOCK_SH) | (others == Others::refuse ? LOCK_NB : 0);
    // Who only looks whether the file is locked, or is just ending, holds it for a moment.
    constexpr int most = 100;
    for (int k = 0; k < most; ++k) {
        if (flock(descriptor_, operation) == 0) return true;
        if (errno == EINTR) continue;
        if (no_locks_here(errno)) {
            log_warning(path_ + ": this file system has no locks (" + reason() +
                        "): two processes that write one file here would damage it");
            return true;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
}

bool LockedFile::has_its_name() const {
    struct stat opened, named;
    return fstat(descriptor_, &opened) == 0 && lstat(path_.c_str(), &named) == 0 && same_inode(opened, named);
}

size_t LockedFile::size() const {
    struct stat file;
    return fstat(descriptor_, &file) == 0 ? size_t(file.st_size) : 0;
}

void LockedFile::cut(size_t size) {
    if (ftruncate(descriptor_, off_t(size)) != 0) throw Error(named_ + ": cannot be written: " + reason());
}

void LockedFile::append(const std::string& bytes) {
    write_all(descriptor_, named_, bytes.data(), bytes.size());
}

void LockedFile::remove() {
    if (has_its_name()) unlink(path_.c_str());
}

bool LockedFile::made_alone() { return try_lock(Kind::alone, Others::refuse); }

std::string writer_of(const std::string& path) {
    const int descriptor = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0) return "";
    std::string writer;
    if (flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK)
        writer = words_for(holder_of(descriptor));
    close(descriptor);
    return writer;
}

SharedLock::SharedLock(const std::string& path)
    : descriptor_(open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
    if (descriptor_ < 0) return;
    held_ = flock(descriptor_, LOCK_SH | LOCK_NB) == 0 || errno != EWOULDBLOCK;
}
SharedLock::SharedLock(SharedLock&& from) noexcept
    : descriptor_(std::exchange(from.descriptor_, -1)), held_(from.held_) {}
SharedLock::~SharedLock() {
    if (descriptor_ >= 0) close(descriptor_);
}

// NAME.partial, or NAME.partial.mp4 of NAME.mp4.
static std::string partial_name(const std::string& target, const std::string& ending) {
    const bool has_it = !ending.empty() && target.ends_with(ending);
    return target.substr(0, target.size() - (has_it ? ending.size() : 0)) + ".partial" + ending;
}

// What must hold before the file is opened, in the order in which members are made.
static std::string placed(const std::string& path, bool overwrite) {
    require_place(path, overwrite);
    const std::string target = target_of(path);
    make_folder_of(target);
    return target;
}

OutputFile::OutputFile(const std::string& path, bool overwrite, const std::string& ending,
                       LockedFile::Others others)
    : path_(path),
      target_(placed(path, overwrite)),
      overwrite_(overwrite),
      file_(partial_name(target_, ending), path, LockedFile::Kind::alone, others) {
    try {
        require_place(path, overwrite);  // again: another process may just have finished it
    } catch (...) {
        if (file_.size() == 0) file_.remove();
        throw;
    }
}

OutputFile::OutputFile(OutputFile&& from) noexcept
    : path_(from.path_),
      target_(from.target_),
      overwrite_(from.overwrite_),
      begun_(from.begun_),
      kept_(from.kept_),
      done_(std::exchange(from.done_, true)),
      file_(std::move(from.file_)) {}

OutputFile::~OutputFile() {
    if (done_ || kept_) return;
    if (begun_ || file_.size() == 0) file_.remove();
}

void OutputFile::write(const std::string& bytes) {
    if (!std::exchange(begun_, true)) file_.cut(0);
    file_.append(bytes);
}

void OutputFile::commit() {
    keep();
    // Not written by this program, which would have found the lock.
    std::error_code error;
    if (!overwrite_ && fs::exists(target_, error))
        throw Error(path_ + ": has come to be there meanwhile; what was written is in " + partial());
    fs::rename(partial(), target_, error);
    if (error) throw Error(path_ + ": cannot be renamed from " + partial() + ": " + error.message());
    done_ = true;
    LockedFile ended(std::move(file_));
}

OutputFolder::OutputFolder(const std::string& path, LockedFile::Kind kind)
    : file_((make_folder_of(path + "/.lock"), path + "/.lock"), path, kind) {}

OutputFolder::~OutputFolder() {
    if (file_.made_alone()) file_.remove();
}

}  // namespace wetcurl

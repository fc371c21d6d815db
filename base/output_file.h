// Files that the program writes: one process writes each of them, and a file has its name only once it is
// whole.
#pragma once

#include <string>

#include "base/error.h"

namespace wetcurl {

// `path` with its symbolic links followed, to a file that need not be there yet: an output that is named by a
// link replaces that file, and the link stays. Throws Error where links lead in a circle.
std::string target_of(const std::string& path);

// Where an OutputFile of `path` is written until it is whole: NAME.partial, beside the target.
std::string partial_of(const std::string& path);

// Whether `path` is a device, a pipe, a socket, or an open descriptor (/dev/stdout, whatever it is directed
// to): text is written to it as it comes, and nothing is locked, renamed or replaced.
bool is_stream(const std::string& path);
// All of `text`. Throws Error where it cannot be written.
void write_to_stream(const std::string& path, const std::string& text);

// Throws Misuse for an empty name, and Error where `path` cannot become a file: it is a folder or a stream,
// or it is there and `overwrite` is false.
void require_place(const std::string& path, bool overwrite);

// The folder that `path` lies in, made where it is missing.
void make_folder_of(const std::string& path);

// A file, open for reading and writing, under a lock that other processes respect; made where it is missing,
// and never cut. The lock is that of flock(2), which ends with its process. It holds between the processes of
// one host on every file system that has locks. NFS (Linux 2.6.12 and later) turns it into a lock of the
// server, which holds between hosts too; but a host may remember for some seconds which file a name meant, so
// that two hosts that begin within these seconds after a third has ended can both believe that the name is
// theirs. Where a file system has no locks at all, a warning says so.
class LockedFile {
  public:
    enum class Kind { alone, shared };
    enum class Others { refuse, wait };
    // Throws Error where it cannot be opened, and, with Others::refuse, where another process holds a lock
    // that excludes this one; the text begins with `named`, names that process, and says what to do.
    LockedFile(const std::string& path, const std::string& named, Kind kind = Kind::alone,
               Others others = Others::refuse);
    LockedFile(LockedFile&& from) noexcept;
    ~LockedFile();  // the lock ends
    LockedFile& operator=(LockedFile&&) = delete;

    const std::string& path() const { return path_; }
    size_t size() const;  // [bytes]
    // Throw Error where the file cannot be written.
    void cut(size_t size);
    void append(const std::string& bytes);
    // Where it still has its name: removes it. Nobody else may hold a lock.
    void remove();
    // Whether this process holds the lock alone now; one that others share cannot be had.
    bool made_alone();

  private:
    bool try_lock(Kind kind, Others others);
    bool has_its_name() const;
    std::string path_, named_;
    int descriptor_ = -1;
};

// Whether a process holds the lock of an OutputFile on the file that lies at `path`: which one, as a text; ""
// where there is none.
std::string writer_of(const std::string& path);

// A lock on the file at a path that others may share, and that keeps an OutputFile from being written there.
class SharedLock {
  public:
    // Takes it if it can be had at once.
    explicit SharedLock(const std::string& path);
    SharedLock(SharedLock&& from) noexcept;
    SharedLock& operator=(SharedLock&&) = delete;
    ~SharedLock();
    // False: a process writes the file. True too on a file system without locks.
    bool is_held() const { return held_; }

  private:
    int descriptor_ = -1;
    bool held_ = false;
};

// A file that is written beside its name, under a lock, and renamed when it is whole. What an earlier process
// left at NAME.partial stays until the first byte is written.
class OutputFile {
  public:
    // `ending` stays last in the partial name where it is given (".mp4": NAME.partial.mp4). Throws Misuse and
    // Error as require_place does, and Error where another process writes the file.
    OutputFile(const std::string& path, bool overwrite, const std::string& ending = "",
               LockedFile::Others others = LockedFile::Others::refuse);
    OutputFile(OutputFile&& from) noexcept;
    ~OutputFile();  // removes what was written, unless it was kept or committed
    OutputFile& operator=(OutputFile&&) = delete;

    const std::string& path() const { return path_; }  // as it was named
    const std::string& partial() const { return file_.path(); }
    // Appends; the first call cuts what was there. Throws Error where it cannot be written.
    void write(const std::string& bytes);
    // For what writes by name: `partial()` is about to be cut and written by something else.
    void begin() { begun_ = true; }
    // The partial file stays when this ends.
    void keep() { kept_ = true; }
    // Gives the file its name. Throws Error where that fails; the partial file then stays.
    void commit();

  private:
    std::string path_, target_;
    bool overwrite_, begun_ = false, kept_ = false, done_ = false;
    LockedFile file_;
};

// A folder that this process fills alone, or with others that share the work: by a lock on FOLDER/.lock,
// which goes with the last of them.
class OutputFolder {
  public:
    // Makes the folder. Throws Error where that fails, or where another process excludes this one.
    explicit OutputFolder(const std::string& path, LockedFile::Kind kind = LockedFile::Kind::alone);
    ~OutputFolder();

  private:
    LockedFile file_;
};

}  // namespace wetcurl

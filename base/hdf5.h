// HDF5 behind a small owner: every handle closes itself, every failure names file and dataset.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/output_file.h"

namespace wetcurl {

// Both may be used by several threads, an object by one at a time.

// A file of ours: it carries a format name and a version, and is written as an OutputFile, which gets its
// name when `commit` is called. One that is destroyed uncommitted stays as NAME.partial, readable.
class H5Writer {
  public:
    // `shared`: other processes read it while it grows (`share`), which needs HDF5 1.10 or later to read.
    enum class Layout { plain, shared };
    // Throws Error where `path` exists and `overwrite` is false, where another process writes it, or where it
    // cannot be made.
    H5Writer(const std::string& path, const std::string& format, int version, bool overwrite)
        : H5Writer(OutputFile(path, overwrite), format, version) {}
    // Into a place that was secured before.
    H5Writer(OutputFile place, const std::string& format, int version, Layout layout = Layout::plain);
    // Goes on with what an earlier process left at `place.partial()`, of Layout::shared; it is shared at
    // once. Throws Error where that cannot be opened; it then stays as it is.
    explicit H5Writer(OutputFile place);
    ~H5Writer();
    H5Writer(const H5Writer&) = delete;
    H5Writer& operator=(const H5Writer&) = delete;

    // Row-major data; `name` may hold groups ("groom/points"), which are made. T: float, double, int32_t,
    // int64_t, uint8_t.
    template <class T>
    void write(const std::string& name, const T* data, const std::vector<size_t>& shape);
    template <class T>
    void write(const std::string& name, const std::vector<T>& data) {
        write(name, data.data(), {data.size()});
    }
    // Appends one row of `shape` to the extendable dataset `name` (made on first use, one chunk a row).
    template <class T>
    void append(const std::string& name, const T* data, const std::vector<size_t>& shape);
    // An extendable dataset of no rows of `shape`, as `append` makes it.
    template <class T>
    void make_rows(const std::string& name, const std::vector<size_t>& shape);
    // Row `row` of the extendable dataset `name`, which grows where it has fewer.
    template <class T>
    void put_row(const std::string& name, size_t row, const T* data, const std::vector<size_t>& shape);
    // From now on other processes may read the file, and a kill at any moment leaves it readable. Only rows
    // of extendable datasets may be written from here on. For Layout::shared.
    void share();
    void attribute(const std::string& name, const std::string& value);
    void attribute(const std::string& name, double value);
    // `name` here is what lies at `target` in another file, whose path starts at this one's folder.
    void link(const std::string& name, const std::string& file, const std::string& target);
    void flush();    // what is written so far survives a crash
    void commit();   // closes and renames to the final name
    void discard();  // closes and removes what was written
    const std::string& path() const { return path_; }

  private:
    void require(bool ok, const std::string& what);
    OutputFile place_;
    std::string path_;
    Layout layout_;
    int64_t file_ = -1;
    bool shared_ = false, failed_ = false;
};

// By its first bytes. False where it cannot be read.
bool is_hdf5(const std::string& path);

class H5Reader {
  public:
    // How far its writer came: to its end, not yet there, or broken off by a kill or a full disk. Only a file
    // of Layout::shared under its partial name can be read in the last two.
    enum class Written { whole, under_way, broken_off };
    // Throws Error where the file is missing, empty, cut short, foreign, of another format, of a version
    // newer than `version` or older than `oldest`, or is being written and cannot be read meanwhile. `mine`:
    // this process holds the lock of an OutputFile there, and writes nothing meanwhile.
    H5Reader(const std::string& path, const std::string& format, int version, int oldest = 1,
             bool mine = false);
    ~H5Reader();
    H5Reader(const H5Reader&) = delete;
    H5Reader& operator=(const H5Reader&) = delete;

    Written written() const { return written_; }
    // "process 123", while it writes the file; "" otherwise.
    const std::string& writer() const { return writer_; }
    // How many of the first `rows` rows of an extendable dataset the file holds whole: fewer where it was
    // cut.
    size_t rows_there(const std::string& name, size_t rows) const;

    bool has(const std::string& name) const;
    // Throws Error where the file holds fewer bytes than that many values have; rows of a file that is not
    // whole may be on their way.
    std::vector<size_t> shape(const std::string& name) const;
    // The whole dataset. `shape`, where given, must match (0 = any). Floating data is checked to be finite.
    template <class T>
    std::vector<T> read(const std::string& name, const std::vector<size_t>& shape = {}) const;
    // The first `rows` rows of a dataset of rows of `shape`, one after the other; as `read` otherwise.
    template <class T>
    std::vector<T> read_rows(const std::string& name, size_t rows, const std::vector<size_t>& shape) const;
    // Row `row` of the first axis.
    template <class T>
    void read_row(const std::string& name, size_t row, T* out) const;
    bool has_attribute(const std::string& name) const;
    std::string text(const std::string& attribute) const;
    double number(const std::string& attribute) const;
    int integer(const std::string& attribute, int low, int high) const;
    std::vector<std::string> list(const std::string& group) const;  // names in a group
    const std::string& path() const { return path_; }

  private:
    void open(bool mine);
    std::string path_, writer_;
    int64_t file_ = -1;
    Written written_ = Written::whole;
    std::optional<SharedLock> lock_;        // no process begins to write what is read
    mutable std::set<std::string> stored_;  // datasets whose values the file is known to hold
};

}  // namespace wetcurl

// HDF5 behind a small owner.
#include "base/hdf5.h"

#include <hdf5.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <string_view>
#include <thread>
#include <type_traits>
#include <utility>

#include "base/lfs_pointer.h"
#include "base/provenance.h"

namespace wetcurl {

namespace fs = std::filesystem;

namespace {

// The library takes one caller at a time. It prints its own stack on standard error unless each thread tells
// it not to: our message says it once.
class Turn {
  public:
    Turn() {
        thread_local const bool quiet = H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr) >= 0;
        (void)quiet;
    }

  private:
    static std::recursive_mutex& mutex() {
        static std::recursive_mutex only;
        return only;
    }
    const std::lock_guard<std::recursive_mutex> lock_{mutex()};
};

struct Handle {
    hid_t id = -1;
    herr_t (*close)(hid_t) = nullptr;
    Handle(hid_t id, herr_t (*close)(hid_t)) : id(id), close(close) {}
    ~Handle() {
        if (id >= 0) close(id);
    }
    Handle(const Handle&) = delete;
    operator hid_t() const { return id; }
    // Closes it now: false where what was kept back could not be written.
    bool closed() { return close(std::exchange(id, -1)) >= 0; }
};

// It must not clean up behind us at exit: after a full disk that crashes, and our owners close all they open.
const bool left_alone = H5dont_atexit() >= 0;

template <class T>
hid_t type_of() {
    if constexpr (std::is_same_v<T, float>) return H5T_NATIVE_FLOAT;
    if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
    if constexpr (std::is_same_v<T, int32_t>) return H5T_NATIVE_INT32;
    if constexpr (std::is_same_v<T, int64_t>) return H5T_NATIVE_INT64;
    if constexpr (std::is_same_v<T, uint8_t>) return H5T_NATIVE_UINT8;
}

void check(bool ok, const std::string& path, const std::string& what) {
    if (!ok) throw Error(path + ": " + what);
}

std::vector<hsize_t> dims_of(const std::vector<size_t>& shape) { return {shape.begin(), shape.end()}; }

hid_t intermediate_groups() {
    static const hid_t list = [] {
        hid_t l = H5Pcreate(H5P_LINK_CREATE);
        H5Pset_create_intermediate_group(l, 1);
        return l;
    }();
    return list;
}

// Without the time of day, so that the same content makes the same bytes.
hid_t untimed_dataset() {
    const hid_t list = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_obj_track_times(list, false);
    return list;
}

// HDF5 would lock what it writes too, by the same flock(2), and find the OutputFile's lock in its way.
hid_t unlocked() {
    static const hid_t list = [] {
        hid_t l = H5Pcreate(H5P_FILE_ACCESS);
        H5Pset_file_locking(l, false, true);
        return l;
    }();
    return list;
}
// The same, to read: files that links lead to stay open for a while, since one is read many times in a row.
hid_t reading() {
    static const hid_t list = [] {
        constexpr unsigned linked_files = 8;
        const hid_t l = H5Pcopy(unlocked());
        H5Pset_elink_file_cache_size(l, linked_files);
        return l;
    }();
    return list;
}
// The same, for files that others read while they are written: what HDF5 calls SWMR needs this layout.
hid_t shared_layout() {
    static const hid_t list = [] {
        const hid_t l = H5Pcopy(unlocked());
        H5Pset_libver_bounds(l, H5F_LIBVER_V110, H5F_LIBVER_V110);
        return l;
    }();
    return list;
}
// A kill divides a write where the kernel's pages meet. None of the blocks that hold a file together crosses
// a page here, so that each is written or not.
hid_t paged() {
    static const hid_t list = [] {
        constexpr hsize_t page = 4096;
        const hid_t l = H5Pcreate(H5P_FILE_CREATE);
        H5Pset_file_space_strategy(l, H5F_FSPACE_STRATEGY_PAGE, false, 1);
        H5Pset_file_space_page_size(l, page);
        return l;
    }();
    return list;
}
// The same, of a file whose writer was killed: it still says that it is being written. The property is that
// of HDF5's own h5clear.
hid_t after_a_kill() {
    static const hid_t list = [] {
        const hid_t l = H5Pcopy(shared_layout());
        const hbool_t clear = true;
        H5Pset(l, "clear_status_flags", &clear);
        return l;
    }();
    return list;
}
// To read such a file: what is damaged is not asked for again and again, each time after twice as long a
// pause, as HDF5 does; what is being written is, for some milliseconds.
hid_t shared_reading(bool being_written) {
    const auto list_of = [](unsigned attempts) {
        const hid_t l = H5Pcopy(shared_layout());
        H5Pset_metadata_read_attempts(l, attempts);
        return l;
    };
    static const hid_t written = list_of(22), left = list_of(1);
    return being_written ? written : left;
}
// The environment's word would go before that.
const bool unlocked_can_be_had = [] {
    const char* word = std::getenv("HDF5_USE_FILE_LOCKING");
    return !word || std::string(word) == "FALSE" || std::string(word) == "0" ||
           unsetenv("HDF5_USE_FILE_LOCKING") == 0;
}();

std::string shape_text(const std::vector<size_t>& shape) {
    std::string s = "(";
    for (size_t i = 0; i < shape.size(); ++i)
        s += (i ? ", " : "") + (shape[i] ? std::to_string(shape[i]) : "any");
    return s + ")";
}

}  // namespace

bool is_hdf5(const std::string& path) {
    constexpr std::string_view signature = "\x89HDF\r\n\x1a\n";
    char start[signature.size()] = {};
    std::ifstream(path, std::ios::binary).read(start, sizeof start);
    return std::string_view(start, sizeof start) == signature;
}

// Whether it has the layout of files that are shared, by the version of its first block.
static bool is_shared(const std::string& path) {
    constexpr size_t signature = 8;
    char start[signature + 1] = {};
    std::ifstream(path, std::ios::binary).read(start, sizeof start);
    return start[signature] >= 3;
}

// A kill, or a full disk, may leave a file of that layout shorter than its first block says it is, which HDF5
// refuses to write on: it gets that length, with zeros, to which nothing in it leads. HDF5 File Format
// Specification 3.0, II.A, version 3: the length is a number of 8 bytes, the lowest first, at byte 28.
static void lengthen(const std::string& path) {
    constexpr size_t place = 28, bytes = 8;
    unsigned char start[place + bytes] = {};
    std::ifstream in(path, std::ios::binary);
    if (!in.read(reinterpret_cast<char*>(start), sizeof start)) return;
    uint64_t said = 0;
    for (size_t k = bytes; k-- > 0;) said = said << 8 | start[place + k];
    std::error_code error;
    if (is_shared(path) && fs::file_size(path, error) < said) fs::resize_file(path, said, error);
}

H5Writer::H5Writer(OutputFile place, const std::string& format, int version, Layout layout)
    : place_(std::move(place)), path_(place_.path()), layout_(layout) {
    const Turn turn;
    place_.begin();
    const bool shared = layout == Layout::shared;
    file_ = H5Fcreate(place_.partial().c_str(), H5F_ACC_TRUNC, shared ? paged() : H5P_DEFAULT,
                      shared ? shared_layout() : unlocked());
    check(file_ >= 0, path_, "cannot be written (HDF5 cannot make " + place_.partial() + ")");
    try {
        attribute("format", format);
        attribute("version", double(version));
        for (const auto& [name, text] : provenance()) attribute("provenance." + name, text);
    } catch (...) {
        H5Fclose(file_);
        throw;
    }
}

H5Writer::H5Writer(OutputFile place)
    : place_(std::move(place)), path_(place_.path()), layout_(Layout::shared) {
    const Turn turn;
    place_.keep();
    lengthen(place_.partial());
    file_ = H5Fopen(place_.partial().c_str(), H5F_ACC_RDWR, after_a_kill());
    check(file_ >= 0, path_,
          "cannot go on with " + place_.partial() + ": it is damaged; without --resume the run begins anew");
    // Killed between two flushes, the file says that it ends before its last rows: they must not be
    // overwritten.
    if (H5Fincrement_filesize(file_, 0) >= 0 && H5Fflush(file_, H5F_SCOPE_GLOBAL) >= 0 &&
        H5Fstart_swmr_write(file_) >= 0) {
        shared_ = true;
        return;
    }
    H5Fclose(file_);
    throw Error(path_ + ": cannot go on with " + place_.partial() +
                ": it is damaged, or the disk is full; without --resume the run begins anew");
}

H5Writer::~H5Writer() {
    const Turn turn;
    if (file_ < 0) return;
    place_.keep();
    // To close it would write on after a full disk, in another order than readers rely on: it stays as a kill
    // leaves it.
    if (!failed_) H5Fclose(file_);
}

// Of a write to a file that may be shared.
void H5Writer::require(bool ok, const std::string& what) {
    failed_ = failed_ || (shared_ && !ok);
    check(ok, path_, what);
}

template <class T>
void H5Writer::write(const std::string& name, const T* data, const std::vector<size_t>& shape) {
    const Turn turn;
    auto dims = dims_of(shape);
    Handle space(H5Screate_simple(int(dims.size()), dims.data(), nullptr), H5Sclose);
    Handle untimed(untimed_dataset(), H5Pclose);
    Handle set(
        H5Dcreate2(file_, name.c_str(), type_of<T>(), space, intermediate_groups(), untimed, H5P_DEFAULT),
        H5Dclose);
    check(set >= 0, path_, "dataset '" + name + "' cannot be made");
    check(H5Dwrite(set, type_of<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0 && set.closed(), path_,
          "dataset '" + name + "' cannot be written (disk full?)");
}

static std::vector<hsize_t> row_of(const std::vector<size_t>& shape) {
    std::vector<hsize_t> row{1};
    row.insert(row.end(), shape.begin(), shape.end());
    return row;
}

template <class T>
void H5Writer::make_rows(const std::string& name, const std::vector<size_t>& shape) {
    const Turn turn;
    const std::vector<hsize_t> row = row_of(shape);
    std::vector<hsize_t> none = row, limit = row;
    none[0] = 0;
    limit[0] = H5S_UNLIMITED;
    // Never more of the second axis; but chunks of two unlimited axes are found by a tree, whose nodes are
    // smaller than a page, and those of one by blocks that grow beyond it.
    if (layout_ == Layout::shared) limit.at(1) = H5S_UNLIMITED;
    Handle space(H5Screate_simple(int(row.size()), none.data(), limit.data()), H5Sclose);
    Handle plist(untimed_dataset(), H5Pclose);
    H5Pset_chunk(plist, int(row.size()), row.data());
    Handle made(
        H5Dcreate2(file_, name.c_str(), type_of<T>(), space, intermediate_groups(), plist, H5P_DEFAULT),
        H5Dclose);
    check(made >= 0, path_, "dataset '" + name + "' cannot be made");
}

static std::vector<hsize_t> extent_of(hid_t set) {
    Handle space(H5Dget_space(set), H5Sclose);
    std::vector<hsize_t> extent(size_t(std::max(0, H5Sget_simple_extent_ndims(space))));
    if (!extent.empty()) H5Sget_simple_extent_dims(space, extent.data(), nullptr);
    return extent;
}

template <class T>
void H5Writer::put_row(const std::string& name, size_t row, const T* data, const std::vector<size_t>& shape) {
    const Turn turn;
    const std::vector<hsize_t> one = row_of(shape);
    Handle set(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    check(set >= 0, path_, "dataset '" + name + "' cannot be opened");
    std::vector<hsize_t> extent = extent_of(set), start(one.size(), 0);
    check(extent.size() == one.size() && std::equal(one.begin() + 1, one.end(), extent.begin() + 1), path_,
          "dataset '" + name + "' has rows of another size");
    start[0] = row;
    if (row >= extent[0]) {
        extent[0] = row + 1;
        require(H5Dset_extent(set, extent.data()) >= 0, "dataset '" + name + "' cannot grow");
    }
    Handle space(H5Dget_space(set), H5Sclose);
    H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, one.data(), nullptr);
    Handle memory(H5Screate_simple(int(one.size()), one.data(), nullptr), H5Sclose);
    require(H5Dwrite(set, type_of<T>(), memory, space, H5P_DEFAULT, data) >= 0 && set.closed(),
            "dataset '" + name + "' cannot be written (disk full?)");
}

template <class T>
void H5Writer::append(const std::string& name, const T* data, const std::vector<size_t>& shape) {
    const Turn turn;
    size_t rows = 0;
    if (H5Lexists(file_, name.c_str(), H5P_DEFAULT) <= 0) {
        make_rows<T>(name, shape);
    } else {
        Handle set(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
        check(set >= 0, path_, "dataset '" + name + "' cannot be opened");
        rows = size_t(extent_of(set).at(0));
    }
    put_row(name, rows, data, shape);
}

void H5Writer::share() {
    const Turn turn;
    check(H5Fstart_swmr_write(file_) >= 0, path_, "cannot be written (disk full?)");
    shared_ = true;
}

void H5Writer::attribute(const std::string& name, const std::string& value) {
    const Turn turn;
    Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type, value.size() + 1);
    H5Tset_cset(type, H5T_CSET_UTF8);
    Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    // Long texts (a whole scene) do not fit in an object header: a dataset holds them.
    Handle untimed(untimed_dataset(), H5Pclose);
    Handle set(H5Dcreate2(file_, ("about/" + name).c_str(), type, space, intermediate_groups(), untimed,
                          H5P_DEFAULT),
               H5Dclose);
    check(set >= 0 && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, value.c_str()) >= 0 && set.closed(),
          path_, "attribute '" + name + "' cannot be written");
}

void H5Writer::attribute(const std::string& name, double value) { write("about/" + name, &value, {1}); }

void H5Writer::link(const std::string& name, const std::string& file, const std::string& target) {
    const Turn turn;
    check(H5Lcreate_external(file.c_str(), target.c_str(), file_, name.c_str(), intermediate_groups(),
                             H5P_DEFAULT) >= 0,
          path_, "'" + name + "': the link to " + file + " cannot be written");
}

void H5Writer::flush() {
    const Turn turn;
    require(H5Fflush(file_, H5F_SCOPE_GLOBAL) >= 0,
            "cannot be written (disk full?); what was written is in " + place_.partial());
}

void H5Writer::commit() {
    const Turn turn;
    place_.keep();
    const bool flushed = H5Fflush(file_, H5F_SCOPE_GLOBAL) >= 0;
    const bool closed = H5Fclose(std::exchange(file_, -1)) >= 0;
    check(flushed && closed, path_,
          "cannot be finished (disk full?); what was written is in " + place_.partial());
    place_.commit();
}

void H5Writer::discard() {
    const Turn turn;
    if (file_ >= 0) H5Fclose(std::exchange(file_, -1));
}

static void require_unwritten(const std::string& path, const std::string& writer) {
    check(writer.empty(), path, "found that " + writer + " writes it; wait until it ends");
}

// NAME where NAME.partial was named and has just got its name.
constexpr std::string_view partial_ending = ".partial";
static std::string present_name(const std::string& path) {
    std::error_code error;
    if (!path.ends_with(partial_ending) || fs::exists(path, error)) return path;
    const std::string name = path.substr(0, path.size() - partial_ending.size());
    return fs::exists(name, error) ? name : path;
}

// Opens what nobody writes, what a process writes that lets others read it, or what one left that was killed.
void H5Reader::open(bool mine) {
    // A file gets its name a moment before its writer lets go of it, and a writer opens it before it shares
    // it.
    constexpr int most = 50;
    for (int k = 0; k < most; ++k) {
        if (k > 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
        path_ = present_name(path_);
        const bool partial = path_.ends_with(partial_ending);
        writer_ = "";
        if (!mine) {
            lock_.emplace(path_);
            if (!lock_->is_held()) lock_.reset(), writer_ = writer_of(path_);
        }
        const bool alone = mine || lock_;
        written_ = Written::whole;
        if (alone) file_ = H5Fopen(path_.c_str(), H5F_ACC_RDONLY, reading());
        if (file_ >= 0) return;
        if (partial && is_shared(path_)) {
            written_ = alone ? Written::broken_off : Written::under_way;
            file_ = H5Fopen(path_.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, shared_reading(!alone));
            if (file_ < 0 && alone) file_ = H5Fopen(path_.c_str(), H5F_ACC_RDONLY, after_a_kill());
            if (file_ >= 0) return;
        }
        if (alone && k > 0) break;
    }
    require_unwritten(path_, writer_);
    throw Error(path_ + ": is cut short or damaged (HDF5 cannot open it)");
}

H5Reader::H5Reader(const std::string& named, const std::string& format, int version, int oldest, bool mine)
    : path_(present_name(named)) {
    const Turn turn;
    const std::string path = path_;
    if (!fs::exists(path)) throw Error(path + ": no such file");
    if (fs::is_directory(path)) throw Error(path + ": found a folder, a '" + format + "' file is needed");
    const bool empty = fs::file_size(path) == 0;
    if (!empty) refuse_lfs_pointer(path);
    if (empty || !is_hdf5(path)) {
        require_unwritten(path, mine ? "" : writer_of(path));
        throw Error(path + (empty ? ": the file is empty"
                                  : ": found no HDF5 file, a '" + format + "' file is needed"));
    }
    open(mine);
    try {
        check(has("about/format"), path, "found a foreign HDF5 file, a '" + format + "' file is needed");
        const std::string found = text("format");
        check(found == format, path, "found a '" + found + "' file, a '" + format + "' file is needed");
        const int v = int(number("version"));
        check(
            v >= oldest && v <= version, path,
            "found version " + std::to_string(v) + ", allowed " + std::to_string(oldest) + " to " +
                std::to_string(version) +
                (v < oldest ? " (made by an older wetcurl: make it again)" : " (made by a newer wetcurl?)"));
    } catch (...) {
        H5Fclose(file_);
        throw;
    }
}

size_t H5Reader::rows_there(const std::string& name, size_t rows) const {
    const Turn turn;
    Handle set(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    check(set >= 0, path_, "dataset '" + name + "' cannot be opened (damaged)");
    const std::vector<hsize_t> extent = extent_of(set);
    if (extent.empty()) return 0;
    rows = std::min(rows, size_t(extent[0]));
    std::error_code error;
    const auto size = fs::file_size(path_, error);
    std::vector<hsize_t> row(extent.size(), 0);
    for (; rows > 0; --rows) {
        row[0] = rows - 1;
        unsigned mask = 0;
        haddr_t place = HADDR_UNDEF;
        hsize_t bytes = 0;
        if (H5Dget_chunk_info_by_coord(set, row.data(), &mask, &place, &bytes) >= 0 && place != HADDR_UNDEF &&
            place + bytes <= size)
            break;
    }
    return rows;
}

H5Reader::~H5Reader() {
    const Turn turn;
    H5Fclose(file_);
}

// Where what is named lies in another file: that file, in brackets; "" where it lies here.
static std::string other_file(hid_t file, const std::string& name) {
    for (size_t at = name.find('/', 1);; at = name.find('/', at + 1)) {
        const std::string part = name.substr(0, at);
        H5L_info_t info;
        if (H5Lexists(file, part.c_str(), H5P_DEFAULT) <= 0 ||
            H5Lget_info(file, part.c_str(), &info, H5P_DEFAULT) < 0)
            return "";
        if (info.type == H5L_TYPE_EXTERNAL) {
            std::vector<char> value(info.u.val_size);
            const char *to = nullptr, *object = nullptr;
            if (H5Lget_val(file, part.c_str(), value.data(), value.size(), H5P_DEFAULT) < 0 ||
                H5Lunpack_elink_val(value.data(), value.size(), nullptr, &to, &object) < 0)
                return "";
            return std::string(" (it lies in ") + to + ", which is not there, or damaged)";
        }
        if (at == std::string::npos) return "";
    }
}

bool H5Reader::has(const std::string& name) const {
    const Turn turn;
    // Every link on the way must exist, or HDF5 calls it an error.
    for (size_t at = name.find('/'); at != std::string::npos; at = name.find('/', at + 1))
        if (at > 0 && H5Lexists(file_, name.substr(0, at).c_str(), H5P_DEFAULT) <= 0) return false;
    return H5Lexists(file_, name.c_str(), H5P_DEFAULT) > 0;
}

// Whether the file holds what `set` claims to: as many bytes, or so many that its filters (gzip at most)
// could have made them of it. A claim is believed before memory is asked for, and unwritten values read as 0.
static void check_stored(hid_t set, const std::vector<size_t>& shape, const std::string& path,
                         const std::string& name) {
    constexpr double most_compressed = 1032;  // of gzip
    Handle type(H5Dget_type(set), H5Tclose);
    Handle list(H5Dget_create_plist(set), H5Pclose);
    const bool filtered = H5Pget_nfilters(list) > 0;
    double claimed = double(H5Tget_size(type));
    for (const size_t side : shape) claimed *= double(side);
    const double stored = double(H5Dget_storage_size(set));
    if (claimed <= stored * (filtered ? most_compressed : 1)) return;
    char sizes[96];
    std::snprintf(sizes, sizeof sizes, "%.0f bytes, of which the file holds %.0f", claimed, stored);
    throw Error(path + ": dataset '" + name + "' claims " + shape_text(shape) + " values of " + sizes +
                ": it is cut short or damaged");
}

std::vector<size_t> H5Reader::shape(const std::string& name) const {
    const Turn turn;
    check(has(name), path_, "dataset '" + name + "' is missing" + other_file(file_, name));
    Handle set(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    check(set >= 0, path_, "dataset '" + name + "' cannot be opened (damaged)");
    Handle space(H5Dget_space(set), H5Sclose);
    std::vector<hsize_t> dims(size_t(std::max(0, H5Sget_simple_extent_ndims(space))));
    if (!dims.empty()) H5Sget_simple_extent_dims(space, dims.data(), nullptr);
    const std::vector<size_t> found(dims.begin(), dims.end());
    Handle list(H5Dget_create_plist(set), H5Pclose);
    const bool grows = written_ != Written::whole && H5Pget_layout(list) == H5D_CHUNKED;
    if (!grows && !stored_.contains(name)) {
        check_stored(set, found, path_, name);
        stored_.insert(name);
    }
    return found;
}

static void check_same_kind(hid_t set, hid_t wanted, const std::string& path, const std::string& name) {
    Handle type(H5Dget_type(set), H5Tclose);
    check(H5Tget_class(type) == H5Tget_class(wanted), path,
          "dataset '" + name + "' holds another type of values");
}

template <class T>
static void check_finite(const std::vector<T>& v, const std::string& path, const std::string& name) {
    if constexpr (std::is_floating_point_v<T>)
        for (size_t i = 0; i < v.size(); ++i)
            if (!std::isfinite(v[i]))
                throw Error(path + ": dataset '" + name + "': found " + std::to_string(v[i]) + " at value " +
                            std::to_string(i) + ", only finite numbers are allowed");
}

template <class T>
std::vector<T> H5Reader::read(const std::string& name, const std::vector<size_t>& wanted) const {
    const Turn turn;
    const auto found = shape(name);
    bool fits = wanted.empty() || wanted.size() == found.size();
    size_t count = 1;
    for (size_t i = 0; i < found.size(); ++i) {
        if (!wanted.empty() && fits && wanted[i] != 0 && wanted[i] != found[i]) fits = false;
        check(found[i] < (size_t(1) << 36) && (found[i] == 0 || count < (size_t(1) << 36) / found[i]), path_,
              "dataset '" + name + "' claims an absurd size " + shape_text(found));
        count *= found[i];
    }
    check(fits, path_,
          "dataset '" + name + "' has shape " + shape_text(found) + ", needed " + shape_text(wanted));
    Handle set(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    check_same_kind(set, type_of<T>(), path_, name);
    std::vector<T> out(count);
    if (count)
        check(H5Dread(set, type_of<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data()) >= 0, path_,
              "dataset '" + name + "' cannot be read (cut short or damaged)");
    check_finite(out, path_, name);
    return out;
}

template <class T>
std::vector<T> H5Reader::read_rows(const std::string& name, size_t rows,
                                   const std::vector<size_t>& wanted) const {
    const Turn turn;
    const auto found = shape(name);
    check(found.size() == wanted.size() + 1 && found[0] >= rows &&
              std::equal(wanted.begin(), wanted.end(), found.begin() + 1),
          path_,
          "dataset '" + name + "' has shape " + shape_text(found) + ", needed " + std::to_string(rows) +
              " rows or more of " + shape_text(wanted));
    size_t each = 1;
    for (const size_t side : wanted) each *= side;
    std::vector<T> out(rows * each);
    Handle set(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    check_same_kind(set, type_of<T>(), path_, name);
    std::vector<hsize_t> start(found.size(), 0), count(found.begin(), found.end());
    count[0] = rows;
    Handle space(H5Dget_space(set), H5Sclose);
    Handle memory(H5Screate_simple(int(count.size()), count.data(), nullptr), H5Sclose);
    if (!out.empty())
        check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) >= 0 &&
                  H5Dread(set, type_of<T>(), memory, space, H5P_DEFAULT, out.data()) >= 0,
              path_, "dataset '" + name + "' cannot be read (cut short or damaged)");
    check_finite(out, path_, name);
    return out;
}

template <class T>
void H5Reader::read_row(const std::string& name, size_t row, T* out) const {
    const Turn turn;
    const auto found = shape(name);
    check(!found.empty() && row < found[0], path_,
          "dataset '" + name + "' has no row " + std::to_string(row));
    Handle set(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    check_same_kind(set, type_of<T>(), path_, name);
    std::vector<hsize_t> start(found.size(), 0), count(found.begin(), found.end());
    start[0] = row;
    count[0] = 1;
    Handle space(H5Dget_space(set), H5Sclose);
    H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
    Handle memory(H5Screate_simple(int(count.size()), count.data(), nullptr), H5Sclose);
    check(H5Dread(set, type_of<T>(), memory, space, H5P_DEFAULT, out) >= 0, path_,
          "dataset '" + name + "' cannot be read (cut short or damaged)");
}

bool H5Reader::has_attribute(const std::string& name) const { return has("about/" + name); }

std::string H5Reader::text(const std::string& attribute) const {
    const Turn turn;
    const std::string name = "about/" + attribute;
    check(has(name), path_, "attribute '" + attribute + "' is missing");
    Handle set(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    Handle type(H5Dget_type(set), H5Tclose);
    check(H5Tget_class(type) == H5T_STRING && !H5Tis_variable_str(type) && shape(name).empty(), path_,
          "attribute '" + attribute + "' is no text");
    std::string value(H5Tget_size(type), '\0');  // which the file holds: `shape` has checked it
    check(H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, value.data()) >= 0, path_,
          "attribute '" + attribute + "' cannot be read");
    value.resize(value.find('\0') == std::string::npos ? value.size() : value.find('\0'));
    return value;
}

double H5Reader::number(const std::string& attribute) const {
    check(has("about/" + attribute), path_, "attribute '" + attribute + "' is missing");
    return read<double>("about/" + attribute, {1})[0];
}

int H5Reader::integer(const std::string& attribute, int low, int high) const {
    const double found = number(attribute);
    check(found >= low && found <= high && found == std::floor(found), path_,
          "attribute '" + attribute + "': found " + std::to_string(found) + ", allowed " +
              std::to_string(low) + " to " + std::to_string(high));
    return int(found);
}

std::vector<std::string> H5Reader::list(const std::string& group) const {
    const Turn turn;
    std::vector<std::string> names;
    if (!has(group)) return names;
    Handle g(H5Gopen2(file_, group.c_str(), H5P_DEFAULT), H5Gclose);
    check(g >= 0, path_, "'" + group + "' is no group");
    const auto add = [](hid_t, const char* name, const H5L_info_t*, void* to) -> herr_t {
        static_cast<std::vector<std::string>*>(to)->emplace_back(name);
        return 0;
    };
    check(H5Literate(g, H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names) >= 0, path_,
          "what is in '" + group + "' cannot be read");
    return names;
}

#define WETCURL_FOR(T)                                                                                     \
    template void H5Writer::write<T>(const std::string&, const T*, const std::vector<size_t>&);            \
    template void H5Writer::append<T>(const std::string&, const T*, const std::vector<size_t>&);           \
    template void H5Writer::make_rows<T>(const std::string&, const std::vector<size_t>&);                  \
    template void H5Writer::put_row<T>(const std::string&, size_t, const T*, const std::vector<size_t>&);  \
    template std::vector<T> H5Reader::read<T>(const std::string&, const std::vector<size_t>&) const;       \
    template std::vector<T> H5Reader::read_rows<T>(const std::string&, size_t, const std::vector<size_t>&) \
        const;                                                                                             \
    template void H5Reader::read_row<T>(const std::string&, size_t, T*) const;
WETCURL_FOR(float)
WETCURL_FOR(double)
WETCURL_FOR(int32_t)
WETCURL_FOR(int64_t)
WETCURL_FOR(uint8_t)
#undef WETCURL_FOR

}  // namespace wetcurl

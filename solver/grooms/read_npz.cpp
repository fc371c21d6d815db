// Strands of DiffLocks: an .npz file, which is a zip archive of .npy arrays (NumPy's format, version 1 to 3).
#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>

#include "base/error.h"
#include "solver/grooms/byte_reader.h"
#include "solver/grooms/readers.h"

#ifdef WETCURL_HAVE_LIBZIP
#include <zip.h>
#endif

namespace wetcurl {

#ifdef WETCURL_HAVE_LIBZIP

namespace {

// Bytes of the archive's entry of this name, or none where it has no such entry.
class Archive {
  public:
    explicit Archive(const std::string& path) : path_(path) {
        int error = 0;
        zip_.reset(zip_open(path.c_str(), ZIP_RDONLY, &error));
        if (zip_) return;
        zip_error_t told;
        zip_error_init_with_code(&told, error);
        const std::string text = zip_error_strerror(&told);
        zip_error_fini(&told);
        throw Error(path + ": found no zip archive that can be read (" + text +
                    "), allowed is one of NumPy's .npz");
    }
    std::optional<std::string> entry(const std::string& name) const {
        const zip_int64_t index = zip_name_locate(zip_.get(), name.c_str(), 0);
        if (index < 0) return std::nullopt;
        zip_stat_t stat;
        zip_stat_init(&stat);
        constexpr zip_uint64_t needed = ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE;
        if (zip_stat_index(zip_.get(), zip_uint64_t(index), 0, &stat) != 0 || (stat.valid & needed) != needed)
            fail(name);
        constexpr zip_uint64_t most_compressed = 1032;  // of deflate
        if (stat.size > most_compressed * (stat.comp_size + 1))
            throw Error(path_ + ": " + name + ": found " + std::to_string(stat.size) +
                        " bytes said to lie in " + std::to_string(stat.comp_size) +
                        ", allowed are 1032 times as many");
        const std::unique_ptr<zip_file_t, decltype(&zip_fclose)> file(
            zip_fopen_index(zip_.get(), zip_uint64_t(index), 0), &zip_fclose);
        if (!file) fail(name);
        std::string bytes(stat.size, '\0');
        for (size_t done = 0; done < bytes.size();) {
            const zip_int64_t taken = zip_fread(file.get(), bytes.data() + done, bytes.size() - done);
            if (taken <= 0) fail(name);
            done += size_t(taken);
        }
        return bytes;
    }
    std::string names() const {
        constexpr zip_int64_t most = 12;
        const zip_int64_t count = zip_get_num_entries(zip_.get(), 0);
        std::string text;
        for (zip_int64_t k = 0; k < std::min(count, most); ++k)
            if (const char* name = zip_get_name(zip_.get(), zip_uint64_t(k), 0))
                text += (text.empty() ? "" : " ") + std::string(name);
        return text.empty() ? "nothing" : text + (count > most ? " ..." : "");
    }

  private:
    [[noreturn]] void fail(const std::string& name) const {
        throw Error(path_ + ": " + name + ": cannot be unpacked: " + zip_strerror(zip_.get()));
    }
    struct Close {
        void operator()(zip_t* zip) const { zip_discard(zip); }
    };
    std::string path_;
    std::unique_ptr<zip_t, Close> zip_;
};

double half_to_double(uint16_t bits) {
    const int exponent = (bits >> 10) & 31, mantissa = bits & 1023;
    const double size = exponent == 31 ? (mantissa ? std::nan("") : INFINITY)
                        : exponent     ? std::ldexp(1024 + mantissa, exponent - 25)
                                       : std::ldexp(mantissa, -24);
    return bits & 0x8000 ? -size : size;
}

// An array of floats, in memory as the file has it.
class Array {
  public:
    // `where`: file and entry.
    Array(const std::string& where, std::string bytes) : where_(where), bytes_(std::move(bytes)) {
        constexpr std::string_view magic = "\x93NUMPY";
        if (!bytes_.starts_with(magic) || bytes_.size() < 12)
            fail("another beginning", "that of a .npy array");
        const int version = bytes_[6];
        if (version < 1 || version > 3) fail("version " + std::to_string(version), "1, 2 or 3");
        uint32_t length = 0;
        const size_t digits = version == 1 ? 2 : 4;
        std::memcpy(&length, bytes_.data() + 8, digits);
        const size_t begin = 8 + digits;
        if (length > bytes_.size() - begin) fail("a header beyond the end", "a whole one");
        read_header(std::string_view(bytes_).substr(begin, length));
        data_ = begin + length;
        size_t left = bytes_.size() - data_, numbers = 1;
        for (size_t n : shape_) {
            if (n != 0 && numbers > left / n)
                fail("more numbers than bytes", "an array that fills the entry");
            numbers *= n;
        }
        if (numbers * width_ != left)
            fail(std::to_string(left) + " bytes", std::to_string(numbers * width_) + " for its shape");
    }
    const std::vector<size_t>& shape() const { return shape_; }
    // By its number in the order of C: the last index runs fastest.
    double at(size_t number) const {
        if (fortran_) {
            size_t index = 0, stride = 1, count = 1;
            for (size_t n : shape_) count *= n;
            for (size_t n : shape_) {
                count /= n;
                index += number / count * stride;
                number %= count;
                stride *= n;
            }
            number = index;
        }
        const char* from = bytes_.data() + data_ + number * width_;
        uint64_t bits = 0;
        for (size_t k = 0; k < width_; ++k)
            bits |= uint64_t((unsigned char)(from[k])) << 8 * (big_endian_ ? width_ - 1 - k : k);
        if (width_ == 2) return half_to_double(uint16_t(bits));
        if (width_ == 4) return std::bit_cast<float>(uint32_t(bits));
        return std::bit_cast<double>(bits);
    }
    [[noreturn]] void fail(const std::string& found, const std::string& allowed) const {
        throw Error(where_ + ": found " + found + ", allowed " + allowed);
    }

  private:
    // {'descr': '<f4', 'fortran_order': False, 'shape': (3, 2), }
    void read_header(std::string_view header) {
        auto value_of = [&](const std::string& key) {
            const size_t at = header.find("'" + key + "'");
            const size_t colon = header.find(':', at);
            if (at == std::string_view::npos || colon == std::string_view::npos)
                fail("no '" + key + "' in its header", "one");
            const size_t begin = header.find_first_not_of(' ', colon + 1);
            return header.substr(std::min(begin, header.size()));
        };
        const std::string_view type = value_of("descr").substr(0, 5);
        if (type == "'<f2'" || type == "'<f4'" || type == "'<f8'" || type == "'>f2'" || type == "'>f4'" ||
            type == "'>f8'") {
            big_endian_ = type[1] == '>';
            width_ = size_t(type[3] - '0');
        } else {
            fail("numbers of type " + std::string(type), "'<f2', '<f4', '<f8'");
        }
        fortran_ = value_of("fortran_order").starts_with("True");
        std::string_view shape = value_of("shape");
        shape = shape.substr(0, shape.find(')'));
        if (!shape.starts_with('(')) fail("no shape", "one in parentheses");
        for (shape.remove_prefix(1); !shape.empty();) {
            if (shape.front() == ' ' || shape.front() == ',') {
                shape.remove_prefix(1);
                continue;
            }
            size_t n = 0;
            const auto [end, error] = std::from_chars(shape.data(), shape.data() + shape.size(), n);
            if (error != std::errc() || shape_.size() == 8) fail("another shape", "up to 8 whole numbers");
            shape_.push_back(n);
            shape.remove_prefix(size_t(end - shape.data()));
        }
    }
    std::string where_, bytes_;
    std::vector<size_t> shape_;
    size_t data_ = 0, width_ = 0;
    bool fortran_ = false, big_endian_ = false;
};

std::string text_of(const std::vector<size_t>& shape) {
    std::string text;
    for (size_t n : shape) text += (text.empty() ? "" : " x ") + std::to_string(n);
    return text.empty() ? "one number" : text;
}

}  // namespace

StrandFile read_npz(const std::string& path) {
    const ByteReader file(path);  // judges whether it is there, plain and not empty
    const Archive archive(path);
    auto bytes = archive.entry("positions.npy");
    if (!bytes)
        throw Error(path + ": found " + archive.names() + ", allowed is positions.npy, as DiffLocks writes");
    const Array positions(path + ": positions", std::move(*bytes));
    const auto& shape = positions.shape();
    if (shape.size() != 3 || shape[2] != 3)
        positions.fail("the shape " + text_of(shape), "strands x points x 3");
    if (shape[0] == 0 || shape[1] == 0)
        positions.fail("the shape " + text_of(shape), "one strand of one point or more");
    StrandFile out;
    out.points.assign(shape[0], std::vector<Vec3d>(shape[1]));
    size_t next = 0;
    for (size_t s = 0; s < shape[0]; ++s)
        for (size_t i = 0; i < shape[1]; ++i) {
            Vec3d& x = out.points[s][i];
            for (double* c : {&x.x, &x.y, &x.z}) *c = positions.at(next++);
            require_sane(file, x, s, i);
        }
    if (auto uv_bytes = archive.entry("root_uv.npy")) {
        const Array uv(path + ": root_uv", std::move(*uv_bytes));
        if (uv.shape() != std::vector<size_t>{shape[0], 2})
            uv.fail("the shape " + text_of(uv.shape()), std::to_string(shape[0]) + " x 2");
        for (size_t s = 0; s < shape[0]; ++s)
            out.root_uv.push_back({float(uv.at(2 * s)), float(uv.at(2 * s + 1))});
    }
    return out;
}

#else

StrandFile read_npz(const std::string& path) {
    throw Error(path +
                ": this wetcurl was built without libzip, which reads .npz files: install libzip-dev and "
                "configure again, or convert the file");
}

#endif

}  // namespace wetcurl

// Checked reading of whole files.
#include "solver/grooms/byte_reader.h"

#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "base/lfs_pointer.h"

namespace wetcurl {

static std::string bytes_of(const std::string& path) {
    if (!std::filesystem::exists(path)) throw Error(path + ": found no such file");
    if (!std::filesystem::is_regular_file(path)) throw Error(path + ": found no plain file");
    std::ifstream in(path, std::ios::binary);
    if (!in) throw Error(path + ": found a file that cannot be opened for reading");
    std::string bytes(size_t(std::filesystem::file_size(path)), '\0');
    in.read(bytes.data(), std::streamsize(bytes.size()));
    if (size_t(in.gcount()) != bytes.size())
        throw Error(path + ": found a file that cannot be read to its end");
    if (bytes.empty()) throw Error(path + ": found an empty file");
    refuse_lfs_pointer(bytes, path);
    return bytes;
}

ByteReader::ByteReader(const std::string& path) : path_(path), bytes_(bytes_of(path)) {}

void ByteReader::fail(const std::string& found, const std::string& allowed) const {
    fail_at("byte " + std::to_string(at_), found, allowed);
}

void ByteReader::fail_at(const std::string& where, const std::string& found,
                         const std::string& allowed) const {
    throw Error(path_ + ": " + where + ": found " + found + ", allowed " + allowed);
}

void ByteReader::need(size_t bytes, const char* what) const {
    if (left() < bytes)
        fail(std::to_string(left()) + " bytes left (cut short?)",
             std::to_string(bytes) + " or more for " + what);
}

size_t ByteReader::fitting(long long found, size_t bytes_each, const char* what) const {
    const size_t most = left() / bytes_each;
    if (found < 0 || size_t(found) > most)
        fail(std::to_string(found) + " " + what,
             "0 to " + std::to_string(most) + ", which is what the rest of the file can hold");
    return size_t(found);
}

void require_sane(const ByteReader& reader, const Vec3d& x, size_t strand, size_t point) {
    for (double c : {x.x, x.y, x.z})
        if (!(std::abs(c) < 1e6))
            reader.fail_at("strand " + std::to_string(strand) + ", point " + std::to_string(point),
                           "the coordinate " + std::to_string(c), "finite numbers below 1e6 in size");
}

Vec3d ByteReader::point(size_t strand, size_t point) {
    const double x = take<float>("a point"), y = take<float>("a point"), z = take<float>("a point");
    require_sane(*this, {x, y, z}, strand, point);
    return {x, y, z};
}

void ByteReader::skip(size_t bytes, const char* what) {
    need(bytes, what);
    at_ += bytes;
}

void ByteReader::seek(size_t offset, const char* what) {
    if (offset > bytes_.size())
        fail("offset " + std::to_string(offset) + " of " + what, "at most " + std::to_string(bytes_.size()));
    at_ = offset;
}

std::string_view ByteReader::line(const char* what) {
    const size_t end = bytes_.find('\n', at_);
    if (end == std::string::npos) fail("the end of the file", std::string("a line of ") + what);
    std::string_view text(bytes_.data() + at_, end - at_);
    at_ = end + 1;
    if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
    return text;
}

std::string_view ByteReader::last_line() {
    if (bytes_.find('\n', at_) != std::string::npos) return line("");
    const std::string_view text(bytes_.data() + at_, left());
    at_ = bytes_.size();
    return text;
}

std::string_view ByteReader::token(const char* what) {
    constexpr const char* blank = " \t\r\n";
    const size_t start = bytes_.find_first_not_of(blank, at_);
    if (start == std::string::npos) fail("the end of the file (cut short?)", what);
    at_ = std::min(bytes_.find_first_of(blank, start), bytes_.size());
    return std::string_view(bytes_).substr(start, at_ - start);
}

void ByteReader::finish() const {
    if (bytes_.find_first_not_of(std::string_view(" \t\r\n"), at_) != std::string::npos)
        fail(std::to_string(left()) + " bytes after the last strand", "none");
}

}  // namespace wetcurl

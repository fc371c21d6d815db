// A whole file in memory, read from its start with every access checked: no reader of strands can run past
// the end, and each complaint names the file, the byte, what was found and what is allowed.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "base/vec3.h"

namespace wetcurl {

class ByteReader {
  public:
    // Throws Error where the file is missing, empty or no plain file.
    explicit ByteReader(const std::string& path);

    // The next little-endian number; `what` names it in a complaint.
    template <class T>
    T take(const char* what) {
        need(sizeof(T), what);
        T value;
        std::memcpy(&value, bytes_.data() + at_, sizeof(T));
        at_ += sizeof(T);
        return value;
    }
    // Checks that `found` things of `bytes_each` bytes can lie in the rest of the file.
    size_t fitting(long long found, size_t bytes_each, const char* what) const;
    // Three floats; throws Error naming the strand and the point unless all are finite and below 1e6 in size.
    Vec3d point(size_t strand, size_t point);

    void skip(size_t bytes, const char* what);
    void seek(size_t offset, const char* what);
    std::string_view line(const char* what);   // up to the next '\n', which is taken but not given
    std::string_view last_line();              // the same, or all that is left where no '\n' comes
    std::string_view token(const char* what);  // up to the next white space, leading white space skipped
    size_t at() const { return at_; }
    size_t left() const { return bytes_.size() - at_; }
    // Throws Error where bytes are left over: the file is not what its counts say.
    void finish() const;
    [[noreturn]] void fail(const std::string& found, const std::string& allowed) const;
    [[noreturn]] void fail_at(const std::string& where, const std::string& found,
                              const std::string& allowed) const;

  private:
    void need(size_t bytes, const char* what) const;
    std::string path_, bytes_;
    size_t at_ = 0;
};

// Throws Error (through `reader`) unless the coordinates are finite and below 1e6 in size.
void require_sane(const ByteReader& reader, const Vec3d& x, size_t strand, size_t point);

}  // namespace wetcurl

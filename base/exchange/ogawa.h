// Ogawa, the container of Alembic files: blocks of bytes, and groups that list blocks and other groups by
// where they lie. Layout (little-endian):
//   file    "Ogawa", 255 once the file is whole and 0 before, version 0 1 (2 bytes), place of the root group
//           (8 bytes), then blocks and groups in any order
//   block   size (8 bytes), bytes
//   group   number of children (8 bytes), 8 bytes a child: its place; the top bit marks a block
// Place 0 is the empty block or group, which is not stored.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <initializer_list>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/output_file.h"

namespace wetcurl {

// A child of a group, as groups list it.
struct OgawaChild {
    static constexpr uint64_t block_bit = uint64_t(1) << 63;
    uint64_t bits = 0;  // the empty group
    bool is_block() const { return bits & block_bit; }
    uint64_t place() const { return bits & ~block_bit; }  // [bytes] from the start of the file
    static OgawaChild empty_block() { return {block_bit}; }
};

// MurmurHash3 (x64, 128 bits, seed 0; Appleby), by which Alembic knows equal arrays.
using OgawaKey = std::array<uint64_t, 2>;
OgawaKey ogawa_key(std::string_view bytes);

// Writes a file from front to end: nothing stays in memory but a key and a place for each different block
// that was written by `keyed`.
class OgawaWriter {
  public:
    // Throws as OutputFile does.
    OgawaWriter(const std::string& path, bool overwrite);

    // A block. Throws Error where it cannot be written, as all that follow.
    OgawaChild block(std::string_view bytes);
    // A block of the key of `bytes` and `bytes`, where none like it has been written; else the one before.
    // No bytes: the empty block.
    OgawaChild keyed(const OgawaKey& key, std::string_view bytes);
    // A group, after its children. No children: the empty group.
    OgawaChild group(const std::vector<OgawaChild>& children);
    // The file is whole, and has its name.
    void finish(OgawaChild root);

    const std::string& path() const { return file_.path(); }

  private:
    void write(std::string_view bytes);
    [[noreturn]] void fail() const;
    OutputFile file_;
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream_;
    uint64_t end_ = 0;  // [bytes] written
    std::map<std::pair<OgawaKey, size_t>, OgawaChild> written_;
};

// Reads a file at any place, with every place and size checked against the file: no more is allocated than
// the file holds. Each Error names the file, what was found and what is allowed.
class OgawaReader {
  public:
    // Throws Error where the file is missing, no plain file, a Git LFS pointer, an Alembic file in HDF5, no
    // Ogawa, or one that its writer did not finish.
    explicit OgawaReader(const std::string& path);
    OgawaReader(const OgawaReader&) = delete;
    ~OgawaReader();

    struct Group {
        uint64_t place = 0, children = 0;
    };
    // Throw Error, which names `where`, for a child of the other kind, or one that does not lie in the file.
    Group root() const;
    Group group(OgawaChild child, const std::string& where) const;
    OgawaChild child(const Group& group, uint64_t index, const std::string& where) const;
    uint64_t size(OgawaChild block, const std::string& where) const;  // [bytes]
    // `bytes` of a block, from its byte `from` on.
    void read(OgawaChild block, uint64_t from, void* to, uint64_t bytes, const std::string& where) const;
    std::string bytes(OgawaChild block, const std::string& where) const;  // all

    // Throws Error "PATH: WHERE: found FOUND, allowed ALLOWED".
    [[noreturn]] void fail(const std::string& where, const std::string& found,
                           const std::string& allowed) const;
    const std::string& path() const { return path_; }

  private:
    void read_at(uint64_t place, void* to, uint64_t bytes, const std::string& where) const;
    std::string path_;
    uint64_t size_ = 0;  // [bytes] of the file
    int descriptor_ = -1;
};

}  // namespace wetcurl

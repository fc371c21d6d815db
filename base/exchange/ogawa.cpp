// Ogawa, the container of Alembic files.
#include "base/exchange/ogawa.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <cstring>

#include "base/lfs_pointer.h"

namespace wetcurl {

static_assert(std::endian::native == std::endian::little, "the file is written as memory holds it");

namespace {

constexpr std::string_view magic = "Ogawa";
constexpr size_t header_bytes = 16, frozen_at = 5, version_at = 6, root_at = 8;
constexpr char frozen = char(0xff);

std::string_view bytes_of(const uint64_t& number) {
    return {reinterpret_cast<const char*>(&number), sizeof number};
}

uint64_t number_at(const char* bytes) {
    uint64_t number;
    std::memcpy(&number, bytes, sizeof number);
    return number;
}

uint64_t mixed(uint64_t h) {
    h = (h ^ (h >> 33)) * 0xff51afd7ed558ccdu;
    h = (h ^ (h >> 33)) * 0xc4ceb9fe1a85ec53u;
    return h ^ (h >> 33);
}

}  // namespace

OgawaKey ogawa_key(std::string_view bytes) {
    constexpr uint64_t c1 = 0x87c37b91114253d5u, c2 = 0x4cf5ad432745937fu;
    const auto first = [](uint64_t k) { return std::rotl(k * c1, 31) * c2; };
    const auto second = [](uint64_t k) { return std::rotl(k * c2, 33) * c1; };
    uint64_t h1 = 0, h2 = 0;
    const size_t whole = bytes.size() / 16 * 16;
    for (size_t i = 0; i < whole; i += 16) {
        h1 = (std::rotl(h1 ^ first(number_at(bytes.data() + i)), 27) + h2) * 5 + 0x52dce729;
        h2 = (std::rotl(h2 ^ second(number_at(bytes.data() + i + 8)), 31) + h1) * 5 + 0x38495ab5;
    }
    char rest[16] = {};
    if (bytes.size() > whole) std::memcpy(rest, bytes.data() + whole, bytes.size() - whole);
    h2 ^= second(number_at(rest + 8)), h1 ^= first(number_at(rest));
    h1 ^= bytes.size(), h2 ^= bytes.size();
    h1 += h2, h2 += h1;
    h1 = mixed(h1), h2 = mixed(h2);
    h1 += h2, h2 += h1;
    return {h1, h2};
}

OgawaWriter::OgawaWriter(const std::string& path, bool overwrite)
    : file_(path, overwrite), stream_(nullptr, std::fclose) {
    file_.begin();
    stream_.reset(std::fopen(file_.partial().c_str(), "wbe"));
    if (!stream_) fail();
    std::string header(magic);
    header += std::string("\0\0\1", 3) + std::string(8, '\0');
    write(header);
}

void OgawaWriter::fail() const { throw Error(path() + ": cannot be written: " + std::strerror(errno)); }

void OgawaWriter::write(std::string_view bytes) {
    if (std::fwrite(bytes.data(), 1, bytes.size(), stream_.get()) != bytes.size()) fail();
    end_ += bytes.size();
}

OgawaChild OgawaWriter::block(std::string_view bytes) {
    if (bytes.empty()) return OgawaChild::empty_block();
    const OgawaChild child{end_ | OgawaChild::block_bit};
    write(bytes_of(bytes.size()));
    write(bytes);
    return child;
}

OgawaChild OgawaWriter::keyed(const OgawaKey& key, std::string_view bytes) {
    if (bytes.empty()) return OgawaChild::empty_block();
    const auto [at, is_new] =
        written_.try_emplace({key, bytes.size()}, OgawaChild{end_ | OgawaChild::block_bit});
    if (is_new) {
        write(bytes_of(sizeof key + bytes.size()));
        write(bytes_of(key[0])), write(bytes_of(key[1]));
        write(bytes);
    }
    return at->second;
}

OgawaChild OgawaWriter::group(const std::vector<OgawaChild>& children) {
    if (children.empty()) return {};
    const OgawaChild child{end_};
    write(bytes_of(children.size()));
    for (const OgawaChild& c : children) write(bytes_of(c.bits));
    return child;
}

void OgawaWriter::finish(OgawaChild root) {
    const auto put = [&](long at, std::string_view bytes) {
        if (std::fseek(stream_.get(), at, SEEK_SET) != 0) fail();
        write(bytes);
    };
    put(root_at, bytes_of(root.bits));
    put(frozen_at, {&frozen, 1});
    if (std::fclose(stream_.release()) != 0) fail();
    file_.commit();
}

OgawaReader::OgawaReader(const std::string& path) : path_(path) {
    struct stat found;
    if (stat(path.c_str(), &found) != 0) throw Error(path + ": found no such file");
    if (!S_ISREG(found.st_mode)) throw Error(path + ": found no plain file");
    descriptor_ = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor_ < 0) throw Error(path + ": cannot be read: " + std::strerror(errno));
    try {
        size_ = uint64_t(found.st_size);
        refuse_lfs_pointer(path);
        char header[header_bytes] = {};
        read_at(0, header, std::min<uint64_t>(size_, header_bytes), "header");
        const std::string_view start(header, header_bytes);
        if (start.starts_with("\x89HDF"))
            throw Error(path +
                        ": found an Alembic file in HDF5, allowed is Ogawa; `abcconvert -toOgawa OLD.abc "
                        "NEW.abc`, which comes with Alembic, converts it");
        if (size_ < header_bytes || !start.starts_with(magic))
            fail("start", size_ == 0 ? "an empty file" : "other bytes", "\"Ogawa\", as Alembic files begin");
        if (start[frozen_at] != frozen)
            fail("byte " + std::to_string(frozen_at), "no mark of a whole file: its writer ended early",
                 "a file that was closed; write it again");
        if (start[version_at] != 0 || start[version_at + 1] != 1)
            fail("byte " + std::to_string(version_at), "another version of Ogawa", "version 1");
    } catch (...) {
        close(descriptor_);
        throw;
    }
}

OgawaReader::~OgawaReader() { close(descriptor_); }

void OgawaReader::fail(const std::string& where, const std::string& found, const std::string& allowed) const {
    throw Error(path_ + ": " + where + ": found " + found + ", allowed " + allowed);
}

void OgawaReader::read_at(uint64_t place, void* to, uint64_t bytes, const std::string& where) const {
    if (place > size_ || bytes > size_ - place)
        fail(where, std::to_string(bytes) + " bytes at byte " + std::to_string(place),
             "what lies in the " + std::to_string(size_) + " bytes of the file (cut short?)");
    for (uint64_t done = 0; done < bytes;) {
        const ssize_t n =
            pread(descriptor_, static_cast<char*>(to) + done, size_t(bytes - done), off_t(place + done));
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) throw Error(path_ + ": cannot be read: " + std::strerror(errno));
        if (n == 0) fail(where, "the end of the file, which grew shorter meanwhile", "a file that stays");
        done += uint64_t(n);
    }
}

OgawaReader::Group OgawaReader::root() const {
    OgawaChild child;
    read_at(root_at, &child.bits, sizeof child.bits, "header");
    return group(child, "root group");
}

OgawaReader::Group OgawaReader::group(OgawaChild child, const std::string& where) const {
    if (child.is_block()) fail(where, "a block of bytes", "a group");
    Group group{child.place(), 0};
    if (group.place == 0) return group;
    read_at(group.place, &group.children, sizeof group.children, where);
    const uint64_t most = (size_ - group.place - sizeof group.children) / sizeof(OgawaChild);
    if (group.children > most)
        fail(
            where, "a group of " + std::to_string(group.children) + " at byte " + std::to_string(group.place),
            "at most " + std::to_string(most) + ", which is what the rest of the file can hold (cut short?)");
    return group;
}

OgawaChild OgawaReader::child(const Group& group, uint64_t index, const std::string& where) const {
    if (index >= group.children)
        fail(where, "no child " + std::to_string(index), std::to_string(group.children) + " children here");
    OgawaChild child;
    read_at(group.place + 8 * (1 + index), &child.bits, sizeof child.bits, where);
    return child;
}

uint64_t OgawaReader::size(OgawaChild block, const std::string& where) const {
    if (!block.is_block()) fail(where, "a group", "a block of bytes");
    if (block.place() == 0) return 0;
    uint64_t size = 0;
    read_at(block.place(), &size, sizeof size, where);
    const uint64_t most = size_ - block.place() - sizeof size;
    if (size > most)
        fail(where, "a block of " + std::to_string(size) + " bytes at byte " + std::to_string(block.place()),
             "at most " + std::to_string(most) + ", which is the rest of the file (cut short?)");
    return size;
}

void OgawaReader::read(OgawaChild block, uint64_t from, void* to, uint64_t bytes,
                       const std::string& where) const {
    const uint64_t there = size(block, where);
    if (from > there || bytes > there - from)
        fail(where, "a block of " + std::to_string(there) + " bytes",
             std::to_string(from + bytes) + " or more");
    if (bytes > 0) read_at(block.place() + sizeof there + from, to, bytes, where);
}

std::string OgawaReader::bytes(OgawaChild block, const std::string& where) const {
    std::string out(size(block, where), '\0');
    read(block, 0, out.data(), out.size(), where);
    return out;
}

}  // namespace wetcurl

// Strands of .obj files: `v` and `l` lines (Wavefront). Everything else is passed over.
#include <charconv>
#include <cstdint>
#include <map>

#include "base/error.h"
#include "solver/grooms/byte_reader.h"
#include "solver/grooms/chains.h"
#include "solver/grooms/readers.h"

namespace wetcurl {
namespace {

constexpr std::string_view blanks = " \t\r\v\f";

// Takes the next word of `line`; "" at its end.
std::string_view next_word(std::string_view& line) {
    const size_t from = std::min(line.find_first_not_of(blanks), line.size());
    const size_t to = std::min(line.find_first_of(blanks, from), line.size());
    const std::string_view word = line.substr(from, to - from);
    line.remove_prefix(to);
    return word;
}

class Lines {
  public:
    explicit Lines(ByteReader& in) : in_(in) {}
    // A line with those that a '\' at its end joins to it; without the zeros that some programs leave at the
    // end.
    bool next(std::string& line) {
        line.clear();
        first_ = number_ + 1;
        while (in_.left() > 0) {
            line += in_.last_line();
            // Some programs mark UTF-8 so.
            if (++number_ == 1 && line.starts_with("\xef\xbb\xbf")) line.erase(0, 3);
            while (!line.empty() && line.back() == '\0') line.pop_back();
            if (line.empty() || line.back() != '\\') return true;
            line.back() = ' ';
        }
        return !line.empty();
    }
    [[noreturn]] void fail(const std::string& found, const std::string& allowed) const {
        in_.fail_at("line " + std::to_string(first_), found, allowed);
    }

  private:
    ByteReader& in_;
    size_t number_ = 0, first_ = 0;
};

std::string shown(std::string_view text) {
    std::string out(text.substr(0, 40));
    for (char& c : out)
        if (c < 32 || c > 126) c = '?';
    return "'" + out + "'";
}

double coordinate(const Lines& lines, std::string_view word) {
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !(std::abs(value) < 1e6))
        lines.fail(shown(word), "coordinates: numbers below 1e6 in size");
    return value;
}

// Of "7", "-1" or "7/3": counted from 1, or back from the last vertex so far.
size_t vertex_of(const Lines& lines, std::string_view word, size_t vertices) {
    const std::string_view text = word.substr(0, word.find('/'));
    long long index = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
    const long long count = (long long)(vertices), from_0 = index < 0 ? count + index : index - 1;
    if (error != std::errc() || end != text.data() + text.size() || from_0 < 0 || from_0 >= count)
        lines.fail("the vertex " + shown(word),
                   "1 to " + std::to_string(count) + ", or -1 back to -" + std::to_string(count) +
                       (error == std::errc() && index == 0
                            ? "; a file that counts from 0 needs 1 more in each `l` line"
                            : ""));
    return size_t(from_0);
}

// Edges that each have two vertices of their own, as some programs write strands: those in the same place as
// one; the lines as they are where they are longer, or strands would branch then.
std::vector<std::vector<size_t>> welded(const std::vector<std::vector<size_t>>& lines,
                                        const std::vector<Vec3d>& vertices) {
    std::map<std::array<double, 3>, size_t> first;
    std::vector<int> ends(vertices.size(), 0);
    std::vector<std::vector<size_t>> out = lines;
    for (auto& line : out) {
        if (line.size() != 2) return lines;
        for (size_t& vertex : line) {
            const Vec3d& x = vertices[vertex];
            vertex = first.try_emplace({x.x, x.y, x.z}, vertex).first->second;
            if (++ends[vertex] > 2) return lines;
        }
        if (line[0] == line[1]) return lines;
    }
    return out;
}

// Lines that share no vertex are strands as they stand; those that do, as where each edge has a line of its
// own, are joined.
std::vector<std::vector<size_t>> strands_of(const std::vector<std::vector<size_t>>& lines, size_t vertices,
                                            const std::string& path) {
    std::vector<bool> is_used(vertices, false);
    bool is_shared = false;
    for (const auto& line : lines)
        for (size_t vertex : line) {
            is_shared = is_shared || is_used[vertex];
            is_used[vertex] = true;
        }
    if (!is_shared) return lines;
    std::vector<std::array<size_t, 2>> edges;
    for (const auto& line : lines)
        for (size_t i = 1; i < line.size(); ++i) edges.push_back({line[i - 1], line[i]});
    std::vector<std::vector<size_t>> strands;
    for (auto& chain : chains_of(edges, vertices, path))
        if (is_used[chain[0]]) strands.push_back(std::move(chain));  // others belong to faces, or to nothing
    return strands;
}

}  // namespace

StrandFile read_obj(const std::string& path) {
    ByteReader in(path);
    Lines lines(in);
    std::vector<Vec3d> vertices;
    std::vector<std::vector<size_t>> polylines;
    size_t faces = 0;
    for (std::string text; lines.next(text);) {
        std::string_view line = text;
        const std::string_view kind = next_word(line);
        if (kind == "v") {
            Vec3d& x = vertices.emplace_back();
            for (double* c : {&x.x, &x.y, &x.z}) *c = coordinate(lines, next_word(line));
        } else if (kind == "l") {
            auto& polyline = polylines.emplace_back();
            for (auto word = next_word(line); !word.empty(); word = next_word(line))
                polyline.push_back(vertex_of(lines, word, vertices.size()));
            if (polyline.size() > 2 && polyline.front() == polyline.back())
                lines.fail("a closed line, which ends at its first vertex",
                           "strands with two ends; without that "
                           "vertex at its end it is one");
        } else if (kind == "f") {
            ++faces;
        }
    }
    if (polylines.empty())
        throw Error(path + ": found " +
                    (faces ? std::to_string(faces) + " faces and no `l` line: a mesh, not strands"
                           : std::string("no `l` line")) +
                    ", allowed are strands as `l` lines");
    StrandFile out;
    for (const auto& strand : strands_of(welded(polylines, vertices), vertices.size(), path)) {
        auto& points = out.points.emplace_back();
        for (size_t vertex : strand) points.push_back(vertices[vertex]);
    }
    return out;
}

}  // namespace wetcurl

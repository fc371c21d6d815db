// The text of a .usda file, taken apart: a scanner that walks over a file of any size with a small buffer,
// and arrays of numbers, read from where the scanner found them. Grammar: "USDA File Format Specification",
// Pixar.
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace wetcurl {

// A file that is read piece by piece.
class TextFile {
  public:
    // Throws Error where it is missing, no plain file, or cannot be opened.
    explicit TextFile(const std::string& path);
    ~TextFile();
    TextFile(const TextFile&) = delete;
    TextFile& operator=(const TextFile&) = delete;

    const std::string& path() const { return path_; }
    size_t size() const { return size_; }  // [bytes], when it was opened
    // Up to `count` bytes from `offset`: fewer at the end of the file.
    size_t read(size_t offset, char* to, size_t count) const;
    // All of these bytes; throws Error where the file has become shorter.
    std::string text(size_t offset, size_t count) const;
    [[noreturn]] void fail(size_t line, const std::string& found, const std::string& expected) const;

  private:
    std::string path_;
    int descriptor_ = -1;
    size_t size_ = 0;
};

// Where a value stands.
struct TextSpan {
    size_t begin = 0, count = 0;  // [bytes]
    size_t line = 0;              // of its first byte, from 1
};

// Walks over the file once. Every function that skips or takes begins by skipping blanks and comments; where
// something else stands there, it throws Error with the line.
class UsdaScanner {
  public:
    explicit UsdaScanner(const TextFile& file) : file_(file), buffer_(buffer_size, '\0') {}

    bool at_end() { return next() < 0; }
    // The next byte that is no blank, or -1; it stays.
    int next();
    bool next_is(char c) { return next() == (unsigned char)(c); }
    bool take_if(char c);
    void expect(char c, const char* what);
    bool next_is_quote() { return next_is('"') || next_is('\''); }
    bool next_is_word();
    // A name or keyword: letters, digits, '_', and ':' between namespaces.
    std::string word(const char* what);
    // The text between quotes, single or triple, without its escapes.
    std::string quoted(const char* what);
    // A number, a word or a quoted text, as text.
    std::string scalar(const char* what);
    // Any value: number, word, text, @asset@, <path>, or anything in brackets.
    void skip_value();
    // The same, and where it stood.
    TextSpan value();
    // The rest of the line.
    std::string line_text();
    size_t line() const { return line_; }
    [[noreturn]] void fail(const std::string& expected);

  private:
    static constexpr size_t buffer_size = size_t(1) << 18;
    size_t offset() const { return base_ + at_; }
    int peek(size_t ahead = 0);
    void step() {
        if (buffer_[at_] == '\n') ++line_;
        ++at_;
    }
    bool fill(size_t wanted);
    void skip_comment();
    void skip_brackets();
    // Walks behind the closing quotes; what lies between them goes to `kept`, where it is given.
    void skip_quoted(std::string* kept);
    void skip_asset();
    void skip_path();

    const TextFile& file_;
    std::string buffer_;
    size_t base_ = 0, at_ = 0,
           end_ = 0;  // of the buffer in the file; the next byte and the end, in the buffer
    size_t line_ = 1;
};

// The values of an array or tuple whose text is in memory.
class UsdaValues {
  public:
    UsdaValues(const TextFile& file, const TextSpan& span)
        : file_(file),
          line_(span.line),
          text_(file.text(span.begin, span.count)),
          at_(text_.data()),
          end_(at_ + text_.size()) {}

    // [a, b, ...]; whole numbers where T is an integer. Throw Error for what is no such array, with the line,
    // and for numbers that are not finite.
    template <class T>
    std::vector<T> numbers();
    // [(a, b, ...), ...]
    template <class T, size_t N>
    std::vector<std::array<T, N>> tuples();
    // All numbers of one value, brackets of any kind left aside: "1", "(1, 2, 3)", "((1, 0), (0, 1))".
    std::vector<double> flat();
    // ["a", "b", ...]
    std::vector<std::string> strings();
    // "a"
    std::string string();
    [[noreturn]] void fail(const std::string& expected) const;

  private:
    void blank();
    bool take_if(char c) {
        blank();
        if (at_ == end_ || *at_ != c) return false;
        ++at_;
        return true;
    }
    void expect(char c, const char* what) {
        if (!take_if(c)) fail(what);
    }
    template <class T>
    T number();
    // Calls item() for each of a list.
    template <class Item>
    void list(Item item);
    void finish();

    const TextFile& file_;
    size_t line_;
    std::string text_;
    const char *at_, *end_;
};

// ---- of the arrays, in the header for their many types

inline void UsdaValues::blank() {
    for (; at_ != end_; ++at_) {
        const char c = *at_;
        if (c == ' ' || c == '\n' || c == '\t' || c == '\r') continue;
        if (c != '#') return;
        while (at_ != end_ && *at_ != '\n') ++at_;
        if (at_ == end_) return;
    }
}

template <class T>
T UsdaValues::number() {
    constexpr const char* what = std::is_integral_v<T> ? "a whole number" : "a number";
    blank();
    const char* from = at_;
    if (from != end_ && *from == '+') ++from;
    T value{};
    auto [to, error] = std::from_chars(from, end_, value);
    if constexpr (std::is_floating_point_v<T>) {
        // Too small for the type, or too large: the wider type tells which.
        if (error == std::errc::result_out_of_range) {
            double wide = std::numeric_limits<double>::infinity();
            const auto again = std::from_chars(from, end_, wide);
            value = again.ec == std::errc() && std::abs(wide) < 1 ? T(0) : std::numeric_limits<T>::infinity();
            error = {};
        }
        if (error == std::errc() && !std::isfinite(value)) fail("a finite number");
    }
    if (error != std::errc()) fail(what);
    at_ = to;
    return value;
}

template <class Item>
void UsdaValues::list(Item item) {
    expect('[', "'['");
    while (!take_if(']')) {
        item();
        if (take_if(',')) continue;
        expect(']', "',' or ']'");
        break;
    }
    finish();
}

template <class T>
std::vector<T> UsdaValues::numbers() {
    std::vector<T> out;
    list([&] { out.push_back(number<T>()); });
    return out;
}

template <class T, size_t N>
std::vector<std::array<T, N>> UsdaValues::tuples() {
    std::vector<std::array<T, N>> out;
    list([&] {
        expect('(', "'('");
        auto& tuple = out.emplace_back();
        for (size_t k = 0; k < N; ++k) {
            if (k) expect(',', "','");
            tuple[k] = number<T>();
        }
        expect(')', "')'");
    });
    return out;
}

}  // namespace wetcurl

// Taking the text of .usda files apart.
#include "base/exchange/usda_text.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "base/error.h"

namespace wetcurl {
namespace {

bool is_blank(int c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; }
bool is_word_start(int c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c >= 0x80;
}
bool is_word_part(int c) { return is_word_start(c) || (c >= '0' && c <= '9') || c == ':'; }
bool is_number_part(int c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '+' ||
           c == '-' || c == '.' || c == '_';
}

// What was found, fit for a message.
std::string shown(std::string_view found) {
    constexpr size_t most = 24;
    if (found.empty()) return "the end of the file (cut short?)";
    std::string text(found.substr(0, std::min(most, found.find('\n'))));
    for (char& c : text)
        if (c < 32 || c > 126) c = '?';
    return "'" + text + "'";
}

}  // namespace

TextFile::TextFile(const std::string& path) : path_(path) {
    descriptor_ = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor_ < 0)
        throw Error(path + (errno == ENOENT ? ": found no such file"
                                            : std::string(": cannot be opened: ") + std::strerror(errno)));
    struct stat file;
    const bool plain = fstat(descriptor_, &file) == 0 && S_ISREG(file.st_mode);
    if (plain && file.st_size > 0) {
        size_ = size_t(file.st_size);
        return;
    }
    close(descriptor_);
    throw Error(path + (plain ? ": found an empty file" : ": found no plain file"));
}

TextFile::~TextFile() { close(descriptor_); }

size_t TextFile::read(size_t offset, char* to, size_t count) const {
    size_t done = 0;
    while (done < count) {
        const ssize_t taken = pread(descriptor_, to + done, count - done, off_t(offset + done));
        if (taken < 0 && errno == EINTR) continue;
        if (taken < 0) throw Error(path_ + ": cannot be read: " + std::strerror(errno));
        if (taken == 0) break;
        done += size_t(taken);
    }
    return done;
}

std::string TextFile::text(size_t offset, size_t count) const {
    std::string text(count, '\0');
    if (read(offset, text.data(), count) != count)
        throw Error(path_ + ": found that it became shorter while it was read; read it when it is whole");
    return text;
}

void TextFile::fail(size_t line, const std::string& found, const std::string& expected) const {
    throw Error(path_ + ":" + std::to_string(line) + ": found " + found + ", expected " + expected);
}

// ---- scanner

// Moves what is left of the buffer to its front and reads on; whether `wanted` bytes are there.
bool UsdaScanner::fill(size_t wanted) {
    const size_t left = end_ - at_;
    if (base_ + end_ >= file_.size()) return left >= wanted;
    std::memmove(buffer_.data(), buffer_.data() + at_, left);
    base_ += at_;
    at_ = 0;
    end_ = left + file_.read(base_ + left, buffer_.data() + left, buffer_size - left);
    return end_ >= wanted;
}

int UsdaScanner::peek(size_t ahead) {
    if (at_ + ahead >= end_ && !fill(ahead + 1)) return -1;
    return (unsigned char)(buffer_[at_ + ahead]);
}

void UsdaScanner::fail(const std::string& expected) {
    if (end_ - at_ < 64) fill(64);
    file_.fail(line_, shown(std::string_view(buffer_).substr(at_, end_ - at_)), expected);
}

void UsdaScanner::skip_comment() {
    if (peek() == '#' || peek(1) == '/') {
        while (peek() >= 0 && peek() != '\n') step();
        return;
    }
    step(), step();
    while (!(peek() == '*' && peek(1) == '/')) {
        if (peek() < 0) fail("'*/', which ends a comment");
        step();
    }
    step(), step();
}

int UsdaScanner::next() {
    for (;;) {
        const int c = peek();
        if (is_blank(c))
            step();
        else if (c == '#' || (c == '/' && (peek(1) == '/' || peek(1) == '*')))
            skip_comment();
        else
            return c;
    }
}

bool UsdaScanner::take_if(char c) {
    if (!next_is(c)) return false;
    step();
    return true;
}

void UsdaScanner::expect(char c, const char* what) {
    if (!take_if(c)) fail(std::string("'") + c + "' " + what);
}

bool UsdaScanner::next_is_word() { return is_word_start(next()); }

constexpr size_t longest_name = 4096;

std::string UsdaScanner::word(const char* what) {
    if (!next_is_word()) fail(what);
    std::string word;
    for (int c = peek(); is_word_part(c); c = peek()) {
        if (word.size() == longest_name) fail("a name of at most 4096 letters");
        word += char(c);
        step();
    }
    return word;
}

void UsdaScanner::skip_quoted(std::string* kept) {
    const int quote = peek();
    const bool triple = peek(1) == quote && peek(2) == quote;
    const size_t from = line_;
    for (int k = 0; k < (triple ? 3 : 1); ++k) step();
    auto keep = [&](int c) {
        if (!kept) return;
        if (kept->size() == longest_name) fail("a text of at most 4096 letters");
        *kept += char(c);
    };
    for (;;) {
        const int c = peek();
        if (c < 0 || (c == '\n' && !triple))
            fail(std::string("the quotes that end the text which begins in line ") + std::to_string(from));
        if (c == quote && (!triple || (peek(1) == quote && peek(2) == quote))) break;
        if (c == '\\' && peek(1) >= 0) step();
        keep(peek());
        step();
    }
    for (int k = 0; k < (triple ? 3 : 1); ++k) step();
}

std::string UsdaScanner::quoted(const char* what) {
    if (!next_is_quote()) fail(what);
    std::string text;
    skip_quoted(&text);
    return text;
}

std::string UsdaScanner::scalar(const char* what) {
    if (next_is_quote()) return quoted(what);
    std::string text;
    for (int c = next(); is_number_part(c); c = peek()) {
        if (text.size() == longest_name) fail(what);
        text += char(c);
        step();
    }
    if (text.empty()) fail(what);
    return text;
}

void UsdaScanner::skip_asset() {
    const bool triple = peek(1) == '@' && peek(2) == '@';
    for (int k = 0; k < (triple ? 3 : 1); ++k) step();
    for (;;) {
        const int c = peek();
        if (c < 0 || c == '\n') fail("'@', which ends the name of a file, in its line");
        if (c == '\\' && triple && peek(1) == '@') {
            // Of an escaped "@@@".
            for (int k = 0; k < 4 && peek() >= 0; ++k) step();
        } else if (c == '@' && (!triple || (peek(1) == '@' && peek(2) == '@'))) {
            break;
        } else {
            step();
        }
    }
    for (int k = 0; k < (triple ? 3 : 1); ++k) step();
}

void UsdaScanner::skip_path() {
    while (peek() != '>') {
        if (peek() < 0 || peek() == '\n') fail("'>', which ends a path, in its line");
        step();
    }
    step();
}

// Bytes that mean nothing to whoever looks for the bracket that closes.
static constexpr auto means_nothing = [] {
    std::array<bool, 256> table{};
    for (bool& entry : table) entry = true;
    for (unsigned char c : std::string_view("()[]{}\"'@<#/\n")) table[c] = false;
    return table;
}();

void UsdaScanner::skip_brackets() {
    constexpr size_t deepest = 200;
    std::string closing;  // the brackets that must still come, the next one last
    do {
        while (at_ < end_ && means_nothing[(unsigned char)(buffer_[at_])]) ++at_;
        const int c = peek();
        switch (c) {
            case -1:
                fail(std::string("'") + closing.back() + "'");
            case '(':
            case '[':
            case '{':
                if (closing.size() == deepest) fail("at most 200 brackets inside each other");
                closing += c == '(' ? ')' : c == '[' ? ']' : '}';
                step();
                break;
            case ')':
            case ']':
            case '}':
                if (c != closing.back()) fail(std::string("'") + closing.back() + "'");
                closing.pop_back();
                step();
                break;
            case '"':
            case '\'':
                skip_quoted(nullptr);
                break;
            case '@':
                skip_asset();
                break;
            case '<':
                skip_path();
                break;
            case '#':
                skip_comment();
                break;
            case '/':
                if (peek(1) == '/' || peek(1) == '*')
                    skip_comment();
                else
                    step();
                break;
            default:
                step();
        }
    } while (!closing.empty());
}

void UsdaScanner::skip_value() {
    const int c = next();
    if (c == '(' || c == '[' || c == '{') return skip_brackets();
    if (c == '"' || c == '\'') return skip_quoted(nullptr);
    if (c == '@') return skip_asset();
    if (c == '<') return skip_path();
    if (!is_number_part(c) && !is_word_start(c)) fail("a value");
    while (is_number_part(peek()) || is_word_part(peek())) step();
}

TextSpan UsdaScanner::value() {
    next();
    TextSpan span{offset(), 0, line_};
    skip_value();
    span.count = offset() - span.begin;
    return span;
}

std::string UsdaScanner::line_text() {
    std::string text;
    for (int c = peek(); c >= 0 && c != '\n'; c = peek()) {
        if (text.size() == longest_name) fail("a line of at most 4096 letters");
        if (c != '\r') text += char(c);
        step();
    }
    return text;
}

// ---- arrays

void UsdaValues::fail(const std::string& expected) const {
    const size_t line = line_ + size_t(std::count(text_.data(), at_, '\n'));
    file_.fail(line, shown(std::string_view(at_, size_t(end_ - at_))), expected);
}

void UsdaValues::finish() {
    blank();
    if (at_ != end_) fail("the end of the array");
}

std::vector<double> UsdaValues::flat() {
    constexpr size_t most = 16;  // of a matrix
    std::vector<double> out;
    for (;;) {
        while (take_if('(') || take_if(')') || take_if(',')) continue;
        if (at_ == end_) return out;
        if (out.size() == most) fail("at most 16 numbers");
        out.push_back(number<double>());
    }
}

std::string UsdaValues::string() {
    blank();
    if (at_ == end_ || (*at_ != '"' && *at_ != '\'')) fail("a text in quotes");
    const char quote = *at_++;
    const char* to = std::find(at_, end_, quote);
    if (to == end_) fail("a text in quotes");
    const std::string text(at_, to);
    at_ = to + 1;
    return text;
}

std::vector<std::string> UsdaValues::strings() {
    std::vector<std::string> out;
    list([&] { out.push_back(string()); });
    return out;
}

}  // namespace wetcurl

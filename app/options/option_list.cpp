// Options by CLI11.
#include "app/options/option_list.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <CLI/CLI.hpp>
#include <limits>
#include <optional>
#include <type_traits>

#include "base/installed.h"

namespace wetcurl {

namespace {

// The number that all of a text is.
template <class Number>
std::optional<Number> number_in(const std::string& text) {
    const char* begin = text.data() + (text.size() > 1 && text[0] == '+' && text[1] != '-');
    const char* end = text.data() + text.size();
    Number number{};
    const auto [rest, error] = std::from_chars(begin, end, number);
    if (error != std::errc() || rest != end) return std::nullopt;
    return number;
}

// Each value of the option is one for which `takes` says yes; said before what earlier calls asked of it.
// shown: in the help beside the option's name.
template <class Takes>
void require(CLI::Option& option, const std::string& allowed, const std::string& shown, Takes takes) {
    option.transform(CLI::Validator(
        [=](std::string& text) {
            return takes(text) ? std::string() : fmt::format("found '{}', allowed: {}", text, allowed);
        },
        shown));
}

template <class Number>
void require_number(CLI::Option& option, Number low, Number high, const std::string& allowed,
                    const std::string& shown) {
    require(option, allowed, shown, [=](const std::string& text) {
        const std::optional<Number> number = number_in<Number>(text);
        return number && *number >= low && *number <= high;
    });
}

template <class Number>
void require_finite_number(CLI::Option& option) {
    require_number(option, std::numeric_limits<Number>::lowest(), std::numeric_limits<Number>::max(),
                   std::is_integral_v<Number> ? fmt::format("a whole number of at most {} digits",
                                                            std::numeric_limits<Number>::digits10)
                                              : "a number",
                   "");
}

// What a value of an option consists of.
template <class Value>
struct NumberOf {
    using type = Value;
};
template <class Value>
struct NumberOf<std::optional<Value>> : NumberOf<Value> {};
template <class Value>
struct NumberOf<std::vector<Value>> : NumberOf<Value> {};

}  // namespace

OptionRow OptionRow::required() { return OptionRow(option_->required()); }
OptionRow OptionRow::shows_default() { return OptionRow(option_->capture_default_str()); }
OptionRow OptionRow::hidden() { return OptionRow(option_->group("")); }
OptionRow OptionRow::one_of(const std::vector<std::string>& words) {
    const std::string allowed = fmt::format("{}", fmt::join(words, ", "));
    require(
        *option_, allowed, "{" + fmt::format("{}", fmt::join(words, ",")) + "}",
        [=](const std::string& text) { return std::find(words.begin(), words.end(), text) != words.end(); });
    return *this;
}
OptionRow OptionRow::within(int low, int high) {
    const std::string allowed = fmt::format("{} to {}", low, high);
    require_number(*option_, low, high, allowed, allowed);
    return *this;
}
OptionRow OptionRow::within(double low, double high) {
    const std::string allowed = fmt::format("{:g} to {:g}", low, high);
    require_number(*option_, low, high, allowed, allowed);
    return *this;
}
OptionRow OptionRow::positive() {
    require_number(*option_, std::numeric_limits<double>::min(), std::numeric_limits<double>::max(),
                   "a number above 0", "above 0");
    return *this;
}
OptionRow OptionRow::not_negative() {
    require_number(*option_, 0.0, std::numeric_limits<double>::max(), "0 or above", "0 or above");
    return *this;
}
OptionRow OptionRow::takes(int values) { return OptionRow(option_->expected(values)); }
OptionRow OptionRow::takes(const std::string& what) { return OptionRow(option_->type_name(what)); }
OptionRow OptionRow::repeatable() {
    return OptionRow(option_->expected(1)->take_all()->allow_extra_args(false));
}
OptionRow OptionRow::input_file() {
    return OptionRow(option_->transform([](const std::string& path) { return found_or_installed(path); }));
}
OptionRow OptionRow::needs(const OptionRow& other) { return OptionRow(option_->needs(other.option_)); }
OptionRow OptionRow::excludes(const OptionRow& other) { return OptionRow(option_->excludes(other.option_)); }

template <class Value>
OptionRow OptionList::option(const std::string& names, Value& value, const std::string& help) {
    CLI::Option* option = app_.add_option(names, value, help);
    using Number = typename NumberOf<Value>::type;
    if constexpr (std::is_arithmetic_v<Number>) require_finite_number<Number>(*option);
    return OptionRow(option);
}
template <>
OptionRow OptionList::option(const std::string& names, Vec3d& value, const std::string& help) {
    const auto put = [&value](const std::array<double, 3>& x) { value = {x[0], x[1], x[2]}; };
    CLI::Option* option =
        app_.add_option_function<std::array<double, 3>>(names, put, help)->type_name("X Y Z");
    require_finite_number<double>(*option);
    return OptionRow(option);
}
#define WETCURL_VALUE(...) \
    template OptionRow OptionList::option(const std::string&, __VA_ARGS__&, const std::string&);
WETCURL_VALUE(std::string)
WETCURL_VALUE(int)
WETCURL_VALUE(double)
WETCURL_VALUE(std::optional<int>)
WETCURL_VALUE(std::optional<long>)
WETCURL_VALUE(std::optional<double>)
WETCURL_VALUE(std::vector<std::string>)
WETCURL_VALUE(std::vector<double>)
#undef WETCURL_VALUE

OptionRow OptionList::flag(const std::string& names, bool& value, const std::string& help) {
    return OptionRow(app_.add_flag(names, value, help));
}
OptionRow OptionList::clears(const std::string& names, bool& value, const std::string& help) {
    return OptionRow(app_.add_flag_callback(
        names, [&value] { value = false; }, help));
}
void OptionList::footer(const std::string& text) { app_.footer(text); }

}  // namespace wetcurl

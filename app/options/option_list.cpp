// Options by CLI11.
#include "app/options/option_list.h"

#include <array>
#include <CLI/CLI.hpp>
#include <optional>

#include "base/installed.h"

namespace wetcurl {

OptionRow OptionRow::required() { return OptionRow(option_->required()); }
OptionRow OptionRow::shows_default() { return OptionRow(option_->capture_default_str()); }
OptionRow OptionRow::hidden() { return OptionRow(option_->group("")); }
OptionRow OptionRow::one_of(const std::vector<std::string>& words) {
    return OptionRow(option_->check(CLI::IsMember(words)));
}
OptionRow OptionRow::within(int low, int high) { return OptionRow(option_->check(CLI::Range(low, high))); }
OptionRow OptionRow::within(double low, double high) {
    return OptionRow(option_->check(CLI::Range(low, high)));
}
OptionRow OptionRow::positive() { return OptionRow(option_->check(CLI::PositiveNumber)); }
OptionRow OptionRow::not_negative() { return OptionRow(option_->check(CLI::NonNegativeNumber)); }
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
    return OptionRow(app_.add_option(names, value, help));
}
template <>
OptionRow OptionList::option(const std::string& names, Vec3d& value, const std::string& help) {
    const auto put = [&value](const std::array<double, 3>& x) { value = {x[0], x[1], x[2]}; };
    return OptionRow(app_.add_option_function<std::array<double, 3>>(names, put, help)->type_name("X Y Z"));
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

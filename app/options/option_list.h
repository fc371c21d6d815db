// The options of a command, as it describes them. CLI11, which reads them, stays behind: a file that sees its
// header takes ten seconds more to compile.
#pragma once

#include <string>
#include <vector>

#include "base/vec3.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace wetcurl {

// One of them. Each call says more of it, and returns it.
class OptionRow {
  public:
    explicit OptionRow(CLI::Option* option) : option_(option) {}
    OptionRow required();
    OptionRow shows_default();  // in the help
    OptionRow hidden();         // from the help
    OptionRow one_of(const std::vector<std::string>& words);
    template <size_t count>
    OptionRow one_of(const char* const (&words)[count]) {
        return one_of(std::vector<std::string>(words, words + count));
    }
    // Both ends are allowed; whole numbers for whole ones, which errors show.
    OptionRow within(int low, int high);
    OptionRow within(double low, double high);
    OptionRow positive();
    OptionRow not_negative();
    OptionRow takes(int values);
    OptionRow takes(const std::string& what);  // as the help calls its value
    OptionRow repeatable();                    // one value after each mention
    // Names a file to read: scenes and released networks that are installed with the program have their names
    // from any folder.
    OptionRow input_file();
    OptionRow needs(const OptionRow& other);
    OptionRow excludes(const OptionRow& other);

  private:
    CLI::Option* option_;
};

class OptionList {
  public:
    explicit OptionList(CLI::App& app) : app_(app) {}
    // `names`: "-o,--output"; without dashes it goes by its place. `value` is left as it is where the option
    // is not given. Value: text, a number, an optional or a vector of these, or a Vec3d.
    template <class Value>
    OptionRow option(const std::string& names, Value& value, const std::string& help);
    // Sets `value` to true, or by `clears` to false.
    OptionRow flag(const std::string& names, bool& value, const std::string& help);
    OptionRow clears(const std::string& names, bool& value, const std::string& help);
    // Below the help.
    void footer(const std::string& text);

  private:
    CLI::App& app_;
};

}  // namespace wetcurl

// Errors that end a command: where, what was found, what is allowed.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace wetcurl {

// A failed run or bad input data: exit status 1.
class Error : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

// A wrong command line or scene key: exit status 2.
class Misuse : public Error {
  public:
    using Error::Error;
};

// ", did you mean 'x'?" for the nearest of `known` by edit distance, or "" where none is near.
std::string did_you_mean(const std::string& found, const std::vector<std::string>& known);

}  // namespace wetcurl

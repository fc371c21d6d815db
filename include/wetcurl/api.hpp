/// @file
/// What the C++ interfaces of libwetcurl have in common.
#pragma once

#include <array>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "api.h"

/// What the library shows in C++.
namespace wetcurl {

/// The origin x y z [m], then the unit quaternion w x y z of the rotation.
using PoseArray = std::array<double, 7>;

/// Not for use from outside.
namespace detail {
/// Throws what wetcurl_error() says where a status is not 0.
inline void check(int status) {
    if (status != 0) throw std::runtime_error(wetcurl_error());
}
}  // namespace detail

}  // namespace wetcurl

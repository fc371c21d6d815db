// The readings of Eq 16 and 18, whose shifts are in print no lengths: names and ranges that scenes, recipes,
// pairs and the command line share.
#pragma once

#include <iterator>
#include <string>
#include <vector>

#include "base/rows.h"

namespace wetcurl {

// length: times the power of the support radius that makes the shift a length, so that hair of twice the size
// is shifted twice as far; printed: no factor, SI numbers as they are.
enum class ShiftUnits { length, printed };
inline constexpr const char* shift_units_words[] = {"length", "printed"};
inline const std::vector<std::string> shift_units_names(std::begin(shift_units_words),
                                                        std::end(shift_units_words));
// Throws Misuse for another name.
ShiftUnits shift_units_named(const std::string& name);
std::string name_of(ShiftUnits units);

// What the command line says of Eq 16's.
inline constexpr const char* colour_units_help =
    "how the shift of wet roots, which are the colours (Eq 16), is read: length (default), times the square "
    "of the "
    "support radius, or printed, SI numbers without it";

// Of kappa, the gain of Eq 18, which is never negative.
inline constexpr double largest_gain = 1e12;

inline constexpr KeyRow gain_row =
    KeyRow::number("gain", "1", 1, 0, largest_gain,
                   "Gain of the shifts that a network of the root codec predicts.", "Eq 18, kappa");
inline constexpr KeyRow shift_units_row =
    KeyRow::one_of("units", shift_units_words, "length",
                   "Whether those shifts scale with the hair (length) or are SI numbers (printed).", "Eq 18");

}  // namespace wetcurl

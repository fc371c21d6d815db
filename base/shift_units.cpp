// Names of the readings of Eq 16 and 18.
#include "base/shift_units.h"

#include "base/error.h"

namespace wetcurl {

ShiftUnits shift_units_named(const std::string& name) {
    for (size_t k = 0; k < shift_units_names.size(); ++k)
        if (shift_units_names[k] == name) return ShiftUnits(k);
    throw Misuse("units of a shift: found '" + name + "', allowed length, printed" +
                 did_you_mean(name, shift_units_names));
}

std::string name_of(ShiftUnits units) { return shift_units_names[size_t(units)]; }

}  // namespace wetcurl

// One strand's numbers where strands lie beside each other, as threads of a device read them together.
#pragma once

#include <cstddef>

#include "base/host_device.h"

namespace wetcurl {

// Every `step`th number from `first` on.
template <class V>
struct Strided {
    V* first;
    size_t step;
    WETCURL_HD V& operator[](size_t i) const { return first[i * step]; }
};

}  // namespace wetcurl

// Promises that are kept or broken, and calls that are refused.
#pragma once

#include <cstdio>
#include <stdexcept>
#include <string>

// Throws where a promise is broken.
inline void require(bool holds, const char* promise) {
    if (!holds) throw std::logic_error(std::string("broken: ") + promise);
}

// Prints the reason; throws where a call succeeds that asks for what cannot be.
template <class Act>
void require_refused(Act act) {
    try {
        act();
    } catch (const std::runtime_error& e) {
        std::printf("refused: %s\n", e.what());
        return;
    }
    throw std::logic_error("broken: what cannot be is refused");
}

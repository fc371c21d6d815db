// The ways to interpolate strands without a network, by name.
#pragma once

#include <string>

namespace wetcurl {

// nearest: a copy of the nearest strand; quad: the weighted mean; core: the weighted mean of the cores (Form
// V+), with the nearest strand's detail in the core's frames; rest: the strand's own rest shape, whose core
// is moved as those around it have moved from theirs, with its own detail in the core's frames; skin: the
// strand's own rest shape, each particle carried rigidly by those at its height of the strands around it, the
// weighted mean of what each makes of it (linear blend skinning, as Hsu et al. 2024 do with guides).
enum class Interpolation { nearest, quad, core, rest, skin };
// Throws Misuse for another name.
Interpolation interpolation_named(const std::string& name);
// Throws Error unless so many low-resolution strands of so many particles are those that are there.
void require_low_strands(int found, int found_particles, int strands, int particles);

}  // namespace wetcurl

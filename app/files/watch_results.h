// What a FrameWatch has seen, as results.
#pragma once

#include "app/files/results.h"
#include "base/frame_watch.h"

namespace wetcurl {

Json json_of(const FrameWatch& watch);
// "1.02 times rest (frame 3, strand 5, particle 7)"; "-" before the first frame.
std::string stretch_text(const FrameWatch& watch);
// What to warn of; "" where nothing was exceeded.
std::string warning_of(const FrameWatch& watch);

}  // namespace wetcurl

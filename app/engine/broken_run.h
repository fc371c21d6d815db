// What a run that was stopped or killed left at its output, and whether another one may go on with it.
#pragma once

#include <optional>
#include <vector>

#include "base/frame_watch.h"

namespace wetcurl {

struct BrokenRun {
    std::string file;  // NAME.partial, or NAME
    RunHeader header;
    int frames;
    std::vector<double> seconds;  // (frame)
};

// What is whole already, unless it is to be replaced; there is nothing to go on with then.
std::optional<BrokenRun> whole_run_at(const std::string& output, bool overwrite);
// Says so. Throws Error unless a run with that header and so many frames is the same one.
void require_whole(const BrokenRun& whole, const RunHeader& header, int frames);
// None where no frame is there. `place` holds the lock.
std::optional<BrokenRun> broken_run_at(const OutputFile& place);
// Throws Error, with what differs, unless a run with that header is the same one.
void require_same(const BrokenRun& broken, const RunHeader& header);
// The watch sees the frames that are there.
void look_at(const BrokenRun& broken, FrameWatch& watch);

}  // namespace wetcurl

// What `wetcurl bench` measures and how it is told: entries, the lines and points they give, the machine.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "solver/scene/scene.h"

namespace wetcurl::bench {

// Of repetitions [s].
struct Times {
    double median = 0, min = 0, max = 0;
    size_t count = 0;
};
Times times_of(std::vector<double> seconds);

// A line of the table: what is not measured of it is left out.
struct Line {
    std::string name;
    std::string series;  // lines over which an exponent of time in `size` is fitted
    double size = 0;
    std::string item;  // a repetition works on `items` of them
    double items = 0;
    double bytes = 0;                       // that a repetition reads and writes at least
    std::optional<double> operations = {};  // in floating point, of a repetition
    std::optional<double> bytes_a_particle = {}, neighbours = {}, error_mm = {};
    std::optional<int> strands = {}, particles = {};
    Times seconds = {};
};

// A point on a curve of error against run time.
struct Point {
    std::string integrator, precision;
    int substeps;
    Times seconds = {};
    std::optional<double> error_mm = {};  // none: the run diverges
};

struct Results {
    std::vector<Line> lines;
    std::vector<Point> points;
};

struct Entry {
    std::vector<std::string> names;         // of its lines; --filter looks in them
    std::string series;                     // for messages
    std::function<void(Results&)> measure;  // null: not here, `absent` says why
    std::string absent = "";
};

// What `prepare` returns is repeated and timed.
Times repeated(const std::function<std::function<void()>()>& prepare);

// Level sets (the paper, VI.B) and neighbour searches (its Table 4), on the CPU.
std::vector<Entry> part_entries();
// Steps of the air, whole frames with their stages, and error against run time. `device` as of --device.
std::vector<Entry> frame_entries(const std::string& device);

// A frame of each of the models (files, codec strand) for each of some numbers of strands: from dry positions
// to wet ones in the memory of the device.
std::vector<Entry> learned_entries(const std::vector<std::string>& models, const std::string& device,
                                   int threads);

// Patches through the paper's networks at width 1, and training steps of them.
std::vector<Entry> network_entries(const std::string& device, int threads);

// The fixed workload at one size: the demo's curls on a head that turns, 24 frames a second, ten substeps,
// ten passes of Eq 10.
struct Workload {
    int across, along;      // strands, the groom's grid
    double radius;          // [m] of Eq 10; 30 to 40 neighbours of hair that hangs
    double settle;          // [s] before the frames that are measured
    int frames = 24;        // 3 or more, frame 0 among them
    int particles = 100;    // a strand
    double angle = 25;      // [degrees] by which the head turns to either side; 0: it rests
    double relaxation = 1;  // of those passes
    double spacing = 0;     // [m] along a strand, of those that feel them; 0: all particles
    int substeps = 10, passes = 10;
    int strands() const { return across * along; }
};
// Every `stride`-th root each way.
Scene scene_of(const Workload& w, bool wet, const std::vector<std::string>& set = {}, int stride = 1);
// The lines of whole_frames.
std::vector<std::string> names_of(const Workload& w, bool wet);
// A line for the frame and for each of its stages. `with_error`: beside the reference.
std::vector<Line> whole_frames(const Workload& w, bool wet, const std::string& device, bool with_error);
// A point for each number of substeps. `integrator` and `precision` as a scene and --precision name them.
std::vector<Point> error_against_time(const Workload& w, const std::string& device,
                                      const std::string& integrator, const std::string& precision,
                                      const std::vector<int>& substeps);

struct Machine {
    std::string processor;
    int threads;                    // of the host
    double copy_bytes, operations;  // a second: a copy's, read and written; of float multiply-adds, two each
};
Machine machine_of(const std::string& device);
// Memory [bytes] that the system can still give; and of this process the most so far. 0 where it does not
// say.
size_t available_bytes();
size_t peak_bytes();

}  // namespace wetcurl::bench

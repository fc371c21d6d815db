// The run cache: what a simulation or an inference leaves, frame by frame. Solver and networks meet here.
// HDF5 "wetcurl run", one chunk a frame, uncompressed.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/hdf5.h"
#include "base/strands.h"

namespace wetcurl {

inline constexpr const char* run_format = "wetcurl run";
inline constexpr int run_version = 1;

// What is the same for all frames.
struct RunHeader {
    std::string scene;         // the resolved scene, TOML
    std::string scene_folder;  // where its relative paths start
    std::string method;  // "simulated dry", "simulated wet, Lin 2015 on our chain", "quad interpolation"…
    std::string device = "cpu";
    double fps = 24;
    double start = 0;  // [s] time of frame 0: above 0 where the run begins at a frame of another one
    unsigned long long seed = 0;
    Groom groom;     // rest strands, head frame
    int stride = 1;  // of this run's grid in the scene's full grid (2: every second root each way)
    int guides = 0;  // above 0: so many strands of the scene's, chosen, in place of a grid
    // Strands of a predicted run that the low-resolution run had too, rising; nothing: not known, as of files
    // of earlier versions.
    std::optional<std::vector<int>> followed;
    std::vector<float> saturation;            // (strand, particle) at the start; empty without wetness
    std::vector<std::string> energy_kinds;    // names of the columns of `energy`; empty: not recorded
    std::vector<std::string> stages;          // names of the columns of `stage_seconds`
    std::vector<std::string> inputs;          // "file hash" of what it was made from
    std::string terms_present, terms_absent;  // comma-separated
    std::string build;                        // of the program that wrote it; read only
    std::string path;                         // file that it was read from; read only
    double time(int frame) const { return start + frame / fps; }  // [s]
};

// What messages call the scene of a run: "RUN.h5: its scene".
std::string scene_name(const RunHeader& header);

// What made a run's strands: "simulated" by physics alone, "interpolated" from a dry run, linear regression
// among that, or "learned": by a network, be it one in the place of a single force.
std::string kind_of(const RunHeader& header);

struct RunFrame {
    Pose head;                  // of the head (and what is attached to it) at this frame
    Strands positions;          // p, metres, world
    Strands displayed;          // p^w of Eq 10; count 0 where the run has no cohesion
    std::vector<float> energy;  // one a kind [J]
    std::vector<float> stage_seconds;
    std::vector<uint8_t> contact;   // (strand, particle), 1 in contact; may be empty
    std::vector<float> saturation;  // (strand, particle); empty where it stays as the header has it
    // (strand, piece of equal length, root first): how far from the simulation a network expects it to be on
    // average [m]; empty where no network said so.
    std::vector<float> expected_error;
    std::vector<double> water;  // held, taken, dripped, dried so far [kg]; empty without flow
    double seconds = 0;         // run time of this frame, file output left out
    // expected_error of the piece that the edge to a particle lies in; only where a network said so.
    float expected_at(int strand, int particle) const {
        const size_t pieces = expected_error.size() / size_t(positions.count),
                     edges = size_t(positions.particles - 1);
        return expected_error[size_t(strand) * pieces + size_t(std::max(particle, 1) - 1) * pieces / edges];
    }
    // What is seen: p^w where there is one, p elsewhere.
    const Strands& seen() const { return displayed.count ? displayed : positions; }
    // (strand, particle) now; empty without wetness.
    const std::vector<float>& wetness(const RunHeader& header) const {
        return saturation.empty() ? header.saturation : saturation;
    }
};

// A run that grows: from its first frame on other processes can read it under its partial name, and a kill at
// any moment leaves all frames that were appended.
class RunWriter {
  public:
    RunWriter(const std::string& path, const RunHeader& header, bool overwrite)
        : RunWriter(OutputFile(path, overwrite), header) {}
    // Into a place that was secured before.
    RunWriter(OutputFile place, const RunHeader& header);
    // Goes on after the first `frames` frames of the run with that header that an earlier process left there.
    RunWriter(OutputFile place, const RunHeader& header, int frames);
    ~RunWriter();
    void append(const RunFrame& frame);
    void commit();

  private:
    struct Body;
    std::unique_ptr<Body> body_;
};

class RunReader {
  public:
    // Throws Error with what is wrong. Of a run that is not whole, frames are those that were whole when this
    // was made. `mine`: as of an H5Reader.
    explicit RunReader(const std::string& path, bool mine = false);
    ~RunReader();
    const RunHeader& header() const;
    int frames() const;
    // Whether it is whole, and the process that writes it, "" for none.
    H5Reader::Written written() const;
    const std::string& writer() const;
    RunFrame frame(int f) const;          // 0 ≤ f < frames()
    std::vector<double> seconds() const;  // (frame)
    const std::string& path() const;

  private:
    struct Body;
    std::unique_ptr<Body> body_;
};

}  // namespace wetcurl

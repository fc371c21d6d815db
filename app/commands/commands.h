// The subcommands of `wetcurl`, one file each: plain options in, exit status out. The command line itself is
// read in main.cpp alone.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/files/common_options.h"

namespace wetcurl {

struct SimulateOptions : CommonOptions {
    std::string scene, output;
    std::optional<int> frames, strands;
    std::string groom;
    std::string precision = "float";
    bool dry = false;
    bool before_cohesion = false;  // without Eq 10, which moves what is displayed alone
    bool reference = false;        // also run in double with 160 substeps and report the error
};
struct EncodeOptions : CommonOptions {
    std::vector<std::string> inputs;  // DRY.h5 WET.h5 pairs, or wet runs for adhesion samples
    std::string output, codec = "strand";
    std::string colour_units;  // of Eq 16, codec root; "": length
};
struct DatasetOptions : CommonOptions {
    std::string recipe, output, part;  // part: "K/N"
};
struct TrainOptions : CommonOptions {
    std::string kind;  // sr | adhesion
    std::vector<std::string> pairs, validation;
    std::string output, recipe, architecture, from;
    std::optional<double> width;
};
struct InferOptions : CommonOptions {
    std::string input, model, interpolate, reconstruct, wetness, output;
    std::optional<int> frames;                   // the first so many alone
    std::string oracle_colours, oracle_weights;  // a wet run, in place of a network's
    std::optional<double> gain;                  // kappa of Eq 18; none: the scene's or the model's
    std::string units, colour_units;             // of Eq 18, of Eq 16; "": the scene's or the model's
    int roots = 4;                               // around a new strand: the grid's four, or the three nearest
    bool wet_shape = false;                      // of an interpolation: Eq 9 before it
    bool settled = false;   // the run is dry, and is moved to where wet strands come to rest
    bool crop = false;      // the network is asked where hair is wet alone
    bool cohesion = false;  // Eq 10 after it
    // Of Eq 10, in place of the scene's.
    std::optional<int> passes;
    std::optional<double> spacing, relaxation;  // [m], [1]
};
struct CompareOptions : CommonOptions {
    std::string reference;
    std::vector<std::string> others;
    int first_frame = 0;  // frames before this one are left out (those that training saw)
};
struct ReportOptions : CommonOptions {
    std::vector<std::string> runs;  // the reference, then what is compared with it; none: a table alone
    std::string table, stability, output;  // folder of comparisons, the battery's JSON, the page; "": none
    std::vector<std::string> trainings;    // their logs, MODEL.h5.jsonl
    int first_frame = 0;                   // of the runs, as for compare
};
struct RenderOptions : CommonOptions {
    std::vector<std::string> runs;  // side by side; with `image` pairs and models too
    std::string output;
    int frame = -1;      // -1: all of them (video), or the last one (picture)
    bool image = false;  // geometry images in place of strands
    int run = 0;         // of a pairs file, for `image`
    int pixels = 400;    // a panel's least side, for `image`
    int width = 720, height = 900;
    bool saturation = false;
    double yaw = 30;  // of the camera around the head [degrees]
    bool labels = true;
};
struct PlotOptions : CommonOptions {
    std::vector<std::string> runs;  // side by side: runs, logs of trainings, or one pairs file
    std::string model;              // for pairs of codec adhesion
    bool time = false;              // of runs: the time of each frame in place of energy
    std::string output;
    int width = 720, height = 480;
};
struct ImportOptions : CommonOptions {
    std::string input, output, units = "auto", up = "y", scalp;
    int resample = 0;  // 0: as it is
};
struct InspectOptions : CommonOptions {
    std::string what, file;  // scene | run | pairs | model | terms | device
    std::string output;      // allowed for none: render draws
};
struct BenchOptions : CommonOptions {
    std::string filter;
    std::vector<std::string> models;  // whose frames are timed too
};

struct StabilityCommandOptions : CommonOptions {
    std::string scene;                       // of S9; "": one of our own
    std::vector<std::string> methods, only;  // by name, cases by id; none: all
    bool quick = false;
};

int simulate_command(const SimulateOptions&);
int encode_command(const EncodeOptions&);
int dataset_command(const DatasetOptions&);
int train_command(const TrainOptions&);
int infer_command(const InferOptions&);
int compare_command(const CompareOptions&);
std::string compare_columns();  // what the columns of its table mean, a line each
int report_command(const ReportOptions&);
int render_command(const RenderOptions&);
int plot_command(const PlotOptions&);
int import_command(const ImportOptions&);
int inspect_command(const InspectOptions&);
int stability_command(const StabilityCommandOptions&);
int bench_command(const BenchOptions&);

}  // namespace wetcurl

// Whole frames of the fixed workload with their stages, and error against run time.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "app/bench/bench.h"
#include "app/bench/bench_operations.h"
#include "app/engine/device.h"
#include "app/engine/reference.h"
#include "app/engine/simulated_frames.h"
#include "base/log.h"

namespace wetcurl::bench {

namespace {

constexpr const char* text = R"(
title = "Fixed workload"
[groom]
grid = [{}, {}]
particles = {}
length_noise = 0.04
phase_noise = 3.1
[motion]
axis = [0, 1, 0]
angle = {}
period = 1.6
[integrator]
substeps = 10
settle = {}
[stretch]
[bend]
[core]
[wetness]
jitter = 0.2
[curl]
[stiffness]
dry = 4.0
wet = 4.0
[[solid]]
name = "head"
shape = "sphere"
radius = 0.095
attached = "head"
)";
constexpr const char* shown_wet = R"(
[cohesion]
radius = {}
tightness = 0.97
passes = 10
relaxation = 1
spacing = 0
neighbours = 0
)";

// What a scene may name beside the workload, in the place of Eq 10; where it reaches, as far as that.
struct Addition {
    const char *name, *stage, *text;  // the last stage of its frames
};
constexpr Addition additions[] = {
    {"flow", "saturation", "[wetness.flow]\nreach = {}\n"},
    {"strand contact", "strand contact", "[strand_contact]\n"},
    {"adhesion", "chain", "[adhesion]\n"},
    {"cohesion in the solve", "cohesion in the solve",
     "[cohesion]\nradius = {}\nstrength = 20\nrelaxation = 1\npasses = 10\ntightness = 0.85\n"},
    {"Lin 2015", "baseline", "[baseline]\nmethod = \"lin\"\nradius = {}\n"},
    {"Kim 2016", "baseline", "[baseline]\nmethod = \"kim\"\nradius = {}\n"},
    {"boundary particles", "baseline", "[baseline]\nmethod = \"boundary_particles\"\n"},
};

// Radii measured: 30 to 40 neighbours in the frames that count. Larger ones settle for less long, since a
// substep of all takes that long on a CPU.
const Workload workloads[] = {{8, 8, 0.0185, 1.5},     {32, 16, 0.0070, 1.5},    {64, 32, 0.0042, 1.5},
                              {110, 90, 0.00238, 1.5}, {200, 150, 0.0017, 0.25}, {400, 250, 0.00114, 0.25}};
const Workload& fixed = workloads[1];

// A run that takes too long ends after fewer frames, though after `fewest`; one of very long frames after 3.
constexpr size_t fewest = 12;
constexpr double long_run = 10, long_frame = 5;  // [s]
// Of a simulation and of what makes it: 284 were measured of 100,000 wet strands.
constexpr double bytes_a_particle = 350, bytes_seen = sizeof(Vec3f);

// What is seen in each frame of the reference, which is run once. The next call may end the reference.
const std::vector<Strands>& reference_frames(const Workload& w, bool wet, const std::string& device) {
    static std::map<std::string, std::vector<Strands>> known;
    Workload passes = w;
    passes.relaxation = 1, passes.spacing = 0, passes.substeps = 10;
    const Scene scene = scene_of(passes, wet);
    // Those of much hair take gigabytes, and are asked for once.
    std::erase_if(
        known, [](const auto& of) { return !of.second.empty() && of.second[0].points.size() > size_t(1e6); });
    auto& frames = known[fmt::format("{}{}{}{}", scene.text, wet, device, w.frames)];
    if (frames.empty()) {
        Reference reference(scene, device);
        while (int(frames.size()) < w.frames) frames.push_back(reference.next().seen());
    }
    return frames;
}

double mean_error(const std::vector<Strands>& frames, const std::vector<Strands>& reference) {
    double sum = 0;
    for (size_t f = 0; f < frames.size(); ++f) sum += distance_mm(frames[f], reference[f]);
    return sum / double(frames.size());
}

double bytes_of(const BufferList& buffers) {
    double sum = 0;
    for (const auto& b : buffers) sum += double(b.bytes);
    return sum;
}
double bytes_of(const BufferList& buffers, BufferUse use) {
    double sum = 0;
    for (const auto& b : buffers)
        if (b.use == use) sum += double(b.bytes);
    return sum;
}

// What a stage goes through in a frame. Caches may hold some of it: the CPU takes a block of strands through
// all substeps before the next.
double bytes_of_stage(const std::string& stage, const Scene& scene, const BufferList& buffers) {
    auto bytes = [&](BufferUse use) { return bytes_of(buffers, use); };
    const double lists = bytes(BufferUse::lists), displayed = bytes(BufferUse::displayed);
    const int substeps = scene.integrator.substeps;
    if (stage == "chain") return substeps * (2 * bytes(BufferUse::written) + bytes(BufferUse::read));
    if (stage == "neighbours") return displayed + lists;  // read, written
    if (stage == "cohesion")
        return scene.cohesion->sweeps() * lists + 2 * displayed;   // each pass; roots to tips at the end
    if (stage == "saturation") return bytes(BufferUse::coupling);  // once a frame
    return substeps * bytes(BufferUse::coupling);
}

// Of a particle in a substep, as counted on a few strands of the workload.
double chain_operations_of(const Workload& w, bool wet) {
    static std::map<std::pair<bool, int>, double> known;
    const auto [at, is_new] = known.insert({{wet, w.particles}, 0});
    if (!is_new) return at->second;
    const Workload few{8, 8, w.radius, 0.25, w.frames, w.particles, w.angle};
    const Scene scene = scene_of(few, wet);
    const auto simulation = make_simulation(scene, "float");
    SimulatedFrames frames(*simulation, 1 + few.frames);
    double sum = 0;
    while (frames.advance())
        if (frames.index() > 0) sum += chain_operations(scene, simulation->state());
    return at->second = sum / few.frames;
}

// In a frame; none where they are not counted.
std::optional<double> operations_of_stage(const std::string& stage, const Workload& w, const Scene& scene,
                                          double neighbours) {
    const double particles = double(w.strands()) * w.particles;
    if (stage == "chain")
        return particles * scene.integrator.substeps * chain_operations_of(w, scene.wetness.has_value());
    if (stage == "cohesion")
        return particles * scene.cohesion->sweeps() * cohesion_operations(*scene.cohesion, neighbours);
    return std::nullopt;
}

std::string name_of_integrator(const std::string& kind) {
    return kind == "implicit" ? "BDF2" : kind == "backward_euler" ? "backward Euler" : kind;
}
std::string name_of_precision(const std::string& precision) {
    return precision == "float" ? "single" : precision;
}

std::string series_of(const Workload& w, bool wet) {
    const std::string spaced = w.spacing > 0 ? fmt::format(" every {:g} mm", 1e3 * w.spacing) : "",
                      relaxed = w.relaxation > 1 ? " over-relaxed" : "",
                      passes = w.passes == 10 ? "" : fmt::format(" with passes = {}", w.passes),
                      shown = spaced + relaxed + passes;
    const std::string substeps = w.substeps == 10 ? "" : fmt::format(" of {} substeps", w.substeps);
    return fmt::format("{} frame{}{}{}", wet ? "wet" : "dry", substeps, w.angle == 0 ? ", head at rest" : "",
                       shown.empty() ? "" : ", Eq 10" + shown);
}
std::string name_of(const Workload& w, bool wet) {
    return fmt::format("{}, {} strands", series_of(w, wet), w.strands());
}

bool fits(const Workload& w, double bytes, const char* what) {
    const double needed = bytes * w.strands() * w.particles, there = double(available_bytes());
    if (there == 0 || needed <= there) return true;
    log_warning(fmt::format("{} strands: {} left out: about {:.1f} GB of memory are needed, {:.1f} are free",
                            w.strands(), what, needed / 1e9, there / 1e9));
    return false;
}
bool fits(const Workload& w) { return fits(w, bytes_a_particle, "they are"); }

// The wet workload's hair, and `beside` it.
Scene scene_with(const char* beside, const Workload& w, const std::vector<std::string>& set = {},
                 int stride = 1) {
    SceneOptions options;
    options.set = set, options.stride = stride;
    const std::string whole = fmt::format(text, w.across, w.along, w.particles, w.angle, w.settle) +
                              fmt::format(fmt::runtime(beside), w.radius);
    return parse_scene(whole, "the fixed workload", ".", options);
}

}  // namespace

Scene scene_of(const Workload& w, bool wet, const std::vector<std::string>& given, int stride) {
    auto set = given;
    if (w.substeps != 10) set.push_back(fmt::format("integrator.substeps={}", w.substeps));
    if (w.passes != 10) set.push_back(fmt::format("cohesion.passes={}", w.passes));
    if (w.relaxation > 1) set.push_back(fmt::format("cohesion.relaxation={}", w.relaxation));
    if (w.spacing > 0) set.push_back(fmt::format("cohesion.spacing={}", w.spacing));
    Scene scene = scene_with(shown_wet, w, set, stride);
    if (!wet) make_dry(scene);
    return scene;
}

// Of lines, before anything is run.
std::vector<std::string> names_of(const Workload& w, bool wet) {
    const std::string whole = name_of(w, wet);
    std::vector<std::string> names{whole, whole + ": chain"};
    if (wet) names.insert(names.end(), {whole + ": neighbours", whole + ": cohesion"});
    return names;
}

namespace {

// Run times [s] of a simulation's frames: whole ones, then those of each stage. What is seen goes to `seen`,
// unless null.
std::vector<std::vector<double>> seconds_of_frames(Simulation& simulation, int most,
                                                   std::vector<Strands>* seen) {
    std::vector<std::vector<double>> seconds(1 + simulation.stages.size());
    double spent = 0;
    SimulatedFrames frames(simulation, most);
    for (RunFrame frame; frames.next(frame);) {
        if (seen) seen->push_back(frame.seen());
        // Nothing is computed for frame 0. Frame 1 finds memory and caches cold; it counts only where it is
        // long.
        if (frames.index() == 0 || (frames.index() == 1 && frame.seconds < long_frame)) continue;
        seconds[0].push_back(frame.seconds);
        for (size_t k = 1; k < seconds.size(); ++k) seconds[k].push_back(double(frame.stage_seconds[k - 1]));
        spent += frame.seconds;
        const size_t enough = frame.seconds > long_frame ? 3 : spent > long_run ? fewest : size_t(most);
        if (!seen && seconds[0].size() >= enough) break;
    }
    return seconds;
}

// Of a frame of the scene, `name`d and of a series, and of each of its stages. What is seen goes to `seen`,
// unless null.
std::vector<Line> frames_of(const Scene& scene, const std::string& name, const std::string& series,
                            const Workload& w, const std::string& device, std::vector<Strands>* seen) {
    const auto simulation = make_simulation_on(device, scene, "float");
    const auto& stages = simulation->stages;
    std::vector<std::vector<double>> seconds;  // (line, frame)
    try {
        seconds = seconds_of_frames(*simulation, w.frames, seen);
    } catch (const Diverged& e) {
        throw Error("bench: " + name + ": " + e.what());
    }
    const BufferList buffers = simulation->buffers();
    const double particles = double(w.strands()) * w.particles;
    Line line;
    line.series = series, line.name = name;
    line.size = w.strands(), line.strands = w.strands(), line.particles = w.particles;
    line.item = "particle", line.items = particles;
    std::vector<Line> lines{line};
    for (const auto& stage : stages) {
        lines.push_back(line);
        lines.back().name += ": " + stage, lines.back().series += ": " + stage;
        lines.back().bytes = bytes_of_stage(stage, scene, buffers);
        lines[0].bytes += lines.back().bytes;
    }
    for (size_t k = 0; k < lines.size(); ++k) lines[k].seconds = times_of(seconds[k]);
    lines[0].bytes_a_particle = bytes_of(buffers) / particles;
    if (const double neighbours = simulation->neighbours_mean(); neighbours > 0)
        lines[0].neighbours = neighbours;
    return lines;
}

// A frame with an addition, and its stage.
Entry entry_of(const Addition& addition, const Workload& w, const std::string& device) {
    const std::string series = fmt::format("frame with {}", addition.name),
                      name = fmt::format("{}, {} strands", series, w.strands());
    auto measure = [addition, w, device, series, name](Results& out) {
        if (!fits(w)) return;
        const auto lines = frames_of(scene_with(addition.text, w), name, series, w, device, nullptr);
        out.lines.push_back(lines.front()), out.lines.push_back(lines.back());
    };
    return {{name, name + ": " + addition.stage}, series, measure};
}

}  // namespace

std::vector<Line> whole_frames(const Workload& w, bool wet, const std::string& device, bool with_error) {
    const Scene scene = scene_of(w, wet);
    std::vector<Strands> seen;
    auto lines =
        frames_of(scene, name_of(w, wet), series_of(w, wet), w, device, with_error ? &seen : nullptr);
    std::optional<double> operations = 0;  // of the frame, where those of all stages are counted
    for (size_t k = 1; k < lines.size(); ++k) {
        lines[k].operations = operations_of_stage(lines[k].name.substr(lines[0].name.size() + 2), w, scene,
                                                  lines[0].neighbours.value_or(0));
        operations = operations && lines[k].operations ? std::optional(*operations + *lines[k].operations)
                                                       : std::nullopt;
    }
    lines[0].operations = operations;
    if (with_error) lines[0].error_mm = mean_error(seen, reference_frames(w, wet, device));
    return lines;
}

// A run of the scene, its error against `exact`; none where it diverges.
static Point point_of(const Scene& scene, const std::string& device, const std::string& precision,
                      const std::vector<Strands>& exact) {
    Point point{name_of_integrator(scene.integrator.kind), name_of_precision(precision),
                scene.integrator.substeps};
    const auto simulation = make_simulation_on(device, scene, precision);
    std::vector<Strands> seen;
    std::vector<double> seconds;
    SimulatedFrames frames(*simulation, int(exact.size()));
    try {
        for (RunFrame frame; frames.next(frame);) {
            seen.push_back(frame.seen());
            if (seen.size() > 2) seconds.push_back(frame.seconds);
        }
    } catch (const Diverged&) {
        return point;
    }
    point.seconds = times_of(seconds);
    point.error_mm = mean_error(seen, exact);
    return point;
}

std::vector<Point> error_against_time(const Workload& w, const std::string& device,
                                      const std::string& integrator, const std::string& precision,
                                      const std::vector<int>& substeps) {
    const auto& exact = reference_frames(w, true, device);
    std::vector<Point> points;
    for (int n : substeps) {
        auto run = [&](double settle, size_t frames) {
            Workload settled = w;
            settled.settle = settle;
            const Scene scene =
                scene_of(settled, true,
                         {"integrator.kind=" + integrator, fmt::format("integrator.substeps={}", n),
                          // It would hide that the explicit scheme diverges.
                          "integrator.limiter=0"});
            return point_of(scene, device, precision, {exact.begin(), exact.begin() + long(frames)});
        };
        // The explicit scheme mostly diverges at once, and need not settle for that; from where it stands on
        // more substeps only take longer.
        const bool is_explicit = integrator == "explicit";
        Point point = is_explicit ? run(0, 3) : run(w.settle, exact.size());
        if (is_explicit && point.error_mm) point = run(w.settle, exact.size());
        points.push_back(point);
        if (is_explicit && point.error_mm) break;
    }
    return points;
}

// A frame's step of a field of cells³, four strands in it.
static Entry air_step(int cells, const std::string& device) {
    Line line;
    line.series = "air step", line.name = fmt::format("air step {}³", cells);
    line.size = line.items = std::pow(cells, 3), line.item = "cell";
    line.bytes = 2 * 3 * sizeof(double) * line.items;  // three components, read and written
    auto measure = [line, cells, device](Results& out) mutable {
        const Scene scene = parse_scene(fmt::format("[groom]\ngrid = [2, 2]\nparticles = 8\n"
                                                    "curl_radius = 0\n[integrator]\n"
                                                    "substeps = 1\n[stretch]\n[air]\n"
                                                    "grid = [{0}, {0}, {0}]\n[[air.source]]\n",
                                                    cells),
                                        "a field of air", ".");
        const auto simulation = make_simulation_on(device, scene, "float");
        const size_t air = size_t(std::find(simulation->stages.begin(), simulation->stages.end(), "air") -
                                  simulation->stages.begin());
        std::vector<double> seconds;
        SimulatedFrames frames(*simulation, 1 + 40);
        RunFrame frame;
        for (double spent = 0; (spent < 2 || seconds.size() < 3) && frames.next(frame);) {
            if (frames.index() == 0) continue;
            seconds.push_back(double(frame.stage_seconds[air]));
            spent += seconds.back();
        }
        seconds.erase(seconds.begin());  // it finds memory and caches cold
        line.seconds = times_of(seconds);
        out.lines.push_back(line);
    };
    return {{line.name}, line.series, measure};
}

std::vector<Entry> frame_entries(const std::string& device) {
    std::vector<Entry> all;
    for (int cells : {16, 32, 64, 128}) all.push_back(air_step(cells, device));
    // The reference takes 16 times the substeps in double precision; compared methods take seconds a frame.
    const int most_with_error = device == "cpu" ? 9900 : 100000,
              most_with_addition = device == "cpu" ? 2048 : 9900;
    std::vector<Workload> frames(std::begin(workloads), std::end(workloads));
    frames.push_back(fixed), frames.back().angle = 0;
    for (const Workload& w : {fixed, workloads[3]}) frames.push_back(w), frames.back().relaxation = 2.5;
    frames.push_back(workloads[3]), frames.back().passes = 1;
    for (bool wet : {true, false})
        for (Workload w : frames) {
            if (!wet && (w.relaxation > 1 || w.passes != 10)) continue;
            if (device != "cpu") w.settle = fixed.settle;  // minutes on a CPU, seconds there
            auto measure = [w, wet, device, most_with_error](Results& out) {
                if (!fits(w)) return;
                const bool with_error =
                    w.strands() <= most_with_error &&
                    fits(w, bytes_a_particle + bytes_seen * 2 * w.frames, "their error is");
                const auto lines = whole_frames(w, wet, device, with_error);
                out.lines.insert(out.lines.end(), lines.begin(), lines.end());
            };
            all.push_back({names_of(w, wet), series_of(w, wet), measure});
        }
    for (const Addition& addition : additions)
        for (Workload w : workloads) {
            if (w.strands() > most_with_addition) continue;
            w.settle = 0.25;
            all.push_back(entry_of(addition, w, device));
        }
    for (const std::string integrator : {"implicit", "backward_euler", "explicit"})
        for (const std::string precision : {"float", "double"}) {
            const std::string curve = "error against run time";
            Entry entry{{fmt::format("{}, {}, {}", curve, name_of_integrator(integrator),
                                     name_of_precision(precision))},
                        curve,
                        {},
                        ""};
            const std::vector<int> substeps =
                integrator == "explicit" ? std::vector<int>{1, 2, 4, 8, 16, 40, 80, 160, 320, 640, 1280, 2560}
                                         : std::vector<int>{1, 2, 4, 8, 10, 16};
            entry.measure = [=](Results& out) {
                const auto points = error_against_time(fixed, device, integrator, precision, substeps);
                out.points.insert(out.points.end(), points.begin(), points.end());
            };
            all.push_back(entry);
        }
    return all;
}

}  // namespace wetcurl::bench

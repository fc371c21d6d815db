// `wetcurl export`: frame by frame from a run to one animated file, or to a file of strands for each frame.
#include "app/commands/export.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>

#include "app/engine/run_of_scene.h"
#include "app/engine/run_solids.h"
#include "app/exchange/guides.h"
#include "app/files/results.h"
#include "app/files/run_file.h"
#include "app/options/option_list.h"
#include "base/exchange/scene_file.h"
#include "base/file_ending.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "base/progress.h"
#include "base/run_cache.h"
#include "solver/grooms/import.h"
#include "solver/scene/scene.h"

namespace wetcurl {

namespace fs = std::filesystem;

namespace {

// What a program takes: its unit, and whether its files have height along z.
struct Target {
    const char* name = "";
    double metres = 1;
    bool swaps_y_and_z = false;  // in Alembic, which cannot say its axes
    bool for_unreal = false;     // with the attributes of its grooms
};
constexpr Target targets[] = {
    {"", 1, false, false},        {"blender", 1, false, false}, {"houdini", 1, false, false},
    {"maya", 0.01, false, false}, {"unreal", 0.01, true, true},
};

// From the run's metres, Y up.
class Axes {
  public:
    Axes(const Target& target, const std::string& path)
        : scale_(float(1 / target.metres)), swap_(target.swaps_y_and_z && ending_of(path) == ".abc") {}
    Vec3f operator()(const Vec3f& x) const { return scale_ * (swap_ ? Vec3f{x.x, x.z, x.y} : x); }
    float length(double metres) const { return float(metres) * scale_; }
    bool swaps_y_and_z() const { return swap_; }

  private:
    float scale_;
    bool swap_;
};

// The strands that are written: in the order of the file that they came from.
class ExportedStrands {
  public:
    ExportedStrands(const RunReader& run, const ExportOptions& o)
        : run_(run), options_(o), origin_(origins_of(run.header().groom)), order_(origin_.size()) {
        std::iota(order_.begin(), order_.end(), 0);
        std::stable_sort(order_.begin(), order_.end(),
                         [&](int a, int b) { return origin(a).number < origin(b).number; });
        const Strands& rest = run.header().groom.rest;
        particles_ = rest.particles;
        for (int s : order_) roots_.push_back(rest.at(s, 0));
        if (o.guides) guides_ = guides_of(roots_, o.guides);
    }

    size_t count() const { return order_.size(); }
    int points_of_each() const { return options_.resample ? options_.resample : particles_; }
    const Guides& guides() const { return guides_; }
    bool has_wetness() const { return !run_.header().saturation.empty(); }

    // Of the strands named, or of all; `path` in the file.
    CurvesObject layout(const std::string& path, const Axes& axes,
                        const std::vector<int>* some = nullptr) const {
        CurvesObject out;
        out.path = path;
        for (size_t k = 0; k < (some ? some->size() : count()); ++k) {
            const size_t at = some ? size_t((*some)[k]) : k;
            const StrandOrigin& from = origin(order_[at]);
            out.counts.push_back(points_of_each());
            out.ids.push_back(from.id), out.groups.push_back(from.group);
            out.root_uv.push_back({from.uv[0], from.uv[1]});
            for (int i = 0; i < points_of_each(); ++i)
                out.widths.push_back(axes.length(width_at(order_[at], i)));
        }
        if (std::all_of(out.groups.begin(), out.groups.end(), [](int group) { return group == 0; }))
            out.groups.clear();
        return out;
    }
    // [m] of a strand of the run at one of the points that are written.
    double width_at(int s, int i) const {
        if (options_.width > 0) return options_.width;
        const std::vector<float>& width = run_.header().groom.width;
        if (width.empty()) return usual_width(s, i);
        const float* own = &width[size_t(s) * size_t(particles_)];
        const bool is_said = std::any_of(own, own + particles_, [](float w) { return w > 0; });
        return is_said ? double(value_at(own, i)) : usual_width(s, i);
    }
    // Whose hair has the width of what no file says.
    void take_widths_of(const Scene& scene) { scene_ = &scene; }

    // (strand, point) [m] of a frame of the run.
    std::vector<Vec3f> points(int frame) const {
        const RunFrame read = run_.frame(frame);
        const Strands& strands = options_.positions == "simulated" ? read.positions : read.seen();
        return in_order(strands.points, [&](const Vec3f* strand, Vec3f* to) {
            if (!options_.resample) {
                std::copy_n(strand, particles_, to);
                return;
            }
            std::vector<Vec3d> given(static_cast<size_t>(particles_));
            std::transform(strand, strand + particles_, given.begin(),
                           [](const Vec3f& x) { return cast<double>(x); });
            const std::vector<Vec3d> even = resampled(given, options_.resample);
            std::transform(even.begin(), even.end(), to, [](const Vec3d& x) { return cast<float>(x); });
        });
    }
    // (strand, point): saturation.
    std::vector<float> wetness(int frame) const {
        if (!has_wetness()) return {};
        const RunFrame read = run_.frame(frame);
        return in_order(read.wetness(run_.header()), [&](const float* strand, float* to) {
            for (int i = 0; i < points_of_each(); ++i) to[i] = value_at(strand, i);
        });
    }

  private:
    const StrandOrigin& origin(int s) const { return origin_[size_t(s)]; }
    double usual_width(int s, int i) const {
        return scene_->hair_width(s, double(i) / (points_of_each() - 1));
    }
    // At a point that is written, of values at the particles of its strand.
    float value_at(const float* strand, int i) const {
        const double at = double(i) * (particles_ - 1) / (points_of_each() - 1);
        const int before = std::min(int(at), particles_ - 2);
        const float share = float(at - before);
        return strand[before] + share * (strand[before + 1] - strand[before]);
    }
    template <class T, class Write>
    std::vector<T> in_order(const std::vector<T>& from, Write write) const {
        std::vector<T> out(count() * size_t(points_of_each()));
#pragma omp parallel for schedule(static)
        for (size_t k = 0; k < count(); ++k)
            write(&from[size_t(order_[k]) * size_t(particles_)], &out[k * size_t(points_of_each())]);
        return out;
    }

    const RunReader& run_;
    const ExportOptions& options_;
    std::vector<StrandOrigin> origin_;  // (strand of the run)
    std::vector<int> order_;            // (strand written): strand of the run
    std::vector<Vec3f> roots_;          // (strand written) [m]
    Guides guides_;                     // strands written
    int particles_ = 0;
    const Scene* scene_ = nullptr;
};

// Points of some strands.
template <class T>
std::vector<T> of_strands(const std::vector<T>& all, const std::vector<int>& some, int points) {
    std::vector<T> out;
    for (int s : some)
        out.insert(out.end(), all.begin() + long(s) * points, all.begin() + long(s + 1) * points);
    return out;
}

// Frames of the run that are written.
std::vector<int> frames_of(const ExportOptions& o, int there) {
    int first = 0, last = there - 1;
    if (!o.frames.empty()) {
        const size_t colon = o.frames.find(':');
        const std::string a = o.frames.substr(0, colon),
                          b = colon == std::string::npos ? a : o.frames.substr(colon + 1);
        auto number = [&](const std::string& text) {
            if (text.empty() || text.size() > 9 || text.find_first_not_of("0123456789") != std::string::npos)
                throw Misuse("--frames: found '" + o.frames +
                             "', allowed FIRST:LAST or one frame, as 0:47 or 12");
            return std::stoi(text);
        };
        first = number(a), last = number(b);
        if (first > last || last >= there)
            throw Misuse("--frames: found " + o.frames + ", but " + o.run + " has frames 0 to " +
                         std::to_string(there - 1));
    }
    std::vector<int> out;
    for (int f = first; f <= last; f += o.every) out.push_back(f);
    return out;
}

// Where it is written frame by frame: the run of '#' in the name becomes the frame's number.
std::string numbered(const std::string& pattern, int number) {
    const size_t first = pattern.find('#');
    if (first == std::string::npos) return pattern;
    const size_t end = pattern.find_first_not_of('#', first);
    std::string digits = std::to_string(number);
    const size_t wide = (end == std::string::npos ? pattern.size() : end) - first;
    if (digits.size() < wide) digits.insert(0, wide - digits.size(), '0');
    return pattern.substr(0, first) + digits + (end == std::string::npos ? "" : pattern.substr(end));
}

const Target& target_named(const std::string& name) {
    return *std::find_if(std::begin(targets), std::end(targets),
                         [&](const Target& t) { return name == t.name; });
}

SceneFileSettings settings_of(const ExportOptions& o, const Target& target, const Axes& axes, double fps,
                              int first) {
    return {.fps = fps,
            .first_frame = o.first_number + first,
            .every = o.every,
            .metres_per_unit = target.metres,
            .up = 'y',
            .swaps_y_and_z = axes.swaps_y_and_z(),
            .for_unreal = target.for_unreal};
}

bool repeat(std::vector<int> ids) {
    std::sort(ids.begin(), ids.end());
    return std::adjacent_find(ids.begin(), ids.end()) != ids.end();
}

// The strands as one animated file.
class AnimatedExport {
  public:
    AnimatedExport(const ExportOptions& o, const RunReader& run, const ExportedStrands& strands,
                   const ShotCuts& cuts, const Target& target, const std::vector<int>& frames)
        : run_(run),
          strands_(strands),
          cuts_(cuts),
          axes_(target, o.output),
          some_(o.guides ? &strands.guides().strands : nullptr),
          file_(create_scene_file(o.output, o.overwrite,
                                  settings_of(o, target, axes_, run.header().fps, frames.front()))) {
        CurvesObject animated = strands.layout(some_ ? "/hair/guides" : "/hair/strands", axes_, some_);
        if (!some_) {
            animated_ = file_->add_curves(animated);
            return;
        }
        animated.is_guide.assign(some_->size(), 1);
        // All strands as they are at first, with the guides that they follow: by their numbers among the
        // guides, for Unreal by their ids.
        CurvesObject all = strands.layout("/hair/strands", axes_);
        if (target.for_unreal && repeat(all.ids)) {
            log_warning(
                o.output +
                ": ids of strands repeat and could not name a guide; groom_id is the strand's number");
            std::iota(all.ids.begin(), all.ids.end(), 0);
            animated.ids = *some_;
        }
        animated_ = file_->add_curves(animated);
        all.is_guide.assign(strands.count(), 0);
        std::vector<int> guide_of(strands.count(), -1);
        for (size_t g = 0; g < some_->size(); ++g)
            guide_of[size_t((*some_)[g])] = target.for_unreal ? animated.ids[g] : int(g);
        all.guides = strands.guides().nearest, all.weights = strands.guides().weights;
        for (auto& nearest : all.guides)
            for (int& guide : nearest) guide = guide_of[size_t(guide)];
        still_ = file_->add_curves(all);
        still_frame_.points = converted(strands.points(frames.front()));
    }

    void append(int f) {
        // Cuts count the frames of the scene, of which the run may be a later part.
        const int in_scene = f + int(std::lround(run_.header().start * run_.header().fps));
        const int before = cuts_.at(in_scene) ? f : std::max(f - 1, 0),
                  after = cuts_.at(in_scene + 1) ? f : std::min(f + 1, run_.frames() - 1);
        const std::vector<Vec3f>& now = at(f);
        CurvesFrame frame{chosen(converted(now)), {}, chosen(strands_.wetness(f))};
        if (run_.frames() > 1) {
            // Central differences, one-sided at cuts and at the ends of the run; zero between two of them.
            const std::vector<Vec3f> late = at(after), early = at(before);
            const float rate = float(run_.header().fps) / float(std::max(after - before, 1));
            std::vector<Vec3f> velocity(late.size());
            for (size_t k = 0; k < late.size(); ++k) velocity[k] = rate * (late[k] - early[k]);
            frame.velocities = chosen(converted(velocity));
        }
        file_->append_curves(animated_, frame);
        if (some_) file_->append_curves(still_, still_frame_);  // kept once: it is the same in all frames
    }
    void finish() { file_->finish(); }

  private:
    std::vector<Vec3f> converted(std::vector<Vec3f> points) const {
        for (auto& x : points) x = axes_(x);
        return points;
    }
    template <class T>
    std::vector<T> chosen(std::vector<T> all) const {
        return some_ && !all.empty() ? of_strands(all, *some_, strands_.points_of_each()) : all;
    }
    // The frames around the last one asked for are kept.
    const std::vector<Vec3f>& at(int f) {
        auto& kept = kept_[size_t(f % 3)];
        if (kept.frame != f) kept = {f, strands_.points(f)};
        return kept.points;
    }
    struct Kept {
        int frame = -1;
        std::vector<Vec3f> points;
    };

    const RunReader& run_;
    const ExportedStrands& strands_;
    const ShotCuts cuts_;
    Axes axes_;
    const std::vector<int>* some_;
    std::unique_ptr<SceneWriter> file_;
    size_t animated_ = 0, still_ = 0;
    CurvesFrame still_frame_;
    Kept kept_[3];
};

// Head and solids as one animated file.
class SolidsExport {
  public:
    SolidsExport(const ExportOptions& o, const RunReader& run, const Target& target,
                 const std::vector<int>& frames)
        : run_(run),
          axes_(target, o.solids),
          file_(create_scene_file(
              o.solids, o.overwrite,
              settings_of(o, {.metres = target.metres}, axes_, run.header().fps, frames.front()))) {
        const std::vector<PosedMesh> solids = at(frames.front());
        if (solids.empty()) throw Misuse("--solids: the scene of " + o.run + " has no solid to write");
        for (size_t k = 0; k < solids.size(); ++k) {
            MeshObject object;
            object.path = "/solids/solid_" + std::to_string(k);
            for (const auto& corners : solids[k].mesh.triangles) {
                object.counts.push_back(3);
                object.corners.insert(object.corners.end(), corners.begin(), corners.end());
            }
            object.points = solids[k].mesh.vertices.size();
            file_->add_mesh(object);
        }
    }
    void append(int f) {
        size_t k = 0;
        for (const PosedMesh& solid : at(f)) {
            std::vector<Vec3f> points;
            for (const auto& x : solid.mesh.vertices)
                points.push_back(axes_(cast<float>(solid.pose(cast<double>(x)))));
            file_->append_mesh(k++, points);
        }
    }
    void finish() { file_->finish(); }

  private:
    std::vector<PosedMesh> at(int f) const {
        return solids_of(run_.header(), run_.frame(f), run_.header().time(f));
    }

    const RunReader& run_;
    Axes axes_;
    std::unique_ptr<SceneWriter> file_;
};

// A file of strands for each frame, metres and Y up unless a program asks for another unit.
void write_frame(const ExportOptions& o, const ExportedStrands& strands, const Target& target, int f) {
    const int n = strands.points_of_each();
    const Axes axes(target, o.output);
    const std::vector<Vec3f> points = strands.points(f);
    const CurvesObject layout = strands.layout("", axes);
    StrandPoints out(strands.count(), std::vector<Vec3d>(size_t(n)));
    StrandWidths widths(strands.count(), std::vector<float>(size_t(n)));
    for (size_t s = 0; s < out.size(); ++s)
        for (size_t i = 0; i < size_t(n); ++i) {
            out[s][i] = cast<double>(axes(points[s * size_t(n) + i]));
            widths[s][i] = layout.widths[s * size_t(n) + i];
        }
    write_strands(numbered(o.output, o.first_number + f), out, o.overwrite, widths,
                  target.metres == 1 ? "metres" : "centimetres");
}

void check(const ExportOptions& o) {
    if (o.every < 1) throw Misuse("--every: found " + std::to_string(o.every) + ", allowed 1 or more");
    if (o.resample == 1)
        throw Misuse("--resample: found 1, allowed 0 (as the run has it) or 2 points and more");
    if (!o.solids.empty() && !is_scene_file(o.solids))
        throw Misuse("--solids: found '" + o.solids + "', allowed are .abc and .usda");
    if (!o.solids.empty() && o.solids == o.output)
        throw Misuse("--solids: found the output's own name; strands and solids have a file each");
    if (is_scene_file(o.output)) {
        check_files(o, o.output, {o.run});
        return;
    }
    if (o.guides)
        throw Misuse("--guides: goes with .abc and .usda, which hold them beside the rest; found " +
                     o.output);
    const std::string ending = ending_of(o.output);
    if ((" " + writable_endings() + " ").find(" " + ending + " ") == std::string::npos)
        throw Misuse("export: found the output '" + o.output + "', allowed endings .abc .usda " +
                     writable_endings());
    check_files(o, numbered(o.output, o.first_number), {o.run});
}

}  // namespace

void add_options(OptionList& options, ExportOptions& o) {
    options.option("run", o.run, "RUN.h5").input_file().required();
    options
        .option("-o,--output", o.output,
                "NAME.abc or NAME.usda: all frames; NAME.####.hair .data .ply .obj .tfx .pbrt: one file a "
                "frame, its number in the place of #")
        .required();
    options
        .option("--for", o.target,
                "the program that reads it: blender, houdini, maya, unreal; its unit, axes and attributes "
                "(default: metres, Y up)")
        .one_of({"blender", "houdini", "maya", "unreal"});
    options.option("--positions", o.positions, "displayed, as render shows them, or simulated, before Eq 10")
        .one_of({"displayed", "simulated"})
        .shows_default();
    options.option("--frames", o.frames, "of the run, FIRST:LAST or one (default: all)");
    options.option("--every", o.every, "write every so many frames").shows_default();
    options.option("--first-number", o.first_number, "number of the run's frame 0 in the file")
        .shows_default();
    options.option("--resample", o.resample, "points a strand, evenly along it; 0: as the run has it")
        .within(0, 10000);
    options
        .option("--guides", o.guides,
                "animate so many strands alone; the others stand still, each with three of them and their "
                "weights")
        .positive();
    options
        .option("--width", o.width,
                "diameter of the hair [m] (default: as its file says, else by the scene's density)")
        .within(1e-7, 1.0);
    options.option("--solids", o.solids, "NAME.abc or NAME.usda for head and solids");
}

int export_command(const ExportOptions& given) {
    ExportOptions o = given;
    o.run = run_to_read(o.run);
    check(o);
    ResultFile results(o);
    const RunReader run(o.run);
    if (run.frames() == 0) throw Error(o.run + ": there is no frame in it to write");
    const std::vector<int> frames = frames_of(o, run.frames());
    const bool animated = is_scene_file(o.output);
    if (!animated && frames.size() > 1 && o.output.find('#') == std::string::npos)
        throw Misuse("export: found " + std::to_string(frames.size()) + " frames for one file " + o.output +
                     "; write NAME.####" + fs::path(o.output).extension().string() +
                     " for a file a frame, or choose one by --frames");
    if (!animated)
        for (const int f : frames) require_place(numbered(o.output, o.first_number + f), o.overwrite);
    const Target& target = target_named(o.target);
    ExportedStrands strands(run, o);
    const auto scene = scene_of_run(run.header());
    strands.take_widths_of(*scene);

    InterruptGuard guard;
    std::optional<AnimatedExport> hair;
    std::optional<SolidsExport> solids;
    if (animated) hair.emplace(o, run, strands, scene->cuts, target, frames);
    if (!o.solids.empty()) solids.emplace(o, run, target, frames);
    Progress progress("export", int(frames.size()), "frame");
    for (size_t k = 0; k < frames.size(); ++k) {
        if (guard.asked())
            throw Interrupted("interrupted after " + std::to_string(k) +
                              " frames: what was begun is not kept");
        if (hair)
            hair->append(frames[k]);
        else
            write_frame(o, strands, target, frames[k]);
        if (solids) solids->append(frames[k]);
        progress.update(int(k) + 1);
    }
    if (hair) hair->finish();
    if (solids) solids->finish();
    log_info("wrote " + o.output + (solids ? " and " + o.solids : ""));
    results.write_json(Json{{"run", o.run},
                            {"output", o.output},
                            {"strands", strands.count()},
                            {"animated", o.guides ? size_t(o.guides) : strands.count()},
                            {"points_of_each", strands.points_of_each()},
                            {"frames", frames.size()},
                            {"first_number", o.first_number + frames.front()},
                            {"metres_per_unit", target.metres}});
    return 0;
}

}  // namespace wetcurl

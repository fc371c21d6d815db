// A run that begins at a frame of another one.
#include "app/engine/run_start.h"

#include <fmt/format.h>

#include <charconv>
#include <filesystem>

#include "app/engine/state_file.h"
#include "app/files/run_file.h"
#include "base/geometry/frames.h"
#include "base/log.h"

namespace wetcurl {

std::string RunStart::words() const { return fmt::format("{} frame {}", file, frame); }

RunStart run_start(const std::string& from) {
    const size_t at = from.rfind('@');
    RunStart start;
    start.file = run_to_read(from.substr(0, at));
    const RunReader run(start.file);
    start.header = run.header();
    start.frame = run.frames() - 1;
    if (at != std::string::npos) {
        const char *begin = from.data() + at + 1, *end = from.data() + from.size();
        const auto [rest, error] = std::from_chars(begin, end, start.frame);
        if (error != std::errc() || rest != end)
            throw Misuse("--from: found '" + from + "', allowed is RUN.h5@N, N the number of a frame");
    }
    if (start.frame < 0 || start.frame >= run.frames())
        throw Misuse(fmt::format("--from: found frame {}, allowed 0 to {}, which {} has", start.frame,
                                 run.frames() - 1, start.file));
    start.now = run.frame(start.frame);
    if (start.frame > 0) start.before = run.frame(start.frame - 1);
    return start;
}

void take_wetness(Scene& scene, const RunStart& start) {
    const Strands &was = start.header.groom.rest, &is = scene.groom.rest;
    if (was.count != is.count || was.particles != is.particles)
        throw Error(
            fmt::format("--from: {} has {} strands of {} particles, the scene {} of {}; allowed is the "
                        "same groom",
                        start.file, was.count, was.particles, is.count, is.particles));
    if (start.header.groom.hash() != scene.groom.hash())
        log_warning(fmt::format("--from: {}: its strands at rest are others than the scene's", start.file));
    const auto& wetness = start.now.wetness(start.header);
    if (scene.wetness && !wetness.empty()) scene.saturation = wetness;
}

namespace {

// Frames of edges that come along from time 0: turned as their root is, then minimally onto the edges where
// they are now.
void carry_frames(const Scene& scene, const RunStart& start, SimulationState& s) {
    const size_t n = size_t(scene.groom.rest.particles);
    RidingRoots::Room before, now;
    if (scene.riding) scene.root_poses_at(0, before), scene.root_poses_at(start.time(), now);
    const Pose head_before = scene.head_at(0);
    for (size_t k = 0; k < s.frame.size(); ++k) {
        if ((k + 1) % n == 0) continue;
        const Quatd &from = scene.riding ? before.pose[k / n].rotation : head_before.rotation,
                    &to = scene.riding ? now.pose[k / n].rotation : start.now.head.rotation;
        s.frame[k] = transported(normalized(to * conjugate(from) * s.frame[k]), s.x[k + 1] - s.x[k]);
    }
}

SimulationState state_at(const RunStart& start, const Simulation& simulation) {
    SimulationState s = simulation.state();
    const auto& points = start.now.positions.points;
    s.time = start.time(), s.first = true;
    for (size_t k = 0; k < points.size(); ++k) {
        s.x[k] = s.x_before[k] = cast<double>(points[k]);
        s.v[k] = {0, 0, 0};
        if (start.frame > 0)
            s.v[k] = start.header.fps * (s.x[k] - cast<double>(start.before.positions.points[k]));
        s.v_before[k] = s.v[k];
    }
    carry_frames(simulation.scene(), start, s);
    for (size_t k = 0; k < s.touching.size() && k < start.now.contact.size(); ++k)
        s.touching[k] = start.now.contact[k];
    s.saturation.clear();  // the scene's own, which is the frame's
    return s;
}

bool same_place(const Pose& a, const Pose& b) {
    const Quatd d = a.rotation * conjugate(b.rotation);
    return norm(a.translation - b.translation) < 1e-6 && std::abs(std::abs(d.w) - 1) < 1e-9;
}

}  // namespace

void go_to(SceneRun& run, const RunStart& start) {
    Simulation& simulation = run.simulation();
    if (!same_place(run.scene().head_at(start.time()), start.now.head))
        log_warning(fmt::format("--from: the scene's head is elsewhere at {:.3f} s than in {}: roots jump",
                                start.time(), start.words()));
    const std::string file = state_file_of(
        start.file.ends_with(".partial") ? start.file.substr(0, start.file.size() - 8) : start.file);
    const RunState fresh = simulation.run_state();
    if (frame_of_state(file)) {
        const StoredState stored = read_state(file, fresh, false);
        if (stored.frame == start.frame && stored.facts.run == facts_of(start.header, "").run) {
            simulation.resume(stored.state);
            return log_info(fmt::format("{}: its state is in {}", start.words(), file));
        }
    }
    simulation.restore(state_at(start, simulation));
    log_info(start.words() + ": " +
             (start.frame > 0 ? "velocities by the difference to the frame before" : "strands at rest"));
}

}  // namespace wetcurl

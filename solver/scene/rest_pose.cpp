// The pose in which hair was made.
#include "solver/scene/rest_pose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/geometry/file_frame.h"
#include "base/log.h"

namespace wetcurl {

namespace {

// Of a scene file the object that is animated, where it has more than one.
Mesh pose_in(const Table& t, const SolidTable& read) {
    try {
        return first_mesh(read.rest, read.object);
    } catch (const Misuse& e) {
        t.fail("rest", e.what());
    }
}

}  // namespace

RestPose rest_of(const Table& t, const SolidTable& read, const FileAxes& said) {
    if (read.rest.empty()) return {};
    if (!std::filesystem::exists(read.rest)) t.fail("rest", "no file '" + read.rest + "'");
    const FileAxes own = axes_of_mesh(read.rest);
    RestPose out{pose_in(t, read), read.rest};
    const double unit =
        own.metres_per_unit && said.metres_per_unit ? *own.metres_per_unit / *said.metres_per_unit : 1;
    const bool turns = own.up && said.up && *own.up != *said.up;
    if (unit == 1 && !turns) return out;
    for (Vec3f& v : out.mesh->vertices) {
        Vec3d x = unit * cast<double>(v);
        if (turns) x = laid_along(std::string(1, *said.up), upright(std::string(1, *own.up), x));
        v = cast<float>(x);
    }
    return out;
}

RestPose rest_of(const Table& t, const SolidTable& read, const MeshFrames& frames, double fps) {
    if (!read.rest_frame) return rest_of(t, read, frames.axes());
    if (!read.rest.empty())
        t.fail("rest_frame", "found beside rest; allowed is one of them, a frame or a file of its own");
    const auto& times = frames.times();
    const double asked = *read.rest_frame, near = 0.25,
                 first = fps * std::min(frames.axes().start.value_or(times.front()), times.front());
    size_t found = times.size();
    for (size_t k = 0; k < times.size(); ++k) {
        const double number = fps * times[k];
        if (std::abs(number - asked) < near || (is_scene_file(read.file) && number < asked)) found = k;
    }
    if (found == times.size() && asked > first - near && asked < fps * times.front()) found = 0;
    if (found == times.size() || asked > fps * times.back() + near)
        t.fail("rest_frame",
               fmt::format("found {}, but {} has frames {:g} to {:g} at {:g} a second (file_fps)", asked,
                           read.file, first, fps * times.back(), fps));
    std::vector<Vec3f> vertices = frames.vertices(found);
    const auto is_held = [&] {
        return std::ranges::equal(vertices, frames.vertices(found + 1),
                                  [](const Vec3f& a, const Vec3f& b) { return norm(a - b) == 0; });
    };
    if (asked - fps * times[found] > near && !is_held())
        t.fail(
            "rest_frame",
            fmt::format("found {}, but {} holds the mesh at frames {:g} and {:g} and moves it between them",
                        asked, read.file, fps * times[found], fps * times[found + 1]));
    return {Mesh{std::move(vertices), frames.triangles()}, frames.name_of(found)};
}

void warn_of_still_mesh(const SolidTable& read) {
    log_warning(
        read.file +
        ": holds the mesh at one time alone, and it stands still; where it should move, export it with "
        "its animation, over the frames of the shot");
}

void warn_of_other_rate(const SolidTable& read, const MeshFrames& frames, double fps) {
    const auto& times = frames.times();
    if (read.file_fps || frames.axes().rate || !is_scene_file(read.file) || times.size() < 2) return;
    const double rate = double(times.size() - 1) / (times.back() - times.front());
    const auto is_whole = [](double x) { return std::abs(x - std::round(x)) < 0.02; };
    if (is_whole(fps / rate) || is_whole(rate / fps)) return;
    log_warning(fmt::format(
        "{}: its samples lie 1/{:.4g} s apart, and numbers of its frames are counted at {:g} a second; "
        "file_fps = {:.4g} in the [[solid]] counts them so",
        read.file, rate, fps, rate));
}

}  // namespace wetcurl

// Frames of a run with the head's motion.
#include "learn/codec/frame_window.h"

#include <cmath>
#include <utility>

#include "base/gravity.h"

namespace wetcurl {

Vec3d HeadWindow::angular_velocity() const {
    if (!inner) return {0, 0, 0};
    const Quatd q = normalized(after.rotation * conjugate(before.rotation));
    const Vec3d v{q.x, q.y, q.z};
    const double sine = norm(v), sign = q.w < 0 ? -1 : 1;
    if (sine < 1e-15) return {0, 0, 0};
    const double angle = 2 * std::atan2(sine, std::abs(q.w));
    return (sign * angle * fps / 2 / sine) * v;
}

Vec3d HeadWindow::acceleration(const Vec3d& x) const {
    if (!inner) return {0, 0, 0};
    return fps * fps * (after(x) - 2.0 * now(x) + before(x));
}

Vec3d gravity_of(const RunHeader& header) {
    Gravity read;
    read_parameters(
        read, Gravity::parameters,
        Config::parse(header.scene, scene_name(header), header.scene_folder).root().table(Gravity::table));
    return read.gravity;
}

static HeadWindow heads_of(const RunHeader& header) {
    HeadWindow heads;
    heads.fps = header.fps;
    heads.gravity = gravity_of(header);
    return heads;
}

FrameWindow::FrameWindow(const RunReader& run)
    : stored_(run), frames_(*stored_), heads_(heads_of(run.header())) {}

FrameWindow::FrameWindow(FrameSource& frames, const RunHeader& header)
    : frames_(frames), heads_(heads_of(header)) {}

Pose gone_on(const Pose& before, const Pose& now) {
    return {normalized(now.rotation * conjugate(before.rotation) * now.rotation),
            2.0 * now.translation - before.translation};
}

bool FrameWindow::advance() {
    const bool first = index_ < 0;
    if (first) has_next_ = frames_.next(next_);
    if (!has_next_) return false;
    ++index_;
    std::swap(now_, next_);
    has_next_ = frames_.next(next_);
    heads_.before = heads_.now;
    heads_.now = now_.head;
    if (has_next_)
        heads_.after = next_.head;
    else if (!first)
        heads_.after = gone_on(heads_.before, heads_.now);
    heads_.inner = !first;
    return true;
}

}  // namespace wetcurl

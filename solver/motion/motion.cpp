// Keyframes by monotone cubic Hermite splines; oscillations eased in and out.
#include "solver/motion/motion.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include "base/log.h"
#include "solver/motion/spline.h"

namespace wetcurl {

using std::numbers::pi;

Motion::Motion(const Table& t) {
    MotionTable read;
    read_parameters(read, MotionTable::parameters, t);
    pivot_ = read.pivot, axis_ = read.axis, shift_ = read.shift;
    period_ = read.period, start_ = read.start;
    if (norm(axis_) < 1e-6) t.fail("axis", "found a zero vector, a direction is needed");
    axis_ = normalized(axis_, axis_);
    angle_ = read.angle * pi / 180;
    if (period_ == 0 && (angle_ != 0 || norm(shift_) > 0))
        t.fail("period", "an oscillation needs a period above 0 [s]");
    for (const Table& k : t.tables("keyframe")) {
        KeyframeTable key;
        read_parameters(key, KeyframeTable::parameters, k);
        const Vec3d &r = key.rotation, &x = key.translation;
        keys_.push_back({key.time, {r.x * pi / 180, r.y * pi / 180, r.z * pi / 180, x.x, x.y, x.z}});
    }
    if (!read.file.empty()) read_file(t, read.file);
    check_times(t);
    rest_at({});
}

ShotCuts cuts_of(const Table& motion, double fps, double seconds) {
    CutsTable read;
    read_parameters(read, CutsTable::parameters, motion);
    for (const int frame : read.cuts)
        if (const double last = std::round(seconds * fps); frame > last)
            log_warning(motion.where("cuts") + ": frame " + std::to_string(frame) +
                        " comes after the last, " + std::to_string(int(last)) + ": it cuts nothing");
    return {read.cuts, fps, motion.has("cuts")};
}

void Motion::read_file(const Table& t, const std::string& path) {
    std::ifstream in(path);
    if (!in) t.fail("file", "no file '" + path + "'");
    std::string line;
    for (int number = 1; std::getline(in, line); ++number) {
        if (line.empty() || line[0] == '#') continue;
        std::stringstream words(line);
        Key k;
        words >> k.time;
        for (double& v : k.value) words >> v;
        bool finite = bool(words) && std::isfinite(k.time);
        for (double v : k.value) finite = finite && std::isfinite(v);
        if (!finite)
            throw Misuse(path + ":" + std::to_string(number) + ": found '" + line +
                         "', needed: time rx ry rz [degrees] tx ty tz [m]");
        for (int c = 0; c < 3; ++c) k.value[c] *= pi / 180;
        keys_.push_back(k);
    }
    if (keys_.empty()) t.fail("file", "'" + path + "' holds no keyframe");
}

void Motion::check_times(const Table& t) const {
    for (size_t k = 1; k < keys_.size(); ++k)
        if (!(keys_[k].time > keys_[k - 1].time))
            t.fail("keyframe", "times must grow; keyframe " + std::to_string(k) + " does not");
}

void Motion::rest_at(const ShotCuts& cuts) {
    slopes_.assign(keys_.size(), Key{0, {}});
    for (size_t k = 1; k + 1 < keys_.size(); ++k) {
        if (cuts.between(keys_[k - 1].time, keys_[k].time) || cuts.between(keys_[k].time, keys_[k + 1].time))
            continue;
        for (int c = 0; c < 6; ++c) {
            const double h0 = keys_[k].time - keys_[k - 1].time, h1 = keys_[k + 1].time - keys_[k].time;
            const double d0 = (keys_[k].value[c] - keys_[k - 1].value[c]) / h0,
                         d1 = (keys_[k + 1].value[c] - keys_[k].value[c]) / h1;
            slopes_[k].value[c] = monotone_slope(h0, d0, h1, d1);
        }
    }
}

Pose Motion::at(double time) const {
    if (driven_) return driven_->at(time);
    double v[6] = {};
    if (!keys_.empty()) {
        const auto after = std::upper_bound(keys_.begin(), keys_.end(), time,
                                            [](double x, const Key& k) { return x < k.time; });
        if (after == keys_.begin()) {
            std::copy_n(keys_.front().value, 6, v);
        } else if (after == keys_.end()) {
            std::copy_n(keys_.back().value, 6, v);
        } else {
            const size_t k = size_t(after - keys_.begin()) - 1;
            const double h = keys_[k + 1].time - keys_[k].time, s = (time - keys_[k].time) / h;
            const HermiteWeights w = hermite_weights(s, h);
            for (int c = 0; c < 6; ++c)
                v[c] = w.from * keys_[k].value[c] + w.from_slope * slopes_[k].value[c] +
                       w.to * keys_[k + 1].value[c] + w.to_slope * slopes_[k + 1].value[c];
        }
    }
    Vec3d r{v[0], v[1], v[2]};
    Pose pose{Quatd::identity(), {v[3], v[4], v[5]}};
    if (const double angle = norm(r); angle > 0) pose.rotation = rotation_about((1 / angle) * r, angle);
    if (period_ > 0 && time > start_) {
        // The sine's own first quarter eases in: its amplitude grows over half a period, so velocity starts
        // at 0.
        const double run = time - start_, ease = std::min(1.0, run / (0.5 * period_));
        const double s = ease * ease * (3 - 2 * ease) * std::sin(2 * pi * run / period_);
        pose.rotation = rotation_about(axis_, s * angle_) * pose.rotation;
        pose.translation += s * shift_;
    }
    pose.translation += pivot_ - rotate(pose.rotation, pivot_);
    return pose;
}

}  // namespace wetcurl

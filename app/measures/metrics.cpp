// Comparison of runs, frame by frame: no more than four frames of each are in memory.
#include "app/measures/metrics.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/geometry/neighbor_grid.h"
#include "base/same_pose.h"
#include "learn/codec/core_detail.h"

namespace wetcurl {

namespace {

constexpr int sampled_frames = 16;
constexpr size_t sampled_points = 50000;
constexpr float depth_tolerance = 1e-4f;  // [m]
constexpr float near_solid = 0.02f;       // [m]
constexpr float crowd_reach = 4e-3f;      // [m]

std::vector<Vec3f> tips_of(const Strands& strands) {
    std::vector<Vec3f> out;
    for (int s = 0; s < strands.count; ++s) out.push_back(strands.at(s, strands.particles - 1));
    return out;
}

std::vector<Vec3f> directions_of(const Strands& strands) {
    std::vector<Vec3f> out(strands.points.size());
    const int n = strands.particles;
    for (int s = 0; s < strands.count; ++s)
        for (int i = 0; i < n; ++i) {
            const int k = std::min(i, n - 2);
            out[size_t(s) * n + i] = normalized(strands.at(s, k + 1) - strands.at(s, k), Vec3f{0, -1, 0});
        }
    return out;
}

// Share of (sampled) points of `from` that find a counterpart in `in`, for each of the three thresholds.
std::array<double, 3> share_found(const Strands& from, const Strands& in) {
    constexpr float reach[3] = {2e-3f, 3e-3f, 4e-3f};
    float cosine[3];
    for (int t = 0; t < 3; ++t) cosine[t] = float(std::cos((20 + 10 * t) * std::numbers::pi / 180));
    NeighborGrid grid;
    grid.build(in.points.data(), in.points.size(), reach[2]);
    const auto along_from = directions_of(from), along_in = directions_of(in);
    const size_t step = (from.points.size() + sampled_points - 1) / sampled_points;
    const long queries = long((from.points.size() + step - 1) / step);
    long found[3] = {0, 0, 0};
#pragma omp parallel for schedule(dynamic, 256) reduction(+ : found[:3])
    for (long q = 0; q < queries; ++q) {
        const size_t k = size_t(q) * step;
        const Vec3f x = from.points[k];
        bool hit[3] = {false, false, false};
        grid.around(x, [&](uint32_t j) {
            if (hit[0]) return;  // the narrowest threshold holds the others
            const Vec3f d = grid.sorted(j) - x;
            const float r2 = dot(d, d);
            if (r2 > reach[2] * reach[2]) return;
            const float c = dot(along_from[k], along_in[grid.order()[j]]);
            for (int t = 0; t < 3; ++t) hit[t] = hit[t] || (r2 <= reach[t] * reach[t] && c >= cosine[t]);
        });
        for (int t = 0; t < 3; ++t) found[t] += hit[t];
    }
    std::array<double, 3> out;
    for (size_t t = 0; t < 3; ++t) out[t] = queries ? double(found[t]) / double(queries) : 0;
    return out;
}

// Distances of x to its k nearest among the others, nearest first.
class Nearest {
  public:
    explicit Nearest(int k) : k_(size_t(k)) {}
    void offer(float distance) {
        if (best_.size() == k_ && distance >= best_.back()) return;
        best_.insert(std::upper_bound(best_.begin(), best_.end(), distance), distance);
        if (best_.size() > k_) best_.pop_back();
    }
    bool full() const { return best_.size() == k_; }
    const std::vector<float>& distances() const { return best_; }

  private:
    size_t k_;
    std::vector<float> best_;
};

// For each point its distances to its k nearest others (k at most the number of others).
std::vector<Nearest> nearest_others(const std::vector<Vec3f>& points, int k) {
    const size_t n = points.size();
    k = std::min<int>(k, int(n) - 1);
    std::vector<Nearest> out(n, Nearest(std::max(k, 0)));
    if (k <= 0) return out;
    Vec3f low = points[0], high = points[0];
    for (const Vec3f& p : points) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    // Points on a surface: a few of them within this radius. Where that finds too few, all are tried.
    const float radius = std::max(1e-6f, 2 * norm(high - low) / std::sqrt(float(n)));
    NeighborGrid grid;
    grid.build(points.data(), n, radius);
#pragma omp parallel for schedule(dynamic, 64)
    for (size_t i = 0; i < n; ++i) {
        grid.around(points[i], [&](uint32_t j) {
            const float r = norm(grid.sorted(j) - points[i]);
            if (grid.order()[j] != i && r <= radius) out[i].offer(r);
        });
        if (out[i].full()) continue;
        out[i] = Nearest(k);
        for (size_t j = 0; j < n; ++j)
            if (j != i) out[i].offer(norm(points[j] - points[i]));
    }
    return out;
}

// Mean, median and 95th percentile (both to 2 micrometres) and maximum of many distances.
class Distances {
  public:
    void add(float metres) {
        const size_t bin = std::min(bins_, size_t(metres / bin_width_));
        if (bin >= count_.size()) count_.resize(bin + 1, 0);
        ++count_[bin];
        ++n_;
        sum_ += metres;
        max_ = std::max(max_, metres);
    }
    double mean() const { return n_ ? sum_ / double(n_) : 0; }
    Spread millimetres() const { return {mean() * 1e3, share(0.95) * 1e3, max_ * 1e3, share(0.5) * 1e3}; }

  private:
    // That this share of them stays below.
    double share(double of) const {
        const size_t wanted = size_t(std::ceil(of * double(n_)));
        size_t seen = 0, bin = 0;
        while (bin < count_.size() && (seen += count_[bin]) < wanted) ++bin;
        return std::min<double>(max_, (double(bin) + 0.5) * bin_width_);
    }
    static constexpr float bin_width_ = 2e-6f;
    static constexpr size_t bins_ = 1000000;  // 2 m, all beyond in the last
    std::vector<size_t> count_;
    size_t n_ = 0;
    double sum_ = 0;
    float max_ = 0;
};

struct Mean {
    double sum = 0;
    long n = 0;
    void add(double x, long count = 1) {
        sum += x;
        n += count;
    }
    double value() const { return n ? sum / double(n) : 0; }
};

// What one run shows by itself, frame after frame.
class RunShape {
  public:
    explicit RunShape(const RunReader& run) : groom_(run.header().groom), link_(clump_link(groom_)) {}

    void add(const Strands& p, const Pose& head, bool sampled) {
        for (float r : curl_radii(p)) curl_.add(r);
        add_stretch(p);
        if (sampled) {
            tips_.add(tip_spread(p));
            clumps_.add(clump_count(p, link_));
            crowd_.add(wetcurl::crowd(p, crowd_reach));
        }
        last_.push_front(p);
        heads_.push_front(head);
        if (last_.size() > 4) {
            last_.pop_back();
            heads_.pop_back();
        }
        if (stands_still()) add_jitter();
    }
    // Of the frame `back` frames ago.
    const Strands& frame(size_t back) const { return last_[back]; }

    double curl() const { return curl_.value(); }
    double stretch() const { return stretch_; }
    double mean_stretch() const { return stretches_.value(); }
    double tips() const { return tips_.value(); }
    double clumps() const { return clumps_.value(); }
    double crowd() const { return crowd_.value(); }
    std::optional<double> jitter_mm() const {
        return jitter_.n ? std::optional(1e3 * std::sqrt(jitter_.value())) : std::nullopt;
    }

  private:
    bool stands_still() const {
        return last_.size() == 4 && std::all_of(heads_.begin(), heads_.end(),
                                                [&](const Pose& h) { return same_pose(h, heads_[0], 1e-6); });
    }
    void add_stretch(const Strands& p) {
        for (int s = 0; s < p.count; ++s)
            for (int i = 0; i + 1 < p.particles; ++i) {
                const float l = norm(groom_.rest.at(s, i + 1) - groom_.rest.at(s, i));
                if (l <= 0) continue;
                const double stretch = norm(p.at(s, i + 1) - p.at(s, i)) / l - 1;
                stretch_ = std::max(stretch_, stretch);
                stretches_.add(std::abs(stretch));
            }
    }
    void add_jitter() {
        for (size_t k = 0; k < last_[0].points.size(); ++k) {
            const Vec3f d = last_[0].points[k] - 3.0f * last_[1].points[k] + 3.0f * last_[2].points[k] -
                            last_[3].points[k];
            jitter_.add(dot(d, d));
        }
    }
    const Groom& groom_;
    float link_;
    Mean curl_, tips_, clumps_, crowd_, jitter_, stretches_;
    double stretch_ = -1;
    std::deque<Strands> last_;
    std::deque<Pose> heads_;
};

// Places of values in their order, equal ones sharing the mean of theirs.
std::vector<double> ranks_of(const std::vector<double>& values) {
    std::vector<size_t> order(values.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return values[a] < values[b]; });
    std::vector<double> ranks(values.size());
    for (size_t begin = 0, end; begin < order.size(); begin = end) {
        for (end = begin; end < order.size() && values[order[end]] == values[order[begin]];) ++end;
        for (size_t k = begin; k < end; ++k) ranks[order[k]] = 0.5 * double(begin + end - 1);
    }
    return ranks;
}

// What a network expected of each strand, against how far it is off, means over the frames.
class ExpectedError {
  public:
    void add(const Strands& a, const Strands& b, const std::vector<float>& expected) {
        if (expected.empty()) return;
        const size_t strands = size_t(a.count), pieces = expected.size() / strands;
        expected_.resize(strands, 0), found_.resize(strands, 0);
        for (size_t s = 0; s < strands; ++s) {
            for (size_t k = 0; k < pieces; ++k)
                expected_[s] += double(expected[s * pieces + k]) / double(pieces);
            for (int i = 0; i < a.particles; ++i)
                found_[s] += double(norm(b.at(int(s), i) - a.at(int(s), i))) / a.particles;
        }
        ++frames_;
    }
    void tell(Comparison& out) const {
        if (!frames_) return;
        double sum = 0;
        for (double e : expected_) sum += e;
        out.expected_mm = 1e3 * sum / double(expected_.size()) / frames_;
        out.expected_rank = rank_correlation(expected_, found_);
    }

  private:
    std::vector<double> expected_, found_;  // (strand), summed
    int frames_ = 0;
};

// Equal particles of both runs.
class PositionError {
  public:
    // `followed`: as of a RunHeader; where it is not known: every second root each way.
    PositionError(const Groom& groom, const std::optional<std::vector<int>>& followed)
        : still_(groom.rest.points.size(), Vec3d{0, 0, 0}) {
        const int n = groom.rest.particles;
        for (int s = 0; s < groom.rest.count; ++s)
            length_.push_back(std::max(float(arc_length(groom.rest.strand(s), n)), 1e-9f));
        shared_.assign(size_t(groom.rest.count), 0);
        if (followed)
            for (const int s : *followed) shared_[size_t(s)] = 1;
        for (int row = 0; row < groom.grid.height && !followed; row += 2)
            for (int column = 0; column < groom.grid.width; column += 2)
                if (int s = groom.grid.at(column, row); s >= 0) shared_[size_t(s)] = 1;
    }
    void add(const Strands& a, const Strands& b, const Pose& head, const std::string& where) {
        const Quatd to_head = conjugate(head.rotation);
        Mean frame;
        for (int s = 0; s < a.count; ++s)
            for (int i = 0; i < a.particles; ++i) {
                const Vec3d e = cast<double>(b.at(s, i) - a.at(s, i));
                const double r = norm(e);
                if (!std::isfinite(r))
                    throw Error(where + ": strand " + std::to_string(s) + ", particle " + std::to_string(i) +
                                ": position is not finite");
                all_.add(float(r));
                frame.add(r);
                (shared_[size_t(s)] ? low_ : new_).add(float(r));
                relative_.add(r / length_[size_t(s)]);
                square_.add(r * r);
                still_[size_t(s) * a.particles + i] += rotate(to_head, e);
            }
        mm_per_frame_.push_back(1e3 * frame.value());
    }
    void tell(Comparison& out) const {
        out.position_mm = all_.millimetres();
        out.shared_mm = low_.millimetres();
        out.new_mm = new_.millimetres();
        out.position_rel = relative_.value();
        out.mm_per_frame = mm_per_frame_;
        Mean length, square;
        for (const Vec3d& sum : still_) {
            const Vec3d mean = (1.0 / double(mm_per_frame_.size())) * sum;
            length.add(norm(mean));
            square.add(dot(mean, mean));
        }
        out.static_mm = 1e3 * length.value();
        out.dynamic_mm = 1e3 * std::sqrt(std::max(0.0, square_.value() - square.value()));
    }

  private:
    std::vector<float> length_;
    std::vector<uint8_t> shared_;
    std::vector<Vec3d> still_;  // sum of errors in the head's frame
    Distances all_, low_, new_;
    Mean relative_, square_;
    std::vector<double> mm_per_frame_;
};

// Of particles and solids: how deep the other run's are, and how far from the reference's.
class SolidError {
  public:
    SolidError(const SolidDistance& solid, const Groom& groom, const Pose& start) : solid_(solid) {
        if (!solid_) return;
        allowed_.resize(groom.rest.points.size());
        for (size_t k = 0; k < allowed_.size(); ++k) {
            const Vec3f x = cast<float>(start(cast<double>(groom.rest.points[k])));
            allowed_[k] = std::min(0.0f, solid_(x, start, 0));
        }
    }
    void add(const Strands& a, const Strands& b, const Pose& head, double time) {
        if (!solid_) return;
        for (size_t k = 0; k < b.points.size(); ++k) {
            const float phi_a = solid_(a.points[k], head, time), phi_b = solid_(b.points[k], head, time);
            if (std::min(phi_a, phi_b) < near_solid) distance_.add(std::abs(phi_b - phi_a));
            const float depth = allowed_[k] - phi_b;
            share_.add(depth > depth_tolerance);
            if (depth > depth_tolerance) depth_.add(depth);
            most_ = std::max(most_, depth);
        }
    }
    void tell(Comparison& out) const {
        out.penetration_fraction = share_.value();
        out.penetration_mean_mm = 1e3 * depth_.value();
        out.penetration_max_mm = 1e3 * most_;
        out.solid_distance_mm = distance_.millimetres();
    }

  private:
    const SolidDistance& solid_;
    std::vector<float> allowed_;  // min(0, phi at rest)
    Mean share_, depth_;
    Distances distance_;
    float most_ = 0;
};

void add_curvature(const Strands& a, const Strands& b, Mean& error, Mean& size) {
    for (int s = 0; s < a.count; ++s)
        for (int i = 1; i + 1 < a.particles; ++i) {
            const double k_a = inverse_circumradius(a.at(s, i - 1), a.at(s, i), a.at(s, i + 1));
            const double k_b = inverse_circumradius(b.at(s, i - 1), b.at(s, i), b.at(s, i + 1));
            error.add(std::abs(k_b - k_a));
            size.add(k_a);
        }
}

// Mean over equal particles [m].
void add_distance(const Strands& a, const Strands& b, Mean& mean) {
    for (size_t k = 0; k < a.points.size(); ++k) mean.add(norm(b.points[k] - a.points[k]));
}

void add_velocity(const RunShape& a, const RunShape& b, double fps, Mean& error) {
    for (size_t k = 0; k < a.frame(0).points.size(); ++k) {
        const Vec3f d =
            (b.frame(0).points[k] - b.frame(1).points[k]) - (a.frame(0).points[k] - a.frame(1).points[k]);
        error.add(fps * norm(d));
    }
}

double ratio(double a, double b) { return b > 0 ? a / b : 0; }

// Mean over the frames [first, end) but frame 0, a state that nothing was computed for.
double seconds_per_frame(const RunReader& run, int first, int end) {
    const auto seconds = run.seconds();
    Mean time;
    for (int f = std::max(first, 1); f < end; ++f) time.add(seconds[size_t(f)]);
    return time.value();
}

void require_comparable(const RunReader& reference, const RunReader& other, int first_frame) {
    const RunHeader &a = reference.header(), &b = other.header();
    auto fail = [&](const std::string& what, const std::string& found, const std::string& allowed) {
        throw Error(other.path() + ": " + what + ": found " + found + ", allowed that of " +
                    reference.path() + ": " + allowed);
    };
    auto size = [](const Strands& s) {
        return std::to_string(s.count) + " x " + std::to_string(s.particles);
    };
    if (a.groom.rest.count != b.groom.rest.count || a.groom.rest.particles != b.groom.rest.particles)
        fail("strands and particles", size(b.groom.rest), size(a.groom.rest));
    if (a.groom.hash() != b.groom.hash()) fail("groom", b.groom.hash(), a.groom.hash());
    if (a.fps != b.fps) fail("frames a second", std::to_string(b.fps), std::to_string(a.fps));
    for (const RunReader* run : {&reference, &other})
        if (run->frames() == 0) throw Error(run->path() + ": there is no frame in it");
    if (first_frame < 0 || first_frame >= std::min(reference.frames(), other.frames()))
        throw Error(other.path() + ": first frame: found " + std::to_string(first_frame) + ", allowed 0 to " +
                    std::to_string(std::min(reference.frames(), other.frames()) - 1) +
                    ", which both runs have");
}

}  // namespace

double rank_correlation(const std::vector<double>& a, const std::vector<double>& b) {
    const std::vector<double> x = ranks_of(a), y = ranks_of(b);
    const double mean = 0.5 * double(a.size() - 1);
    double xx = 0, yy = 0, xy = 0;
    for (size_t k = 0; k < x.size(); ++k) {
        xx += (x[k] - mean) * (x[k] - mean), yy += (y[k] - mean) * (y[k] - mean);
        xy += (x[k] - mean) * (y[k] - mean);
    }
    return xx > 0 && yy > 0 ? xy / std::sqrt(xx * yy) : 0;
}

double inverse_circumradius(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const Vec3d u = cast<double>(b - a), v = cast<double>(c - b), w = cast<double>(c - a);
    const double sides = norm(u) * norm(v) * norm(w);
    return sides > 0 ? 2 * norm(cross(u, v)) / sides : 0;
}

std::array<double, 3> oriented_f1(const Strands& reference, const Strands& other) {
    const auto precision = share_found(other, reference), recall = share_found(reference, other);
    std::array<double, 3> out;
    for (size_t t = 0; t < 3; ++t) out[t] = ratio(2 * precision[t] * recall[t], precision[t] + recall[t]);
    return out;
}

double tip_spread(const Strands& strands, int k) {
    Mean mean;
    for (const auto& near : nearest_others(tips_of(strands), k))
        for (float r : near.distances()) mean.add(r);
    return mean.value();
}

int clump_count(const Strands& strands, float link) {
    const auto tips = tips_of(strands);
    std::vector<int> parent(tips.size());
    std::iota(parent.begin(), parent.end(), 0);
    auto top = [&](int i) {
        while (parent[size_t(i)] != i) i = parent[size_t(i)] = parent[size_t(parent[size_t(i)])];
        return i;
    };
    NeighborGrid grid;
    grid.build(tips.data(), tips.size(), std::max(link, 1e-6f));
    int groups = int(tips.size());
    for (size_t i = 0; i < tips.size(); ++i)
        grid.around(tips[i], [&](uint32_t j) {
            if (norm(grid.sorted(j) - tips[i]) >= link) return;
            const int a = top(int(i)), b = top(int(grid.order()[j]));
            if (a == b) return;
            parent[size_t(a)] = b;
            --groups;
        });
    return groups;
}

double crowd(const Strands& strands, float reach) {
    const auto& points = strands.points;
    NeighborGrid grid;
    grid.build(points.data(), points.size(), reach);
    const size_t step = (points.size() + sampled_points - 1) / sampled_points, n = size_t(strands.particles);
    long found = 0, asked = long((points.size() + step - 1) / step);
#pragma omp parallel for schedule(dynamic, 256) reduction(+ : found)
    for (long q = 0; q < asked; ++q) {
        const size_t k = size_t(q) * step;
        grid.around(points[k], [&](uint32_t j) {
            const Vec3f d = grid.sorted(j) - points[k];
            found += grid.order()[j] / n != k / n && dot(d, d) <= reach * reach;
        });
    }
    return asked ? double(found) / double(asked) : 0;
}

float clump_link(const Groom& groom) {
    std::vector<Vec3f> roots;
    for (int s = 0; s < groom.rest.count; ++s) roots.push_back(groom.rest.at(s, 0));
    if (roots.size() < 2) return 0;
    std::vector<float> distance;
    for (const auto& near : nearest_others(roots, 1)) distance.push_back(near.distances()[0]);
    std::nth_element(distance.begin(), distance.begin() + long(distance.size() / 2), distance.end());
    return distance[distance.size() / 2] / 2;
}

Comparison compare(const RunReader& reference, const RunReader& other, int first_frame,
                   const SolidDistance& solid) {
    require_comparable(reference, other, first_frame);
    const int end = std::min(reference.frames(), other.frames());
    const Groom& groom = reference.header().groom;
    const double fps = reference.header().fps;
    Comparison out;
    out.file = other.path();
    out.method = other.header().method;
    out.kind = kind_of(other.header());
    out.frames = end - first_frame;

    RunShape shape_a(reference), shape_b(other);
    PositionError position(groom, other.header().followed);
    ExpectedError expected;
    SolidError solid_error(solid, groom, other.frame(0).head);
    Mean curvature_error, curvature, velocity, strands;
    std::array<Mean, 3> f1;
    const int step = (out.frames + sampled_frames - 1) / sampled_frames;
    for (int f = first_frame; f < end; ++f) {
        const RunFrame frame_a = reference.frame(f), frame_b = other.frame(f);
        const std::string where = other.path() + ": frame " + std::to_string(f);
        if (!same_pose(frame_a.head, frame_b.head, 1e-5))
            throw Error(where + ": the head is elsewhere than in " + reference.path() +
                        ", allowed the same motion");
        const Strands &a = frame_a.seen(), &b = frame_b.seen();
        const bool sampled = (f - first_frame) % step == 0;
        position.add(a, b, frame_a.head, where);
        expected.add(a, b, frame_b.expected_error);
        shape_a.add(a, frame_a.head, sampled);
        shape_b.add(b, frame_b.head, sampled);
        add_curvature(a, b, curvature_error, curvature);
        if (frame_a.displayed.count && frame_b.displayed.count)
            add_distance(frame_a.positions, frame_b.positions, strands);
        if (f > first_frame) add_velocity(shape_a, shape_b, fps, velocity);
        solid_error.add(a, b, frame_b.head, other.header().time(f));
        if (sampled) {
            const auto found = oriented_f1(a, b);
            for (size_t t = 0; t < 3; ++t) f1[t].add(found[t]);
        }
    }

    out.seconds_per_frame = seconds_per_frame(other, first_frame, end);
    out.seconds_per_frame_reference = seconds_per_frame(reference, first_frame, end);
    position.tell(out);
    expected.tell(out);
    solid_error.tell(out);
    for (size_t t = 0; t < 3; ++t) out.f1[t] = f1[t].value();
    out.curvature_error = ratio(curvature_error.value(), curvature.value());
    out.curl_radius_ratio = ratio(shape_b.curl(), shape_a.curl());
    out.stretch_max = shape_b.stretch();
    out.stretch_max_reference = shape_a.stretch();
    out.stretch_mean = shape_b.mean_stretch();
    out.stretch_mean_reference = shape_a.mean_stretch();
    if (strands.n) out.strands_mm = 1e3 * strands.value();
    out.tip_spread_mm = 1e3 * shape_b.tips();
    out.tip_spread_reference_mm = 1e3 * shape_a.tips();
    out.tip_spread_ratio = ratio(shape_b.tips(), shape_a.tips());
    out.clumps = shape_b.clumps();
    out.clumps_reference = shape_a.clumps();
    out.crowd = shape_b.crowd();
    out.crowd_reference = shape_a.crowd();
    out.jitter_mm = shape_b.jitter_mm();
    out.jitter_reference_mm = shape_a.jitter_mm();
    out.velocity_error = velocity.value();
    return out;
}

}  // namespace wetcurl

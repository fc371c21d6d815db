// Runs thinned out and quantised.
#include "app/report/report_player.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>

#include "app/engine/run_solids.h"
#include "base/run_cache.h"

namespace wetcurl {

namespace {

constexpr size_t positions_at_once = 80000;  // of all runs, in a frame
constexpr int solid_points = 300, most_frames = 72;
constexpr float comparable = 2.5f;  // a solid larger than that many times the hair is a floor, and not drawn

// Particles to keep, root and tip among them.
std::vector<int> particles_kept(int count, int kept) {
    std::vector<int> out;
    for (int k = 0; k < kept; ++k)
        out.push_back(int(std::lround(double(k) * (count - 1) / std::max(1, kept - 1))));
    return out;
}

struct Extremes {
    Vec3f low{1e9f, 1e9f, 1e9f}, high{-1e9f, -1e9f, -1e9f};
    void add(const Vec3f& x) {
        low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
        high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
    }
    float diagonal() const { return norm(high - low); }
};

Extremes box_of(const std::vector<Vec3f>& points) {
    Extremes box;
    for (const Vec3f& x : points) box.add(x);
    return box;
}

// The points that lie furthest in directions spread evenly (Fibonacci's spiral): a solid's outline from any
// side.
std::vector<Vec3f> outermost(const std::vector<Vec3f>& points) {
    std::vector<Vec3f> out;
    for (int k = 0; k < solid_points; ++k) {
        const float y = 1 - 2 * (float(k) + 0.5f) / solid_points, r = std::sqrt(1 - y * y),
                    a = float(k) * float(std::numbers::pi * (3 - std::sqrt(5.0)));
        const Vec3f d{r * std::cos(a), y, r * std::sin(a)};
        out.push_back(*std::max_element(points.begin(), points.end(), [&](const Vec3f& p, const Vec3f& q) {
            return dot(p, d) < dot(q, d);
        }));
    }
    return out;
}

std::string quantised(const std::vector<Vec3f>& points, const Extremes& box) {
    std::vector<uint8_t> bytes;
    bytes.reserve(6 * points.size());
    const auto put = [&](float x, float low, float high) {
        const float share = high > low ? (x - low) / (high - low) : 0;
        const long n = std::lround(65535 * std::clamp(share, 0.f, 1.f));
        bytes.push_back(uint8_t(n & 255)), bytes.push_back(uint8_t(n >> 8));
    };
    for (const Vec3f& p : points) {
        put(p.x, box.low.x, box.high.x);
        put(p.y, box.low.y, box.high.y);
        put(p.z, box.low.z, box.high.z);
    }
    return base64(bytes);
}

}  // namespace

Kept kept_of(int runs, int frames, int strands, int particles, size_t bytes) {
    for (int step = (frames + most_frames - 1) / most_frames;; ++step) {
        Kept kept{strands, particles, step, (frames + step - 1) / step};
        const auto in_a_frame = [&] { return size_t(runs) * size_t(kept.strands) * size_t(kept.particles); };
        const auto fits = [&] {
            return in_a_frame() <= positions_at_once && 6 * in_a_frame() * size_t(kept.frames) <= bytes;
        };
        while (!fits() && (kept.strands > 1 || kept.particles > 2)) {
            const bool too_many = kept.strands / 300.0 >= kept.particles / 48.0;
            if (kept.strands > 1 && (too_many || kept.particles == 2))
                kept.strands -= std::max(1, kept.strands / 32);
            else
                kept.particles -= std::max(1, kept.particles / 32);
        }
        const bool enough =
            kept.strands >= std::min(strands, 200) && kept.particles >= std::min(particles, 36);
        if ((enough && fits()) || kept.frames == 1 || (kept.frames <= 24 && fits())) return kept;
    }
}

std::vector<int> strands_kept(int count, int kept) {
    std::vector<int> order(static_cast<size_t>(count));
    std::iota(order.begin(), order.end(), 0);
    // Multiples of the golden ratio, modulo 1: the first few are as evenly spread as many.
    std::sort(order.begin(), order.end(),
              [](int a, int b) { return uint32_t(a) * 2654435769u < uint32_t(b) * 2654435769u; });
    order.resize(size_t(std::min(count, kept)));
    std::sort(order.begin(), order.end());
    return order;
}

Json player_of(const std::vector<std::string>& paths, const std::vector<std::string>& names, int first_frame,
               double error_mm) {
    std::vector<std::unique_ptr<RunReader>> runs;
    int frames = 0;
    for (const auto& path : paths) {
        runs.push_back(std::make_unique<RunReader>(path));
        const int n = runs.back()->frames() - first_frame;
        frames = runs.size() == 1 ? n : std::min(frames, n);
    }
    const RunHeader& header = runs[0]->header();
    const Strands& rest = header.groom.rest;
    // Water that flows is a seventh byte, an expected error one more.
    int more = 0;
    for (const auto& run : runs) {
        const RunFrame frame = run->frame(first_frame);
        more = std::max(more, int(!frame.saturation.empty()) + int(!frame.expected_error.empty()));
    }
    const Kept kept = kept_of(int(runs.size()), frames, rest.count, rest.particles,
                              size_t(14'000'000 * 6) / size_t(6 + more));
    const auto strands = strands_kept(rest.count, kept.strands),
               particles = particles_kept(rest.particles, kept.particles);

    Extremes box;
    std::vector<std::vector<Vec3f>> positions(runs.size()), solids;
    std::vector<std::vector<uint8_t>> saturation(runs.size()), expected(runs.size());
    const auto byte = [](double share) { return uint8_t(std::lround(255 * std::clamp(share, 0., 1.))); };
    for (int k = 0; k < kept.frames; ++k) {
        const int f = first_frame + k * kept.frame_step;
        for (size_t r = 0; r < runs.size(); ++r) {
            const RunFrame frame = runs[r]->frame(f);
            const auto& wetness = frame.wetness(runs[r]->header());
            const bool wet = !wetness.empty() && (k == 0 || !frame.saturation.empty());
            for (int s : strands)
                for (int i : particles) {
                    positions[r].push_back(frame.seen().at(s, i));
                    box.add(positions[r].back());
                    if (wet)
                        saturation[r].push_back(
                            byte(double(wetness[size_t(s) * size_t(rest.particles) + size_t(i)])));
                    if (!frame.expected_error.empty())
                        expected[r].push_back(byte(1e3 * double(frame.expected_at(s, i)) / error_mm));
                }
            if (r > 0) continue;
            const float hair = box_of(frame.seen().points).diagonal();
            const auto posed = solids_of(header, frame, header.time(f));
            solids.resize(posed.size());
            for (size_t b = 0; b < posed.size(); ++b) {
                std::vector<Vec3f> world;
                for (const Vec3f& v : posed[b].mesh.vertices)
                    world.push_back(cast<float>(posed[b].pose(cast<double>(v))));
                if (world.empty() || box_of(world).diagonal() > comparable * hair) continue;
                const auto outline = outermost(world);
                for (const Vec3f& x : outline) box.add(x);
                solids[b].insert(solids[b].end(), outline.begin(), outline.end());
            }
        }
    }

    const auto list = [](const Vec3f& v) { return Json{v.x, v.y, v.z}; };
    Json json{{"fps", header.fps},
              {"first_frame", first_frame},
              {"frame_step", kept.frame_step},
              {"frames", kept.frames},
              {"strands", strands.size()},
              {"particles", particles.size()},
              {"of", {{"frames", frames}, {"strands", rest.count}, {"particles", rest.particles}}},
              {"low", list(box.low)},
              {"size", list(box.high - box.low)},
              {"error_mm", error_mm},
              {"runs", Json::array()},
              {"solids", Json::array()}};
    for (size_t r = 0; r < runs.size(); ++r)
        json["runs"].push_back({{"name", names[r]},
                                {"method", runs[r]->header().method},
                                {"positions", quantised(positions[r], box)},
                                {"saturation", saturation[r].empty() ? Json() : Json(base64(saturation[r]))},
                                {"expected", expected[r].empty() ? Json() : Json(base64(expected[r]))}});
    for (const auto& solid : solids)
        // One that is not drawn in every frame has no place in the list.
        if (solid.size() == size_t(kept.frames) * solid_points)
            json["solids"].push_back(quantised(solid, box));
    return json;
}

std::string base64(const std::vector<uint8_t>& bytes) {
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (size_t k = 0; k < bytes.size(); k += 3) {
        const size_t n = std::min<size_t>(3, bytes.size() - k);
        uint32_t word = 0;
        for (size_t i = 0; i < 3; ++i) word = word << 8 | (i < n ? bytes[k + i] : 0u);
        for (size_t i = 0; i < 4; ++i) out += i <= n ? letters[word >> (18 - 6 * i) & 63] : '=';
    }
    return out;
}

}  // namespace wetcurl

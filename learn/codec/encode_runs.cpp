// Runs to pairs.
#include "learn/codec/encode_runs.h"

#include <numeric>
#include <sstream>

#include "base/same_pose.h"

namespace wetcurl {

RunPair::RunPair(const std::string& dry_path, const std::string& wet_path)
    : dry(std::make_unique<RunReader>(dry_path)), wet(std::make_unique<RunReader>(wet_path)) {
    const RunHeader &d = dry->header(), &w = wet->header();
    auto same = [&](const std::string& what, auto found, auto allowed) {
        if (found == allowed) return;
        std::ostringstream text;
        text << dry_path << ": " << what << ": found " << found << ", allowed " << allowed << " (as "
             << wet_path << " has it)";
        throw Error(text.str());
    };
    same("seed", d.seed, w.seed);
    same("frames", dry->frames(), wet->frames());
    same("frames a second", d.fps, w.fps);
    if (dry->frames() == 0) throw Error(dry_path + ": there is no frame in it");
    if (!simulated_wet(w))
        throw Error(wet_path + ": found a run '" + w.method +
                    "', allowed as the second of a pair is one that was simulated wet (simulate without "
                    "--dry, of a scene with [wetness])");
    if (w.saturation.empty())
        throw Error(wet_path + ": knows no saturation, allowed is a run of a scene with [wetness]");
    same("particles of a strand", d.groom.rest.particles, w.groom.rest.particles);
    if (d.groom.rest.count >= w.groom.rest.count)
        throw Error(dry_path + ": found " + std::to_string(d.groom.rest.count) +
                    " low-resolution strands, allowed are fewer than " + std::to_string(w.groom.rest.count) +
                    ", which " + wet_path + " has");
    require_part();
}

void RunPair::require_part() const {
    if (dry->header().guides > 0 && wet->header().stride > 1) return;  // guides are of the whole groom
    try {
        wetcurl::require_part(wet->header().groom, dry->header().groom);
    } catch (const Error& e) {
        throw Error(dry->path() + ", " + wet->path() + ": " + e.what());
    }
}

void RunPair::require_nested() const {
    try {
        wetcurl::require_nested(wet->header().groom, dry->header().groom);
    } catch (const Error& e) {
        throw Error(dry->path() + ", " + wet->path() + ": " + e.what());
    }
}

// The frames of both, side by side, their heads checked.
template <class Visit>
static void for_each_frame(const RunPair& pair, const std::string& what, Visit visit) {
    const InterruptGuard guard;
    FrameWindow window(*pair.dry);
    FrameDelivery frames({what, pair.dry->frames()}, guard);
    frames.run(window, [&](int index, const RunFrame& dry) {
        const RunFrame wet = pair.wet->frame(index);
        if (!same_pose(dry.head, wet.head, 1e-6))
            throw Error(pair.dry->path() + ": frame " + std::to_string(index) +
                        ": the head is elsewhere than in " + pair.wet->path() + ", allowed the same motion");
        visit(window, wet);
    });
    if (!frames.is_whole())
        throw Interrupted("interrupted at frame " + std::to_string(frames.delivered()) + " of " +
                          pair.dry->path());
}

StrandEncoder::StrandEncoder(const Groom& high, const Groom& low, const std::vector<float>& saturation,
                             const Strands* shape, bool low_is_wet, const HairTraits& traits)
    : codec_(high, low, saturation, shape, low_is_wet, traits) {}

StrandPairs StrandEncoder::begin(int frames, bool displayed) const {
    std::vector<int> all(static_cast<size_t>(frames));
    std::iota(all.begin(), all.end(), 0);
    return {frames,         static_channels, dynamic_channels, codec_.height(), codec_.width(),
            codec_.fixed(), codec_.mask(),   codec_.length(),  displayed,       all};
}

void StrandEncoder::take_up(const Strands& low, const HeadWindow& heads) {
    dynamic_.resize(size_t(dynamic_channels) * codec_.pixels());
    codec_.dynamic(low, heads, dynamic_.data());
    head_ = heads.now;
}

double StrandEncoder::encode(const Strands& wet, std::vector<float>& target) {
    target.resize(size_t(strand_coefficients) * codec_.pixels());
    codec_.encode(wet, head_, target.data());
    for (size_t k = 0; k < target.size(); ++k) target[k] -= dynamic_[k];  // the base comes first
    codec_.decode(target.data(), head_, decoded_);
    double sum = 0;
    for (size_t k = 0; k < wet.points.size(); ++k) sum += norm(decoded_.points[k] - wet.points[k]);
    return 1e3 * sum / double(wet.points.size());
}

double encode_strands(const RunPair& pair, PairsWriter& out, const Strands* shape, const HairTraits& traits) {
    const RunHeader& wet_header = pair.wet->header();
    if (!pair.wet->frame(0).saturation.empty())
        throw Error(pair.wet->path() +
                    ": its water moves ([wetness.flow]), allowed for the strand codec is "
                    "wetness that stays; --codec root takes each frame's");
    StrandEncoder encoder(wet_header.groom, pair.dry->header().groom, wet_header.saturation, shape,
                          simulated_wet(pair.dry->header()), traits);
    const bool displayed = !pair.wet->frame(0).displayed.points.empty();
    out.begin(encoder.begin(pair.dry->frames(), displayed));
    std::vector<float> target, after;
    double floor_mm = 0;
    for_each_frame(pair, "encode", [&](const FrameWindow& window, const RunFrame& wet) {
        encoder.take_up(window.now().positions, window.heads());
        floor_mm += encoder.encode(wet.positions, target);
        if (displayed) encoder.encode(wet.displayed, after);
        out.append(encoder.dynamic().data(), target.data(), displayed ? after.data() : nullptr);
    });
    return floor_mm / pair.dry->frames();
}

static std::vector<float> coloured(const RootImage& image, std::vector<Vec3f> roots, const ColourBox& box) {
    for (Vec3f& p : roots) p = colour_of(p, box);
    std::vector<float> out(3 * image.pixels());
    image.draw(roots, out.data());
    return out;
}

std::vector<float> root_colours(const RootImage& image, const Strands& strands,
                                const std::vector<float>& saturation, float support_radius,
                                const ColourBox& box) {
    return coloured(image, shifted_roots(strands, saturation, support_radius), box);
}

PairRoots roots_of(const RunPair& pair, float support_radius, ShiftUnits units, ColourBox& box) {
    PairRoots roots;
    for_each_frame(pair, "roots", [&](const FrameWindow& window, const RunFrame& wet) {
        roots.dry.push_back(shifted_roots(window.now().positions, {}, support_radius));
        roots.wet.push_back(
            shifted_roots(wet.seen(), wet.wetness(pair.wet->header()), support_radius, units));
        grow(box, roots.dry.back());
        grow(box, roots.wet.back());
    });
    return roots;
}

void encode_roots(const std::vector<RunPair>& pairs, float support_radius, PairsWriter& out,
                  ShiftUnits units) {
    ColourBox box;
    std::vector<PairRoots> all;
    for (const RunPair& pair : pairs) pair.require_nested();
    for (const RunPair& pair : pairs) all.push_back(roots_of(pair, support_radius, units, box));
    if (!(box.diagonal() > 0))
        throw Error("root codec: all roots lie in one point, allowed is a box with a diagonal");
    out.box(&box.lower.x, &box.upper.x);
    out.attribute("support_radius", support_radius);
    out.attribute("colour_units", name_of(units));
    for (size_t p = 0; p < pairs.size(); ++p) {
        const RootImage low(pairs[p].dry->header().groom.grid), high(pairs[p].wet->header().groom.grid, 2);
        out.begin(RootPairs{int(all[p].dry.size()), low.height(), low.width(), low.mask(), high.mask()});
        for (size_t f = 0; f < all[p].dry.size(); ++f)
            out.append(coloured(low, all[p].dry[f], box).data(), coloured(high, all[p].wet[f], box).data());
    }
}

}  // namespace wetcurl

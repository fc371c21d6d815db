// Strands that a network is not trusted with.
#include "app/inference/simulated_strands.h"

#include <algorithm>

#include "app/engine/scene_changes.h"
#include "base/same_pose.h"

namespace wetcurl {

namespace {

Scene before_cohesion(const Scene& scene, const std::vector<int>& strands) {
    Scene part = part_of_scene(scene, strands);
    leave_out_display(part);
    return part;
}

}  // namespace

std::vector<int> not_trusted(Predictor& predictor, LowRun& low, int frames, double within,
                             const InterruptGuard& guard) {
    FrameWindow window(low.source(), low.header());
    std::vector<double> sum;
    Strands p;
    int seen = 0;
    for (; seen < frames && window.advance(); ++seen) {
        if (guard.asked()) throw Interrupted("interrupted before the first frame");
        predictor.apply(window.index(), window.now(), window.heads(), p);
        const std::vector<float> expected = predictor.expected_error();
        sum.resize(size_t(p.count), 0);
        const size_t pieces = expected.size() / sum.size();
        for (size_t k = 0; k < expected.size(); ++k) sum[k / pieces] += double(expected[k]) / double(pieces);
    }
    std::vector<int> out;
    for (size_t s = 0; s < sum.size(); ++s)
        if (sum[s] > within * seen) out.push_back(int(s));
    return out;
}

SimulatedStrands::SimulatedStrands(const Scene& scene, const std::string& file, std::vector<int> strands,
                                   const PredictionRequest& request)
    : strands_(std::move(strands)),
      run_(file, before_cohesion(scene, strands_), request.device, request.threads) {}

void SimulatedStrands::put(const Pose& head, Strands& p) {
    if (!run_.source().next(frame_)) throw Error(run_.file() + ": its simulation has no more frames");
    if (!same_pose(head, frame_.head, 1e-6))
        throw Error(run_.file() + ": its head moves in another way than that of the low-resolution run, " +
                    "allowed with --within is the same motion");
    for (size_t k = 0; k < strands_.size(); ++k)
        std::copy_n(frame_.positions.strand(int(k)), p.particles, p.strand(strands_[k]));
}

}  // namespace wetcurl

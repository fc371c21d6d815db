// Learned frames of the fixed workload: codec, network and placement, input and output where they are used.
// Ours.
#include <fmt/format.h>

#include <filesystem>

#include "app/bench.h"
#include "app/learned_hair.h"
#include "learn/network_module.h"
#include "solver/plan.h"
#ifdef WETCURL_HAVE_CUDA
#include "base/device_buffer.h"
#endif

namespace wetcurl::bench {

namespace {

// Dry strands of every second root each way.
const Workload workloads[] = {{64, 32, 0.0042, 0}, {220, 180, 0.0012, 0}};

// The frame as it lies in the memory that the network reads and writes.
class Frame {
  public:
    Frame(LearnedStrands& learned, const Strands& low, size_t out, bool on_device) {
        if (!on_device) {
            low_ = low.points, out_.resize(out);
            learned.bind(low_.data(), out_.data());
            return;
        }
#ifdef WETCURL_HAVE_CUDA
        device_low_ = DeviceBuffer<Vec3f>(low.points), device_out_ = DeviceBuffer<Vec3f>(out);
        learned.bind(device_low_.data(), device_out_.data(), true);
#endif
    }

  private:
    std::vector<Vec3f> low_, out_;
#ifdef WETCURL_HAVE_CUDA
    DeviceBuffer<Vec3f> device_low_, device_out_;
#endif
};

Line learned_frame(const Workload& w, const std::string& model, const std::string& name,
                   const std::string& device, int threads) {
    const Scene high = scene_of(w, true);
    const Groom low = coarsened(high.groom, 2);
    const auto learned = learned_strands_of(model, high, high.title, low, device, threads);
    const Strands& shape = high.groom.rest;
    const Frame frame(*learned, low.rest, shape.points.size(), device != "cpu");
    const HeadWindow heads;
    learned->run(heads);  // the second one captures
    Line line;
    line.name = name, line.series = name.substr(0, name.find(',')) + name.substr(name.rfind(','));
    line.size = shape.count, line.item = "particle", line.items = double(shape.points.size());
    line.bytes = line.items * sizeof(Vec3f) + double(low.rest.points.size()) * sizeof(Vec3f);
    line.operations = 2.0 * double(learned->card().parameters) * shape.count;
    line.strands = shape.count, line.particles = shape.particles;
    line.seconds = repeated([&] { return [&] { learned->run(heads); }; });
    return line;
}

}  // namespace

std::vector<Entry> learned_entries(const std::vector<std::string>& models, const std::string& device,
                                   int threads) {
    std::vector<Entry> out;
    for (const auto& model : models)
        for (const Workload& w : workloads) {
            // After other networks Eq 10 follows, which is not of this frame.
            const bool whole = network_module().card(model).target == "displayed";
            const std::string name =
                fmt::format("learned frame{}, {} strands, {}", whole ? "" : " before cohesion", w.strands(),
                            std::filesystem::path(model).stem().string());
            out.push_back({{name},
                           "learned frame",
                           [=](Results& results) {
                               results.lines.push_back(learned_frame(w, model, name, device, threads));
                           },
                           ""});
        }
    return out;
}

}  // namespace wetcurl::bench

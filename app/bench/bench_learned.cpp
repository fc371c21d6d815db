// Learned frames of the fixed workload: codec, network and placement, input and output where they are used.
#include <fmt/format.h>

#include <filesystem>

#include "app/bench/bench.h"
#include "app/engine/device.h"
#include "app/engine/learned_hair.h"
#include "learn/codec/network_module.h"
#include "solver/chain/scene_checks.h"
#ifdef WETCURL_HAVE_CUDA
#include "base/device_buffer.h"
#endif

namespace wetcurl::bench {

namespace {

// The low-resolution run has every second root each way.
const Workload workloads[] = {{64, 32, 0.0042, 0}, {220, 180, 0.0012, 0}};

// As the network learned it: dry, or wet before Eq 10.
Scene low_scene_of(const Workload& w, const ModelCard& card) {
    std::vector<std::string> set;
    if (card.low_substeps) set.push_back(fmt::format("integrator.substeps={}", card.low_substeps));
    Scene low = scene_of(w, card.low == "wet", set, 2);
    leave_out_display(low);
    return low;
}

// What of a frame is timed: the network, the run before it too, and Eq 10 after it.
enum class Part { network, with_run, with_cohesion };

// With Eq 10 at particles so far apart along a strand [m], and over-relaxed.
Workload thinned(Workload w, double spacing, double relaxation = 1, int substeps = 10) {
    w.spacing = spacing, w.relaxation = relaxation, w.substeps = substeps;
    return w;
}

// As `infer` shows it.
Scene high_scene_of(const Workload& w, const ModelCard& card) {
    Scene high = scene_of(w, true);
    if (card.target == "displayed") high.cohesion->passes = passes_after_displayed(high.cohesion->passes);
    return high;
}

// A network on the workload's hair, in and out where it computes.
class TimedHair {
  public:
    TimedHair(const Workload& w, const std::string& model, const std::string& device, int threads, Part part)
        : high_(high_scene_of(w, network_module().card(model))),
          low_(low_scene_of(w, network_module().card(model))),
          device_(device),
          learned_(learned_strands_of(model, high_, high_.title, low_.groom,
                                      1 / (low_.fps * low_.integrator.substeps), device, threads),
                   high_, device, part == Part::with_cohesion) {
        if (part == Part::with_cohesion) learned_.strands().lead_edges(most_length_rounds);
    }

    const Strands& high() const { return high_.groom.rest; }
    const Scene& low() const { return low_; }
    // Of strands that hang at rest.
    Times at_rest() {
        low_points_ = low_.groom.rest.points;
        const Vec3f* low = low_points_.data();
#ifdef WETCURL_HAVE_CUDA
        if (on_device()) low = (device_low_ = DeviceBuffer<Vec3f>(low_points_)).data();
#endif
        bind(low);
        return repeated([&] { return [&] { learned_.run(HeadWindow(), 0); }; });
    }
    // Of strands that are simulated before each frame: read where they are.
    Times simulated() {
        const auto simulation = make_simulation_on(device_, low_, "float");
        RunFrame frame;
        simulation->snapshot(frame);
        low_points_ = frame.positions.points;
        bind(on_device() ? simulation->positions_on_device() : low_points_.data());
        return repeated([&] {
            return [&] {
                // Not by SimulatedFrames, whose check of every strand would be timed as well.
                simulation->advance();
                if (!on_device()) {
                    simulation->snapshot(frame);
                    std::copy(frame.positions.points.begin(), frame.positions.points.end(),
                              low_points_.begin());
                }
                learned_.run(HeadWindow(), 0);
            };
        });
    }
    size_t parameters() { return size_t(learned_.strands().card().parameters); }

  private:
    bool on_device() const { return device_ != "cpu"; }
    void bind(const Vec3f* low) {
        const size_t count = high().points.size();
        if (!on_device()) {
            out_.resize(count);
            learned_.bind(low, out_.data(), false);
        }
#ifdef WETCURL_HAVE_CUDA
        if (on_device()) {
            device_out_ = DeviceBuffer<Vec3f>(count);
            learned_.bind(low, device_out_.data(), true);
        }
#endif
        learned_.run(HeadWindow(), 0);  // the second one captures
    }

    Scene high_, low_;
    std::string device_;
    LearnedHair learned_;
    std::vector<Vec3f> low_points_, out_;
#ifdef WETCURL_HAVE_CUDA
    DeviceBuffer<Vec3f> device_low_, device_out_;
#endif
};

Line learned_frame(const Workload& w, const std::string& model, const std::string& name,
                   const std::string& device, int threads, Part part) {
    TimedHair hair(w, model, device, threads, part);
    const Strands& shape = hair.high();
    Line line;
    line.name = name, line.series = name.substr(0, name.find(',')) + name.substr(name.rfind(','));
    line.size = shape.count, line.item = "particle", line.items = double(shape.points.size());
    line.bytes = sizeof(Vec3f) * (line.items + double(hair.low().groom.rest.points.size()));
    line.operations = 2.0 * double(hair.parameters()) * shape.count;
    line.strands = shape.count, line.particles = shape.particles;
    line.seconds = part == Part::network ? hair.at_rest() : hair.simulated();
    return line;
}

}  // namespace

std::vector<Entry> learned_entries(const std::vector<std::string>& models, const std::string& device,
                                   int threads) {
    std::vector<Entry> out;
    // What they stand in for, where no other entry is that; and cheaper ones.
    const Workload& large = workloads[1];
    if (!models.empty())
        for (const Workload& w : {large, thinned(large, 0.0125, 3.4), thinned(large, 0.0125, 3.4, 4),
                                  thinned(large, 0.0125, 3.4, 2), thinned(large, 0.02, 3.4, 4)})
            out.push_back({names_of(w, true), "wet frame",
                           [=](Results& results) {
                               const auto lines = whole_frames(w, true, device, false);
                               results.lines.insert(results.lines.end(), lines.begin(), lines.end());
                           },
                           ""});
    for (const auto& model : models)
        for (const Workload& w : workloads) {
            auto add = [&](const std::string& what, Part part, const Workload& w) {
                const std::string name = fmt::format("{}, {} strands, {}", what, w.strands(),
                                                     std::filesystem::path(model).stem().string());
                out.push_back({{name},
                               "learned frame",
                               [=](Results& results) {
                                   results.lines.push_back(
                                       learned_frame(w, model, name, device, threads, part));
                               },
                               ""});
            };
            if (network_module().card(model).target == "displayed") {
                add("learned frame", Part::network, w);
                add("simulated and learned frame", Part::with_run, w);
            } else {
                add("learned frame before cohesion", Part::network, w);
                add("simulated and learned frame with Eq 10", Part::with_cohesion, w);
            }
            add("simulated and learned frame with Eq 10 every 10 mm", Part::with_cohesion, thinned(w, 0.01));
            add("simulated and learned frame with Eq 10 every 12.5 mm over-relaxed", Part::with_cohesion,
                thinned(w, 0.0125, 3.4));
        }
    return out;
}

}  // namespace wetcurl::bench

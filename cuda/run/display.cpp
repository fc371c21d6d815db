// What is seen of wet hair, on a CUDA device.
#include "cuda/run/display.h"

#include "cuda/cohesion/cohesion_kernel.h"
#include "cuda/device/cuda_owners.h"
#include "cuda/run/simulation.h"
#include "cuda/solids/rigid_shapes.h"
#include "solver/scene/rest_state.h"
#include "solver/solids/rest_depths.h"

namespace wetcurl {

namespace {

class OnDevice final : public DeviceDisplay {
  public:
    OnDevice(const Scene& scene, int device)
        : scene_(scene),
          device_(device),
          shapes_(scene),
          cohesion_(*scene.cohesion, scene.groom.rest.count, Thinning(scene.groom.rest, *scene.cohesion),
                    cast<float>(scene.head_at(0).translation), volumes_of(scene), scene.saturation, false,
                    rest_depths_of(scene)),
          strands_(scene.groom.rest.points.size()),
          solids_(shapes_.size()) {}

    Vec3f* strands() override { return strands_.data(); }

    void apply(Vec3f* displayed, const Pose& head, double time, DeviceStream after) override {
        check_cuda(cudaSetDevice(device_), "choice of the device");
        place(head, time);
        if (displayed != captured_) graph_.forget();
        captured_ = displayed;
        const cudaStream_t stream = after ? after : stream_.handle;
        for (;;) {
            graph_.replay(stream, [&] { launch(displayed, stream); });
            check_cuda(cudaStreamSynchronize(stream), "display");
            if (!cohesion_.grow(report_.last())) break;
            graph_.forget();  // it holds the old lists
        }
    }
    void apply(Strands& p, const Pose& head, double time) override {
        check_cuda(cudaSetDevice(device_), "choice of the device");
        if (!displayed_.size()) displayed_ = DeviceBuffer<Vec3f>(strands_.size());
        strands_.upload(p.points.data(), strands_.size());
        apply(displayed_.data(), head, time, nullptr);
        displayed_.download(p.points.data());
    }
    double neighbours_mean() const override {
        return double(report_.last().pairs) / double(cohesion_.asked());
    }

  private:
    void place(const Pose& head, double time) {
        const ShapeView* shape = shapes_.data();
        DeviceSolid<float>* to = solids_.host.data();
        for (const auto& solid : scene_.solids) {
            const Pose pose = solid.at(time, head);
            *to++ = {shape++, cast<float>(pose.rotation), cast<float>(pose.translation), {}, {},
                     0.f,     solid.moves_with_roots()};
        }
        motion_.host[0] = {};
        motion_.host[0].solids = solids_.device.data(), motion_.host[0].count = int(shapes_.size());
    }
    void launch(Vec3f* displayed, cudaStream_t stream) {
        motion_.send(stream), solids_.send(stream), report_.clear(stream);
        cohesion_.launch_lists(strands_.data(), report_.data(), stream);
        cohesion_.launch_passes(strands_.data(), motion_.device.data(), displayed, stream);
        report_.fetch(stream);
    }

    const Scene& scene_;
    const int device_;
    RigidShapes shapes_;
    CohesionDevice cohesion_;
    DeviceBuffer<Vec3f> strands_, displayed_;  // the latter of the host's strands
    OnBoth<SubstepMotion<float>> motion_{1};
    OnBoth<DeviceSolid<float>> solids_;
    FrameReports report_;
    Stream stream_;
    Graph graph_;
    const Vec3f* captured_ = nullptr;
};

}  // namespace

std::unique_ptr<DeviceDisplay> make_cuda_display(const Scene& scene, int device) {
    require_cuda_device(device);
    if (scene.has_deforming_solid())
        throw Error("display on a CUDA device: found a solid that deforms, allowed are rigid ones");
    check_cuda(cudaSetDevice(device), "choice of the device");
    return std::make_unique<OnDevice>(scene, device);
}

}  // namespace wetcurl

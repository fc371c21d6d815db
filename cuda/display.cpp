// What is seen of wet hair, on a CUDA device.
#include "cuda/display.h"

#include "cuda/cohesion_kernel.h"
#include "cuda/driver.h"
#include "cuda/rigid_shapes.h"
#include "cuda/simulation.h"
#include "solver/rest_state.h"

namespace wetcurl {

namespace {

class OnDevice final : public DeviceDisplay {
  public:
    OnDevice(const Scene& scene, int device)
        : scene_(scene),
          device_(device),
          shapes_(scene),
          cohesion_(*scene.cohesion, scene.groom.rest.count,
                    Thinning(scene.groom.rest, scene.cohesion->spacing),
                    cast<float>(scene.motion.at(0).translation), volumes_of(scene), scene.saturation, false,
                    rest_depths_of(scene)),
          strands_(scene.groom.rest.points.size()),
          host_motion_(1),
          motion_(1),
          host_solids_(shapes_.size()),
          solids_(shapes_.size()),
          host_report_(2),
          report_(1) {
        host_report_[0] = host_report_[1] = {};
    }

    Vec3f* strands() override { return strands_.data(); }

    void apply(Vec3f* displayed, const Pose& head, double time) override {
        check_cuda(cudaSetDevice(device_), "choice of the device");
        place(head, time);
        if (displayed != captured_) graph_.forget();
        captured_ = displayed;
        for (;;) {
            graph_.replay(stream_.handle, [&] { launch(displayed); });
            check_cuda(cudaStreamSynchronize(stream_.handle), "display");
            if (!cohesion_.grow(host_report_[1])) break;
            graph_.forget();  // it holds the old lists
        }
    }
    void apply(Strands& p, const Pose& head, double time) override {
        check_cuda(cudaSetDevice(device_), "choice of the device");
        if (!displayed_.size()) displayed_ = DeviceBuffer<Vec3f>(strands_.size());
        strands_.upload(p.points.data(), strands_.size());
        apply(displayed_.data(), head, time);
        displayed_.download(p.points.data());
    }
    double neighbours_mean() const override {
        return double(host_report_[1].pairs) / double(cohesion_.asked());
    }

  private:
    void place(const Pose& head, double time) {
        const ShapeView* shape = shapes_.data();
        DeviceSolid<float>* to = host_solids_.data();
        for (const auto& solid : scene_.solids) {
            const Pose pose = solid.at(time, head);
            *to++ = {shape++,       cast<float>(pose.rotation), cast<float>(pose.translation), {}, {}, 0.f,
                     solid.attached};
        }
        host_motion_[0] = {};
        host_motion_[0].solids = solids_.data(), host_motion_[0].count = int(shapes_.size());
    }
    void launch(Vec3f* displayed) {
        auto upload = [&](auto& to, const auto& from) {
            if (to.size())
                check_cuda(cudaMemcpyAsync(to.data(), from.data(), to.bytes(), cudaMemcpyHostToDevice,
                                           stream_.handle),
                           "display");
        };
        upload(motion_, host_motion_), upload(solids_, host_solids_), upload(report_, host_report_);
        cohesion_.launch_lists(strands_.data(), report_.data(), stream_.handle);
        cohesion_.launch_passes(strands_.data(), motion_.data(), displayed, stream_.handle);
        check_cuda(cudaMemcpyAsync(&host_report_[1], report_.data(), sizeof(FrameReport),
                                   cudaMemcpyDeviceToHost, stream_.handle),
                   "display");
    }

    const Scene& scene_;
    const int device_;
    RigidShapes shapes_;
    CohesionDevice cohesion_;
    DeviceBuffer<Vec3f> strands_, displayed_;  // the latter of the host's strands
    // Where the solids are, and what a frame leaves: a blank report, and the last one's.
    PinnedBuffer<SubstepMotion<float>> host_motion_;
    DeviceBuffer<SubstepMotion<float>> motion_;
    PinnedBuffer<DeviceSolid<float>> host_solids_;
    DeviceBuffer<DeviceSolid<float>> solids_;
    PinnedBuffer<FrameReport> host_report_;
    DeviceBuffer<FrameReport> report_;
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

// Interpolation on a CUDA device.
#include "learn/codec/device_interpolator.h"

#include <string>

#include "learn/codec/interpolation_kernels.h"

namespace wetcurl {

DeviceInterpolator::DeviceInterpolator(Interpolation kind, const Stencil& stencil, const Groom& high,
                                       const Groom& low, const Strands* shape, bool low_is_wet,
                                       const Settled* settled)
    : kind_(kind),
      n_(high.rest.particles),
      low_(low.rest.count),
      high_(high.rest.count),
      width_(stencil.width) {
    if (kind_ == Interpolation::skin)
        throw Error(
            "interpolation: found skin on a CUDA device, allowed there are nearest, quad, core and rest; the "
            "CPU (--device cpu) takes all");
    if (kind_ == Interpolation::rest) {
        const StrandCodec codec(high, low, {}, shape, low_is_wet, {}, settled);
        if (const int allowed = codec.carrier().around().width; width_ != allowed)
            throw Error("interpolation: found rest shapes carried by " + std::to_string(width_) +
                        " roots, allowed on a CUDA device are " + std::to_string(allowed) +
                        " of these strands; the CPU (--device cpu) takes either");
        rest_.emplace(codec, low);
        return;
    }
    root_ = DeviceBuffer<Vec3f>(root_frames(high).root);
    nearest_ = DeviceBuffer<int>(stencil.nearest);
    if (kind_ == Interpolation::nearest) return;
    from_ = DeviceBuffer<int>(stencil.from), weight_ = DeviceBuffer<float>(stencil.weight);
    if (kind_ == Interpolation::core) cores_ = DeviceBuffer<Vec3f>(low.rest.points.size());
}

void DeviceInterpolator::apply(const Vec3f* low, const Pose& head, Vec3f* out, cudaStream_t stream) {
    if (rest_) {
        HeadWindow still;
        still.now = head;
        rest_->begin_frame(still, true);
        rest_->take_head(stream);
        rest_->depart(low, stream);
        rest_->move_cores(stream);
        rest_->carry(stream);
        rest_->place(nullptr, 0, out, stream);
        return;
    }
    const bool nearest = kind_ == Interpolation::nearest;
    const StrandsToPlace to{high_,
                            n_,
                            nearest ? 1 : width_,
                            root_.data(),
                            nearest ? nearest_.data() : from_.data(),
                            nearest ? nullptr : weight_.data(),
                            cast<float>(head.rotation),
                            cast<float>(head.translation)};
    if (kind_ != Interpolation::core) return launch_means(to, low, out, stream);
    launch_cores(low_, n_, low, cores_.data(), stream);
    launch_details(to, nearest_.data(), low, cores_.data(), out, stream);
}

}  // namespace wetcurl

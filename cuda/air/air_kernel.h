// The air on a device: the stages of AirField, by its formulas.
#pragma once

#include <cuda_runtime.h>

#include <array>

#include "base/device_buffer.h"
#include "solver/air/air_field.h"

namespace wetcurl {

// The strands that brake the air, (strand, particle) in the device's memory.
template <class T>
struct BrakingHair {
    const Vec3<T>*x, *v;
    const T* rest_length;
    int particles;
    size_t count;
    double drag;  // [kg/(m s)]
};

// A ball that blows, and how much at the moment.
struct BlowingBall {
    Vec3d center, velocity;
    double radius, gust;
};

// Nothing is allocated and nothing read by the host from step to step, so that one can be captured.
class AirDevice {
  public:
    // `hair_length` [m] of all hair that brakes it, `drag` as of AirDrag; 0: none does.
    AirDevice(const Air& air, double dt, double hair_length, double drag);
    // Steps of so many seconds follow; nothing may be on its way.
    void take_steps_of(double dt);

    // What sources do at `time` [s], for the steps that follow.
    void blow(double time);
    // As AirField::step. `hair`: null where the air is not braked.
    template <class T>
    void launch_step(const BrakingHair<T>* hair, cudaStream_t stream);
    // What particles at x (count) feel: air (count) [m/s].
    template <class T>
    void launch_sample(const Vec3<T>* x, Vec3<T>* air, size_t count, cudaStream_t stream) const;
    // As AirField's, (z, y, x) at the faces of an axis; nothing may be on its way there.
    std::vector<double> velocities(int axis) const { return u_[size_t(axis)].host(); }
    void blow_as(int axis, const std::vector<double>& u) { u_[size_t(axis)].upload(u.data(), u.size()); }
    size_t bytes() const;

  private:
    // What an axis of the box needs: the sines of its cells, and the factors of diffusion along as many faces
    // as it has cells, and one more.
    struct Axis {
        int cells;
        DeviceBuffer<double> sines, eigenvalues, factors, more_factors;
    };
    StaggeredGrid view(const std::array<DeviceBuffer<double>, 3>& u) const;
    void launch_sines(int axis, bool back, const double* from, double* to, cudaStream_t stream) const;

    const Air air_;
    double dt_ = 0;  // [s] of a step
    std::array<Axis, 3> axes_;
    std::array<DeviceBuffer<double>, 3> u_, next_;  // within a step it is the latter
    DeviceBuffer<double> pressure_, spare_;
    PinnedBuffer<BlowingBall> host_balls_;
    DeviceBuffer<BlowingBall> balls_;
    // Of hair: k and kv of each face, as whole numbers of 1 / scale, whose sums have no order.
    DeviceBuffer<long long> braked_;
    const double all_drag_;  // [kg/s] of all hair
    double scale_ = 0;
};

}  // namespace wetcurl

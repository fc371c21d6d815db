// The air of a CUDA device against the host's.
#include <gtest/gtest.h>

#include <random>

#include "cuda/air/air_kernel.h"
#include "cuda/device/cuda_owners.h"
#include "tests/cuda/needs_device.h"

namespace wetcurl {
namespace {

constexpr double dt = 1.0 / 24;
constexpr int strands = 40, n = 16;
constexpr size_t particles = size_t(strands) * n;

Air blown_air(bool two_way) {
    Air air{};
    air.size = 0.8, air.viscosity = 1e-3, air.density = 1.2;
    air.grid = {12, 16, 10}, air.wind = {0.5, 0, -1}, air.two_way = two_way;
    air.sources = {{.radius = 0.2, .period = 0.7, .center = {0.1, 0.05, 0}, .velocity = {0, 2, 3}}};
    return air;
}

// The largest difference in what particles feel after `steps` [m/s].
double apart(bool two_way, int steps) {
    const Air air = blown_air(two_way);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> place(-0.45, 0.45), speed(-2, 2);
    std::vector<Vec3d> x(particles), v(particles);
    for (auto& p : x) p = cast<double>(cast<float>(Vec3d{place(random), place(random), place(random)}));
    for (auto& p : v) p = cast<double>(cast<float>(Vec3d{speed(random), speed(random), speed(random)}));
    const double edge = 0.01, drag = 0.05;
    std::vector<DragPoint> hair;
    for (size_t k = 0; two_way && k < particles; ++k) {
        const bool end = k % n == 0 || k % n == n - 1;
        hair.push_back({cast<float>(x[k]), cast<float>(v[k]), float(drag * edge * (end ? 0.5 : 1))});
    }
    AirField field(air);
    AirDevice device(air, dt, edge * strands * (n - 1), drag);
    const DeviceBuffer<Vec3d> at(x), velocity(v);
    const DeviceBuffer<double> edges(std::vector<double>(particles, edge));
    const BrakingHair<double> braking{at.data(), velocity.data(), edges.data(), n, particles, drag};
    DeviceBuffer<Vec3d> felt(particles);
    const Stream stream;
    for (int step = 1; step <= steps; ++step) {
        field.step(dt, step * dt, hair);
        device.blow(step * dt);
        device.launch_step(two_way ? &braking : nullptr, stream.handle);
        check_cuda(cudaStreamSynchronize(stream.handle), "step");
    }
    device.launch_sample(at.data(), felt.data(), particles, stream.handle);
    check_cuda(cudaStreamSynchronize(stream.handle), "sample");
    const std::vector<Vec3d> got = felt.host();
    double most = 0, fastest = 0;
    for (size_t k = 0; k < particles; ++k) {
        most = std::max(most, norm(got[k] - field.at(x[k])));
        fastest = std::max(fastest, norm(field.at(x[k]) - air.wind));
    }
    EXPECT_GT(fastest, 0.5);  // something blew
    return most;
}

class AirCouplingOnDevice : public testing::NeedsDevice {};

TEST_F(AirCouplingOnDevice, blows_as_the_hosts) { EXPECT_LT(apart(false, 20), 1e-11); }

// The host keeps a piece's drag in single precision.
TEST_F(AirCouplingOnDevice, is_braked_by_hair_as_the_hosts) { EXPECT_LT(apart(true, 20), 1e-6); }

}  // namespace
}  // namespace wetcurl

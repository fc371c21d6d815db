/// @file
/// Wet hair simulated in another program, for C++: owners of a wetcurl_setup and a wetcurl_simulation, whose
/// functions throw std::runtime_error. simulation.h describes units, shapes, poses and what each does.
#pragma once

#include "api.hpp"
#include "simulation.h"

namespace wetcurl {

/// A scene to be simulated, and what the caller brings along.
class Setup {
  public:
    /// A scene file, see wetcurl_setup_file().
    static Setup file(const std::string& scene) { return Setup(wetcurl_setup_file(scene.c_str())); }
    /// The text of a scene, see wetcurl_setup_text().
    static Setup text(const std::string& scene, const std::string& folder = ".") {
        return Setup(wetcurl_setup_text(scene.c_str(), folder.c_str()));
    }
    /// "integrator.substeps=20"
    Setup& set(const std::string& assignment) {
        detail::check(wetcurl_setup_set(setup_.get(), assignment.c_str()));
        return *this;
    }
    /// See wetcurl_setup_strands(): points (strand), positions (point, 3) [m].
    Setup& strands(const std::vector<int>& points, const std::vector<float>& positions) {
        size_t sum = 0;
        for (int each : points) sum += size_t(each < 0 ? 0 : each);
        if (positions.size() != 3 * sum)
            throw std::runtime_error("strands: found " + std::to_string(positions.size()) +
                                     " numbers, allowed three for each of " + std::to_string(sum) +
                                     " points");
        detail::check(
            wetcurl_setup_strands(setup_.get(), int(points.size()), points.data(), positions.data()));
        return *this;
    }
    /// See wetcurl_setup_mesh(): positions (vertex, 3) [m], corners (triangle, 3).
    Setup& mesh(const std::string& solid, const std::vector<float>& positions,
                const std::vector<int>& corners) {
        detail::check(wetcurl_setup_mesh(setup_.get(), solid.c_str(), int(positions.size() / 3),
                                         positions.data(), int(corners.size() / 3), corners.data()));
        return *this;
    }
    /// See wetcurl_setup_drive_roots().
    Setup& drive_roots() {
        detail::check(wetcurl_setup_drive_roots(setup_.get()));
        return *this;
    }
    /// For the C interface.
    const wetcurl_setup* get() const { return setup_.get(); }

  private:
    explicit Setup(wetcurl_setup* setup) : setup_(setup, wetcurl_setup_free) {
        if (!setup_) throw std::runtime_error(wetcurl_error());
    }
    std::unique_ptr<wetcurl_setup, decltype(&wetcurl_setup_free)> setup_;
};

/// A simulation. One thread at a time may use it.
class Simulation {
  public:
    /// See wetcurl_simulate().
    explicit Simulation(const Setup& setup, const std::string& device = "cpu",
                        const std::string& precision = "float", int threads = 0)
        : simulation_(wetcurl_simulate(setup.get(), device.c_str(), precision.c_str(), threads),
                      wetcurl_simulation_free) {
        if (!simulation_) throw std::runtime_error(wetcurl_error());
    }
    /// Number of strands.
    int strands() const { return wetcurl_strands(simulation_.get()); }
    /// Number of particles of a strand.
    int particles() const { return wetcurl_strand_particles(simulation_.get()); }
    /// The time that is simulated [s].
    double time() const { return wetcurl_time(simulation_.get()); }

    /// See wetcurl_move_head().
    void move_head(const PoseArray& pose) {
        detail::check(wetcurl_move_head(simulation_.get(), pose.data()));
    }
    /// See wetcurl_move_solid().
    void move_solid(const std::string& solid, const PoseArray& pose) {
        detail::check(wetcurl_move_solid(simulation_.get(), solid.c_str(), pose.data()));
    }
    /// See wetcurl_move_mesh(): positions (vertex, 3) [m], as many as were brought.
    void move_mesh(const std::string& solid, const std::vector<float>& positions) {
        detail::check(wetcurl_move_mesh(simulation_.get(), solid.c_str(), positions.data()));
    }
    /// See wetcurl_move_roots(): poses (strand).
    void move_roots(const std::vector<PoseArray>& poses) {
        require(poses.size(), size_t(strands()), "poses of roots");
        detail::check(wetcurl_move_roots(simulation_.get(), poses.data()->data()));
    }
    /// See wetcurl_wet(): saturation (strand, particle).
    void wet(const std::vector<float>& saturation) {
        require(saturation.size(), size_t(strands()) * size_t(particles()), "numbers of saturation");
        detail::check(wetcurl_wet(simulation_.get(), saturation.data()));
    }
    /// See wetcurl_advance().
    void advance(double seconds) { detail::check(wetcurl_advance(simulation_.get(), seconds)); }
    /// See wetcurl_cut().
    void cut() { detail::check(wetcurl_cut(simulation_.get())); }

    /// Where strands are displayed, (strand, particle, 3) [m].
    std::vector<float> displayed() const { return read(wetcurl_displayed, 3); }
    /// Where strands are simulated, (strand, particle, 3) [m].
    std::vector<float> simulated() const { return read(wetcurl_simulated, 3); }
    /// (strand, particle, 3) [m/s]
    std::vector<float> velocities() const { return read(wetcurl_velocities, 3); }
    /// (strand, particle)
    std::vector<float> saturation() const { return read(wetcurl_saturation, 1); }

  private:
    static void require(size_t found, size_t allowed, const std::string& what) {
        if (found != allowed)
            throw std::runtime_error("found " + std::to_string(found) + " " + what + ", allowed " +
                                     std::to_string(allowed));
    }
    std::vector<float> read(int (*of)(const wetcurl_simulation*, float*), size_t each) const {
        std::vector<float> out(size_t(strands()) * size_t(particles()) * each);
        detail::check(of(simulation_.get(), out.data()));
        return out;
    }
    std::unique_ptr<wetcurl_simulation, decltype(&wetcurl_simulation_free)> simulation_;
};

}  // namespace wetcurl

/// @file
/// Learned wet hair in another program, for C++: an owner of a wetcurl_hair, whose functions throw
/// std::runtime_error. learned.h describes units, shapes and poses.
#pragma once

#include "api.hpp"
#include "learned.h"

namespace wetcurl {

/// The hair of a scene with its network.
class Hair {
  public:
    /// Opens a scene and a model, see wetcurl_open().
    Hair(const std::string& scene, const std::string& model, const std::string& device = "cpu",
         int threads = 0)
        : hair_(wetcurl_open(scene.c_str(), model.c_str(), device.c_str(), threads), wetcurl_close) {
        if (!hair_) throw std::runtime_error(wetcurl_error());
    }
    /// The same from other strands of low resolution, see wetcurl_open_from().
    Hair(const std::string& scene, const std::string& model, const wetcurl_low_run& low,
         const std::string& device = "cpu", int threads = 0)
        : hair_(wetcurl_open_from(scene.c_str(), model.c_str(), device.c_str(), threads, low),
                wetcurl_close) {
        if (!hair_) throw std::runtime_error(wetcurl_error());
    }
    /// Number of strands that are read.
    int low_strands() const { return wetcurl_low_strands(hair_.get()); }
    /// Number of strands that are written.
    int high_strands() const { return wetcurl_high_strands(hair_.get()); }
    /// Number of particles of a strand, read or written.
    int particles() const { return wetcurl_particles(hair_.get()); }
    /// The strands of low resolution at rest, (low strands, particles, 3) [m], in the head's frame.
    std::vector<float> low_at_rest() const {
        std::vector<float> out(size_t(low_strands()) * size_t(particles()) * 3);
        wetcurl_low_at_rest(hair_.get(), out.data());
        return out;
    }
    /// Which of the scene's strands those are, (low strands), counted from 0.
    std::vector<int> low_places() const {
        std::vector<int> out(size_t(low_strands()), 0);
        wetcurl_low_places(hair_.get(), out.data());
        return out;
    }
    /// Computes only where hair is wet, see wetcurl_crop().
    void crop() { detail::check(wetcurl_crop(hair_.get())); }
    /// Draws strands into locks by a grid, see wetcurl_locks().
    void locks(int passes) { detail::check(wetcurl_locks(hair_.get(), passes)); }
    /// Sets the memory of the frames, see wetcurl_bind(): low (low strands, particles, 3) and high (high
    /// strands, particles, 3) [m], in world axes.
    void bind(const float* low, float* high, bool on_device = false) {
        detail::check(wetcurl_bind(hair_.get(), low, high, on_device));
    }
    /// Computes a frame, see wetcurl_run().
    void run(const PoseArray& before, const PoseArray& now, const PoseArray& after) {
        detail::check(wetcurl_run(hair_.get(), before.data(), now.data(), after.data()));
    }
    /// Computes a frame with a head that does not move: a shot's first.
    void run(const PoseArray& now) { detail::check(wetcurl_run(hair_.get(), nullptr, now.data(), nullptr)); }
    /// How far the frame run last is expected to be off, (high strands, WETCURL_ERROR_PIECES) [m], see
    /// wetcurl_expected_errors().
    std::vector<float> expected_errors() const {
        std::vector<float> out(size_t(high_strands()) * WETCURL_ERROR_PIECES);
        detail::check(wetcurl_expected_errors(hair_.get(), out.data()));
        return out;
    }
    /// The next frame is the first of another shot.
    void restart() { wetcurl_restart(hair_.get()); }

  private:
    std::unique_ptr<wetcurl_hair, decltype(&wetcurl_close)> hair_;
};

}  // namespace wetcurl

// Learned wet hair in another program: wetcurl.h for C++, an owner that throws std::runtime_error.
#pragma once

#include <array>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "wetcurl.h"

namespace wetcurl {

using PoseArray = std::array<double, 7>;  // x y z of the head's origin [m], quaternion w x y z

class Hair {
  public:
    // As of wetcurl_open.
    Hair(const std::string& scene, const std::string& model, const std::string& device = "cpu",
         int threads = 0)
        : hair_(wetcurl_open(scene.c_str(), model.c_str(), device.c_str(), threads), wetcurl_close) {
        if (!hair_) throw std::runtime_error(wetcurl_error());
    }
    int low_strands() const { return wetcurl_low_strands(hair_.get()); }
    int high_strands() const { return wetcurl_high_strands(hair_.get()); }
    int particles() const { return wetcurl_particles(hair_.get()); }
    // (low strands, particles, 3) [m], in the head's frame.
    std::vector<float> low_at_rest() const {
        std::vector<float> out(size_t(low_strands()) * size_t(particles()) * 3);
        wetcurl_low_at_rest(hair_.get(), out.data());
        return out;
    }
    // As of wetcurl_crop.
    void crop() { check(wetcurl_crop(hair_.get())); }
    // As of wetcurl_bind: low (low strands, particles, 3), high (high strands, particles, 3) [m], world.
    void bind(const float* low, float* high, bool on_device = false) {
        check(wetcurl_bind(hair_.get(), low, high, on_device));
    }
    // As of wetcurl_run.
    void run(const PoseArray& before, const PoseArray& now, const PoseArray& after) {
        check(wetcurl_run(hair_.get(), before.data(), now.data(), after.data()));
    }
    // A head that stands still.
    void run(const PoseArray& now) { check(wetcurl_run(hair_.get(), nullptr, now.data(), nullptr)); }
    void restart() { wetcurl_restart(hair_.get()); }

  private:
    static void check(int status) {
        if (status != 0) throw std::runtime_error(wetcurl_error());
    }
    std::unique_ptr<wetcurl_hair, decltype(&wetcurl_close)> hair_;
};

}  // namespace wetcurl

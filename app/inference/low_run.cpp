// The low-resolution run that `infer` starts from.
#include "app/inference/low_run.h"

#include <fmt/format.h>

#include "app/engine/device.h"

namespace wetcurl {

LowRun::LowRun(const std::string& file)
    : file_(file),
      reader_(file),
      header_(reader_->header()),
      frames_(reader_->frames()),
      source_(std::make_unique<StoredFrames>(*reader_)) {}

LowRun::LowRun(const std::string& scene_file, Scene low, const std::string& device, int threads)
    : file_(scene_file) {
    // A program built without the solver's CUDA backend may still have a network there.
    run_.emplace(std::move(low), names_of_cuda_devices().empty() ? "cpu" : device, "float", threads);
    header_ = run_->header();
    frames_ = run_->scene().frames;
    source_ = std::make_unique<SimulatedFrames>(run_->simulation(), frames_);
}

std::string LowRun::origin() const {
    if (!run_) return file_;
    return fmt::format("{} ({}, {} strands, {} substeps a frame)", file_, header_.method,
                       header_.groom.rest.count, run_->scene().integrator.substeps);
}

}  // namespace wetcurl

// The low-resolution run that `infer` starts from.
#pragma once

#include "app/engine/scene_run.h"
#include "app/inference/method.h"

namespace wetcurl {

class LowRun {
  public:
    // A run file.
    explicit LowRun(const std::string& file);
    // A scene at low resolution of that file, dry or wet, which is simulated as frames are asked for.
    LowRun(const std::string& scene_file, Scene low, const std::string& device, int threads);

    const RunHeader& header() const { return header_; }
    const std::string& file() const { return file_; }
    int frames() const { return frames_; }
    // In order, once.
    FrameSource& source() { return *source_; }
    // What `inputs` of a result's header says of it: the run's file, or the scene's and how it was simulated.
    std::string origin() const;

  private:
    std::string file_;
    std::optional<RunReader> reader_;  // of a run file
    std::optional<SceneRun> run_;      // of a scene
    RunHeader header_;
    int frames_;
    std::unique_ptr<FrameSource> source_;
};

}  // namespace wetcurl

// Frames in order.
#include "base/frames.h"

#include <omp.h>

#include <future>
#include <optional>

#include "base/progress.h"

namespace wetcurl {

bool FrameSource::next(RunFrame& frame) {
    if (!advance()) return false;
    begin(frame);
    finish(frame);
    return true;
}

void FrameDelivery::run(FrameSource& source, const Sink& sink) {
    std::optional<Progress> progress;
    if (!settings_.what.empty()) progress.emplace(settings_.what, settings_.frames, "frame");
    RunFrame frame;
    std::future<double> on_its_way;
    const auto deliver = [&](int index) {
        const double begin = omp_get_wtime();
        source.finish(frame);
        sink(index, frame);
        return omp_get_wtime() - begin;
    };
    const auto arrive = [&] {
        if (!on_its_way.valid()) return;
        sink_seconds_ += on_its_way.get();
        ++delivered_;
        if (progress) progress->update(delivered_, settings_.note ? settings_.note() : "");
    };
    try {
        for (int index = delivered_; index < settings_.frames && !guard_.asked() && source.advance();
             ++index) {
            arrive();
            source.begin(frame);
            if (index > 0) seconds_.push_back(frame.seconds);
            on_its_way =
                std::async(settings_.overlap ? std::launch::async : std::launch::deferred, deliver, index);
            if (!settings_.overlap) arrive();
        }
    } catch (...) {
        arrive();
        throw;
    }
    arrive();
}

}  // namespace wetcurl

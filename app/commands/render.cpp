// `wetcurl render`: runs side by side, or (--image) geometry images, as a picture of one frame or a video of
// all.
#include "app/commands/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "app/drawing/geometry_film.h"
#include "app/drawing/image_file.h"
#include "app/drawing/picture.h"
#include "app/engine/run_solids.h"
#include "app/files/results.h"
#include "app/files/run_file.h"
#include "app/options/option_list.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "base/progress.h"
#include "base/run_cache.h"

namespace wetcurl {

namespace {

// What is drawn, frame by frame.
class Reel {
  public:
    virtual ~Reel() = default;
    virtual int frames() const = 0;
    virtual double fps() const = 0;
    // Settles what the pictures of these frames share.
    virtual void settle(int first, int last) = 0;
    virtual Image draw(int frame) = 0;
};

// The runs of one picture, their common frames and the camera that they share.
class RunReel final : public Reel {
  public:
    explicit RunReel(const RenderOptions& options) : options_(options) {
        for (const std::string& path : options.runs) {
            runs_.push_back(std::make_unique<RunReader>(path));
            const int n = runs_.back()->frames();
            if (n == 0) throw Error(path + ": there is no frame in it to draw");
            frames_ = runs_.size() == 1 ? n : std::min(frames_, n);
        }
    }

    int frames() const override { return frames_; }
    double fps() const override { return runs_[0]->header().fps; }
    void settle(int first, int last) override {
        fit_camera(first, last, 9);
        if (options_.expected_error) find_largest_error(first, last, 9);
    }

    Image draw(int f) override {
        std::vector<Image> panels;
        for (size_t k = 0; k < runs_.size(); ++k) panels.push_back(draw_run(k, f));
        if (options_.saturation) draw_rainbow_legend(panels.back(), "1", "saturation");
        if (options_.expected_error)
            draw_rainbow_legend(panels.back(), fmt::format("{:g} mm", 1e3 * largest_error_),
                                "expected error");
        return side_by_side(panels);
    }

  private:
    // Makes the camera see all runs at `count` frames spread evenly over first..last.
    void fit_camera(int first, int last, int count) {
        Extent extent;
        count = std::min(count, last - first + 1);
        for (int k = 0; k < count; ++k) {
            const int f = frame_of(k, count, first, last);
            for (const auto& run : runs_) {
                const RunFrame frame = run->frame(f);
                extent.add(frame.seen());
                for (const PosedMesh& solid : solids_of(run->header(), frame, run->header().time(f)))
                    extent.add(solid);
            }
        }
        camera_ = fitted_camera(extent, options_.view, options_.width, options_.height);
        fitted_at_ = runs_[0]->frame(first).head;
    }

    // The end of the scale of expected errors: 1, 2 or 5 times a power of ten that 98 of 100 pieces of
    // strands, at so many frames, lie below. Throws Error where no run tells its errors.
    void find_largest_error(int first, int last, int count) {
        std::vector<float> all;
        count = std::min(count, last - first + 1);
        for (int k = 0; k < count; ++k)
            for (const auto& run : runs_) {
                const auto expected = run->frame(frame_of(k, count, first, last)).expected_error;
                all.insert(all.end(), expected.begin(), expected.end());
            }
        if (all.empty())
            throw Error(options_.runs[0] +
                        ": --expected-error: no run here says what its network expects to err by; `infer` "
                        "with a model of whole strands writes such runs");
        const auto most = all.begin() + long(all.size() * 98 / 100);
        std::nth_element(all.begin(), most, all.end());
        largest_error_ = 1e-6;
        for (int k = 0; largest_error_ < double(*most); ++k) largest_error_ *= k % 3 == 1 ? 2.5 : 2;
    }

    Image draw_run(size_t k, int f) const {
        const RunReader& run = *runs_[k];
        const RunHeader& header = run.header();
        const RunFrame frame = run.frame(f);
        // A dry run records its wetness as well; only the colours asked for show it.
        const bool wet = !header.saturation.empty() &&
                         (options_.saturation || !header.method.starts_with("simulated dry"));
        Panel panel;
        const std::vector<float> shown = shown_of(frame, wet ? &frame.wetness(header) : nullptr);
        StrandLayer layer{.strands = &frame.seen(), .saturation = wet ? &frame.wetness(header) : nullptr};
        if (!shown.empty()) layer.shown = &shown;
        panel.layers.push_back(layer);
        panel.solids = solids_of(header, frame, header.time(f));
        if (!options_.light.empty())
            panel.light_yaw = options_.light[0], panel.light_pitch = options_.light[1];
        const Camera camera = options_.follow ? carried(camera_, fitted_at_, frame.head) : camera_;
        Image image = draw_panel(panel, camera);
        if (options_.labels)
            draw_label(image, (options_.label.empty() ? header.method : options_.label[k]) + ", " +
                                  std::to_string(frame.seen().count) + " strands, frame " +
                                  std::to_string(f));
        return image;
    }

    // (strand, particle), 0..1: what strands are coloured by; empty: hair's own colour.
    std::vector<float> shown_of(const RunFrame& frame, const std::vector<float>* saturation) const {
        const Strands& seen = frame.seen();
        if (options_.saturation)
            return saturation ? *saturation : std::vector<float>(seen.points.size(), 0.f);
        std::vector<float> out;
        if (options_.expected_error && !frame.expected_error.empty())
            for (int s = 0; s < seen.count; ++s)
                for (int i = 0; i < seen.particles; ++i)
                    out.push_back(frame.expected_at(s, i) / float(largest_error_));
        return out;
    }

    // Frame k of `count` spread evenly over first..last.
    static int frame_of(int k, int count, int first, int last) {
        return count == 1 ? first : first + int(long(last - first) * k / (count - 1));
    }

    const RenderOptions& options_;
    std::vector<std::unique_ptr<RunReader>> runs_;
    int frames_ = 0;
    double largest_error_ = 1;  // [m]: where the scale of expected errors ends
    Camera camera_;
    Pose fitted_at_;  // of the head, where the camera was placed
};

// Geometry images side by side.
class ImageReel final : public Reel {
  public:
    explicit ImageReel(const RenderOptions& o)
        : film_(geometry_film(o.runs, o.run, o.threads)), least_(o.pixels) {}
    int frames() const override { return film_->frames(); }
    double fps() const override { return film_->fps(); }
    void settle(int first, int last) override { film_->settle(first, last); }
    Image draw(int f) override { return draw_geometry(film_->panels(f), least_); }

  private:
    std::unique_ptr<GeometryFilm> film_;
    int least_;
};

std::unique_ptr<Reel> reel_of(const RenderOptions& o) {
    if (o.image) return std::make_unique<ImageReel>(o);
    return std::make_unique<RunReel>(o);
}

void check(const RenderOptions& o, const std::string& extension) {
    if (o.runs.empty())
        throw Misuse("render: no run is named; wetcurl render RUN.h5... -o out.png|out.mp4|out.webm");
    if (extension != ".png" && extension != ".mp4" && extension != ".webm")
        throw Misuse("render: " + (o.output.empty() ? "no output" : o.output) +
                     ": allowed are .png, .mp4 and .webm");
    for (int size : {o.width, o.height})
        if (size < 16 || size > 8192)
            throw Misuse("render: a panel of " + std::to_string(o.width) + " x " + std::to_string(o.height) +
                         " pixels; allowed are 16 to 8192 each way");
    constexpr long widest = 16383;  // of VP8, and about what H.264 takes
    const long width = long(o.width) * long(o.runs.size());
    if (extension != ".png" && width > widest)
        throw Misuse("render: " + std::to_string(o.runs.size()) + " panels make a video " +
                     std::to_string(width) + " pixels wide, allowed are " + std::to_string(widest) +
                     "; a --width of " + std::to_string(widest / long(o.runs.size())) + " fits");
    if (extension != ".png" && o.frame >= 0)
        throw Misuse("render: --frame picks one frame for a .png; " + o.output + " takes all of them");
    if (o.image && (o.pixels < 16 || o.pixels > 8192))
        throw Misuse("render: --pixels " + std::to_string(o.pixels) + ": allowed are 16 to 8192");
    if (o.image && o.run < 0)
        throw Misuse("render: --run " + std::to_string(o.run) + ": allowed is 0 or more");
    if (!o.label.empty() && o.label.size() != o.runs.size())
        throw Misuse("render: found --label " + std::to_string(o.label.size()) +
                     " times, allowed is once for each of " + std::to_string(o.runs.size()) +
                     " runs, in their order");
    if (o.saturation && o.expected_error)
        throw Misuse("render: found --saturation and --expected-error, allowed is one of them");
    auto within = [](const char* option, double value, double low, double high) {
        if (!(value >= low && value <= high))
            throw Misuse(fmt::format("render: {} {}: allowed are {} to {}", option, value, low, high));
    };
    within("--yaw", o.view.yaw, -360, 360), within("--pitch", o.view.pitch, -89, 89),
        within("--zoom", o.view.zoom, 0.05, 50);
    check_files(o, o.output, o.runs);
}

}  // namespace

void add_options(OptionList& options, RenderOptions& o) {
    options
        .option("runs", o.runs,
                "RUN.h5; with --image: runs, PAIRS.h5 with any models of its codec, or models")
        .input_file()
        .required();
    options.option("-o,--output", o.output, "out.png, out.mp4 or out.webm").required();
    options.option("--frame", o.frame, "one frame (default: all for a video, the last for a picture)")
        .not_negative();
    const OptionRow of_strands[] = {
        options.option("--width", o.width, "of one panel, 16 to 8192 [pixels]").shows_default(),
        options.option("--height", o.height, "of one panel, 16 to 8192 [pixels]").shows_default(),
        options.option("--yaw", o.view.yaw, "of the camera around the head [degrees]").shows_default(),
        options.option("--pitch", o.view.pitch, "of the camera above the horizon [degrees]").shows_default(),
        options.option("--zoom", o.view.zoom, "times as large as what fits").shows_default(),
        options.flag("--follow-head", o.follow, "the camera moves with the head"),
        options.option("--light", o.light, "yaw and pitch of the key light, from the camera [degrees]")
            .within(-180.0, 180.0)
            .takes(2),
        options.option("--label", o.label, "of a panel, in place of its run's method (repeatable, one a run)")
            .repeatable(),
        options.flag("--saturation", o.saturation, "colour by saturation (red wet, blue dry)"),
        options.flag("--expected-error", o.expected_error,
                     "colour by the error that a network expects of itself (red large, blue none)"),
        options.clears("--no-labels", o.labels, "no text under the panels")};
    OptionRow image = options.flag(
        "--image", o.image,
        "geometry images, a strand a square: of a run its roots (Eq 14, wet ones after Eq 16); of pairs "
        "input, target and residual; with models their predictions too; of a model its first layer");
    for (const OptionRow& option : of_strands) image.excludes(option);
    options.option("--run", o.run, "with --image: which of the runs in PAIRS.h5")
        .not_negative()
        .needs(image)
        .shows_default();
    options.option("--pixels", o.pixels, "with --image: least side of a panel, 16 to 8192")
        .needs(image)
        .shows_default();
    options.footer(
        "Geometry images: codec root shows its colours; codec strand the offset of the tip from the root in "
        "the strand's root frame (red x, green y along the scalp's normal, blue z; grey: none). Pixels "
        "without a strand are hatched.");
}

int render_command(const RenderOptions& given) {
    RenderOptions options = given;
    for (auto& path : options.runs) path = run_to_read(path);
    const std::string extension = std::filesystem::path(options.output).extension().string();
    check(options, extension);
    const std::unique_ptr<Reel> reel = reel_of(options);
    const int last = reel->frames() - 1;
    std::string written = options.output;
    if (extension == ".png") {
        if (options.frame > last)
            throw Misuse("render: --frame " + std::to_string(options.frame) + ": " + options.runs[0] +
                         (last == 0 ? " has frame 0 alone"
                                    : (options.runs.size() > 1 ? " and what is beside it have frames 0 to "
                                                               : " has frames 0 to ") +
                                          std::to_string(last)));
        const int f = options.frame < 0 ? last : options.frame;
        reel->settle(f, f);
        write_png(options.output, reel->draw(f), options.overwrite);
    } else {
        reel->settle(0, last);
        InterruptGuard guard;
        Image image = reel->draw(0);
        VideoFile video(options.output, image.width, image.height, reel->fps(), options.overwrite);
        Progress progress("render", last + 1, "frame");
        for (int f = 0; f <= last; ++f) {
            // One frame is always in it, so that what is left can be played.
            if (f > 0 && guard.asked())
                throw Interrupted("interrupted: " + std::to_string(f) + " frames are kept in " +
                                  video.leave());
            if (f > 0) image = reel->draw(f);
            video.append(image);
            progress.update(f + 1);
        }
        written = video.commit();
    }
    log_info("wrote " + written);
    return 0;
}

}  // namespace wetcurl

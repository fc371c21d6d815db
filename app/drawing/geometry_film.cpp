// Runs, pairs and models as geometry images.
#include "app/drawing/geometry_film.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "app/drawing/chart.h"
#include "app/engine/run_of_scene.h"
#include "app/files/file_kind.h"
#include "base/progress.h"
#include "base/run_cache.h"
#include "learn/codec/doubled_image.h"
#include "learn/codec/encode_runs.h"
#include "learn/codec/network_module.h"

namespace wetcurl {

namespace {

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

struct Range {
    float low = 0, high = 0;
    float largest() const { return std::max(std::abs(low), std::abs(high)); }
};

// Of the values that hold data.
Range range_of(const GeometryPanel& p) {
    Range r{std::numeric_limits<float>::max(), std::numeric_limits<float>::lowest()};
    for (size_t k = 0; k < p.values.size(); ++k)
        if (p.mask[k % p.pixels()])
            r.low = std::min(r.low, p.values[k]), r.high = std::max(r.high, p.values[k]);
    return r.low > r.high ? Range{} : r;
}

// What all but the strongest 2 % of the values that hold data stay below, so that a few do not pale the rest.
float usual_strength(const GeometryPanel& p) {
    std::vector<float> strengths;
    for (size_t k = 0; k < p.values.size(); ++k)
        if (p.mask[k % p.pixels()]) strengths.push_back(std::abs(p.values[k]));
    if (strengths.empty()) return 0;
    const auto at = strengths.begin() + long(0.98 * double(strengths.size() - 1));
    std::nth_element(strengths.begin(), at, strengths.end());
    return *at;
}

std::string range_text(const GeometryPanel& p, double factor, const std::string& unit) {
    const Range r = range_of(p);
    return fmt::format("values {:.3g} to {:.3g}{}", factor * r.low, factor * r.high,
                       unit.empty() ? "" : " " + unit);
}

std::string size_text(const std::string& codec, const GeometryPanel& p) {
    const auto strands = std::count_if(p.mask.begin(), p.mask.end(), [](uint8_t m) { return m != 0; });
    return fmt::format("codec {}, {} x {} pixels, {} {}", codec, p.width, p.height, strands,
                       strands == 1 ? "strand" : "strands");
}

// Up to nine of first..last, spread evenly.
std::vector<int> samples_of(int first, int last) {
    std::vector<int> out;
    const int count = std::min(9, last - first + 1);
    for (int k = 0; k < count; ++k)
        out.push_back(count == 1 ? first : first + int(long(last - first) * k / (count - 1)));
    return out;
}

// ---------------------------------------------------------------- runs

// Roots as codec root encodes them, with one box for all runs and frames.
class RunFilm final : public GeometryFilm {
  public:
    explicit RunFilm(const std::vector<std::string>& files) {
        for (const auto& path : files) {
            One& one = runs_.emplace_back();
            one.reader = std::make_unique<RunReader>(path);
            const RunReader& run = *one.reader;
            if (run.frames() == 0) throw Error(path + ": there is no frame in it to draw");
            try {
                one.image = std::make_unique<RootImage>(run.header().groom.grid);
            } catch (const Error& e) {
                throw Error(path + ": " + e.what());
            }
            one.wet = simulated_wet(run.header());
            frames_ = runs_.size() == 1 ? run.frames() : std::min(frames_, run.frames());
        }
        for (One& one : runs_) {
            const RunHeader& header = one.reader->header();
            const float radius = support_radius_of(header);
            Progress progress("roots", frames_, "frame");
            for (int f = 0; f < frames_; ++f) {
                const RunFrame frame = one.reader->frame(f);
                one.roots.push_back(shifted_roots(
                    frame.seen(), one.wet ? frame.wetness(header) : std::vector<float>(), radius));
                grow(box_, one.roots.back());
                progress.update(f + 1);
            }
        }
        if (!(box_.diagonal() > 0))
            throw Error(files[0] +
                        ": all roots lie in one point, Eq 14 needs a box with a diagonal (two strands or "
                        "more, or a head that moves)");
    }
    int frames() const override { return frames_; }
    double fps() const override { return runs_[0].reader->header().fps; }

    std::vector<GeometryPanel> panels(int f) override {
        std::vector<GeometryPanel> out;
        for (const One& one : runs_) {
            GeometryPanel& p = out.emplace_back();
            p.height = one.image->height(), p.width = one.image->width(), p.mask = one.image->mask();
            p.values.resize(3 * p.pixels());
            std::vector<Vec3f> colours = one.roots[size_t(f)];
            for (Vec3f& c : colours) c = colour_of(c, box_);
            one.image->draw(colours, p.values.data());
            p.caption = {fmt::format("roots of a {} run ({})", one.wet ? "wet" : "dry",
                                     one.wet ? "Eq 14, 16" : "Eq 14"),
                         fmt::format("{}, frame {} of 0 to {}", file_name(one.reader->path()), f,
                                     one.reader->frames() - 1),
                         size_text("root", p),
                         fmt::format("{}; 1 is {:.4g} mm", range_text(p, 1, ""), 1e3 * box_.diagonal())};
        }
        return out;
    }

  private:
    struct One {
        std::unique_ptr<RunReader> reader;
        std::unique_ptr<RootImage> image;
        bool wet = false;
        std::vector<std::vector<Vec3f>> roots;  // (frame, strand), shifted by Eq 16 where wet
    };
    std::vector<One> runs_;
    ColourBox box_;
    int frames_ = 0;
};

// ---------------------------------------------------------------- pairs, with or without models

// A network beside the pairs that it is asked about.
struct Asked {
    std::string path;
    std::unique_ptr<Network> network;
    const ModelCard& card() const { return network->card(); }
};

std::vector<Asked> asked_of(const std::vector<std::string>& models, const PairsReader& pairs, int threads) {
    std::vector<Asked> out;
    for (const auto& path : models) {
        const ModelCard card = network_module().card(path);
        const std::string codec = name_of(pairs.codec());
        if (card.codec != codec)
            throw Error(
                fmt::format("{}: found a model of codec {}, {} holds pairs of codec {}: name a model "
                            "trained on such pairs",
                            path, card.codec, pairs.path(), codec));
        if (card.low != pairs.low())
            throw Error(fmt::format("{}: learned from {} low-resolution runs, those of {} are {}", path,
                                    card.low, pairs.path(), pairs.low()));
        out.push_back({path, network_module().load(path, "cpu", threads)});
    }
    return out;
}

std::string chosen(const PairsReader& pairs, int run, int frame, int frames,
                   const std::vector<int>& of_run = {}) {
    return fmt::format("{}{}, frame {} of 0 to {}{}", file_name(pairs.path()),
                       pairs.runs() == 1 ? "" : fmt::format(", run {} of 0 to {}", run, pairs.runs() - 1),
                       frame, frames - 1,
                       of_run.empty() || of_run[size_t(frame)] == frame
                           ? ""
                           : fmt::format(" (the run's {})", of_run[size_t(frame)]));
}

// Values less those of another panel.
GeometryPanel difference(const GeometryPanel& a, const GeometryPanel& b) {
    GeometryPanel out = a;
    for (size_t k = 0; k < out.values.size(); ++k) out.values[k] -= b.values[k];
    out.caption.clear();
    return out;
}

// What pairs of both codecs share: a row of panels, and residuals about grey.
class PairsFilm : public GeometryFilm {
  public:
    PairsFilm(std::unique_ptr<PairsReader> pairs, int run, std::vector<Asked> asked)
        : pairs_(std::move(pairs)), run_(run), asked_(std::move(asked)) {}

  protected:
    // Two lines of a caption: what the values are, and how much stronger their colours are than those of what
    // it is a residual of. `mm` of a value of 1.
    void describe_residual(GeometryPanel& p, const GeometryPanel& of, double mm) const {
        p.caption.push_back(range_text(p, mm, "mm"));
        p.caption.push_back(fmt::format("grey is 0, full colour {:.3g} mm or more (x {:.3g})", reach_mm_,
                                        double(p.gain / of.gain)));
    }

    std::unique_ptr<PairsReader> pairs_;
    int run_;
    std::vector<Asked> asked_;
    double reach_mm_ = 1;  // a residual of full colour
};

class RootPairsFilm final : public PairsFilm {
  public:
    RootPairsFilm(std::unique_ptr<PairsReader> pairs, int run, std::vector<Asked> asked)
        : PairsFilm(std::move(pairs), run, std::move(asked)), shape_(pairs_->root(run)) {
        pairs_->box(&box_.lower.x, &box_.upper.x);
        for (const Asked& a : asked_) {
            const auto& arrays = a.card().arrays;
            for (const auto& [name, corner] : {std::pair{"b_min", box_.lower}, {"b_max", box_.upper}}) {
                const auto found = arrays.find(name);
                if (found != arrays.end() && found->second.size() == 3 &&
                    norm(Vec3d{found->second[0], found->second[1], found->second[2]} - corner) > 1e-5)
                    throw Error(a.path + ": its colours (Eq 14) are of another box than those of " +
                                pairs_->path() + ": name a model trained on these pairs, or encode with its");
            }
        }
    }
    int frames() const override { return shape_.frames; }

    void settle(int first, int last) override {
        float most = 0;
        for (int f : samples_of(first, last))
            for (const auto& p : all(f))
                if (p.middle > 0) most = std::max(most, usual_strength(p));
        reach_mm_ = round_above(1e3 * box_.diagonal() * double(most));
    }

    std::vector<GeometryPanel> panels(int f) override { return all(f); }

  private:
    std::vector<GeometryPanel> all(int f) {
        GeometryPanel input, target;
        input.height = shape_.height, input.width = shape_.width, input.mask = shape_.mask_low;
        target.height = 2 * shape_.height, target.width = 2 * shape_.width, target.mask = shape_.mask;
        input.values.resize(3 * input.pixels());
        target.values.resize(3 * target.pixels());
        pairs_->frame(run_, f, input.values.data(), target.values.data());
        const double mm = 1e3 * box_.diagonal();
        const std::string where = chosen(*pairs_, run_, f, shape_.frames);
        auto caption = [&](GeometryPanel& p, const std::string& what, const std::string& from) {
            p.caption = {what, from, size_text("root", p),
                         fmt::format("{}; 1 is {:.4g} mm", range_text(p, 1, ""), mm)};
        };
        auto residual = [&](const GeometryPanel& a, const GeometryPanel& b, const std::string& what,
                            const std::string& from) {
            GeometryPanel p = difference(a, b);
            p.middle = 0.5f, p.gain = float(0.5 * mm / reach_mm_);
            p.caption = {what, from, size_text("root", p)};
            describe_residual(p, a, mm);
            return p;
        };
        caption(input, fmt::format("input: {} roots (Eq 14)", pairs_->low()), where);
        caption(target, "target: wet roots (Eq 14, 16)", where);
        std::vector<GeometryPanel> out{input};
        for (const Asked& a : asked_) {
            GeometryPanel answer = target;
            a.network->run(input.values.data(), {1, 3, input.height, input.width}, answer.values.data());
            caption(answer, "prediction of " + a.card().architecture, file_name(a.path));
            out.push_back(answer);
        }
        out.push_back(target);
        for (size_t k = 0; k < asked_.size(); ++k)
            out.push_back(
                residual(out[1 + k], target, "residual: prediction - target", file_name(asked_[k].path)));
        if (asked_.empty()) {
            GeometryPanel doubled = target;
            doubled.values = doubled_image(input.values.data(), 3, input.height, input.width);
            out.push_back(residual(target, doubled, "residual: target - doubled input", where));
        }
        return out;
    }

    RootPairs shape_;
    ColourBox box_;
};

class StrandPairsFilm final : public PairsFilm {
  public:
    StrandPairsFilm(std::unique_ptr<PairsReader> pairs, int run, std::vector<Asked> asked)
        : PairsFilm(std::move(pairs), run, std::move(asked)),
          shape_(pairs_->strand(run)),
          dct_(pairs_->particles()),
          inputs_(shape_.static_channels + shape_.dynamic_channels) {
        for (const Asked& a : asked_) {
            if (a.card().input_channels != inputs_)
                throw Error(fmt::format("{}: takes {} channels, {} holds {}: encode again", a.path,
                                        a.card().input_channels, pairs_->path(), inputs_));
            if (a.card().target == "displayed" && !shape_.displayed)
                throw Error(
                    fmt::format("{}: learned the strands after Eq 10, run {} of {} holds those "
                                "before it alone",
                                a.path, run, pairs_->path()));
            if (a.card().target != asked_[0].card().target)
                throw Error(fmt::format("{}: learned another target than {}: draw them apart", a.path,
                                        asked_[0].path));
        }
        displayed_ = !asked_.empty() && asked_[0].card().target == "displayed";
    }
    int frames() const override { return shape_.frames; }

    void settle(int first, int last) override {
        float tips = 0, residuals = 0;
        for (int f : samples_of(first, last))
            for (const auto& [panel, is_residual] : all(f)) {
                if (is_residual)
                    residuals = std::max(residuals, usual_strength(panel));
                else
                    tips = std::max(tips, range_of(panel).largest());
            }
        tips_mm_ = round_above(1e3 * double(tips)), reach_mm_ = round_above(1e3 * double(residuals));
    }

    std::vector<GeometryPanel> panels(int f) override {
        std::vector<GeometryPanel> out;
        for (auto& [panel, is_residual] : all(f)) {
            if (is_residual) {
                describe_residual(panel, out[0], 1e3);
            } else {
                panel.caption.push_back(range_text(panel, 1e3, "mm"));
                panel.caption.push_back(fmt::format("grey is 0, full colour {:.3g} mm", tips_mm_));
            }
            panel.caption.push_back("tip from root: red x, green y, blue z");
            out.push_back(std::move(panel));
        }
        return out;
    }

  private:
    // Amplitudes (72, H, W) as tips.
    GeometryPanel tips_of(const std::vector<float>& amplitudes) const {
        GeometryPanel p;
        p.height = shape_.height, p.width = shape_.width, p.mask = shape_.mask;
        p.values.resize(3 * p.pixels());
        std::vector<Vec3f> strand(size_t(dct_.particles()));
        for (size_t k = 0; k < p.pixels(); ++k) {
            float c[strand_coefficients];
            for (size_t m = 0; m < size_t(strand_coefficients); ++m) c[m] = amplitudes[m * p.pixels() + k];
            dct_.decode(c, strand.data());
            const Vec3f tip = shape_.length[k] * (strand.back() - strand.front());
            p.values[k] = tip.x, p.values[p.pixels() + k] = tip.y, p.values[2 * p.pixels() + k] = tip.z;
        }
        return p;
    }

    // And whether each is a residual.
    std::vector<std::pair<GeometryPanel, bool>> all(int f) const {
        const size_t area = shape_.pixels();
        std::vector<float> inputs = shape_.fixed, target(size_t(strand_coefficients) * area);
        inputs.resize(size_t(inputs_) * area);
        float* const dynamic = inputs.data() + size_t(shape_.static_channels) * area;
        pairs_->frame(run_, f, dynamic, target.data(), displayed_);
        const std::vector<float> base(dynamic, dynamic + target.size());
        auto on_base = [&](std::vector<float> amplitudes) {
            for (size_t k = 0; k < amplitudes.size(); ++k) amplitudes[k] += base[k];
            return tips_of(amplitudes);
        };
        const std::string where = chosen(*pairs_, run_, f, shape_.frames, shape_.frame);
        std::vector<std::pair<GeometryPanel, bool>> out;
        auto add = [&](GeometryPanel p, const std::string& what, const std::string& from, bool residual) {
            p.middle = 0.5f, p.gain = float(0.5e3 / (residual ? reach_mm_ : tips_mm_));
            p.caption = {what, from, size_text("strand", p)};
            out.emplace_back(std::move(p), residual);
        };
        add(tips_of(base), "input: base strands", where, false);
        const GeometryPanel wanted = on_base(target);
        std::vector<GeometryPanel> answers;
        for (const Asked& a : asked_) {
            std::vector<float> answer(size_t(a.card().output_channels) * area);
            a.network->run(inputs.data(), {1, inputs_, shape_.height, shape_.width}, answer.data());
            answer.resize(target.size());  // amplitudes come first
            answers.push_back(on_base(answer));
            add(answers.back(), "prediction of " + a.card().architecture, file_name(a.path), false);
        }
        add(wanted, displayed_ ? "target: wet strands, after Eq 10" : "target: wet strands, before Eq 10",
            where, false);
        for (size_t k = 0; k < answers.size(); ++k)
            add(difference(answers[k], wanted), "residual: prediction - target", file_name(asked_[k].path),
                true);
        if (asked_.empty()) add(difference(wanted, out[0].first), "residual: target - base", where, true);
        return out;
    }

    StrandPairs shape_;
    StrandDct dct_;
    int inputs_;
    bool displayed_ = false;
    double tips_mm_ = 1;  // an offset of full colour
};

// ---------------------------------------------------------------- models alone

// Of the first layer: a network of colours as its filters, side by side, any other as the matrix of its
// weights, a row an output, a column an input.
class FilterFilm final : public GeometryFilm {
  public:
    explicit FilterFilm(const std::vector<std::string>& models) {
        for (const auto& path : models) panels_.push_back(panel_of(path));
    }
    int frames() const override { return 1; }
    std::vector<GeometryPanel> panels(int) override { return panels_; }

  private:
    static GeometryPanel panel_of(const std::string& path) {
        const ModelCard card = network_module().card(path);
        const H5Reader file(path, "wetcurl model", 1);
        // The first of all that take the network's inputs.
        std::string layer;
        std::vector<size_t> shape;
        for (const auto& name : file.list("weights"))
            if (const auto s = file.shape("weights/" + name);
                layer.empty() && s.size() >= 2 && s[1] == size_t(card.input_channels))
                layer = name, shape = s;
        if (layer.empty())
            throw Error(
                fmt::format("{}: no layer of it takes its {} inputs alone, so there are no filters "
                            "to draw; name pairs as well: render --image PAIRS.h5 {}",
                            path, card.input_channels, file_name(path)));
        const auto weights = file.read<float>("weights/" + layer);
        const size_t taps = shape.size() == 4 ? shape[2] * shape[3] : 1;
        const bool colours = card.codec == "root" && shape[1] == 3 && taps > 1;
        GeometryPanel p = colours ? filters(weights, shape) : matrix(weights, shape[0], shape[1] * taps);
        float most = 0;
        for (float w : weights) most = std::max(most, std::abs(w));
        p.middle = 0.5f, p.gain = 0.5f / std::max(most, 1e-30f);
        p.caption = {
            colours ? "filters of the first layer" : "weights of the first layer",
            fmt::format("{}: {} ({})", file_name(path), card.architecture, layer),
            colours ? fmt::format("codec {}, {} filters of {} x {}", card.codec, shape[0], shape[3], shape[2])
                    : fmt::format("codec {}, {} outputs (down) of {} inputs (across)", card.codec, shape[0],
                                  shape[1] * taps),
            fmt::format("grey is 0, full colour {:.3g}{}", most,
                        colours ? "" : "; red positive, blue negative")};
        return p;
    }

    // (out, 3, h, w) as coloured tiles with a seam between them.
    static GeometryPanel filters(const std::vector<float>& weights, const std::vector<size_t>& shape) {
        const size_t count = shape[0], h = shape[2], w = shape[3];
        const auto across = size_t(std::ceil(std::sqrt(double(count)))), down = (count + across - 1) / across;
        GeometryPanel p;
        p.height = int(down * (h + 1) - 1), p.width = int(across * (w + 1) - 1);
        p.values.assign(3 * p.pixels(), 0), p.mask.assign(p.pixels(), 0);
        for (size_t k = 0; k < count; ++k)
            for (size_t y = 0; y < h; ++y)
                for (size_t x = 0; x < w; ++x) {
                    const size_t pixel =
                        (k / across * (h + 1) + y) * size_t(p.width) + k % across * (w + 1) + x;
                    p.mask[pixel] = 1;
                    for (size_t c = 0; c < 3; ++c)
                        p.values[c * p.pixels() + pixel] = weights[((k * 3 + c) * h + y) * w + x];
                }
        return p;
    }

    // Red positive, blue negative, on grey.
    static GeometryPanel matrix(const std::vector<float>& weights, size_t rows, size_t columns) {
        GeometryPanel p;
        p.height = int(rows), p.width = int(columns);
        p.mask.assign(p.pixels(), 1);
        p.values.resize(3 * p.pixels());
        for (size_t k = 0; k < p.pixels(); ++k) {
            p.values[k] = weights[k];
            p.values[p.pixels() + k] = -0.4f * std::abs(weights[k]);
            p.values[2 * p.pixels() + k] = -weights[k];
        }
        return p;
    }

    std::vector<GeometryPanel> panels_;
};

}  // namespace

std::unique_ptr<GeometryFilm> geometry_film(const std::vector<std::string>& files, int run, int threads) {
    std::vector<std::string> runs, pairs, models;
    for (const auto& path : files) {
        const FileKind kind = kind_of_file(path);
        (kind == FileKind::run ? runs : kind == FileKind::pairs ? pairs : models).push_back(path);
    }
    if (pairs.size() > 1 || (!runs.empty() && runs.size() < files.size()))
        throw Misuse(
            fmt::format("render --image: found {} runs, {} pairs files and {} models; allowed are "
                        "runs alone, one pairs file with or without models, or models alone",
                        runs.size(), pairs.size(), models.size()));
    if (pairs.empty() && run > 0)
        throw Misuse("render --image: --run picks one of the runs in a pairs file, and none is named");
    if (!runs.empty()) return std::make_unique<RunFilm>(runs);
    if (pairs.empty()) return std::make_unique<FilterFilm>(models);
    auto reader = std::make_unique<PairsReader>(pairs[0]);
    if (reader->codec() == Codec::adhesion)
        throw Error(pairs[0] +
                    ": holds pairs of codec adhesion, which are no images; `wetcurl plot PAIRS.h5 --model "
                    "MODEL.h5` draws them");
    if (run >= reader->runs())
        throw Misuse(
            fmt::format("render --image: --run {}: {} has runs 0 to {}", run, pairs[0], reader->runs() - 1));
    auto asked = asked_of(models, *reader, threads);
    if (reader->codec() == Codec::root)
        return std::make_unique<RootPairsFilm>(std::move(reader), run, std::move(asked));
    return std::make_unique<StrandPairsFilm>(std::move(reader), run, std::move(asked));
}

}  // namespace wetcurl

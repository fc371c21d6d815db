// Batches drawn from pairs files.
#include "training/data.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <sstream>

#include "base/error.h"
#include "learn/codec/strand_codec.h"
#include "models/registry.h"

namespace wetcurl {
namespace {

using std::vector;

// Of an epoch: the same for every training with this seed, whatever came before.
std::mt19937_64 generator(double seed, long epoch) {
    std::seed_seq mix{uint64_t(seed) & 0xffffffffu, uint64_t(seed) >> 32, uint64_t(epoch)};
    return std::mt19937_64(mix);
}

// Below n; a modulus of 64 random bits is even enough, and the same in every standard library.
size_t draw(std::mt19937_64& random, size_t n) { return size_t(random() % n); }

vector<long> shuffled(vector<long> items, std::mt19937_64& random) {
    for (size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[draw(random, i)]);
    return items;
}

vector<long> counting(long n) {
    vector<long> items(static_cast<size_t>(n));
    std::iota(items.begin(), items.end(), 0l);
    return items;
}

long ceil_divide(long a, long b) { return (a + b - 1) / b; }

// How many of `count` frames, in order of time, training sees; the rest is held out.
long trained_of(long count, double validation, const std::string& where) {
    const long held = validation > 0 ? std::max(1l, std::lround(count * validation)) : 0;
    if (held >= count)
        throw Error(where + ": found " + std::to_string(count) + " frames, of which validation = " +
                    std::to_string(validation) + " leaves none to train on; validation = 0 holds none out");
    return count - held;
}

void require_finite(const Tensor& values, const std::string& where) {
    if (!torch::isfinite(values).all().item<bool>())
        throw Error(where + ": found a value that is not finite, only finite numbers are allowed");
}

std::string run_name(const PairsReader& pairs, int run) {
    return pairs.path() + ": runs/" + std::to_string(run);
}

// How many of a run's frames training sees: all or none, where files of their own are held out.
long trained_of(const PairsReader& file, int run, long frames, size_t place, size_t trained, size_t files,
                const Recipe& recipe) {
    if (trained == files) return trained_of(frames, recipe.validation, run_name(file, run));
    return place < trained ? frames : 0;
}

// A frame that a batch can name.
struct Place {
    size_t run;
    long frame;
};

vector<Place> places_of(const vector<long>& frames, const vector<long>& trained, bool held_out) {
    vector<Place> places;
    for (size_t r = 0; r < frames.size(); ++r)
        for (long f = held_out ? trained[r] : 0; f < (held_out ? frames[r] : trained[r]); ++f)
            places.push_back({r, f});
    return places;
}

Tensor image(const Tensor& rows) { return rows.unsqueeze(2).unsqueeze(3); }

// ---- codec strand: masked pixels as rows, whole frames ----

class StrandData : public TrainingData {
  public:
    StrandData(const vector<PairsReader*>& pairs, size_t trained, const Recipe& recipe, torch::Device device)
        : recipe_(recipe),
          device_(device),
          displayed_(recipe.target == "displayed"),
          neighbours_(find_architecture(recipe.architecture)->neighbours) {
        for (size_t k = 0; k < pairs.size(); ++k)
            for (int r = 0; r < pairs[k]->runs(); ++r) {
                add_run(*pairs[k], r);
                trained_.push_back(
                    trained_of(*pairs[k], r, frames_.back(), k, trained, pairs.size(), recipe));
            }
        train_ = places_of(frames_, trained_, false);
        held_ = places_of(frames_, trained_, true);
        starts_ = recipe.steady > 0 ? followed() : train_;
        find_statistics();
    }

    void describe(ModelCard& card) const override {
        card.input_channels = int(mean_.size(0));
        card.arrays["input_mean"] = values(mean_);
        card.arrays["input_std"] = values(deviation_);
        card.arrays["input_low"] = values(low_);
        card.arrays["input_high"] = values(high_);
        card.arrays["output_scale"] = values(scale_);
        card.target = recipe_.target;
    }
    void begin_epoch(long epoch) override {
        auto random = generator(recipe_.seed, epoch);
        order_ = shuffled(counting(long(starts_.size())), random);
    }
    long steps() const override { return ceil_divide(long(starts_.size()), long(batch_of_starts())); }
    Batch batch(long step) const override {
        vector<Place> places;
        for (long i : share(step, batch_of_starts(), order_.size()))
            places.push_back(starts_[size_t(order_[size_t(i)])]);
        if (!in_pairs()) return of(places);
        for (size_t k = 0, count = places.size(); k < count; ++k)
            places.push_back({places[k].run, places[k].frame + 1});
        Batch out = of(places);
        out.in_pairs = true;
        return out;
    }
    long validation_batches() const override { return long(held_.size()); }
    Batch validation_batch(long i) const override { return of({held_[size_t(i)]}); }
    double unit() const override { return 1; }

  private:
    struct Run {
        Tensor fixed, dynamic, target;           // (P, Cs), (F, P, Cd), (F, P, 72)
        Tensor pixels, length, relative_length;  // (P), (P, 1) [m], (P, 1)
        long height, width;
        vector<int> times;  // (F)
    };

    bool in_pairs() const { return recipe_.steady > 0; }
    double batch_of_starts() const {
        return in_pairs() ? std::max(1.0, std::floor(recipe_.batch / 2)) : recipe_.batch;
    }

    // The frames of training that another follows, each in one pair.
    vector<Place> followed() const {
        vector<Place> starts;
        for (size_t k = 0; k + 1 < train_.size(); ++k) {
            const Place &now = train_[k], &next = train_[k + 1];
            const vector<int>& times = runs_[now.run].times;
            if (now.run != next.run || times.empty() ||
                times[size_t(next.frame)] != times[size_t(now.frame)] + 1)
                continue;
            starts.push_back(now);
            ++k;
        }
        if (starts.empty())
            throw Error(
                "pairs: found no two frames that are known to be in a row, which loss.steady needs (together "
                "= 2 in the data set's recipe)");
        return starts;
    }

    static vector<float> values(const Tensor& t) {
        return {t.data_ptr<float>(), t.data_ptr<float>() + t.numel()};
    }

    // (C, H W) to rows of the masked pixels (P, C).
    static Tensor masked_rows(const float* planes, long channels, const Tensor& pixels, long area) {
        return torch::from_blob(const_cast<float*>(planes), {channels, area})
            .index_select(1, pixels)
            .t()
            .contiguous();
    }

    void add_run(const PairsReader& file, int r) {
        const StrandPairs run = file.strand(r);
        const std::string where = run_name(file, r);
        const long area = long(run.pixels());
        vector<long> inside;
        vector<float> lengths;
        for (long p = 0; p < area; ++p)
            if (run.mask[size_t(p)]) {
                inside.push_back(p);
                lengths.push_back(run.length[size_t(p)]);
            }
        if (inside.empty()) throw Error(where + "/mask: found no strand");
        if (displayed_ && !run.displayed)
            throw Error(where + ": knows no strands after cohesion, which target = \"displayed\" needs");
        const Tensor pixels = torch::tensor(inside);
        const long count = pixels.size(0);

        Run out;
        out.pixels = pixels.to(device_), out.height = run.height, out.width = run.width;
        out.times = run.frame;
        const Tensor length = torch::tensor(lengths).unsqueeze(1);
        const double mean = length.mean().item<double>();
        if (!(mean > 0) || !std::isfinite(mean))
            throw Error(where + "/length: found a mean strand length of " + std::to_string(mean) +
                        " m, needed above 0");
        out.length = length.to(device_);
        out.relative_length = (length / mean).to(device_);
        out.fixed = masked_rows(run.fixed.data(), run.static_channels, pixels, area);
        out.dynamic = torch::empty({run.frames, count, run.dynamic_channels});
        out.target = torch::empty({run.frames, count, strand_coefficients});
        vector<float> dynamic(size_t(run.dynamic_channels * area)),
            target(size_t(strand_coefficients * area));
        for (int f = 0; f < run.frames; ++f) {
            file.frame(r, f, dynamic.data(), target.data(), displayed_);
            out.dynamic[f].copy_(masked_rows(dynamic.data(), run.dynamic_channels, pixels, area));
            out.target[f].copy_(masked_rows(target.data(), strand_coefficients, pixels, area));
        }
        for (const auto& t : {out.fixed, out.dynamic, out.target}) require_finite(t, where);
        if (!runs_.empty() &&
            (runs_[0].fixed.size(1) != out.fixed.size(1) || runs_[0].dynamic.size(2) != out.dynamic.size(2)))
            throw Error(where + ": found other channels than in the first run");
        // Whole: an epoch over the wire would keep a device waiting.
        for (Tensor* t : {&out.fixed, &out.dynamic, &out.target}) *t = t->to(device_);
        runs_.push_back(out);
        frames_.push_back(run.frames);
    }

    // Per channel over the frames that training sees, in double: mean, deviation and range of the inputs,
    // size of the target.
    void find_statistics() {
        const auto exact = torch::dtype(torch::kDouble).device(device_);
        Tensor sum = torch::zeros({channels()}, exact), squares = sum.clone();
        Tensor targets = torch::zeros({strand_coefficients}, exact);
        Tensor low = torch::full({channels()}, mute, exact), high = -low;
        double rows = 0;
        for (const auto& place : train_) {
            const Tensor x = inputs_of(place).to(torch::kDouble),
                         y = runs_[place.run].target[place.frame].to(torch::kDouble);
            sum += x.sum(0);
            squares += x.square().sum(0);
            low = torch::minimum(low, x.amin(0)), high = torch::maximum(high, x.amax(0));
            targets += y.square().sum(0);
            rows += double(x.size(0));
        }
        sum = sum.cpu(), squares = squares.cpu(), targets = targets.cpu();
        const Tensor mean = sum / rows;
        const Tensor deviation = (squares / rows - mean.square()).clamp_min(0).sqrt();
        // A channel that never changes taught nothing: it comes in as zero, also where it differs at run
        // time.
        const Tensor constant = deviation <= 1e-5 * mean.abs() + 1e-9;
        low_ = low.cpu().to(torch::kFloat), high_ = high.cpu().to(torch::kFloat);
        mean_ = mean.to(torch::kFloat);
        deviation_ = torch::where(constant, torch::full_like(deviation, mute), deviation).to(torch::kFloat);
        if (!recipe_.leave_out.empty() && channels() != strand_channels)
            throw Error("pairs: found " + std::to_string(channels()) + " inputs, leave_out knows names for " +
                        std::to_string(strand_channels));
        std::istringstream left_out(recipe_.leave_out);
        for (std::string name; left_out >> name;)
            for (const InputGroup& group : strand_inputs)
                if (name == group.name) {
                    auto of_group = [&](Tensor& t) {
                        return t.narrow(0, group.channels.first, group.channels.count);
                    };
                    of_group(deviation_).fill_(mute);
                    of_group(low_).fill_(-mute), of_group(high_).fill_(mute);
                }
        const Tensor size = (targets / rows).sqrt();
        // Amplitudes that hardly move keep a thousandth of the largest, so that none is out of reach.
        scale_ = torch::cat({torch::maximum(size, 1e-3 * size.max()).clamp_min(1e-9).to(torch::kFloat),
                             torch::ones({answered_errors.count})});
    }

    long channels() const { return runs_[0].fixed.size(1) + runs_[0].dynamic.size(2); }

    // (P, C)
    Tensor inputs_of(const Place& place) const {
        const Run& r = runs_[place.run];
        return torch::cat({r.fixed, r.dynamic[place.frame]}, 1);
    }

    Batch of(const vector<Place>& places) const {
        if (places.empty()) return {};
        vector<Tensor> inputs, targets, bases, lengths, relative;
        for (const Place& place : places) {
            const Run& r = runs_[place.run];
            inputs.push_back(inputs_of(place));
            targets.push_back(r.target[place.frame]);
            lengths.push_back(r.length), relative.push_back(r.relative_length);
            bases.push_back(
                r.dynamic[place.frame].narrow(1, dynamic_layout.base.first, dynamic_layout.base.count));
        }
        const Tensor rows = torch::cat(inputs);
        Batch out{image(rows), image(torch::cat(targets)), torch::cat(bases),   {},
                  {},          torch::cat(lengths),        torch::cat(relative)};
        if (neighbours_) lay_out(places, rows, out);
        return out;
    }

    // The rows as whole frames.
    void lay_out(const vector<Place>& places, const Tensor& rows, Batch& out) const {
        const Run& first = runs_[places[0].run];
        const long area = first.height * first.width, frames = long(places.size());
        vector<Tensor> pixels;
        for (const Place& place : places) {
            const Run& r = runs_[place.run];
            if (r.height != first.height || r.width != first.width)
                throw Error("pairs: found grids of " + std::to_string(r.width) + " x " +
                            std::to_string(r.height) + " and of " + std::to_string(first.width) + " x " +
                            std::to_string(first.height) + " roots in one batch; " + recipe_.architecture +
                            " needs one size, or batch = 1");
            pixels.push_back(r.pixels + long(pixels.size()) * area);
        }
        Tensor whole = rows;
        if (rows.size(0) < frames * area) {
            out.pixels = torch::cat(pixels);
            whole = torch::zeros({frames * area, rows.size(1)}, rows.options());
            whole.index_copy_(0, out.pixels, rows);
        }
        out.input = whole.view({frames, first.height, first.width, -1}).permute({0, 3, 1, 2});
    }

    Recipe recipe_;
    torch::Device device_;
    bool displayed_, neighbours_;
    vector<Run> runs_;
    vector<long> frames_, trained_, order_;
    vector<Place> train_, held_, starts_;  // of frames or pairs that an epoch draws
    static constexpr double mute = 1e30;   // a deviation by which an input is as good as 0
    Tensor mean_, deviation_, low_, high_, scale_;
};

// ---- codec root: patches of colour images ----

class RootData : public TrainingData {
  public:
    RootData(const vector<PairsReader*>& pairs, size_t trained, const Recipe& recipe, torch::Device device)
        : recipe_(recipe), device_(device) {
        pairs.front()->box(lower_, upper_);
        for (size_t k = 0; k < pairs.size(); ++k) {
            require_same_box(*pairs[k]);
            for (int r = 0; r < pairs[k]->runs(); ++r) {
                add_run(*pairs[k], r);
                trained_.push_back(
                    trained_of(*pairs[k], r, frames_.back(), k, trained, pairs.size(), recipe));
            }
        }
        train_ = places_of(frames_, trained_, false);
        held_ = places_of(frames_, trained_, true);
        for (size_t p = 0; p < train_.size(); ++p)
            for (long k = patches_of(runs_[train_[p].run]); k > 0; --k) samples_.push_back(long(p));
    }

    void describe(ModelCard& card) const override {
        card.input_channels = colour_channels;
        card.arrays["b_min"] = {float(lower_[0]), float(lower_[1]), float(lower_[2])};
        card.arrays["b_max"] = {float(upper_[0]), float(upper_[1]), float(upper_[2])};
    }
    // As many patches as cover each image once, at random places.
    void begin_epoch(long epoch) override {
        auto random = generator(recipe_.seed, epoch);
        order_ = shuffled(samples_, random);
        corners_.clear();
        for (long sample : order_) {
            const Run& run = runs_[train_[size_t(sample)].run];
            const long y = long(draw(random, size_t(run.input.size(2) - side() + 1)));
            corners_.push_back({y, long(draw(random, size_t(run.input.size(3) - side() + 1)))});
        }
    }
    long steps() const override { return ceil_divide(long(samples_.size()), long(recipe_.batch)); }
    Batch batch(long step) const override {
        vector<Batch> patches;
        for (long i : share(step, recipe_.batch, order_.size())) {
            const auto [y, x] = corners_[size_t(i)];
            patches.push_back(patch(train_[size_t(order_[size_t(i)])], y, x, side(), side()));
        }
        return joined(patches);
    }
    long validation_batches() const override { return long(held_.size()); }
    Batch validation_batch(long i) const override {
        const Tensor& input = runs_[held_[size_t(i)].run].input;
        return patch(held_[size_t(i)], 0, 0, input.size(2), input.size(3));
    }
    double unit() const override {
        double square = 0;
        for (int a = 0; a < 3; ++a) square += (upper_[a] - lower_[a]) * (upper_[a] - lower_[a]);
        return std::sqrt(square);
    }

  private:
    struct Run {
        Tensor input, target, mask;  // (F, 3, h, w), (F, 3, 2h, 2w), (1, 1, 2h, 2w)
        // (F, 3, 2h, 2w): up() of the whole images; at its border a patch's own would be an extrapolation.
        Tensor base = {};
    };

    void require_same_box(const PairsReader& file) const {
        double lower[3], upper[3];
        file.box(lower, upper);
        if (!std::equal(lower, lower + 3, lower_) || !std::equal(upper, upper + 3, upper_))
            throw Error(file.path() +
                        ": found another box (b_min, b_max) than in the first file; one model has one box: "
                        "encode the runs together");
        if (!(unit() > 0) || !std::isfinite(unit()))
            throw Error(file.path() + ": found an empty box (b_min, b_max)");
    }

    void add_run(const PairsReader& file, int r) {
        const RootPairs run = file.root(r);
        const std::string where = run_name(file, r);
        Run out{torch::empty({run.frames, colour_channels, run.height, run.width}),
                torch::empty({run.frames, colour_channels, 2 * run.height, 2 * run.width}),
                torch::tensor(vector<int>(run.mask.begin(), run.mask.end()))
                    .ne(0)
                    .to(torch::kFloat)
                    .view({1, 1, 2 * run.height, 2 * run.width})};
        for (int f = 0; f < run.frames; ++f)
            file.frame(r, f, out.input[f].data_ptr<float>(), out.target[f].data_ptr<float>());
        for (const auto& t : {out.input, out.target}) require_finite(t, where);
        if (out.mask.sum().item<float>() == 0) throw Error(where + "/mask: found no strand");
        for (Tensor* t : {&out.input, &out.target, &out.mask}) *t = t->to(device_);
        out.base = up(out.input);
        smallest_ = std::min({smallest_, long(run.height), long(run.width)});
        runs_.push_back(out);
        frames_.push_back(run.frames);
    }

    // Patches of a batch are of one size: the recipe's, or the smallest image's.
    long side() const { return std::min(long(recipe_.patch), smallest_); }
    long patches_of(const Run& run) const {
        return ceil_divide(run.input.size(2), side()) * ceil_divide(run.input.size(3), side());
    }

    Batch patch(const Place& place, long y, long x, long height, long width) const {
        const Run& r = runs_[place.run];
        auto cut = [&](const Tensor& t, long scale) {
            return t.narrow(2, scale * y, scale * height).narrow(3, scale * x, scale * width);
        };
        auto frame = [&](const Tensor& t) { return t.narrow(0, place.frame, 1); };
        return {cut(frame(r.input), 1), cut(frame(r.target), 2), cut(frame(r.base), 2), cut(r.mask, 2), {}};
    }

    static Batch joined(const vector<Batch>& patches) {
        if (patches.empty()) return {};
        vector<Tensor> parts[4];
        for (const auto& p : patches) {
            parts[0].push_back(p.input);
            parts[1].push_back(p.target);
            parts[2].push_back(p.base);
            parts[3].push_back(p.mask);
        }
        return {torch::cat(parts[0]), torch::cat(parts[1]), torch::cat(parts[2]), torch::cat(parts[3]), {}};
    }

    Recipe recipe_;
    torch::Device device_;
    double lower_[3], upper_[3];
    vector<Run> runs_;
    vector<long> frames_, trained_, samples_, order_;
    vector<std::pair<long, long>> corners_;
    vector<Place> train_, held_;
    long smallest_ = std::numeric_limits<long>::max();
};

// ---- codec adhesion: single particles, as many in contact as free ----

class AdhesionData : public TrainingData {
  public:
    AdhesionData(const vector<PairsReader*>& pairs, const Recipe& recipe) : recipe_(recipe) {
        vector<AdhesionSample> train, held;
        for (auto* file : pairs)
            for (int r = 0; r < file->runs(); ++r) {
                const auto samples = file->adhesion(r);
                const auto split =
                    samples.begin() + trained_of(long(samples.size()), recipe.validation, run_name(*file, r));
                train.insert(train.end(), samples.begin(), split);
                held.insert(held.end(), split, samples.end());
            }
        for (size_t s = 0; s < train.size(); ++s) (train[s].contact ? contact_ : free_).push_back(long(s));
        if (contact_.empty() || free_.empty())
            throw Error(pairs.front()->path() + ": found " + std::to_string(contact_.size()) +
                        " samples in contact and " + std::to_string(free_.size()) +
                        " free ones to train on, both kinds are needed");
        train_ = of(train);
        held_ = of(held);
    }

    void describe(ModelCard& card) const override { card.input_channels = adhesion_inputs; }
    void begin_epoch(long epoch) override {
        auto random = generator(recipe_.seed, epoch);
        order_.clear();
        for (long i = 0; i < half(); ++i) {
            order_.push_back(contact_[draw(random, contact_.size())]);
            order_.push_back(free_[draw(random, free_.size())]);
        }
    }
    long steps() const override { return ceil_divide(2 * half(), long(recipe_.batch)); }
    Batch batch(long step) const override {
        vector<long> samples;
        for (long i : share(step, recipe_.batch, order_.size())) samples.push_back(order_[size_t(i)]);
        if (samples.empty()) return {};
        const Tensor chosen = torch::tensor(samples);
        return {train_.input.index_select(0, chosen),
                train_.target.index_select(0, chosen),
                train_.base.index_select(0, chosen),
                {},
                {}};
    }
    // The natural distribution.
    long validation_batches() const override { return ceil_divide(held_.input.size(0), rows_a_batch); }
    Batch validation_batch(long i) const override {
        const long first = i * rows_a_batch, count = std::min(rows_a_batch, held_.input.size(0) - first);
        return {held_.input.narrow(0, first, count),
                held_.target.narrow(0, first, count),
                held_.base.narrow(0, first, count),
                held_.mask.narrow(0, first, count),
                {}};
    }
    double unit() const override { return 1; }

  private:
    static constexpr long rows_a_batch = 1 << 16;
    // Of particle i.
    static constexpr long force_before = AdhesionChannels::first(0) + AdhesionChannels::force;

    long half() const {
        return std::min(long(recipe_.epoch_samples) / 2, long(contact_.size() + free_.size()));
    }

    static Batch of(const vector<AdhesionSample>& samples) {
        const long n = long(samples.size());
        Tensor input = torch::empty({n, adhesion_inputs}), target = torch::empty({n, 1}),
               contact = torch::empty({n, 1});
        for (long s = 0; s < n; ++s) {
            std::copy_n(samples[size_t(s)].input.data(), adhesion_inputs,
                        input.data_ptr<float>() + s * adhesion_inputs);
            target.data_ptr<float>()[s] = samples[size_t(s)].target;
            contact.data_ptr<float>()[s] = samples[size_t(s)].contact;
        }
        return {image(input), image(target), image(input.narrow(1, force_before, 1)), image(contact), {}};
    }

    Recipe recipe_;
    Batch train_, held_;
    vector<long> contact_, free_, order_;
};

std::unique_ptr<TrainingData> open_codec(const vector<PairsReader*>& pairs, size_t trained,
                                         const Recipe& recipe, torch::Device device) {
    switch (pairs.front()->codec()) {
        case Codec::strand:
            return std::make_unique<StrandData>(pairs, trained, recipe, device);
        case Codec::root:
            return std::make_unique<RootData>(pairs, trained, recipe, device);
        default:
            if (trained != pairs.size())
                throw Misuse("train adhesion: takes no --validation; the last samples are held out");
            return std::make_unique<AdhesionData>(pairs, recipe);
    }
}

}  // namespace

vector<long> TrainingData::share(long step, double batch, size_t count) const {
    const long first = step * long(batch), end = std::min(first + long(batch), long(count));
    vector<long> places;
    for (long i = first + ranks.mine; i < end; i += ranks.of) places.push_back(i);
    return places;
}

Batch Batch::to(torch::Device device) const {
    auto moved = [&](const Tensor& t) { return t.defined() ? t.to(device) : t; };
    return {moved(input),  moved(target),          moved(base), moved(mask), moved(pixels),
            moved(length), moved(relative_length), in_pairs};
}

std::unique_ptr<TrainingData> open_data(const vector<PairsReader*>& pairs, size_t trained,
                                        const Recipe& recipe, torch::Device device, const Ranks& ranks) {
    const PairsReader& first = *pairs.front();
    for (auto* file : pairs)
        if (file->codec() != first.codec())
            throw Error(file->path() + ": found codec " + name_of(file->codec()) + ", needed what " +
                        first.path() + " has: " + name_of(first.codec()));
    for (auto* file : pairs)
        if (file->low() != first.low())
            throw Error(file->path() + ": its low-resolution runs are " + file->low() + ", needed what " +
                        first.path() + " has: " + first.low());
    auto data = open_codec(pairs, trained, recipe, device);
    data->ranks = ranks;
    return data;
}

}  // namespace wetcurl

// Learned wet strands on the CPU.
#include "learn/codec/learned_strands.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/thread_room.h"
#include "learn/codec/crop.h"
#include "learn/codec/lane_network.h"
#include "learn/codec/lock_grid.h"
#include "learn/codec/outside_lanes.h"

namespace wetcurl {

void require_fit(const ModelCard& card, const StrandCodec& codec) {
    const std::string network = "network " + card.architecture + ": ";
    if (card.codec != "strand")
        throw Error(network + "found one of codec " + card.codec + ", allowed is codec strand");
    if (card.input_channels != strand_channels || card.output_channels != strand_outputs)
        throw Error(network + "found " + std::to_string(card.input_channels) + " inputs and " +
                    std::to_string(card.output_channels) + " outputs, allowed " +
                    std::to_string(strand_channels) + " and " + std::to_string(strand_outputs) +
                    " (made by another wetcurl? encode and train again)");
    // Amplitudes do not know how many particles they come of, as long as these carry them all.
    if (codec.particles() < dct_kept)
        throw Error(network + "predicts " + std::to_string(dct_kept) + " amplitudes an axis, the hair has " +
                    std::to_string(codec.particles()) + " particles a strand; allowed " +
                    std::to_string(dct_kept) + " or more");
}

std::vector<float> in_metres(std::vector<float> answered, const std::vector<int>& pixel_of,
                             const std::vector<float>& length) {
    constexpr float largest = 20;  // of what a damaged network answers, so that it stays a number
    for (size_t k = 0; k < answered.size(); ++k)
        answered[k] = usual_error * std::exp(std::clamp(answered[k], -largest, largest)) *
                      length[size_t(pixel_of[k / error_pieces])];
    return answered;
}

void require_finite(const Vec3f* low, size_t count, int particles) {
    bool finite = true;
#pragma omp simd reduction(&& : finite)
    for (size_t k = 0; k < count; ++k) finite = finite && std::isfinite(low[k].x + low[k].y + low[k].z);
    for (size_t k = 0; k < count && !finite; ++k)
        if (!std::isfinite(low[k].x + low[k].y + low[k].z))
            throw Error("learned strands: found low-resolution strand " + std::to_string(k / particles) +
                        ", particle " + std::to_string(k % particles) +
                        " at no finite position, allowed are finite ones");
}

int length_rounds_of(const ModelCard& card) { return card.target == "displayed" ? 1 : most_length_rounds; }

void require_rounds(int rounds) {
    if (rounds < 0 || rounds > most_length_rounds)
        throw Error("learned strands: found " + std::to_string(rounds) +
                    " rounds that lead edges, allowed are 0 to " + std::to_string(most_length_rounds));
}

namespace {

class StrandsOnCpu final : public LearnedStrands {
  public:
    StrandsOnCpu(std::unique_ptr<Network> network, StrandCodec codec, Body body)
        : network_(std::move(network)),
          codec_(std::move(codec)),
          rounds_(length_rounds_of(network_->card())) {
        require_fit(network_->card(), codec_);
        errors_.resize(size_t(lanes().blocks()) * error_pieces);
        answers_.resize(size_t(codec_.averaged()) * lanes().blocks() * strand_coefficients);
        if (const auto layers = network_->strand_layers()) {
            if (layers->inputs != strand_channels || layers->outputs != strand_outputs)
                throw Error("network " + card().architecture + ": found layers of " +
                            std::to_string(layers->inputs) + " inputs and " +
                            std::to_string(layers->outputs) + " outputs, allowed " +
                            std::to_string(strand_channels) + " and " + std::to_string(strand_outputs));
            std::vector<S> fixed(size_t(lanes().blocks()) * static_channels);
            for (int block = 0; block < lanes().blocks(); ++block)
                codec_.read_image(block, static_channels, codec_.fixed().data(),
                                  &fixed[size_t(block) * static_channels]);
            in_lanes_.emplace(*layers, codec_.grid(), lanes(), static_channels, fixed,
                              body == Body::single_precision);
        } else {
            input_.resize(size_t(strand_channels) * codec_.pixels());
            answer_.resize(size_t(strand_outputs) * codec_.pixels());
            std::copy(codec_.fixed().begin(), codec_.fixed().end(), input_.begin());
        }
    }
    const ModelCard& card() const override { return network_->card(); }
    void keep_outside(const HeadShapes& head) override {
        outside_.emplace(head, lanes(), codec_.particles(), codec_.edges());
    }
    void lead_edges(int rounds) override { require_rounds(rounds), rounds_ = rounds; }
    void draw_together(const LockTerms& terms, const std::vector<float>& saturation) override {
        locks_.emplace(terms, lanes(), codec_.particles(), codec_.edges(), saturation);
    }
    void crop(const std::vector<uint8_t>& wanted) override {
        crop_ = crop_to(codec_.grid(), wanted, network_->reach(), card().architecture);
        if (in_lanes_) return in_lanes_->crop(*crop_);
        const size_t seen = size_t(crop_->seen.height) * crop_->seen.width;
        seen_.resize(strand_channels * seen), answer_of_seen_.resize(strand_outputs * seen);
        std::fill(answer_.begin(), answer_.end(), 0.f);
    }
    void bind(const Vec3f* low, Vec3f* out, bool on_device) override {
        if (on_device)
            throw Error("learned strands: found memory of a CUDA device, this one runs on the CPU");
        from_ = low, to_ = out;
    }
    void run(const HeadWindow& heads) override {
        require_finite(from_, size_t(codec_.low_strands()) * codec_.particles(), codec_.particles());
        codec_.begin(heads);
        if (locks_) locks_->begin(codec_.now().first);
        room_.require(size_t(codec_.particles()));
        if (in_lanes_)
            run_in_lanes(heads.now);
        else
            run_whole_images(heads.now);
    }
    DeviceStream begin(const HeadWindow&) override {
        throw Error("learned strands: found a frame begun on the CPU, allowed is that on a CUDA device");
    }
    void restart() override { codec_.restart(); }
    int memory() const override { return codec_.memory() + (locks_ ? codec_.averaged() - 1 : 0); }
    Strands base(const Pose& head) override { return codec_.base(head, rounds_); }
    std::vector<float> expected_errors() override {
        std::vector<float> out(size_t(codec_.roots().count()) * error_pieces);
        for (int block = 0; block < lanes().blocks(); ++block)
            lanes().store(block, error_pieces, &errors_[size_t(block) * error_pieces], out.data());
        return in_metres(std::move(out), codec_.pixel_of(), codec_.length());
    }

    std::vector<float> inputs() override {
        const size_t strands = size_t(codec_.roots().count());
        std::vector<float> moving(strands * dynamic_channels), out;
#pragma omp parallel for schedule(static)
        for (int block = 0; block < lanes().blocks(); ++block) {
            S features[dynamic_channels];
            codec_.describe(block, features);
            lanes().store(block, dynamic_channels, features, moving.data());
        }
        out.reserve(strands * strand_channels);
        for (size_t s = 0; s < strands; ++s) {
            for (int c = 0; c < static_channels; ++c)
                out.push_back(codec_.fixed()[size_t(c) * codec_.pixels() + size_t(codec_.pixel_of()[s])]);
            const auto from = moving.begin() + long(s * dynamic_channels);
            out.insert(out.end(), from, from + dynamic_channels);
        }
        return out;
    }

  private:
    using S = StrandCodec::S;
    const RootLanes& lanes() const { return codec_.lanes(); }

    void run_in_lanes(const Pose& head) {
        constexpr int together = LaneNetwork::together;
        const auto& groups = in_lanes_->groups();
        in_lanes_->prepare();
#pragma omp parallel
        {
            codec_.follow(from_);
#pragma omp for schedule(static)
            for (size_t g = 0; g < groups.size(); ++g) {
                S features[together * dynamic_channels];
                for (int b = 0; b < groups[g].count; ++b)
                    codec_.describe(groups[g].first + b, features + b * dynamic_channels);
                in_lanes_->begin(groups[g], features);
            }
            in_lanes_->run();
#pragma omp for schedule(static)
            for (size_t g = 0; g < groups.size(); ++g) {
                S answer[together * strand_outputs];
                in_lanes_->end(groups[g], answer);
                for (int b = 0; b < groups[g].count; ++b)
                    place(groups[g].first + b, answer + b * strand_outputs, head);
            }
            if (locks_) show_locks(head);
        }
    }
    void run_whole_images(const Pose& head) {
#pragma omp parallel
        {
            codec_.follow(from_);
#pragma omp for schedule(static)
            for (int block = 0; block < lanes().blocks(); ++block) {
                S features[dynamic_channels];
                codec_.describe(block, features);
                codec_.write_image(block, dynamic_channels, features, input_.data() + codec_.fixed().size());
            }
        }
        ask();
#pragma omp parallel
        {
#pragma omp for schedule(static)
            for (int block = 0; block < lanes().blocks(); ++block) {
                S answer[strand_outputs];
                codec_.read_image(block, strand_outputs, answer_.data(), answer);
                place(block, answer, head);
            }
            if (locks_) show_locks(head);
        }
    }
    void place(int block, const S* answer, const Pose& head) {
        Vec3<S>* const x = locks_ ? locks_->strands(block) : room_.mine();
        S mean[strand_coefficients];
        average(block, answer + answered_amplitudes.first, mean);
        codec_.place(block, mean, rounds_, head, x);
        std::copy_n(answer + answered_errors.first, error_pieces, &errors_[size_t(block) * error_pieces]);
        if (locks_)
            locks_->take(block, head);
        else
            finish(block, head, x);
    }
    // The mean of an answer and those of the frames before.
    void average(int block, const S* answer, S* mean) {
        const int frames = codec_.averaged(), slot = codec_.now().slot % frames;
        const size_t all = size_t(lanes().blocks()) * strand_coefficients;
        S* const kept = &answers_[size_t(block) * strand_coefficients];
        for (int k = 0; k < frames; ++k)
            if (k == slot || codec_.now().first) std::copy_n(answer, strand_coefficients, kept + k * all);
        for (int c = 0; c < strand_coefficients; ++c) {
            S sum = answer[c];  // the oldest last, wherever in the ring it lies
            for (int back = 1; back < frames; ++back)
                sum += kept[size_t((slot + frames - back) % frames) * all + size_t(c)];
            mean[c] = S(1 / float(frames)) * sum;
        }
    }
    // Called by all threads of a team, when all strands are placed.
    void show_locks(const Pose& head) {
        locks_->draw();
#pragma omp for schedule(static)
        for (int block = 0; block < lanes().blocks(); ++block) {
            locks_->show(block, head);
            finish(block, head, locks_->strands(block));
        }
    }
    void finish(int block, const Pose& head, Vec3<S>* x) {
        if (outside_) outside_->push(block, head, x);
        lanes().store(block, 3 * codec_.particles(), &x->x, &to_->x);
    }
    void ask() {
        if (!crop_)
            return network_->run(input_.data(), {1, strand_channels, codec_.height(), codec_.width()},
                                 answer_.data());
        const GridBox answered = crop_->answered, seen = crop_->seen;
        // f(place in images of `seen`, place in those of the grid), row by row of a box within `seen`.
        auto for_each_row = [&](const GridBox& box, int channels, auto f) {
            for (size_t c = 0; c < size_t(channels); ++c)
                for (int r = box.row; r < box.row + box.height; ++r)
                    f((c * seen.height + (r - seen.row)) * seen.width + (box.column - seen.column),
                      (c * codec_.height() + r) * codec_.width() + box.column);
        };
        for_each_row(seen, strand_channels, [&](size_t in_seen, size_t in_grid) {
            std::copy_n(&input_[in_grid], seen.width, &seen_[in_seen]);
        });
        network_->run(seen_.data(), {1, strand_channels, seen.height, seen.width}, answer_of_seen_.data());
        for_each_row(answered, strand_outputs, [&](size_t in_seen, size_t in_grid) {
            std::copy_n(&answer_of_seen_[in_seen], answered.width, &answer_[in_grid]);
        });
    }

    std::unique_ptr<Network> network_;
    StrandCodec codec_;
    int rounds_;  // that lead edges
    std::optional<OutsideLanes> outside_;
    std::optional<LockGrid> locks_;
    std::optional<Crop> crop_;
    // A residual network for strands runs here; any other by itself, on whole images.
    std::optional<LaneNetwork> in_lanes_;
    std::vector<float> input_, answer_, seen_, answer_of_seen_;
    std::vector<S> errors_;   // (block, error_pieces), as answered
    std::vector<S> answers_;  // (codec_.averaged(), round robin; block, strand_coefficients)
    ThreadRoom<Vec3<S>> room_;
    const Vec3f* from_ = nullptr;
    Vec3f* to_ = nullptr;
};

}  // namespace

std::unique_ptr<LearnedStrands> learned_strands(std::unique_ptr<Network> network, StrandCodec codec,
                                                Body body) {
    return std::make_unique<StrandsOnCpu>(std::move(network), std::move(codec), body);
}

}  // namespace wetcurl

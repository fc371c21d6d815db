// Learned wet strands on the CPU.
#include "learn/codec/learned_strands.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "learn/codec/crop.h"

namespace wetcurl {

void require_fit(const ModelCard& card, const StrandCodec& codec) {
    const std::string network = "network " + card.architecture + ": ";
    if (card.codec != "strand")
        throw Error(network + "found one of codec " + card.codec + ", allowed is codec strand");
    if (card.input_channels != strand_channels)
        throw Error(network + "found " + std::to_string(card.input_channels) + " inputs, allowed " +
                    std::to_string(strand_channels) + " (made by another wetcurl? encode and train again)");
    // Amplitudes do not know how many particles they come of, as long as these carry them all.
    if (codec.particles() < dct_kept)
        throw Error(network + "predicts " + std::to_string(dct_kept) + " amplitudes an axis, the hair has " +
                    std::to_string(codec.particles()) + " particles a strand; allowed " +
                    std::to_string(dct_kept) + " or more");
}

void require_finite(const Vec3f* low, size_t count, int particles) {
    for (size_t k = 0; k < count; ++k)
        if (!std::isfinite(low[k].x + low[k].y + low[k].z))
            throw Error("learned strands: found low-resolution strand " + std::to_string(k / particles) +
                        ", particle " + std::to_string(k % particles) +
                        " at no finite position, allowed are finite ones");
}

void require_each(const HeadShapes& head, size_t particles) {
    if (head.depth.size() != particles)
        throw Error(
            "learned strands: found " + std::to_string(head.depth.size()) +
            " depths in what is attached to the head, allowed one a particle: " + std::to_string(particles));
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
    StrandsOnCpu(std::unique_ptr<Network> network, StrandCodec codec)
        : network_(std::move(network)),
          codec_(std::move(codec)),
          rounds_(length_rounds_of(network_->card())),
          input_(size_t(strand_channels) * codec_.pixels()),
          answer_(size_t(strand_coefficients) * codec_.pixels()) {
        require_fit(network_->card(), codec_);
        std::copy(codec_.fixed().begin(), codec_.fixed().end(), input_.begin());
        low_ = Strands(codec_.low_strands(), codec_.particles());
    }
    const ModelCard& card() const override { return network_->card(); }
    void keep_outside(const HeadShapes& head) override {
        require_each(head, size_t(codec_.roots().count()) * codec_.particles());
        head_ = head;
        views_.clear();
        for (const Shape& shape : head_.shapes) views_.push_back(view_of(shape));
    }
    void lead_edges(int rounds) override { require_rounds(rounds), rounds_ = rounds; }
    void crop(const std::vector<uint8_t>& wanted) override {
        crop_ = crop_to(codec_.grid(), wanted, network_->reach(), card().architecture);
        const size_t seen = size_t(crop_->seen.height) * crop_->seen.width;
        seen_.resize(strand_channels * seen), answer_of_seen_.resize(strand_coefficients * seen);
        std::fill(answer_.begin(), answer_.end(), 0.f);
    }
    void bind(const Vec3f* low, Vec3f* out, bool on_device) override {
        if (on_device)
            throw Error("learned strands: found memory of a CUDA device, this one runs on the CPU");
        from_ = low, to_ = out;
    }
    void run(const HeadWindow& heads) override {
        require_finite(from_, low_.points.size(), low_.particles);
        std::copy_n(from_, low_.points.size(), low_.points.begin());
        codec_.dynamic(low_, heads, input_.data() + codec_.fixed().size());
        ask();
        codec_.decode(answer_.data(), heads.now, to_);
        codec_.lead_edges(rounds_, to_);
        if (!head_.shapes.empty()) push_out(heads.now);
    }
    DeviceStream begin(const HeadWindow&) override {
        throw Error("learned strands: found a frame begun on the CPU, allowed is that on a CUDA device");
    }
    void restart() override { codec_.restart(); }
    Strands base(const Pose& head) override {
        Strands out = codec_.base(head);
        codec_.lead_edges(rounds_, out.points.data());
        return out;
    }

  private:
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
        for_each_row(answered, strand_coefficients, [&](size_t in_seen, size_t in_grid) {
            std::copy_n(&answer_of_seen_[in_seen], answered.width, &answer_[in_grid]);
        });
    }
    void push_out(const Pose& head) {
        const Quatf turn = cast<float>(head.rotation), back = conjugate(turn);
        const Vec3f place = cast<float>(head.translation);
        auto out_of_shapes = [&](size_t k) {
            return [&, depth = head_.depth[k]](const Vec3f& world) {
                const Vec3f from = rotate(back, world - place);
                Vec3f x = from;
                for (const ShapeView& shape : views_) x = pushed_out(shape, x, depth);
                return norm(x - from) > 0 ? place + rotate(turn, x) : world;
            };
        };
        const int n = codec_.particles();
#pragma omp parallel for schedule(static)
        for (int s = 0; s < codec_.roots().count(); ++s) {
            const size_t root = size_t(s) * size_t(n);
            for (size_t k = root + 1; k < root + size_t(n); ++k) to_[k] = out_of_shapes(k)(to_[k]);
            for (size_t k = root + 1; k < root + size_t(n); ++k)
                to_[k] = led_around(to_[k - 1], to_[k], torn_lengths * codec_.edges()[k], out_of_shapes(k));
        }
    }

    std::unique_ptr<Network> network_;
    StrandCodec codec_;
    int rounds_;  // that lead edges
    HeadShapes head_;
    std::vector<ShapeView> views_;  // of its shapes
    std::vector<float> input_, answer_;
    std::optional<Crop> crop_;
    std::vector<float> seen_, answer_of_seen_;
    Strands low_;
    const Vec3f* from_ = nullptr;
    Vec3f* to_ = nullptr;
};

}  // namespace

std::unique_ptr<LearnedStrands> learned_strands(std::unique_ptr<Network> network, StrandCodec codec) {
    return std::make_unique<StrandsOnCpu>(std::move(network), std::move(codec));
}

}  // namespace wetcurl

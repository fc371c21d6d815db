// Learned wet strands on the CPU.
// Ours.
#include "learn/learned_strands.h"

#include <algorithm>

#include "base/error.h"

namespace wetcurl {

void require_inputs_of_codec(const ModelCard& card) {
    constexpr int inputs = static_channels + dynamic_channels;
    if (card.codec == "strand" && card.input_channels == inputs) return;
    throw Error("network " + card.architecture + ": found " + std::to_string(card.input_channels) +
                " inputs of codec " + card.codec + ", allowed " + std::to_string(inputs) +
                " of codec strand (trained by another wetcurl? train it again)");
}

void require_depths(const HeadShapes& head, size_t particles) {
    if (head.depth.size() != particles)
        throw Error(
            "learned strands: found " + std::to_string(head.depth.size()) +
            " depths in what is attached to the head, allowed one a particle: " + std::to_string(particles));
}

namespace {

class OnHost final : public LearnedStrands {
  public:
    OnHost(std::unique_ptr<Network> network, StrandCodec codec)
        : network_(std::move(network)),
          codec_(std::move(codec)),
          input_(size_t(static_channels + dynamic_channels) * codec_.pixels()),
          answer_(size_t(strand_coefficients) * codec_.pixels()) {
        require_inputs_of_codec(network_->card());
        std::copy(codec_.fixed().begin(), codec_.fixed().end(), input_.begin());
        low_ = Strands(codec_.low_strands(), codec_.particles());
    }
    const ModelCard& card() const override { return network_->card(); }
    void keep_outside(const HeadShapes& head) override {
        require_depths(head, size_t(codec_.roots().count()) * codec_.particles());
        head_ = head;
    }
    void bind(const Vec3f* low, Vec3f* out, bool on_device) override {
        if (on_device)
            throw Error("learned strands: found memory of a CUDA device, this one runs on the CPU");
        from_ = low, to_ = out;
    }
    void run(const HeadWindow& heads) override {
        std::copy_n(from_, low_.points.size(), low_.points.begin());
        codec_.dynamic(low_, heads, input_.data() + codec_.fixed().size());
        network_->run(input_.data(), {1, static_channels + dynamic_channels, codec_.height(), codec_.width()},
                      answer_.data());
        codec_.decode(answer_.data(), heads.now, to_);
        for (const Shape& shape : head_.shapes) push_out_of(view_of(shape), heads.now);
    }
    void restart() override { codec_.restart(); }
    Strands base(const Pose& head) override { return codec_.base(head); }

  private:
    void push_out_of(const ShapeView& shape, const Pose& head) {
        const Quatf turn = cast<float>(head.rotation), back = conjugate(turn);
        const Vec3f place = cast<float>(head.translation);
        const size_t n = size_t(codec_.particles());
#pragma omp parallel for schedule(static)
        for (size_t k = 0; k < head_.depth.size(); ++k) {
            if (k % n == 0) continue;
            const Vec3f x = rotate(back, to_[k] - place), out = pushed_out(shape, x, head_.depth[k]);
            if (norm(out - x) > 0) to_[k] = place + rotate(turn, out);
        }
    }

    std::unique_ptr<Network> network_;
    StrandCodec codec_;
    HeadShapes head_;
    std::vector<float> input_, answer_;
    Strands low_;
    const Vec3f* from_ = nullptr;
    Vec3f* to_ = nullptr;
};

}  // namespace

std::unique_ptr<LearnedStrands> learned_strands(std::unique_ptr<Network> network, StrandCodec codec) {
    return std::make_unique<OnHost>(std::move(network), std::move(codec));
}

}  // namespace wetcurl

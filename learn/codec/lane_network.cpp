// Layers in lanes.
#include "learn/codec/lane_network.h"

#include <algorithm>
#include <string>

#include "base/error.h"

namespace wetcurl {

namespace {

using S = LaneNetwork::S;

// Outputs at once, so that their sums, for `together` blocks, and what they are made of fit the registers.
constexpr int tile = register_bytes == 64 ? 8 : 4;
constexpr int beyond = StrandLayers::kernel / 2;

// weight (outputs, inputs), of the inputs from `begin` to `end`, times a factor of each, to panels.
template <class Factor>
std::vector<float> panels_of(const std::vector<float>& weight, int outputs, int inputs, int begin, int end,
                             Factor factor) {
    std::vector<float> out;
    for (int first = 0; first < outputs; first += tile)
        for (int j = begin; j < end; ++j)
            for (int o = first; o < first + tile; ++o)
                out.push_back(float(double(weight[size_t(o) * inputs + j]) * factor(o, j)));
    return out;
}

// end(output, block, sum) of start(output, block) + sum over j of panels * in (block, inputs).
template <int count, class Start, class End>
[[gnu::always_inline]] inline void multiply(const std::vector<float>& panels, int outputs, int inputs,
                                            const S* in, Start start, End end) {
    const float* weight = panels.data();
    for (int first = 0; first < outputs; first += tile) {
        S sum[tile][count];
#pragma GCC unroll 8
        for (int o = 0; o < tile; ++o)
#pragma GCC unroll 2
            for (int b = 0; b < count; ++b) sum[o][b] = start(first + o, b);
        for (int j = 0; j < inputs; ++j, weight += tile) {
            S x[count];
            for (int b = 0; b < count; ++b) x[b] = in[b * inputs + j];
#pragma GCC unroll 8
            for (int o = 0; o < tile; ++o)
#pragma GCC unroll 2
                for (int b = 0; b < count; ++b) sum[o][b] += S(weight[o]) * x[b];
        }
#pragma GCC unroll 8
        for (int o = 0; o < tile; ++o)
#pragma GCC unroll 2
            for (int b = 0; b < count; ++b) end(first + o, b, sum[o][b]);
    }
}

}  // namespace

#ifdef __AVX512VNNI__
const bool LaneNetwork::has_bytes = true;

namespace {

constexpr int of_integer = 4;  // bytes
typedef int32_t Integers __attribute__((vector_size(register_bytes)));

// Four channels a number: x (channels) of a pixel a lane, rounded to 255 steps between 0 and the largest, or
// between that either way from 128 on. Returns the size of a step.
template <bool positive>
S to_bytes(int channels, const S* x, Integers* out) {
    S most(tiny_length<float>);
    for (int c = 0; c < channels; ++c) most = maximum(most, positive ? x[c] : maximum(x[c], -x[c]));
    constexpr float steps = positive ? 255 : 127;
    const S per_step = S(steps) / most;
    for (int c = 0; c < channels; c += of_integer) {
        Integers all = {};
        for (int k = 0; k < of_integer; ++k) {
            // All lanes are asked for by a mask: GCC 12 warns of its own header without.
            const Integers number =
                Integers(_mm512_maskz_cvtps_epi32(0xffff, __m512((x[c + k] * per_step).v)));
            all |= (number & 255) << 8 * k;
        }
        out[c / of_integer] = positive ? all : all ^ int32_t(0x80808080);  // adds 128 to each
    }
    return most * S(1 / steps);
}

}  // namespace

LaneNetwork::Bytes LaneNetwork::bytes_of(const std::vector<float>& weight, int outputs, int inputs) {
    Bytes out;
    std::vector<int> byte(weight.size());
    for (int o = 0; o < outputs; ++o) {
        const float* row = &weight[size_t(o) * inputs];
        float most = 0;
        for (int j = 0; j < inputs; ++j) most = std::max(most, std::abs(row[j]));
        out.scale.push_back(most / 127), out.sum.push_back(0);
        for (int j = 0; j < inputs; ++j) {
            byte[size_t(o) * inputs + j] = most > 0 ? int(std::lround(127 * row[j] / most)) : 0;
            out.sum.back() += byte[size_t(o) * inputs + j];
        }
    }
    for (int first = 0; first < outputs; first += tile)
        for (int j = 0; j < inputs; j += of_integer)
            for (int o = first; o < first + tile; ++o) {
                uint32_t four = 0;
                for (int k = 0; k < of_integer; ++k)
                    four |= uint32_t(byte[size_t(o) * inputs + j + k] & 255) << 8 * k;
                out.panels.push_back(int32_t(four));
            }
    return out;
}

template <int count, class End>
void LaneNetwork::multiply_dense(const Dense& layer, bool positive, const S* in, S* room, End end) const {
    if (!in_bytes_)
        return multiply<count>(
            layer.panels, channels_, channels_, in, [&](int c, int) { return S(layer.bias[size_t(c)]); },
            end);
    const int integers = channels_ / of_integer;
    Integers* const bytes = reinterpret_cast<Integers*>(room);
    S step[count];
    for (int b = 0; b < count; ++b)
        step[b] = positive ? to_bytes<true>(channels_, in + b * channels_, bytes + b * integers)
                           : to_bytes<false>(channels_, in + b * channels_, bytes + b * integers);
    const int32_t* weight = layer.bytes.panels.data();
    for (int first = 0; first < channels_; first += tile) {
        __m512i sum[tile][count];
#pragma GCC unroll 8
        for (int o = 0; o < tile; ++o)
#pragma GCC unroll 2
            for (int b = 0; b < count; ++b)
                sum[o][b] = __m512i(Integers{} + (positive ? 0 : -128 * layer.bytes.sum[size_t(first + o)]));
        for (int j = 0; j < integers; ++j, weight += tile) {
            __m512i x[count];
            for (int b = 0; b < count; ++b) x[b] = __m512i(bytes[b * integers + j]);
#pragma GCC unroll 8
            for (int o = 0; o < tile; ++o)
#pragma GCC unroll 2
                for (int b = 0; b < count; ++b)
                    sum[o][b] = _mm512_dpbusd_epi32(sum[o][b], x[b], __m512i(Integers{} + weight[o]));
        }
#pragma GCC unroll 8
        for (int o = 0; o < tile; ++o)
#pragma GCC unroll 2
            for (int b = 0; b < count; ++b) {
                const size_t c = size_t(first + o);
                const S whole(__builtin_convertvector(Integers(sum[o][b]), S::Register));
                end(int(c), b, S(layer.bias[c]) + S(layer.bytes.scale[c]) * step[b] * whole);
            }
    }
}
#else
const bool LaneNetwork::has_bytes = false;

LaneNetwork::Bytes LaneNetwork::bytes_of(const std::vector<float>&, int, int) { return {}; }

template <int count, class End>
void LaneNetwork::multiply_dense(const Dense& layer, bool, const S* in, S*, End end) const {
    multiply<count>(
        layer.panels, channels_, channels_, in, [&](int c, int) { return S(layer.bias[size_t(c)]); }, end);
}
#endif

LaneNetwork::Dense LaneNetwork::dense_of(const StrandLayers::Dense& layer) const {
    if (in_bytes_) return {{}, bytes_of(layer.weight, channels_, channels_), layer.bias};
    return {panels_of(layer.weight, channels_, channels_, 0, channels_, [](int, int) { return 1.0; }),
            {},
            layer.bias};
}

LaneNetwork::LaneNetwork(const StrandLayers& layers, const RootGrid& grid, const StrandLanes& lanes,
                         int fixed_inputs, const std::vector<S>& fixed, bool single)
    : in_bytes_(has_bytes && !single),
      channels_(layers.channels),
      outputs_(layers.outputs),
      inputs_(layers.inputs - fixed_inputs),
      height_(grid.height),
      row_blocks_((grid.width + S::lanes - 1) / S::lanes),
      stride_(size_t(row_blocks_ + 1) * S::lanes) {
    if (channels_ % tile != 0 || outputs_ % tile != 0 || inputs_ < 0)
        throw Error("network in lanes: found " + std::to_string(channels_) + " channels, " +
                    std::to_string(outputs_) + " outputs and " + std::to_string(layers.inputs) +
                    " inputs, allowed are channels and outputs in multiples of " + std::to_string(tile) +
                    " and " + std::to_string(fixed_inputs) + " inputs or more");
    const auto share = [&](int, int j) { return 1 / double(layers.deviation[size_t(j)]); };
    first_ = panels_of(layers.first.weight, channels_, layers.inputs, fixed_inputs, layers.inputs, share);
    last_ = panels_of(layers.last.weight, outputs_, channels_, 0, channels_,
                      [&](int o, int) { return double(layers.scale[size_t(o)]); });
    for (int o = 0; o < outputs_; ++o)
        last_bias_.push_back(layers.last.bias[size_t(o)] * layers.scale[size_t(o)]);
    for (const StrandLayers::Block& block : layers.blocks)
        blocks_.push_back({block.around, dense_of(block.in), dense_of(block.out)});

    std::vector<float> bias(static_cast<size_t>(channels_));
    for (int c = 0; c < channels_; ++c) {
        double sum = layers.first.bias[size_t(c)];
        for (int j = 0; j < layers.inputs; ++j)
            sum -= double(layers.first.weight[size_t(c) * layers.inputs + j]) * share(c, j) *
                   double(layers.mean[size_t(j)]);
        bias[size_t(c)] = float(sum);
    }
    start_.resize(size_t(lanes.blocks()) * channels_);
    const Panels still = panels_of(layers.first.weight, channels_, layers.inputs, 0, fixed_inputs, share);
#pragma omp parallel for schedule(static)
    for (int block = 0; block < lanes.blocks(); ++block)
        multiply<1>(
            still, channels_, fixed_inputs, &fixed[size_t(block) * fixed_inputs],
            [&](int c, int) { return S(bias[size_t(c)]); },
            [&](int c, int, const S& sum) { start_[size_t(block) * channels_ + c] = sum; });

    for (int block = 0; block < lanes.blocks(); ++block) strands_.push_back(lanes.holds(block));
    // Zeros before the first row's first pixel, too.
    for (auto& x : x_) x.assign(S::lanes + size_t(height_ + 2 * beyond) * channels_ * stride_, 0);
    crop({{0, 0, height_, grid.width}, {0, 0, height_, grid.width}});
}

void LaneNetwork::crop(const Crop& crop) {
    const auto within = [&](const GridBox& box, int row, int column) {
        return row >= box.row && row < box.row + box.height && column >= box.column &&
               column < box.column + box.width;
    };
    groups_.clear();
    seen_ = answered_ = strands_;
    for (int row = 0; row < height_; ++row)
        for (int first = 0; first < row_blocks_; first += together) {
            Group group{row * row_blocks_ + first, std::min(together, row_blocks_ - first), false};
            for (int block = group.first; block < group.first + group.count; ++block)
                for (int lane = 0; lane < S::lanes; ++lane) {
                    const int column = (block - row * row_blocks_) * S::lanes + lane;
                    if (!within(crop.answered, row, column)) answered_[size_t(block)].set(lane, 0);
                    if (!within(crop.seen, row, column)) seen_[size_t(block)].set(lane, 0);
                    group.seen = group.seen || seen_[size_t(block)][lane] > 0;
                }
            groups_.push_back(group);
        }
    for (auto& x : x_) std::fill(x.begin(), x.end(), 0.f);
}

size_t LaneNetwork::at(int block, int channel) const {
    const size_t row = size_t(block / row_blocks_ + beyond), column = size_t(block % row_blocks_);
    return S::lanes + (row * size_t(channels_) + size_t(channel)) * stride_ + column * S::lanes;
}

template <int count>
void LaneNetwork::begin_group(int block, const S* input) {
    const S* start = &start_[size_t(block) * channels_];
    float* const x = x_[0].data();
    multiply<count>(
        first_, channels_, inputs_, input, [&](int c, int b) { return start[b * channels_ + c]; },
        [&](int c, int b, const S& sum) {
            (seen_[size_t(block + b)] * sum).store(x + at(block, c) + b * S::lanes);
        });
}

template <int count>
void LaneNetwork::run_group(int block, const Block& layer, const float* from, float* to) {
    S *const seen = room_.mine(), *const hidden = seen + count * channels_,
             *const room = hidden + count * channels_;
    const size_t row = size_t(channels_) * stride_, here = at(block, 0);
    const float* weight = layer.around.data();
    const bool looks = !layer.around.empty();
    for (int c = 0; c < channels_; ++c) {
        const float* const x = from + here + size_t(c) * stride_;
        S sum[count];
        for (int b = 0; b < count; ++b) sum[b] = S::load(x + b * S::lanes);
        if (looks)
            for (int r = -beyond; r <= beyond; ++r)
#pragma GCC unroll 5
                for (int k = -beyond; k <= beyond; ++k, ++weight) {
                    const float* const beside = x + r * long(row) + k;
                    for (int b = 0; b < count; ++b) sum[b] += S(*weight) * S::load(beside + b * S::lanes);
                }
        for (int b = 0; b < count; ++b) seen[b * channels_ + c] = sum[b];
    }
    multiply_dense<count>(layer.in, false, seen, room, [&](int c, int b, const S& sum) {
        hidden[b * channels_ + c] = maximum(sum, S(0));
    });
    multiply_dense<count>(layer.out, true, hidden, room, [&](int c, int b, const S& sum) {
        const size_t k = here + size_t(c) * stride_ + size_t(b) * S::lanes;
        (seen_[size_t(block + b)] * (S::load(from + k) + sum)).store(to + k);
    });
}

template <int count>
void LaneNetwork::end_group(int block, S* answer) {
    const float* const x = x_[blocks_.size() % 2].data() + at(block, 0);
    S* const seen = room_.mine();
    for (int c = 0; c < channels_; ++c)
        for (int b = 0; b < count; ++b)
            seen[b * channels_ + c] = maximum(S::load(x + size_t(c) * stride_ + b * S::lanes), S(0));
    multiply<count>(
        last_, outputs_, channels_, seen, [&](int o, int) { return S(last_bias_[size_t(o)]); },
        [&](int o, int b, const S& sum) { answer[b * outputs_ + o] = answered_[size_t(block + b)] * sum; });
}

static_assert(LaneNetwork::together == 2, "a group is whole, or one block");

void LaneNetwork::begin(const Group& group, const S* input) {
    if (!group.seen) return;
    group.count == together ? begin_group<together>(group.first, input) : begin_group<1>(group.first, input);
}

void LaneNetwork::run() {
    for (size_t k = 0; k < blocks_.size(); ++k) {
        const float* const from = x_[k % 2].data();
        float* const to = x_[(k + 1) % 2].data();
#pragma omp for schedule(static)
        for (size_t g = 0; g < groups_.size(); ++g) {
            const Group& group = groups_[g];
            if (!group.seen) continue;
            group.count == together ? run_group<together>(group.first, blocks_[k], from, to)
                                    : run_group<1>(group.first, blocks_[k], from, to);
        }
    }
}

void LaneNetwork::end(const Group& group, S* answer) {
    if (!group.seen) {
        std::fill_n(answer, group.count * outputs_, S(0));
        return;
    }
    group.count == together ? end_group<together>(group.first, answer) : end_group<1>(group.first, answer);
}

}  // namespace wetcurl

// Rest shapes carried by the strands around them.
#include "learn/codec/carried_rest.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "base/pack_tile.h"

namespace wetcurl {

// Edge i of a strand [m].
static Vec3f edge_of(const Strands& strands, int strand, int i) {
    return strands.at(strand, i + 1) - strands.at(strand, i);
}

static float length_of(const Vec3f* strand, int n) {
    return std::max(float(arc_length(strand, n)), tiny_length<float>);
}

// Of the strands around one those that are drawn as it is count most; a hundredth of its length apart is as
// good as not.
void RestCarrier::weigh(const Strands& drawn_cores) {
    constexpr float alike = 0.01f;
    const int n = particles_, width = around_.width;
#pragma omp parallel for schedule(static)
    for (int s = 0; s < drawn_cores.count; ++s) {
        float* weight = around_.weight.data() + size_t(s) * width;
        const int* from = around_.from.data() + size_t(s) * width;
        const Vec3f* core = drawn_cores.strand(s);
        const float least = alike * float(arc_length(core, n));
        float sum = 0;
        for (int k = 0; k < width; ++k) {
            const float apart = square_apart(core, low_rest_cores_.strand(from[k]), n);
            weight[k] /= std::max(least * least + apart, tiny_length<float>);
            sum += weight[k];
        }
        for (int k = 0; k < width; ++k) weight[k] /= sum;
    }
}

// What each low-resolution strand's core has and those beside it have not, and by how much all of it a
// high-resolution strand measures what is lost.
void RestCarrier::find_own(const Groom& low, const Strands& drawn_cores) {
    own_ = Strands(low.rest.count, particles_);
    // By its own length: what is longer is so wherever it hangs.
    auto edge_at_rest = [&](int strand, int i) {
        return per_low_length_[size_t(strand)] * edge_of(low_rest_cores_, strand, i);
    };
    for (int s = 0; s < low.rest.count; ++s) {
        const int* beside = around_.beside[size_t(s)].strand;
        const int count = int(std::count_if(beside, beside + Stencil::widest, [](int b) { return b >= 0; }));
        for (int i = 0; count > 1 && i + 1 < particles_; ++i) {  // one beside it says nothing of a mean
            Vec3f& own = own_.at(s, i) = edge_at_rest(s, i);
            for (int k = 0; k < count; ++k) own -= (1.f / float(count)) * edge_at_rest(beside[k], i);
        }
    }
    constexpr float least_turn = 0.03f;  // of edges from those around [rad]; less says nothing
    const int n = particles_, width = around_.width;
    lost_weight_.resize(around_.weight.size());
#pragma omp parallel for schedule(static)
    for (int s = 0; s < drawn_cores.count; ++s) {
        const int* from = around_.from.data() + size_t(s) * width;
        const float* weight = around_.weight.data() + size_t(s) * width;
        float all = least_turn * least_turn / float(n - 1);
        for (int k = 0; k < width; ++k)
            for (int i = 0; i + 1 < n; ++i) all += weight[k] * dot(own_.at(from[k], i), own_.at(from[k], i));
        for (int k = 0; k < width; ++k) lost_weight_[size_t(s) * width + k] = weight[k] / all;
    }
}

Settled settled_between(const Strands& dry, const Strands& wet) {
    constexpr float whole = 0.05f, none = 0.2f;  // how far apart, of a strand's length
    const int n = wet.particles;
    Settled out{std::vector<float>(size_t(wet.count)), wet};
    for (int s = 0; s < wet.count; ++s) {
        const float far = std::sqrt(square_apart(wet.strand(s), dry.strand(s), n)) /
                          std::max(float(arc_length(wet.strand(s), n)), tiny_length<float>);
        out.share[size_t(s)] = std::clamp((none - far) / (none - whole), 0.f, 1.f);
        for (int i = 0; i < n; ++i) out.more.at(s, i) -= out.share[size_t(s)] * dry.at(s, i);
    }
    return out;
}

// Cores are linear in the strand: that of a strand moved is the sum of both.
void RestCarrier::start_from(const Settled& settled) {
    settled_ = settled;
    const Strands cores = cores_of(settled.more);
    for (size_t k = 0; k < cores.points.size(); ++k) low_rest_cores_.points[k] -= cores.points[k];
}

RestCarrier::RestCarrier(RootLanes lanes, Stencil around, const Groom& high, const Groom& low,
                         const Strands* shape, bool low_is_wet, const Settled* settled)
    : lanes_(std::move(lanes)),
      particles_(high.rest.particles),
      low_is_wet_(low_is_wet || settled),
      around_(std::move(around)),
      low_rest_cores_(cores_of(low.rest)),
      low_lanes_(StrandLanes::in_order(low.rest.count)),
      offsets_(size_t(low_lanes_.blocks()) * particles_),
      cores_(offsets_.size()),
      moved_(low.rest.count, low.rest.particles),
      lost_(size_t(low.rest.count)) {
    auto size = [](const Strands& s) {
        return std::to_string(s.count) + " strands of " + std::to_string(s.particles) + " particles";
    };
    const Strands& curled = shape ? *shape : high.rest;
    if (size(curled) != size(high.rest))
        throw Error("interpolation: found a shape at rest of " + size(curled) + ", allowed that of all " +
                    size(high.rest));
    if (around_.count() != high.rest.count)
        throw Error("interpolation: found a stencil for " + std::to_string(around_.count()) +
                    " strands, allowed one for all " + std::to_string(high.rest.count));
    if (settled && size(settled->more) != size(low.rest))
        throw Error("interpolation: found " + size(settled->more) +
                    " that have settled, allowed all low-resolution " + size(low.rest));
    const Strands drawn_cores = cores_of(high.rest), curled_cores = cores_of(curled);
    // Stubs tell of long strands no more than their quarter does.
    constexpr float least_share = 0.25f;
    float mean = 0;
    for (int s = 0; s < low.rest.count; ++s)
        mean += length_of(low.rest.strand(s), particles_) / float(low.rest.count);
    for (int s = 0; s < low.rest.count; ++s)
        per_low_length_.push_back(1 /
                                  std::max(length_of(low.rest.strand(s), particles_), least_share * mean));
    weigh(drawn_cores);
    find_own(low, drawn_cores);
    const int n = particles_, width = around_.width, blocks = lanes_.blocks();
    constexpr float longest = 4;  // edges, of the drawn ones
    const Vec3<S> none{S(0), S(0), S(0)};
    rest_.assign(size_t(blocks) * n, {none, S(1), none, none, none});
    block_length_.assign(size_t(blocks), S(0));
    from_.assign(size_t(blocks) * S::lanes * width, 0);
    weight_.assign(from_.size(), 0), lost_share_.assign(from_.size(), 0);
    auto set = [](Vec3<S>& to, int lane, const Vec3f& x) {
        to.x.set(lane, x.x), to.y.set(lane, x.y), to.z.set(lane, x.z);
    };
#pragma omp parallel for schedule(static)
    for (int block = 0; block < blocks; ++block)
        for (int lane = 0; lane < S::lanes; ++lane) {
            const int s = lanes_.strand(block, lane);
            if (s < 0) continue;
            const Quat<S>& turn = lanes_.rotation(block);
            const Quatf to_root = conjugate(Quatf{turn.w[lane], turn.x[lane], turn.y[lane], turn.z[lane]});
            const Vec3f *core = curled_cores.strand(s), *p = curled.strand(s);
            const size_t first = size_t(s) * width, here = (size_t(block) * S::lanes + lane) * width;
            const int* from = around_.from.data() + first;
            const float* weight = around_.weight.data() + first;
            const float strand_length = length_of(high.rest.strand(s), n);
            block_length_[size_t(block)].set(lane, strand_length);
            const int main = int(std::max_element(weight, weight + width) - weight);
            for (int k = 0; k < width; ++k)  // a strand that counts nothing is not read
                from_[here + size_t(k)] = from[weight[k] != 0 ? k : main];
            std::copy_n(weight, width, &weight_[here]);
            std::copy_n(&lost_weight_[first], width, &lost_share_[here]);
            for (int i = 0; i < n; ++i) {
                RestParticle<S>& out = rest_[size_t(block) * n + i];
                set(out.detail, lane, rotate(to_root, p[i] - core[i]));
                if (i + 1 == n) continue;
                const Vec3f edge = edge_of(drawn_cores, s, i), along = core[i + 1] - core[i];
                Vec3f own = edge;
                for (int k = 0; k < width; ++k)
                    own -= weight[k] * strand_length * per_low_length_[size_t(from[k])] *
                           edge_of(low_rest_cores_, from[k], i);
                // Wet strands come as short as they are. An edge that is drawn as good as nowhere tells
                // nothing.
                const float length =
                    low_is_wet_ ? 1
                                : std::min(norm(along) / std::max(norm(edge), tiny_length<float>), longest);
                out.length.set(lane, length);
                set(out.edge, lane, rotate(to_root, length * edge));
                set(out.own, lane, rotate(to_root, length * own));
                set(out.curled, lane, rotate(to_root, along));
            }
        }
    if (settled) start_from(*settled);
    if (!low_is_wet_) return;
    low_offsets_ = Strands(low.rest.count, n);
    kept_.assign(size_t(blocks) * S::lanes, -1);
    for (int s = 0; s < low.rest.count; ++s)
        if (const int twin = around_.twin[size_t(s)]; twin >= 0) kept_[size_t(lanes_.place_of(twin))] = s;
}

RestParticle<float> RestCarrier::rest(int strand, int particle) const {
    const int place = lanes_.place_of(strand), lane = place % S::lanes;
    const RestParticle<S>& p = rest_[size_t(place / S::lanes) * particles_ + particle];
    auto of = [&](const Vec3<S>& v) { return Vec3f{v.x[lane], v.y[lane], v.z[lane]}; };
    return {of(p.edge), p.length[lane], of(p.curled), of(p.detail), of(p.own)};
}

void RestCarrier::follow(const Vec3f* low, const Pose& head) {
    const int n = particles_, low_strands = moved_.count;
    const Quat<S> to_head = cast<S>(conjugate(head.rotation));
    const float beta = core_beta(n);
#pragma omp for schedule(static)
    for (int block = 0; block < low_lanes_.blocks(); ++block) {
        Vec3<S>*p = &offsets_[size_t(block) * n], *core = &cores_[size_t(block) * n];
        S* const numbers = &p->x;
        low_lanes_.load(block, 3 * n, &low->x, numbers);
        S share(1);
        for (int lane = 0; lane < S::lanes && !settled_.share.empty(); ++lane)
            if (const int s = low_lanes_.strand(block, lane); s >= 0)
                share.set(lane, settled_.share[size_t(s)]);
        const Vec3<S> root = p[0];
        for (int i = 0; i < n; ++i) p[i] = share * rotate(to_head, p[i] - root);
        core_of(p, n, beta, core);
        low_lanes_.store(block, 3 * n, &core->x, &moved_.points.data()->x);
        if (low_is_wet_) low_lanes_.store(block, 3 * n, numbers, &low_offsets_.points.data()->x);
        for (int lane = 0; lane < S::lanes; ++lane) {
            const int s = low_lanes_.strand(block, lane);
            if (s < 0) continue;
            Vec3f* moved = moved_.strand(s);
            const Vec3f* rest = low_rest_cores_.strand(s);
            const float per = per_low_length_[size_t(s)];
            for (int i = 0; i < n; ++i) moved[i] = per * (moved[i] - (rest[i] - rest[0]));
            for (int i = 0; i < n && !settled_.share.empty(); ++i)
                low_offsets_.at(s, i) += settled_.more.at(s, i);
        }
    }
#pragma omp for schedule(static)
    for (int s = 0; s < low_strands; ++s) lost_[size_t(s)] = lost_of(s);
}

float RestCarrier::lost_of(int low_strand) const {
    const int numbers = 3 * (particles_ - 1);
    const Beside& beside = around_.beside[size_t(low_strand)];
    const float* own = &own_.strand(low_strand)->x;
    const auto moved = [&](int k) { return &moved_.strand(k)->x; };
    S sums(0);
    int j = 0;
    for (; j + S::lanes <= numbers; j += S::lanes)
        sums += lost_of_edge(S::load(own + j), low_strand, beside,
                             [&](int k) { return S::load(moved(k) + j + 3) - S::load(moved(k) + j); });
    float sum = 0;
    for (int lane = 0; lane < S::lanes; ++lane) sum += sums[lane];
    for (; j < numbers; ++j)
        sum += lost_of_edge(own[j], low_strand, beside, [&](int k) { return moved(k)[j + 3] - moved(k)[j]; });
    return sum;
}

void RestCarrier::carry(int block, Vec3<S>* out, S* doubt) const {
    constexpr int most = Stencil::widest;
    const int n = particles_, width = around_.width;
    const size_t first = size_t(block) * S::lanes * width;
    const float* row[S::lanes * most];
    S lost(0);
    for (int lane = 0; lane < S::lanes; ++lane) {
        float sum = 0;
        for (int k = lane * width; k < (lane + 1) * width; ++k) {
            const int from = from_[first + size_t(k)];
            row[k] = &moved_.strand(from)->x;
            sum += lost_share_[first + size_t(k)] * lost_[size_t(from)];
        }
        lost.set(lane, std::clamp(sum, 0.f, 1.f));
    }
    // `out` holds how far cores have moved, by their lengths, until a particle is there.
    weighted_columns(3 * n, width, row, &weight_[first], &out->x);
    if (doubt) {
        for (int place = 0; place < doubt_places; ++place) {
            const int i = doubt_particle(n, place);
            for (int lane = 0; lane < S::lanes; ++lane) {
                float sum = 0;
                for (int k = lane * width; k < (lane + 1) * width; ++k)
                    for (int axis = 0; axis < 3; ++axis) {
                        const float apart = row[k][3 * i + axis] - (&out[i].x)[axis][lane];
                        sum += weight_[first + size_t(k)] * apart * apart;
                    }
                doubt[place].set(lane, std::sqrt(sum));
            }
        }
        doubt[doubt_places] = lost;
    }
    const Quat<S> to_root = conjugate(lanes_.rotation(block));
    const RestParticle<S>* rest = &rest_[size_t(block) * n];
    const S length = block_length_[size_t(block)];
    carry_rest<S>(
        n, lost, [&](int i) -> const RestParticle<S>& { return rest[i]; },
        [&](int i) { return length * rotate(to_root, out[i]); },
        [&](int i, const Vec3<S>& x) { out[i] = x; });
    for (int lane = 0; lane < S::lanes && low_is_wet_; ++lane) {
        const int s = kept_[size_t(block) * S::lanes + lane];
        if (s < 0) continue;
        const Quatf turn{to_root.w[lane], to_root.x[lane], to_root.y[lane], to_root.z[lane]};
        for (int i = 0; i < n; ++i) {
            const Vec3f x = rotate(turn, low_offsets_.at(s, i));
            out[i].x.set(lane, x.x), out[i].y.set(lane, x.y), out[i].z.set(lane, x.z);
        }
    }
}

}  // namespace wetcurl

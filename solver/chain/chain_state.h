// The strands of a scene as the stepper holds them: strand-interleaved, a lane a strand; on a device, which
// has them one after the other, in plain numbers of one lane.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "base/buffer_list.h"
#include "solver/scene/rest_state.h"
#include "solver/scene/scene.h"
#include "solver/solids/rest_depths.h"

namespace wetcurl {

// Calls f(info, array) for those that the scene needs.
template <class Holder, class F>
void for_each_needed_array(const Scene& scene, Holder& holder, F f) {
#define WETCURL_ROW(name, type, extent, part, use, label, needed) \
    if (needed) f(StrandArrayInfo{label, ArrayExtent::extent, StrandPart::part, BufferUse::use}, holder.name);
    WETCURL_STRAND_ARRAYS(WETCURL_ROW)
#undef WETCURL_ROW
}

// Arrays of (block, particle) (solver/terms/strand_arrays.h). S is a plain number, or S::lanes of them; the
// last block is filled up with copies of the last strand.
template <class S>
struct ChainState : StrandArrays<S, HostArray> {
    using Arrays = StrandArrays<S, HostArray>;
    using Arrays::mass, Arrays::saturation, Arrays::rest_core, Arrays::target, Arrays::push, Arrays::x,
        Arrays::x_before, Arrays::root, Arrays::rest_depth, Arrays::rest_length, Arrays::frame,
        Arrays::touching, Arrays::stretch_spring, Arrays::bend_spring, Arrays::twist_spring;
    static constexpr bool plain = std::is_arithmetic_v<S>;
    static constexpr int lanes = [] {
        if constexpr (plain)
            return 1;
        else
            return S::lanes;
    }();
    int strands, n, blocks;

    size_t at(int block, int i) const { return size_t(block) * size_t(n) + size_t(i); }
    // The strand that a lane holds or copies; a block's strands, copies left out.
    int strand_of(int block, int lane) const { return std::min(block * lanes + lane, strands - 1); }
    int strands_in(int block) const { return std::min(lanes, strands - block * lanes); }

    // At rest on the pose of the head, or of each root that rides, where the run begins.
    explicit ChainState(const Scene& scene)
        : strands(scene.groom.rest.count),
          n(scene.groom.rest.particles),
          blocks((strands + lanes - 1) / lanes) {
        for_each_needed_array(scene, *this, [&](const StrandArrayInfo& info, auto& array) {
            array.resize(size_t(blocks) * info.entries(n));
        });
        const std::vector<float> depth = rest_depths_of(scene);
        RidingRoots::Room roots;
        if (scene.riding) scene.root_poses_at(scene.begin(), roots);
        const Pose head = scene.head_at(scene.begin());
#pragma omp parallel for schedule(dynamic)
        for (int block = 0; block < blocks; ++block)
            for (int lane = 0; lane < lanes; ++lane) {
                const int s = strand_of(block, lane);
                place(scene, scene.riding ? roots.pose[size_t(s)] : head, depth, block, lane, s);
            }
    }

    // One lane of a number, a vector, a rotation.
    static void put(S& to, int lane, double a) {
        if constexpr (plain)
            to = S(a);
        else
            to.set(lane, Plain<S>(a));
    }
    static void put(Vec3<S>& to, int lane, const Vec3d& p) {
        put(to.x, lane, p.x), put(to.y, lane, p.y), put(to.z, lane, p.z);
    }
    static void put(Quat<S>& to, int lane, const Quatd& q) {
        put(to.w, lane, q.w), put(to.x, lane, q.x), put(to.y, lane, q.y), put(to.z, lane, q.z);
    }
    template <class U>
    static U lane_of(const S& a, int lane) {
        if constexpr (plain)
            return U(a);
        else
            return U(a[lane]);
    }
    template <class U>
    static Vec3<U> lane_of(const Vec3<S>& a, int lane) {
        return {lane_of<U>(a.x, lane), lane_of<U>(a.y, lane), lane_of<U>(a.z, lane)};
    }
    template <class U>
    static Quat<U> lane_of(const Quat<S>& a, int lane) {
        return {lane_of<U>(a.w, lane), lane_of<U>(a.x, lane), lane_of<U>(a.y, lane), lane_of<U>(a.z, lane)};
    }

    // Calls f(particle, cell, lane) for each particle: its index in arrays (strand, particle), and where the
    // buffers here have it. A block is one thread's, so that f may write its lane of a cell.
    template <class F>
    void for_each_particle(F f) const {
        visit([&](int block) { return strands_in(block); }, f);
    }
    // For the copies too.
    template <class F>
    void for_each_lane(F f) const {
        visit([](int) { return lanes; }, f);
    }
    // Calls f(cell, particle) for each cell; `particle(lane)` for all lanes: which it holds, or copies.
    template <class F>
    void for_each_cell(F f) const {
#pragma omp parallel for schedule(static)
        for (int block = 0; block < blocks; ++block)
            for (int i = 0; i < n; ++i)
                f(at(block, i),
                  [&](int lane) { return size_t(strand_of(block, lane)) * size_t(n) + size_t(i); });
    }
    // Calls f(lane) for the lanes that hold strand s or copy it.
    template <class F>
    void for_each_lane_of(int s, F f) const {
        for (int lane = s % lanes; lane < lanes; ++lane)
            if (strand_of(s / lanes, lane) == s) f(lane);
    }
    // A buffer (block, particle) as numbers U (strand, particle); empty where it is empty. And back.
    template <class U, class V, class To>
    void unpack(const std::vector<V>& from, std::vector<To>& to) const {
        to.resize(from.empty() ? 0 : size_t(strands) * size_t(n));
        if (!from.empty())
            for_each_particle([&](size_t id, size_t k, int lane) { to[id] = lane_of<U>(from[k], lane); });
    }
    template <class From, class V>
    void pack(const std::vector<From>& from, std::vector<V>& to) const {
        for_each_lane([&](size_t id, size_t k, int lane) { put(to[k], lane, from[id]); });
    }
    // All that a simulation goes on from, (strand, particle). What is empty in `from` stays as it is.
    void save(StateArrays<double, HostArray>& to) const {
        for_each_state_array([&](auto, const auto& array, auto& out) { unpack<double>(array, out); }, *this,
                             to);
    }
    void restore(const StateArrays<double, HostArray>& from) {
        for_each_state_array(
            [&](auto, auto& array, const auto& values) {
                if (!array.empty() && !values.empty()) pack(values, array);
            },
            *this, from);
    }
    // At rest where each strand is, carried rigidly by move(strand), a Pose.
    template <class Move>
    void carry(Move move) {
        for_each_lane([&](size_t id, size_t k, int lane) {
            const Pose by = move(id / size_t(n));
            put(x[k], lane, by(lane_of<double>(x[k], lane)));
            if (!frame.empty()) put(frame[k], lane, by.rotation * lane_of<double>(frame[k], lane));
        });
        x_before = x;
        for (auto* at_rest : {&this->v, &this->v_before})
            at_rest->assign(at_rest->size(), {S(0), S(0), S(0)});
        this->pushed.assign(this->pushed.size(), S(0));
    }
    // Substeps of `now` [s] follow those of `before`: what was one of the latter ago becomes what was one of
    // the former ago, along the cubic through both ends. Returns false where they are too unlike for that.
    bool retime(double step_before, double step_now) {
        const double w = step_now / step_before;
        if (w > 1.5) return false;
        // BDF2 bears no more than 1 + sqrt(2).
        const double s = 1 - w;
        const auto at_before = S(Plain<S>((1 + 2 * s) * w * w)),
                   of_before = S(Plain<S>(s * w * w * step_before)),
                   of_now = S(Plain<S>(s * s * (s - 1) * step_before)), share = S(Plain<S>(w));
#pragma omp parallel for schedule(static)
        for (size_t k = 0; k < x.size(); ++k) {
            x_before[k] =
                x[k] + at_before * (x_before[k] - x[k]) + of_before * this->v_before[k] + of_now * this->v[k];
            this->v_before[k] = this->v[k] + share * (this->v_before[k] - this->v[k]);
            if (!this->pushed.empty()) this->pushed[k] = share * this->pushed[k];
        }
        return true;
    }
    // (strand, particle), 1 in contact; empty without adhesion.
    std::vector<uint8_t> contacts() const {
        std::vector<uint8_t> out;
        unpack<uint8_t>(touching, out);
        return out;
    }

    // What follows the water of one strand: `rest` at the saturation (n), null where the scene has none. What
    // is empty in `rest` stays.
    void put_water(const Scene& scene, int block, int lane, const StrandRest& rest, const float* sigma) {
        for (int i = 0; i < n; ++i) {
            const size_t k = at(block, i);
            put(mass[k], lane, rest.mass[size_t(i)]);
            if (!saturation.empty()) put(saturation[k], lane, sigma[i]);
            if (i + 1 == n) continue;
            if (!stretch_spring.empty()) put(stretch_spring[k], lane, rest.springs.stretch[size_t(i)]);
            if (!bend_spring.empty()) put(bend_spring[k], lane, rest.springs.bend[size_t(i)]);
            if (!twist_spring.empty()) put(twist_spring[k], lane, rest.springs.twist[size_t(i)]);
            if (!rest.rest_core.empty()) put(rest_core[k], lane, rest.rest_core[size_t(i)]);
            if (!target.empty() && !rest.target.empty()) put(target[k], lane, rest.target[size_t(i)]);
            if (!push.empty())
                put(push[k], lane,
                    scene.curl->w_h * sigma[i] * printed_edge(*scene.curl, rest.rest_length[size_t(i)], i));
        }
    }

    // Where the arrays of a block begin.
    StrandArrays<S, ConstPointer> pointers(int block) const {
        StrandArrays<S, ConstPointer> whole;
        for_each_strand_array([](auto, auto& to, const auto& array) { to = array.data(); }, whole, *this);
        return arrays_of(whole, size_t(block), n);
    }
    void list(BufferList& to) const {
        for_each_strand_array([&](const StrandArrayInfo& info,
                                  const auto& array) { add_buffer(to, info.label, array, info.use); },
                              *this);
    }

  private:
    template <class Lanes, class F>
    void visit(Lanes lanes_in, F f) const {
#pragma omp parallel for schedule(static)
        for (int block = 0; block < blocks; ++block)
            for (int lane = 0; lane < lanes_in(block); ++lane) {
                const size_t first = size_t(strand_of(block, lane)) * size_t(n);
                for (int i = 0; i < n; ++i) f(first + size_t(i), at(block, i), lane);
            }
    }
    void place(const Scene& scene, const Pose& root_pose, const std::vector<float>& depth, int block,
               int lane, int s) {
        const StrandRest rest = rest_state_of(scene, s);
        for (int i = 0; i < n; ++i) {
            const Vec3d p = rest.start[size_t(i)];
            const size_t k = at(block, i), drawn = size_t(s) * size_t(n) + size_t(i);
            const Vec3d world = root_pose(p);
            put(x[k], lane, world);
            put(x_before[k], lane, world);
            if (i < 2) put(root[size_t(block) * 2 + size_t(i)], lane, p);
            if (!rest_depth.empty()) put(rest_depth[k], lane, depth[drawn]);
            if (i + 1 == n) continue;
            put(rest_length[k], lane, rest.rest_length[size_t(i)]);
            if (!frame.empty()) put(frame[k], lane, root_pose.rotation * rest.frame[size_t(i)]);
        }
        const size_t first = size_t(s) * size_t(n);
        put_water(scene, block, lane, rest, scene.saturation.empty() ? nullptr : &scene.saturation[first]);
    }
};

// A run that blew up has no neighbours to find; the caller asks `divergence` next. p [m].
template <class U>
bool is_finite(const std::vector<Vec3<U>>& p) {
    const U* const x = reinterpret_cast<const U*>(p.data());
    int beyond = 0;
#pragma omp simd reduction(| : beyond)
    for (size_t k = 0; k < 3 * p.size(); ++k) beyond |= !(std::abs(x[k]) < U(1e6));
    return beyond == 0;
}

// Over the first `lanes` lanes.
template <class S>
double sum_of_lanes(const S& a, int lanes) {
    double sum = 0;
    for (int lane = 0; lane < lanes; ++lane) sum += double(a[lane]);
    return sum;
}

// Why a run cannot go on.
struct Divergence {
    int strand;
    std::string largest_term;  // the kind of energy that grew most
};

}  // namespace wetcurl

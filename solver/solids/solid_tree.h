// The nearest of many rigid solids by a tree of boxes; what it finds is the plain loop's, to the bit.
// Bounding-volume hierarchy by halving along the longest side; branch and bound.
#pragma once

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include "solver/solids/contact.h"

namespace wetcurl {

// With more solids than this the tree is walked. Measured (wetcurl bench --filter query): it is faster from
// 16 spheres on, and from 4 level sets.
inline constexpr size_t most_solids_in_a_loop = 6;

template <class T>
class SolidTree {
  public:
    // Of solids as they are posed; indices below are theirs. In the memory of those before.
    void pose(const std::vector<PosedSolid<T>>& solids) {
        boxes_.clear(), nodes_.clear();
        for (const auto& solid : solids) boxes_.push_back(box_of(solid));
        order_.resize(solids.size());
        std::iota(order_.begin(), order_.end(), 0);
        nodes_.reserve(2 * solids.size());
        nodes_.emplace_back();
        build(0, 0, int(solids.size()));
    }

    // Calls visit(k), near boxes first, for each solid that may be as near as `phi` [m] at x in some lane;
    // phi may shrink meanwhile.
    template <class S, class Visit>
    void visit_near(const Vec3<S>& x, const S& phi, Visit visit) const {
        struct Waiting {
            int node;
            S squared;
        } stack[64];  // halving leaves fewer levels
        int top = 0;
        stack[top++] = {0, squared_distance(nodes_[0].box, x)};
        while (top > 0) {
            const Waiting next = stack[--top];
            const S reach = maximum(phi, S(0));
            // Rounding must not hide a solid.
            if (!any_positive(reach * reach - S(T(0.9999)) * next.squared + S(T(1e-30)))) continue;
            const Node& node = nodes_[size_t(next.node)];
            if (node.solid >= 0) {
                visit(node.solid);
                continue;
            }
            Waiting far{node.children, squared_distance(nodes_[size_t(node.children)].box, x)},
                near{node.children + 1, squared_distance(nodes_[size_t(node.children) + 1].box, x)};
            if (first_lane(far.squared) < first_lane(near.squared)) std::swap(far, near);
            stack[top++] = far;
            stack[top++] = near;
        }
    }

    // Calls meet(k), in order, for each solid whose box some of the particles 2 to n - 1 may lie in; it says
    // whether it has moved any.
    template <class S, class Meet>
    void for_each_met(int n, const Vec3<S>* x, Meet meet) const {
        auto around = extent(n, x);
        for (size_t k = 0; k < boxes_.size(); ++k) {
            const Vec3<S> gap =
                upper(cast<S>(boxes_[k].low) - around.high, around.low - cast<S>(boxes_[k].high));
            if (!any_positive(-maximum(gap.x, maximum(gap.y, gap.z)))) continue;
            if (meet(k)) around = extent(n, x);
        }
    }

    size_t bytes() const {
        return nodes_.capacity() * sizeof(Node) + boxes_.capacity() * sizeof(Box) +
               order_.capacity() * sizeof(int);
    }

  private:
    struct Box {
        Vec3<T> low, high;
    };
    struct Node {
        Box box;
        int children = 0, solid = -1;  // a leaf has one solid, else there are two children in a row
    };
    template <class S>
    struct Extent {
        Vec3<S> low, high;
    };
    template <class S>
    static Extent<S> extent(int n, const Vec3<S>* x) {
        const S all(std::numeric_limits<T>::max());
        Extent<S> e{{all, all, all}, {-all, -all, -all}};
        for (int i = 2; i < n; ++i) e = {lower(e.low, x[i]), upper(e.high, x[i])};
        return e;
    }
    template <class S>
    static S squared_distance(const Box& box, const Vec3<S>& x) {
        const Vec3<S> d = x - lower(upper(x, cast<S>(box.low)), cast<S>(box.high));
        return dot(d, d);
    }
    static T first_lane(T a) { return a; }
    static T first_lane(const Pack<T>& a) { return a[0]; }

    // In the world, larger by more than rounding.
    static Box box_of(const PosedSolid<T>& solid) {
        const Bounds body = bounds_of(*solid.shape);
        constexpr T all = std::numeric_limits<T>::max();
        if (!std::isfinite(body.high.x)) return {{-all, -all, -all}, {all, all, all}};
        Box box{{all, all, all}, {-all, -all, -all}};
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3d c{corner & 1 ? body.high.x : body.low.x, corner & 2 ? body.high.y : body.low.y,
                          corner & 4 ? body.high.z : body.low.z};
            const Vec3<T> p = rotate(solid.rotation, cast<T>(c)) + solid.translation;
            box = {lower(box.low, p), upper(box.high, p)};
        }
        const T more = T(1e-5) * (norm(box.high - box.low) + norm(solid.translation));
        return {box.low - Vec3<T>{more, more, more}, box.high + Vec3<T>{more, more, more}};
    }
    void build(int node, int first, int count) {
        const auto begin = order_.begin() + first, end = begin + count;
        Box around = boxes_[size_t(*begin)];
        for (auto k = begin; k != end; ++k)
            around = {lower(around.low, boxes_[size_t(*k)].low), upper(around.high, boxes_[size_t(*k)].high)};
        nodes_[size_t(node)].box = around;
        if (count == 1) {
            nodes_[size_t(node)].solid = *begin;
            return;
        }
        const auto middle = [&](int k) {
            return T(0.5) * boxes_[size_t(k)].low + T(0.5) * boxes_[size_t(k)].high;
        };
        Box spread{middle(*begin), middle(*begin)};
        for (auto k = begin; k != end; ++k)
            spread = {lower(spread.low, middle(*k)), upper(spread.high, middle(*k))};
        const Vec3<T> side = spread.high - spread.low;
        const auto along = [&](int k) {
            const Vec3<T> m = middle(k);
            return side.x >= side.y && side.x >= side.z ? m.x : side.y >= side.z ? m.y : m.z;
        };
        std::nth_element(begin, begin + count / 2, end, [&](int a, int b) { return along(a) < along(b); });
        const int children = int(nodes_.size());
        nodes_[size_t(node)].children = children;
        nodes_.resize(nodes_.size() + 2);
        build(children, first, count / 2);
        build(children + 1, first + count / 2, count - count / 2);
    }

    std::vector<int> order_;
    std::vector<Node> nodes_;
    std::vector<Box> boxes_;  // (solid)
};

// The earlier one of solids that come in any order, where both are as near.
template <class S>
struct NearerOrEarlier {
    S rank;
    S* best;
    auto operator()(const S& distance, const S& so_far) const {
        const auto counts = (distance < so_far) | ((distance <= so_far) & (rank < *best));
        *best = select(counts, rank, *best);
        return counts;
    }
};

// expected_contact's, before it is weighed, and sample_nearest's, of `solids` by their tree.
template <class S>
Hold<S> deepest_contact(const SolidTree<Plain<S>>& tree, const std::vector<PosedSolid<Plain<S>>>& solids,
                        const S& rest_depth, const Vec3<S>& x) {
    Hold<S> hold = no_contact<S>();
    S best(-1);
    // A gap is no smaller than the distance: rest depths lie inside.
    tree.visit_near(x, hold.gap, [&](int k) {
        take_deeper(solids[size_t(k)], rest_depth, x, hold, NearerOrEarlier<S>{S(k), &best});
    });
    return hold;
}
template <class S>
void sample_nearest(const SolidTree<Plain<S>>& tree, const std::vector<PosedSolid<Plain<S>>>& solids,
                    const Vec3<S>& x, S& phi, Vec3<S>& normal, Vec3<S>& surface_velocity) {
    phi = S(1e9);
    S best(-1);
    tree.visit_near(x, phi, [&](int k) {
        take_nearer(solids[size_t(k)], x, phi, normal, surface_velocity, NearerOrEarlier<S>{S(k), &best});
    });
}

}  // namespace wetcurl

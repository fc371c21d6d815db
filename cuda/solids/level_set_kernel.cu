// Kernels of rebuilding: a node a thread, or where nodes are few a node a warp, whose lanes share out the
// tree.
#include "cuda/device/cuda_owners.h"
#include "cuda/solids/level_set_kernel.h"

namespace wetcurl {

namespace {

constexpr unsigned threads = 128, lanes = 32, side = 4, brick = side * side * side;
// Seen on an H200: a node a warp is faster for so many of them at most. Lanes with a node each go different
// ways through the tree, one after the other.
constexpr unsigned most_of_warps = 1 << 17;

// The tree as all lanes of a warp walk it for one place at a time.
class TreeOfWarp {
  public:
    __device__ explicit TreeOfWarp(const TriangleTree& tree) : tree_(tree) {
        for (unsigned bit = lanes / 2; bit > 0 && from_ >= 0; bit /= 2) {
            const TriangleTree::Node& node = tree.nodes[size_t(from_)];
            const bool second = threadIdx.x & bit;
            if (node.count == 0)
                from_ = node.first + second;
            else if (second)
                from_ = -1;  // the leaf is another lane's
        }
    }
    __device__ TriangleTree::Closest closest(const Vec3d& x, int guess) const {
        TriangleTree::Closest best;
        if (from_ >= 0) best = tree_.closest(x, guess, from_);
        double least = best.distance;
        for (unsigned other = lanes / 2; other > 0; other /= 2)
            least = minimum(least, __shfl_xor_sync(all, least, other));
        // The first lane's of those that are as near.
        const int lane = __ffs(int(__ballot_sync(all, best.distance == least))) - 1;
        best.triangle = __shfl_sync(all, best.triangle, lane);
        for (double* w : {&best.distance, &best.barycentric.x, &best.barycentric.y, &best.barycentric.z,
                          &best.point.x, &best.point.y, &best.point.z})
            *w = __shfl_sync(all, *w, lane);
        return best;
    }
    // Far clusters count as one: there is little to share out.
    __device__ bool inside(const Vec3d& x) const { return tree_.inside(x); }

  private:
    static constexpr unsigned all = 0xffffffff;
    const TriangleTree& tree_;
    int from_ = 0;  // this lane's part of the tree; -1: none
};

// Bit k of a place in a brick, in Morton order.
__device__ int bit(unsigned place, int k) { return int(place >> k & 1); }

template <bool by_warps>
__global__ void __launch_bounds__(threads)
    set_nodes(const __grid_constant__ LevelSetRebuild rebuild, const __grid_constant__ TriangleTree tree,
              int step, dim3 bricks) {
    const unsigned thread = blockIdx.x * threads + threadIdx.x, node = by_warps ? thread / lanes : thread;
    const unsigned b = node / brick, place = node % brick;
    const int i = step * (int(b % bricks.x * side) + bit(place, 0) + 2 * bit(place, 3)),
              j = step * (int(b / bricks.x % bricks.y * side) + bit(place, 1) + 2 * bit(place, 4)),
              k = step * (int(b / bricks.x / bricks.y * side) + bit(place, 2) + 2 * bit(place, 5));
    const DistanceGrid& g = rebuild.band.grid;
    if (i >= g.nx || j >= g.ny || k >= g.nz) return;
    if constexpr (by_warps)
        rebuild.set(TreeOfWarp(tree), step, i, j, k);  // the same by all its lanes
    else
        rebuild.set(tree, step, i, j, k);
}

void launch_lattice(const LevelSetRebuild& rebuild, const TriangleTree& tree, int step, cudaStream_t stream) {
    auto along = [step](int nodes) { return (unsigned((nodes - 1) / step) + side) / side; };
    const dim3 bricks(along(rebuild.band.grid.nx), along(rebuild.band.grid.ny), along(rebuild.band.grid.nz));
    const unsigned nodes = bricks.x * bricks.y * bricks.z * brick;
    if (nodes <= most_of_warps)
        set_nodes<true><<<nodes * lanes / threads, threads, 0, stream>>>(rebuild, tree, step, bricks);
    else
        set_nodes<false>
            <<<(nodes + threads - 1) / threads, threads, 0, stream>>>(rebuild, tree, step, bricks);
}

}  // namespace

MovingLevelSetDevice::MovingLevelSetDevice(const Mesh& mesh, const Bounds& box, double spacing, double band,
                                           cudaStream_t stream)
    : stream_(stream),
      mesh_(mesh),
      surface_(mesh_),
      band_(mesh, box, spacing, band),
      triangles_(mesh.triangles.size()),
      original_(mesh.triangles.size()),
      place_(mesh.triangles.size()),
      tree_nodes_(mesh.triangles.size()),
      vertices_(mesh.vertices.size()),
      before_(mesh.vertices.size()),
      corners_(mesh.triangles),
      phi_before_(band_.nodes()),
      phi_(band_.nodes()),
      velocity_(band_.nodes()),
      triangle_(band_.nodes()) {
    check_cuda(cudaStreamSynchronize(nullptr), "mesh");  // streams of launches do not wait for this one
    hold(mesh.vertices);
}

void MovingLevelSetDevice::hold(const std::vector<Vec3f>& vertices) {
    find_tree(vertices);
    per_second_ = 0;
    send(stream_);
    copy_on_device(before_.data(), vertices_.device.data(), before_.size(), stream_);
    launch_rebuild(stream_);
    copy_on_device(phi_before_.data(), phi_.data(), phi_.size(), stream_);
}

void MovingLevelSetDevice::advance(const std::vector<Vec3f>& vertices, double seconds) {
    find_tree(vertices);
    per_second_ = 1 / seconds;
}

void MovingLevelSetDevice::launch_advance(cudaStream_t stream) const {
    copy_on_device(phi_before_.data(), phi_.data(), phi_.size(), stream);
    copy_on_device(before_.data(), vertices_.device.data(), before_.size(), stream);
    send(stream);
    launch_rebuild(stream);
}

MovingGrid MovingLevelSetDevice::grid(double share) const {
    return moving_grid(band_, phi_before_.data(), phi_.data(), velocity_.data(), share, per_second_);
}

void MovingLevelSetDevice::find_tree(const std::vector<Vec3f>& vertices) {
    mesh_.vertices = vertices;
    surface_.rebuild(mesh_);
    const TriangleTree tree = surface_.tree();
    triangles_.fill(tree.triangles), original_.fill(tree.original), place_.fill(tree.place);
    tree_nodes_.fill(tree.nodes), vertices_.fill(mesh_.vertices);
}

void MovingLevelSetDevice::send(cudaStream_t stream) const {
    triangles_.send(stream), original_.send(stream), place_.send(stream), tree_nodes_.send(stream);
    vertices_.send(stream);
}

void MovingLevelSetDevice::launch_rebuild(cudaStream_t stream) const {
    const TriangleTree tree{triangles_.sent(), original_.sent(), place_.sent(), tree_nodes_.sent()};
    const LevelSetRebuild rebuild{
        band_,       per_second_,      corners_.data(), before_.data(), vertices_.device.data(),
        phi_.data(), velocity_.data(), triangle_.data()};
    for (int step = LevelSetRebuild::coarsest_step; step > 0; step /= 2)
        launch_lattice(rebuild, tree, step, stream);
    check_cuda(cudaGetLastError(), "launch of a level set's rebuilding");
}

size_t MovingLevelSetDevice::bytes() const {
    return triangles_.device.bytes() + original_.device.bytes() + place_.device.bytes() +
           tree_nodes_.device.bytes() + vertices_.device.bytes() + before_.bytes() + corners_.bytes() +
           phi_before_.bytes() + phi_.bytes() + velocity_.bytes() + triangle_.bytes();
}

}  // namespace wetcurl

// The loop over lattices from coarse to fine, and the level sets of both ends of a span.
#include "base/geometry/moving_level_set.h"

namespace wetcurl {

NarrowBand::NarrowBand(const Mesh& mesh, const Bounds& box, double spacing, double width)
    : grid(laid_over(box, spacing, "the box of a moving mesh", LevelSetRebuild::coarsest_step)),
      // The corners of a cell on the rim lie a diagonal beyond.
      width(width + 2 * double(grid.spacing)),
      closed(boundary_edges(mesh) == 0) {}

MovingLevelSet::MovingLevelSet(Mesh mesh, const Bounds& box, double spacing, double band)
    : mesh_(std::move(mesh)),
      surface_(mesh_),
      band_(mesh_, box, spacing, band),
      phi_(band_.nodes()),
      velocity_(band_.nodes()),
      triangle_(band_.nodes()) {
    hold(mesh_.vertices);
}

void MovingLevelSet::hold(const std::vector<Vec3f>& vertices) {
    mesh_.vertices = before_ = vertices;
    per_second_ = 0;
    build();
    phi_before_ = phi_;
}

void MovingLevelSet::advance(const std::vector<Vec3f>& vertices, double seconds) {
    std::swap(phi_, phi_before_);
    std::swap(mesh_.vertices, before_);
    mesh_.vertices = vertices;
    per_second_ = 1 / seconds;
    build();
}

MovingGrid MovingLevelSet::grid(double share) const {
    return moving_grid(band_, phi_before_.data(), phi_.data(), velocity_.data(), share, per_second_);
}

size_t MovingLevelSet::bytes() const {
    return (phi_.capacity() + phi_before_.capacity()) * sizeof(float) + velocity_.capacity() * sizeof(Vec3f) +
           triangle_.capacity() * sizeof(int) + surface_.bytes();
}

void MovingLevelSet::build() {
    surface_.rebuild(mesh_);
    const LevelSetRebuild rebuild{
        band_,       per_second_,      mesh_.triangles.data(), before_.data(), mesh_.vertices.data(),
        phi_.data(), velocity_.data(), triangle_.data()};
    size_t exact = 0;
    for (int step = LevelSetRebuild::coarsest_step; step > 0; step /= 2)
#pragma omp parallel for collapse(2) schedule(dynamic, 4) reduction(+ : exact)
        for (int k = 0; k < band_.grid.nz; k += step)
            for (int j = 0; j < band_.grid.ny; j += step)
                for (int i = 0; i < band_.grid.nx; i += step) exact += rebuild.set(surface_, step, i, j, k);
    exact_ = exact;
}

}  // namespace wetcurl

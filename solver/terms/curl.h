// Curl exaggeration: wet hair curls more tightly. The rest shape is blended toward a helix.
// The paper, Eq 6-9. Differs: print adds a constant push that is not zero at rest; here the bend's target is
// blended from tbar_dry to tbar_helix, angle and direction of each turn by s = w_h sigma, so that saturation
// 0 changes no bit. Where no radius and pitch are named the helix is the strand's own curl, tightened to
// `contraction` times its axial extent at unchanged torsion (ours). It runs about the strand's own axis, edge
// by edge (print: one rotation a strand): water curls a strand, and bends it no further than it is drawn.
#pragma once

#include <optional>
#include <vector>

#include "solver/terms/form.h"
#include "solver/terms/wet_curl.h"

namespace wetcurl {

struct Curl {
    static constexpr const char *name = "curl", *table = "curl",
                                *about = "Curl exaggeration: wet hair curls more tightly; needs [wetness].";
    double w_h, contraction, tightening;
    std::optional<double> radius, pitch;  // [m], pitch of a full turn; both or none
    bool printed = false;
    static constexpr Parameter<Curl> parameters[] = {
        {KeyRow::number("weight", "1", 1, 0, 1, "Share of the wet shape at saturation 1.", "Eq 9, w_h"),
         &Curl::w_h},
        {KeyRow::number("contraction", "1", 0.75, 0.2, 1,
                        "Axial extent of the wet curl by that of the dry one, where no helix is named.",
                        "ours, Fig 28"),
         &Curl::contraction},
        {KeyRow::number("tightening", "1", 2, 1, 16,
                        "Largest factor by which a turn grows for it: nearly straight hair contracts less.",
                        "ours"),
         &Curl::tightening},
        {KeyRow::number("radius", "m", 0, 0, 1, "Radius of the helix of wet hair; with pitch.", "Eq 7, r")
             .without_default("the strand's own curl, contracted"),
         &Curl::radius},
        {KeyRow::number("pitch", "m", 0, 0, 10, "Pitch of a full turn of that helix; with radius.", "Eq 7, p")
             .without_default("the strand's own curl, contracted"),
         &Curl::pitch},
        {form_row, &Curl::printed},
    };
};

// Turn of the helix of radius r and pitch 2 pi p [m] for each segment of length l: the solution of
// l² = (2 r sin(omega/2))² + (p omega)². r = 0 or p = 0 are finite.
double helix_angle(double r, double p, double l);

// The shape of a strand in itself: tbar_i, edge i in the frame of edge i-1 (frames carried from the root).
// points (n) -> (n-1), entry 0 is the root edge's length along the first axis.
std::vector<Vec3d> intrinsic_shape(const std::vector<Vec3d>& points);
// And back, from the root's position and frame.
std::vector<Vec3d> shape_from_intrinsic(const std::vector<Vec3d>& tbar, const Vec3d& root,
                                        const Quatd& frame);

Turning turning_of(const std::vector<Vec3d>& tbar);

// Edge i, of length l [m], of the printed curl's helix: its push for each w_h sigma [m].
Vec3d printed_edge(const Curl& curl, double l, int i);

// How a strand curls as it takes up water: found once, asked for at any saturation.
class WetCurl {
  public:
    WetCurl(const Curl& curl, const std::vector<Vec3d>& tbar);  // (n-1), dry
    // tbar (n-1) at `saturation` (n). Up to where it is first above 0, the dry bits.
    std::vector<Vec3d> at(const float* saturation) const;
    // The same to `out` (n-1), in its memory; `points`: room.
    void at(const float* saturation, std::vector<Vec3d>& out, std::vector<Vec3d>& points) const;
    size_t bytes() const;

    // What any device needs for it.
    WetCurlView<const Vec3d*, const Quatd*> view() const;

  private:
    CurlOfStrand curl_;
    std::vector<Vec3d> dry_, straight_edges_, straight_, helix_, drawn_;  // (n-1), as in the view
    std::vector<Quatd> frames_, bend_left_;
};

std::vector<Vec3d> curled(const Curl& curl, const std::vector<Vec3d>& tbar, const float* saturation);

// Rotation M that turns unit h to unit p (Eq 7, 8): I + Psi + Psi²/(1+c), gamma = h x p, c = h.p.
// Differs: print has 2 Psi for Psi², c = gamma.p, and gamma = p x h, which turns p to h.
// Opposed vectors turn about `axis`, any vector that is not along h.
Mat3<double> helix_rotation(const Vec3d& h, const Vec3d& p, const Vec3d& axis);

}  // namespace wetcurl

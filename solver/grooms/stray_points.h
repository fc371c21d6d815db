// Points that are no part of their strands, as broken files have them.
#pragma once

#include <optional>

#include "solver/grooms/import.h"

namespace wetcurl {

// Of a strand [m].
struct Segments {
    std::vector<double> lengths;
    double usual = 0;  // the median one
    explicit Segments(const std::vector<Vec3d>& strand);
    bool is_long(size_t i) const { return lengths[i] > 5 * usual; }
    bool is_jump(size_t i) const { return lengths.size() > 2 && lengths[i] > 20 * usual; }
    double length_without_jumps() const;
};

// Of one strand: points [first, last).
struct StrayPoints {
    size_t first, last;
};

// Finds them against what is usual in a groom. Stray are
// - points at the file's origin, if the strand, or for a root most other roots, are elsewhere;
// - up to three points that the strand jumps to, over more than 5 of its median segments, and back from, to
//   near where it left;
// - all beyond a segment of more than 20 of the strand's median ones and a quarter of the usual strand; not
//   so where a fifth of the strands have such segments, which are drawn so then.
class StraySearch {
  public:
    explicit StraySearch(const ImportedStrands& in);
    // The first of that strand, from its root on; nothing: none.
    std::optional<StrayPoints> first_in(const std::vector<Vec3d>& strand) const;

  private:
    bool at_origin(const Vec3d& x) const { return norm(x - origin_) < 1e-9; }
    Vec3d origin_;
    double usual_length_ = 0;  // of a strand, without its jumps [m]
    bool roots_elsewhere_ = false, jumps_ = false;
};

struct Repaired {
    size_t strands = 0, points = 0;  // strands that lost points, and how many these were
};
// Leaves stray points out. Strands of which a single point is left are dropped, and counted as such.
Repaired repair(ImportedStrands& in);

}  // namespace wetcurl

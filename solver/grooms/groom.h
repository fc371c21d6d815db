// The groom that a scene names: the built-in one, or strands of a file laid on a grid.
#pragma once

#include <functional>
#include <optional>

#include "base/config.h"
#include "base/strands.h"
#include "solver/grooms/import.h"
#include "solver/grooms/root_grid.h"
#include "solver/grooms/strand_findings.h"

namespace wetcurl {

struct GroomTable;

// The scalp that is a solid of the scene, null where none is; roots (strand) [m] of a file's hair, else
// empty.
using ScalpOfSolid = std::function<std::shared_ptr<const ScalpMesh>(const std::vector<Vec3d>& roots)>;

// Reads `[groom]`. Without `file`: the built-in groom (procedural.h). With it: the file's strands, with
// `units`, `up`, then x <- `scale` x + `offset` [m], each resampled to `particles` points even in arc length,
// roots laid on a grid (`grid`, else the finest that they fill), normals from the `scalp` where one is named,
// else off the middle of the roots. Keys of the built-in groom are then checked and said to rest, since
// `--groom` lays a file over any scene. `of_solid`: where `scalp` may name a solid. `findings`, where given,
// receives what looks wrong about the strands. `brought` [m], where not empty: strands in place of a
// file's, none of which may be degenerate. Throws Misuse for keys and values, Error for bad files.
Groom load_groom(const Table& table, unsigned long long seed, const ScalpOfSolid& of_solid = {},
                 std::vector<Finding>* findings = nullptr, const StrandPoints& brought = {},
                 CurlTurns* curl = nullptr);

// The strands of `groom.file` [m], y up, in the order, at the place and repaired as the table says. Throws as
// import_strands of a file does.
ImportedStrands import_strands(const GroomTable& groom);

// The grid of every 1st, 2nd, 4th... root each way: the finest that has at most `at_most` strands, 1 or more.
// `stride`, where given, receives which. Throws Misuse where at_most < 1, Error where no root is left.
Groom thinned(const Groom& full, int at_most, int* stride = nullptr);

// "this groom nests as 64, 256, 1024 strands": the grids of every 1st, 2nd, 4th... root each way.
std::string nesting_text(const Groom& full);

// Every strand as `particles` points, even in arc length.
StrandPoints resampled_strands(const StrandPoints& strands, int particles);
// Their widths there, from those at the given points; of none, none.
StrandWidths resampled_widths(const StrandPoints& strands, const StrandWidths& widths, int particles);

// Roots under the surface of a scalp: real ones often are.
struct RootDepth {
    int roots = 0, below = 0;
    double median = 0, deepest = 0;  // depth of those below [m]
    double away = 0;                 // of all from the scalp, either side, in the median [m]
};
// Warns where roots are so far from the scalp that units or axis must be wrong.
RootDepth root_depth(const StrandPoints& strands, const ScalpMesh& scalp);
std::string described(const RootDepth& depth);

std::vector<Vec3d> roots_of(const StrandPoints& strands);

}  // namespace wetcurl

// Grooms of scenes.
#include "solver/grooms/groom.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "base/error.h"
#include "base/log.h"
#include "base/median.h"
#include "solver/grooms/procedural.h"
#include "solver/grooms/stray_points.h"

namespace wetcurl {

StrandPoints resampled_strands(const StrandPoints& strands, int particles) {
    StrandPoints out(strands.size());
#pragma omp parallel for schedule(dynamic, 64)
    for (size_t s = 0; s < strands.size(); ++s) out[s] = resampled(strands[s], particles);
    return out;
}

StrandWidths resampled_widths(const StrandPoints& strands, const StrandWidths& widths, int particles) {
    StrandWidths out(widths.size());
    for (size_t s = 0; s < widths.size(); ++s) {
        std::vector<double> at{0};  // arc length of each point
        for (size_t i = 1; i < strands[s].size(); ++i)
            at.push_back(at.back() + norm(strands[s][i] - strands[s][i - 1]));
        for (int k = 0; k < particles; ++k) {
            const double want = at.back() * k / (particles - 1);
            size_t after = 1;
            while (after + 1 < at.size() && at[after] < want) ++after;
            const double span = at[after] - at[after - 1];
            const float t = span > 0 ? float(std::clamp((want - at[after - 1]) / span, 0.0, 1.0)) : 0;
            out[s].push_back((1 - t) * widths[s][after - 1] + t * widths[s][after]);
        }
    }
    return out;
}

std::vector<Vec3d> roots_of(const StrandPoints& strands) {
    std::vector<Vec3d> roots;
    for (const auto& strand : strands) roots.push_back(strand[0]);
    return roots;
}

RootDepth root_depth(const StrandPoints& strands, const ScalpMesh& scalp) {
    RootDepth out;
    out.roots = int(strands.size());
    std::vector<double> depths, distances;
    for (const auto& root : roots_of(strands)) {
        const double height = scalp.closest(root).height;
        distances.push_back(std::abs(height));
        if (height < 0) depths.push_back(-height);
        out.deepest = std::max(out.deepest, -height);
    }
    out.below = int(depths.size());
    out.median = median(depths);
    out.away = median(distances);
    constexpr double too_far = 0.03;  // [m]
    if (out.away > too_far)
        log_warning("roots lie " + std::to_string(out.away) +
                    " m from the scalp in the median: are the units and up axes of hair and scalp right?");
    return out;
}

std::string described(const RootDepth& depth) {
    char text[200];
    std::snprintf(
        text, sizeof text,
        "roots lie %.1f mm from the scalp in the median; %d of %d under it, by %.1f mm in the median, "
        "%.1f mm at most",
        1e3 * depth.away, depth.below, depth.roots, 1e3 * depth.median, 1e3 * depth.deepest);
    return text;
}

static std::vector<Vec3f> normals_at(const std::vector<Vec3d>& roots, const ScalpMesh* scalp) {
    const RootDome dome = dome_of(roots);
    std::vector<Vec3f> normals;
    for (const auto& x : roots)
        normals.push_back(cast<float>(scalp ? scalp->closest(x).normal : dome.outward(x)));
    return normals;
}

// As the table says.
static void arrange(ImportedStrands& in, const GroomTable& groom, const std::string& file) {
    if (groom.tip_first) {
        for (auto& strand : in.strands) std::reverse(strand.begin(), strand.end());
        for (auto& widths : in.widths) std::reverse(widths.begin(), widths.end());
    }
    const Quatd turn = rotation_of(groom.rotation);
    for (auto& strand : in.strands)
        for (auto& x : strand) x = groom.scale * rotate(turn, x) + groom.offset;
    in.origin = groom.scale * rotate(turn, in.origin) + groom.offset;
    for (auto& widths : in.widths)
        for (float& width : widths) width *= float(groom.scale);
    if (!groom.repair) return;
    const Repaired repaired = repair(in);
    log_info(file + ": left out " + std::to_string(repaired.points) + " stray points of " +
             std::to_string(repaired.strands) + " strands");
}

ImportedStrands import_strands(const GroomTable& groom) {
    ImportedStrands in = import_strands(groom.file, groom.hair_units());
    arrange(in, groom, groom.file);
    return in;
}

// The grid asked for, or {0, 0} for the finest there is. One with fewer pixels than the file has strands is a
// choice of strands.
static GridSize grid_wanted(const Table& table, const GroomTable& groom, size_t strands) {
    if (!table.has("grid")) return {0, 0};
    const auto [width, height] = groom.grid;
    if ((long long)width * height - (long long)strands <= most_holes({width, height})) return {width, height};
    log_warning(table.where("grid") + ": found " + std::to_string(width) + " x " + std::to_string(height) +
                ", but " + groom.file + " has " + std::to_string(strands) +
                " strands: taking the finest grid that they fill");
    return {0, 0};
}

// A file laid over a scene's own groom leaves that one's keys without a part: they must be right all the
// same.
static void rest_procedural_keys(const Table& table, const std::string& file) {
    std::string resting;
    ProceduralGroom ignored;
    read_parameters(ignored, procedural_parameters, table);
    for (const auto& row : procedural_parameters)
        if (table.has(row.key)) resting += std::string(" ") + row.key;
    if (table.has("scalp_centre")) resting += " scalp_centre";
    if (!resting.empty())
        log_info(table.where() + ": strands come from " + file + "; without effect:" + resting);
}

// Each of them is somebody's, who asks for it by its number.
static ImportedStrands taken_whole(const StrandPoints& brought, const std::string& what) {
    for (size_t s = 0; s < brought.size(); ++s)
        for (size_t i = 0; i < brought[s].size(); ++i)
            if (const Vec3d& x = brought[s][i]; !std::isfinite(x.x + x.y + x.z))
                throw Error(what + ": point " + std::to_string(i) + " of strand " + std::to_string(s) +
                            " is not finite");
    ImportedStrands in = strands_in_metres(brought, what);
    if (in.dropped())
        throw Error(what + ": strand " + std::to_string(in.dropped_numbers[0]) +
                    " has no length; allowed are two points or more, 0.1 mm or more in all");
    return in;
}

static Groom groom_of_strands(const Table& table, const GroomTable& groom, const ScalpOfSolid& of_solid,
                              std::vector<Finding>* findings, const StrandPoints& brought, CurlTurns& curl) {
    const std::string file = brought.empty() ? groom.file : "strands in memory";
    const int particles = groom.particles;
    rest_procedural_keys(table, file);
    if (brought.empty() && !std::filesystem::exists(file)) table.fail("file", "no file '" + file + "'");
    ImportedStrands in = brought.empty() ? import_strands(groom) : taken_whole(brought, file);
    if (!brought.empty()) arrange(in, groom, file);
    const StrandPoints& strands = in.strands;
    if (findings) *findings = findings_of_strands(in, file);
    const std::vector<Vec3d> roots = roots_of(strands);
    const auto scalp = read_scalp(groom, of_solid ? of_solid(roots) : nullptr, in.up);
    if (scalp) log_info(file + ": " + described(root_depth(strands, *scalp)));
    curl = turns_of(strands);
    if (findings) findings->push_back(finding_of_turns(curl, particles));
    const RootLayout layout = lay_on_grid(roots, scalp.get(), grid_wanted(table, groom, roots.size()));
    log_info(file + ": " + described(layout));

    Groom full;
    full.rest = Strands(int(strands.size()), particles);
    const StrandPoints even = resampled_strands(strands, particles);
    for (int s = 0; s < full.rest.count; ++s)
        for (int i = 0; i < particles; ++i) full.rest.at(s, i) = cast<float>(even[size_t(s)][size_t(i)]);
    full.normal = normals_at(roots, scalp.get());
    full.grid = layout.grid;
    for (const auto& widths : resampled_widths(strands, in.widths, particles))
        full.width.insert(full.width.end(), widths.begin(), widths.end());
    full.origin = origins_of(full);  // of pixels
    for (size_t s = 0; s < strands.size(); ++s) {
        StrandOrigin& origin = full.origin[s];
        origin.number = origin.id = int(in.numbers[s]);
        if (!in.ids.empty()) origin.id = in.ids[s];
        if (!in.groups.empty()) origin.group = in.groups[s];
        if (!in.root_uv.empty()) std::copy_n(in.root_uv[s].begin(), 2, origin.uv);
    }
    return coarsened(full, 1);  // strands in the order of their pixels
}

Groom load_groom(const Table& table, unsigned long long seed, const ScalpOfSolid& of_solid,
                 std::vector<Finding>* findings, const StrandPoints& brought, CurlTurns* curl) {
    CurlTurns found;
    if (!curl) curl = &found;
    GroomTable read;
    read_parameters(read, GroomTable::parameters, table);
    if (!read.file.empty() || !brought.empty())
        return groom_of_strands(table, read, of_solid, findings, brought, *curl);
    const ProceduralGroom groom = read_procedural(table, seed, of_solid ? of_solid({}) : nullptr);
    *curl = turns_of(groom);
    if (findings) findings->push_back(finding_of_turns(*curl, groom.particles));
    return make_procedural(groom);
}

Groom thinned(const Groom& full, int at_most, int* stride) {
    if (at_most < 1) throw Misuse("--strands: found " + std::to_string(at_most) + ", allowed 1 or more");
    for (int each = 1;; each *= 2) {
        Groom out = coarsened(full, each);
        if (out.rest.count > at_most) continue;
        if (out.rest.count == 0)
            throw Error("--strands " + std::to_string(at_most) + ": " + nesting_text(full) +
                        "; no grid of it has so few");
        if (stride) *stride = each;
        return out;
    }
}

std::string nesting_text(const Groom& full) {
    const RootGrid& grid = full.grid;
    std::vector<int> counts;
    for (int each = 1; each == 1 || each / 2 < std::max(grid.width, grid.height); each *= 2) {
        int count = 0;
        for (int row = 0; row < grid.height; row += each)
            for (int column = 0; column < grid.width; column += each) count += grid.at(column, row) >= 0;
        if (count > 0 && (counts.empty() || count < counts.back())) counts.push_back(count);
    }
    std::string text;
    for (const int count : counts) text = std::to_string(count) + (text.empty() ? "" : ", " + text);
    return "this groom nests as " + text + " strands";
}

}  // namespace wetcurl

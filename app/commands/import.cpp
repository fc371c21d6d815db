// `wetcurl import`: reads strands of another program, reports on them, writes them in metres, Y up.
#include "app/commands/import.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/files/results.h"
#include "app/options/option_list.h"
#include "solver/grooms/groom.h"
#include "solver/grooms/strand_findings.h"

namespace wetcurl {
namespace {

struct Extent {
    Vec3d low, high;       // of all points [m]
    double median_length;  // [m]
    size_t points = 0;
};

Extent extent_of(const StrandPoints& strands) {
    Extent out{strands[0][0], strands[0][0], 0};
    std::vector<double> lengths;
    for (const auto& strand : strands) {
        out.points += strand.size();
        lengths.push_back(arc_length(strand.data(), int(strand.size())));
        for (const auto& x : strand) {
            out.low = {std::min(out.low.x, x.x), std::min(out.low.y, x.y), std::min(out.low.z, x.z)};
            out.high = {std::max(out.high.x, x.x), std::max(out.high.y, x.y), std::max(out.high.z, x.z)};
        }
    }
    std::sort(lengths.begin(), lengths.end());
    out.median_length = lengths[lengths.size() / 2];
    return out;
}

Json vector_json(const Vec3d& x) { return {x.x, x.y, x.z}; }

// Lengths in metres.
Json report(const ImportOptions& options, const ImportedStrands& in, const Extent& extent,
            const RootDepth* depth, const RootLayout& layout) {
    Json json{{"file", options.input},
              {"output", options.output},
              {"strands", in.strands.size()},
              {"points", extent.points},
              {"strands_in_file", in.found},
              {"dropped",
               {{"no_points", in.no_points},
                {"one_point", in.one_point},
                {"no_length", in.no_length},
                {"numbers", in.dropped_numbers}}},
              {"repeated_points", in.repeated_points},
              {"units", in.units},
              {"units_guessed", in.guessed},
              {"up", in.up},
              {"up_given", in.up_told},
              {"bounds", {{"low", vector_json(extent.low)}, {"high", vector_json(extent.high)}}},
              {"median_length", extent.median_length},
              {"grid",
               {{"width", layout.grid.width},
                {"height", layout.grid.height},
                {"roots_left_out", layout.quality.roots - layout.quality.pixels},
                {"neighbour_distance_mean", layout.quality.neighbour_mean},
                {"nearest_distance_mean", layout.quality.nearest_mean},
                {"parameterisation", layout.parameterisation},
                {"assignment", layout.assignment}}}};
    json["findings"] = Json::array();
    for (const Finding& finding : findings_of_strands(in, options.input))
        json["findings"].push_back(json_of(finding));
    if (depth)
        json["below_scalp"] = {
            {"roots", depth->below}, {"median_depth", depth->median}, {"deepest", depth->deepest}};
    return json;
}

void print(const ImportOptions& options, const ImportedStrands& in, const Extent& extent,
           const RootDepth* depth, const RootLayout& layout) {
    const Vec3d a = extent.low, b = extent.high;
    std::printf("%s: %zu strands, %zu points\n", options.input.c_str(), in.strands.size(), extent.points);
    std::printf("dropped   %zu of %zu strands: %zu without points, %zu of one point, %zu without length\n",
                in.dropped(), in.found, in.no_points, in.one_point, in.no_length);
    std::printf("left out  %zu points that repeat the one before\n", in.repeated_points);
    std::printf("units     %s%s, %s up%s\n", in.units.c_str(), in.guessed ? " (not given: guessed)" : "",
                in.up.c_str(),
                in.up_told             ? ""
                : in.up_reason.empty() ? " (not given: assumed)"
                                       : " (not given: guessed)");
    std::printf("bounds    x %.3f to %.3f, y %.3f to %.3f, z %.3f to %.3f m\n", a.x, b.x, a.y, b.y, a.z, b.z);
    std::printf("length    %.3f m in the median\n", extent.median_length);
    if (depth) std::printf("scalp     %s\n", described(*depth).c_str());
    std::printf("grid      %s\n", described(layout).c_str());
    for (const Finding& finding : findings_of_strands(in, options.input))
        if (finding.level != Finding::Level::note)
            std::printf("%s: %s\n", name_of(finding.level), described(finding).c_str());
    if (!options.output.empty()) std::printf("written   %s, metres, Y up\n", options.output.c_str());
}

}  // namespace

void add_options(OptionList& options, ImportOptions& o) {
    options.option("input", o.input, readable_endings()).required();
    options.option("output", o.output, writable_endings() + "; none: report only");
    options.option("--units", o.groom.units, "of the file").one_of({"m", "cm", "mm", "auto"}).shows_default();
    options
        .option("--up", o.groom.up,
                "axis that points up; auto: as the file says, else y, or a guess by how hair falls")
        .one_of({"x", "-x", "y", "-y", "z", "-z", "auto"})
        .shows_default();
    options.option("--rotation", o.groom.rotation, "of the strands about x, then y, then z [degrees]");
    options.option("--scale", o.groom.scale, "factor of the strands").within(1e-6, 1e6).shows_default();
    options.option("--offset", o.groom.offset, "of the strands, after rotation and scale [m]");
    options.option("--order", o.order, "where strands of the file begin")
        .one_of(GroomTable::orders)
        .shows_default();
    options.flag("--repair", o.groom.repair, "leave stray points out");
    options.option("--resample", o.resample, "particles a strand; 0: as it is").within(0, 100000);
    options.option("--scalp", o.scalp,
                   "head mesh in the units of the hair, which --rotation, --scale and --offset move to it: "
                   "depth of roots, and the grid laid on it");
}

// The head of the roots, whose file may have another axis than theirs where neither is told.
static ScalpMesh scalp_of(const ImportOptions& options, const ImportedStrands& in) {
    const auto with = [&](const std::string& up) {
        return ScalpMesh(import_mesh(options.scalp, {options.groom.units, up}));
    };
    if (options.groom.up != "auto" || in.up == "y") return with(options.groom.up);
    ScalpMesh as_said = with("auto"), as_hair = with(in.up);
    const auto away = [&](const ScalpMesh& scalp) {
        double sum = 0;
        for (const Vec3d& root : roots_of(in.strands)) sum += std::abs(scalp.closest(root).height);
        return sum;
    };
    return away(as_hair) < away(as_said) ? std::move(as_hair) : std::move(as_said);
}

int import_command(const ImportOptions& options) {
    if (options.resample == 1)
        throw Misuse("--resample: found 1, allowed 0 (as it is) or 2 particles and more");
    const bool writes = !options.output.empty();
    check_files(options, options.output, {options.input, options.scalp});
    if (writes) require_writable(options.output, options.overwrite);
    ResultFile results(options);
    GroomTable groom = options.groom;
    groom.file = options.input;
    groom.tip_first = options.order == "tip_first";
    ImportedStrands in = import_strands(groom);
    if (options.resample) {
        in.widths = resampled_widths(in.strands, in.widths, options.resample);
        in.strands = resampled_strands(in.strands, options.resample);
    }

    std::optional<ScalpMesh> scalp;
    std::optional<RootDepth> depth;
    if (!options.scalp.empty()) {
        scalp.emplace(scalp_of(options, in));
        depth = root_depth(in.strands, *scalp);
    }
    const RootLayout layout = lay_on_grid(roots_of(in.strands), scalp ? &*scalp : nullptr);
    const Extent extent = extent_of(in.strands);
    if (writes) write_strands(options.output, in.strands, options.overwrite, in.widths);
    if (options.json != "-") print(options, in, extent, depth ? &*depth : nullptr, layout);
    results.write_json(report(options, in, extent, depth ? &*depth : nullptr, layout));
    return 0;
}

}  // namespace wetcurl

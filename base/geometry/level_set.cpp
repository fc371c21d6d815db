// Signed distance grids of meshes: building and the cache on disk.
#include "base/geometry/level_set.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>

#include "base/hdf5.h"
#include "base/log.h"
#include "base/strands.h"

namespace wetcurl {

namespace {

constexpr const char* format = "wetcurl level set";
constexpr int version = 1;
constexpr double default_cells = 96;            // on the longest side
constexpr int padding = 4;                      // cells between the mesh and the border of the grid
constexpr double most_nodes = double(1 << 27);  // 512 MiB of single precision

std::string hash_of(const std::vector<float>& phi) {
    return hash_bytes(phi.data(), phi.size() * sizeof(float));
}

}  // namespace

std::string cache_folder() {
    if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache)
        return std::string(cache) + "/wetcurl";
    if (const char* home = std::getenv("HOME"); home && *home) return std::string(home) + "/.cache/wetcurl";
    return "";
}

double usual_spacing(const Bounds& box) {
    const Vec3d size = box.high - box.low;
    return std::max({size.x, size.y, size.z}) / default_cells;
}

DistanceGrid laid_over(const Bounds& box, double spacing, const std::string& what, int multiple) {
    const Vec3d size = box.high - box.low;
    const double longest = std::max({size.x, size.y, size.z});
    if (!(longest > 0) || !std::isfinite(longest)) throw Error("level set: " + what + " has no extent");
    if (spacing == 0) spacing = usual_spacing(box);
    if (!(spacing > 0) || !std::isfinite(spacing))
        throw Error("level set: a spacing of " + std::to_string(spacing) + " m, allowed above 0");
    const float h = float(spacing);
    const auto nodes = [&](double side) {
        const double cells = std::ceil(side / double(h)) + 2 * padding;
        return std::ceil(cells / multiple) * multiple + 1;
    };
    const double nx = nodes(size.x), ny = nodes(size.y), nz = nodes(size.z);
    if (!(nx * ny * nz <= most_nodes))
        throw Error("level set: a spacing of " + std::to_string(spacing * 1000) +
                    " mm makes more than 2^27 nodes of a mesh of " + std::to_string(longest) +
                    " m; take a spacing of " + std::to_string(longest / 400 * 1000) + " mm or more");
    const double pad = padding * double(h);
    return {cast<float>(box.low - Vec3d{pad, pad, pad}), h, int(nx), int(ny), int(nz), nullptr};
}

// Lays the grid; the values come by build() or load().
LevelSet::LevelSet(Mesh mesh, double spacing, Unbuilt) : mesh_(std::move(mesh)) {
    const DistanceGrid grid = laid_over(
        bounding_box(mesh_), spacing, "the mesh of " + std::to_string(mesh_.triangles.size()) + " triangles");
    origin_ = grid.origin, spacing_ = grid.spacing;
    nx_ = grid.nx, ny_ = grid.ny, nz_ = grid.nz;
}

LevelSet::LevelSet(Mesh mesh, double spacing) : LevelSet(std::move(mesh), spacing, Unbuilt{}) { build(); }

void LevelSet::build() {
    const auto start = std::chrono::steady_clock::now();
    const MeshDistance surface(mesh_);
    const Vec3d origin = cast<double>(origin_);
    const double h = double(spacing_);
    phi_.resize(size_t(nx_) * size_t(ny_) * size_t(nz_));
#pragma omp parallel for collapse(2) schedule(dynamic, 8)
    for (int k = 0; k < nz_; ++k)
        for (int j = 0; j < ny_; ++j) {
            int last = -1;  // the nearest triangle of one node is near the next one too
            for (int i = 0; i < nx_; ++i) {
                const Vec3d x = origin + h * Vec3d{double(i), double(j), double(k)};
                const auto nearest = surface.closest(x, last);
                last = nearest.triangle;
                const float d = float(nearest.distance);
                phi_[(size_t(k) * size_t(ny_) + size_t(j)) * size_t(nx_) + size_t(i)] =
                    surface.inside(x) ? -d : d;
            }
        }
    build_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::string LevelSet::key() const {
    const std::string vertices = hash_bytes(mesh_.vertices.data(), mesh_.vertices.size() * sizeof(Vec3f));
    const std::string triangles =
        hash_bytes(mesh_.triangles.data(), mesh_.triangles.size() * 3 * sizeof(int));
    const std::string all =
        vertices + triangles + hash_bytes(&spacing_, sizeof spacing_) + std::to_string(padding);
    return hash_bytes(all.data(), all.size());
}

bool LevelSet::load(const std::string& path) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) return false;
    try {
        const H5Reader file(path, format, version);
        auto phi = file.read<float>("phi", {size_t(nz_), size_t(ny_), size_t(nx_)});
        if (file.text("hash") != hash_of(phi)) throw Error(path + ": phi is not what was written");
        build_seconds_ = file.number("build seconds");
        phi_ = std::move(phi);
    } catch (const Error& e) {
        log_warning("level set in the cache is damaged and made anew: " + std::string(e.what()));
        return false;
    }
    return from_cache_ = true;
}

void LevelSet::store(const std::string& path) const {
    try {
        H5Writer file(path, format, version, true);
        try {
            file.write("phi", phi_.data(), {size_t(nz_), size_t(ny_), size_t(nx_)});
            file.attribute("hash", hash_of(phi_));
            file.attribute("build seconds", build_seconds_);
            file.commit();
        } catch (const Error&) {
            file.discard();
            throw;
        }
    } catch (const Error& e) {
        // Also where another process just stores the same.
        log_debug("level set not kept in the cache: " + std::string(e.what()));
    }
}

std::shared_ptr<const LevelSet> LevelSet::cached(Mesh mesh, double spacing, const std::string& folder) {
    std::shared_ptr<LevelSet> level_set(new LevelSet(std::move(mesh), spacing, Unbuilt{}));
    const std::string path = folder + "/level_set_" + level_set->key() + ".h5";
    if (!folder.empty() && level_set->load(path)) return level_set;
    level_set->build();
    if (!folder.empty()) level_set->store(path);
    return level_set;
}

}  // namespace wetcurl

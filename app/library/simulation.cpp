// Simulations in other programs.
#include <wetcurl/simulation.h>

#include <filesystem>
#include <memory>

#include "app/engine/device.h"
#include "app/engine/driven_run.h"
#include "app/library/calls.h"
#include "base/installed.h"
#include "solver/scene/findings.h"

using namespace wetcurl;

struct wetcurl_setup {
    std::string file;  // or:
    std::string text, folder;
    SceneOptions options;
    Brought brought;
    bool drives_roots = false;
};

struct wetcurl_simulation {
    std::string device;
    int threads;
    std::unique_ptr<DrivenRun> run;
};

namespace {

std::vector<Vec3f> points_of(const float* from, size_t count) {
    std::vector<Vec3f> out(count);
    for (Vec3f& x : out) x = {from[0], from[1], from[2]}, from += 3;
    return out;
}

Vec3f* points_of(float* to) {
    static_assert(sizeof(Vec3f) == 3 * sizeof(float));
    return reinterpret_cast<Vec3f*>(to);
}

void require_count(int found, int least, const std::string& what) {
    if (found < least)
        throw Error(what + ": found " + std::to_string(found) + ", allowed " + std::to_string(least) +
                    " or more");
}

// In the caller's thread, with the simulation's own number of threads.
template <class Act>
int on(wetcurl_simulation* simulation, const char* function, Act act) noexcept {
    return status_of([&] {
        given(simulation, function, "the simulation");
        const Threads own(simulation->threads);
        enter_device(simulation->device);
        act(*simulation->run);
    });
}

template <class Read>
int read(const wetcurl_simulation* simulation, const char* function, const float* to, Read read_it) noexcept {
    return status_of([&] {
        given(simulation, function, "the simulation"), given(to, function, "the memory to write to");
        enter_device(simulation->device);
        read_it(*simulation->run);
    });
}

}  // namespace

wetcurl_setup* wetcurl_setup_file(const char* scene) {
    return guarded<wetcurl_setup*>(nullptr, [&] {
        const std::string file = found_or_installed(given(scene, "wetcurl_setup_file", "scene"));
        if (!std::filesystem::exists(file)) throw Error(file + ": no such file");
        auto setup = std::make_unique<wetcurl_setup>();
        setup->file = file;
        return setup.release();
    });
}

wetcurl_setup* wetcurl_setup_text(const char* scene, const char* folder) {
    return guarded<wetcurl_setup*>(nullptr, [&] {
        auto setup = std::make_unique<wetcurl_setup>();
        setup->text = given(scene, "wetcurl_setup_text", "scene");
        setup->folder = given(folder, "wetcurl_setup_text", "folder");
        return setup.release();
    });
}

void wetcurl_setup_free(wetcurl_setup* setup) { delete setup; }

int wetcurl_setup_set(wetcurl_setup* setup, const char* assignment) {
    return status_of(
        [&] { setup->options.set.push_back(given(assignment, "wetcurl_setup_set", "assignment")); });
}

int wetcurl_setup_strands(wetcurl_setup* setup, int strands, const int* points, const float* positions) {
    return status_of([&] {
        const std::string function = "wetcurl_setup_strands";
        require_count(strands, 1, function + ": strands");
        given(points, function, "points"), given(positions, function, "positions");
        StrandPoints brought;
        for (int s = 0; s < strands; ++s) {
            require_count(points[s], 2, function + ": points of strand " + std::to_string(s));
            auto& strand = brought.emplace_back();
            for (int i = 0; i < points[s]; ++i, positions += 3)
                strand.push_back({double(positions[0]), double(positions[1]), double(positions[2])});
        }
        setup->brought.strands = std::move(brought);
    });
}

int wetcurl_setup_mesh(wetcurl_setup* setup, const char* solid, int vertices, const float* positions,
                       int triangles, const int* corners) {
    return status_of([&] {
        const std::string function = "wetcurl_setup_mesh", name = given(solid, function, "the solid's name");
        given(positions, function, "positions"), given(corners, function, "corners");
        require_count(vertices, 3, function + ": vertices"),
            require_count(triangles, 1, function + ": triangles");
        Mesh mesh{points_of(positions, size_t(vertices)), {}};
        for (int v = 0; v < vertices; ++v)
            if (const Vec3f& x = mesh.vertices[size_t(v)]; !std::isfinite(x.x + x.y + x.z))
                throw Error(function + ": vertex " + std::to_string(v) + " is not finite");
        for (int k = 0; k < 3 * triangles; ++k)
            if (corners[k] < 0 || corners[k] >= vertices)
                throw Error(function + ": triangle " + std::to_string(k / 3) + ": found vertex " +
                            std::to_string(corners[k]) + ", allowed 0 to " + std::to_string(vertices - 1));
        for (int k = 0; k < triangles; ++k, corners += 3)
            mesh.triangles.push_back({corners[0], corners[1], corners[2]});
        setup->brought.meshes[name] = std::move(mesh);
    });
}

int wetcurl_setup_drive_roots(wetcurl_setup* setup) {
    return status_of([&] { setup->drives_roots = true; });
}

wetcurl_simulation* wetcurl_simulate(const wetcurl_setup* setup, const char* device, const char* precision,
                                     int threads) {
    return guarded<wetcurl_simulation*>(nullptr, [&] {
        const std::string function = "wetcurl_simulate";
        given(setup, function, "the setup");
        const std::lock_guard alone(opening());
        const std::string exact = given(precision, function, "precision");
        if (exact != "float" && exact != "double")
            throw Error(function + ": found the precision '" + exact + "', allowed float, double");
        const int count = threads_of(threads, function);
        const Threads own(count);
        SceneOptions options = setup->options;
        options.brought = &setup->brought, options.endless = true;
        Scene scene;
        if (setup->file.empty()) {
            scene = parse_scene(setup->text, "scene", setup->folder, options);
            act_on(findings_of(scene), scene, "scene");
        } else {
            scene = load_scene(setup->file, options);
        }
        auto simulation = std::make_unique<wetcurl_simulation>();
        simulation->device = given(device, function, "device"), simulation->threads = count;
        simulation->run = std::make_unique<DrivenRun>(
            std::move(scene),
            DrivenRun::Given{.strands = !setup->brought.strands.empty(), .roots = setup->drives_roots},
            device, exact, count);
        return simulation.release();
    });
}

void wetcurl_simulation_free(wetcurl_simulation* simulation) {
    if (simulation) status_of([&] { enter_device(simulation->device); });
    delete simulation;
}

int wetcurl_strands(const wetcurl_simulation* simulation) { return simulation->run->strands(); }
int wetcurl_strand_particles(const wetcurl_simulation* simulation) { return simulation->run->particles(); }
double wetcurl_time(const wetcurl_simulation* simulation) { return simulation->run->time(); }

int wetcurl_move_head(wetcurl_simulation* simulation, const double pose[7]) {
    return on(simulation, "wetcurl_move_head",
              [&](DrivenRun& run) { run.move_head(pose_of(given(pose, "wetcurl_move_head", "pose"))); });
}

int wetcurl_move_solid(wetcurl_simulation* simulation, const char* solid, const double pose[7]) {
    return on(simulation, "wetcurl_move_solid", [&](DrivenRun& run) {
        run.move_solid(given(solid, "wetcurl_move_solid", "the solid's name"),
                       pose_of(given(pose, "wetcurl_move_solid", "pose")));
    });
}

int wetcurl_move_mesh(wetcurl_simulation* simulation, const char* solid, const float* positions) {
    return on(simulation, "wetcurl_move_mesh", [&](DrivenRun& run) {
        const std::string name = given(solid, "wetcurl_move_mesh", "the solid's name");
        given(positions, "wetcurl_move_mesh", "positions");
        run.move_mesh(name, points_of(positions, run.vertices(name)));
    });
}

int wetcurl_move_roots(wetcurl_simulation* simulation, const double* poses) {
    return on(simulation, "wetcurl_move_roots", [&](DrivenRun& run) {
        given(poses, "wetcurl_move_roots", "poses");
        std::vector<Pose> roots;
        for (int s = 0; s < run.strands(); ++s) roots.push_back(pose_of(poses + 7 * s));
        run.move_roots(roots);
    });
}

int wetcurl_wet(wetcurl_simulation* simulation, const float* saturation) {
    return on(simulation, "wetcurl_wet",
              [&](DrivenRun& run) { run.wet(given(saturation, "wetcurl_wet", "saturation")); });
}

int wetcurl_advance(wetcurl_simulation* simulation, double seconds) {
    return on(simulation, "wetcurl_advance", [&](DrivenRun& run) { run.advance(seconds); });
}

int wetcurl_cut(wetcurl_simulation* simulation) {
    return on(simulation, "wetcurl_cut", [](DrivenRun& run) { run.cut(); });
}

int wetcurl_displayed(const wetcurl_simulation* simulation, float* positions) {
    return read(simulation, "wetcurl_displayed", positions,
                [&](const DrivenRun& run) { run.displayed(points_of(positions)); });
}

int wetcurl_simulated(const wetcurl_simulation* simulation, float* positions) {
    return read(simulation, "wetcurl_simulated", positions,
                [&](const DrivenRun& run) { run.positions(points_of(positions)); });
}

int wetcurl_velocities(const wetcurl_simulation* simulation, float* velocities) {
    return read(simulation, "wetcurl_velocities", velocities,
                [&](const DrivenRun& run) { run.velocities(points_of(velocities)); });
}

int wetcurl_saturation(const wetcurl_simulation* simulation, float* saturation) {
    return read(simulation, "wetcurl_saturation", saturation,
                [&](const DrivenRun& run) { run.saturation(saturation); });
}
